//! Tables and arrays of whole curves.

use std::path::Path;

use nlmodes::modal::{ModalBranch, Participation};
use nlmodes::report::columns::ResponseRow;
use nlmodes::report::{write_contacts, write_harmonics, write_histories, write_matlab, write_participation};
use nlmodes_scene::scene::OutputFiles;

use super::{Curve, histories};
use crate::Failure;

/// The points of several curves in the order of their table.
fn together(curves: &[&dyn Curve]) -> Option<ModalBranch> {
    let points = curves.iter().flat_map(|curve| curve.branch().points.iter().cloned()).collect();
    curves.first().map(|first| ModalBranch { points, ..first.branch().clone() })
}

/// Writes what the contacts do, the motions, and the participation of the lowest linear modes, of all points of these
/// curves one behind the other: `contacts.csv`, `harmonics.npz`, `participation.csv`.
pub fn write(directory: &Path, curves: &[&dyn Curve]) -> Result<(), Failure> {
    let Some(all) = together(curves) else { return Ok(()) };
    let participation: Vec<Participation> = curves.iter().flat_map(|curve| curve.participation()).cloned().collect();
    write_contacts(directory.join("contacts.csv"), &all)?;
    write_harmonics(directory.join("harmonics.npz"), &all)?;
    Ok(write_participation(directory.join("participation.csv"), &all, &participation)?)
}

/// Writes `histories.npz`, and `results.mat` where it is asked for.
pub fn write_motions(directory: &Path, files: &OutputFiles, curves: &[&dyn Curve]) -> Result<(), Failure> {
    let Some(all) = together(curves) else { return Ok(()) };
    let histories = histories::of_points(curves, files)?;
    if !histories.points.is_empty() {
        write_histories(directory.join("histories.npz"), &histories)?;
    }
    if files.matlab {
        let each = curves.iter().flat_map(|curve| (0..curve.branch().points.len()).map(|k| curve.response_row(k)));
        let further: Vec<ResponseRow> = each.flatten().collect();
        write_matlab(directory.join("results.mat"), &all, &further, &histories)?;
    }
    Ok(())
}
