//! Floquet multipliers compared with the growth of disturbances.

use crate::support;

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Continuation, ParametricSystem, StepSettings};
use nlmodes_timestep::{Floquet, PeriodicMotion, Shooting};
use support::{dynamics, unit_rod};

fn motions(elements: usize, ratio: f64) -> (Shooting, Vec<PeriodicMotion>) {
    let (mut shooting, x, direction) = Shooting::from_grazing(dynamics(&unit_rod(elements)), 1).unwrap();
    let method = Continuation {
        step: StepSettings { tolerance: 1e-12, ..StepSettings::default() },
        bounds: vec![Bound { coordinate: shooting.dim(), min: -3.0, max: ratio.ln() }],
        max_points: 400,
        ..Continuation::default()
    };
    let branch = method.run(&mut shooting, &x, 0.0, &direction, |_| ControlFlow::Continue(())).unwrap();
    let motions = branch.points.iter().map(|p| shooting.motion(&p.x).unwrap()).collect();
    (shooting, motions)
}

/// Distance from the motion after each of this many periods, in the energy norm of the open structure.
fn distances(shooting: &mut Shooting, motion: &PeriodicMotion, periods: usize) -> Vec<f64> {
    let omega = shooting.dynamics().omega().to_vec();
    let mut state = motion.state.clone();
    state.z.iter_mut().zip(&omega).enumerate().for_each(|(k, (z, ω))| *z += 1e-10 / (ω * (k + 1) as f64));
    let mut found = Vec::new();
    for _ in 0..periods {
        state = shooting.dynamics().propagate(&state, TAU / motion.omega).unwrap().end;
        let gap = |a: &[f64], b: &[f64], k: usize| a[k] - b[k];
        let square: f64 = (0..omega.len())
            .map(|k| (omega[k] * gap(&state.z, &motion.state.z, k)).powi(2) + gap(&state.v, &motion.state.v, k).powi(2))
            .sum();
        found.push(square.sqrt());
    }
    found
}

#[test]
fn disturbances_of_an_unstable_motion_grow_by_its_largest_multiplier() {
    let (mut shooting, motions) = motions(5, 4.0);
    let largest: Vec<f64> = motions.iter().map(|m| Floquet::new(shooting.dynamics(), m).unwrap().largest()).collect();
    let at = (0..largest.len()).max_by(|&i, &j| largest[i].total_cmp(&largest[j])).unwrap();
    assert!(largest[at] > 1.05, "no unstable motion: {largest:?}");
    let found = distances(&mut shooting, &motions[at], 150);
    assert!(found[149] < 1e-3, "too far for what is linear: {:e}", found[149]);
    let growth = (found[149] / found[129]).powf(1.0 / 20.0);
    // The multiplier is real; by then the others, of magnitude one, are below a thousandth of it.
    assert!((growth / largest[at] - 1.0).abs() < 1e-3, "{growth} and {}", largest[at]);
}

#[test]
fn disturbances_of_a_stable_motion_grow_no_faster_than_time() {
    let (mut shooting, motions) = motions(5, 4.0);
    let mut tested = 0;
    for motion in motions.iter().skip(2).step_by(9) {
        let floquet = Floquet::new(shooting.dynamics(), motion).unwrap();
        if floquet.is_stable() && floquet.largest() < 1.0 + 1e-9 {
            let found = distances(&mut shooting, motion, 400);
            // A disturbance changes the energy and with it the period: it drifts away along the motion, linearly in
            // time.
            assert!(found[399] < 8.0 * found[99], "{:e} and {:e} at {}", found[99], found[399], motion.omega);
            tested += 1;
        }
    }
    assert!(tested >= 3, "{tested}");
}
