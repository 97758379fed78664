//! `starts.npz`: where the exact motions of a branch by shooting start.

use std::path::Path;

use nlmodes::branches::ComputedBranch;
use nlmodes::report::write_starts;
use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::Scene;

use super::sink::branch_directory;
use crate::Failure;
use crate::files::STARTS;
use crate::physical::displacements;

/// Writes the file of each branch by shooting, from which `verify` can start the motions again without loss.
pub fn write(
    directory: &Path,
    scene: &Scene,
    open: Option<&OpenStructure>,
    all: &[ComputedBranch],
) -> Result<(), Failure> {
    let open = open.filter(|_| scene.structure.straight().is_some());
    for (number, computed) in all.iter().enumerate() {
        let Some(mut problem) = computed.exact()? else { continue };
        let rows = computed.unknowns.iter().map(|x| problem.first_displacement(x)).collect::<Result<Vec<_>, _>>()?;
        let displaced = |x: Vec<f64>| open.map_or_else(|| x.clone(), |open| displacements(open, &x));
        let rows: Vec<Vec<f64>> = rows.into_iter().map(displaced).collect();
        let omega: Vec<f64> = computed.branch.points.iter().map(|point| point.omega).collect();
        write_starts(branch_directory(directory, number).join(STARTS), &omega, &rows)?;
    }
    Ok(())
}
