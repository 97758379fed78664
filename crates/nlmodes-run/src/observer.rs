//! Events of a run, and how it is ended.

use std::path::Path;

use nlmodes::branches::Watch;
use nlmodes::modal::ModalPoint;
use nlmodes::virtual_test::TestLevel;
use nlmodes_scene::scene::{Scene, TestScene, Updating};

use crate::outcome::PartOutcome;

/// An event of a run.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// The directory has an interrupted run of this scene, with this many points, which is computed again.
    Abandoned {
        /// The output directory.
        directory: &'a Path,
        /// Rows of its tables.
        points: usize,
    },
    /// Files derived from the results in the directory by other calls are replaced or removed by this run.
    Replaces {
        /// The output directory.
        directory: &'a Path,
        /// Certificates of `run --certify`, in whose place come those of a plain run.
        certificates: usize,
        /// Figures as PDF or PNG, which are removed.
        drawn: usize,
    },
    /// The parameters of one of several methods' scenes are updated next.
    Updating {
        /// Number of the method, from 0.
        number: usize,
        /// How many there are.
        of: usize,
        /// Its scene.
        scene: &'a Scene,
    },
    /// Parameters were updated.
    Updated(&'a Updating),
    /// One of several parts begins: a method, or a number of harmonics.
    Part {
        /// Number of the part, from 0.
        number: usize,
        /// How many there are.
        of: usize,
        /// Its folder within the output directory.
        folder: &'a Path,
    },
    /// The branches of this scene begin.
    Begun(&'a Scene),
    /// A warning about the structure before trusting the results.
    Warning(&'a str),
    /// There is no interrupted run to continue: the computation starts from the beginning.
    NothingToResume {
        /// The output directory.
        directory: &'a Path,
    },
    /// A point, found or repeated from an earlier run.
    Point {
        /// Number of its branch, from 0.
        branch: usize,
        /// The point.
        point: &'a ModalPoint,
        /// Whether it was computed now.
        is_new: bool,
    },
    /// Only the first points of a branch are kept: an internal resonance is skipped.
    Withdrawn {
        /// How many stay.
        kept: usize,
    },
    /// The branch goes the other way from its start, which is found once more.
    Turned {
        /// Points that are there.
        points: usize,
    },
    /// No more points come.
    Computed,
    /// A check of the verification report examines a point, which may take long.
    Looking {
        /// Name of the check.
        check: &'static str,
        /// The point.
        point: usize,
        /// Its number among those checked, from 1, and their number.
        number: [usize; 2],
    },
    /// All files of a part are written, or why not is in it.
    Done(&'a PartOutcome),
    /// A virtual test that was to be continued starts again.
    TestBeginsAnew,
    /// The rig of a virtual test, in a line.
    Rig(&'a str),
    /// A curve of damped or forced motions begins.
    Curve {
        /// Number of the curve, from 1.
        number: usize,
        /// How many are to be computed.
        of: usize,
        /// Its name.
        name: &'a str,
    },
    /// A curve of damped or forced motions is there, or why not.
    CurveDone {
        /// Its name.
        name: &'a str,
        /// Whether it follows the announced one: a branch of it, or the curve from the other end of the window.
        is_further: bool,
        /// Points, and in words why there are no more; or why there are none.
        outcome: Result<(usize, &'a str), &'a str>,
        /// Whether it ended where it was meant to.
        is_complete: bool,
    },
    /// A level of a virtual test is recorded.
    Level {
        /// Its scene.
        scene: &'a TestScene,
        /// Number of the level, from 1.
        number: usize,
        /// What was recorded and extracted.
        level: &'a TestLevel,
    },
}

/// Observer of a run.
pub trait Observer {
    /// Takes note of what happens.
    fn event(&mut self, event: Event<'_>);

    /// Whether the run is to end after the current step, with the results so far.
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Whether the verification reports of branches include all checks, not only those at next to no cost. Default no.
    fn certifies(&self) -> bool {
        false
    }

    /// Observer between points, when branches start: it is informed about searches, and may end them at once. Default
    /// none.
    fn watch(&self) -> Watch {
        Watch::default()
    }
}

impl dyn Observer + '_ {
    /// Passes warnings on.
    pub(crate) fn warn(&mut self, texts: impl IntoIterator<Item: AsRef<str>>) {
        texts.into_iter().for_each(|text| self.event(Event::Warning(text.as_ref())));
    }
}

/// Ignores everything, and lets the run continue to its end.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {
    fn event(&mut self, _: Event<'_>) {}
}
