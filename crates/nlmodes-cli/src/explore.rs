//! `nlmodes-cli explore`: a scene on a page with sliders, with its branch recomputed as they move.

use std::path::PathBuf;

use clap::Args;
use nlmodes_run::explore::{ExploreError, Page};

use crate::Status;
use crate::terminal::{print, refuse};

/// Arguments of `explore`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The scene, a TOML file
    #[arg(value_name = "SCENE")]
    path: PathBuf,
    /// Replaces a value of the scene, or adds one; see `run`
    #[arg(long = "set", value_name = "KEY=VALUE", allow_hyphen_values = true)]
    overrides: Vec<String>,
    /// Port on this machine; default: a free one
    #[arg(long, default_value_t = 0)]
    port: u16,
}

/// Serves the page until Ctrl-C.
pub fn run(arguments: &Arguments) -> Status {
    let page = match Page::open(&arguments.path, arguments.overrides.clone(), arguments.port) {
        Ok(page) => page,
        Err(ExploreError::Scene(refused)) => return refuse(&refused),
        Err(error) => {
            say!("error: {error}");
            return if matches!(error, ExploreError::Server(_)) { Status::EndedEarly } else { Status::Wrong };
        }
    };
    let said = print(&format!(
        "{}\n\nOpen it in a browser on this machine; nobody without this address gets an answer. Ctrl-C ends.",
        page.address()
    ));
    if said == Status::Done {
        page.serve();
    }
    said
}
