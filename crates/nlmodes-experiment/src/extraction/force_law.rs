//! The force of a stop over the displacement into it: `F = k (x − g)^p`, and what a force cell makes of it.

use crate::extraction::folded::{Closed, Folded};
use crate::extraction::loss::least_squares;

/// Shares of the peak between which the law is fitted.
const FROM: f64 = 0.12;
/// Exponents that are tried.
const EXPONENTS: std::ops::Range<usize> = 8..61;
/// Their unit.
const FINE: f64 = 0.05;
/// Fewest bins of a fit.
const FEWEST: usize = 8;
/// Correlation of force and displacement below which they do not rise together, as at a rigid stop.
const TOGETHER: f64 = 0.9;
/// Errors of a mean displacement that the stop must yield.
const YIELDS: f64 = 20.0;

/// A law of the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceLaw {
    /// Exponent `p`: 1 of a spring, 1.5 of a Hertz contact, less than 1 where the force saturates.
    pub exponent: f64,
    /// Displacement at which the force begins, m.
    pub stop: f64,
    /// Standard error of the latter, m.
    pub stop_error: f64,
    /// Whether it is that of a spring or of a Hertz contact, and noise explains what it leaves of the force.
    pub explains: bool,
}

/// Points of the mean period, each `[x, F]`.
type Points = Vec<[f64; 2]>;

impl ForceLaw {
    /// Of the mean period; `None` where the stop does not yield measurably.
    pub fn of(folded: &Folded) -> Option<Self> {
        let peak = folded.peak();
        let least = folded.threshold().max(FROM * peak);
        let pairs = folded.displacement.iter().zip(&folded.force);
        let points: Points = pairs.filter(|(_, f)| **f > least).map(|(x, f)| [*x, f / peak]).collect();
        let span = range(&points);
        if points.len() < FEWEST || span < YIELDS * folded.displacement_error || correlation(&points) < TOGETHER {
            return None;
        }
        let fits = EXPONENTS.filter_map(|i| power(&points, FINE * i as f64));
        let best = refined(&points, fits.min_by(|a, b| a.left.total_cmp(&b.left))?.exponent)?;
        let highest = points.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        // A spring or a Hertz contact, where the best exponent fits hardly better.
        let is_as_good = |fit: &Fit| fit.left < CURVED * best.left.max(NEGLIGIBLE);
        let known = LAWS.iter().filter_map(|exponent| power(&points, *exponent)).find(is_as_good);
        let law = known.unwrap_or(best);
        // What noise does not explain is no noise: it has no mean.
        let is_noise = law.left < UNEXPLAINED * (folded.force_error / peak).max(NEGLIGIBLE);
        let n = if is_noise { points.len() as f64 } else { 1.0 };
        let left = law.left.max(NEGLIGIBLE);
        // That it is one of these is known no better than the best exponent shows; an exponent, as far as what is left
        // grows beside it.
        let by_exponent = if known.is_some() {
            (best.stop - law.stop).abs()
        } else {
            let beside = power(&points, best.exponent + FINE)?;
            let growth = (beside.left.powi(2) - best.left.powi(2)).max(f64::MIN_POSITIVE);
            (beside.stop - best.stop).abs() * (left / (n * growth).sqrt()).min(1.0)
        };
        (highest > law.stop).then_some(Self {
            exponent: law.exponent,
            stop: law.stop,
            stop_error: by_exponent.hypot(LEVER * left * (highest - law.stop) / n.sqrt()),
            explains: is_noise && known.is_some(),
        })
    }
}

/// The best exponent within the grid about this one.
fn refined(points: &Points, exponent: f64) -> Option<Fit> {
    let (mut low, mut high) = (exponent - FINE, exponent + FINE);
    let left = |exponent: f64| power(points, exponent).map_or(f64::INFINITY, |fit| fit.left);
    for _ in 0..STEPS {
        let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if left(a) < left(b) { high = b } else { low = a }
    }
    power(points, 0.5 * (low + high))
}

/// Steps to the best exponent, each by a third.
const STEPS: usize = 20;
/// Exponents of a spring and of a Hertz contact.
const LAWS: [f64; 2] = [1.0, 1.5];
/// Factor by which another exponent must fit better than these.
const CURVED: f64 = 1.5;
/// Factor on the noise of the mean period beyond which it does not explain a misfit.
const UNEXPLAINED: f64 = 2.0;
/// Error of the place at which the force begins, over that of a displacement within the contact: it is extrapolated,
/// with an exponent that is free.
const LEVER: f64 = 6.0;
/// Share of the peak within which a fit is as good as any.
const NEGLIGIBLE: f64 = 2e-3;

#[derive(Debug, Clone, Copy)]
struct Fit {
    exponent: f64,
    stop: f64,
    left: f64,
}

/// The law with this exponent: `F^(1/p)` is a line in the displacement, weighted as the force is.
fn power(points: &Points, exponent: f64) -> Option<Fit> {
    let origin = points[0][0];
    let row = |[x, f]: &[f64; 2]| {
        let root = f.powf(exponent.recip());
        // dF = p F^(1 − 1/p) d(F^(1/p)).
        let weight = exponent * f / root;
        (vec![weight, weight * (x - origin)], weight * root)
    };
    let rows: Vec<(Vec<f64>, f64)> = points.iter().map(row).collect();
    let (line, ..) = least_squares(&rows)?;
    if line[1] <= 0.0 {
        return None;
    }
    let stop = origin - line[0] / line[1];
    let model = |x: f64| (line[1] * (x - stop)).max(0.0).powf(exponent);
    let squares: f64 = points.iter().map(|[x, f]| (f - model(*x)).powi(2)).sum();
    Some(Fit { exponent, stop, left: (squares / points.len() as f64).sqrt() })
}

fn range(points: &Points) -> f64 {
    let (low, high) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[0]), h.max(p[0])));
    high - low
}

fn correlation(points: &Points) -> f64 {
    let n = points.len().max(1) as f64;
    let mean = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / n;
    let (x, f) = (mean(0), mean(1));
    let sum = |i: usize, j: usize| points.iter().map(|p| (p[i] - [x, f][i]) * (p[j] - [x, f][j])).sum::<f64>();
    sum(0, 1) / (sum(0, 0) * sum(1, 1)).sqrt()
}

/// How late (s) a force is for which the stop would give out energy; `None` where it takes energy, as all do.
/// `omega` is in rad/s.
pub fn late(folded: &Folded, spans: &[Closed], omega: f64) -> Option<f64> {
    let n = folded.phase.len();
    let turn = std::f64::consts::TAU;
    let (mut work, mut rate, mut size, mut noise) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..n {
        let j = (i + 1) % n;
        let width = (folded.phase[j] - folded.phase[i]).rem_euclid(turn);
        let middle = folded.phase[i] + 0.5 * width;
        // Up to half of the contact behind it a force that comes late is still there.
        let is_near = spans.iter().any(|span| {
            let length = span.leaving - span.touching;
            (middle - span.touching + 0.5 * length).rem_euclid(turn) < 2.0 * length
        });
        if !is_near {
            continue;
        }
        let (dx, df) = (folded.displacement[j] - folded.displacement[i], folded.force[j] - folded.force[i]);
        let force = 0.5 * (folded.force[j] + folded.force[i]);
        work += force * dx;
        size += (force * dx).abs();
        noise += (folded.force_error * dx).powi(2);
        rate += df * dx / width;
    }
    let is_given = -work > (GIVEN * size).max(SIGNIFICANT * f64::sqrt(noise)) && rate > 0.0;
    is_given.then(|| -work / rate / omega)
}

/// Standard errors that it must have.
const SIGNIFICANT: f64 = 6.0;
/// Share of the work that goes to and fro which a stop must give out to be late.
const GIVEN: f64 = 0.04;

/// Root mean square of the force while the contact is open, about where it rests, over the peak, and the harmonic
/// that is strongest in it; `None` where noise explains it.
pub fn rings(folded: &Folded, spans: &[Closed]) -> Option<(f64, usize)> {
    let closed: f64 = spans.iter().map(|span| span.leaving - span.touching).sum();
    let open = folded.open_bins(spans, MARGIN * closed);
    if open.len() < FEWEST {
        return None;
    }
    let mean = open.iter().map(|i| folded.force[*i]).sum::<f64>() / open.len() as f64;
    let square = open.iter().map(|i| (folded.force[*i] - mean).powi(2)).sum::<f64>() / open.len() as f64;
    let own = (square - folded.force_error.powi(2)).max(0.0).sqrt();
    let is_there = own > RINGS * folded.peak() && square > 2.0 * folded.force_error.powi(2);
    let harmonic = |n: usize| {
        let term =
            |i: &usize| num_complex::Complex64::from_polar(folded.force[*i] - mean, -(n as f64) * folded.phase[*i]);
        open.iter().map(term).sum::<num_complex::Complex64>().norm()
    };
    let strongest = (1..folded.phase.len() / 2).max_by(|a, b| harmonic(*a).total_cmp(&harmonic(*b)))?;
    is_there.then_some((own / folded.peak(), strongest))
}

/// Share of the closed time that is left out behind and before a contact.
const MARGIN: f64 = 0.1;
/// Share of the peak from which on a force while open is one.
const RINGS: f64 = 0.015;

#[cfg(test)]
mod tests {
    use super::*;

    fn folded(law: impl Fn(f64) -> f64, late: f64) -> Folded {
        let n = 400;
        let phase: Vec<f64> = (0..n).map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(n)).collect();
        let at = |t: f64| 1e-3 * t.cos();
        Folded {
            force: phase.iter().map(|t| law(at(t - late))).collect(),
            displacement: phase.iter().map(|t| at(*t)).collect(),
            phase,
            ..Folded::default()
        }
    }

    #[test]
    fn springs_hertz_contacts_and_saturated_cells_are_told_apart() {
        let spring = |x: f64| (1e5 * (x - 8e-4)).max(0.0);
        for (law, exponent) in [
            (folded(spring, 0.0), 1.0),
            (folded(|x| 1e7 * (x - 8e-4).max(0.0).powf(1.5), 0.0), 1.5),
            (folded(|x| 15.0 * (spring(x) / 15.0).tanh(), 0.0), 0.6),
        ] {
            let found = ForceLaw::of(&law).unwrap();
            assert!((found.exponent - exponent).abs() < 0.11, "{found:?} {exponent}");
            assert!((found.stop - 8e-4).abs() < 2e-5, "{found:?}");
        }
        // A rigid stop.
        assert!(ForceLaw::of(&folded(|x| if x > 8e-4 { 1.0 } else { 0.0 }, 0.0)).is_none());
    }

    #[test]
    fn a_late_force_gives_out_energy_and_has_its_delay() {
        let spring = |x: f64| (1e5 * (x - 8e-4)).max(0.0);
        for (by, is_late) in [(0.03, true), (-0.03, false), (0.0, false)] {
            let folded = folded(spring, by);
            let found = late(&folded, &folded.beyond(8e-4), 100.0);
            assert_eq!(found.is_some(), is_late, "{by} {found:?}");
            assert!(found.is_none_or(|found| (found / 3e-4 - 1.0).abs() < 0.1), "{found:?}");
        }
    }

    #[test]
    fn a_cell_that_rings_is_heard() {
        let mut folded = folded(|x: f64| (1e5 * (x - 8e-4)).max(0.0), 0.0);
        let spans = folded.beyond(8e-4);
        assert_eq!(rings(&folded, &spans), None);
        for (force, phase) in folded.force.iter_mut().zip(&folded.phase) {
            *force += 3.0 * (-0.5 * phase).exp() * (31.0 * phase).sin();
        }
        let (share, harmonic) = rings(&folded, &spans).unwrap();
        assert!(harmonic.abs_diff(31) <= 1 && share > 0.015 && share < 0.1, "{share} {harmonic}");
    }
}
