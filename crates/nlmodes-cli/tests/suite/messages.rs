//! Messages about mistakes, word for word.
//!
//! Each scene in `tests/bad_scenes` is rejected with the text in the file `.stderr` beside it; each one in
//! `tests/odd_scenes` is accepted, with the warnings in the file beside it; `tests/likely_mistakes` has the most common
//! mistakes. `NLMODES_GOLDEN=write` rewrites these files: read them as somebody who just made the mistake. A first line
//! `# arguments: …` adds arguments to the call.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

use assert_cmd::Command;

type Outcome = Result<(), Box<dyn Error>>;

#[test]
fn mistakes_are_explained_word_for_word() -> Outcome {
    compare_all("tests/bad_scenes", |_| 2)
}

#[test]
fn oddities_are_warned_of_word_for_word() -> Outcome {
    compare_all("tests/odd_scenes", |_| 0)
}

/// Common first mistakes: an error ends the program, a warning does not.
#[test]
fn likely_mistakes_are_explained_word_for_word() -> Outcome {
    compare_all("tests/likely_mistakes", |said| if said.contains("error: ") { 2 } else { 0 })
}

fn compare_all(directory: &str, status: fn(&str) -> i32) -> Outcome {
    let mut scenes = Vec::new();
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(directory))? {
        scenes.push(entry?.path());
    }
    scenes.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    scenes.sort();
    assert!(!scenes.is_empty(), "{directory} has no scenes");
    let differing = scenes.iter().map(|scene| compare(scene, status)).collect::<Result<Vec<_>, _>>()?;
    let differing: String = differing.into_iter().flatten().collect();
    assert!(differing.is_empty(), "{differing}\nNLMODES_GOLDEN=write writes the expected texts anew");
    Ok(())
}

/// Checks one scene; `Some` text if its output differs from the expected one.
fn compare(scene: &Path, status: fn(&str) -> i32) -> Result<Option<String>, Box<dyn Error>> {
    let found = said_about(scene, status)?;
    let expected: PathBuf = scene.with_extension("stderr");
    if env::var("NLMODES_GOLDEN").is_ok_and(|mode| mode == "write") {
        fs::write(&expected, &found)?;
        return Ok(None);
    }
    let wanted = fs::read_to_string(&expected).unwrap_or_default().replace("\r\n", "\n");
    Ok((wanted != found).then(|| format!("{}: expected\n{wanted}\nfound\n{found}\n", scene.display())))
}

/// Output of `check` on standard error for a copy of the scene in an empty directory, in which no file may appear.
fn said_about(scene: &Path, status: fn(&str) -> i32) -> Result<String, Box<dyn Error>> {
    let directory = tempfile::tempdir()?;
    let name = scene.file_name().ok_or("a scene without a name")?;
    fs::copy(scene, directory.path().join(name))?;
    let text = String::from_utf8_lossy(&fs::read(scene)?).into_owned();
    let arguments = text.lines().next().and_then(|line| line.strip_prefix("# arguments: ")).unwrap_or_default();
    let mut command = Command::cargo_bin("nlmodes-cli")?;
    command.arg("check").arg(name).args(arguments.split_whitespace()).current_dir(directory.path());
    let output = command.output()?;
    let said = String::from_utf8(output.stderr)?;
    let status = status(&said);
    assert_eq!(output.status.code(), Some(status), "{}: {said}", scene.display());
    assert_eq!(output.stdout.is_empty(), status != 0, "{}", scene.display());
    assert_eq!(fs::read_dir(directory.path())?.count(), 1, "{} wrote something", scene.display());
    Ok(said.replace("\r\n", "\n"))
}
