//! What a run tells while it computes, and how it is asked to end.

use std::path::Path;

use nlmodes::branches::Watch;
use nlmodes::modal::ModalPoint;
use nlmodes::virtual_test::TestLevel;
use nlmodes_scene::scene::{Scene, TestScene, Updating};

use crate::outcome::PartOutcome;

/// Something that a run tells.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// The directory holds an interrupted run of this scene, with so many points, which is computed anew.
    Abandoned {
        /// The output directory.
        directory: &'a Path,
        /// Rows of its tables.
        points: usize,
    },
    /// What calls of their own made of the results in the directory is replaced or removed by this run.
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
    /// Something about the structure that a user should know before trusting what comes out.
    Warning(&'a str),
    /// There is no interrupted run to go on with: it is computed from the beginning.
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
    /// Only the first points of a branch stay: a tongue is skipped.
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
    /// A check of the certificate looks at a point, which may take long.
    Looking {
        /// Name of the check.
        check: &'static str,
        /// The point.
        point: usize,
        /// Its number among those that are looked at, from 1, and how many these are.
        number: [usize; 2],
    },
    /// All files of a part are written, or why not is in it.
    Done(&'a PartOutcome),
    /// A virtual test that was to be gone on with begins anew.
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
        /// Whether it stands behind the one that was announced: a branch of that, or the curve from the other end of
        /// the window.
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

/// Whoever looks on while a run computes.
pub trait Observer {
    /// Takes note of what happens.
    fn event(&mut self, event: Event<'_>);

    /// Whether the run is to end behind the step in progress, with what was found.
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Whether the certificates of branches are to look at all that can be looked at, not only at what costs next to
    /// nothing. Default no.
    fn certifies(&self) -> bool {
        false
    }

    /// Who looks on between points, when branches begin: he is told what is sought, and may end that at once. Default
    /// nobody.
    fn watch(&self) -> Watch {
        Watch::default()
    }
}

/// Looks away, and lets the run go on to its end.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {
    fn event(&mut self, _: Event<'_>) {}
}
