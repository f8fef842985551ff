//! Progress bars on stderr, only where it is a terminal. They have no colours.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How often a bar looks at the counters. Rarely enough not to disturb timed runs.
const PERIOD: Duration = Duration::from_millis(250);

/// One stretch of work: what it is, how much of it there is, how much is done.
pub(crate) struct Stage<'a> {
    name: &'static str,
    total: Total<'a>,
    done: &'a AtomicU64,
}

enum Total<'a> {
    Known(u64),
    Later(&'a AtomicU64),
}

impl<'a> Stage<'a> {
    pub fn new(name: &'static str, total: u64, done: &'a AtomicU64) -> Stage<'a> {
        Stage { name, total: Total::Known(total), done }
    }

    /// How much there is turns out before the stage begins; until then `total` is 0.
    pub fn later(name: &'static str, total: &'a AtomicU64, done: &'a AtomicU64) -> Stage<'a> {
        Stage { name, total: Total::Later(total), done }
    }

    fn total(&self) -> Option<u64> {
        match self.total {
            Total::Known(total) => Some(total),
            Total::Later(total) => Some(total.load(Ordering::Relaxed)).filter(|total| *total > 0),
        }
    }
}

/// Runs `work` on this thread while another shows how far its stages are, one after the other. Without a terminal it
/// only runs `work`.
pub(crate) fn during<T>(title: &str, stages: &[Stage], work: impl FnOnce() -> T) -> T {
    if !std::io::stderr().is_terminal() {
        return work();
    }
    let finished = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let watcher = scope.spawn(|| watch(title, stages, &finished));
        let result = work();
        finished.store(true, Ordering::Relaxed);
        watcher.thread().unpark();
        result
    })
}

fn watch(title: &str, stages: &[Stage], finished: &AtomicBool) {
    for stage in stages {
        let bar = ProgressBar::with_draw_target(stage.total(), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{prefix} {msg} [{bar:32}] {percent:>3} %, {eta} left") {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_prefix(title.to_string());
        bar.set_message(stage.name);
        loop {
            let (done, total) = (stage.done.load(Ordering::Relaxed), stage.total());
            if let Some(total) = total {
                bar.set_length(total);
                bar.set_position(done.min(total));
            }
            if finished.load(Ordering::Relaxed) || total.is_some_and(|total| done >= total) {
                break;
            }
            std::thread::park_timeout(PERIOD);
        }
        bar.finish_and_clear();
    }
}
