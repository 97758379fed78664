//! What gradients say of a study, against differences of its own cases and the cases of a sampled design.

use std::path::Path;

use nlmodes_run::Silent;
use nlmodes_study::{Collected, Evaluator, FirstOrder, OfQuantity, Settings, Study, run};
use serde_json::{Map, Value};

/// A soft rod of two lumps before a stop.
const OSCILLATOR: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 2
mass_matrix = "lumped"
start = "clamped"
material = { youngs_modulus_pa = 10.0, density_kg_m3 = 2.0 }
section = { area_m2 = 1.0 }
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 0.01
stiffness_n_m = 50.0
[reduction]
kind = "free-interface"
modes = 1
[method]
harmonics = 15
[continuation]
max_energy_ratio = 30.0
[output]
stability = "never"
"#;

const OF_MODE: &str = r#"
scene = "oscillator.toml"
[design]
kind = "first-order"
box_deviations = 2.0
[[vary]]
key = "contact.0.gap_m"
name = "gap"
uniform = [0.008, 0.012]
[[vary]]
key = "contact.0.stiffness_n_m"
name = "stiffness"
normal = { mean = 50.0, std = 4.0 }
[[quantity]]
name = "f"
of = "frequency_hz"
at = { energy_j = 0.003 }
at_most = 0.66
[[quantity]]
name = "f_at_peak"
of = "frequency_hz"
at = { peak_m = 0.0128 }
[[quantity]]
name = "force"
of = "peak_contact_force_n"
at = { frequency_hz = 0.6 }
at_most = 0.5
[[quantity]]
name = "f_of_ratio"
of = "frequency_hz"
at = { energy_ratio = 6.0 }
"#;

/// A damped rod before an elastic stop, driven at its end.
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
"#;

const OF_RESPONSE: &str = r#"
scene = "rod.toml"
[design]
kind = "latin-hypercube"
samples = 24
first_order = true
[[vary]]
key = "contact.0.gap_m"
name = "gap"
uniform = [0.98e-3, 1.02e-3]
[[vary]]
key = "damping.ratio"
name = "damping"
uniform = [0.019, 0.021]
[[quantity]]
name = "peak"
of = "peak"
[[quantity]]
name = "down"
of = "jump_down_hz"
[[quantity]]
name = "up"
of = "jump_up_hz"
[[quantity]]
name = "force"
of = "max_force"
[[quantity]]
name = "impulse"
of = "impulse"
at = { frequency_hz = 1300.0 }
"#;

fn study(text: &str, scene: &str, directory: &Path) -> Study {
    let read = Study::parse_with_scene("study.toml", text, scene);
    let mut study = read.map_err(|refused| refused.text(false)).unwrap().scene;
    study.directory = directory.to_path_buf();
    study
}

fn evaluated(study: &Study, values: &[(&str, f64)], quantity: &str) -> f64 {
    let set: Map<String, Value> =
        values.iter().map(|(name, value)| ((*name).to_owned(), Value::from(*value))).collect();
    let answer = Evaluator::new(study.clone(), Settings::default()).evaluate(&set).unwrap().unwrap();
    answer.quantities[quantity].as_f64().unwrap_or_else(|| panic!("{quantity}: {answer:?}"))
}

/// Difference quotients of fourth order of cases beside the means, by each variable.
fn differences(study: &Study, means: &[(&str, f64)], quantity: &str, step: f64) -> Vec<f64> {
    let of = |k: usize| {
        let at = |factor: f64| {
            let mut values = means.to_vec();
            values[k].1 *= factor;
            evaluated(study, &values, quantity)
        };
        let first = at(1.0 + step) - at(1.0 - step);
        (8.0 * first - at(1.0 + 2.0 * step) + at(1.0 - 2.0 * step)) / (12.0 * step * means[k].1)
    };
    (0..means.len()).map(of).collect()
}

fn of<'f>(first: &'f FirstOrder, quantity: &str) -> &'f OfQuantity {
    first.quantities.iter().find(|of| of.quantity == quantity).unwrap()
}

#[test]
fn gradients_of_quantities_of_a_mode_are_differences_of_cases_and_corners_are_computed() {
    let place = tempfile::tempdir().unwrap();
    let study = study(OF_MODE, OSCILLATOR, place.path());
    let outcome = run(&study, &Settings::default(), &mut Silent).unwrap();
    assert!(outcome.is_done() && outcome.cases == 1, "{outcome:?}");
    let collected = Collected::new(&study, 1);
    let first = collected.first_order.as_ref().unwrap();
    assert_eq!(first.reason, None);
    let means = [("gap", 0.01), ("stiffness", 50.0)];
    let deviations = [0.004 / 12f64.sqrt(), 4.0];
    for quantity in ["f", "f_at_peak", "force"] {
        let own = of(first, quantity);
        assert_eq!(own.reason, None, "{quantity}");
        let found: Vec<f64> = own.effects.iter().map(|effect| effect.derivative).collect();
        let wanted = differences(&study, &means, quantity, 1e-2);
        for (k, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
            // Between the points of a branch, which are interpolated on both sides.
            let size = wanted.abs().max(1e-2 * own.value.unwrap() / means[k].1);
            assert!((found - wanted).abs() < 2e-3 * size, "{quantity} by {k}: {found} {wanted}");
        }
        let std = found.iter().zip(deviations).map(|(d, s)| (d * s).powi(2)).sum::<f64>().sqrt();
        assert!((own.std.unwrap() / std - 1.0).abs() < 1e-12);
        let shares: f64 = own.effects.iter().map(|effect| effect.share.unwrap()).sum();
        assert!((shares - 1.0).abs() < 1e-12 && own.of_cases.is_none());
        for corner in &own.corners {
            let at = [("gap", corner.at["gap"]), ("stiffness", corner.at["stiffness"])];
            assert!([0.008, 0.012].contains(&at[0].1) && [42.0, 58.0].contains(&at[1].1), "{at:?}");
            let there = evaluated(&study, &at, quantity);
            assert!((corner.computed.unwrap() / there - 1.0).abs() < 1e-9, "{corner:?}");
            // By differences of cases beside the corner: the same sign as at the means, unless that is reported.
            let sign = |k: usize| {
                let at = |factor: f64| {
                    let mut values = at;
                    values[k].1 *= factor;
                    evaluated(&study, &values, quantity)
                };
                (at(1.01) - at(0.99)) * found[k] > 0.0
            };
            let turned: Vec<&str> = (0..2).filter(|k| !sign(*k)).map(|k| at[k].0).collect();
            assert_eq!(corner.turns_over, turned, "{quantity}: {corner:?}");
            let linear = own.value.unwrap() + (0..2).map(|k| found[k] * (at[k].1 - means[k].1)).sum::<f64>();
            assert!((corner.predicted / linear - 1.0).abs() < 1e-12);
        }
        let value = |which: &str| own.corners.iter().find(|corner| corner.which == which).unwrap().computed.unwrap();
        assert!(value("smallest") < own.value.unwrap() && own.value.unwrap() < value("largest"));
    }
    let ratio = of(first, "f_of_ratio");
    assert!(ratio.reason.as_ref().unwrap().contains("{ energy_j = … } holds the energy itself"), "{ratio:?}");
}

#[test]
fn a_limit_is_met_by_the_share_of_the_tolerances_that_is_told() {
    let place = tempfile::tempdir().unwrap();
    let probe = study(OF_MODE, OSCILLATOR, place.path());
    run(&probe, &Settings::default(), &mut Silent).unwrap();
    let first = Collected::new(&probe, 1).first_order.unwrap();
    let own = of(&first, "f");
    let (mean, most) = (own.value.unwrap(), own.corners[0].computed.unwrap());
    // Two thirds of the way to the worst corner, which is all that counts; less than nothing; more than all of it.
    for (limit, whole) in [(mean + 0.667 * (most - mean), None), (0.99 * mean, Some(0.0)), (1.01 * most, Some(1.0))] {
        let text = OF_MODE.replacen("at_most = 0.66", &format!("at_most = {limit:?}"), 1);
        let study = study(&text, OSCILLATOR, place.path());
        assert!(run(&study, &Settings::default(), &mut Silent).unwrap().is_done());
        let first = Collected::new(&study, 1).first_order.unwrap();
        let kept = of(&first, "f").limit.as_ref().unwrap();
        assert_eq!(kept.reason, "");
        let share = kept.share.unwrap();
        if let Some(whole) = whole {
            assert_eq!(share, whole);
            continue;
        }
        let at: Vec<(&str, f64)> = [("gap", 0.01), ("stiffness", 50.0)]
            .into_iter()
            .map(|(name, mean)| (name, mean + share * (own.corners[0].at[name] - mean)))
            .collect();
        let value = evaluated(&study, &at, "f");
        assert!(value <= limit && limit - value < 1e-3 * (limit - mean), "{value} {limit}");
        assert!((kept.computed.unwrap() - value).abs() < 1e-12 && (0.5..0.9).contains(&share), "{kept:?}");
    }
}

#[test]
fn gradients_of_quantities_of_responses_are_differences_of_cases_and_stand_beside_the_spread_of_the_study() {
    let place = tempfile::tempdir().unwrap();
    let study = study(OF_RESPONSE, ROD, place.path());
    assert!(run(&study, &Settings::default(), &mut Silent).unwrap().is_done());
    let collected = Collected::new(&study, 1);
    assert_eq!(collected.counts.cases, 24);
    let first = collected.first_order.as_ref().unwrap();
    let means = [("gap", 1e-3), ("damping", 0.02)];
    // Largest values have points of their own where a scene is differentiated.
    let sensitivity = "[[sensitivity]]\nkey = \"damping.ratio\"\n";
    let other = self::study(OF_RESPONSE, &format!("{ROD}{sensitivity}"), place.path());
    for quantity in ["peak", "down", "up", "force", "impulse"] {
        let own = of(first, quantity);
        assert_eq!(own.reason, None, "{quantity}");
        let wanted = differences(&other, &means, quantity, 2e-3);
        for (k, (effect, wanted)) in own.effects.iter().zip(&wanted).enumerate() {
            let found = effect.derivative;
            let size = wanted.abs().max(1e-2 * own.value.unwrap() / means[k].1);
            let allowed = 1e-3;
            assert!((found - wanted).abs() < allowed * size, "{quantity} by {k}: {found} {wanted}");
        }
        let beside = own.of_cases.unwrap();
        assert!(beside.more.abs() < 0.25 && beside.std_error > 0.0, "{quantity}: {beside:?}");
        assert!(beside.shift.abs() < 1.0);
    }
    collected.write(&study).unwrap();
    let written = std::fs::read_to_string(place.path().join("study.json")).unwrap();
    let written: Value = serde_json::from_str(&written).unwrap();
    assert_eq!(written["first_order"]["quantities"][1]["quantity"], "down");
    let page = std::fs::read_to_string(place.path().join("report.html")).unwrap();
    assert!(page.contains("<h2>By gradients</h2>") && page.contains("largest at"));
    assert!(first.to_string().contains("down by gradients: "), "{first}");
}

/// A lightly damped beam, whose largest contact force lies less than a ten-thousandth of the frequency from a fold.
const STOP: &str = include_str!("../../../../configs/studies/stop.toml");

#[test]
fn gradients_of_a_largest_force_next_to_a_fold_are_differences_of_cases() {
    let place = tempfile::tempdir().unwrap();
    let text = r#"
scene = "stop.toml"
[design]
kind = "first-order"
[[vary]]
key = "contact.0.gap_mm"
name = "gap"
uniform = [0.95, 1.05]
[[vary]]
key = "structure.section.height_mm"
name = "height"
uniform = [19.9, 20.1]
[[quantity]]
name = "force"
of = "max_force"
[[quantity]]
name = "amplitude"
of = "fundamental_m"
at = "max"
"#;
    let study = study(text, STOP, place.path());
    assert!(run(&study, &Settings::default(), &mut Silent).unwrap().is_done());
    let first = Collected::new(&study, 1).first_order.unwrap();
    let sensitivity = "\n[[sensitivity]]\nkey = \"damping.ratio\"\n";
    let other = self::study(text, &format!("{STOP}{sensitivity}"), place.path());
    let means = [("gap", 1.0), ("height", 20.0)];
    for quantity in ["force", "amplitude"] {
        let own = of(&first, quantity);
        assert_eq!(own.reason, None);
        let wanted = differences(&other, &means, quantity, 1e-4);
        for (effect, wanted) in own.effects.iter().zip(&wanted) {
            let (found, size) = (effect.derivative, wanted.abs().max(1e-2 * own.value.unwrap()));
            assert!((found - wanted).abs() < 2e-3 * size, "{quantity} by {}: {found} {wanted}", effect.variable);
        }
    }
}

/// With a tenth of the cases, and right to what both state.
#[test]
fn indices_of_an_expansion_are_those_of_ten_times_as_many_cases() {
    let place = tempfile::tempdir().unwrap();
    let variables = "[[vary]]\nkey = \"structure.material.youngs_modulus_pa\"\nname = \"modulus\"\n\
        lognormal = { mean = 10.0, std = 0.6 }\n[[vary]]\nkey = \"structure.material.density_kg_m3\"\n\
        name = \"density\"\nloguniform = [1.9, 2.1]\n[[quantity]]";
    let with = |design: &str| {
        let text = OF_MODE.replacen("kind = \"first-order\"", &format!("kind = \"sobol\"\n{design}"), 1);
        let study = study(&text.replacen("[[quantity]]", variables, 1), OSCILLATOR, place.path());
        assert!(run(&study, &Settings::default(), &mut Silent).unwrap().is_done());
        Collected::new(&study, 1)
    };
    let (full, few) = (with("samples = 32\nsobol_indices = true"), with("samples = 19\nexpansion = true"));
    assert_eq!((full.counts.complete, few.counts.complete), (192, 19));
    for quantity in ["f", "f_at_peak"] {
        let of = |all: &Collected| all.statistics.iter().find(|one| one.quantity == quantity).cloned().unwrap();
        let (full, few) = (of(&full), of(&few));
        let own = few.expansion.unwrap();
        assert!(own.with_gradients == 19 && own.left_out < 1e-3, "{own:?}");
        let [mean, std] = [full.spread.as_ref().unwrap().mean, full.spread.as_ref().unwrap().std];
        assert!((own.mean - mean).abs() < 0.1 * std && (own.std / std - 1.0).abs() < 0.1, "{own:?} {mean} {std}");
        for (full, few) in full.sobol_indices.iter().zip(&few.sobol_indices) {
            let (a, b) = (full.measure, few.measure);
            for (less, errors) in [
                (a.first - b.first, [a.first_error, b.first_error]),
                (a.total - b.total, [a.total_error, b.total_error]),
            ] {
                assert!(less.abs() < 2.0 * errors[0] + errors[1] + 1e-6, "{quantity} {full:?} {few:?}");
            }
        }
    }
    // Nothing is differentiated there, and a tenth of so many cases is too few for its values alone.
    let ratio = few.statistics.iter().find(|one| one.quantity == "f_of_ratio").unwrap();
    assert!(ratio.expansion.as_ref().is_none_or(|own| own.with_gradients == 0), "{ratio:?}");
    let refused = |design: &str| {
        let text = OF_MODE.replacen("kind = \"first-order\"", design, 1);
        Study::parse_with_scene("study.toml", &text, OSCILLATOR).map_err(|refused| refused.text(false)).unwrap_err()
    };
    assert!(refused("kind = \"first-order\"\nexpansion = true").contains("`design.expansion` has no meaning"));
    let both = "kind = \"sobol\"\nsamples = 4\nsobol_indices = true\nexpansion = true";
    assert!(refused(both).contains("`design.sobol_indices` beside `design.expansion`"));
}
