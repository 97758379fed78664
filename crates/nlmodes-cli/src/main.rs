//! The program `nlmodes-cli`.

use std::process::ExitCode;

fn main() -> ExitCode {
    nlmodes_cli::command::run().into()
}
