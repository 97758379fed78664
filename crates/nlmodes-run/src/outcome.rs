//! What came out of a run.

mod curve;
mod ending;

use std::time::Duration;

use nlmodes::branches::ComputedTree;
use nlmodes::modal::Participation;
use nlmodes_scene::assemble::StaticState;
use nlmodes_scene::scene::Scene;

use crate::Failure;
use crate::certificate::Certificate;
use crate::linear::LinearFrequencies;
pub use ending::Ending;

/// What came out of one method with one number of harmonics.
#[derive(Debug)]
pub struct PartOutcome {
    /// The scene with that method, that number, its parameters updated, and its own directory.
    pub scene: Scene,
    /// Its branches; of one of several parts the first one only, the others are on disk.
    pub tree: ComputedTree,
    /// What static loads and stops that press do to the structure; `None` without either.
    pub state: Option<StaticState>,
    /// Linear frequencies of the structure.
    pub linear: LinearFrequencies,
    /// Participation of the lowest linear modes in each point of each of these branches.
    pub participation: Vec<Vec<Participation>>,
    /// The verification reports of these branches; none if files could not be written.
    pub certificates: Vec<Certificate>,
    /// From the beginning to the last point.
    pub points_time: Duration,
    /// Differences of overlays from the first branch, one line per stop.
    pub compared: Vec<String>,
    /// From the beginning to the last file.
    pub wall_time: Duration,
    /// Why the files made from complete branches are incomplete.
    pub failure: Option<Failure>,
    /// Whether all branches ended where they were meant to, and all files are there.
    pub is_complete: bool,
}

impl PartOutcome {
    /// Participation of linear modes in the points of its first branch.
    pub(crate) fn shares(&self) -> &[Participation] {
        self.participation.first().map_or(&[], Vec::as_slice)
    }

    /// How its branches ended, in words.
    pub fn endings(&self) -> Vec<Ending> {
        let several = self.tree.branches.len() > 1;
        let name = |number: usize| if several { format!("branch {number}: ") } else { String::new() };
        let branches = self.tree.branches.iter().enumerate();
        branches.map(|(number, computed)| Ending::new(computed, &name(number), self.points_time)).collect()
    }

    /// The estimated errors of the numbers, a sentence for each branch.
    pub fn certificates_text(&self) -> String {
        let several = self.certificates.len() > 1;
        let name = |number: usize| if several { format!(" of branch {number}") } else { String::new() };
        let certificates = self.certificates.iter().enumerate();
        certificates.map(|(number, certificate)| certificate.text(&name(number)) + "\n").collect()
    }
}

/// What came out of a scene.
#[derive(Debug)]
pub struct RunOutcome {
    /// Each method with each of its numbers of harmonics, in the order of the scene.
    pub parts: Vec<PartOutcome>,
    /// How the others differ from the first of several parts, stop by stop, a line each.
    pub compared: Vec<String>,
    /// Why the common files of several parts are not all there.
    pub failure: Option<Failure>,
    /// Whether the end was requested before all parts had begun.
    pub is_cut_off: bool,
}

impl RunOutcome {
    /// Whether all was computed and written.
    pub fn is_complete(&self) -> bool {
        !self.is_cut_off && self.failure.is_none() && self.parts.iter().all(|part| part.is_complete)
    }
}
