//! `nlmodes-cli experiment design`: what a test will need.

use nlmodes_run::design::{design, in_words, of_structure, write};
use nlmodes_run::{RunError, design};
use nlmodes_scene::AnyScene;

use crate::Status;
use crate::observer::TerminalObserver;
use crate::options::RunOptions;
use crate::terminal::{print, refuse_run};

/// Plans the test of a scene, prints it and writes `design.json`.
pub fn run(scene: AnyScene, options: RunOptions) -> Status {
    let (file, assumed) = match scene {
        AnyScene::Test(file) => (*file, Vec::new()),
        AnyScene::Structure(files) => {
            let Some(file) = files.into_iter().next() else { return Status::Wrong };
            match of_structure(&file) {
                Ok(design::Assumed { file, assumed }) => (file, assumed),
                Err(error) => return refuse_run(&error),
            }
        }
        AnyScene::Records(_) => return Status::Wrong,
    };
    let mut found = match design(&file, &mut TerminalObserver::new(options)) {
        Ok(found) => found,
        Err(error) => return refuse_run(&error),
    };
    found.assumed = assumed;
    let directory = &file.scene.output_directory;
    if let Err(error) = write(&found, directory) {
        return refuse_run(&RunError::Files(error));
    }
    print(&format!("{}\nWritten to {}", in_words(&found), directory.join(design::FILE).display()));
    let is_whole = found.ended.is_none() && found.levels.iter().all(|level| level.held);
    if is_whole { Status::Done } else { Status::EndedEarly }
}
