//! `starts.npz`: where the exact motions of a branch by shooting start.

use std::path::Path;

use nlmodes::branches::ComputedBranch;
use nlmodes::report::write_starts;

use super::sink::branch_directory;
use crate::Failure;
use crate::files::STARTS;

/// Writes the file of each branch by shooting, from which `verify` can start the motions again without loss.
pub fn write(directory: &Path, all: &[ComputedBranch]) -> Result<(), Failure> {
    for (number, computed) in all.iter().enumerate() {
        let Some(mut problem) = computed.exact()? else { continue };
        let rows = computed.unknowns.iter().map(|x| problem.first_displacement(x)).collect::<Result<Vec<_>, _>>()?;
        let omega: Vec<f64> = computed.branch.points.iter().map(|point| point.omega).collect();
        write_starts(branch_directory(directory, number).join(STARTS), &omega, &rows)?;
    }
    Ok(())
}
