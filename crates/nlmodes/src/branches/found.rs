//! The points of a branch as they are found.

use std::ops::ControlFlow;

use nlmodes_continuation::{Branch, BranchPoint};
use nlmodes_hbm::TruncationError;
use nlmodes_modal::{Event, ModalPoint};

use super::Watch;
use super::events::event_of;
use super::left::Departure;
use super::viewer::Viewer;

/// The beginning of a run.
#[derive(Debug, Clone, Copy)]
pub(super) enum First {
    /// Its first point has this event.
    Named(Event),
    /// Its first point is known already and is not found again.
    Known,
    /// Nothing happens there.
    Plain,
}

/// The points of a branch as they are found.
#[derive(Default)]
pub(super) struct Found {
    pub points: Vec<ModalPoint>,
    /// Scaled unknowns of each.
    pub unknowns: Vec<Vec<f64>>,
    pub evaluations: usize,
    pub refused_steps: usize,
    /// The largest error that the held modes left out cause, by estimate.
    pub largest_held_modes_error: f64,
    /// Points kept when each point of the continuation had been seen.
    seen: Vec<usize>,
    start_event: Option<Event>,
    /// Where the branch leaves its nonlinear mode.
    departure: Departure,
    /// Where the run began, and whether that point is left out.
    start: Option<Vec<f64>>,
    start_is_known: bool,
}

impl Found {
    pub(super) fn new(first: &First) -> Self {
        let start_event = if let First::Named(event) = first { Some(*event) } else { None };
        Self { start_event, start_is_known: matches!(first, First::Known), ..Self::default() }
    }

    /// The point that is kept of one of the continuation, if it is.
    fn keep(&mut self, viewer: &mut Viewer, point: &BranchPoint) -> &[ModalPoint] {
        let before = self.points.len();
        self.take(viewer, point);
        self.seen.push(self.points.len());
        &self.points[before..]
    }

    /// As [`Self::keep`], but nothing once the computation has ended: what is found then may lack what could not be
    /// looked for any more.
    pub(super) fn keep_unless_ended(
        &mut self,
        watch: &Watch,
        viewer: &mut Viewer,
        point: &BranchPoint,
    ) -> ControlFlow<(), &[ModalPoint]> {
        if watch.has_ended() {
            return ControlFlow::Break(());
        }
        let before = self.points.len();
        self.keep(viewer, point);
        if watch.has_ended() {
            self.truncate(before);
            self.seen.pop();
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(&self.points[before..])
    }

    fn take(&mut self, viewer: &mut Viewer, point: &BranchPoint) -> Option<()> {
        let is_first = self.start.is_none();
        if is_first {
            self.start = Some(point.x.clone());
            if self.start_is_known {
                return None;
            }
        } else if !point.events.is_empty() && self.is_start(point) {
            // What the continuation meets at the start is the grazing itself.
            return None;
        }
        let named = self.start_event.take_if(|_| is_first);
        self.add(viewer, point, named.into_iter().collect(), None)
    }

    /// Adds a point with these events beside those of the continuation.
    fn add(
        &mut self,
        viewer: &mut Viewer,
        point: &BranchPoint,
        names: Vec<Event>,
        error: Option<TruncationError>,
    ) -> Option<()> {
        let mut modal = viewer.see(&point.x, point.residual)?;
        modal.events = names.into_iter().chain(point.events.iter().map(|e| event_of(*e))).collect();
        modal.error_estimate = error.map(|e| e.frequency);
        self.largest_held_modes_error = error.map_or(0.0, |e| e.held_modes).max(self.largest_held_modes_error);
        if self.departure.is_seen(&modal) {
            modal.events.push(Event::OtherMode);
        }
        self.points.push(modal);
        self.unknowns.push(point.x.clone());
        Some(())
    }

    /// A run begins, from a point that has not been seen.
    pub(super) fn begin(&mut self) {
        self.start = None;
    }

    /// Whether the first point of a run has not been left yet.
    pub(super) fn is_at_start(&self) -> bool {
        self.start.is_none()
    }

    /// A run leaves its first point.
    pub(super) fn leave_start(&mut self, point: &BranchPoint) {
        self.start = Some(point.x.clone());
    }

    /// Keeps a point with an estimate of its error and with these events.
    pub(super) fn keep_named(
        &mut self,
        viewer: &mut Viewer,
        point: &BranchPoint,
        names: Vec<Event>,
        error: Option<TruncationError>,
    ) -> &[ModalPoint] {
        let before = self.points.len();
        if point.events.is_empty() || !self.is_start(point) {
            self.add(viewer, point, names, error);
        }
        &self.points[before..]
    }

    /// Index of the point kept last when point `number` of the continuation had been seen.
    pub fn index_of(&self, number: usize) -> usize {
        self.seen.get(number).map_or(0, |n| n.saturating_sub(1))
    }

    pub(super) fn count(&mut self, branch: &Branch) {
        self.evaluations += branch.evaluations;
        self.refused_steps += branch.refused_steps;
    }

    fn is_start(&self, point: &BranchPoint) -> bool {
        self.start.as_ref().is_some_and(|first| first.iter().zip(&point.x).all(|(a, b)| (a - b).abs() < 1e-6))
    }

    /// Keeps the first `count` points.
    pub fn truncate(&mut self, count: usize) {
        self.points.truncate(count);
        self.unknowns.truncate(count);
    }

    /// Takes the points of another run behind its own.
    pub fn append(&mut self, mut other: Found) {
        self.points.append(&mut other.points);
        self.unknowns.append(&mut other.unknowns);
        self.evaluations += other.evaluations;
        self.refused_steps += other.refused_steps;
        self.largest_held_modes_error = self.largest_held_modes_error.max(other.largest_held_modes_error);
    }

    pub fn reverse(&mut self) {
        self.points.reverse();
        self.unknowns.reverse();
    }
}
