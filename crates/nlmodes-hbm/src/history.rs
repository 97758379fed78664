use std::f64::consts::{PI, TAU};

use nlmodes_modal::{ContactInstant, TimeHistory};

use crate::energy::inner;
use crate::trigonometric::Trigonometric;
use crate::{HbmError, MixedShooting, Symmetry};

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
impl MixedShooting<'_> {
    /// Motion and force of contact `contact` over one period of the point with the unknowns `x`, at `samples` equidistant
    /// instants and the end of the period.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    ///
    /// # Panics
    /// If there is no such contact.
    pub fn time_history(
        &mut self,
        x: &[f64],
        contact: usize,
        samples: usize,
        label: &str,
    ) -> Result<TimeHistory, HbmError> {
        self.solve_contact(x)?;
        let omega = self.omega(x);
        let of = self.structure().model().contacts()[contact];
        let mut history = TimeHistory {
            label: label.to_owned(),
            time: Vec::with_capacity(samples + 1),
            displacement: Vec::with_capacity(samples + 1),
            velocity: Vec::with_capacity(samples + 1),
            acceleration: Vec::with_capacity(samples + 1),
            force: Vec::with_capacity(samples + 1),
            stop: of.side.sign() * of.gap,
            instants: self.instants(contact, omega),
        };
        let y: Vec<Trigonometric> = self.sweep.y.iter().map(|z| Trigonometric { z: z.clone() }).collect();
        for j in 0..=samples {
            let tau = TAU * j as f64 / samples as f64;
            let (gap, force) = self.contact_state(&y, contact, tau);
            history.time.push(tau / omega);
            history.displacement.push(of.side.sign() * (of.gap - gap[0]));
            history.velocity.push(-of.side.sign() * omega * gap[1]);
            history.acceleration.push(-of.side.sign() * omega * omega * gap[2]);
            history.force.push(force);
        }
        Ok(history)
    }

    /// Gap with two derivatives by τ, and force, of a contact at the phase `tau`.
    fn contact_state(&self, y: &[Trigonometric], contact: usize, tau: f64) -> ([f64; 3], f64) {
        let set = self.sweep.sets.get(self.set_at(tau));
        let values: Vec<[f64; 3]> = y.iter().map(|y| y.evaluate(tau)).collect();
        let at = |order: usize| values.iter().map(|v| v[order]).collect::<Vec<f64>>();
        if set.closed[contact] {
            // The stop yields by its own compliance; a rigid one not at all.
            let yields = self.structure().model().contacts()[contact].law.compliance();
            let force = [0, 1, 2].map(|order| set.force(contact, &at(order)));
            return (force.map(|f| -yields * f), force[0]);
        }
        ([0, 1, 2].map(|order| set.guard_value(contact, &at(order))), 0.0)
    }

    fn set_at(&self, tau: f64) -> usize {
        let tau = if self.series().symmetry == Symmetry::Even && tau > PI { TAU - tau } else { tau };
        let at = self.sweep.intervals.partition_point(|i| i.to < tau).min(self.sweep.intervals.len() - 1);
        self.sweep.intervals[at].set
    }

    /// Instants within a period at which the contact closes or opens.
    fn instants(&self, contact: usize, omega: f64) -> Vec<ContactInstant> {
        let mut found = Vec::new();
        for pair in self.sweep.intervals.windows(2) {
            let [before, after] = [0, 1].map(|k| self.sweep.closed(&pair[k])[contact]);
            if before != after {
                found.push(ContactInstant { time: pair[0].to / omega, touching: after });
                if self.series().symmetry == Symmetry::Even {
                    found.push(ContactInstant { time: (TAU - pair[0].to) / omega, touching: before });
                }
            }
        }
        found.sort_by(|a, b| a.time.total_cmp(&b.time));
        found
    }

    /// Largest violations of `0 ≤ g ⊥ λ ≥ 0` over `samples` instants of a period of the point with the unknowns `x`.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn check_contact(&mut self, x: &[f64], samples: usize) -> Result<ContactDefects, HbmError> {
        self.solve_contact(x)?;
        let y: Vec<Trigonometric> = self.sweep.y.iter().map(|z| Trigonometric { z: z.clone() }).collect();
        let a = self.structure().compliance().a();
        let length = self.scales.length;
        let mut worst = ContactDefects::default();
        for j in 0..samples {
            let tau = TAU * (j as f64 + 0.5) / samples as f64;
            let at: Vec<f64> = y.iter().map(|y| y.evaluate(tau)[0]).collect();
            let set = self.sweep.sets.get(self.set_at(tau));
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
