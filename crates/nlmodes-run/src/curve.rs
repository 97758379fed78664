//! Computed curves of periodic motions as files, figures and page take them, whatever their motions are of: nonlinear
//! modes or responses.

pub(crate) mod figures;
pub(crate) mod histories;
pub(crate) mod page;
pub(crate) mod picture;
pub(crate) mod space;
pub(crate) mod stops;
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
/// Of these, how many are shown.
pub(crate) const SHOWN_MODES: usize = 2;

/// A computed curve of periodic motions, with what is needed to look closer at its points.
pub(crate) trait Curve {
    /// The points, with their coordinates, the name of the curve and why it ends.
    fn branch(&self) -> &ModalBranch;

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

    /// The same at `frames` equidistant instants and the end of the period, with the displacements (m) of these degrees
    /// of freedom of a structure in free-interface modes; those of the contacts are along the directions of the latter.
    ///
    /// # Errors
    /// As [`histories`](Self::histories).
    fn frames(&self, open: &OpenStructure, point: usize, dofs: &[usize], frames: usize) -> Result<Frames, Failure>;
}

/// A structure over a period.
pub(crate) struct Frames {
    /// Its contacts.
    pub contacts: Vec<TimeHistory>,
    /// Displacements, m: degrees of freedom × instants.
    pub displacements: Mat<f64>,
}

impl Frames {
    /// Of contacts that are known and modal coordinates, modes × (H + 1), at `frames` instants.
    pub fn new(
        contacts: Vec<TimeHistory>,
        modal: &HarmonicCoefficients,
        open: &OpenStructure,
        dofs: &[usize],
        frames: usize,
    ) -> Self {
        let forces = Mat::from_fn(contacts.len(), frames, |i, k| contacts[i].force[k]);
        let eta = Mat::from_fn(open.modes.n_modes(), frames, |r, k| {
            let tau = TAU * k as f64 / frames as f64;
            let harmonics = modal.of(r).iter().enumerate();
            harmonics.map(|(n, q)| q.re * (n as f64 * tau).cos() - q.im * (n as f64 * tau).sin()).sum()
        });
        let mut displacements = open.modes.displacements(dofs, &eta, &forces);
        // What the static loads move beyond the modes.
        let moved = open.state.as_ref().map(|state| open.beyond_modes(state, dofs));
        for (row, by) in moved.iter().flatten().enumerate() {
            (0..frames).for_each(|k| displacements[(row, k)] += by);
        }
        Self { displacements, contacts }
    }
}
