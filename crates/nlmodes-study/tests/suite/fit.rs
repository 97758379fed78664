//! Variables from points of a curve that was computed with other values: found to the errors of the curve, with the
//! covariance of the stated deviations.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use nlmodes_run::Silent;
use nlmodes_study::{Evaluator, FitError, FitOutcome, Settings, Study, fit};
use serde_json::{Map, Value};

/// A beam before an elastic stop at phase resonance.
const BEAM: &str = r#"
[structure]
kind = "beam"
length_m = 0.6
elements = 4
start = "clamped"
material = { youngs_modulus_gpa = 200.0, density_kg_m3 = 7800.0, poissons_ratio = 0.3 }
section = { width_mm = 12.0, height_mm = 20.0 }
[[contact]]
at_m = 0.6
direction = "transverse"
side = "positive"
gap_mm = 1.0
stiffness_n_m = 2e4
[damping]
ratio = 0.006
[[force]]
at_m = 0.15
direction = "transverse"
[[response]]
kind = "phase-resonance"
levels_n = [40.0]
[method]
harmonics = 3
[output]
stability = "never"
"#;

/// Two masses on springs between two walls, from files; the second one before a stop.
const CHAIN: &str = r#"
[structure]
kind = "matrices"
stiffness = "k.mtx"
mass = "m.mtx"
dofs = "dofs.csv"
[[contact]]
node = 2
normal = [1.0, 0.0, 0.0]
gap_m = 1e-3
stiffness_n_m = 4e3
[damping]
rayleigh = { mass_1_s = 0.5, stiffness_s = 0.0 }
[response]
kind = "damped-mode"
[method]
harmonics = 5
[continuation]
max_energy_ratio = 40.0
[output]
stability = "never"
"#;

fn place(scene: &str) -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(place.path().join(name), text).unwrap();
    write("scene.toml", scene);
    let header = "%%MatrixMarket matrix coordinate real symmetric\n";
    write("k.mtx", &format!("{header}2 2 3\n1 1 2000.0\n2 1 -1000.0\n2 2 2500.0\n"));
    write("m.mtx", &format!("{header}2 2 2\n1 1 1.0\n2 2 0.7\n"));
    write("dofs.csv", "row,node,component\n0,1,1\n1,2,1\n");
    place
}

/// The study `text` of the scene at this place.
fn study(place: &Path, text: &str) -> Study {
    fs::write(place.join("study.toml"), text).unwrap();
    let mut study = Study::load(&place.join("study.toml")).map_err(|refused| refused.text(false)).unwrap().scene;
    study.directory = place.join("out");
    study
}

/// Every `nth` row of a run with other values, the columns and their deviations as a table of measured points.
fn measured(place: &Path, set: &[(&str, f64)], columns: &[(&str, Option<f64>)], rows: (f64, f64, usize)) {
    let vary: String = set.iter().map(|(key, v)| format!("[[vary]]\nkey = \"{key}\"\nvalues = [{v:?}]\n")).collect();
    let truth = study(place, &format!("scene = \"scene.toml\"\n{vary}"));
    let answer = Evaluator::new(truth.clone(), Settings::default()).evaluate(&values(set)).unwrap().unwrap();
    let path = truth.directory.join("cases").join(&answer.id).join("branch.csv");
    let mut table = csv::Reader::from_path(path).unwrap();
    let header = table.headers().unwrap().clone();
    let at = |name: &str| header.iter().position(|own| own == name).unwrap();
    let mut text = String::new();
    for (name, std) in columns {
        write!(text, "{}{name}", if text.is_empty() { "" } else { "," }).unwrap();
        std.iter().for_each(|_| write!(text, ",{name}_std").unwrap());
    }
    let (low, high, nth) = rows;
    let numbers: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    let within = |row: &&csv::StringRecord| (low..high).contains(&row[at(columns[0].0)].parse::<f64>().unwrap());
    for row in numbers.iter().filter(within).step_by(nth) {
        text.push('\n');
        for (k, (name, std)) in columns.iter().enumerate() {
            write!(text, "{}{}", if k == 0 { "" } else { "," }, &row[at(name)]).unwrap();
            std.iter().for_each(|std| write!(text, ",{std:?}").unwrap());
        }
    }
    fs::write(place.join("measured.csv"), text).unwrap();
}

fn values(set: &[(&str, f64)]) -> Map<String, Value> {
    set.iter().map(|(key, value)| ((*key).to_owned(), Value::from(*value))).collect()
}

fn fitted(place: &Path, over: &str, keys: &[(&str, f64)]) -> Result<(Study, FitOutcome), FitError> {
    let vary: String = keys.iter().map(|(key, _)| format!("[[vary]]\nkey = \"{key}\"\n")).collect();
    let text = format!("scene = \"scene.toml\"\n[fit]\nmeasured = \"measured.csv\"\nover = \"{over}\"\n{vary}");
    let study = study(place, &text);
    let found = fit(&study, &Settings::default(), &mut Silent)?;
    Ok((study, found))
}

/// The values come back to `error` of them.
fn come_back(found: &FitOutcome, truth: &[(&str, f64)], error: f64) {
    for (own, (key, value)) in found.parameters.iter().zip(truth) {
        assert_eq!(own.variable, *key);
        assert!((own.value / value - 1.0).abs() < error, "{key}: {} {value}", own.value);
    }
}

#[test]
fn gap_modulus_and_damping_of_a_beam_come_back_from_its_backbone_with_their_covariance() {
    let place = place(BEAM);
    let truth = [("contact.0.gap_mm", 1.1), ("structure.material.youngs_modulus_gpa", 195.0), ("damping.ratio", 0.005)];
    let deviations = [0.02, 2e-5];
    let columns = |factor: f64| {
        [
            ("level", None),
            ("frequency_hz", Some(deviations[0] * factor)),
            ("fundamental_m", Some(deviations[1] * factor)),
        ]
    };
    measured(place.path(), &truth, &columns(1.0), (5.0, 30.0, 4));
    let (study, found) = fitted(place.path(), "level", &truth).unwrap();
    come_back(&found, &truth, 2e-5);
    assert!(found.chi_squared < 1e-2 && found.degrees_of_freedom + 3 == found.points.len(), "{found}");
    assert!(found.probability.unwrap() > 0.99 && found.deviations_are_stated);
    found.write(&study).unwrap();
    for file in ["fit.json", "fit.csv", "fit_frequency_hz.svg", "fit_fundamental_m.svg"] {
        assert!(study.directory.join(file).is_file(), "{file}");
    }
    // The covariance by differences of curves with other values, of which the rows are points.
    let steps = [1e-2, 1e-2, 1e-2];
    let places: Vec<f64> = found.points.iter().map(|row| row.place).collect();
    let quantities: String = found
        .points
        .iter()
        .enumerate()
        .map(|(k, row)| {
            format!("[[quantity]]\nname = \"q{k}\"\nof = \"{}\"\nat = {{ level = {:?} }}\n", row.column, places[k])
        })
        .collect();
    let other = self::study(
        place.path(),
        &format!("scene = \"scene.toml\"\n[[vary]]\nkey = \"damping.ratio\"\nvalues = [0.005]\n{quantities}"),
    );
    let at = |k: usize, factor: f64| -> Vec<f64> {
        let mut set = truth;
        set[k].1 *= factor;
        let answer = Evaluator::new(other.clone(), Settings::default()).evaluate(&values(&set)).unwrap().unwrap();
        (0..found.points.len()).map(|k| answer.quantities[&format!("q{k}")].as_f64().unwrap()).collect()
    };
    let column = |k: usize| -> Vec<f64> {
        let (plus, minus) = (at(k, 1.0 + steps[k]), at(k, 1.0 - steps[k]));
        let rows = plus.iter().zip(&minus).zip(&found.points);
        rows.map(|((plus, minus), row)| (plus - minus) / (2.0 * steps[k] * truth[k].1) / row.std.unwrap()).collect()
    };
    let columns_of: Vec<Vec<f64>> = (0..3).map(column).collect();
    let normal = |i: usize, j: usize| columns_of[i].iter().zip(&columns_of[j]).map(|(a, b)| a * b).sum::<f64>();
    for i in 0..3 {
        for j in 0..3 {
            let product: f64 = (0..3).map(|k| found.covariance[i][k] * normal(k, j)).sum();
            let size = (found.covariance[i][i] * normal(j, j)).sqrt();
            assert!((product - f64::from(u8::from(i == j))).abs() < 2e-2 * size, "{i} {j}: {product} {size}");
        }
    }
    // Twice the deviations, twice the deviations of the values.
    measured(place.path(), &truth, &columns(2.0), (5.0, 30.0, 4));
    let (_, coarse) = fitted(place.path(), "level", &truth).unwrap();
    for (fine, coarse) in found.parameters.iter().zip(&coarse.parameters) {
        assert!((coarse.std / fine.std - 2.0).abs() < 1e-3, "{} {}", coarse.std, fine.std);
    }
}

#[test]
fn stiffness_gap_and_damping_of_matrices_come_back_from_a_damped_mode() {
    let place = place(CHAIN);
    let truth = [("contact.0.stiffness_n_m", 5e3), ("contact.0.gap_m", 1.1e-3), ("damping.rayleigh.mass_1_s", 0.6)];
    let columns = [("fundamental_m", None), ("frequency_hz", Some(1e-3)), ("damping_ratio", Some(1e-4))];
    measured(place.path(), &truth, &columns, (1.3e-3, 3e-3, 3));
    let (_, found) = fitted(place.path(), "fundamental_m", &truth).unwrap();
    come_back(&found, &truth, 1e-4);
    assert!(found.chi_squared < 1e-2, "{found}");
}

#[test]
fn without_deviations_they_follow_from_what_is_left_and_what_cannot_be_told_apart_is_named() {
    let place = place(BEAM);
    let truth = [("contact.0.gap_mm", 1.1), ("structure.material.youngs_modulus_gpa", 195.0)];
    measured(place.path(), &truth, &[("level", None), ("frequency_hz", None)], (5.0, 30.0, 4));
    // Rows that are off by turns.
    let text = fs::read_to_string(place.path().join("measured.csv")).unwrap();
    let off = |(k, line): (usize, &str)| match line.split_once(',') {
        Some((level, hz)) if k > 0 => {
            let hz: f64 = hz.parse::<f64>().unwrap() + if k % 2 == 0 { 0.01 } else { -0.01 };
            format!("{level},{hz:?}")
        }
        _ => line.to_owned(),
    };
    let rows: Vec<String> = text.lines().enumerate().map(off).collect();
    fs::write(place.path().join("measured.csv"), rows.join("\n")).unwrap();
    // The damping of the virtual test is that of the scene.
    let (_, found) = fitted(place.path(), "level", &truth).unwrap();
    assert!(!found.deviations_are_stated && found.probability.is_none());
    let scatter = (found.chi_squared / found.degrees_of_freedom as f64).sqrt();
    assert!((0.008..0.015).contains(&scatter), "{scatter}");
    let off = found.parameters.iter().zip(&truth).all(|(own, (_, value))| (own.value - value).abs() < 3.0 * own.std);
    assert!(off, "{found}");
    // Below the stop its gap does nothing.
    measured(place.path(), &truth, &[("level", None), ("frequency_hz", None)], (1.6, 2.1, 1));
    let error = fitted(place.path(), "level", &truth).unwrap_err();
    assert!(
        error.to_string().contains("cannot tell the variables apart") && error.to_string().contains("gap_mm"),
        "{error}"
    );
    fs::write(place.path().join("measured.csv"), "level,frequency_hz\n900.0,48.0\n800.0,48.0\n").unwrap();
    let error = fitted(place.path(), "level", &truth).unwrap_err();
    assert!(error.to_string().contains("is never 900"), "{error}");
}

#[test]
fn mistakes_of_measured_points_are_said_at_their_place() {
    let place = place(BEAM);
    let refused = |table: &str, over: &str| {
        fs::write(place.path().join("measured.csv"), table).unwrap();
        let text = format!(
            "scene = \"scene.toml\"\n[fit]\nmeasured = \"measured.csv\"\nover = \"{over}\"\n\
             [[vary]]\nkey = \"damping.ratio\"\n"
        );
        fs::write(place.path().join("study.toml"), text).unwrap();
        Study::load(&place.path().join("study.toml")).unwrap_err().text(false)
    };
    for (table, over, expected) in [
        ("level,frequency_hz\n", "level", "expected a header, and a row for each point"),
        ("level,frequency_hz\n1.0,2.0\n", "modal_amplitude", "of which no derivatives are known"),
        ("frequency_hz\n2.0\n", "level", "has no column level"),
        ("level,other\n1.0,2.0\n", "level", "has no column to fit"),
        ("level,frequency_hz,peak_m\n1.0,2.0,3.0\n", "level", "expected a column frequency_hz_std"),
        ("level,frequency_hz,frequency_hz_std\n1.0,2.0,0.0\n", "level", "is not positive"),
        ("level,frequency_hz\n,2.0\n", "level", "a row of"),
    ] {
        let said = refused(table, over);
        assert!(said.contains(expected), "{said}");
    }
}
