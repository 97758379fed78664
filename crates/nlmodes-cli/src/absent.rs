//! Commands that this build does not have, since a first run does not need what they bring along.

use std::ffi::OsString;

use clap::Args;

use crate::Status;

/// Whatever the command would take.
#[derive(Debug, Args)]
pub struct Arguments {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _all: Vec<OsString>,
}

/// Names the feature that the command needs.
pub fn refuse(command: &str, feature: &str) -> Status {
    say!(
        "error: `{command}` is not in this build of nlmodes-cli\n  help: `cargo run --features {feature} -- {command} \
         …` \
         or `cargo install --path crates/nlmodes-cli --features full`; releases have all features"
    );
    Status::Wrong
}
