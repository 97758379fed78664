//! An inset with the widest internal-resonance branch that is too flat to be visible.

use super::BranchFigure;
use crate::chart::{Axis, Inset, Scale};
use nlmodes_modal::{ModalBranch, ModalPoint, Tongue, tongues};
use std::f64::consts::TAU;

/// Fraction of the height of the figure below which an internal-resonance branch looks like a line, and fraction of its
/// width above which it is enlarged.
const FLAT: f64 = 0.04;
const WIDE: f64 = 0.08;

impl<'a> BranchFigure<'a> {
    /// The part of the figure around it, if there is one.
    pub(super) fn inset(&self, x: Scale, y: Scale) -> Option<Inset> {
        let of_branch = |branch: &&'a ModalBranch| {
            let with_ends = |tongue: Tongue| {
                let end = tongue.end.unwrap_or(branch.points.len() - 1);
                &branch.points[tongue.start.saturating_sub(1)..=(end + 1).min(branch.points.len() - 1)]
            };
            tongues(&branch.points).into_iter().filter(|tongue| !tongue.skipped).map(with_ends).collect::<Vec<_>>()
        };
        let extent = |piece: &[ModalPoint], place: &dyn Fn(&ModalPoint) -> Option<f64>| {
            let places = piece.iter().filter_map(place);
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
            high - low
        };
        let width = |piece: &[ModalPoint]| extent(piece, &|point| x.place(self.place(point).0));
        let height = |piece: &[ModalPoint]| extent(piece, &|point| y.place(self.place(point).1));
        let flat = self.branches.iter().flat_map(of_branch).filter(|piece| height(piece) < FLAT && width(piece) > WIDE);
        let shown = flat.max_by(|a, b| width(a).total_cmp(&width(b)))?;
        let points = || shown.iter().filter(|point| self.is_visible(point));
        Some(Inset {
            x: Axis {
                label: String::new(),
                scale: self.abscissa.scale(points().map(|p| self.abscissa.value(p)), None)?,
            },
            y: Axis { label: String::new(), scale: Scale::linear(points().map(|p| p.omega / TAU), 0.12)? },
        })
    }
}
