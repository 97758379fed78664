//! Tables of the points that other curves do not have: `branch.csv`, `appropriation.csv`.

use std::fs;
use std::path::Path;

use nlmodes::modal::ModalPoint;
use nlmodes::report::columns::{BranchRow, GradientColumns, ResponseRow, Row};
use nlmodes::report::{ReportError, write_rows};
use nlmodes_scene::scene::Scene;

use super::curves::ComputedResponse;
use super::viewed::viewed;
use crate::Failure;
use crate::curve::Curve;
use crate::forces::{self, Forces};
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
    let rows = shown.iter().flat_map(|one| (0..one.branch().points.len()).map(move |k| (one, k)));
    let rows = rows.enumerate().filter_map(|(index, (one, k))| {
        let point = one.branch().points.get(k)?;
        Some(((BranchRow::of(index, point), one.response_row(k)?), gradients.cells(point)))
    });
    let like = ((BranchRow::unknown(), ResponseRow::unknown()), gradients.cells(&ModalPoint::default()));
    write_rows(directory.join("branch.csv"), &like, rows)
}

/// Writes `appropriation.csv`, the forces of each drive point in each harmonic, where they were computed.
pub fn write_forces(directory: &Path, curves: &[ComputedResponse]) -> Result<(), Failure> {
    let mut rows = Vec::new();
    let mut first = 0;
    for computed in curves {
        for (i, (found, point)) in computed.appropriations.iter().zip(&computed.branch.points).enumerate() {
            let of = |(drive, force): (usize, &'_ Vec<_>)| Forces {
                point: first + i,
                omega: point.listed_omega(),
                drive,
                amplitudes: force.iter().skip(1).copied().collect(),
            };
            rows.extend(found.forces.iter().enumerate().map(of));
        }
        first += computed.branch.points.len();
    }
    forces::write(directory, &rows)
}
