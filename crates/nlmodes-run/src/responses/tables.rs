//! Tables of the points: `branch.csv`, `contacts.csv`, `harmonics.npz`, `appropriation.csv`.

use std::fs;
use std::path::Path;

use nlmodes::modal::{ModalBranch, ModalPoint};
use nlmodes::report::columns::{BranchRow, ResponseOf, ResponseRow, Row};
use nlmodes::report::{ReportError, write_contacts, write_harmonics, write_rows};

use super::curves::ComputedResponse;
use crate::Failure;
use crate::forces::{self, Forces};

/// All points of the curves in the order of `branch.csv`, with the curve of each.
pub fn points(curves: &[ComputedResponse]) -> impl Iterator<Item = (usize, &ComputedResponse, &ModalPoint)> {
    curves
        .iter()
        .enumerate()
        .flat_map(|(number, computed)| computed.branch.points.iter().map(move |point| (number, computed, point)))
}

/// Writes `branch.csv` of the curves that are there.
pub fn write_points(directory: &Path, unit: &str, curves: &[ComputedResponse]) -> Result<(), ReportError> {
    fs::create_dir_all(directory).map_err(|source| ReportError::Io { path: directory.to_path_buf(), source })?;
    let row = |(index, (curve, computed, point)): (usize, (usize, &ComputedResponse, &ModalPoint))| {
        let of = ResponseOf {
            response: computed.response + 1,
            kind: computed.kind.name(),
            curve,
            name: &computed.branch.label,
            is_detached: computed.is_detached,
            unit,
        };
        (BranchRow::of(index, point), ResponseRow::of(of, point))
    };
    let like = (BranchRow::unknown(), ResponseRow::unknown());
    write_rows(directory.join("branch.csv"), &like, points(curves).enumerate().map(row))
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

/// Writes `contacts.csv` and `harmonics.npz` of all points, in the order of `branch.csv`.
pub fn write_motions(directory: &Path, curves: &[ComputedResponse]) -> Result<(), Failure> {
    let Some(first) = curves.first() else { return Ok(()) };
    let points = points(curves).map(|(_, _, point)| point.clone()).collect();
    let all = ModalBranch { points, ..first.branch.clone() };
    write_contacts(directory.join("contacts.csv"), &all)?;
    Ok(write_harmonics(directory.join("harmonics.npz"), &all)?)
}
