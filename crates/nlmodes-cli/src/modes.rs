//! `nlmodes-cli modes`: the linear modes, with and without the mass redistribution.

use nlmodes_run::chain;
use nlmodes_run::linear::{linear_frequencies, without_contacts};
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::Assembly;
use nlmodes_scene::scene::Scene;

use crate::Status;
use crate::terminal::{print, refuse};

/// Prints the table of linear modes; of a structure from files also where its contacts cannot be reduced.
pub fn run(file: &SceneFile) -> Status {
    let found = Assembly::of(&file.scene).and_then(|assembly| linear_frequencies(&file.scene, &assembly));
    match found {
        Ok(found) => print(found.table(&file.scene).trim_end()),
        Err(error) => match without_contacts(&file.scene) {
            Ok(Some(found)) => {
                let table = found.table(&file.scene);
                print(&format!("{}\n\nWithout the contacts, for {}", table.trim_end(), chain(&error)))
            }
            _ => refuse(&file.error_at(&error.path(), &chain(&error), "", &[])),
        },
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
