use nlmodes_modal::{ContactInstant, ContactPeriod, TimeHistory};

use crate::trajectory::Segment;
use crate::verification::{n_intervals, share};
use crate::{ClosedInterval, Trajectory};

/// Gap and force of a contact at an instant, each with its first two time derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactState {
    /// Gap, m, m/s, m/s²; zero while closed.
    pub gap: [f64; 3],
    /// Force, N, N/s, N/s²; zero while open.
    pub force: [f64; 3],
}

impl Trajectory {
    /// Gap and force of contact `contact` at the instant `t`, clamped to the trajectory.
    pub fn contact_state(&self, contact: usize, t: f64) -> ContactState {
        self.segment_at(t).contact_state(contact, t)
    }

    /// Each of `count` contacts over the trajectory, taken as one period.
    pub fn contact_periods(&self, count: usize) -> Vec<ContactPeriod> {
        let (intervals, period) = (self.closed_intervals(), self.duration());
        let of = |contact: usize| {
            let own: Vec<ClosedInterval> = intervals.iter().filter(|i| i.contact == contact).copied().collect();
            let impulse = self.impulse(contact);
            ContactPeriod {
                closed_share: share(&own, contact, period),
                peak_force: self.peak_force(contact),
                mean_force: impulse / period,
                impulse,
                touches: n_intervals(&own, count, period),
                approach_velocity: self.approach_velocity(contact),
                sliding: None,
            }
        };
        (0..count).map(of).collect()
    }

    /// Integral of the force of contact `contact` over the trajectory, N·s.
    pub fn impulse(&self, contact: usize) -> f64 {
        let closed = self.segments.iter().filter(|s| s.phase.closed[contact]);
        // An empty sum of floats is −0.
        closed.map(|s| s.phase.force_motion(contact, &s.start).integral(s.to - s.from)).sum::<f64>() + 0.0
    }

    /// Largest closing speed of the gap of contact `contact` at the beginning of contact, m/s, for a periodic
    /// continuation.
    fn approach_velocity(&self, contact: usize) -> f64 {
        let around = self.segments.last().zip(self.segments.first());
        let pairs = self.segments.windows(2).map(|pair| (&pair[0], &pair[1])).chain(around);
        let touching = pairs.filter(|(before, after)| !before.phase.closed[contact] && after.phase.closed[contact]);
        touching.map(|(before, _)| -before.contact_state(contact, before.to).gap[1]).fold(0.0, f64::max)
    }

    /// Instants for a time history (see [`TimeHistory::exact_instants`]), each with the states of `count` contacts.
    pub fn exact_states(&self, samples: usize, count: usize) -> Vec<(f64, Vec<ContactState>)> {
        let ends: Vec<[f64; 2]> = self.segments.iter().map(|s| [s.from, s.to]).collect();
        let of = |(t, number): (f64, usize)| {
            let states = (0..count).map(|contact| self.segments[number].contact_state(contact, t));
            (t, states.collect())
        };
        TimeHistory::exact_instants(&ends, samples).into_iter().map(of).collect()
    }

    fn segment_at(&self, t: f64) -> &Segment {
        &self.segments[self.segments.partition_point(|s| s.to < t).min(self.segments.len() - 1)]
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
}

impl Segment {
    /// Gap and force of a contact at the instant `t`, clamped to the segment.
    fn contact_state(&self, contact: usize, t: f64) -> ContactState {
        let after = (t.min(self.to) - self.from).max(0.0);
        if self.phase.closed[contact] {
            let force = self.phase.force_motion(contact, &self.start).evaluate(after);
            return ContactState { gap: [0.0; 3], force };
        }
        ContactState { gap: self.phase.guard(contact, &self.start).evaluate(after), force: [0.0; 3] }
    }
}
