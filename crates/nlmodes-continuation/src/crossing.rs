//! Points where more than two half-branches meet: what leaves them, and which way a branch goes on.

use crate::corrector::Correction;
use crate::half_branches::outward;
use crate::record::{is_direction, is_vector};
use crate::vectors::{distance, dot};

/// Distance below which two branch points are one.
const SAME: f64 = 1e-4;

/// Which half-branch a branch follows where more than two meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AtBranchPoint {
    /// Its own, through the point: straight on, or at a kink so that all curves through it, half-branches joined in
    /// pairs, turn least in all.
    #[default]
    Stay,
    /// One of the others: that along which the parameter grows most.
    Switch,
}

/// A half-branch of the solution set that leaves a branch point.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Arm {
    /// Its first point; the tangent leads away from the branch point.
    pub start: Correction,
    /// Whether the branch went on along this half-branch.
    pub followed: bool,
}

/// A point where more than two half-branches meet, as a branch came to it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Crossing {
    /// Index in [`crate::Branch::points`].
    pub point: usize,
    /// Where it is, `z = (x, p)`.
    pub z: Vec<f64>,
    /// The half-branches, but for the one on which the branch came.
    pub arms: Vec<Arm>,
    /// Dimension of the kernel of the Jacobian, two at a simple branch point; one where smooth pieces meet whose
    /// Jacobians have no more.
    pub kernel: usize,
    /// Whether these are all: not where they were found by a search, as where more than one direction is free.
    pub complete: bool,
}

/// Half-branches around a branch point before the branch has chosen: the way back, its own continuation and the others.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Choice {
    /// Where it is, `z = (x, p)`.
    pub z: Vec<f64>,
    /// Unit vector toward the way back.
    pub back: Vec<f64>,
    /// The other half-branches.
    pub arms: Vec<Correction>,
    /// Index of the branch's own continuation.
    pub own: usize,
    /// Dimension of the kernel of the Jacobian.
    #[cfg_attr(feature = "serde", serde(default))]
    pub kernel: usize,
    /// Whether these are all.
    #[cfg_attr(feature = "serde", serde(default))]
    pub complete: bool,
}

impl Choice {
    /// Whether this can be a branch point of a system with n unknowns.
    pub(crate) fn is_of(&self, n: usize) -> bool {
        is_vector(&self.z, n + 1)
            && is_direction(&self.back, n + 1)
            && self.own < self.arms.len()
            && self.arms.iter().all(|arm| arm.is_of(n))
    }

    /// Index of the half-branch to follow.
    pub(crate) fn arm(&self, rule: AtBranchPoint) -> usize {
        let growth = |k: &usize| outward(&self.z, &self.arms[*k].z).last().copied().unwrap_or(0.0);
        let others = (0..self.arms.len()).filter(|k| *k != self.own);
        match rule {
            AtBranchPoint::Stay => self.own,
            AtBranchPoint::Switch => others.max_by(|a, b| growth(a).total_cmp(&growth(b))).unwrap_or(self.own),
        }
    }

    pub(crate) fn crossing(&self, point: usize, followed: Option<usize>) -> Crossing {
        let arms = self.arms.iter().enumerate();
        let arms = arms.map(|(k, start)| Arm { start: start.clone(), followed: followed == Some(k) });
        Crossing { point, z: self.z.clone(), arms: arms.collect(), kernel: self.kernel, complete: self.complete }
    }
}

/// The branch points that several branches met, and which of their half-branches have been passed.
#[derive(Debug, Default)]
pub(crate) struct Registry {
    crossings: Vec<Known>,
}

#[derive(Debug)]
struct Known {
    z: Vec<f64>,
    arms: Vec<KnownArm>,
}

#[derive(Debug)]
struct KnownArm {
    outward: Vec<f64>,
    passed: bool,
    /// Where it starts, and the branch and its branch point that found it; `None` for a half-branch on which a branch
    /// came.
    start: Option<(Correction, usize, usize)>,
}

/// A half-branch that no branch has passed: its first point, the branch that found it, and the number of that branch's
/// branch point.
pub(crate) struct Open {
    pub start: Correction,
    pub branch: usize,
    pub crossing: usize,
}

impl Registry {
    /// Takes note that branch `branch` came to its branch point number `crossing` and wants to go on along `arm`.
    ///
    /// False if that half-branch has been passed already.
    pub fn enter(&mut self, choice: &Choice, arm: usize, branch: usize, crossing: usize) -> bool {
        let onward = outward(&choice.z, &choice.arms[arm].z);
        if let Some(known) = self.crossings.iter_mut().find(|k| distance(&k.z, &choice.z) < SAME) {
            known.pass(&choice.back);
            return known.pass(&onward);
        }
        let back = KnownArm { outward: choice.back.clone(), passed: true, start: None };
        let arms = choice.arms.iter().enumerate().map(|(k, start)| KnownArm {
            outward: outward(&choice.z, &start.z),
            passed: k == arm,
            start: Some((start.clone(), branch, crossing)),
        });
        self.crossings.push(Known { z: choice.z.clone(), arms: std::iter::once(back).chain(arms).collect() });
        true
    }

    /// The next half-branch that no branch has passed, which counts as passed from now on.
    pub fn next_open(&mut self) -> Option<Open> {
        let mut arms = self.crossings.iter_mut().flat_map(|k| &mut k.arms);
        let arm = arms.find(|a| !a.passed)?;
        arm.passed = true;
        let (start, branch, crossing) = arm.start.clone()?;
        Some(Open { start, branch, crossing })
    }

    /// Number of half-branches that no branch has passed.
    pub fn n_open(&self) -> usize {
        self.crossings.iter().flat_map(|k| &k.arms).filter(|a| !a.passed).count()
    }
}

impl Known {
    /// Marks the half-branch in this direction; false if it was passed before.
    fn pass(&mut self, direction: &[f64]) -> bool {
        let nearest =
            self.arms.iter_mut().max_by(|a, b| dot(&a.outward, direction).total_cmp(&dot(&b.outward, direction)));
        nearest.is_some_and(|arm| !std::mem::replace(&mut arm.passed, true))
    }
}
