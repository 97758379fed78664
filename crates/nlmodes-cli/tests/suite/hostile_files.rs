//! Malicious scenes: markup in names, links that lead out of the directory.

use std::error::Error;
use std::fs;
use std::path::Path;

use assert_cmd::Command;

type Outcome = Result<(), Box<dyn Error>>;

const MARKUP: &str = "</title></script><script>alert(1)</script><img src=x onerror=alert(2)>\\\" & '";

/// A rod of two elements and four points; a title that is a page of its own.
fn scene(title: &str) -> String {
    format!(
        r#"
title = "{title}"
[structure]
kind = "rod"
length_m = 1.0
elements = 2
start = "clamped"
[structure.material]
youngs_modulus_pa = 1.0
density_kg_m3 = 1.0
[structure.section]
area_m2 = 1.0
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1.0
[method]
harmonics = [1, 2]
[continuation]
max_energy_ratio = 1.01
"#
    )
}

fn run(directory: &Path, title: &str, arguments: &[&str]) -> Result<(Option<i32>, String), Box<dyn Error>> {
    fs::write(directory.join("scene.toml"), scene(title))?;
    let mut command = Command::cargo_bin("nlmodes-cli")?;
    command.args(["run", "scene.toml", "--quiet", "--out", "results"]).args(arguments).current_dir(directory);
    let output = command.output()?;
    Ok((output.status.code(), String::from_utf8(output.stderr)?))
}

/// All files below a directory.
fn files(directory: &Path) -> Result<Vec<std::path::PathBuf>, Box<dyn Error>> {
    let mut all = Vec::new();
    for entry in fs::read_dir(directory)? {
        let path = entry?.path();
        if path.is_dir() { all.extend(files(&path)?) } else { all.push(path) }
    }
    Ok(all)
}

#[test]
fn markup_in_a_title_is_text_on_page_and_figures() -> Outcome {
    let directory = tempfile::tempdir()?;
    let (status, said) = run(directory.path(), MARKUP, &[])?;
    assert_eq!(status, Some(0), "{said}");
    let mut seen = 0;
    for path in files(directory.path())? {
        let shown = path.extension().is_some_and(|ending| ending == "html" || ending == "svg");
        if shown {
            let text = fs::read_to_string(&path)?;
            for wrong in ["<script>alert", "<img src=x", "</title></script>"] {
                assert!(!text.contains(wrong), "{} has {wrong}", path.display());
            }
            seen += usize::from(text.contains("alert(1)"));
        }
    }
    assert!(seen > 2, "the title stands in {seen} files only");
    Ok(())
}

#[test]
fn nothing_is_written_beside_the_output_directory() -> Outcome {
    let directory = tempfile::tempdir()?;
    let (status, said) = run(directory.path(), "../../outside/name", &["--set", "structure.elements=4"])?;
    assert_eq!(status, Some(0), "{said}");
    let mut names: Vec<_> =
        fs::read_dir(directory.path())?.map(|entry| Ok(entry?.file_name())).collect::<Result<_, std::io::Error>>()?;
    names.sort();
    assert_eq!(names, ["results", "scene.toml"]);
    Ok(())
}

#[cfg(unix)]
#[test]
fn results_are_not_written_through_links() -> Outcome {
    let directory = tempfile::tempdir()?;
    let outside = directory.path().join("precious.txt");
    fs::write(&outside, "keep me")?;
    fs::create_dir_all(directory.path().join("results/h1"))?;
    let link = directory.path().join("results/h1/branch.csv");
    std::os::unix::fs::symlink(&outside, &link)?;
    let (status, said) = run(directory.path(), "rod", &[])?;
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("branch.csv is a symbolic link to") && said.contains("precious.txt"), "{said}");
    assert_eq!(fs::read_to_string(&outside)?, "keep me");
    fs::remove_file(&link)?;
    // A directory of results that is itself a link was the user's choice.
    fs::rename(directory.path().join("results"), directory.path().join("elsewhere"))?;
    std::os::unix::fs::symlink(directory.path().join("elsewhere"), directory.path().join("results"))?;
    let (status, said) = run(directory.path(), "rod", &[])?;
    assert_eq!(status, Some(0), "{said}");
    assert!(directory.path().join("elsewhere/h2/branch.csv").is_file());
    Ok(())
}

#[test]
fn warnings_stand_in_the_summary() -> Outcome {
    let directory = tempfile::tempdir()?;
    let (status, said) = run(directory.path(), "rod", &["--set", "contact.0.gap_m=1.5"])?;
    assert_eq!(status, Some(0), "{said}");
    assert_eq!(said.matches("longer than the structure").count(), 1, "{said}");
    let summary = fs::read_to_string(directory.path().join("results/h1/summary.json"))?;
    assert!(
        summary.contains("`contact.0.gap_m` is longer than the structure: 1.5 m, beside a length of 1 m"),
        "{summary}"
    );
    Ok(())
}
