//! Scenes with responses: tables, figures, ends, and what is said.

use std::collections::BTreeMap;
use std::error::Error;
use std::f64::consts::TAU;
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
    // Two stops of one scene have two rows a point; here one.
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
    // Far from the stop, ü given: u = −(K − ω²M)⁻¹ M r at the tip of two elements with their mass.
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
        "{ROD}\n[response]\nkind = \"frequency\"\nfrequency_hz = [0.3, 0.6]\nlevels_n = [0.2]\n[continuation]\nmax_points = 20\n"
    );
    let output = run(folder.path(), &text, &["--set", "method.harmonics=5"])?;
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("20 points"), "{}", said(&output));
    assert_eq!(rows(folder.path().join("out/branch.csv"))?.len(), 20);
    assert_eq!(summary(folder.path())?["curves"][0]["end"]["reason"], "max-points");
    Ok(())
}

/// NLvib's third example with less damping, the spring before the first mass as a stop whose node has no mass.
const MASSES: &str = r#"
[structure]
kind = "matrices"
stiffness = "k.mtx"
mass = "m.mtx"
dofs = "dofs.csv"
[[contact]]
node = 3
normal = [1.0, 0.0, 0.0]
gap_m = 1.0
[reduction]
modes = 2
[damping]
rayleigh = { stiffness_s = 0.01 }
[[force]]
node = 2
direction = [1.0, 0.0, 0.0]
[[response]]
kind = "phase-resonance"
frequency_hz = [0.06, 0.19]
levels_n = [0.35]
[[response]]
kind = "frequency"
frequency_hz = [0.06, 0.19]
levels_n = [0.2]
[method]
harmonics = 8
[output]
stability = "never"
"#;

/// The same example as it is, as a rod of two lumped elements: masses of 1 kg on springs of 1 N/m, a spring of 100 N/m before the tip.
const LUMPS: &str = r#"
[structure]
kind = "rod"
length_m = 2.0
elements = 2
mass_matrix = "lumped"
start = "clamped"
end = "free"
material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }
section = { area_m2 = 1.0 }
[[structure.mass_point]]
at_m = 2.0
mass_kg = 0.5
[[contact]]
at_m = 2.0
direction = "axial"
side = "positive"
gap_m = 1.0
stiffness_n_m = 100.0
[damping]
rayleigh = { stiffness_s = 0.03 }
[[force]]
at_m = 1.0
direction = "axial"
[[response]]
kind = "frequency"
frequency_hz = [0.09, 0.1195547349434]
levels_n = [0.1]
[method]
kind = "hbm"
harmonics = 63
[output]
stability = "never"
figures = false
page = false
"#;

#[test]
fn a_structure_of_few_masses_before_an_elastic_stop_moves_in_all_its_modes() -> Outcome {
    let folder = tempdir()?;
    let out = run(folder.path(), LUMPS, &[])?;
    assert!(out.status.success(), "{}", said(&out));
    let branch = rows(folder.path().join("out/branch.csv"))?;
    // Below contact: `((1 + iγ) K − Ω²) q = f`, γ = 0.03 Ω, of two masses, by Cramer's rule.
    let omega = TAU * 0.09;
    let (gamma, square) = (0.03 * omega, omega * omega);
    let free = (1.0 - square, gamma);
    // (a + iγ)(b + 2iγ) − (1 + iγ)² with a = 1 − Ω², b = 2 − Ω²
    let real = free.0 * (2.0 - square) - 2.0 * gamma * gamma - (1.0 - gamma * gamma);
    let imaginary = gamma * (2.0 * free.0 + 2.0 - square - 2.0);
    let linear = 0.1 * free.0.hypot(free.1) / real.hypot(imaginary);
    assert!((number(&branch[0], "drive_fundamental_m") / linear - 1.0).abs() < 1e-9, "{linear}");
    // With 63 harmonics by other code, next to its peak; exact are 0.9363056809.
    let peak = branch.iter().map(|row| number(row, "drive_fundamental_m")).fold(0.0, f64::max);
    assert!((peak / 0.9363067661 - 1.0).abs() < 1e-7, "{peak}");
    Ok(())
}

#[test]
fn a_detached_curve_is_followed_from_a_phase_resonance_and_named() -> Outcome {
    let folder = tempdir()?;
    let header = "%%MatrixMarket matrix coordinate real symmetric\n";
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text);
    write("k.mtx", &format!("{header}3 3 5\n1 1 101\n2 1 -1\n2 2 2\n3 1 -100\n3 3 100\n"))?;
    write("m.mtx", &format!("{header}3 3 2\n1 1 1\n2 2 1\n"))?;
    write("dofs.csv", "1,1,ux\n2,2,ux\n3,3,ux\n")?;
    let output = run(folder.path(), MASSES, &[])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let rows = rows(folder.path().join("out/branch.csv"))?;
    let detached: Vec<_> = rows.iter().filter(|row| row["detached"] == "true").collect();
    assert!(detached.len() > 20 && detached.iter().all(|row| row["name"] == "0.2 N, detached"));
    // Around the two resonances that the curve from the ends of the window does not reach.
    let frequencies = detached.iter().map(|row| std::f64::consts::TAU * number(row, "frequency_hz"));
    let (low, high) = frequencies.fold((f64::INFINITY, 0.0_f64), |(low, high), w| (low.min(w), high.max(w)));
    assert!((low - 0.783).abs() < 0.004 && (high - 0.8136).abs() < 0.004, "{low} {high}");
    assert!(summary(folder.path())?.to_string().contains("the curve is closed"));
    Ok(())
}

/// The rod of two elements with 2 % and a force of 12 in time, `q̈ = 3 (12 cos Ωt − 2q − 2 (q − 1)⁺) − 2ζω q̇` with `ω² = 6`: amplitude of its middle at the frequency of
/// the load, of motions of twice its period to which it comes from a state.
fn settled(hertz: f64, mut state: [f64; 2]) -> f64 {
    let (omega, damping) = (TAU * hertz, 0.04 * 6.0_f64.sqrt());
    let rate = |t: f64, [q, v]: [f64; 2]| {
        let force = 12.0 * (omega * t).cos() - 2.0 * q - 2.0 * (q - 1.0).max(0.0);
        [v, 3.0 * force - damping * v]
    };
    let along = |x: [f64; 2], k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
    let (steps, periods) = (400, 160);
    let h = TAU / omega / f64::from(steps);
    let mut sum = [0.0; 2];
    for j in 0..steps * periods {
        let t = h * f64::from(j);
        if j >= steps * (periods - 2) {
            let (sin, cos) = (omega * t).sin_cos();
            sum = along(sum, [cos, sin], state[0] / f64::from(steps));
        }
        let a = rate(t, state);
        let b = rate(t + 0.5 * h, along(state, a, 0.5 * h));
        let c = rate(t + 0.5 * h, along(state, b, 0.5 * h));
        let d = rate(t + h, along(state, c, h));
        state = [0, 1].map(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    sum[0].hypot(sum[1])
}

#[test]
fn a_scene_comes_to_motions_of_twice_the_period_that_are_those_of_an_integration_in_time() -> Outcome {
    let folder = tempdir()?;
    let text = ROD.replace("ratio = 0.01", "ratio = 0.02")
        + "[response]\nkind = \"frequency\"\nfrequency_hz = [0.75, 0.95]\nlevels_n = [12.0]\nsubharmonic = 2\n";
    let output = run(folder.path(), &text, &[])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let rows = rows(folder.path().join("out/branch.csv"))?;
    let of = |curve: &'static str| rows.iter().filter(move |row| row["curve"] == curve);
    let doublings: Vec<f64> =
        of("0").filter(|row| row["event"].contains("period-doubling")).map(|row| number(row, "frequency_hz")).collect();
    assert_eq!(doublings.len(), 2);
    let doubled: Vec<_> = of("1").collect();
    let ends = [doubled.first(), doubled.last()].map(|row| row.map_or(f64::NAN, |row| number(row, "frequency_hz")));
    assert!(ends.iter().zip(&doublings).all(|(end, at)| (end / at - 1.0).abs() < 1e-3), "{ends:?} {doublings:?}");
    for wanted in [0.81, 0.84, 0.87] {
        let off = |row: &&&BTreeMap<String, String>| (number(row, "frequency_hz") - wanted).abs();
        let stable = doubled.iter().filter(|row| row["stable"] == "true");
        let row = stable.min_by(|a, b| off(a).total_cmp(&off(b))).ok_or("no stable motion")?;
        for state in [[0.0, 0.0], [-2.0, 0.0], [0.0, 5.0]] {
            let amplitude = settled(number(row, "frequency_hz"), state);
            let found = number(row, "drive_fundamental_m");
            assert!((amplitude / found - 1.0).abs() < 1e-4, "{wanted} {state:?}: {amplitude} {found}");
        }
    }
    Ok(())
}

#[test]
fn the_damper_of_a_stop_takes_power_and_adds_to_the_damping_of_the_mode() -> Outcome {
    let ratio = |stop: &str| -> Result<f64, Box<dyn Error>> {
        let folder = tempdir()?;
        let text = ROD.replace("gap_m = 1.0", &format!("gap_m = 1.0\n{stop}"))
            + "[continuation]\nmax_energy_ratio = 10.0\n[[response]]\nkind = \"damped-mode\"\n\
               [[response]]\nkind = \"frequency\"\nfrequency_hz = [0.35, 0.5]\nlevels_n = [0.2]\n";
        let output = run(folder.path(), &text, &[])?;
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let rows = rows(folder.path().join("out/branch.csv"))?;
        for row in rows.iter().filter(|row| row["kind"] == "frequency") {
            let balance = number(row, "input_power_w") / number(row, "dissipated_power_w") - 1.0;
            assert!(balance.abs() < 1e-12, "{balance:e}");
        }
        let mode = rows.iter().rfind(|row| row["kind"] == "damped-mode").ok_or("no mode")?;
        Ok(number(mode, "damping_ratio"))
    };
    let (elastic, dissipating) = (ratio("stiffness_n_m = 3.0")?, ratio("stiffness_n_m = 3.0\ndamping_n_s_m = 0.5")?);
    assert!(elastic < 0.011 && dissipating > 1.5 * elastic, "{elastic} {dissipating}");
    Ok(())
}

/// What follows nonlinear modes says so of responses, and does not follow something else.
#[test]
fn verify_and_compare_refuse_responses() -> Outcome {
    let folder = tempdir()?;
    let response = "[[response]]\nkind = \"frequency\"\nfrequency_hz = [0.2, 0.3]\nlevels_n = [0.01]\n";
    let output = run(folder.path(), &format!("{ROD}{response}"), &["--quiet"])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    for (arguments, text) in [
        (["verify", "out", "--point", "1"].as_slice(), "these are responses"),
        (&["compare", "scene.toml"], "not on responses"),
    ] {
        let refused = Command::cargo_bin("nlmodes-cli")?.args(arguments).current_dir(folder.path()).output()?;
        assert_eq!(refused.status.code(), Some(2));
        assert!(said(&refused).contains(text), "{}", said(&refused));
    }
    Ok(())
}

/// What the equations leave out, and what a scene says in vain, is told.
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
        let outcome = |name: &str| {
            let check = checks.as_array().into_iter().flatten().find(|check| check["name"] == name);
            check.map(|check| check["outcome"].clone())
        };
        assert_eq!(outcome("dashpots"), Some(Value::from(if is_told { "doubtful" } else { "good" })));
        // The only mode is all there is; its mass at the stop is left out.
        assert_eq!((outcome("modes"), outcome("contact mass")), (Some("good".into()), Some("doubtful".into())));
    }
    Ok(())
}
