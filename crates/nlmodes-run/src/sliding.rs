//! Sliding of the contacts in motions that were computed without friction, for `contacts.csv`.

mod tangents;

use nlmodes::branches::{ComputedBranch, Histories};
use nlmodes::linalg::sparse_from_triplets;
use nlmodes::modal::{ClosedSpan, HarmonicCoefficients, Sliding};
use nlmodes::model::StructuralModel;
use nlmodes::model::reduction::ResponseRows;
use nlmodes_scene::assemble::{NodeContacts, OpenStructure};
use nlmodes_scene::scene::Scene;
use num_complex::Complex64;

use crate::Failure;
use crate::physical::{joined, parts};
pub use tangents::{Tangent, Tangents};

/// Says of the contacts of all points of these branches how they slide, where their nodes move within the plane of the
/// contact; before displacements are recovered. Exact motions, whose forces are no series, have none of it.
///
/// # Errors
/// [`Failure`] if a point cannot be evaluated again.
pub fn of_branches(
    scene: &Scene,
    (model, open): (&StructuralModel, Option<&OpenStructure>),
    nodes: Option<&NodeContacts>,
    branches: &mut [ComputedBranch],
) -> Result<(), Failure> {
    let (dofs, directions) = match open {
        Some(open) => (&open.dofs[..], nlmodes::linalg::triplets(open.modes.directions()).collect::<Vec<_>>()),
        None => (model.dofs(), entries(model)),
    };
    let tangents = Tangents::of(scene, dofs, &directions, nodes);
    if tangents.is_empty() {
        return Ok(());
    }
    let moves = match open {
        Some(open) => Moves::OfModes { open, rows: rows(open, &tangents)? },
        None => Moves::Recorded,
    };
    for computed in branches {
        let found = of_branch(&tangents, &moves, computed)?;
        for (point, all) in computed.branch.points.iter_mut().zip(found) {
            point.contacts.iter_mut().zip(all).for_each(|(contact, sliding)| contact.sliding = sliding);
        }
    }
    Ok(())
}

/// Entries of `W` of contacts of a structure that is not reduced by its open modes.
fn entries(model: &StructuralModel) -> Vec<(usize, usize, f64)> {
    let of = |(i, contact): (usize, &nlmodes::model::Contact)| {
        contact.normal.entries().iter().map(move |&(dof, w)| (dof, i, w)).collect::<Vec<_>>()
    };
    model.contacts().iter().enumerate().flat_map(of).collect()
}

/// How displacements follow from the coordinates of a point.
enum Moves<'a> {
    /// From modal coordinates and contact forces; a row each tangential direction.
    OfModes { open: &'a OpenStructure, rows: ResponseRows },
    /// They are among the coordinates.
    Recorded,
}

fn rows(open: &OpenStructure, tangents: &Tangents) -> Result<ResponseRows, Failure> {
    let column =
        |(j, tangent): (usize, &Tangent)| tangent.weights.iter().map(move |&(dof, w)| (dof, j, w)).collect::<Vec<_>>();
    let entries: Vec<_> = tangents.all().enumerate().flat_map(column).collect();
    Ok(open.modes.rows(&sparse_from_triplets(open.dofs.len(), tangents.count(), &entries)?)?)
}

/// What each contact does at each point.
fn of_branch(
    tangents: &Tangents,
    moves: &Moves<'_>,
    computed: &ComputedBranch,
) -> Result<Vec<Vec<Option<Sliding>>>, Failure> {
    let mut histories = Histories::of(computed);
    let mut found = Vec::new();
    for (k, point) in computed.branch.points.iter().enumerate() {
        let Some(spans) = histories.closed_spans(k)? else { return Ok(Vec::new()) };
        let (series, size) = match moves {
            Moves::OfModes { open, rows } => of_modes(open, rows, &point.coefficients),
            Moves::Recorded => recorded(tangents, computed, &point.coefficients),
        };
        found.push(tangents.sliding(&spans, |j| (series[j].clone(), size[j]), point.omega));
    }
    Ok(found)
}

/// Tangential displacements of reduced coordinates, harmonic by harmonic, and the speed by phase that they would have
/// if all modes moved them alike.
fn of_modes(
    open: &OpenStructure,
    rows: &ResponseRows,
    coefficients: &HarmonicCoefficients,
) -> (Vec<Option<Vec<Complex64>>>, Vec<f64>) {
    let x = parts(coefficients);
    let eta = x.subrows(0, open.modes.n_modes()).to_owned();
    let moved = joined(&(&rows.modes * &eta + &rows.forces * open.reduced.contact_forces(&x)));
    let modal = (0..eta.nrows()).map(|r| speed(coefficients.of(r)).powi(2)).sum::<f64>().sqrt();
    let norm = |j: usize| (0..eta.nrows()).map(|r| rows.modes[(j, r)].powi(2)).sum::<f64>().sqrt();
    let all = 0..moved.n_coordinates();
    (all.clone().map(|j| Some(moved.of(j).to_vec())).collect(), all.map(|j| norm(j) * modal).collect())
}

/// Tangential displacements that are among the coordinates; none of those that are not all recorded.
fn recorded(
    tangents: &Tangents,
    computed: &ComputedBranch,
    coefficients: &HarmonicCoefficients,
) -> (Vec<Option<Vec<Complex64>>>, Vec<f64>) {
    let series = |tangent: &Tangent| {
        let mut sum = vec![Complex64::default(); coefficients.n_harmonics() + 1];
        for &(dof, w) in &tangent.weights {
            let own = coefficients.of(computed.structure.recorded_index(dof)?);
            sum.iter_mut().zip(own).for_each(|(sum, q)| *sum += q * w);
        }
        Some(sum)
    };
    let whole = (0..coefficients.n_coordinates()).map(|d| speed(coefficients.of(d)).powi(2)).sum::<f64>().sqrt();
    (tangents.all().map(series).collect(), vec![whole; tangents.count()])
}

/// Root of the sum of squares of the harmonics of a derivative by phase.
pub fn speed(z: &[Complex64]) -> f64 {
    z.iter().enumerate().map(|(n, z)| (n as f64).powi(2) * z.norm_sqr()).sum::<f64>().sqrt()
}

impl Tangents {
    /// How each contact slides that is closed in these spans, in a motion of angular frequency `omega` (rad/s);
    /// `moves` gives the series of a tangential displacement (m), if it is known, and the speed by phase below whose
    /// rounding it is no motion. None of a contact that does not move within its plane.
    pub fn sliding(
        &self,
        spans: &[Vec<ClosedSpan>],
        moves: impl Fn(usize) -> (Option<Vec<Complex64>>, f64),
        omega: f64,
    ) -> Vec<Option<Sliding>> {
        let of = |(contact, spans): (usize, &Vec<ClosedSpan>)| {
            let known: Option<Vec<(Vec<Complex64>, f64)>> =
                self.of_contact(contact).map(&moves).map(|(series, size)| Some((series?, size))).collect();
            // Modes of a structure whose motions do not couple are known to the root of rounding.
            let is_motion = |(series, size): &(Vec<Complex64>, f64)| speed(series) > f64::EPSILON.sqrt() * size;
            let moving: Vec<Vec<Complex64>> = known?.into_iter().filter(is_motion).map(|(series, _)| series).collect();
            let found = (!moving.is_empty()).then(|| Sliding::of(spans, &moving, omega))?;
            Some(found.with_friction(self.friction(contact)))
        };
        spans.iter().enumerate().map(of).collect()
    }
}
