//! The boundaries of smooth pieces that pass through a point.

use std::collections::HashMap;

use crate::ParametricSystem;
use crate::expansion::gradient;
use crate::pencil::orthonormal;
use crate::signs::Signs;
use crate::vectors::{along, distance, dot};

/// Loops around the point on which boundaries are looked for, and the shortest piece into which one is divided, over
/// the radius.
const LOOPS: usize = 3;
const SHORTEST: f64 = 1e-3;

/// Distance of a boundary from the point, over the radius, up to which it passes through it.
pub(super) const THROUGH: f64 = 1e-2;

/// Cosine of the angle between the gradients of two boundaries above which they are one.
const SAME: f64 = 1.0 - 1e-6;

/// Most boundaries: the ways to pass some of them double with each.
const MOST: usize = 6;

/// A point around the center, and the piece on which it lies.
type Place = (Vec<f64>, u64);

/// Unit vectors across the boundaries through `center`; `None` if the system does not know the pieces around it, or
/// they are not as these boundaries alone would make them.
pub(super) fn around<S: ParametricSystem>(system: &mut S, center: &[f64], radius: f64) -> Option<Vec<Vec<f64>>> {
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
