//! The oscillator with an elastic stop of Code_Aster's SDND122 over gap and stop stiffness: each frequency, mean,
//! quantiles and Sobol' indices compared with the closed form.

use nlmodes_run::Silent;
use nlmodes_study::{Collected, Settings, Study, run};

const ENERGY: f64 = 0.0065;

/// Mass 1 kg on a spring of 10 N/m.
const SCENE: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 1
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
[method]
kind = "shooting"
mass_redistribution = "none"
harmonics = 1
[continuation]
max_energy_ratio = 30.0
"#;

const STUDY: &str = r#"
scene = "oscillator.toml"
[design]
kind = "sobol"
samples = 32
sobol_indices = true
[[vary]]
key = "contact.0.gap_m"
name = "gap"
uniform = [0.008, 0.012]
[[vary]]
key = "contact.0.stiffness_n_m"
name = "stiffness"
uniform = [25.0, 75.0]
[[quantity]]
name = "f"
of = "frequency_hz"
at = { total_energy_j = 0.0065 }
"#;

/// Frequency, Hz: a half wave on the spring alone, then one on spring and stop.
fn frequency(gap: f64, stop: f64, energy: f64) -> f64 {
    let (k, m, e): (f64, f64, f64) = (10.0, 1.0, energy);
    let amplitude = (2.0 * e / k).sqrt();
    let rest = stop * gap / (k + stop);
    let in_contact = ((2.0 * e - k * stop * gap * gap / (k + stop)) / (k + stop)).sqrt();
    let free = 2.0 * (std::f64::consts::PI - (gap / amplitude).acos()) / (k / m).sqrt();
    let pressed = 2.0 * ((gap - rest) / in_contact).acos() / ((k + stop) / m).sqrt();
    1.0 / (free + pressed)
}

/// Mean, deviation, 5 and 95 % and first-order indices on a grid of equally likely cells.
struct Exact {
    mean: f64,
    std: f64,
    quantiles: [f64; 2],
    first: [f64; 2],
}

fn exact() -> Exact {
    let n = 400;
    let at = |k: usize| (k as f64 + 0.5) / n as f64;
    let grid: Vec<Vec<f64>> = (0..n)
        .map(|i| (0..n).map(|j| frequency(0.008 + 0.004 * at(i), 25.0 + 50.0 * at(j), ENERGY)).collect())
        .collect();
    let mean_of = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / n as f64;
    let of_gap: Vec<f64> = grid.iter().map(|row| mean_of(&mut row.iter().copied())).collect();
    let of_stop: Vec<f64> = (0..n).map(|j| mean_of(&mut grid.iter().map(|row| row[j]))).collect();
    let mean = mean_of(&mut of_gap.iter().copied());
    let spread = |values: &[f64]| mean_of(&mut values.iter().map(|x| (x - mean).powi(2)));
    let variance = mean_of(&mut grid.iter().map(|row| spread(row)));
    let mut all: Vec<f64> = grid.into_iter().flatten().collect();
    all.sort_by(f64::total_cmp);
    Exact {
        mean,
        std: variance.sqrt(),
        quantiles: [0.05, 0.95].map(|share| all[(share * all.len() as f64) as usize]),
        first: [spread(&of_gap) / variance, spread(&of_stop) / variance],
    }
}

#[test]
fn frequencies_spread_and_indices_are_those_of_the_closed_form() {
    // Reference points of the test case, at their energies.
    for (energy, hz) in [(0.00650108331626, 0.6466310406398), (0.00647656819016, 0.6465124271995)] {
        assert!((frequency(0.01, 50.0, energy) - hz).abs() < 1e-12);
    }
    let place = tempfile::tempdir().unwrap();
    let mut study =
        Study::parse_with_scene("study.toml", STUDY, SCENE).map_err(|refused| refused.text(false)).unwrap().scene;
    study.directory = place.path().to_path_buf();
    assert!(run(&study, &Settings::default(), &mut Silent).unwrap().is_done());
    let collected = Collected::new(&study, 2);
    let column = |name: &str| collected.table.column(name).unwrap().numbers().unwrap();
    let (gaps, stops, found, said) = (column("gap"), column("stiffness"), column("f"), column("f_error"));
    assert_eq!(found.len(), 128);
    for (k, (gap, stop)) in gaps.iter().zip(&stops).enumerate() {
        let (found, said) = (found[k].unwrap(), said[k].unwrap());
        let error = (found - frequency(gap.unwrap(), stop.unwrap(), ENERGY)).abs();
        // Between points of a branch, of which there are some fifty.
        assert!(error <= said + 1e-5 && error < 1e-4, "case {k}: {error:e}, said {said:e}");
    }
    let exact = exact();
    let statistics = &collected.statistics[0];
    let spread = statistics.spread.as_ref().unwrap();
    assert_eq!(spread.count, 64);
    // Sixty-four points of a Sobol' sequence: some ten times more accurate than independent ones.
    assert!((spread.mean - exact.mean).abs() < 0.2 * exact.std / 8.0, "{} {}", spread.mean, exact.mean);
    assert!((spread.std / exact.std - 1.0).abs() < 0.03, "{} {}", spread.std, exact.std);
    let quantile = |share: f64| spread.quantiles.iter().find(|q| q[0] == share).unwrap()[1];
    for (share, wanted) in [0.05, 0.95].into_iter().zip(exact.quantiles) {
        // The standard error of such a quantile of 64 independent values is about an eighth of their standard
        // deviation.
        assert!((quantile(share) - wanted).abs() < 0.3 * exact.std, "{share}: {} {wanted}", quantile(share));
    }
    for (found, wanted) in statistics.sobol_indices.iter().zip(exact.first) {
        assert!((found.measure.first - wanted).abs() < 0.08, "{}: {} {wanted}", found.variable, found.measure.first);
        // Their interaction is negligible.
        assert!((found.measure.total - wanted).abs() < 0.08, "{}: {}", found.variable, found.measure.total);
    }
}
