//! Motions of twice the period of their load.

use nlmodes::response::{
    Event, ResponseCurve, ResponseModel, ResponsePoint, ResponseSettings, Stability, branching_responses,
};
use nlmodes_timestep::ForcedMotion;
use num_complex::Complex64;

use crate::response::integrated::masses::Masses;

const CASES: [Masses; 2] = [
    Masses { mass: 1.0, stiffness: 1.0, gap: 1.0, force: 1.0, damping: 0.03, stop: 3.0 },
    Masses { mass: 3.0, stiffness: 4e6, gap: 2e-4, force: 1.0, damping: 0.03, stop: 3.0 },
];

fn curves(masses: &Masses, harmonics: usize) -> (ResponseModel, Vec<ResponseCurve>) {
    let model = masses.model();
    let window = [1.2, 1.5].map(|w| w * masses.frequency());
    let settings = ResponseSettings { harmonics, subharmonic: 2, ..ResponseSettings::new(window) };
    let curves = branching_responses(&model, masses.level(), &settings).unwrap();
    (model, curves)
}

/// Amplitudes of the drive point at half the frequency of the load and at that of the load.
fn amplitudes(model: &ResponseModel, point: &ResponsePoint) -> [Complex64; 2] {
    let q = model.displacement(&model.row(1).unwrap(), &point.motion, 2);
    [q[1], q[2]]
}

fn exact_amplitudes(model: &ResponseModel, motion: &ForcedMotion) -> [Complex64; 2] {
    let row = model.row(1).unwrap();
    let at = |n: usize| row.modes.iter().enumerate().map(|(k, phi)| motion.modal_harmonic(k, n) * *phi).sum();
    [at(1), at(2)]
}

fn is_stable(point: &ResponsePoint) -> bool {
    matches!(point.stability, Some(Stability { stable: Some(true), .. }))
}

/// The stable point of the doubled branch nearest to a frequency.
fn stable_near<'a>(curve: &'a ResponseCurve, masses: &Masses, frequency: f64) -> &'a ResponsePoint {
    let off = |p: &&ResponsePoint| (p.omega / masses.frequency() - frequency).abs();
    curve.points.iter().filter(|p| is_stable(p)).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
}

#[test]
fn the_branch_behind_a_period_doubling_is_that_of_an_integration_in_time() {
    for masses in CASES {
        let (model, curves) = curves(&masses, 40);
        // The response with the period of the load loses its stability where it begins to touch ...
        let doubling = |p: &&ResponsePoint| p.events.contains(&Event::PeriodDoubling);
        let doublings: Vec<&ResponsePoint> = curves[0].points.iter().filter(doubling).collect();
        assert_eq!((doublings.len(), curves.len()), (1, 2));
        let exact = masses.exact(&model, doublings[0], 1).unwrap();
        let nearest = exact.multipliers.iter().map(|m| (m + 1.0).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-3, "{nearest:e}");
        // ... and the doubled branch leaves it there.
        let branch = &curves[1];
        assert!(branch.end.complete, "{:?}", branch.end);
        assert!((branch.points[0].omega / doublings[0].omega - 1.0).abs() < 1e-3);
        // Where it is stable, structures at rest come to it.
        let point = stable_near(branch, &masses, 1.4);
        let [half, _] = amplitudes(&model, point);
        assert!(half.norm() > masses.gap, "{half}");
        let (settled, _) = masses.integrate(point.omega, [0.0; 4], 120);
        let (_, amplitude) = masses.integrate(point.omega, settled, 2);
        assert!((amplitude.norm() / half.norm() - 1.0).abs() < 1e-5, "{amplitude} {half}");
        for point in &branch.points {
            let balance = point.motion.input_power / point.motion.dissipated_power - 1.0;
            assert!(balance.abs() < 1e-12, "{balance:e}");
        }
    }
}

#[test]
fn doubled_motions_come_to_the_exact_ones_with_more_harmonics_and_so_do_their_multipliers() {
    let masses = &CASES[0];
    let mut errors = Vec::new();
    for harmonics in [20, 80] {
        let (model, curves) = curves(masses, harmonics);
        let mut worst = [0.0_f64; 3];
        for frequency in [1.34, 1.4, 1.46] {
            let point = stable_near(&curves[1], masses, frequency);
            let exact = masses.exact(&model, point, 2).unwrap();
            assert!(exact.residual < 1e-12);
            let of = amplitudes(&model, point).into_iter().zip(exact_amplitudes(&model, &exact));
            let off = of.map(|(a, b)| (a - b).norm() / b.norm()).fold(0.0, f64::max);
            let peak = (point.motion.contacts[0].peak_force / exact.peak_force(0) - 1.0).abs();
            let (found, known) = (point.stability.unwrap(), exact.multipliers[0].norm());
            let multiplier = (found.magnitude() - known).abs();
            let error = found.error.unwrap();
            assert!(multiplier < 10.0 * error + 1e-7, "{multiplier:e} {error:e}");
            worst = [worst[0].max(off), worst[1].max(peak), worst[2].max(multiplier)];
        }
        errors.push(worst);
    }
    let [coarse, fine] = errors[..] else { panic!("two numbers of harmonics") };
    assert!(fine[0] < 1e-6 && fine[1] < 1e-6 && fine[2] < 1e-4, "{coarse:?} {fine:?}");
    assert!(fine[0] < 0.02 * coarse[0], "{coarse:?} {fine:?}");
}
