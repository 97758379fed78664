//! The motion of a structure in space: its edges, and the force at each contact.

use serde::Serialize;
use std::f64::consts::TAU;
use std::fmt::Write as _;

use super::packed::{Packed, PackedRows, scale};

/// Maximum number of harmonics of the motion on the page.
const HARMONICS: usize = 6;
/// Width and height of the static figure.
const STILL: [f64; 2] = [760.0, 400.0];

/// The motion of a structure in space over one period, to be drawn as a wireframe.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Wireframe {
    /// Name of the motion, for instance `point 12`.
    pub name: String,
    /// Positions of its vertices at rest, m.
    pub places: Vec<[f64; 3]>,
    /// Pairs of connected vertices.
    pub edges: Vec<[usize; 2]>,
    /// Displacement of each vertex (m) at equal steps of a period: steps × vertices.
    pub displacements: Vec<Vec<[f64; 3]>>,
    /// Phases of the forces, shares of the period, ascending from zero.
    pub phases: Vec<f64>,
    /// Contact vertices, with the force on the structure there (N) at these phases.
    pub forces: Vec<(usize, Vec<[f64; 3]>)>,
}

/// Data for the script.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct WireData {
    name: String,
    places: Packed,
    edges: Vec<usize>,
    /// Cosine and sine coefficients of the displacements, x, y, z of one vertex after the other; the mean first,
    /// without a sine.
    cosines: PackedRows,
    sines: PackedRows,
    contacts: Vec<usize>,
    /// Forces over the phases, x, y, z of one contact after the other.
    forces: PackedRows,
    phases: Vec<f64>,
}

impl Wireframe {
    /// Whether there is something to draw, with finite numbers and existing vertices.
    pub(super) fn is_sound(&self) -> bool {
        let n = self.places.len();
        let finite = |all: &[[f64; 3]]| all.iter().flatten().all(|v| v.is_finite());
        let is_corner = |i: &usize| *i < n;
        !self.edges.is_empty()
            && !self.displacements.is_empty()
            && finite(&self.places)
            && self.edges.iter().flatten().all(is_corner)
            && self.displacements.iter().all(|step| step.len() == n && finite(step))
            && self.forces.iter().all(|(i, f)| *i < n && f.len() == self.phases.len() && finite(f))
            && self.phases.iter().all(|phase| phase.is_finite())
    }

    pub(super) fn data(&self) -> WireData {
        let steps = self.displacements.len();
        let harmonics = HARMONICS.min(steps.saturating_sub(1) / 2);
        let part = |n: usize, turn: fn(f64) -> f64| -> Vec<f64> {
            let weight = if n == 0 { 1.0 } else { 2.0 } / steps as f64;
            let mut sum = vec![0.0; 3 * self.places.len()];
            for (k, step) in self.displacements.iter().enumerate() {
                let factor = weight * turn(TAU * (n * k) as f64 / steps as f64);
                sum.iter_mut().zip(step.iter().flatten()).for_each(|(sum, u)| *sum += factor * u);
            }
            sum
        };
        let cosines: Vec<Vec<f64>> = (0..=harmonics).map(|n| part(n, f64::cos)).collect();
        let mut sines: Vec<Vec<f64>> = (1..=harmonics).map(|n| part(n, f64::sin)).collect();
        let largest = |all: &[Vec<f64>]| all.iter().flatten().fold(0.0_f64, |l, v| l.max(v.abs()));
        if largest(&sines) <= 1e-6 * largest(&cosines) {
            sines.clear();
        }
        let forces: Vec<Vec<f64>> =
            (0..self.phases.len()).map(|k| self.forces.iter().flat_map(|(_, over)| over[k]).collect()).collect();
        let places: Vec<f64> = self.places.iter().flatten().copied().collect();
        WireData {
            name: self.name.clone(),
            places: Packed::new(&places),
            edges: self.edges.iter().flatten().copied().collect(),
            cosines: packed(&cosines),
            sines: packed(&sines),
            contacts: self.forces.iter().map(|(corner, _)| *corner).collect(),
            // One row per phase, also without force.
            forces: PackedRows::new(&forces, scale(forces.iter().flatten().copied())),
            phases: self.phases.clone(),
        }
    }

    /// The structure at the step of its largest displacement, magnified, over that at rest, as an SVG picture.
    pub(super) fn still(&self) -> String {
        let size = |step: &[[f64; 3]]| step.iter().flatten().fold(0.0_f64, |l, v| l.max(v.abs()));
        let sizes = self.displacements.iter().map(|step| size(step));
        let (at, largest) = sizes.enumerate().fold((0, 0.0), |most, next| if next.1 > most.1 { next } else { most });
        let extent = (0..3).map(|a| spread(self.places.iter().map(|x| x[a]))).fold(0.0, f64::max);
        let factor = if largest > 0.0 { 0.15 * extent / largest } else { 0.0 };
        let moved = |k: f64| -> Vec<[f64; 2]> {
            let places = self.places.iter().zip(&self.displacements[at]);
            places.map(|(x, u)| projected(std::array::from_fn(|a| x[a] + k * u[a]))).collect()
        };
        let (rest, now) = (moved(0.0), moved(factor));
        let bounds = [0, 1].map(|a| {
            let values = || rest.iter().chain(&now).map(|p| p[a]);
            (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max))
        });
        let [width, height] = STILL;
        let room = |(low, high): (f64, f64), pixels: f64| (pixels - 40.0) / (high - low).max(f64::MIN_POSITIVE);
        let scale = room(bounds[0], width).min(room(bounds[1], height));
        let middle = bounds.map(|(low, high)| 0.5 * (low + high));
        let pixel =
            |p: &[f64; 2]| [width / 2.0 + scale * (p[0] - middle[0]), height / 2.0 - scale * (p[1] - middle[1])];
        let lines = |points: &[[f64; 2]]| {
            let mut path = String::new();
            for [a, b] in &self.edges {
                let ([x, y], [u, v]) = (pixel(&points[*a]), pixel(&points[*b]));
                // Writing to a string cannot fail.
                _ = write!(path, "M{x:.1} {y:.1}L{u:.1} {v:.1}");
            }
            path
        };
        format!(
            "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"Wireframe of the structure, at rest and \
                displaced\">\
             <path d=\"{}\" class=\"trail\"/><path d=\"{}\" class=\"wire\"/></svg>",
            lines(&rest),
            lines(&now)
        )
    }
}

/// From above and from the side.
fn projected([x, y, z]: [f64; 3]) -> [f64; 2] {
    let (turn, lift) = (0.6_f64, 0.45_f64);
    let (along, deep) = (x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos());
    [along, z * lift.cos() + deep * lift.sin()]
}

fn spread(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
}

/// All rows with one factor, without rows of zeros at the end.
fn packed(rows: &[Vec<f64>]) -> PackedRows {
    let scale = scale(rows.iter().flatten().copied());
    let last = rows.iter().rposition(|row| row.iter().any(|v| v.abs() > 0.5 * scale)).map_or(1, |last| last + 1);
    PackedRows::new(&rows[..last.min(rows.len())], scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar of which one end moves by `0.3 + 2 cos τ + 0.5 sin 2τ` along z and is pushed while it is below.
    fn bar(steps: usize) -> Wireframe {
        let tau = |k: usize| TAU * k as f64 / steps as f64;
        let z = |k: usize| 1e-3 * (0.3 + 2.0 * tau(k).cos() + 0.5 * (2.0 * tau(k)).sin());
        Wireframe {
            name: "point 3".into(),
            places: vec![[0.0; 3], [2.0, 0.0, 0.0]],
            edges: vec![[0, 1]],
            displacements: (0..steps).map(|k| vec![[0.0; 3], [0.0, 0.0, z(k)]]).collect(),
            phases: (0..steps).map(|k| k as f64 / steps as f64).collect(),
            forces: vec![(1, (0..steps).map(|k| [0.0, 0.0, (-z(k)).max(0.0)]).collect())],
        }
    }

    #[test]
    fn coefficients_are_those_of_the_motion() {
        let data = bar(24).data();
        let at = |rows: &PackedRows, n: usize| rows.values().get(n).map_or(0.0, |row| row[5]);
        for (n, cosine, sine) in [(0, 0.3e-3, 0.0), (1, 2e-3, 0.0), (2, 0.0, 0.5e-3)] {
            assert!((at(&data.cosines, n) - cosine).abs() < 1e-6, "{n}");
            assert!(n == 0 || (at(&data.sines, n - 1) - sine).abs() < 1e-6, "{n}");
        }
        // The last steps have no force; without them the others would have wrong phases.
        assert_eq!(data.forces.values().len(), 24);
        assert_eq!((data.edges.as_slice(), data.contacts.as_slice()), (&[0, 1][..], &[1][..]));
    }

    #[test]
    fn what_cannot_be_drawn_is_not_sound() {
        assert!(bar(24).is_sound() && bar(24).still().contains("<path"));
        assert!(!Wireframe { edges: vec![[0, 2]], ..bar(24) }.is_sound());
        assert!(!Wireframe { edges: Vec::new(), ..bar(24) }.is_sound());
        assert!(!Wireframe { places: vec![[f64::NAN; 3]; 2], ..bar(24) }.is_sound());
        assert!(!Wireframe { forces: vec![(1, Vec::new())], ..bar(24) }.is_sound());
    }
}
