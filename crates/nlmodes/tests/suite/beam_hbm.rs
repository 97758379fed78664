//! The cantilever of Section 4 by conventional harmonic balance, and beside MS-HBM as in Section 5.2.

use nlmodes::modal::EndReason;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, ComputedBranch, Histories, ResonanceRule, compute_branch};
use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes::model::{Drop, MasslessContactModel, Side, StructuralModel};

const LENGTH: f64 = 0.629_755_20;
const STIFFNESS: f64 = 2.3e6;

fn beam(youngs_modulus: f64, stiffness: Option<f64>) -> StructuralModel {
    let beam = Beam {
        material: Material::new(youngs_modulus, 7730.0).unwrap().with_poissons_ratio(0.3).unwrap(),
        section: Section::rectangle(0.012, 0.020).unwrap().with_shear_factor(5.0 / 6.0).unwrap(),
        mesh: Mesh::graded(LENGTH, 21, 9.195_853_6).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(LENGTH, Direction::Transverse, Side::Positive, 1.03e-3);
    beam.assemble(&[stiffness.map_or(stop, |k| stop.on_spring(k))]).unwrap()
}

fn hbm() -> MasslessContactModel {
    MasslessContactModel::with_spring_tips(&beam(187.60e9, Some(STIFFNESS)), None).unwrap()
}

fn ms_hbm(stiffness: Option<f64>) -> MasslessContactModel {
    MasslessContactModel::new(&beam(181.36e9, stiffness), &Drop).unwrap()
}

fn branch(model: MasslessContactModel, max_energy_ratio: f64) -> ComputedBranch {
    let (max_energy_ratio, internal_resonance) = (Some(max_energy_ratio), ResonanceRule::Follow);
    let settings = BranchSettings { max_energy_ratio, internal_resonance, ..BranchSettings::default() };
    let computed = compute_branch(model, &settings, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(computed.branch.end.reasons, [EndReason::MaxEnergy], "{:?}", computed.branch.end);
    assert!(computed.branch.points.iter().all(|p| p.residual < 1e-10));
    computed
}

fn end_hz(computed: &ComputedBranch) -> f64 {
    computed.branch.points.last().unwrap().omega / TAU
}

/// Frequency at a modal amplitude, by a cubic through the four nearest points.
fn hz_at(computed: &ComputedBranch, amplitude: f64) -> f64 {
    let points: Vec<(f64, f64)> = computed.branch.points.iter().map(|p| (p.modal_amplitude, p.omega / TAU)).collect();
    let after = points.partition_point(|p| p.0 < amplitude).clamp(2, points.len() - 2);
    let near = &points[after - 2..after + 2];
    let weight = |i: usize| {
        (0..4).filter(|&j| j != i).map(|j| (amplitude - near[j].0) / (near[i].0 - near[j].0)).product::<f64>()
    };
    (0..4).map(|i| near[i].1 * weight(i)).sum()
}

#[test]
fn harmonic_balance_of_the_beam_passes_through_frequencies_computed_elsewhere() {
    // Own computation in Python (Timoshenko elements integrated by Gauss, receptances of the full matrices, quadrature
    // by Gauss between the roots of the gap, Powell's method): grazing energy, and Hz over the energy ratio.
    for (ratio, expected) in [(1.5, 44.034_781_044_8), (3.0, 48.148_150_479_5), (6.0, 51.393_472_036_7)] {
        let computed = branch(hbm(), ratio);
        assert_eq!(computed.branch.label, "HBM, 5 harmonics");
        assert!((computed.grazing.energy / 0.004_922_468_958_926_6 - 1.0).abs() < 1e-7);
        assert!((computed.grazing.omega / TAU - 40.10).abs() < 1e-6);
        let found = end_hz(&computed);
        // The matrices differ by rounding, and 21 graded elements have a condition near 1e9.
        assert!((found - expected).abs() < 1e-6, "{ratio}: {found} against {expected}");
    }
}

#[test]
fn mixed_shooting_is_stiffer_than_harmonic_balance_by_two_percent_and_its_force_peak_ten_times_higher() {
    let (rigid, elastic, balance) =
        (branch(ms_hbm(None), 6.5), branch(ms_hbm(Some(STIFFNESS)), 6.5), branch(hbm(), 6.5));
    for amplitude in [6e-4, 7e-4, 8e-4, 9e-4] {
        let [rigid, elastic, balance] = [&rigid, &elastic, &balance].map(|branch| hz_at(branch, amplitude));
        // Stiffer because the stop does not yield, and because the mode has less mass without its tip.
        assert!(rigid > elastic && elastic > balance, "{amplitude}: {rigid}, {elastic}, {balance} Hz");
        assert!(rigid / balance < 1.025, "{amplitude}: {rigid}, {balance} Hz");
    }
    let peak = |branch: &ComputedBranch| branch.branch.points.last().unwrap().peak_contact_force;
    let ratio = peak(&rigid) / peak(&balance);
    assert!((8.0..12.0).contains(&ratio), "{ratio}");
    // The same stop makes the same force, whether or not the node has mass.
    assert!((peak(&elastic) / peak(&balance) - 1.0).abs() < 0.05, "{} {}", peak(&elastic), peak(&balance));
}

#[test]
fn a_solution_between_two_points_has_the_amplitude_of_the_other_method() {
    let computed = branch(hbm(), 2.0);
    let points = &computed.branch.points;
    // Neither of the points themselves, nor their mean: somewhere between the sixth and the seventh.
    let amplitude = 0.3 * points[5].modal_amplitude + 0.7 * points[6].modal_amplitude;
    let found = computed.at_amplitude(amplitude, points[5].omega).unwrap().unwrap();
    assert!((found.point.modal_amplitude / amplitude - 1.0).abs() < 1e-9);
    let range = points[5].omega.min(points[6].omega)..points[5].omega.max(points[6].omega);
    assert!(range.contains(&found.point.omega), "{}", found.point.omega / TAU);
    // It is on the branch: a branch that ends at its energy ends at its frequency and amplitude.
    let other = branch(hbm(), found.point.kinetic_energy / computed.grazing.energy);
    let last = other.branch.points.last().unwrap();
    assert!((found.point.omega / last.omega - 1.0).abs() < 1e-10);
    assert!((amplitude / last.modal_amplitude - 1.0).abs() < 1e-8);
    let history = &Histories::of(&computed).between(&found, 400, "between").unwrap()[0];
    let peak = history.force.iter().fold(0.0_f64, |m, f| m.max(*f));
    assert!((peak / last.peak_contact_force - 1.0).abs() < 1e-3, "{peak} {}", last.peak_contact_force);
    assert!(computed.at_amplitude(10.0 * amplitude, points[5].omega).unwrap().is_none());
}

#[test]
fn a_stiffer_spring_brings_harmonic_balance_toward_mixed_shooting_on_the_same_masses() {
    let tips = |k: f64| MasslessContactModel::with_spring_tips(&beam(181.36e9, Some(k)), Some(&Drop)).unwrap();
    // At 2.3e6 N/m the tip's own stiffness, some 1e10 N/m, hardly matters: truncating the node changes nothing.
    let (node, tip) = (end_hz(&branch(ms_hbm(Some(STIFFNESS)), 3.0)), end_hz(&branch(tips(STIFFNESS), 3.0)));
    assert!((node / tip - 1.0).abs() < 1e-5, "{node} {tip}");
    // And MS-HBM runs into its own rigid stop like 1/k_c, once k_c is beyond what five harmonics see of the contact.
    let rigid = end_hz(&branch(ms_hbm(None), 3.0));
    let off = [1e11, 1e12, 1e13].map(|k| (end_hz(&branch(ms_hbm(Some(k)), 3.0)) - rigid).abs());
    assert!(off.windows(2).all(|pair| (8.0..12.0).contains(&(pair[0] / pair[1]))), "{off:?}");
}
