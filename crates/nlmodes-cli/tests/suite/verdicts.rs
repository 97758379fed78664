//! `check` and `run` think the same of a scene.

use std::error::Error;
use std::fs;
use std::path::Path;

use assert_cmd::Command;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// Status and standard error of a command on a copy of the scene in an empty directory.
fn said(command: &str, scene: &Path, more: &[&str]) -> Outcome<(Option<i32>, String)> {
    let directory = tempfile::tempdir()?;
    let name = scene.file_name().ok_or("a scene without a name")?;
    fs::copy(scene, directory.path().join(name))?;
    let text = String::from_utf8_lossy(&fs::read(scene)?).into_owned();
    let arguments = text.lines().next().and_then(|line| line.strip_prefix("# arguments: ")).unwrap_or_default();
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    let output = call.arg(command).arg(name).args(arguments.split_whitespace()).args(more);
    let output = output.current_dir(directory.path()).output()?;
    Ok((output.status.code(), String::from_utf8(output.stderr)?))
}

/// Whatever `run` refuses before it computes, `check` refuses too, in the same words; whatever `check` takes, `run`
/// begins with.
#[test]
fn check_refuses_what_run_refuses_and_nothing_else() -> Outcome {
    let mut differing = Vec::new();
    for folder in ["bad_scenes", "odd_scenes", "likely_mistakes"] {
        for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(folder))? {
            let scene = entry?.path();
            if scene.extension().is_none_or(|extension| extension != "toml") {
                continue;
            }
            let text = String::from_utf8_lossy(&fs::read(&scene)?).into_owned();
            // Records are for `experiment extract`.
            if text.contains("[recording]") {
                continue;
            }
            let (checked, check_said) = said("check", &scene, &[])?;
            // Some points are enough of those that are sound; a virtual test has nothing that would make it short.
            let short = ["--quiet", "--set", "continuation.max_points=3"];
            let more = match (checked, text.contains("[virtual_test")) {
                (Some(2), _) => &short[..1],
                (_, true) => continue,
                _ => &short,
            };
            let (ran, run_said) = said("run", &scene, more)?;
            if (checked == Some(2)) != (ran == Some(2)) || (checked == Some(2) && check_said != run_said) {
                let name = scene.display();
                differing.push(format!("{name}: check {checked:?}\n{check_said}\nrun {ran:?}\n{run_said}"));
            }
        }
    }
    assert!(differing.is_empty(), "{}", differing.join("\n"));
    Ok(())
}
