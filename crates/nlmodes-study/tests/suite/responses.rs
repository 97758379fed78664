//! Studies of scenes with responses.

use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;

use nlmodes_run::Silent;
use nlmodes_study::{Cells, Collected, Settings, Study, run};

/// A damped rod before an elastic stop, driven at its end at two levels.
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
levels_n = [300.0, 2000.0]
[method]
harmonics = 3
"#;

const STUDY: &str = r#"
scene = "rod.toml"
[[vary]]
key = "contact.0.gap_m"
name = "gap"
values = [0.8e-3, 1.0e-3, 1.2e-3, -1.0]
[[quantity]]
name = "peak"
of = "peak"
level = 2000.0
[[quantity]]
name = "up"
of = "jump_up_hz"
level = 2000.0
[[quantity]]
name = "down"
of = "jump_down_hz"
level = 2000.0
[[quantity]]
name = "force"
of = "max_force"
[[quantity]]
name = "impulse"
of = "impulse"
at = { frequency_hz = 1300.0 }
level = 2000.0
[[quantity]]
name = "small"
of = "peak"
level = 300.0
[[quantity]]
name = "missing"
of = "peak"
level = 5.0
"#;

fn study(text: &str, directory: &Path) -> Study {
    let mut study =
        Study::parse_with_scene("study.toml", text, ROD).map_err(|refused| refused.text(false)).unwrap().scene;
    study.directory = directory.to_path_buf();
    study
}

fn column(collected: &Collected, name: &str) -> Vec<Option<f64>> {
    collected.table.column(name).and_then(Cells::numbers).unwrap()
}

#[test]
fn peaks_jumps_forces_and_impulses_are_those_of_the_curves() {
    let place = tempfile::tempdir().unwrap();
    let text = STUDY.replace("-1.0]", "1.4e-3]");
    let study = study(&text, place.path());
    let settings = Settings { jobs: NonZeroUsize::new(2), ..Settings::default() };
    let outcome = run(&study, &settings, &mut Silent).unwrap();
    assert!(outcome.is_done() && outcome.computed == 4 && outcome.failed == 0, "{outcome:?}");
    let collected = Collected::new(&study, 1);
    let all = |name: &str| column(&collected, name).into_iter().map(Option::unwrap).collect::<Vec<f64>>();
    let (peak, up, down, force, gap) = (all("peak"), all("up"), all("down"), all("force"), all("gap"));
    let ids = nlmodes_study::case::cases(&study, 1);
    for (row, case) in ids.iter().enumerate() {
        let directory = place.path().join("cases").join(case.id.as_ref().unwrap());
        let mut table = csv::Reader::from_path(directory.join("branch.csv")).unwrap();
        let header = table.headers().unwrap().clone();
        let at = |name: &str| header.iter().position(|own| own == name).unwrap();
        let number = |row: &csv::StringRecord, name: &str| row[at(name)].parse::<f64>().unwrap();
        let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
        let at_level = |level: f64| rows.iter().filter(move |row| number(row, "level") == level);
        let most = at_level(2000.0).map(|row| number(row, "fundamental_m")).fold(0.0, f64::max);
        // Between points there is a little more.
        assert!((0.0..3e-3).contains(&(peak[row] / most - 1.0)), "{} {most}", peak[row]);
        let largest = rows.iter().map(|row| number(row, "peak_contact_force_n")).fold(0.0, f64::max);
        assert_eq!(force[row], largest);
        let folds = at_level(2000.0).filter(|row| row[at("event")].contains("fold"));
        let folds: Vec<f64> = folds.map(|row| number(row, "frequency_hz")).collect();
        assert!(folds.contains(&up[row]) && folds.contains(&down[row]) && up[row] > down[row], "{folds:?}");
        // At the small level the stop is not touched while its gap is large enough.
        assert!(gap[row] > all("small")[row] && peak[row] > gap[row]);
    }
    // A wider gap lets the peak grow and takes the stiffness of the stop from it.
    assert!(peak.windows(2).all(|w| w[1] > w[0]) && up.windows(2).all(|w| w[1] < w[0]), "{peak:?} {up:?}");
    assert!(all("impulse").iter().all(|impulse| *impulse > 0.0));
    assert_eq!(column(&collected, "missing"), [None; 4]);
    let Some(Cells::Texts(reasons)) = collected.table.column("reason") else { panic!() };
    assert!(reasons[0].as_deref().unwrap().contains("missing: there is no curve at level 5"), "{reasons:?}");
    // What touches nothing does not depend on the gap.
    let small = collected.statistics.iter().find(|one| one.quantity == "small").unwrap();
    assert!(small.does_not_vary && small.to_string().contains("does not depend on the variables"), "{small}");
    assert!(!collected.statistics[0].does_not_vary);
    // Envelope and percentiles of the largest amplitude of each case.
    let [least, largest] = collected.band.envelope.as_ref().unwrap();
    assert!(least.iter().zip(largest).all(|(a, b)| a <= b) && least.len() == collected.band.x.len());
    let top = largest.iter().copied().fold(0.0, f64::max);
    assert!((top / peak[3] - 1.0).abs() < 0.05, "{top} {peak:?}");
    collected.write(&study).unwrap();
    assert!(fs::read_to_string(place.path().join("report.html")).unwrap().contains("\"of_responses\":true"));
}

#[test]
fn a_case_that_fails_is_a_row_and_places_without_meaning_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let text = STUDY.replace("key = \"contact.0.gap_m\"", "key = \"contact.0.at_m\"").replace("-1.0]", "1.0]");
    let study = study(&text, place.path());
    let outcome = run(&study, &Settings::default(), &mut Silent).unwrap();
    assert!(outcome.computed == 1 && outcome.refused == 3, "{outcome:?}");
    let collected = Collected::new(&study, 1);
    assert_eq!((collected.counts.complete, collected.counts.failed), (1, 3));
    let refused = |from: &str, to: &str| {
        Study::parse_with_scene("study.toml", &STUDY.replacen(from, to, 1), ROD).unwrap_err().text(false)
    };
    let said = refused("of = \"peak\"", "of = \"peak\"\nat = \"max\"");
    assert!(said.contains("`quantity.0.at` has no meaning for \"peak\""), "{said}");
    let said = refused("of = \"max_force\"", "of = \"frequency_hz\"");
    assert!(said.contains("`quantity.3.at` is missing"), "{said}");
    let mode = ROD.split("[damping]").next().unwrap().to_owned()
        + "[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 2.0\n";
    let said = Study::parse_with_scene("study.toml", STUDY, &mode).unwrap_err().text(false);
    assert!(said.contains("`peak` is of responses over the frequency"), "{said}");
    assert!(!fs::read_dir(place.path()).unwrap().collect::<Vec<_>>().is_empty());
}
