//! `starts.npz`: where the exact motions of a branch by shooting start.

use std::path::Path;

use nlmodes::branches::ComputedBranch;
use nlmodes::report::write_starts;
use nlmodes_scene::assemble::{OpenStructure, StaticState};
use nlmodes_scene::scene::Scene;

use super::sink::branch_directory;
use crate::Failure;
use crate::files::STARTS;
use crate::physical::{displacements, written_displacement};

/// Writes the file of each branch by shooting, from which `verify` can start the motions again without loss.
pub fn write(
    directory: &Path,
    scene: &Scene,
    (open, state): (Option<&OpenStructure>, Option<&StaticState>),
    all: &[ComputedBranch],
) -> Result<(), Failure> {
    let moved = state.map(|state| written_displacement(scene, open, state));
    let open = open.filter(|_| scene.structure.straight().is_some());
    for (number, computed) in all.iter().enumerate() {
        let Some(mut problem) = computed.exact()? else { continue };
        let rows = computed.unknowns.iter().map(|x| problem.first_displacement(x)).collect::<Result<Vec<_>, _>>()?;
        let displaced = |x: Vec<f64>| open.map_or_else(|| x.clone(), |open| displacements(open, &x));
        let mut rows: Vec<Vec<f64>> = rows.into_iter().map(displaced).collect();
        if let Some(by) = &moved {
            rows.iter_mut().for_each(|row| row.iter_mut().zip(by).for_each(|(q, by)| *q += by));
        }
        let omega: Vec<f64> = computed.branch.points.iter().map(|point| point.omega).collect();
        write_starts(branch_directory(directory, number).join(STARTS), &omega, &rows)?;
    }
    Ok(())
}
