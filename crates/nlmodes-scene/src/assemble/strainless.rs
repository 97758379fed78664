//! Motions of a structure from files that strain nothing: those of rigid bodies, and others.

use std::f64::consts::TAU;

use nlmodes::model::reduction::OpenModes;
use nlmodes_io::{DofLabel, FeModel};
use nlmodes_linalg::{Digits, Mat, symmetric_eigen};

use crate::significant;

/// Share of a motion that may be another one than that of rigid bodies, in the mean square: what the digits mix into
/// it of the elastic modes.
const OTHER: f64 = 0.05;
/// Of motions that are none of rigid bodies, σ over the first λ that is distinguished from zero, up to which there is a
/// gap.
const GAP: f64 = 1e-4;
/// Motions of a rigid body of which less than this share, squared, is left beside others are combinations of these.
const DEPENDENT: f64 = 1e-8;
/// Combinations that move less than this share, squared, of the largest move nothing that is known: a translation where
/// only rotations are, but for what the digits mix into it.
const UNSEEN: f64 = 1e-4;

/// Motions that strain nothing, as far as the digits of the files tell.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Strainless {
    /// Those in which all bodies move as rigid ones, as far as places and rotations tell.
    pub rigid: usize,
    /// The others: of mechanisms, as hinges leave them.
    pub mechanisms: usize,
    /// The lowest node of each body that moves in them.
    pub floating: Vec<u64>,
    /// The digits of the files would not show a support on which the structure has a frequency below this one, Hz; zero
    /// where they are not known.
    pub unseen_hz: f64,
}

impl Strainless {
    /// So many motions of rods and beams, whose bodies have no names.
    pub fn of_rigid_bodies(rigid: usize) -> Self {
        Self { rigid, ..Self::default() }
    }

    /// All of them: as many of the lowest modes.
    pub fn count(&self) -> usize {
        self.rigid + self.mechanisms
    }

    /// Those among the open modes of the model; none if a mode is none of rigid bodies and yet not distinguished from
    /// zero, without a gap to the next one: the digits leave nothing of it.
    pub(super) fn of(model: &FeModel, modes: &OpenModes) -> Option<Self> {
        let count = modes.openness().strainless;
        if count == 0 {
            return Some(Self::default());
        }
        let bodies = bodies(model);
        let (others, unseen) = Rows::new(model, &bodies).others(&modes.shapes().subcols(0, count).to_owned());
        let worst = modes.openness().deviations[..count].iter().copied().fold(0.0, f64::max);
        let next = modes.omega_squared().get(count).copied().unwrap_or(0.0);
        if others + unseen > 0 && worst > GAP * next {
            return None;
        }
        let floating = floating(model, &bodies, modes, count);
        // Few or round values do not show how many digits they were cut off at.
        let is_cut = model.digits[0] != Digits::DOUBLE;
        let unseen_hz = if is_cut { modes.openness().unseen.sqrt() / TAU } else { 0.0 };
        Some(Self { rigid: count - others, mechanisms: others, floating, unseen_hz })
    }

    /// `six rigid-body motions`, or with the mechanisms; empty without any.
    pub fn text(&self) -> String {
        let some = |count: usize, what: &str| match count {
            0 => None,
            1 => Some(format!("one {what}")),
            n => Some(format!("{} {what}s", written(n))),
        };
        let parts = [some(self.rigid, "rigid-body motion"), some(self.mechanisms, "motion of a mechanism")];
        parts
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(" and ")
            .replace("motion of a mechanisms", "motions of mechanisms")
    }

    /// What the digits of the files leave open: softer supports do not show in them. None where they are not known.
    pub fn unseen_text(&self) -> Option<String> {
        let hz = significant(self.unseen_hz, 2);
        let text =
            format!("a support on which the structure has less than {hz} Hz would not show in the digits of the files");
        (self.unseen_hz > 0.0).then_some(text)
    }
}

fn written(n: usize) -> String {
    const WORDS: [&str; 13] =
        ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"];
    WORDS.get(n).map_or_else(|| n.to_string(), |word| (*word).to_owned())
}

/// The body of each row: what the stiffness couples.
fn bodies(model: &FeModel) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..model.n_dofs()).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    let mut join = |i: usize, j: usize| {
        let (a, b) = (root(&mut parent, i), root(&mut parent, j));
        parent[a.max(b)] = a.min(b);
    };
    model.stiffness.entries().for_each(|(i, j, _)| join(i, j));
    // The directions of a node belong together, though some elements do not couple them.
    let mut first = std::collections::HashMap::new();
    for (row, label) in model.labels.iter().enumerate() {
        join(row, *first.entry(label.node).or_insert(row));
    }
    (0..model.n_dofs()).map(|row| root(&mut parent, row)).collect()
}

/// The lowest node of each body that moves in the first modes.
fn floating(model: &FeModel, bodies: &[usize], modes: &OpenModes, count: usize) -> Vec<u64> {
    let shapes = modes.shapes();
    let mut most = vec![0.0_f64; bodies.len()];
    for (row, body) in bodies.iter().enumerate().filter(|(row, _)| model.labels[*row].component.translation().is_some())
    {
        (0..count).for_each(|k| most[*body] = most[*body].max(shapes[(row, k)].abs()));
    }
    let largest = most.iter().copied().fold(0.0, f64::max);
    let moves = |body: usize| most[body] > OTHER * largest;
    let of = |body: usize| {
        let rows = bodies.iter().enumerate().filter(|(_, own)| **own == body);
        rows.map(|(row, _)| model.labels[row].node).min()
    };
    (0..bodies.len()).filter(|&body| moves(body)).filter_map(of).collect()
}

/// The rows of a model with what rigid bodies do there.
struct Rows<'a> {
    bodies: &'a [usize],
    /// By what a component is multiplied to be a displacement: one, or the size of the structure for rotations; nothing
    /// where it is not known how a rigid body moves it.
    reach: Vec<f64>,
    /// Displacement of each row in the motions of a rigid body.
    motions: Vec<[f64; 6]>,
}

impl<'a> Rows<'a> {
    fn new(model: &FeModel, bodies: &'a [usize]) -> Self {
        let places: Vec<[f64; 3]> = model.nodes().into_iter().filter_map(|node| model.place_of(node)).collect();
        let mean = |axis: usize| places.iter().map(|x| x[axis]).sum::<f64>() / places.len().max(1) as f64;
        let centre = [0, 1, 2].map(mean);
        let distance = |x: &[f64; 3]| (0..3).map(|a| (x[a] - centre[a]).powi(2)).sum::<f64>().sqrt();
        let size = places.iter().map(distance).fold(0.0, f64::max);
        let size = if size > 0.0 { size } else { 1.0 };
        let of = |label: &DofLabel| row(model, label, (centre, size));
        let (reach, motions) = model.labels.iter().map(of).unzip();
        Self { bodies, reach, motions }
    }

    /// How many independent combinations of these motions are none of rigid bodies; and how many there are where
    /// nothing tells, without places and rotations.
    fn others(&self, shapes: &Mat<f64>) -> (usize, usize) {
        if self.reach.iter().all(|reach| *reach == 0.0) {
            return (0, shapes.ncols());
        }
        let displaced = Mat::from_fn(shapes.nrows(), shapes.ncols(), |i, k| self.reach[i] * shapes[(i, k)]);
        let mut left = displaced.clone();
        let mut known: Vec<usize> = self.bodies.to_vec();
        known.sort_unstable();
        known.dedup();
        for body in known {
            let rows: Vec<usize> = (0..self.bodies.len()).filter(|row| self.bodies[*row] == body).collect();
            self.take_out(&rows, &mut left);
        }
        (above(&displaced, &left), 0)
    }

    /// Takes the motions of one rigid body out of the columns.
    fn take_out(&self, rows: &[usize], left: &mut Mat<f64>) {
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for motion in 0..6 {
            let mut v: Vec<f64> = rows.iter().map(|&i| self.reach[i] * self.motions[i][motion]).collect();
            let before = inner(&v, &v);
            for _ in 0..2 {
                for q in &basis {
                    let share = inner(q, &v);
                    v.iter_mut().zip(q).for_each(|(v, q)| *v -= share * q);
                }
            }
            let after = inner(&v, &v);
            if after > DEPENDENT * before {
                basis.push(v.into_iter().map(|v| v / after.sqrt()).collect());
            }
        }
        for k in 0..left.ncols() {
            for q in &basis {
                let share: f64 = rows.iter().zip(q).map(|(&i, q)| q * left[(i, k)]).sum();
                rows.iter().zip(q).for_each(|(&i, q)| left[(i, k)] -= share * q);
            }
        }
    }
}

/// A row in the motions of a rigid body: three translations, and three rotations about the centre by one over the size.
/// Without any places, the rotations of nodes tell which bodies turn as one.
fn row(model: &FeModel, label: &DofLabel, (centre, size): ([f64; 3], f64)) -> (f64, [f64; 6]) {
    let mut motion = [0.0; 6];
    if let Some(axis) = label.component.rotation() {
        motion[3 + axis] = 1.0 / size;
        return (size, motion);
    }
    match (label.component.translation(), model.place_of(label.node)) {
        (Some(axis), Some(place)) => {
            motion[axis] = 1.0;
            let x: [f64; 3] = std::array::from_fn(|a| (place[a] - centre[a]) / size);
            // e_r × x.
            let [p, q] = [(axis + 1) % 3, (axis + 2) % 3];
            (motion[3 + p], motion[3 + q]) = (x[q], -x[p]);
            (1.0, motion)
        }
        _ => (0.0, motion),
    }
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Independent combinations of the columns of which more than [`OTHER`] is left, in the mean square.
fn above(whole: &Mat<f64>, left: &Mat<f64>) -> usize {
    let gram = |a: &Mat<f64>| a.transpose() * a;
    let Ok((values, vectors)) = symmetric_eigen(&gram(whole)) else { return whole.ncols() };
    let largest = values.iter().copied().fold(0.0, f64::max);
    let kept: Vec<usize> = (0..values.len()).filter(|&k| values[k] > UNSEEN * largest).collect();
    let unit = Mat::from_fn(vectors.nrows(), kept.len(), |i, k| vectors[(i, kept[k])] / values[kept[k]].sqrt());
    let Ok((shares, _)) = symmetric_eigen(&gram(&(left * unit))) else { return whole.ncols() };
    shares.iter().filter(|share| **share > OTHER * OTHER).count()
}
