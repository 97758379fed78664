//! `nlmodes-cli modes`: the linear modes, with and without the mass redistribution.

use nlmodes_run::chain;
use nlmodes_run::linear::linear_frequencies;
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::structural_model;
use nlmodes_scene::scene::Scene;

use crate::Status;
use crate::terminal::{print, refuse};

/// Prints the table of linear modes.
pub fn run(file: &SceneFile) -> Status {
    let found = structural_model(&file.scene).and_then(|model| linear_frequencies(&file.scene, &model));
    match found {
        Ok(found) => print(found.table(&file.scene).trim_end()),
        Err(error) => refuse(&file.error_at(&error.path(), &chain(&error), "", &[])),
    }
}

/// Prints the method to which the following lines belong, if there are several.
pub fn say_method(scene: &Scene, number: usize, count: usize) -> Status {
    if count < 2 {
        return Status::Done;
    }
    let space = if number > 0 {
        "
"
    } else {
        ""
    };
    print(&format!("{space}[[method]] {} of {count}: {}", number + 1, scene.method.kind.name()))
}
