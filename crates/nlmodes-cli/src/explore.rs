//! `nlmodes-cli explore`: a scene on a page with sliders, its branch computed anew while one drags.

mod answer;
mod computing;
mod save;
mod server;
mod sliders;

use std::path::PathBuf;

use clap::Args;
use nlmodes_scene::memory;

use crate::Status;
use crate::terminal::{print, wants_colours};
use answer::Explorer;

/// What `explore` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The scene, a TOML file
    #[arg(value_name = "SCENE")]
    path: PathBuf,
    /// Replaces a value of the scene, or adds one; see `run`
    #[arg(long = "set", value_name = "KEY=VALUE", allow_hyphen_values = true)]
    overrides: Vec<String>,
    /// Port on this machine; default: one that is free
    #[arg(long, default_value_t = 0)]
    port: u16,
}

/// Serves the page until Ctrl-C.
pub fn run(arguments: &Arguments) -> Status {
    let text = match std::fs::read_to_string(&arguments.path) {
        Ok(text) => text,
        Err(error) => {
            say!("error: cannot read {}: {error}", arguments.path.display());
            return Status::Wrong;
        }
    };
    let name = arguments.path.display().to_string();
    let mut files = match nlmodes_scene::parse_each_method(&name, &text, &arguments.overrides) {
        Ok(files) => files,
        Err(refused) => {
            say!("{}", refused.text(wants_colours()));
            return Status::Wrong;
        }
    };
    if let Err(said) = memory::admit(&mut files, None) {
        say!("{}", said.text(wants_colours()));
        return Status::Wrong;
    }
    let Some(first) = files.into_iter().next() else { return Status::Wrong };
    let served = server::bind(arguments.port).and_then(|server| {
        let explorer = Explorer::new(&arguments.path, text, arguments.overrides.clone(), &first, server.port())?;
        let said = print(&format!(
            "{}\n\nOpen it in a browser on this machine; nobody without this address gets an answer. Ctrl-C ends.",
            explorer.address()
        ));
        if said == Status::Done {
            server.serve(explorer);
        }
        Ok(said)
    });
    served.unwrap_or_else(|error| {
        say!("error: {error}");
        Status::EndedEarly
    })
}
