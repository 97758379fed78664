//! Figures: their width, their titles, and other formats.

use std::error::Error;
use std::fs;

use assert_cmd::Command;

use super::{Outcome, run};

/// Widths in print and titles are as requested; drawing options do not change the computation.
#[test]
fn figures_have_the_width_and_the_title_that_are_asked_for() -> Outcome {
    let (_folder, out, _) = run(&["output.figure_width_mm=90", "output.figure_titles=false"])?;
    let (_other, usual, _) = run(&[])?;
    for name in ["frequency_energy.svg", "contacts.svg", "motion_1.svg", "history_P1.svg"] {
        let (narrow, wide) = (fs::read_to_string(out.join(name))?, fs::read_to_string(usual.join(name))?);
        assert!(narrow.contains("width=\"90mm\"") && wide.contains("width=\"720\""), "{name}");
        assert!(!narrow.contains(">Three stops<"), "{name}");
    }
    assert!(fs::read_to_string(usual.join("contacts.svg"))?.contains(">Three stops<"));
    assert_eq!(fs::read(out.join("branch.csv"))?, fs::read(usual.join("branch.csv"))?);
    Ok(())
}

/// Figures of another width are redrawn from the steps of the run, which is unchanged, including its verification
/// report.
#[test]
fn figures_of_another_width_are_drawn_anew_without_a_run() -> Outcome {
    let (_folder, out, _) = run(&[])?;
    let mut before = Vec::new();
    for entry in fs::read_dir(&out)? {
        let path = entry?.path();
        before.push((path.clone(), fs::read(path)?));
    }
    let figures = |more: &[&str]| -> Result<std::process::Output, Box<dyn Error>> {
        Ok(Command::cargo_bin("nlmodes-cli")?.arg("figures").arg(&out).args(more).output()?)
    };
    let drawn = figures(&["--width-mm", "90", "--no-titles"])?;
    assert_eq!(drawn.status.code(), Some(0), "{}", String::from_utf8_lossy(&drawn.stderr));
    for name in ["frequency_energy_90mm.pdf", "contacts_90mm.pdf", "motion_1_90mm.pdf", "history_P1_90mm.pdf"] {
        let page = String::from_utf8_lossy(&fs::read(out.join(name))?).into_owned();
        let size = page.split("/MediaBox").nth(1).ok_or("no size")?;
        let sides: Vec<f64> = size.split(&['[', ']', ' ', '\n'][..]).filter_map(|side| side.parse().ok()).collect();
        assert!((sides[2] - 90.0 / 25.4 * 72.0).abs() < 0.01, "{name}: {sides:?}");
    }
    for (path, content) in before {
        assert_eq!(fs::read(&path)?, content, "{}", path.display());
    }
    let hidden = fs::read_dir(&out)?.flatten().filter(|entry| entry.file_name().to_string_lossy().starts_with('.'));
    assert_eq!(hidden.count(), 0);
    for wrong in ["0", "nan", "1e9"] {
        assert_eq!(figures(&["--width-mm", wrong])?.status.code(), Some(2));
    }
    // An interrupted run is not continued for a figure.
    let steps = fs::read_to_string(out.join("steps.jsonl"))?;
    let kept: Vec<&str> = steps.lines().take(8).collect();
    fs::write(out.join("steps.jsonl"), kept.join("\n") + "\n")?;
    let cut = figures(&["--width-mm", "90"])?;
    assert_eq!(cut.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&cut.stderr).contains("--resume"), "{cut:?}");
    // The folder of one number of harmonics has no run.json: it is in the parent folder.
    fs::remove_file(out.join("run.json"))?;
    let part = figures(&["--width-mm", "90"])?;
    assert_eq!(part.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&part.stderr).contains("name the folder above"), "{part:?}");
    Ok(())
}

/// A PDF and a PNG beside each figure; the next run removes them.
#[test]
fn figures_come_as_pdf_and_png_too() -> Outcome {
    let (folder, out, _) = run(&["output.figure_width_mm=90"])?;
    let with_ending = |ending: &str| -> Result<Vec<String>, Box<dyn Error>> {
        let names = fs::read_dir(&out)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
        let mut names = names.collect::<Result<Vec<_>, std::io::Error>>()?;
        names.retain(|name| name.ends_with(ending));
        names.sort();
        Ok(names.into_iter().filter_map(|name| name.strip_suffix(ending).map(str::to_owned)).collect())
    };
    let place = out.to_string_lossy().into_owned();
    let call = Command::cargo_bin("nlmodes-cli")?
        .args(["figures", &place, "--format", "pdf,png", "--dots-per-inch", "50"])
        .output()?;
    assert_eq!(call.status.code(), Some(0), "{}", String::from_utf8_lossy(&call.stderr));
    let figures = with_ending(".svg")?;
    assert!(figures.len() > 5, "{figures:?}");
    assert_eq!((with_ending(".pdf")?, with_ending(".png")?), (figures.clone(), figures));
    let table = Command::cargo_bin("nlmodes-cli")?.arg("figures").arg(out.join("branch.csv")).output()?;
    let said = String::from_utf8_lossy(&table.stderr);
    assert!(table.status.code() == Some(2) && said.contains("branch.csv: no figures; expected .svg"), "{said}");
    let scene = folder.path().join("scene.toml");
    let again = Command::cargo_bin("nlmodes-cli")?
        .arg("run")
        .arg(&scene)
        .args(["--quiet", "--force", "--set", "output.figures=false", "--out"])
        .arg(&out)
        .output()?;
    assert_eq!(again.status.code(), Some(0), "{}", String::from_utf8_lossy(&again.stderr));
    assert!(String::from_utf8_lossy(&again.stderr).contains("figures as PDF or PNG will be removed"), "{again:?}");
    assert!(with_ending(".svg")?.is_empty() && with_ending(".pdf")?.is_empty() && with_ending(".png")?.is_empty());
    Ok(())
}
