//! The program as others start it.

use std::process::Command;

pub fn rattlebench(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rattlebench"));
    command.args(arguments);
    command
}
