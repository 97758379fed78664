//! What every computed point must satisfy, checked with the full matrices and with time alone.

use crate::support;

use std::f64::consts::TAU;

use nlmodes_continuation::{EventKind, Linearization, ParametricSystem};
use nlmodes_hbm::{CondensedStructure, PeriodicSystem, Switching, Symmetry};
use nlmodes_modal::HarmonicCoefficients;
use nlmodes_model::{Drop, MasslessContactModel, Side, StructuralModel, linear_modes};
use num_complex::Complex64;
use support::{FullMatrices, condense, fitted_slope, follow, frequency_ratio, problem, rod, stops};

/// A named structure, harmonics, energy ratio.
type Case = (&'static str, StructuralModel, usize, f64);

fn cases() -> Vec<Case> {
    let paper = || rod(100, 210e9, 9000.0, 20.0, &[(100, Side::Positive, 0.5)]);
    vec![
        ("paper rod, 2 harmonics", paper(), 2, 15.2),
        ("paper rod, 3 harmonics", paper(), 3, 8.0),
        ("short rod, 5 harmonics", rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0)]), 5, 3.0),
        ("stop on the other side", rod(6, 1.0, 1.0, 1.0, &[(6, Side::Negative, 0.3)]), 2, 3.0),
        ("stop in the middle", rod(6, 1.0, 1.0, 1.0, &[(3, Side::Positive, 0.3)]), 2, 3.0),
        ("two elements, 12 harmonics", rod(2, 1.0, 1.0, 1.0, &[(2, Side::Positive, 1.0)]), 12, 6.0),
    ]
}

#[test]
fn every_point_of_every_branch_satisfies_the_equations_of_the_paper() {
    const SAMPLES: usize = 1 << 14;
    for symmetry in [Symmetry::Even, Symmetry::None] {
        for (name, model, harmonics, ratio) in cases() {
            let (structure, full) = (condense(&model), FullMatrices::of(&model));
            let (mut problem, start) = problem(&structure, 1, harmonics, symmetry, Switching::Exact);
            let branch = follow(&mut problem, &start, ratio);
            let contact = stops(&model)[0];
            let (side, k_nn) = (contact.side.sign(), full.k[contact.dof][contact.dof]);
            for (i, point) in branch.points.iter().enumerate() {
                assert!(point.residual < 1e-10, "{name} {i}: residual {:e}", point.residual);
                let modal = structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
                // The strong springs of short elements cancel: rounding is near 1e-16 times a few hundred.
                let defect = full.equation_8_defect(&modal);
                assert!(defect < 1e-11, "{name} {i}: eq. (8) by {defect:e}");
                let kinetic = full.kinetic_energy(&modal);
                assert!((kinetic / modal.kinetic_energy - 1.0).abs() < 1e-9, "{name} {i}: {kinetic}");
                assert!(
                    ((problem.scales().energy * point.p.exp()) / modal.kinetic_energy - 1.0).abs() < 1e-9,
                    "{name} {i}"
                );
                let checked = problem.check_contact(&point.x, 300).unwrap();
                let worst = checked.penetration.max(checked.tension).max(checked.complementarity);
                assert!(worst < 1e-11, "{name} {i}: {checked:?}");
                if let Some(delta) = point.x.get(problem.n_coefficients() + 1) {
                    assert!(delta.abs() < 1e-9, "{name} {i}: unfolding {delta:e}");
                }
                if i % 12 != 0 {
                    continue;
                }
                let history = problem
                    .equidistant_histories(&point.x, structure.model().contacts(), SAMPLES, "")
                    .unwrap()
                    .swap_remove(0);
                for j in (0..SAMPLES).step_by(SAMPLES / 64) {
                    let tau = TAU * j as f64 / SAMPLES as f64;
                    // One contact: the tip is where it would be without a stop, or at the stop.
                    let toward = side * full.free_position(&modal, tau)[0];
                    let (q, force) = (side * toward.min(contact.gap), k_nn * (toward - contact.gap).max(0.0));
                    assert!((history.displacement[j] - q).abs() < 1e-9 * contact.gap, "{name} {i}: q_N at {tau}");
                    assert!((history.force[j] - force).abs() < 1e-9 * k_nn * contact.gap, "{name} {i}: force at {tau}");
                }
                for n in 0..=harmonics {
                    // Trapezoidal rule on a function with corners: (2π/16384)² times the jump of the slope, about 1e-8.
                    let scale = if n == 0 { 1.0 } else { 2.0 } / SAMPLES as f64;
                    let unit = |j: usize| num_complex::Complex64::cis(-TAU * (n * j % SAMPLES) as f64 / SAMPLES as f64);
                    let by_quadrature: num_complex::Complex64 =
                        (0..SAMPLES).map(|j| unit(j) * history.displacement[j] * scale).sum();
                    let error = (by_quadrature - modal.coefficients.of(contact.dof)[n]).norm();
                    assert!(error < 2e-7 * contact.gap, "{name} {i}: eq. (14), harmonic {n}: {error:e}");
                }
            }
        }
    }
}

/// Frequencies over that at grazing, at several energies, from a branch without symmetry.
fn resampled(structure: &CondensedStructure, symmetry: Symmetry, harmonics: usize) -> Vec<f64> {
    let (mut problem, start) = problem(structure, 1, harmonics, symmetry, Switching::Exact);
    [1.2, 1.6, 2.2, 3.0].map(|ratio| problem_at(&mut problem, &start, ratio)).to_vec()
}

fn problem_at(problem: &mut PeriodicSystem, start: &nlmodes_hbm::Grazing, ratio: f64) -> f64 {
    let branch = follow(problem, start, ratio);
    let last = branch.points.last().unwrap();
    assert!((last.p - ratio.ln()).abs() < 1e-12, "{:?}", branch.stop);
    last.x[problem.n_coefficients()]
}

#[test]
fn the_full_series_finds_the_branch_of_the_even_one() {
    let structure = condense(&rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0)]));
    for harmonics in [1, 2, 4] {
        let even = resampled(&structure, Symmetry::Even, harmonics);
        let full = resampled(&structure, Symmetry::None, harmonics);
        for (even, full) in even.iter().zip(&full) {
            assert!((even / full - 1.0).abs() < 1e-9, "{harmonics} harmonics: {even} against {full}");
        }
    }
}

#[test]
fn a_solution_shifted_in_time_is_a_solution() {
    let model = rod(8, 1.0, 1.0, 1.0, &[(8, Side::Positive, 1.0), (4, Side::Positive, 0.8)]);
    let structure = condense(&model);
    let (h, p) = (3, 2.0_f64.ln());
    let (mut even, start) = problem(&structure, 1, h, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut even, &start, 2.0);
    let solution = &branch.points.last().unwrap().x;
    let (mut full, _) = problem(&structure, 1, h, Symmetry::None, Switching::Exact);
    let (width, dofs) = (2 * h + 1, structure.n_contact_dofs());
    for phi in [0.0, 0.3, 1.7, 2.9, 4.4, 6.1] {
        let mut x = vec![0.0; full.dim()];
        for d in 0..dofs {
            for n in 0..=h {
                let c = solution[d * (h + 1) + n];
                x[d * width + n] = c * (n as f64 * phi).cos();
                if n > 0 {
                    x[d * width + h + n] = c * (n as f64 * phi).sin();
                }
            }
        }
        x[dofs * width] = solution[dofs * (h + 1)];
        let mut at = Linearization::new(full.dim());
        full.linearize(&x, p, &mut at).unwrap();
        // All but the last equation, the phase anchor, which has to object to the shift.
        let rows = &at.residual[..=dofs * width];
        let worst = rows.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        assert!(worst < 1e-10, "shift {phi}: {worst:e}");
        assert!(phi == 0.0 || at.residual[dofs * width + 1].abs() > 1e-2, "shift {phi} escapes the anchor");
    }
}

#[test]
fn a_free_phase_brings_no_crossing_and_few_evaluations_more() {
    // In metres and in millimetres, before a stop on either side: the phase starts with either sign of the fundamental.
    for (unit, side) in [(1.0, Side::Positive), (1e3, Side::Negative)] {
        let model = rod(40, 210e9, 9000.0 / (unit * unit), 20.0 * unit, &[(40, side, 0.5 * unit)]);
        let structure = condense(&model);
        let [even, free] = [Symmetry::Even, Symmetry::None].map(|symmetry| {
            let (mut problem, start) = problem(&structure, 1, 3, symmetry, Switching::Exact);
            let branch = follow(&mut problem, &start, 1.2);
            assert!((branch.points.last().unwrap().p - 1.2_f64.ln()).abs() < 1e-9, "{:?}", branch.stop);
            assert!(branch.points.iter().all(|point| !point.events.contains(&EventKind::Kink)));
            assert!(branch.crossings.is_empty());
            branch.evaluations as f64 / branch.points.len() as f64
        });
        assert!(free < 3.0 * even, "{free} evaluations a point instead of {even}");
    }
}

/// Angular frequency at 1.5 and 3 times the energy of grazing, and that energy.
fn figures(model: &StructuralModel) -> ([f64; 2], f64) {
    let structure = condense(model);
    let start = nlmodes_hbm::grazing(&structure, 1).unwrap();
    ([1.5, 3.0].map(|r| start.omega * frequency_ratio(&structure, 2, Switching::Exact, r)), start.energy)
}

fn assert_scaled(name: &str, found: ([f64; 2], f64), from: ([f64; 2], f64), frequency: f64, energy: f64) {
    for (found, from) in found.0.iter().zip(from.0) {
        assert!((found / from / frequency - 1.0).abs() < 1e-10, "{name}: {found} against {from}");
    }
    assert!((found.1 / from.1 / energy - 1.0).abs() < 1e-10, "{name}: {} against {}", found.1, from.1);
}

#[test]
fn units_mass_and_gap_scale_frequency_and_energy_as_they_must() {
    let stop = |gap| [(20, Side::Positive, gap)];
    let in_metres = figures(&rod(20, 210e9, 9000.0, 20.0, &stop(0.5)));
    // EA in newtons stays, ρA goes from kg/m to t/mm, lengths times 1000, energies in N·mm.
    let in_millimetres = figures(&rod(20, 210e9, 9000.0 * 1e-6, 20e3, &stop(500.0)));
    assert_scaled("millimetres", in_millimetres, in_metres, 1.0, 1e3);
    let heavy = figures(&rod(20, 210e9, 4.0 * 9000.0, 20.0, &stop(0.5)));
    assert_scaled("fourfold mass", heavy, in_metres, 0.5, 1.0);
    let wide = figures(&rod(20, 210e9, 9000.0, 20.0, &stop(1.5)));
    assert_scaled("threefold gap", wide, in_metres, 1.0, 9.0);
    let stiff = figures(&rod(20, 4.0 * 210e9, 9000.0, 20.0, &stop(0.5)));
    assert_scaled("fourfold stiffness", stiff, in_metres, 2.0, 4.0);
}

#[test]
fn a_mirrored_stop_gives_the_mirrored_motion() {
    let [right, left] = [Side::Positive, Side::Negative].map(|side| {
        let structure = condense(&rod(12, 1.0, 1.0, 1.0, &[(12, side, 0.7)]));
        let (mut problem, start) = problem(&structure, 1, 3, Symmetry::Even, Switching::Exact);
        let branch = follow(&mut problem, &start, 2.0);
        let last = branch.points.last().unwrap();
        let history =
            problem.equidistant_histories(&last.x, structure.model().contacts(), 100, "").unwrap().swap_remove(0);
        (problem.omega(&last.x), history)
    });
    assert!((right.0 / left.0 - 1.0).abs() < 1e-11, "{} against {}", right.0, left.0);
    for j in 0..=100 {
        assert!((right.1.displacement[j] + left.1.displacement[j]).abs() < 1e-9, "{j}");
        assert!((right.1.velocity[j] + left.1.velocity[j]).abs() < 1e-8, "{j}");
        assert!((right.1.force[j] - left.1.force[j]).abs() < 1e-8, "{j}");
    }
    assert!((right.1.stop + left.1.stop).abs() < 1e-15 && right.1.stop == 0.7);
}

#[test]
fn fewer_held_modes_converge_to_all_of_them() {
    let model = rod(100, 210e9, 9000.0, 20.0, &[(100, Side::Positive, 0.5)]);
    let with = |count: usize| {
        let massless = MasslessContactModel::new(&model, &Drop).unwrap();
        let structure = CondensedStructure::new(massless, count).unwrap();
        let (mut problem, start) = problem(&structure, 1, 2, Symmetry::Even, Switching::Exact);
        let branch = follow(&mut problem, &start, 2.0);
        let point = &branch.points.last().unwrap().x;
        let modal = structure.modal_point(&mut problem, point, 0.0).unwrap();
        [modal.omega, modal.total_energy, modal.modal_amplitude, modal.coefficients.of(40)[2].re]
    };
    let all = with(99);
    // 66.556745713823 Hz in Python, without modes.
    assert!((all[0] / TAU - 66.556_745_713_823).abs() < 1e-8, "{}", all[0] / TAU);
    // What a rod loses beyond mode m is Σ_{k > m} (ν/ω_k)⁴ ~ m⁻³, and faster where m comes near the 99 there are.
    for (quantity, name) in ["frequency", "total energy", "modal amplitude", "second harmonic"].iter().enumerate() {
        let errors: Vec<(f64, f64)> =
            [4, 8, 16, 32].map(|count| (count as f64, (with(count)[quantity] / all[quantity] - 1.0).abs())).to_vec();
        assert!(fitted_slope(&errors) < -2.7, "{name}: {errors:?}");
        assert!(errors[3].1 < 1e-5, "{name}: {errors:?}");
    }
}

/// Modes are orthonormal by mass: what is put together of them is taken apart again, and the motion of a branch from
/// all of its degrees of freedom as from the reduced ones.
#[test]
fn modal_coordinates_are_those_that_a_motion_was_put_together_of() {
    let structure = condense(&rod(6, 2.0, 3.0, 1.0, &[(6, Side::Positive, 1.0)]));
    let model = structure.model();
    let (linear, dofs) = (linear_modes(model.mass(), model.stiffness(), 3).unwrap(), model.dofs().len());
    let eta = |k: usize, n: usize| Complex64::new(1.0 + k as f64, n as f64 - 0.5 * k as f64);
    let mut motion = HarmonicCoefficients::zeros(dofs, 2);
    for (d, n) in (0..dofs).flat_map(|d| (0..=2).map(move |n| (d, n))) {
        motion.of_mut(d)[n] = (0..3).map(|k| eta(k, n) * linear.shapes[(d, k)]).sum();
    }
    let found = structure.modal_coordinates(&motion, 3).unwrap();
    for (k, n) in (0..3).flat_map(|k| (0..=2).map(move |n| (k, n))) {
        assert!((found.of(k)[n] - eta(k, n)).norm() < 1e-12, "{k} {n}: {}", found.of(k)[n]);
    }
    assert!(structure.modal_coordinates(&HarmonicCoefficients::zeros(dofs - 1, 2), 3).is_err());
    let (mut problem, start) = problem(&structure, 1, 5, Symmetry::Even, Switching::Exact);
    let branch = follow(&mut problem, &start, 3.0);
    let x = &branch.points.last().unwrap().x;
    let (modal, whole) =
        (problem.motion(x, 0.0).unwrap().modal_coefficients(), structure.modal_point(&mut problem, x, 0.0).unwrap());
    let whole = structure.modal_coordinates(&whole.coefficients, 3).unwrap();
    for (k, n) in (0..3).flat_map(|k| (0..=5).map(move |n| (k, n))) {
        assert!((modal.of(k)[n] - whole.of(k)[n]).norm() < 1e-11, "{k} {n}: {} {}", modal.of(k)[n], whole.of(k)[n]);
    }
}
