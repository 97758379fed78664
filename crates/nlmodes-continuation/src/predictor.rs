//! The predictor: where the branch is expected, from points and tangents that are known.

use crate::step::BasePoint;
use crate::vectors::{along, distance, dot};

/// Longest step, over the one before, for which the curve through the last two points is continued.
const EXTRAPOLATED: f64 = 2.0;

/// Largest distance of the prediction from the tangent, over the step, that is credible.
const OFF_TANGENT: f64 = 0.2;

/// Smallest component of a tangent along that of the base point with which a curve is interpolated.
const STEEPEST: f64 = 0.2;

/// A point of the branch and the tangent there, as far as a predictor needs them.
#[derive(Debug, Clone)]
pub(crate) struct Behind {
    pub z: Vec<f64>,
    pub tangent: Vec<f64>,
}

/// Where the branch is expected on the plane at the distance `h` along the tangent of the base point: on the cubic
/// through the last two points, or else on the tangent itself.
pub(crate) fn predicted(base: &BasePoint, h: f64) -> Vec<f64> {
    let on_tangent = along(&base.z, h, &base.tangent);
    let Some(behind) = &base.behind else { return on_tangent };
    let s = dot(&behind.z, &base.tangent) - dot(&base.z, &base.tangent);
    if s >= 0.0 || h > -EXTRAPOLATED * s {
        return on_tangent;
    }
    let from = (s, behind.z.as_slice(), behind.tangent.as_slice());
    let Some(curve) = Hermite::new(&base.tangent, from, (0.0, &base.z, &base.tangent)) else { return on_tangent };
    let on_curve = curve.at(h);
    if distance(&on_curve, &on_tangent) > OFF_TANGENT * h { on_tangent } else { on_curve }
}

/// The cubic with two points and the tangents there, over the distance along a direction.
#[derive(Debug)]
pub(crate) struct Hermite<'a> {
    s: [f64; 2],
    z: [&'a [f64]; 2],
    slope: [Vec<f64>; 2],
}

impl<'a> Hermite<'a> {
    /// Through two points with their distances and tangents; `None` if the tangents lead across the direction.
    pub fn new(direction: &[f64], from: (f64, &'a [f64], &[f64]), to: (f64, &'a [f64], &[f64])) -> Option<Self> {
        let slope = |tangent: &[f64]| {
            let ahead = dot(tangent, direction);
            (ahead > STEEPEST).then(|| tangent.iter().map(|t| t / ahead).collect::<Vec<f64>>())
        };
        Some(Self { s: [from.0, to.0], z: [from.1, to.1], slope: [slope(from.2)?, slope(to.2)?] })
    }

    /// The point at the distance `s`.
    pub fn at(&self, s: f64) -> Vec<f64> {
        let width = self.s[1] - self.s[0];
        let u = (s - self.s[0]) / width;
        let (h1, h2) = (u * u * (3.0 - 2.0 * u), u * (1.0 - u) * (1.0 - u));
        let h3 = u * u * (u - 1.0);
        self.sum([1.0 - h1, h1, width * h2, width * h3])
    }

    /// The unit tangent at the distance `s`.
    pub fn tangent(&self, s: f64) -> Vec<f64> {
        let width = self.s[1] - self.s[0];
        let u = (s - self.s[0]) / width;
        let d1 = 6.0 * u * (1.0 - u) / width;
        let slope = self.sum([-d1, d1, (1.0 - u) * (1.0 - 3.0 * u), u * (3.0 * u - 2.0)]);
        let length = dot(&slope, &slope).sqrt();
        slope.iter().map(|v| v / length).collect()
    }

    fn sum(&self, weights: [f64; 4]) -> Vec<f64> {
        let vectors = [self.z[0], self.z[1], &self.slope[0], &self.slope[1]];
        (0..self.z[0].len()).map(|i| vectors.iter().zip(weights).map(|(v, w)| w * v[i]).sum()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_its_own_interpolant() {
        let z = |s: f64| [s, 1.0 - 2.0 * s + 0.5 * s * s * s];
        let t = |s: f64| {
            let slope = [1.0, -2.0 + 1.5 * s * s];
            let length = dot(&slope, &slope).sqrt();
            slope.map(|v| v / length)
        };
        let ends = [0.3, 1.1].map(|s| (s, z(s), t(s)));
        let [a, b] = &ends;
        let curve = Hermite::new(&[1.0, 0.0], (a.0, &a.1, &a.2), (b.0, &b.1, &b.2)).unwrap();
        for s in [0.3, 0.5, 0.9, 1.1, 1.4] {
            let gap = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(gap(&curve.at(s), &z(s)) < 1e-14 && gap(&curve.tangent(s), &t(s)) < 1e-14, "at {s}");
        }
    }
}
