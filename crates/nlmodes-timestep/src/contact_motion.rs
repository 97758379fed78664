use nlmodes_modal::ContactInstant;

use crate::trajectory::Segment;
use crate::{ClosedInterval, Trajectory};

/// Gap and force of a contact at an instant, each with its first two derivatives by time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactState {
    /// Gap, m, m/s, m/s²; zero while closed.
    pub gap: [f64; 3],
    /// Force, N, N/s, N/s²; zero while open.
    pub force: [f64; 3],
}

impl Trajectory {
    /// Gap and force of contact `contact` at the instant `t`, which is kept within the trajectory.
    pub fn contact_state(&self, contact: usize, t: f64) -> ContactState {
        let segment = self.segment_at(t);
        let after = (t.min(segment.to) - segment.from).max(0.0);
        if segment.phase.closed[contact] {
            let force = segment.phase.force_motion(contact, &segment.start).evaluate(after);
            return ContactState { gap: [0.0; 3], force };
        }
        ContactState { gap: segment.phase.guard(contact, &segment.start).evaluate(after), force: [0.0; 3] }
    }

    /// Largest force of contact `contact`, N.
    pub fn peak_force(&self, contact: usize) -> f64 {
        let closed = self.segments.iter().filter(|s| s.phase.closed[contact]);
        closed.map(|s| -s.phase.force_motion(contact, &s.start).negated().lowest(s.to - s.from)).fold(0.0, f64::max)
    }

    /// Smallest gap of contact `contact`, m; zero if it is ever closed.
    pub fn smallest_gap(&self, contact: usize) -> f64 {
        let lowest = |s: &Segment| match s.phase.closed[contact] {
            true => 0.0,
            false => s.phase.guard(contact, &s.start).lowest(s.to - s.from),
        };
        self.segments.iter().map(lowest).fold(f64::INFINITY, f64::min)
    }

    /// Instants within the trajectory at which contact `contact` closes or opens.
    pub fn contact_instants(&self, contact: usize) -> Vec<ContactInstant> {
        let end = self.duration();
        let of = |interval: &ClosedInterval| {
            let ends = [(interval.from, true), (interval.to, false)];
            ends.map(|(time, touching)| ContactInstant { time, touching })
        };
        let intervals = self.closed_intervals();
        let all = intervals.iter().filter(|i| i.contact == contact).flat_map(of);
        all.filter(|instant| instant.time > 0.0 && instant.time < end).collect()
    }

    fn segment_at(&self, t: f64) -> &Segment {
        &self.segments[self.segments.partition_point(|s| s.to < t).min(self.segments.len() - 1)]
    }
}
