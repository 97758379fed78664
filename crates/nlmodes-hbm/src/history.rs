use std::f64::consts::{PI, TAU};

use nlmodes_modal::{ClosedSpan, ContactInstant, TimeHistory};
use nlmodes_model::DofContact;

use crate::closed_set::ClosedSet;
use crate::contact_operator::{ContactOperator, PatternInterval};
use crate::trigonometric::evaluate;
use crate::trigonometric::inner;
use crate::{HbmError, PeriodicSystem, Symmetry};

/// Largest deviations from what a motion with contact must satisfy, over the samples of a period, in scaled units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct ContactDefects {
    /// Largest penetration `max(−g)` over the length scale.
    pub penetration: f64,
    /// Largest tensile force `max(−λ)` over the largest force.
    pub tension: f64,
    /// Largest `|min(g, Aλ)|` over the length scale.
    pub complementarity: f64,
}

/// Displacement, velocity and acceleration of the degree of freedom of a stop, from its gap with two derivatives by
/// phase.
fn along(of: &DofContact, omega: f64, gap: [f64; 3]) -> [f64; 3] {
    let side = of.side.sign();
    [side * (of.gap - gap[0]), -side * omega * gap[1], -side * omega * omega * gap[2]]
}

/// Contacts over a period: stops at degrees of freedom, and a motion of angular frequency `omega` (rad/s).
impl ContactOperator {
    /// Motion and force of each contact at `samples` equidistant instants and the end of the period.
    pub(crate) fn equidistant_histories(
        &self,
        contacts: &[DofContact],
        omega: f64,
        samples: usize,
        label: &str,
    ) -> Vec<TimeHistory> {
        let phases = (0..=samples).map(|j| TAU * j as f64 / samples as f64);
        self.histories(contacts, omega, label, phases.map(|tau| (tau, self.set_at(tau))))
    }

    /// Motion and force of all contacts, exact at the instants of contact.
    pub(crate) fn time_histories(
        &self,
        contacts: &[DofContact],
        omega: f64,
        samples: usize,
        label: &str,
    ) -> Vec<TimeHistory> {
        let segments: Vec<(f64, f64, usize)> = self.whole_period();
        let ends: Vec<[f64; 2]> = segments.iter().map(|s| [s.0, s.1]).collect();
        let instants = TimeHistory::exact_instants(&ends, samples).into_iter();
        self.histories(contacts, omega, label, instants.map(|(tau, segment)| (tau, segments[segment].2)))
    }

    /// Motion and force of all contacts at these phases, each with the closed set that its segment has.
    fn histories(
        &self,
        contacts: &[DofContact],
        omega: f64,
        label: &str,
        phases: impl Iterator<Item = (f64, usize)>,
    ) -> Vec<TimeHistory> {
        let empty = |(contact, of): (usize, &DofContact)| TimeHistory {
            instants: self.instants(contact, omega),
            ..TimeHistory::empty(label, of.side.sign() * of.gap)
        };
        let mut histories: Vec<TimeHistory> = contacts.iter().enumerate().map(empty).collect();
        let stops: Vec<f64> = contacts.iter().map(DofContact::stop_compliance).collect();
        let mut last = f64::NEG_INFINITY;
        for (tau, set) in phases {
            last = (tau / omega).max(f64::next_up(last));
            let states = self.states_in(self.sets.get(set), tau, &stops);
            for ((history, of), (gap, force)) in histories.iter_mut().zip(contacts).zip(states) {
                history.push(last, along(of, omega, gap), force);
            }
        }
        histories
    }

    /// Of each contact its gap (m), with two derivatives by phase, and its force (N) at phase `tau`, as the formulas of
    /// this interval give them: the gap of a closed contact is negative by what its stop, of this compliance (m/N),
    /// yields.
    pub fn states(&self, interval: &PatternInterval, tau: f64, stops: &[f64]) -> Vec<([f64; 3], f64)> {
        self.states_in(self.sets.get(interval.set), tau, stops)
    }

    fn states_in(&self, set: &ClosedSet, tau: f64, stops: &[f64]) -> Vec<([f64; 3], f64)> {
        let values: Vec<[f64; 3]> = self.y.iter().map(|y| evaluate(y, tau)).collect();
        let y = [0, 1, 2].map(|order| values.iter().map(|value| value[order]).collect::<Vec<f64>>());
        stops.iter().enumerate().map(|(i, compliance)| state_in(set, i, *compliance, &y)).collect()
    }

    /// The intervals of one contact pattern over the whole period: phases of their ends, closed set.
    fn whole_period(&self) -> Vec<(f64, f64, usize)> {
        let of = |i: &PatternInterval| (i.from, i.to, i.set);
        let forward = self.intervals.iter().map(of);
        let is_even = self.series.symmetry == Symmetry::Even;
        let mirrored = self.intervals.iter().rev().filter(|_| is_even).map(|i| (TAU - i.to, TAU - i.from, i.set));
        let mut all: Vec<(f64, f64, usize)> = Vec::new();
        for interval in forward.chain(mirrored) {
            match all.last_mut() {
                Some(last) if last.2 == interval.2 => last.1 = interval.1,
                _ => all.push(interval),
            }
        }
        all
    }

    /// The spans of a period in which each contact is closed, with its force: a series for each contact pattern.
    pub fn closed_spans(&self) -> Vec<Vec<ClosedSpan>> {
        let mut all = vec![Vec::new(); self.y.len()];
        for (from, to, set) in self.whole_period() {
            let set = self.sets.get(set);
            for &i in &set.active {
                all[i].push(ClosedSpan { from, to, force: self.combination(set.force_row(i)).z });
            }
        }
        all
    }

    pub(crate) fn set_at(&self, tau: f64) -> usize {
        let tau = if self.series.symmetry == Symmetry::Even && tau > PI { TAU - tau } else { tau };
        let at = self.intervals.partition_point(|i| i.to < tau).min(self.intervals.len() - 1);
        self.intervals[at].set
    }

    /// Instants within a period at which the contact closes or opens.
    fn instants(&self, contact: usize, omega: f64) -> Vec<ContactInstant> {
        let mut found = Vec::new();
        for pair in self.intervals.windows(2) {
            let [before, after] = [0, 1].map(|k| self.closed(&pair[k])[contact]);
            if before != after {
                found.push(ContactInstant { time: pair[0].to / omega, touching: after });
                if self.series.symmetry == Symmetry::Even {
                    found.push(ContactInstant { time: (TAU - pair[0].to) / omega, touching: before });
                }
            }
        }
        found.sort_by(|a, b| a.time.total_cmp(&b.time));
        found
    }
}

impl PeriodicSystem {
    /// Largest violations of `0 ≤ g ⊥ λ ≥ 0` over `samples` instants of a period of the point with the unknowns `x`.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn check_contact(&mut self, x: &[f64], samples: usize) -> Result<ContactDefects, HbmError> {
        self.solve(x, 0.0)?;
        let (a, length, operator) = (self.structure.compliance().a(), self.scales.length, &self.operator);
        let mut worst = ContactDefects::default();
        for j in 0..samples {
            let tau = TAU * (j as f64 + 0.5) / samples as f64;
            let at: Vec<f64> = operator.y.iter().map(|y| evaluate(y, tau)[0]).collect();
            let set = operator.sets.get(operator.set_at(tau));
            let force: Vec<f64> = (0..at.len()).map(|i| set.force(i, &at)).collect();
            for i in 0..at.len() {
                let row: Vec<f64> = (0..at.len()).map(|k| a[(i, k)]).collect();
                let gap = (at[i] + inner(&row, &force)) / length;
                let push = force[i] * a[(i, i)] / length;
                worst.penetration = worst.penetration.max(-gap);
                worst.tension = worst.tension.max(-push);
                worst.complementarity = worst.complementarity.max(gap.min(push).abs());
            }
        }
        Ok(worst)
    }
}

/// Gap with two derivatives by τ, and force, of a contact whose stop yields by `compliance`, while one set of contacts
/// is closed; `y` are the gaps without contact forces and their two derivatives.
fn state_in(set: &ClosedSet, contact: usize, compliance: f64, y: &[Vec<f64>; 3]) -> ([f64; 3], f64) {
    if set.closed[contact] {
        let force = [0, 1, 2].map(|order| set.force(contact, &y[order]));
        return (force.map(|f| -compliance * f), force[0]);
    }
    ([0, 1, 2].map(|order| set.guard_value(contact, &y[order])), 0.0)
}
