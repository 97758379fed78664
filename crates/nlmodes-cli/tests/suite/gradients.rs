//! `[[sensitivity]]` from the command line: columns, figures and page, against differences of whole runs.

use std::collections::HashMap;
use std::error::Error;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

/// A cantilever with a point mass and a spring before two stops, an elastic one at its tip.
const BEAM: &str = "[structure]\nkind = \"beam\"\nlength_m = 0.5\nelements = 8\nstart = \"clamped\"\n\
    material = { youngs_modulus_gpa = 210.0, density_kg_m3 = 7800.0, poissons_ratio = 0.3 }\n\
    section = { width_mm = 20.0, height_mm = 6.0 }\n\
    [[structure.mass_point]]\nat_m = 0.25\nmass_kg = 0.05\n\
    [[structure.spring]]\nat_m = 0.375\ndirection = \"transverse\"\nstiffness_n_m = 800.0\n\
    [[contact]]\nat_m = 0.5\ndirection = \"transverse\"\nside = \"positive\"\ngap_mm = 1.0\nstiffness_n_m = 2e4\n\
    [[contact]]\nat_m = 0.375\ndirection = \"transverse\"\nside = \"negative\"\ngap_mm = 0.7\n\
    [method]\nharmonics = 5\n[output]\nstability = \"never\"\n";

const MODE: &str = "[continuation]\nmax_energy_ratio = 4.0\n";

const FORCE: &str = "[damping]\nratio = 0.01\n[[force]]\nat_m = 0.125\ndirection = \"transverse\"\namplitude_n = 8.0\n\
    [[response]]\nkind = \"frequency\"\nfrequency_hz = [12.0, 26.0]\n";

/// Keys with their values.
const KEYS: [(&str, f64); 10] = [
    ("contact.0.gap_mm", 1.0),
    ("contact.1.gap_m", 0.7e-3),
    ("contact.0.stiffness_n_m", 2e4),
    ("structure.material.youngs_modulus_gpa", 210.0),
    ("structure.material.density_kg_m3", 7800.0),
    ("structure.length_m", 0.5),
    ("structure.section.height_mm", 6.0),
    ("structure.mass_point.0.mass_kg", 0.05),
    ("structure.spring.0.stiffness_n_m", 800.0),
    ("structure.mass_point.0.at_m", 0.25),
];

/// Positions that move with the length.
const PLACES: [(&str, f64); 4] = [
    ("structure.mass_point.0.at_m", 0.25),
    ("structure.spring.0.at_m", 0.375),
    ("contact.0.at_m", 0.5),
    ("contact.1.at_m", 0.375),
];

fn with_keys(text: &str, keys: &[(&str, f64)]) -> String {
    keys.iter().fold(text.to_owned(), |text, (key, _)| text + &format!("[[sensitivity]]\nkey = \"{key}\"\n"))
}

/// Runs a scene in a folder of its own; the exit status and what was reported.
fn call(text: &str, more: &[String]) -> Result<(TempDir, Option<i32>, String), Box<dyn Error>> {
    let folder = tempdir()?;
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, text)?;
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    call.arg("run").arg(&scene).args(["--quiet", "--out", "out"]).current_dir(folder.path());
    more.iter().for_each(|set| _ = call.args(["--set", set]));
    let output = call.output()?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    Ok((folder, output.status.code(), said))
}

/// The rows of `branch.csv`, numbers by the names of columns.
fn rows(folder: &Path) -> Result<Vec<HashMap<String, f64>>, Box<dyn Error>> {
    let mut table = csv::Reader::from_path(folder.join("out/branch.csv"))?;
    let header = table.headers()?.clone();
    let number = |row: csv::StringRecord| {
        header.iter().zip(&row).map(|(name, cell)| (name.to_owned(), cell.parse().unwrap_or(f64::NAN))).collect()
    };
    table.records().map(|row| Ok(number(row?))).collect()
}

fn last_row(text: &str, more: &[String]) -> Result<(TempDir, HashMap<String, f64>), Box<dyn Error>> {
    let (folder, code, said) = call(text, more)?;
    assert_eq!(code, Some(0), "{said}");
    let last = rows(folder.path())?.pop().ok_or("no point")?;
    Ok((folder, last))
}

/// The overrides with a key times a factor.
fn changed(key: &str, value: f64, factor: f64, places: &[(&str, f64)]) -> Vec<String> {
    let own = format!("{key}={:?}", value * factor);
    let moved = places.iter().filter(|_| key == "structure.length_m");
    std::iter::once(own).chain(moved.map(|(place, at)| format!("{place}={:?}", at * factor))).collect()
}

fn grazing_energy(text: &str, more: &[String]) -> Result<f64, Box<dyn Error>> {
    let short = [more, &["continuation.max_energy_ratio=1.01".to_owned()]].concat();
    let (folder, code, said) = call(text, &short)?;
    assert_eq!(code, Some(0), "{said}");
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("out/summary.json"))?)?;
    Ok(summary["grazing"]["energy_j"].as_f64().ok_or("no energy")?)
}

/// Relative steps of a difference of runs: next to a resonance responses bend more.
const STEP: f64 = 1e-4;
const OF_RESPONSE: f64 = 5e-5;

#[test]
fn gradients_of_a_beam_between_two_stops_are_those_of_runs_that_end_at_the_same_energy() -> Outcome {
    let text = format!("{BEAM}figures = true\n{MODE}");
    let own = grazing_energy(&text, &[])?;
    let ratio = |energy: f64| format!("continuation.max_energy_ratio={:?}", 4.0 * own / energy);
    let (folder, base) = last_row(&with_keys(&text, &KEYS), &[ratio(own)])?;
    for file in ["gradients_1.svg", "gradients_2.svg"] {
        assert!(folder.path().join("out").join(file).is_file(), "{file}");
    }
    let page = fs::read_to_string(folder.path().join("out/report.html"))?;
    assert!(page.contains("Gradients by the parameters of the scene"));
    let plain = format!("{BEAM}figures = false\npage = false\n{MODE}");
    for (key, value) in KEYS {
        let end = |factor: f64| -> Result<HashMap<String, f64>, Box<dyn Error>> {
            let set = changed(key, value, factor, &PLACES);
            let energy = grazing_energy(&plain, &set)?;
            Ok(last_row(&plain, &[set, vec![ratio(energy)]].concat())?.1)
        };
        let (above, below) = (end(1.0 + STEP)?, end(1.0 - STEP)?);
        for (name, of) in [
            ("frequency", "frequency_hz"),
            ("amplitude", "fundamental_m"),
            ("peak", "peak_m"),
            ("peak_force", "peak_contact_force_n"),
            ("impulse", "impulse_ns"),
        ] {
            let difference = (above[of].abs() - below[of].abs()) / (2.0 * STEP * value);
            let gradient = base[&format!("d_{name}_d_{key}")];
            let size = difference.abs().max(1e-2 * base[of].abs() / value);
            let error = (gradient - difference).abs() / size;
            // The mesh bends with a position over the length of an element: differences of runs err by more.
            let allowed = if key.ends_with("at_m") { 1e-5 } else { 2e-6 };
            assert!(error < allowed, "{key}, {name}: {gradient} by gradient, {difference}, {error:.1e}");
        }
    }
    Ok(())
}

#[test]
fn gradients_of_a_response_are_those_of_runs_that_end_at_the_same_frequency() -> Outcome {
    let text = format!("{BEAM}figures = false\npage = false\n{FORCE}");
    let more = [("damping.ratio", 0.01), ("force.0.amplitude_n", 8.0)];
    let keys: Vec<(&str, f64)> = KEYS.iter().chain(&more).copied().collect();
    let places: Vec<(&str, f64)> = PLACES.iter().chain(&[("force.0.at_m", 0.125)]).copied().collect();
    let (_folder, base) = last_row(&with_keys(&text, &keys), &[])?;
    assert!(base["peak_contact_force_n"] > 0.0);
    for (key, value) in keys {
        let end = |factor: f64| last_row(&text, &changed(key, value, factor, &places)).map(|(_, row)| row);
        let (above, below) = (end(1.0 + OF_RESPONSE)?, end(1.0 - OF_RESPONSE)?);
        for (name, of) in [
            ("amplitude", "fundamental_m"),
            ("peak", "peak_m"),
            ("peak_force", "peak_contact_force_n"),
            ("impulse", "impulse_ns"),
        ] {
            let difference = (above[of] - below[of]) / (2.0 * OF_RESPONSE * value);
            let gradient = base[&format!("d_{name}_d_{key}")];
            let error = (gradient - difference).abs() / difference.abs().max(1e-2 * base[of].abs() / value);
            assert!(error < 2e-6, "{key}, {name}: {gradient} by gradient, {difference}, {error:.1e}");
        }
    }
    Ok(())
}

/// At the rows with the largest amplitude and the largest contact force the derivatives are those of these maxima,
/// which lie between the steps of a curve and move in frequency with most parameters.
#[test]
fn gradients_of_a_peak_are_those_of_the_peaks_of_other_runs() -> Outcome {
    let keys = [
        ("contact.0.gap_mm", 1.0),
        ("structure.section.height_mm", 6.0),
        ("structure.material.youngs_modulus_gpa", 210.0),
        ("damping.ratio", 0.01),
        ("response.levels_n.0", 8.0),
    ];
    let force = FORCE.replace("amplitude_n = 8.0\n", "") + "levels_n = [8.0]\n";
    let text = with_keys(&format!("{BEAM}figures = false\npage = false\n{force}"), &keys);
    let largest = |rows: &[HashMap<String, f64>], of: &str| -> Result<HashMap<String, f64>, Box<dyn Error>> {
        Ok(rows.iter().max_by(|a, b| a[of].total_cmp(&b[of])).ok_or("no rows")?.clone())
    };
    let run = |more: &[String]| -> Result<Vec<HashMap<String, f64>>, Box<dyn Error>> {
        let (folder, code, said) = call(&text, more)?;
        assert_eq!(code, Some(0), "{said}");
        rows(folder.path())
    };
    let base = run(&[])?;
    for (key, value) in keys {
        let set = key.replace("response.levels", "response.0.levels");
        let end = |factor: f64| run(&[format!("{set}={:?}", value * factor)]);
        let (above, below) = (end(1.0 + STEP)?, end(1.0 - STEP)?);
        for (name, of) in [("amplitude", "fundamental_m"), ("peak_force", "peak_contact_force_n")] {
            let difference = (largest(&above, of)?[of] - largest(&below, of)?[of]) / (2.0 * STEP * value);
            let own = largest(&base, of)?;
            let gradient = own[&format!("d_{name}_d_{key}")];
            let error = (gradient - difference).abs() * value / own[of];
            assert!(error < 1e-6, "{key}, {name}: {gradient} by gradient, {difference}, {error:.1e}");
        }
    }
    Ok(())
}

#[test]
fn what_has_no_gradient_is_refused_by_name() -> Outcome {
    let cases: [(&str, &str, &str); 6] = [
        ("method.harmonics", "", "is no parameter of the structure or its load"),
        ("contact.3.gap_m", "", "the scene does not write `contact.3.gap_m`"),
        ("structure.kind", "", "no single number"),
        ("contact.0.at_m", "", "cannot vary on both sides"),
        ("contact.0.gap_m", "method.mass_redistribution=drop", "free-interface"),
        ("contact.0.gap_m", "method.kind=shooting", "harmonics"),
    ];
    for (key, set, expected) in cases {
        let text = with_keys(&format!("{BEAM}{MODE}"), &[(key, 0.0)]);
        let more: Vec<String> = [set].iter().filter(|set| !set.is_empty()).map(|set| (*set).to_owned()).collect();
        let (_folder, code, said) = call(&text, &more)?;
        assert!(code == Some(2) && said.contains(expected), "{key} {set}: {said}");
    }
    Ok(())
}
