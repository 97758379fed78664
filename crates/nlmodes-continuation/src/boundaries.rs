//! The boundaries of smooth pieces that pass through a point.

use std::collections::HashMap;

use nlmodes_linalg::{DenseLu, Mat};

use crate::pencil::orthonormal;
use crate::signs::Signs;
use crate::vectors::{along, distance, dot};
use crate::{Boundary, ParametricSystem};

/// Loops around the point on which boundaries are looked for, and the shortest piece into which one is divided, over
/// the radius.
const LOOPS: usize = 3;
const SHORTEST: f64 = 1e-3;

/// Distance of a boundary from the point, over the radius, up to which it passes through it.
const THROUGH: f64 = 1e-2;

/// Cosine of the angle between the gradients of two boundaries above which they are one.
const SAME: f64 = 1.0 - 1e-6;

/// Most boundaries: the ways to pass some of them double with each.
const MOST: usize = 6;

/// Ratio of the pivots below which gradients are not distinguished.
const DEPENDENT: f64 = 1e-6;

/// A point around the center, and the piece on which it lies.
type Place = (Vec<f64>, u64);

/// Unit vectors across the boundaries through `center`; `None` if the system does not know the pieces around it, or
/// they are not as these boundaries alone would make them.
pub(crate) fn around<S: ParametricSystem>(system: &mut S, center: &[f64], radius: f64) -> Option<Vec<Vec<f64>>> {
    let mut signs = Signs::default();
    let (mut slopes, mut places) = (Vec::new(), Vec::new());
    for _ in 0..LOOPS {
        let mut draw = || (0..center.len()).map(|_| signs.draw_between()).collect::<Vec<f64>>();
        let u = orthonormal(draw(), &[])?;
        let v = orthonormal(draw(), std::slice::from_ref(&u))?;
        // Each boundary is crossed twice, and not all at one place.
        let corners =
            [(1.0, &u), (1.0, &v), (-1.0, &u), (-1.0, &v), (1.0, &u)].map(|(s, d)| along(center, s * radius, d));
        let corners: Option<Vec<Place>> =
            corners.into_iter().map(|z| system.pattern_at(&z).map(|piece| (z, piece))).collect();
        let corners = corners?;
        for pair in corners.windows(2) {
            between(system, center, radius, (&pair[0], &pair[1]), &mut slopes)?;
        }
        places.extend(corners);
    }
    let explained = !slopes.is_empty() && slopes.len() <= MOST && are_told_by(&slopes, center, radius, &places);
    explained.then_some(slopes)
}

/// The boundaries between two points.
fn between<S: ParametricSystem>(
    system: &mut S,
    center: &[f64],
    radius: f64,
    (from, to): (&Place, &Place),
    slopes: &mut Vec<Vec<f64>>,
) -> Option<()> {
    if from.1 == to.1 {
        return Some(());
    }
    let boundary = system.boundary(&from.0, &to.0);
    if let Some(boundary) = boundary.filter(|b| b.value(&from.0) > 0.0 && b.value(&to.0) < 0.0) {
        let slope = gradient(&boundary, center)?;
        let size = dot(&slope, &slope).sqrt();
        if boundary.value(center).abs() > THROUGH * radius * size {
            return None;
        }
        let slope: Vec<f64> = slope.iter().map(|s| s / size).collect();
        if slopes.iter().all(|known| dot(known, &slope).abs() < SAME) {
            slopes.push(slope);
        }
        return Some(());
    }
    if distance(&from.0, &to.0) < SHORTEST * radius || slopes.len() > MOST {
        return None;
    }
    let middle: Vec<f64> = from.0.iter().zip(&to.0).map(|(a, b)| 0.5 * (a + b)).collect();
    let piece = system.pattern_at(&middle)?;
    let middle = (middle, piece);
    between(system, center, radius, (from, &middle), slopes)?;
    between(system, center, radius, (&middle, to), slopes)
}

/// Whether places on the same sides of all boundaries lie on one piece.
fn are_told_by(slopes: &[Vec<f64>], center: &[f64], radius: f64, places: &[Place]) -> bool {
    let mut known = HashMap::new();
    places.iter().all(|(z, piece)| {
        let from_center = along(z, -1.0, center);
        let values: Vec<f64> = slopes.iter().map(|slope| dot(slope, &from_center)).collect();
        let clear = values.iter().all(|value| value.abs() > THROUGH * radius);
        let sides: Vec<bool> = values.iter().map(|value| *value > 0.0).collect();
        !clear || *known.entry(sides).or_insert(*piece) == *piece
    })
}

/// Unit vectors into the pieces on all sides of the boundaries with these unit vectors across them.
pub(crate) fn sides(slopes: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let across = dual(slopes)?;
    let side = |set: usize| {
        let signed = across.iter().enumerate().map(|(j, a)| (if set >> j & 1 == 1 { 1.0 } else { -1.0 }, a));
        let sum = signed.fold(vec![0.0; slopes[0].len()], |sum, (sign, a)| along(&sum, sign, a));
        let length = dot(&sum, &sum).sqrt();
        sum.iter().map(|v| v / length).collect()
    };
    Some((0..1 << slopes.len()).map(side).collect())
}

/// Vectors in the span of these whose products with them are one for the same and zero for the others.
fn dual(slopes: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
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

/// The gradient of the function of a boundary, by central differences.
pub(crate) fn gradient(boundary: &Boundary, z: &[f64]) -> Option<Vec<f64>> {
    const STEP: f64 = 1e-5;
    let mut at = z.to_vec();
    let slope: Vec<f64> = (0..z.len())
        .map(|j| {
            let mut value = |s: f64| {
                at[j] = z[j] + s;
                let value = boundary.value(&at);
                at[j] = z[j];
                value
            };
            (value(STEP) - value(-STEP)) / (2.0 * STEP)
        })
        .collect();
    let size = dot(&slope, &slope);
    (size.is_finite() && size > 0.0).then_some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_of_a_boundary_is_that_of_its_function() {
        let boundary = Boundary::new(|z| z[0] * z[1] - 3.0 * z[2] * z[2]);
        let found = gradient(&boundary, &[0.4, -1.2, 0.7]).unwrap();
        assert!(found.iter().zip([-1.2, 0.4, -4.2]).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        assert_eq!(gradient(&Boundary::new(|_| 1.0), &[0.4]), None, "a constant has none");
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
