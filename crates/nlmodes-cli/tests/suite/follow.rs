//! `nlmodes-cli follow`: folds, first touches and modes over a parameter, against single runs and closed forms.

use std::collections::HashMap;
use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;
type Row = HashMap<String, f64>;
/// Folder, exit status, standard output and standard error of a call.
type Called = (TempDir, Option<i32>, String, String);
/// Curves by their numbers, and what was printed.
type Curves = (Vec<Vec<Row>>, String);

/// A rod before an elastic stop, driven at its end.
const ROD: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 4
start = "clamped"
material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }
section = { area_m2 = 1e-4 }
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1e-3
stiffness_n_m = 3e7
[damping]
ratio = 0.02
[[force]]
at_m = 1.0
direction = "axial"
[response]
kind = "frequency"
frequency_hz = [1000.0, 2200.0]
levels_n = [2000.0]
[method]
harmonics = 3
[output]
figures = false
page = false
"#;

/// A beam with a point mass between two elastic stops.
const BEAM: &str = r#"
[structure]
kind = "beam"
length_m = 0.5
elements = 8
start = "clamped"
material = { youngs_modulus_gpa = 210.0, density_kg_m3 = 7800.0, poissons_ratio = 0.3 }
section = { width_mm = 20.0, height_mm = 6.0 }
[[structure.mass_point]]
at_m = 0.25
mass_kg = 0.05
[[contact]]
at_m = 0.5
direction = "transverse"
side = "positive"
gap_mm = 1.0
stiffness_n_m = 2e4
[[contact]]
at_m = 0.375
direction = "transverse"
side = "negative"
gap_mm = 0.7
stiffness_n_m = 1e4
[damping]
ratio = 0.01
[[force]]
at_m = 0.125
direction = "transverse"
[response]
kind = "frequency"
frequency_hz = [12.0, 26.0]
levels_n = [12.0]
[method]
harmonics = 5
[output]
figures = false
page = false
stability = "never"
"#;

fn rows(path: &Path) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut table = csv::Reader::from_path(path)?;
    let header = table.headers()?.clone();
    let number = |cell: &str| match cell {
        "true" => 1.0,
        "false" => 0.0,
        cell => cell.parse().unwrap_or(f64::NAN),
    };
    let row = |row: csv::StringRecord| header.iter().zip(&row).map(|(n, c)| (n.to_owned(), number(c))).collect();
    table.records().map(|record| Ok(row(record?))).collect()
}

fn call(text: &str, arguments: &[&str]) -> Result<Called, Box<dyn Error>> {
    let folder = tempdir()?;
    fs::write(folder.path().join("scene.toml"), text)?;
    let mut command = Command::cargo_bin("nlmodes-cli")?;
    command.args(arguments).arg("--out").arg("out").current_dir(folder.path());
    let output = command.output()?;
    let [said, told] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    Ok((folder, output.status.code(), said, told))
}

/// The curves over a parameter, by their numbers.
fn followed(text: &str, arguments: &[&str]) -> Result<Curves, Box<dyn Error>> {
    let (folder, code, said, told) = call(text, &[&["follow", "scene.toml"], arguments].concat())?;
    assert_eq!(code, Some(0), "{said}{told}");
    let mut curves: Vec<Vec<Row>> = Vec::new();
    for row in rows(&folder.path().join("out/follow.csv"))? {
        curves.resize(curves.len().max(row["curve"] as usize + 1), Vec::new());
        curves[row["curve"] as usize].push(row);
    }
    assert!(folder.path().join("out/follow_frequency.svg").is_file());
    Ok((curves, said))
}

/// Rows of a run with a value, in whose event a word occurs.
fn of_run(text: &str, set: &str, event: &str) -> Result<Vec<Row>, Box<dyn Error>> {
    let (folder, code, _, told) = call(text, &["run", "scene.toml", "--quiet", "--set", set])?;
    assert_eq!(code, Some(0), "{told}");
    let path = folder.path().join("out/branch.csv");
    let mut table = csv::Reader::from_path(&path)?;
    let at = table.headers()?.iter().position(|name| name == "event").ok_or("no events")?;
    let is: Vec<bool> = table.records().map(|row| row.map(|row| row[at].contains(event))).collect::<Result<_, _>>()?;
    Ok(rows(&path)?.into_iter().zip(is).filter_map(|(row, is)| is.then_some(row)).collect())
}

/// Points of a curve are events of single runs, and its slopes those between its points.
fn is_of_runs(text: &str, key: &str, window: [&str; 2], event: &str) -> Outcome {
    let of = if event == "fold" { "fold" } else { "touch" };
    let (curves, said) = followed(text, &["--of", of, "--over", key, "--from", window[0], "--to", window[1]])?;
    assert!(!curves.is_empty(), "{said}");
    for curve in &curves {
        for k in [0, curve.len() / 3, 2 * curve.len() / 3, curve.len() - 1] {
            let (row, set) = (&curve[k], format!("{key}={:?}", curve[k]["value"]));
            let found = of_run(text, &set, event)?;
            let off = |other: &Row| (row["frequency_hz"] / other["frequency_hz"] - 1.0).abs();
            let nearest = found.iter().min_by(|a, b| off(a).total_cmp(&off(b))).ok_or(format!("{set}: none"))?;
            assert!(off(nearest) < 1e-8, "{set}: {:.1e} of {}", off(nearest), row["frequency_hz"]);
            for name in ["fundamental_m", "peak_m", "peak_contact_force_n", "impulse_ns", "energy_j"] {
                let (own, other) = (row[name].abs(), nearest[name].abs());
                // Next to a first touch forces begin with the root of what is left.
                let size = other.max(if name.contains('n') { 1.0 } else { 0.0 });
                assert!((own - other).abs() < 1e-5 * size, "{set}, {name}: {own} {other}");
            }
            assert!(row["residual"] < 1e-9);
        }
        let slopes = curve.windows(3).filter(|w| w.iter().all(|row| row["turns"] == 0.0));
        for w in slopes {
            let [a, b, c] = [&w[0], &w[1], &w[2]].map(|row| (row["value"], row["frequency_hz"]));
            let [left, right] = [(b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0)];
            // The slope of the parabola through three points.
            let parabola = (left * (c.0 - b.0) + right * (b.0 - a.0)) / (c.0 - a.0);
            // What the parabola leaves, and what single solutions differ by.
            let allowed = 0.3 * (left - right).abs() + 1e-4 * left.abs() + 1e-6 * b.1 / b.0;
            let own = w[1]["d_frequency_d_value"];
            assert!((own - parabola).abs() < allowed, "{key} at {}: {own} {parabola}", b.0);
        }
    }
    Ok(())
}

#[test]
fn folds_over_gap_stiffness_damping_level_and_modulus_are_those_of_single_runs() -> Outcome {
    is_of_runs(ROD, "contact.0.gap_m", ["0.8e-3", "1.5e-3"], "fold")?;
    is_of_runs(ROD, "contact.0.stiffness_n_m", ["2e7", "4e7"], "fold")?;
    is_of_runs(ROD, "damping.ratio", ["0.015", "0.025"], "fold")?;
    is_of_runs(ROD, "response.levels_n.0", ["1500", "2500"], "fold")?;
    is_of_runs(ROD, "structure.material.youngs_modulus_pa", ["200e9", "220e9"], "fold")
}

#[test]
fn folds_of_a_beam_between_two_stops_are_those_of_single_runs() -> Outcome {
    is_of_runs(BEAM, "contact.0.gap_mm", ["0.9", "1.1"], "fold")?;
    is_of_runs(BEAM, "structure.mass_point.0.mass_kg", ["0.048", "0.052"], "fold")
}

#[test]
fn first_touches_are_those_of_single_runs() -> Outcome {
    is_of_runs(ROD, "contact.0.gap_m", ["0.8e-3", "1.2e-3"], "contact-change")?;
    is_of_runs(ROD, "structure.material.density_kg_m3", ["7700", "7900"], "contact-change")?;
    is_of_runs(BEAM, "contact.1.gap_mm", ["0.69", "0.71"], "contact-change")
}

#[test]
fn where_two_folds_meet_the_curve_turns_and_beyond_it_a_run_has_none() -> Outcome {
    let (curves, said) = followed(ROD, &["--over", "contact.0.gap_m", "--from", "0.5e-3", "--to", "3e-3"])?;
    // Both folds of the scene lie on it.
    assert_eq!(curves.len(), 1, "{said}");
    let turn = curves[0].iter().find(|row| row["turns"] == 1.0).ok_or("it does not turn")?;
    assert!(said.contains("turns at 0.00174"), "{said}");
    let folds = |gap: f64| of_run(ROD, &format!("contact.0.gap_m={gap:?}"), "fold").map(|rows| rows.len());
    assert_eq!([folds(0.999 * turn["value"])?, folds(1.001 * turn["value"])?], [2, 0]);
    // Both half-branches end at the same value, at the frequencies of the two folds there.
    let ends = [&curves[0][0], &curves[0][curves[0].len() - 1]];
    assert!(ends.iter().all(|row| row["value"] == 0.5e-3));
    assert!((ends[0]["frequency_hz"] - ends[1]["frequency_hz"]).abs() > 1.0);
    Ok(())
}

/// One mode of 1 kg on 10 N/m, with a stop on a spring, reduced elsewhere.
fn oscillator(harmonics: usize, more: &str) -> String {
    format!(
        r#"
[structure]
kind = "reduced"
frequencies_hz = [{:?}]
contact_rows = [[1.0]]
residual_flexibility_m_n = [[0.0]]
[[contact]]
row = 1
gap_m = 0.01
stiffness_n_m = 50.0
[method]
harmonics = {harmonics}
{more}"#,
        10f64.sqrt() / TAU
    )
}

/// Frequency (Hz) and averaged kinetic energy of the oscillator of Code_Aster's SDND122 with this total energy: a half
/// wave on the spring alone, then one on spring and stop.
fn closed_form(gap: f64, stop: f64, energy: f64) -> [f64; 2] {
    let (k, m): (f64, f64) = (10.0, 1.0);
    let [w, u] = [(k / m).sqrt(), ((k + stop) / m).sqrt()];
    let amplitude = (2.0 * energy / k).sqrt();
    let rest = stop * gap / (k + stop);
    let pressed = ((2.0 * energy - k * stop * gap * gap / (k + stop)) / (k + stop)).sqrt();
    // Half the phase of each part of the motion, from its turning point to the stop.
    let [free, closed] = [PI - (gap / amplitude).acos(), ((gap - rest) / pressed).acos()];
    let period = 2.0 * (free / w + closed / u);
    // ∫ m v²/2 dt with v = a w sin: m a² w (φ/2 − sin(2 φ)/4)/2 on each side.
    let kinetic = |a: f64, w: f64, phase: f64| 0.5 * m * a * a * w * (0.5 * phase - 0.25 * (2.0 * phase).sin());
    [1.0 / period, 2.0 * (kinetic(amplitude, w, free) + kinetic(pressed, u, closed)) / period]
}

/// The frequency at an averaged kinetic energy.
fn at_kinetic(gap: f64, stop: f64, kinetic: f64) -> f64 {
    let (mut low, mut high) = (0.5 * 10.0 * gap * gap * (1.0 + 1e-12), 1.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if closed_form(gap, stop, middle)[1] < kinetic { low = middle } else { high = middle }
    }
    closed_form(gap, stop, low)[0]
}

#[test]
fn a_mode_at_an_energy_over_gap_and_stiffness_is_the_closed_form_of_sdnd122() -> Outcome {
    let more = "[continuation]\nmax_energy_ratio = 30.0\n[output]\nstability = \"never\"\n";
    let scene = oscillator(40, more);
    let energy = 0.003;
    for (key, from, to, is_gap) in
        [("contact.0.gap_m", "0.006", "0.014", true), ("contact.0.stiffness_n_m", "20", "120", false)]
    {
        let (curves, said) =
            followed(&scene, &["--of", "mode", "--energy-j", "0.003", "--over", key, "--from", from, "--to", to])?;
        assert_eq!(curves.len(), 1, "{said}");
        assert!(curves[0].len() > 20);
        for row in &curves[0] {
            let exact =
                |value: f64| if is_gap { at_kinetic(value, 50.0, energy) } else { at_kinetic(0.01, value, energy) };
            let (value, found) = (row["value"], row["frequency_hz"]);
            let error = (found / exact(value) - 1.0).abs();
            assert!(error < 1e-8, "{key} = {value}: {found}, {error:.1e}");
            assert!((row["energy_j"] / energy - 1.0).abs() < 1e-9);
            let step = 1e-4 * value;
            let slope = (exact(value + step) - exact(value - step)) / (2.0 * step);
            let own = row["d_frequency_d_value"];
            assert!((own - slope).abs() < 2e-4 * slope.abs(), "{key} = {value}: slope {own} {slope}");
        }
    }
    Ok(())
}

/// The derivative at zero by differences of the fourth order.
fn slope(of: impl Fn(f64) -> f64, h: f64) -> f64 {
    (8.0 * (of(h) - of(-h)) - (of(2.0 * h) - of(-2.0 * h))) / (12.0 * h)
}

/// Gradients at the points of a branch, by gap and stiffness of the stop and by the frequency of the structure.
#[test]
fn gradients_of_sdnd122_are_those_of_its_closed_form() -> Outcome {
    let keys = ["contact.0.gap_m", "contact.0.stiffness_n_m", "structure.frequencies_hz.0"];
    let asked: String = keys.iter().map(|key| format!("[[sensitivity]]\nkey = \"{key}\"\n")).collect();
    let more = "[continuation]\nmax_energy_ratio = 12.0\n[output]\nstability = \"never\"\nfigures = false\n\
        page = false\n";
    let scene = oscillator(300, &(more.to_owned() + &asked));
    let (folder, code, _, told) = call(&scene, &["run", "scene.toml", "--quiet"])?;
    assert_eq!(code, Some(0), "{told}");
    let (mut seen, frequency) = (0, 10f64.sqrt() / TAU);
    // Next to the first touch the motion bends ever faster, and each digit takes more harmonics.
    for row in rows(&folder.path().join("out/branch.csv"))?.iter().filter(|row| row["energy_j"] > 5e-4) {
        let energy = row["energy_j"];
        let of: [(f64, &dyn Fn(f64) -> f64); 3] = [
            (0.01, &|gap| at_kinetic(gap, 50.0, energy)),
            (50.0, &|stop| at_kinetic(0.01, stop, energy)),
            // Other stiffness: the same motion in another unit of force.
            (frequency, &|hz| {
                let times = (hz / frequency).powi(2);
                times.sqrt() * at_kinetic(0.01, 50.0 / times, energy / times)
            }),
        ];
        for (key, (value, at)) in keys.iter().zip(of) {
            let h = 2e-3 * value;
            let slope = slope(|by| at(value + by), h);
            let error = (row[&format!("d_frequency_d_{key}")] / slope - 1.0).abs();
            assert!(error < 1e-9, "{key} at {energy} J: {error:.1e}");
        }
        seen += 1;
    }
    assert!(seen > 5, "{seen}");
    Ok(())
}

/// The same oscillator as a rod of one element, `k = E A/L`, `m = ρ A L/3`: gradients by what it is made of.
#[test]
fn gradients_of_sdnd122_by_modulus_density_area_and_length_are_those_of_its_closed_form() -> Outcome {
    let values = [
        ("structure.material.youngs_modulus_pa", 40.0),
        ("structure.material.density_kg_m3", 3.0),
        ("structure.section.area_m2", 0.5),
        ("structure.length_m", 2.0),
    ];
    let asked: String = values.iter().map(|(key, _)| format!("[[sensitivity]]\nkey = \"{key}\"\n")).collect();
    let scene = "[structure]\nkind = \"rod\"\nlength_m = 2.0\nelements = 1\nstart = \"clamped\"\n\
        material = { youngs_modulus_pa = 40.0, density_kg_m3 = 3.0 }\nsection = { area_m2 = 0.5 }\n\
        [[contact]]\nat_m = 2.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 0.01\nstiffness_n_m = 50.0\n\
        [method]\nharmonics = 300\n[continuation]\nmax_energy_ratio = 12.0\n\
        [output]\nstability = \"never\"\nfigures = false\npage = false\n";
    let (folder, code, _, told) = call(&(scene.to_owned() + &asked), &["run", "scene.toml", "--quiet"])?;
    assert_eq!(code, Some(0), "{told}");
    let mut seen = 0;
    for row in rows(&folder.path().join("out/branch.csv"))?.iter().filter(|row| row["energy_j"] > 5e-4) {
        // The same motion in other units of force and time.
        let at = |[e, rho, area, length]: [f64; 4]| {
            let (stiffness, mass) = (e * area / length / 10.0, rho * area * length / 3.0);
            (stiffness / mass).sqrt() * at_kinetic(0.01, 50.0 / stiffness, row["energy_j"] / stiffness)
        };
        let own = values.map(|(_, value)| value);
        assert!((row["frequency_hz"] / at(own) - 1.0).abs() < 1e-9, "{} Hz for {}", row["frequency_hz"], at(own));
        for (j, (key, value)) in values.iter().enumerate() {
            let h = 2e-3 * value;
            let moved = |by: f64| {
                let mut all = own;
                all[j] += by;
                at(all)
            };
            let slope = slope(moved, h);
            let error = (row[&format!("d_frequency_d_{key}")] - slope).abs() / (at(own) / value);
            assert!(error < 1e-9, "{key} at {} J: {error:.1e}", row["energy_j"]);
        }
        seen += 1;
    }
    assert!(seen > 5, "{seen}");
    Ok(())
}

#[test]
fn phase_resonances_over_gap_level_and_modulus_are_those_of_single_runs() -> Outcome {
    // Up to where the second stop is met the level grows along the curve.
    let text = BEAM.replace("kind = \"frequency\"", "kind = \"phase-resonance\"");
    let text = text.replace("[12.0, 26.0]\nlevels_n = [12.0]", "[12.0, 40.0]\nlevels_n = [2.0]");
    for (key, from, to) in [
        ("contact.0.gap_mm", "0.9", "1.1"),
        ("response.levels_n.0", "1.6", "2.4"),
        ("structure.material.youngs_modulus_gpa", "205", "215"),
        ("damping.ratio", "0.008", "0.012"),
    ] {
        let (curves, said) = followed(&text, &["--of", "resonance", "--over", key, "--from", from, "--to", to])?;
        assert_eq!(curves.len(), 1, "{said}");
        let [first, last] = [&curves[0][0], &curves[0][curves[0].len() - 1]];
        for (row, value) in [(first, from), (last, to)] {
            let set = key.replace("response.levels", "response.0.levels");
            let found = of_run(&text, &format!("{set}={value}"), "")?;
            let other = found.last().ok_or("no point")?;
            assert!((row["value"] - value.parse::<f64>()?).abs() < 1e-9 * row["value"], "{said}");
            for name in ["frequency_hz", "peak_m", "peak_contact_force_n", "impulse_ns"] {
                let off = (row[name] / other[name] - 1.0).abs();
                assert!(off < 1e-8, "{key} = {value}, {name}: {off:.1e} of {}", row[name]);
            }
        }
    }
    Ok(())
}

#[test]
fn first_touch_of_one_mass_is_where_its_linear_response_is_the_gap() -> Outcome {
    let more = "[damping]\nratio = 0.02\n[[force]]\nrow = 1\n\
        [response]\nkind = \"frequency\"\nfrequency_hz = [0.3, 0.9]\n\
        levels_n = [0.02]\n[output]\nstability = \"never\"\n";
    let scene = oscillator(5, more);
    let (curves, said) =
        followed(&scene, &["--of", "touch", "--over", "contact.0.gap_m", "--from", "0.005", "--to", "0.02"])?;
    assert_eq!(curves.len(), 2, "{said}");
    for row in curves.iter().flatten() {
        let w = TAU * row["frequency_hz"];
        let response = 0.02 / (10.0 - w * w).hypot(2.0 * 0.02 * 10f64.sqrt() * w);
        assert!((response / row["value"] - 1.0).abs() < 1e-8, "{}: {response}", row["value"]);
    }
    Ok(())
}

#[test]
fn what_cannot_be_followed_is_said() -> Outcome {
    let cases: [(&[&str], i32, &str); 7] = [
        (&["--over", "contact.0.gap_m", "--from", "2e-3", "--to", "3e-3"], 2, "outside of 0.002 to 0.003"),
        (&["--over", "contact.7.gap_m", "--from", "0.0", "--to", "3e-3"], 2, "does not write `contact.7.gap_m`"),
        (&["--over", "method.harmonics", "--from", "1", "--to", "9"], 2, "is no parameter of the structure"),
        (
            &["--over", "contact.0.gap_m", "--from", "0", "--to", "1", "--level", "7"],
            2,
            "has no level 7; its levels: 2000",
        ),
        (
            &["--of", "mode", "--energy-j", "1.0", "--over", "contact.0.gap_m", "--from", "0", "--to", "1"],
            2,
            "has responses",
        ),
        (&["--of", "mode", "--over", "contact.0.gap_m", "--from", "0", "--to", "1"], 2, "--energy-j"),
        (&["--of", "resonance", "--over", "contact.0.gap_m", "--from", "0", "--to", "1"], 2, "no phase resonance"),
    ];
    for (arguments, status, expected) in cases {
        let (_folder, code, _, told) = call(ROD, &[&["follow", "scene.toml"], arguments].concat())?;
        assert!(code == Some(status) && told.contains(expected), "{arguments:?}: {told}");
    }
    Ok(())
}
