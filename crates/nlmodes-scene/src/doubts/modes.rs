//! Linear modes from which no branch begins, or none with contact.

use std::f64::consts::TAU;

use super::short;
use crate::assemble::{OpenStructure, StaticState};
use crate::scene::Scene;

/// Squared frequencies that differ by less than this share are not distinguished.
const EQUAL: f64 = 1e-8;
/// Share of a row up to which another one is in its direction, or a contact not moved.
const SMALL: f64 = 1e-6;

/// What speaks against the mode of which the nonlinear one is wanted; nothing of rigid-body motions, which are refused.
pub(super) fn doubts(scene: &Scene, open: &OpenStructure) -> Vec<String> {
    let mode = scene.method.mode.wrapping_sub(1);
    let Ok((rigid, unfelt)) = open.modes.rigid_motions() else { return Vec::new() };
    if !scene.responses.is_empty() || !(rigid..open.modes.n_modes()).contains(&mode) {
        return Vec::new();
    }
    [repeated(open, mode), floating(open, rigid, unfelt)].into_iter().flatten().collect()
}

/// Another mode of the same frequency, of which and the first the contacts see different combinations.
fn repeated(open: &OpenStructure, mode: usize) -> Option<String> {
    let (squares, rows) = (open.modes.omega_squared(), open.modes.contact_rows());
    let same = |k: &usize| *k != mode && (squares[*k] - squares[mode]).abs() <= EQUAL * squares[mode];
    let other = (0..squares.len()).find(same)?;
    let row = |i: usize| [rows[(i, mode)], rows[(i, other)]];
    let crossed = |i: usize, j: usize| {
        let ([a, b], [c, d]) = (row(i), row(j));
        (a * d - b * c).abs() > SMALL * a.hypot(b) * c.hypot(d)
    };
    let contacts = open.modes.n_contacts();
    (0..contacts).any(|i| (0..i).any(|j| crossed(i, j))).then(|| {
        format!(
            "modes {} and {} have the same frequency ({} Hz): any combination of them is a linear mode, the contacts \
            do not agree on one, and no branch may begin there. A little \
             that breaks the symmetry, 1e-6 of the mass on one side, gives each its own",
            mode + 1,
            other + 1,
            short(squares[mode].max(0.0).sqrt() / TAU)
        )
    })
}

/// A structure that floats, in which the forces of the contacts cannot balance each other: the mean of what acts on it
/// vanishes in a periodic motion. And motions of it that no contact feels.
fn floating(open: &OpenStructure, rigid: usize, unfelt: usize) -> Option<String> {
    let is_carried = open.state.as_ref().is_some_and(StaticState::is_carried);
    if rigid > 0 && !is_carried && !contacts_balance(open, rigid) {
        return Some(
            "the structure floats, and all contacts push it to the same side: their mean force vanishes in a periodic \
            motion, so that none with contact exists. Stops on the other side, or a support, hold it"
                .to_owned(),
        );
    }
    (unfelt > 0 && (open.files.is_some() || open.elsewhere.is_some())).then(|| left_at_rest(rigid, unfelt))
}

/// Motions of rods and beams that no contact feels.
pub(super) fn of_bodies(scene: &Scene, open: &OpenStructure) -> Option<String> {
    let (rigid, unfelt) = (open.modes.n_rigid(), open.modes.unfelt_motions().len());
    (unfelt > 0 && scene.responses.is_empty() && scene.method.mode > unfelt).then(|| left_at_rest(rigid, unfelt))
}

fn left_at_rest(rigid: usize, unfelt: usize) -> String {
    format!(
        "the structure floats, and its contacts do not feel {unfelt} of its {rigid} motions: these are left at rest"
    )
}

/// Whether forces of the contacts can balance each other in all of the first `rigid` modes: whether some of them, none
/// negative and not all zero, do no work in any.
pub fn contacts_balance(open: &OpenStructure, rigid: usize) -> bool {
    let row = |i: usize| (0..rigid).map(|r| open.modes.contact_rows()[(i, r)]).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = (0..open.modes.n_contacts()).map(row).collect();
    let length = |row: &[f64]| inner(row, row).sqrt();
    let largest = rows.iter().map(|row| length(row)).fold(0.0, f64::max);
    let unit = |row: &Vec<f64>| row.iter().map(|v| v / length(row)).collect::<Vec<f64>>();
    rows.iter().any(|row| length(row) <= SMALL * largest) || balanced(&rows.iter().map(unit).collect::<Vec<_>>())
}

/// Steps toward the point of a hull that is next to the origin.
const STEPS: usize = 1000;

/// Whether a combination of these unit vectors with weights that are not negative vanishes: whether their hull has the
/// origin (Mitchell, Demyanov and Malozemov: weight goes from the farthest to the nearest vertex).
fn balanced(points: &[Vec<f64>]) -> bool {
    let Some(mut x) = points.first().cloned() else { return true };
    let mut weights = vec![0.0; points.len()];
    weights[0] = 1.0;
    for _ in 0..STEPS {
        let along = |i: &usize| inner(&points[*i], &x);
        let by = |a: &usize, b: &usize| along(a).total_cmp(&along(b));
        let (Some(near), Some(far)) =
            ((0..points.len()).min_by(by), (0..points.len()).filter(|i| weights[*i] > 0.0).max_by(by))
        else {
            return true;
        };
        let size = inner(&x, &x);
        if size <= SMALL * SMALL {
            return true;
        }
        if along(&near) > 0.0 {
            return false;
        }
        let step: Vec<f64> = points[far].iter().zip(&points[near]).map(|(far, near)| far - near).collect();
        let moved = (inner(&x, &step) / inner(&step, &step)).clamp(0.0, weights[far]);
        (weights[far], weights[near]) = (weights[far] - moved, weights[near] + moved);
        x.iter_mut().zip(&step).for_each(|(x, step)| *x -= moved * step);
    }
    true
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_balance_where_their_hull_has_the_origin() {
        let angle = |degrees: f64| vec![degrees.to_radians().cos(), degrees.to_radians().sin()];
        let of = |degrees: &[f64]| balanced(&degrees.iter().map(|d| angle(*d)).collect::<Vec<_>>());
        assert!(of(&[0.0, 180.0]) && of(&[10.0, 120.0, 250.0]) && of(&[0.0, 90.0, 181.0, 200.0]));
        assert!(!of(&[0.0]) && !of(&[0.0, 100.0]) && !of(&[10.0, 120.0, 180.0]) && !of(&[0.0, 45.0, 90.0, 179.0]));
    }
}
