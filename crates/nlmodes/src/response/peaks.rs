//! The largest amplitude and contact force of a response, located between its points.

use nlmodes_continuation::BranchPoint;
use nlmodes_hbm::Source;

use crate::response::follow::{CONVERGED, Curve};
use crate::response::{ResponseError, ResponsePoint};

/// Section of an interval by which a maximum is narrowed down, and how often: to 1e-6 of the interval, where what a
/// quantity misses of its maximum is 1e-12 of its change there.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
const SECTIONS: usize = 29;

/// A quantity of a point of which the largest value is located.
type Quantity<'a> = &'a dyn Fn(&ResponsePoint) -> f64;

impl Curve<'_> {
    /// Puts a point where the amplitude of the watched displacement is largest, and one where the contact force is:
    /// what a parameter does to a maximum is its derivative at constant frequency there, and only there.
    pub fn locate_peaks(&mut self, points: Vec<ResponsePoint>) -> Result<Vec<ResponsePoint>, ResponseError> {
        let is_over_frequency = matches!(self.system.closing().omega, Source::Parameter { .. });
        if self.settings.gradients.changes.is_empty() || !is_over_frequency {
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
        let value = |curve: &mut Self, t: f64| -> Result<f64, ResponseError> {
            let found = curve.near_across(&at(t))?;
            Ok(if found.residual > CONVERGED { f64::NEG_INFINITY } else { of(&found) })
        };
        let (mut low, mut high) = (0.0, 2.0);
        let inner = |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let [mut a, mut b] = inner(low, high);
        let (mut of_a, mut of_b) = (value(self, a)?, value(self, b)?);
        for _ in 0..SECTIONS {
            if self.settings.watch.asks_to_end() {
                return Ok(points);
            }
            if of_a > of_b {
                (high, b, of_b) = (b, a, of_a);
                a = inner(low, high)[0];
                of_a = value(self, a)?;
            } else {
                (low, a, of_a) = (a, b, of_b);
                b = inner(low, high)[1];
                of_b = value(self, b)?;
            }
        }
        let t = 0.5 * (low + high);
        let found = self.point_across(&at(t))?;
        if found.residual <= CONVERGED && of(&found) >= of(&points[k]) {
            points.insert(if t < 1.0 { k } else { k + 1 }, found);
        }
        Ok(points)
    }
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
