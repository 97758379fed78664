//! Computed curves of periodic motions as files, figures and page take them, whatever their motions are of: nonlinear
//! modes or responses.

pub(crate) mod figures;
pub(crate) mod gradients;
pub(crate) mod histories;
pub(crate) mod page;
pub(crate) mod picture;
pub(crate) mod space;
pub(crate) mod stops;
pub(crate) mod stress;
pub(crate) mod summary;
pub(crate) mod tables;

use std::f64::consts::TAU;

use nlmodes::linalg::Mat;
use nlmodes::modal::{HarmonicCoefficients, ModalBranch, Participation, TimeHistory};
use nlmodes::report::StopLine;
use nlmodes::report::columns::ResponseRow;
use nlmodes_scene::assemble::OpenStructure;

use crate::Failure;

/// Linear modes whose participation is written.
pub(crate) const LINEAR_MODES: usize = 6;

/// A computed curve of periodic motions, with what is needed to look closer at its points.
pub(crate) trait Curve {
    /// The points, with their coordinates, the name of the curve and why it ends.
    fn branch(&self) -> &ModalBranch;

    /// Number of its first point in `branch.csv`.
    fn first(&self) -> usize {
        0
    }

    /// Participation of the lowest linear modes at each point.
    fn participation(&self) -> &[Participation];

    /// What a point has in `branch.csv` behind the columns of every curve, if anything.
    fn response_row(&self, point: usize) -> Option<ResponseRow>;

    /// The points that pictures of the motion show, the last one also in space.
    fn pictured(&self) -> Vec<usize>;

    /// The points whose contacts are drawn over a period.
    fn references(&self) -> Vec<usize>;

    /// Number of contacts.
    fn n_contacts(&self) -> usize;

    /// The stops that limit one of the coordinates.
    fn stops(&self) -> Vec<StopLine>;

    /// Motion and force of all contacts over a period of a point, exact at the instants of contact: `samples + 1`
    /// instants, or more where there are many changes of contact.
    ///
    /// # Errors
    /// If the point cannot be evaluated again.
    fn histories(&self, point: usize, samples: usize, label: &str) -> Result<Vec<TimeHistory>, Failure>;

    /// What the loads move statically beyond the modes of a structure in free-interface modes, shape by shape, m.
    fn load_shapes(&self) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// The coordinates of a structure in free-interface modes at `count` equidistant instants of a period of a point,
    /// and its contacts there and at the end of the period, along the directions of that structure.
    ///
    /// # Errors
    /// As [`histories`](Self::histories).
    fn instants(&self, open: &OpenStructure, point: usize, count: usize) -> Result<Instants, Failure> {
        let phases: Vec<f64> = (0..count).map(|k| TAU * k as f64 / count as f64).collect();
        let contacts = self.contacts_at(open, point, Grid::Equidistant(count))?;
        self.instants_of(open, point, &phases, contacts)
    }

    /// The contacts of a structure in free-interface modes over a period of a point, along its directions.
    ///
    /// # Errors
    /// As [`histories`](Self::histories).
    fn contacts_at(&self, open: &OpenStructure, point: usize, grid: Grid) -> Result<Vec<TimeHistory>, Failure>;

    /// The coordinates of a structure in free-interface modes at these phases (rad) of a point, with its contacts
    /// there.
    ///
    /// # Errors
    /// As [`histories`](Self::histories).
    fn instants_of(
        &self,
        open: &OpenStructure,
        point: usize,
        phases: &[f64],
        contacts: Vec<TimeHistory>,
    ) -> Result<Instants, Failure>;
}

/// Instants of a period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Grid {
    /// So many equidistant ones, and the end of the period.
    Equidistant(usize),
    /// So many and one, both sides of each change of contact and its middle among them.
    Exact(usize),
}

/// What makes the displacements of a structure in free-interface modes at some instants, a column each.
pub(crate) struct Instants {
    /// Its contacts.
    pub contacts: Vec<TimeHistory>,
    /// Modal coordinates, m √kg.
    pub eta: Mat<f64>,
    /// Contact forces, N.
    pub forces: Mat<f64>,
    /// Coordinates of the shapes of the loads.
    pub loads: Mat<f64>,
}

impl Instants {
    /// Of contacts that are known and modal coordinates, modes × (H + 1), at these phases (rad) without loads.
    pub fn new(contacts: Vec<TimeHistory>, modal: &HarmonicCoefficients, modes: usize, phases: &[f64]) -> Self {
        let count = phases.len();
        let forces = Mat::from_fn(contacts.len(), count, |i, k| contacts[i].force[k]);
        let eta = Mat::from_fn(modes, count, |r, k| {
            let tau = phases[k];
            let harmonics = modal.of(r).iter().enumerate();
            harmonics.map(|(n, q)| q.re * (n as f64 * tau).cos() - q.im * (n as f64 * tau).sin()).sum()
        });
        Self { contacts, eta, forces, loads: Mat::zeros(0, count) }
    }

    /// Displacements of these degrees of freedom, m, a row each; with what the static loads move.
    pub fn displacements(&self, open: &OpenStructure, dofs: &[usize], shapes: &[Vec<f64>]) -> Mat<f64> {
        let mut found = open.modes.displacements(dofs, &self.eta, &self.forces);
        // What the static loads move beyond the modes.
        let moved = open.state.as_ref().map(|state| open.beyond_modes(state, dofs));
        for (row, dof) in dofs.iter().enumerate() {
            let still = moved.as_ref().map_or(0.0, |moved| moved[row]);
            for k in 0..found.ncols() {
                let loads = shapes.iter().enumerate().map(|(j, shape)| shape[*dof] * self.loads[(j, k)]);
                found[(row, k)] += still + loads.sum::<f64>();
            }
        }
        found
    }
}
