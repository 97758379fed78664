//! Complementarity at a few points, recomputed from the motions of the contacts.

use nlmodes::branches::{ComputedBranch, Histories};
use nlmodes::modal::TimeHistory;

use super::{Check, Worst, listed};

const NAME: &str = "contact law";
/// Contact problems are solved to 1e-10; the motion adds the rounding of its series.
const LIMIT: f64 = 1e-8;
/// Instants per period, in addition to those at which contacts close and open.
const SAMPLES: usize = 256;

/// Largest of `|min(λ/λ_max, g/q_max)|` over all contacts and a period.
pub fn complementarity(computed: &ComputedBranch, points: &[usize]) -> Check {
    let mut histories = Histories::of(computed);
    let strongest = computed.branch.points.iter().fold(f64::MIN_POSITIVE, |m, p| m.max(p.peak_contact_force));
    let mut worst = Worst::default();
    for &point in points {
        match histories.at(point, SAMPLES, "") {
            Ok(motions) => worst.take(point, violation(computed, strongest, &motions)),
            Err(error) => return Check::missing(NAME, None, format!("point {point}: {error}"), "`verify`"),
        }
    }
    let words = format!(
        "no force pulls, no gap is negative, none of both at once: largest |min(λ/λ_max, g/q_max)| over a period, {}",
        listed(points, &computed.branch.points)
    );
    Check::found(NAME, worst.value, LIMIT, words).at(&worst)
}

pub(super) fn violation(computed: &ComputedBranch, strongest: f64, motions: &[TimeHistory]) -> f64 {
    let widest = motions.iter().flat_map(|m| &m.displacement).fold(f64::MIN_POSITIVE, |m, q| q.abs().max(m));
    let mut worst = 0.0_f64;
    for (motion, contact) in motions.iter().zip(computed.structure.model().contacts()) {
        for (q, force) in motion.displacement.iter().zip(&motion.force) {
            // What an elastic stop yields belongs to the gap.
            let gap = contact.gap + contact.direction() * q + contact.stop_compliance() * force;
            worst = worst.max((force / strongest).min(gap / widest).abs());
        }
    }
    worst
}
