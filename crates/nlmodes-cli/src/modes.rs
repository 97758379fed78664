//! `nlmodes-cli modes`: the linear modes, with and without the mass redistribution.

use nlmodes_run::chain;
use nlmodes_run::linear::{LinearFrequencies, linear_frequencies, modal_model};
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::structural_model;
use nlmodes_scene::scene::{Scene, Updating};

use crate::Status;
use crate::terminal::{print, refuse};

/// Prints the table of linear modes.
pub fn run(file: &SceneFile) -> Status {
    let found = structural_model(&file.scene).and_then(|model| linear_frequencies(&file.scene, &model));
    match found {
        Ok(found) => print(table(&file.scene, &found).trim_end()),
        Err(error) => refuse(&file.error_at(&error.path(), &chain(&error), "", &[])),
    }
}

/// Says of which of several methods the lines that follow are.
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

fn table(scene: &Scene, found: &LinearFrequencies) -> String {
    let rule = scene.method.mass_redistribution.name();
    let redistributed = format!("contact mass: {rule}");
    let columns = [
        Some(("contact mass kept", &found.mass_kept)),
        found.mass_redistributed.as_ref().map(|f| (redistributed.as_str(), f)),
        found.contacts_held.as_ref().map(|f| ("contacts held", f)),
        found.of_the_elements.as_ref().map(|f| ("of the elements", f)),
    ];
    let columns: Vec<(&str, &Vec<f64>)> = columns.into_iter().flatten().collect();
    let modal = scene.structure.straight().and_then(modal_model).map_or_else(String::new, |text| format!("\n{text}"));
    let mut text = format!("{}{modal}\n\nfrequency, Hz\n  mode", scene.title);
    columns.iter().for_each(|(name, _)| text += &format!("{name:>22}"));
    text += if found.characters.is_empty() { "\n" } else { "  what it is\n" };
    for k in 0..columns.iter().map(|(_, f)| f.len()).max().unwrap_or(0) {
        text += &format!("  {:>4}", k + 1);
        for (name, frequencies) in &columns {
            // In the row of the same mode, whatever the order of its frequency.
            let same = if *name == redistributed { found.redistributed_as.get(k).copied().flatten() } else { Some(k) };
            let frequency = same.and_then(|k| frequencies.get(k));
            text += &frequency.map_or_else(|| format!("{:>22}", "-"), |f| format!("{f:>22.8}"));
        }
        let character = found.characters.get(k).filter(|words| !words.is_empty());
        text += &character.map_or_else(String::new, |words| format!("  {words}"));
        text += "\n";
    }
    text
}

/// What was done, in a line for each parameter and each frequency.
pub fn updated(updating: &Updating) -> Option<String> {
    let done = updating.done.as_ref()?;
    let parameters = updating.parameters.iter().zip(done.from.iter().zip(&done.to));
    let parameters = parameters.map(|(p, (from, to))| format!("updated {}: {from:.6e} became {to:.6e}", p.name()));
    let frequencies = updating.modes.iter().zip(&updating.frequencies_hz).zip(done.from_hz.iter().zip(&done.to_hz));
    let frequencies = frequencies.map(|((mode, given), (from, to))| {
        format!("  mode {mode}: {from:.6} Hz became {to:.6} Hz, given {given} Hz ({:+.1e})", to / given - 1.0)
    });
    Some(parameters.chain(frequencies).collect::<Vec<_>>().join("\n"))
}
