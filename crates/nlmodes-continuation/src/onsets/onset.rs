//! What sets in beyond a boundary.

use nlmodes_linalg::{DenseLu, Mat};

use crate::corrector::Corrector;
use crate::expansion::{ABOVE_ROUNDING, DEPTH, POWERS};
use crate::vectors::{along, dot};
use crate::{Linearization, ParametricSystem};

/// How much more sets in on one side of a boundary than on the other.
const ONE_SIDED: f64 = 10.0;

/// Ratio of the pivots below which gradients are not told apart.
const DEPENDENT: f64 = 1e-6;

/// What sets in beyond a boundary.
pub(super) struct Onset {
    /// Unit vector away from what sets in.
    pub slope: Vec<f64>,
    /// The vector that leads beyond this boundary by one, and along the others.
    pub inward: Vec<f64>,
    /// What sets in: a vector of unit length over the sizes of the equations, and its length at the depth [`DEPTH`].
    pub force: Vec<f64>,
    pub length: f64,
    /// Power of the depth with which that grows.
    pub power: f64,
}

impl Onset {
    /// What sets in at `z` beyond the boundary with this gradient of unit length, on the one side or the other;
    /// `across` leads across it alone.
    pub fn measured<S: ParametricSystem>(
        system: &mut S,
        corrector: &mut Corrector,
        z: &[f64],
        slope: &[f64],
        across: &[f64],
    ) -> Option<Self> {
        // At a multiple of the depth, each entry over the size of its equation.
        let mut residual = |s: f64| {
            corrector.evaluate(system, &along(z, s * DEPTH, across)).ok()?;
            let Linearization { residual, sizes, .. } = corrector.linearization();
            Some(residual.iter().zip(sizes).map(|(r, size)| r / size).collect::<Vec<f64>>())
        };
        let here = residual(0.0)?;
        // What is not linear.
        let mut bent = |s: f64| {
            let (near, far) = (residual(s)?, residual(2.0 * s)?);
            Some(
                far.iter()
                    .zip(&near)
                    .zip(&here)
                    .map(|((far, near), here)| far - 2.0 * near + here)
                    .collect::<Vec<f64>>(),
            )
        };
        let (up, down) = (bent(1.0)?, bent(-1.0)?);
        let (sign, force, other) = if size(&up) > size(&down) { (1.0, up, down) } else { (-1.0, down, up) };
        let (length, twice) = (size(&force), size(&bent(2.0 * sign)?));
        let power = (twice / length).log2();
        let rounding = corrector.rounding.iter().fold(0.0_f64, |m, r| m.max(*r));
        if !(length > (ONE_SIDED * size(&other)).max(ABOVE_ROUNDING * rounding) && POWERS.contains(&power)) {
            return None;
        }
        let sizes = &corrector.linearization().sizes;
        Some(Self {
            slope: slope.iter().map(|s| -sign * s).collect(),
            inward: across.iter().map(|a| sign * a).collect(),
            force: force.iter().zip(sizes).map(|(f, size)| f * size / length).collect(),
            length: length / (power.exp2() - 2.0),
            power,
        })
    }
}

fn size(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

/// Vectors in the span of these whose products with them are one for the same and zero for the others.
pub(super) fn dual(slopes: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let k = slopes.len();
    let lu = DenseLu::factor(&Mat::from_fn(k, k, |i, j| dot(&slopes[i], &slopes[j]))).ok()?;
    if lu.pivot_ratio() < DEPENDENT {
        return None;
    }
    let dual = (0..k).map(|j| {
        let mut weights: Vec<f64> = (0..k).map(|i| if i == j { 1.0 } else { 0.0 }).collect();
        lu.solve_in_place(&mut weights);
        slopes.iter().zip(weights).fold(vec![0.0; slopes[0].len()], |sum, (slope, w)| along(&sum, w, slope))
    });
    Some(dual.collect())
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    /// `a (x − p) + k max(± x, 0)^power = 0`.
    struct Stop {
        a: f64,
        k: f64,
        side: f64,
        power: f64,
    }

    impl ParametricSystem for Stop {
        type Error = Infallible;

        fn dim(&self) -> usize {
            1
        }

        fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
            let depth = (self.side * x[0]).max(0.0);
            out.residual[0] = self.a * (x[0] - p) + self.k * depth.powf(self.power);
            let slope = self.k * self.power * self.side * depth.powf(self.power - 1.0);
            (out.jacobian[(0, 0)], out.jacobian[(0, 1)]) = (self.a + slope, -self.a);
            Ok(())
        }
    }

    /// Beside what is linear, `k d^power` at the depth `d`, on the side on which it sets in.
    #[test]
    fn what_sets_in_is_measured_with_its_power_size_and_side() {
        for (a, k, power) in [(0.0, 4.0, 1.5), (30.0, 4.0, 1.5), (-2.0, -9.0, 2.0), (0.7, 3e3, 2.0)] {
            for side in [1.0, -1.0] {
                let mut corrector = Corrector::new(1, 1e-11, 8);
                let mut stop = Stop { a, k, side, power };
                let found = Onset::measured(&mut stop, &mut corrector, &[0.0; 2], &[-1.0, 0.0], &[1.0, 0.0]).unwrap();
                let expected = f64::abs(k) * DEPTH.powf(power);
                assert!((found.power - power).abs() < 1e-3, "{a} {k} {side}: {}", found.power);
                assert!((found.length / expected - 1.0).abs() < 5e-3, "{a} {k} {side}: {:e}", found.length);
                assert!((found.inward[0] - side).abs() < 1e-12 && (found.force[0] - k.signum()).abs() < 5e-3);
            }
        }
        let mut corrector = Corrector::new(1, 1e-11, 8);
        let mut measured = |k: f64, power: f64| {
            let mut stop = Stop { a: 1.0, k, side: 1.0, power };
            Onset::measured(&mut stop, &mut corrector, &[0.0; 2], &[-1.0, 0.0], &[1.0, 0.0]).is_some()
        };
        assert!(
            measured(4.0, 1.5) && !measured(0.0, 1.5) && !measured(4.0, 3.0),
            "nothing, and what sets in too softly"
        );
    }

    #[test]
    fn dual_vectors_have_products_of_one_and_zero_and_dependent_ones_have_none() {
        let slopes = vec![vec![1.0, 2.0, 0.5, 0.0], vec![-0.3, 1.0, 4.0, 0.2], vec![0.0, 0.7, -1.0, 3.0]];
        let found = dual(&slopes).unwrap();
        for (i, slope) in slopes.iter().enumerate() {
            for (j, own) in found.iter().enumerate() {
                assert!((dot(slope, own) - f64::from(u8::from(i == j))).abs() < 1e-13, "({i}, {j})");
            }
        }
        // In their span: across what all of them are across.
        let with_one_more = [slopes.clone(), vec![vec![0.1, 0.2, 0.3, 0.4]]].concat();
        let across = dual(&with_one_more).unwrap().pop().unwrap();
        assert!(found.iter().all(|own| dot(own, &across).abs() < 1e-13));
        assert_eq!(dual(&[slopes[0].clone(), slopes[0].clone()]), None);
    }
}
