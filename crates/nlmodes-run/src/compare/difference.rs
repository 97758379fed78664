//! How far two branches are from each other.

use nlmodes::modal::{ModalBranch, ModalPoint};

/// The largest difference of a branch from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Difference {
    /// As many points: the largest relative difference in frequency or energy of two points with the same number.
    OfPoints(f64),
    /// Steps of different lengths: the largest distance of a point from the chords of the other branch, in the
    /// logarithms of frequency and energy. It includes the distance of the chords from their arcs.
    FromChords(f64),
}

/// The difference of `branch` from `first`.
pub fn difference(first: &ModalBranch, branch: &ModalBranch) -> Difference {
    let (reference, points) = (places(&first.points), places(&branch.points));
    if reference.len() == points.len() {
        let largest = reference.iter().zip(&points).flat_map(|(a, b)| [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()]);
        return Difference::OfPoints(largest.fold(0.0, f64::max));
    }
    let nearest = |p: &[f64; 2]| {
        let chords = reference.windows(2).map(|chord| distance(p, &chord[0], &chord[1]));
        chords.chain(reference.iter().map(|q| distance(p, q, q))).fold(f64::INFINITY, f64::min)
    };
    Difference::FromChords(points.iter().map(nearest).fold(0.0, f64::max))
}

fn places(points: &[ModalPoint]) -> Vec<[f64; 2]> {
    points.iter().map(|point| [point.omega.ln(), point.kinetic_energy.ln()]).collect()
}

/// Distance of a point from the chord between two others.
fn distance(p: &[f64; 2], a: &[f64; 2], b: &[f64; 2]) -> f64 {
    let (along, from) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = along[0] * along[0] + along[1] * along[1];
    let share = ((along[0] * from[0] + along[1] * from[1]) / squared).clamp(0.0, 1.0);
    let share = if share.is_nan() { 0.0 } else { share };
    (from[0] - share * along[0]).hypot(from[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes::modal::{BranchEnd, HarmonicCoefficients};

    fn branch(points: &[(f64, f64)]) -> ModalBranch {
        let point = |&(omega, kinetic_energy): &(f64, f64)| ModalPoint {
            omega,
            coefficients: HarmonicCoefficients::zeros(1, 1),
            kinetic_energy,
            ..ModalPoint::default()
        };
        ModalBranch {
            label: String::new(),
            coordinates: Vec::new(),
            contact_coordinate: None,
            stop: None,
            points: points.iter().map(point).collect(),
            end: BranchEnd::given(""),
        }
    }

    #[test]
    fn points_are_compared_by_number_where_there_are_as_many() {
        let found = difference(&branch(&[(1.0, 1.0), (2.0, 3.0)]), &branch(&[(1.0, 1.0), (2.0 * (1.0 + 1e-6), 3.0)]));
        assert!(matches!(found, Difference::OfPoints(d) if (d - 1e-6).abs() < 1e-11), "{found:?}");
    }

    #[test]
    fn other_points_are_compared_with_the_chords() {
        let first = branch(&[(1.0, 1.0), (1.0, 10.0)]);
        let found = difference(&first, &branch(&[(1.0, 1.0), (1.001, 5.0), (1.0, 10.0)]));
        assert!(matches!(found, Difference::FromChords(d) if (d - 1.001_f64.ln()).abs() < 1e-12), "{found:?}");
    }
}
