//! Ctrl-C: the first asks to stop and keep what is finished, the second stops at once.

use std::sync::atomic::{AtomicBool, Ordering};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Set by the first Ctrl-C. Where no handler can be installed, Ctrl-C ends the program as usual.
pub(crate) fn flag() -> &'static AtomicBool {
    let installed = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    if let Err(error) = installed {
        eprintln!("remark: Ctrl-C will lose unfinished work: {error}");
    }
    &INTERRUPTED
}
