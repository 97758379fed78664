//! What each contact does over a period, against quadratures and differences of its motion, in two systems of units.

use crate::support;

use nlmodes_hbm::{Switching, Symmetry};
use nlmodes_modal::{ContactPeriod, TimeHistory};
use nlmodes_model::{Side, StructuralModel};
use support::{condense, follow, problem, rod};

/// Tip and middle, or both sides of the tip, in units in which lengths are `length`, stiffnesses `stiffness` and masses
/// `mass` times as large.
fn models(length: f64, stiffness: f64, mass: f64) -> [StructuralModel; 2] {
    let stops = |side, second, node| [(10, Side::Positive, length), (node, side, second * length)];
    // A rod of unit length: its stiffness is that of the section, its mass that of the whole.
    [stops(Side::Positive, 0.8, 5), stops(Side::Negative, 1.3, 10)].map(|s| rod(10, stiffness, mass, 1.0, &s))
}

/// Trapezoidal integral of the force; the instants of contact are among the samples.
fn impulse(history: &TimeHistory) -> f64 {
    let pairs = history.time.windows(2).zip(history.force.windows(2));
    pairs.map(|(t, f)| 0.5 * (t[1] - t[0]) * (f[0] + f[1])).sum()
}

/// Largest speed toward the stop at the samples just before the contact closes.
fn approach(history: &TimeHistory) -> f64 {
    let toward = history.stop.signum();
    let before = |t: f64| history.time.partition_point(|at| *at < t * (1.0 - 1e-12));
    let touching = history.instants.iter().filter(|instant| instant.touching);
    touching.map(|instant| toward * history.velocity[before(instant.time)]).fold(0.0, f64::max)
}

#[test]
fn shares_forces_impulses_and_approach_are_those_of_the_motion() {
    for (length, stiffness, mass) in [(1.0, 1.0, 1.0), (1e-3, 2.1e8, 0.3)] {
        for model in models(length, stiffness, mass) {
            for symmetry in [Symmetry::Even, Symmetry::None] {
                let structure = condense(&model);
                let (mut problem, start) = problem(&structure, 1, 3, symmetry, Switching::Exact);
                let branch = follow(&mut problem, &start, 3.0);
                for point in branch.points.iter().skip(1).step_by(4).chain(branch.points.last()) {
                    let modal = structure.modal_point(&mut problem, &point.x, point.residual).unwrap();
                    let histories = problem.time_histories(&point.x, structure.model().contacts(), 6000, "").unwrap();
                    assert_eq!(modal.contacts.len(), 2);
                    let few = problem.time_histories(&point.x, structure.model().contacts(), 200, "").unwrap();
                    modal.contacts.iter().zip(&few).for_each(|(found, history)| keeps_its_blows(found, history));
                    for (found, history) in modal.contacts.iter().zip(&histories) {
                        check(found, history, std::f64::consts::TAU / modal.omega);
                    }
                    let first = modal.contacts[0];
                    assert_eq!(
                        (modal.contact_fraction, modal.peak_contact_force),
                        (first.closed_share, modal.contacts.iter().map(|c| c.peak_force).fold(0.0, f64::max),)
                    );
                }
                let last = structure.modal_point(&mut problem, &branch.points.last().unwrap().x, 0.0).unwrap();
                assert!(last.contacts[0].impulse > 0.0 && last.contacts[0].touches > 0);
            }
        }
    }
}

/// Few instants have the largest force of the shortest blow too. Of 16 intervals of a half-sine it lies between two by
/// 1 − cos(π/32).
fn keeps_its_blows(found: &ContactPeriod, history: &TimeHistory) {
    let peak = history.force.iter().copied().fold(0.0, f64::max);
    assert!(found.closed_share < 1e-6 || (peak / found.peak_force - 1.0).abs() < 0.01, "{peak:e} of {found:?}");
}

fn check(found: &ContactPeriod, history: &TimeHistory, period: f64) {
    assert!(history.time.windows(2).all(|t| t[0] < t[1]));
    // At grazing forces are rounding.
    if found.closed_share < 1e-3 {
        return;
    }
    let size = found.peak_force.max(1e-300) * period;
    // The trapezoidal rule, 6000 samples: 1e-7 of the force's curvature.
    assert!((found.impulse - impulse(history)).abs() < 2e-6 * size, "{found:?} against {:e}", impulse(history));
    assert!((found.mean_force * period - found.impulse).abs() < 1e-12 * size);
    let peak = history.force.iter().copied().fold(0.0, f64::max);
    assert!((found.peak_force - peak).abs() < 1e-4 * peak, "{found:?} against {peak:e}");
    let touching = history.instants.iter().filter(|instant| instant.touching).count();
    assert_eq!(found.touches.max(touching) - touching, 0, "{found:?}");
    let speed = approach(history);
    assert!((found.approach_velocity - speed).abs() < 1e-6 * speed, "{found:?} against {speed:e}");
    let closed: f64 = history
        .instants
        .chunks(2)
        .filter(|pair| pair.len() == 2 && pair[0].touching)
        .map(|p| p[1].time - p[0].time)
        .sum();
    let around = history.instants.first().is_some_and(|instant| !instant.touching);
    assert!(around || (found.closed_share - closed / period).abs() < 1e-9, "{found:?}");
    // Nothing is pushed where there is a gap, and no gap is passed.
    for (force, displacement) in history.force.iter().zip(&history.displacement) {
        let gap = history.stop.signum() * (history.stop - displacement) / history.stop.abs();
        assert!(gap > -1e-9 && *force > -1e-9 * found.peak_force && (gap < 1e-9 || *force < 1e-9 * found.peak_force));
    }
}
