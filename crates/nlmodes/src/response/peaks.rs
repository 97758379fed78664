//! The largest amplitude and contact force of a response, located between its points.

use nlmodes_continuation::BranchPoint;
use nlmodes_hbm::Source;

use crate::response::follow::{CONVERGED, Curve};
use crate::response::{ResponseError, ResponsePoint};

/// Share of the longer part of an interval by which a maximum is narrowed down where parabolas do not.
const SECTION: f64 = 0.381_966_011_250_105_1;

/// How closely a maximum is located, over the distance of two points: what a quantity misses of its maximum is 1e-12 of
/// its change there. In this many steps at most.
const CLOSE: f64 = 1e-6;
const STEPS: usize = 40;

/// A quantity of a point of which the largest value is located.
type Quantity<'a> = &'a dyn Fn(&ResponsePoint) -> f64;

impl Curve<'_> {
    /// Puts a point where the amplitude of the watched displacement is largest, and one where the contact force is, on
    /// a curve over the frequency. What a parameter does to a maximum is its derivative at constant frequency there,
    /// and only there.
    pub fn locate_peaks(&mut self, points: Vec<ResponsePoint>) -> Result<Vec<ResponsePoint>, ResponseError> {
        let is_over_frequency = matches!(self.system.closing().omega, Source::Parameter { .. });
        if !is_over_frequency {
            return Ok(points);
        }
        let force = |point: &ResponsePoint| point.motion.contacts.iter().map(|c| c.peak_force).fold(0.0, f64::max);
        let points = self.with_largest(points, &|point| point.watched)?;
        self.with_largest(points, &force)
    }

    fn with_largest(
        &mut self,
        mut points: Vec<ResponsePoint>,
        of: Quantity<'_>,
    ) -> Result<Vec<ResponsePoint>, ResponseError> {
        let Some(k) = (0..points.len()).max_by(|&a, &b| of(&points[a]).total_cmp(&of(&points[b]))) else {
            return Ok(points);
        };
        // At an end of the window the curve may rise beyond it.
        if k == 0 || k + 1 == points.len() || of(&points[k]) <= 0.0 {
            return Ok(points);
        }
        let beside = [&points[k - 1], &points[k], &points[k + 1]].map(|point| {
            let mut z = point.solved.x.clone();
            z.push(point.solved.p);
            z
        });
        let at = |t: f64| between(&beside, t);
        let value = |curve: &mut Self, t: f64| {
            let found = curve.near_across(&at(t))?;
            Ok(if found.residual > CONVERGED { f64::NEG_INFINITY } else { of(&found) })
        };
        let ends = [0.0, 2.0].map(|t| (t, of(&points[k + t as usize - 1])));
        let Some(t) = self.largest(ends, (1.0, of(&points[k])), &value)? else { return Ok(points) };
        let found = self.point_across(&at(t))?;
        if found.residual <= CONVERGED && of(&found) >= of(&points[k]) {
            points.insert(if t < 1.0 { k } else { k + 1 }, found);
        }
        Ok(points)
    }

    /// Where a quantity is largest between two ends with a larger value between them, by Brent's method: parabolas
    /// through the three largest values, sections where those do not narrow it down. `None` if it was cut off.
    fn largest(
        &mut self,
        [mut low, mut high]: [(f64, f64); 2],
        mut best: (f64, f64),
        value: &dyn Fn(&mut Self, f64) -> Result<f64, ResponseError>,
    ) -> Result<Option<f64>, ResponseError> {
        let (mut second, mut third) = if low.1 > high.1 { (low, high) } else { (high, low) };
        let (mut step, mut before) = (high.0 - low.0, high.0 - low.0);
        for _ in 0..STEPS {
            let middle = 0.5 * (low.0 + high.0);
            if (best.0 - middle).abs() + 0.5 * (high.0 - low.0) <= 2.0 * CLOSE {
                break;
            }
            if self.settings.watch.asks_to_end() {
                return Ok(None);
            }
            let by = vertex(best, second, third);
            let narrows = by.abs() < 0.5 * before.abs() && low.0 < best.0 + by && best.0 + by < high.0;
            (before, step) = if narrows {
                (step, by)
            } else {
                let longer = if best.0 < middle { high.0 - best.0 } else { low.0 - best.0 };
                (longer, SECTION * longer)
            };
            let t = best.0 + step.abs().max(CLOSE).copysign(step);
            let found = (t, value(self, t)?);
            let (better, worse) = if found.1 >= best.1 { (found, best) } else { (best, found) };
            if worse.0 < better.0 {
                low = worse;
            } else {
                high = worse;
            }
            if found.1 >= best.1 {
                (third, second, best) = (second, best, found);
            } else if found.1 >= second.1 {
                (third, second) = (second, found);
            } else if found.1 >= third.1 {
                third = found;
            }
        }
        Ok(Some(best.0))
    }
}

/// How far the vertex of the parabola through three values is from the first of them.
fn vertex(first: (f64, f64), second: (f64, f64), third: (f64, f64)) -> f64 {
    let of = |other: (f64, f64)| (other.0 - first.0, other.1 - first.1);
    let [(a, of_a), (b, of_b)] = [of(second), of(third)];
    0.5 * (a * a * of_b - b * b * of_a) / (a * of_b - b * of_a)
}

/// A guess between three points, from 0 at the first to 2 at the last one.
fn between(beside: &[Vec<f64>; 3], t: f64) -> BranchPoint {
    let (from, to, share) = if t < 1.0 { (0, 1, t) } else { (1, 2, t - 1.0) };
    let (from, to) = (&beside[from], &beside[to]);
    let step: Vec<f64> = from.iter().zip(to).map(|(a, b)| b - a).collect();
    let length = step.iter().map(|s| s * s).sum::<f64>().sqrt();
    let mut x: Vec<f64> = from.iter().zip(&step).map(|(z, s)| z + share * s).collect();
    let p = x.pop().unwrap_or(0.0);
    BranchPoint::guess(x, p, step.iter().map(|s| s / length).collect())
}
