//! Parameters from linear frequencies: both rows of Table 1, lengths, and what frequencies cannot tell.

use std::convert::Infallible;
use std::f64::consts::{PI, TAU};

use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes::model::{Drop, MasslessContactModel, ModelError, Side, StructuralModel, linear_modes};
use nlmodes::updating::{FrequencyTarget, UpdatingError, update_parameters};

fn beam(youngs_modulus: f64, density: f64, length: f64) -> StructuralModel {
    let beam = Beam {
        material: Material::new(youngs_modulus, density).unwrap().with_poissons_ratio(0.3).unwrap(),
        section: Section::rectangle(0.012, 0.020).unwrap().with_shear_factor(5.0 / 6.0).unwrap(),
        mesh: Mesh::graded(length, 21, 9.195_853_6).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    beam.assemble(&[Stop::rigid(length, Direction::Transverse, Side::Positive, 1.03e-3)]).unwrap()
}

fn hertz(model: &StructuralModel, without_tip_mass: bool) -> Result<Vec<f64>, ModelError> {
    let mass = match without_tip_mass {
        true => MasslessContactModel::new(model, &Drop)?.mass().clone(),
        false => model.mass().clone(),
    };
    Ok(linear_modes(&mass, model.stiffness(), 4)?.omega.iter().map(|omega| omega / TAU).collect())
}

fn target(mode: usize, frequency: f64) -> FrequencyTarget {
    FrequencyTarget { mode, frequency }
}

#[test]
fn both_moduli_of_table_1_follow_from_40_10_hertz() {
    for (without_tip_mass, expected) in [(true, 181.36e9), (false, 187.60e9)] {
        for start in [20e9, 210e9, 2e12] {
            let model = |p: &[f64]| hertz(&beam(p[0], 7730.0, 0.629_755_20), without_tip_mass);
            let found = update_parameters(&[start], &[target(1, 40.10)], model).unwrap();
            assert!((found.values[0] / expected - 1.0).abs() < 5e-6, "{start}: {}", found.values[0]);
            // Twelve moduli that differ in the 13th digit have frequencies up to 4e-11 of themselves apart from √E: the
            // rounding of the entries of K. No search comes nearer.
            assert!((found.after[0] / 40.10 - 1.0).abs() < 1e-10, "{}", found.after[0]);
            // ω ~ √E: in logarithms one step leads there, and long ones are cut.
            assert!(found.iterations <= 8, "{}", found.iterations);
        }
    }
}

#[test]
fn modulus_and_length_come_back_from_two_frequencies() {
    // Timoshenko: shear lowers the second mode of a shorter beam more, so that two frequencies tell length and modulus
    // apart.
    let given = hertz(&beam(190e9, 7730.0, 0.3), false).unwrap();
    let targets = [target(1, given[0]), target(4, given[3])];
    let found = update_parameters(&[170e9, 0.32], &targets, |p| hertz(&beam(p[0], 7730.0, p[1]), false)).unwrap();
    assert!((found.values[0] / 190e9 - 1.0).abs() < 1e-6 && (found.values[1] / 0.3 - 1.0).abs() < 1e-6, "{found:?}");
}

#[test]
fn length_of_a_rod_is_a_quarter_of_the_wavelength() {
    let frequency = |p: &[f64]| {
        let rod = Rod {
            material: Material::new(210e9, 9000.0).unwrap(),
            area: 1.0,
            mesh: Mesh::uniform(p[0], 400).unwrap(),
            mass_matrix: MassMatrix::Consistent,
            start: Support::Clamped,
            end: Support::Free,
        };
        hertz(&rod.assemble(&[]).unwrap(), false)
    };
    let found = update_parameters(&[35.0], &[target(1, 60.0)], frequency).unwrap();
    let quarter = (210e9_f64 / 9000.0).sqrt() / 60.0 / 4.0;
    // The finite elements are off by (π/2/400)²/24.
    let mesh = 1.0 + (0.5 * PI / 400.0).powi(2) / 24.0;
    assert!((found.values[0] / (quarter * mesh) - 1.0).abs() < 1e-9, "{} {quarter}", found.values[0]);
}

#[test]
fn more_frequencies_than_parameters_are_met_in_the_mean_of_their_logarithms() {
    // f_r = r √p: ln f_r − ln f_r* has the mean zero where p is the geometric mean of (f_r*/r)².
    let targets = [target(1, 1.1), target(2, 1.9), target(3, 3.2)];
    let model = |p: &[f64]| Ok::<_, Infallible>((1..4).map(|r| f64::from(r) * p[0].sqrt()).collect());
    let found = update_parameters(&[7.0], &targets, model).unwrap();
    let mean = (1.1_f64 * (1.9 / 2.0) * (3.2 / 3.0)).powf(2.0 / 3.0);
    assert!((found.values[0] / mean - 1.0).abs() < 1e-9, "{} {mean}", found.values[0]);
    assert!((found.before[0] - 7.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn modulus_and_density_cannot_be_told_apart() {
    let targets = [target(1, 40.0), target(2, 250.0)];
    let model = |p: &[f64]| hertz(&beam(p[0], p[1], 0.629_755_20), false);
    let error = update_parameters(&[200e9, 7800.0], &targets, model).unwrap_err();
    assert!(matches!(error, UpdatingError::Indistinct), "{error}");
}

#[test]
fn what_cannot_be_found_is_said() {
    let model = |p: &[f64]| Ok::<_, Infallible>(vec![p[0].sqrt()]);
    let error = |start: &[f64], targets: &[FrequencyTarget]| update_parameters(start, targets, model).unwrap_err();
    assert!(matches!(error(&[1.0, 2.0], &[target(1, 1.0)]), UpdatingError::Count { parameters: 2, targets: 1 }));
    assert!(matches!(error(&[], &[target(1, 1.0)]), UpdatingError::Count { parameters: 0, .. }));
    assert!(matches!(error(&[1.0], &[target(2, 1.0)]), UpdatingError::NoSuchMode { mode: 2, available: 1 }));
    assert!(matches!(error(&[1.0], &[target(0, 1.0)]), UpdatingError::NoSuchMode { mode: 0, .. }));
    assert!(matches!(error(&[-1.0], &[target(1, 1.0)]), UpdatingError::NotPositive { .. }));
    // No p gives 3.
    let bounded = |p: &[f64]| Ok::<_, Infallible>(vec![2.0 - 1.0 / (1.0 + p[0] * p[0])]);
    let error = update_parameters(&[1.0], &[target(1, 3.0)], bounded).unwrap_err();
    assert!(matches!(error, UpdatingError::NotConverged { .. } | UpdatingError::Indistinct), "{error}");
}
