//! The rod of three elements in units `EA = ρA = L = g₀ = 1`, consistent mass, that of the tip dropped; its branch by
//! shooting, from grazing on.

use crate::support;

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Branch, Continuation, StepSettings, StopReason};
use nlmodes_timestep::{Floquet, Shooting};
use support::{dynamics, unit_rod};

/// The branch of mode 1 from grazing up to a frequency, Hz.
fn branch_to(shooting: &mut Shooting, x: &[f64], direction: &[f64], hertz: f64) -> Branch {
    let index = shooting.frequency_index();
    let max = hertz * TAU * x[index] / shooting.omega(x);
    let method = Continuation {
        step: StepSettings { tolerance: 1e-13, ..StepSettings::default() },
        bounds: vec![Bound { coordinate: index, min: 0.5, max }],
        ..Continuation::default()
    };
    method.run(shooting, x, 0.0, direction, |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn energies_at_a_frequency_are_those_known_from_elsewhere() {
    let (mut shooting, x, direction) = Shooting::from_grazing(dynamics(&unit_rod(3)), 1).unwrap();
    let branch = branch_to(&mut shooting, &x, &direction, 0.34155);
    assert!(matches!(branch.stop, StopReason::Bound { .. }), "{:?}", branch.stop);
    let last = branch.points.last().unwrap();
    let motion = shooting.motion(&last.x).unwrap();
    assert!((motion.omega / TAU / 0.34155 - 1.0).abs() < 1e-14);
    // From another program. The frequency is exact to its last digit; energies change by 55 times its relative change.
    assert!((motion.total_energy / 1.630_176_961_523_382 - 1.0).abs() < 1e-12, "{}", motion.total_energy);
    assert!((motion.kinetic_energy / 0.842_186_695_352_613 - 1.0).abs() < 1e-12, "{}", motion.kinetic_energy);
    assert_eq!(motion.trajectory.closed_intervals().len(), 2);
}

#[test]
fn every_point_of_the_branch_returns_after_its_full_period() {
    let (mut shooting, x, direction) = Shooting::from_grazing(dynamics(&unit_rod(3)), 1).unwrap();
    let branch = branch_to(&mut shooting, &x, &direction, 0.36);
    assert!(branch.points.len() > 10 && matches!(branch.stop, StopReason::Bound { .. }));
    let known = shooting.dynamics().omega().to_vec();
    for point in &branch.points {
        let motion = shooting.motion(&point.x).unwrap();
        let (end, start) = (&motion.trajectory.end, &motion.state);
        for (k, ω) in known.iter().enumerate() {
            let missing = (ω * (end.z[k] - start.z[k])).abs().max((end.v[k] - start.v[k]).abs());
            assert!(missing < 1e-11 * motion.total_energy.sqrt(), "mode {k}: {missing:e}");
        }
        // Forward and backward in time are alike: with μ also 1/μ and its conjugate, and their product is one.
        let floquet = Floquet::new(shooting.dynamics(), &motion).unwrap();
        let product = floquet.multipliers.iter().product::<num_complex::Complex64>();
        assert!((product.re - 1.0).abs() < 1e-9 && product.im.abs() < 1e-9, "{:?}", floquet.multipliers);
        assert!(floquet.trivial_defect < 1e-9, "{:e}", floquet.trivial_defect);
    }
}
