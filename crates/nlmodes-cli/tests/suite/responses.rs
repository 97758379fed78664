//! Scenes with responses: tables, figures, ends, and messages.

mod errors;
mod few_masses;
mod sweeps;

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::tempdir;

type Outcome = Result<(), Box<dyn Error>>;

/// The rod of two elements with `EA = ρA = L = g₀ = 1`, tip dropped, 1 %, a force at its middle.
const ROD: &str = r#"
title = "Rod of two elements"
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
[damping]
ratio = 0.01
[[force]]
at_m = 0.5
[method]
harmonics = 20
mass_redistribution = "drop"
"#;

fn run(folder: &Path, text: &str, more: &[&str]) -> Result<Output, Box<dyn Error>> {
    let scene = folder.join("scene.toml");
    fs::write(&scene, text)?;
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    Ok(call.arg("run").arg(&scene).arg("--out").arg(folder.join("out")).args(more).current_dir(folder).output()?)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Rows of a table by the names of its columns.
fn rows(path: PathBuf) -> Result<Vec<BTreeMap<String, String>>, Box<dyn Error>> {
    let mut table = csv::Reader::from_path(path)?;
    let names: Vec<String> = table.headers()?.iter().map(str::to_owned).collect();
    let row = |record: csv::StringRecord| names.iter().cloned().zip(record.iter().map(str::to_owned)).collect();
    Ok(table.records().map(|record| record.map(row)).collect::<Result<_, _>>()?)
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row.get(column).and_then(|text| text.parse().ok()).unwrap_or(f64::NAN)
}

fn summary(folder: &Path) -> Result<Value, Box<dyn Error>> {
    Ok(serde_json::from_str(&fs::read_to_string(folder.join("out/summary.json"))?)?)
}

#[test]
fn curves_phase_resonance_and_modes_share_tables_and_figures() -> Outcome {
    let folder = tempdir()?;
    let text = ROD.to_owned()
        + r#"
[[response]]
kind = "frequency"
frequency_hz = [0.3, 0.6]
levels_n = [0.1, 0.2]
[[response]]
kind = "phase-resonance"
frequency_hz = [0.3, 0.6]
levels_n = [0.2]
[[response]]
kind = "damped-mode"
frequency_hz = [0.3, 0.6]
[[response]]
kind = "mode"
[continuation]
max_energy_ratio = 10.0
"#;
    let output = run(folder.path(), &text, &[])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let out = folder.path().join("out");
    let table = rows(out.join("branch.csv"))?;
    for (i, row) in table.iter().enumerate() {
        assert_eq!(row["point"], i.to_string());
        assert!(number(row, "frequency_hz") > 0.0 && number(row, "residual") < 1e-9);
        if row["kind"] == "frequency" || row["kind"] == "phase-resonance" {
            let (input, lost) = (number(row, "input_power_w"), number(row, "dissipated_power_w"));
            assert!((input / lost - 1.0).abs() < 1e-11, "{row:?}");
            assert!(row["force_n"] == row["level"] && number(row, "drive_fundamental_m") > 0.0);
            let pbmif = number(row, "pbmif");
            assert!((0.0..=1.0 + 1e-12).contains(&pbmif), "{pbmif}");
        }
        if row["kind"] == "damped-mode" {
            // ξ = P/2E, D = ξ/2ω.
            let power = number(row, "dissipated_power_w") / (2.0 * number(row, "energy_j"));
            let ratio = power / (2.0 * number(row, "frequency_hz") * std::f64::consts::TAU);
            assert!((ratio / number(row, "damping_ratio") - 1.0).abs() < 1e-10);
            assert!(number(row, "force_n") > 0.0 && row["level"].is_empty());
        }
    }
    // Phase resonance at 0.2: 0.4400260004 with all harmonics.
    let summary = summary(folder.path())?;
    let found = &summary["curves"][2]["phase_resonances"];
    let at: Vec<f64> = found
        .as_array()
        .ok_or("no list")?
        .iter()
        .filter(|p| p["level"] == 0.2)
        .filter_map(|p| p["frequency_hz"].as_f64())
        .collect();
    assert!(matches!(at[..], [f] if (f - 0.4400260004).abs() < 1e-6), "{at:?}");
    assert!(summary["curves"].as_array().ok_or("no list")?.iter().all(|c| c["end"]["complete"] == true));
    let events: Vec<&Value> = summary["curves"][1]["events"].as_array().ok_or("no list")?.iter().collect();
    assert_eq!(events.iter().filter(|e| e["events"].to_string().contains("fold")).count(), 2, "{events:?}");
    // Two stops have two rows per point; here there is one.
    assert_eq!(rows(out.join("contacts.csv"))?.len(), table.len());
    for name in
        ["responses.svg", "phase.svg", "contact_force.svg", "damping_ratio.svg", "force_needed.svg", "drive.svg"]
    {
        assert!(fs::read_to_string(out.join(name))?.starts_with("<svg"), "{name}");
    }
    let page = fs::read_to_string(out.join("report.html"))?;
    assert!(page.contains("0.2 N") && page.contains("damped mode") && page.contains("Phase resonances at the levels"));
    assert!(out.join("harmonics.npz").exists() && out.join("run.json").exists());
    Ok(())
}

/// Pictures and histories are those of the level with the largest contact force, not of a first one without contact.
#[test]
fn the_level_with_the_largest_contact_force_is_pictured() -> Outcome {
    let folder = tempdir()?;
    let response = "[[response]]\nkind = \"frequency\"\nfrequency_hz = [0.3, 0.6]\nlevels_n = [0.001, 0.2]\n";
    run(folder.path(), &(ROD.replace("harmonics = 20", "harmonics = 5") + response), &[])?;
    for name in ["contacts.svg", "history_P1.svg"] {
        assert!(folder.path().join("out").join(name).exists(), "{name}");
    }
    assert!(fs::read_to_string(folder.path().join("out/contacts.svg"))?.contains("0.2 N"));
    Ok(())
}

#[test]
fn a_scene_on_one_response_is_the_same_with_one_bracket_or_two() -> Outcome {
    let mut tables = Vec::new();
    for heading in ["[response]", "[[response]]"] {
        let folder = tempdir()?;
        let text = format!("{ROD}\n{heading}\nkind = \"force\"\nfrequency_hz = 0.42\nlevels_n = [0.3]\n");
        let output = run(folder.path(), &text, &["--quiet", "--set", "method.harmonics=5"])?;
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        tables.push(fs::read_to_string(folder.path().join("out/branch.csv"))?);
        assert!(folder.path().join("out/force_response.svg").exists());
    }
    assert_eq!(tables[0], tables[1]);
    Ok(())
}

#[test]
fn a_base_that_shakes_moves_a_rod_as_a_force_on_all_its_mass_does() -> Outcome {
    // Without contact, with given ü: u = −(K − ω²M)⁻¹ M r at the tip of two elements with their mass.
    let folder = tempdir()?;
    let text = ROD
        .replace("[[force]]\nat_m = 0.5", "[base_motion]\namplitude_m = 1e-3")
        .replace("gap_m = 1.0", "gap_m = 10.0")
        + "\n[response]\nkind = \"force\"\nfrequency_hz = 0.1\n";
    let output = run(folder.path(), &text, &["--quiet", "--set", "damping.ratio=0.0"])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let table = rows(folder.path().join("out/branch.csv"))?;
    let last = table.last().ok_or("no point")?;
    // Tip dropped: only the middle node has mass, 4m of its elements, and m that couples it to the base.
    let (l, w) = (0.5_f64, 0.1 * std::f64::consts::TAU);
    let (k, m) = (1.0 / l, l / 6.0);
    // The tip follows the middle statically: K of the middle is k.
    let exact = 1e-3 * w * w * (4.0 * m + m) / (k - w * w * 4.0 * m);
    assert!((number(last, "fundamental_m") / exact - 1.0).abs() < 1e-9, "{} {exact}", last["fundamental_m"]);
    assert_eq!(number(last, "level"), 1e-3);
    assert!(last["force_n"].is_empty() && number(last, "base_amplitude_m") == 1e-3);
    Ok(())
}

#[test]
fn templates_and_scenes_that_come_along_are_sound() -> Outcome {
    let folder = tempdir()?;
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let template = folder.path().join("mine.toml");
    let written = Command::cargo_bin("nlmodes-cli")?.args(["new", "response"]).arg(&template).output()?;
    assert_eq!(written.status.code(), Some(0));
    let own = ["beam_responses", "beam_base_motion", "tube_support"]
        .map(|name| workspace.join(format!("configs/{name}.toml")));
    for scene in own.iter().chain([&template]) {
        let output = Command::cargo_bin("nlmodes-cli")?.arg("check").arg(scene).output()?;
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.contains("response 0") && text.contains("damping"), "{text}");
    }
    Ok(())
}

#[test]
fn a_curve_that_ends_early_is_said_and_the_rest_is_there() -> Outcome {
    let folder = tempdir()?;
    let text = format!(
        "{ROD}\n[response]\nkind = \"frequency\"\nfrequency_hz = [0.3, 0.6]\nlevels_n = \
         [0.2]\n[continuation]\nmax_points = 20\n"
    );
    let output = run(folder.path(), &text, &["--set", "method.harmonics=5"])?;
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("20 points"), "{}", said(&output));
    // From the upper end too, which it did not reach.
    assert!(said(&output).contains("0.2 N, from the upper end: 20 points"), "{}", said(&output));
    assert_eq!(rows(folder.path().join("out/branch.csv"))?.len(), 40);
    let curves = &summary(folder.path())?["curves"];
    assert_eq!([0, 1].map(|k| curves[k]["end"]["reason"].as_str()), [Some("max-points"); 2], "{curves}");
    Ok(())
}

/// A command for nonlinear modes rejects responses instead of computing something else.
#[test]
fn compare_refuses_responses() -> Outcome {
    let folder = tempdir()?;
    let response = "[[response]]\nkind = \"frequency\"\nfrequency_hz = [0.2, 0.3]\nlevels_n = [0.01]\n";
    let output = run(folder.path(), &format!("{ROD}{response}"), &["--quiet"])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let refused =
        Command::cargo_bin("nlmodes-cli")?.args(["compare", "scene.toml"]).current_dir(folder.path()).output()?;
    assert_eq!(refused.status.code(), Some(2));
    assert!(said(&refused).contains("not on responses"), "{}", said(&refused));
    Ok(())
}

/// There is a warning about neglected effects and about ineffective keys.
#[test]
fn dashpots_beyond_the_modes_and_keys_without_effect_are_said() -> Outcome {
    let folder = tempdir()?;
    let dashpot = |at: &str| format!("[[damping.dashpot]]\nat_m = {at}\ndamping_n_s_m = 0.1\n[[force]]");
    let response = "[[response]]\nkind = \"frequency\"\nfrequency_hz = [0.2, 0.3]\nlevels_n = [0.01]\n";
    for (at, is_told) in [("1.0", true), ("0.5", false)] {
        let text = ROD
            .replacen("[[force]]", &dashpot(at), 1)
            .replace("harmonics = 20", "harmonics = 3\nheld_modes = 1\nsymmetry = \"none\"");
        let output = run(folder.path(), &format!("{text}{response}"), &["--force"])?;
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        assert_eq!(
            said(&output).contains("dashpot 0: its force bends the structure beyond the modes"),
            is_told,
            "{}",
            said(&output)
        );
        for key in ["held_modes", "symmetry"] {
            assert!(said(&output).contains(&format!("`method.{key}` has no effect on responses")), "{}", said(&output));
        }
        let checks = summary(folder.path())?["certificate"]["checks"].clone();
        let check = |name: &str| checks.as_array().into_iter().flatten().find(|check| check["name"] == name);
        let value = |name: &str| check(name).and_then(|check| check["value"].as_f64());
        // What the dashpot moves beyond the modes is some of the displacement, or nothing.
        assert_eq!(value("dashpots").ok_or("dashpots")? > 1e-2, is_told);
        // There is only one mode; its mass at the stop is left out.
        assert!(value("modes") == Some(0.0) && value("contact mass") > Some(0.01), "{checks}");
    }
    Ok(())
}
