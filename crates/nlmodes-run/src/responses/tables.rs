//! Tables of the points that other curves do not have: `branch.csv`, `appropriation.csv`.

use std::fs;
use std::path::Path;

use nlmodes::modal::ModalPoint;
use nlmodes::report::columns::{BranchRow, GradientColumns, ResponseRow, Row};
use nlmodes::report::{ReportError, write_rows};
use nlmodes_scene::scene::Scene;

use super::curves::ComputedResponse;
use super::viewed::{Viewed, viewed};
use crate::Failure;
use crate::curve::Curve;
use crate::forces;
use crate::model::Model;

/// All points of the curves in the order of `branch.csv`, with the curve of each.
pub fn points(curves: &[ComputedResponse]) -> impl Iterator<Item = (usize, &ComputedResponse, &ModalPoint)> {
    curves
        .iter()
        .enumerate()
        .flat_map(|(number, computed)| computed.branch.points.iter().map(move |point| (number, computed, point)))
}

/// Writes `branch.csv` of the curves that are there.
pub fn write_points(
    directory: &Path,
    scene: &Scene,
    model: &Model,
    curves: &[ComputedResponse],
) -> Result<(), ReportError> {
    fs::create_dir_all(directory).map_err(|source| ReportError::Io { path: directory.to_path_buf(), source })?;
    let shown = viewed(scene, model, curves);
    let gradients = GradientColumns::of(shown.iter().flat_map(|one| &one.branch().points));
    let points = shown.iter().flat_map(|one| &one.branch().points);
    let rows = rows(&shown).zip(points).map(|(row, point)| (row, gradients.cells(point)));
    let like = ((BranchRow::unknown(), ResponseRow::unknown()), gradients.cells(&ModalPoint::default()));
    write_rows(directory.join("branch.csv"), &like, rows)
}

/// The points of these curves, one after the other.
pub fn rows<'a>(shown: &'a [Viewed<'a>]) -> impl Iterator<Item = (BranchRow, ResponseRow)> + 'a {
    let points = shown.iter().flat_map(|one| one.branch().points.iter().enumerate().map(move |point| (one, point)));
    points
        .enumerate()
        .filter_map(|(index, (one, (k, point)))| Some((BranchRow::of(index, point), one.response_row(k)?)))
}

/// Writes `appropriation.csv`, the forces of each drive point in each harmonic, where they were computed.
pub fn write_forces(directory: &Path, curves: &[ComputedResponse]) -> Result<(), Failure> {
    let mut rows = Vec::new();
    let mut first = 0;
    for computed in curves {
        for (i, (found, point)) in computed.appropriations.iter().zip(&computed.branch.points).enumerate() {
            for (drive, force) in found.forces.iter().enumerate() {
                rows.extend(forces::rows(first + i, point.listed_omega(), drive, force.get(1..).unwrap_or_default()));
            }
        }
        first += computed.branch.points.len();
    }
    forces::write(directory, rows)
}
