//! What the contacts do over one period, instant by instant.

use std::f64::consts::TAU;
use std::sync::Arc;

use nlmodes_hbm::{ContactOperator, ForceLaw, PatternInterval, PeriodicMotion, PlacedLaw, touch_spans};
use nlmodes_modal::ClosedSpan;
use num_complex::Complex64;

use crate::response::{ResponseError, ResponseModel};

/// The contacts of a motion over a period: which are closed when.
pub struct ContactPattern<'a> {
    model: &'a ResponseModel,
    omega: f64,
    contacts: ContactOperator,
    /// Of each contact whose stop dissipates, the displacement of the stop, harmonic by harmonic.
    stops: Vec<Option<Vec<Complex64>>>,
    /// Stops with a law of force, which are reported after the contacts.
    laws: Vec<LawStop>,
    /// Ends in phase (rad) of the segments in which nothing closes or opens, in order from 0 to 2π, and the interval of
    /// the contacts that each is part of.
    stretches: Vec<([f64; 2], PatternInterval)>,
}

/// A stop with a law of force, and the displacement toward it, harmonic by harmonic, m.
#[derive(Debug)]
struct LawStop {
    law: Arc<dyn ForceLaw>,
    displacement: Vec<Complex64>,
}

/// Displacement toward its stop from rest (m) with two derivatives by time, and force (N).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Displacement, velocity, acceleration.
    pub motion: [f64; 3],
    /// Contact force, nonnegative to rounding.
    pub force: f64,
}

impl ResponseModel {
    /// When which contacts are closed over a period of the motion; `subharmonic` periods of the load are one of the
    /// motion.
    ///
    /// # Errors
    /// [`ResponseError::Problem`] where a contact problem has no solution.
    pub fn contact_pattern(
        &self,
        motion: &PeriodicMotion,
        subharmonic: usize,
    ) -> Result<ContactPattern<'_>, ResponseError> {
        let structure = self.structure();
        let stop = |i: usize| {
            let j = structure.damped_stop(i)? - structure.n_moving();
            motion.stops.iter().map(|stops| stops.get(j).copied()).collect::<Option<Vec<Complex64>>>()
        };
        let stops = (0..structure.n_contacts()).map(stop).collect();
        let laws = self.law_stops(motion, subharmonic)?;
        let harmonics = motion.eta.len().saturating_sub(1);
        let y = self.gap_harmonics(motion, subharmonic);
        let contacts = ContactOperator::of_harmonics(structure.compliance(), y, harmonics)?;
        let stretches = divided(contacts.intervals(), &laws, motion.at.omega);
        Ok(ContactPattern { model: self, omega: motion.at.omega, contacts, stops, laws, stretches })
    }

    /// The stops with a law of force in a motion.
    fn law_stops(&self, motion: &PeriodicMotion, subharmonic: usize) -> Result<Vec<LawStop>, ResponseError> {
        let is_stop = |(_, placed): &(usize, &PlacedLaw)| placed.law.stop_gap().is_some();
        let all = self.structure().laws().iter().enumerate().filter(is_stop);
        let (laws, weights): (Vec<_>, Vec<_>) =
            all.filter_map(|(l, placed)| Some((placed.law.clone(), self.law_weights(l)?.clone()))).unzip();
        let rows = self.rows(&weights)?;
        let of = |(law, row)| LawStop { law, displacement: self.displacement(row, motion, subharmonic) };
        Ok(laws.into_iter().zip(&rows).map(of).collect())
    }

    fn gap_harmonics(&self, motion: &PeriodicMotion, subharmonic: usize) -> Vec<Vec<Complex64>> {
        let structure = self.structure();
        let omega = motion.at.omega * subharmonic as f64;
        let gap = |i: usize| {
            let of = |eta: &Vec<Complex64>| eta.iter().enumerate().map(|(k, eta)| eta * structure.rows()[(i, k)]).sum();
            let mut y: Vec<Complex64> = (0..motion.eta.len()).map(|n| of(&motion.coordinates(n))).collect();
            y[0] += structure.gaps()[i];
            for (y, reactions) in y.iter_mut().zip(&motion.reactions) {
                *y += reactions.iter().zip(structure.laws()).map(|(f, law)| f * law.contacts[i]).sum::<Complex64>();
            }
            for term in self.terms() {
                if let Some(y) = y.get_mut(term.harmonic * subharmonic) {
                    *y += term.gaps[i] * (motion.at.level * omega.powi(term.omega_power));
                }
            }
            y
        };
        (0..structure.n_contacts()).map(gap).collect()
    }
}

impl ContactPattern<'_> {
    /// Ends in phase (rad) of the segments with unchanged closed contacts, in order from 0 to 2π.
    pub fn stretches(&self) -> Vec<[f64; 2]> {
        self.stretches.iter().map(|(ends, _)| *ends).collect()
    }

    /// The contacts at a phase (rad) in a segment, whose formulas also hold at its ends.
    ///
    /// # Panics
    /// If there is no such segment.
    pub fn state(&self, tau: f64, stretch: usize) -> Vec<ContactState> {
        let structure = self.model.structure();
        let states = self.contacts.states(&self.stretches[stretch].1, tau, structure.stop_compliance());
        let of = |(i, (gap, force)): (usize, ([f64; 3], f64))| {
            let yielded = |order: i32| self.stops[i].as_ref().map_or(0.0, |stop| self.value(stop, tau, order));
            let moved = |order: i32| yielded(order) - gap[order as usize] * self.omega.powi(order);
            ContactState { motion: [structure.gaps()[i] + moved(0), moved(1), moved(2)], force }
        };
        let of_law = |stop: &LawStop| {
            let motion = [0, 1, 2].map(|order| self.value(&stop.displacement, tau, order));
            ContactState { motion, force: stop.law.at(motion[0], motion[1]).force }
        };
        states.into_iter().enumerate().map(of).chain(self.laws.iter().map(of_law)).collect()
    }

    /// The spans of a period in which each contact is closed, with its force: a series for each contact pattern; none
    /// of a stop with a law of force, which has no such series.
    pub fn closed_spans(&self) -> Vec<Vec<ClosedSpan>> {
        self.contacts.closed_spans().into_iter().chain(self.laws.iter().map(|_| Vec::new())).collect()
    }

    fn value(&self, z: &[Complex64], tau: f64, order: i32) -> f64 {
        let one = |(n, z): (usize, &Complex64)| {
            let nu = Complex64::new(0.0, n as f64 * self.omega);
            (nu.powi(order) * z * Complex64::cis(n as f64 * tau)).re
        };
        z.iter().enumerate().map(one).sum()
    }
}

/// The intervals of the contacts, divided where a stop with a law of force begins or ends to act.
fn divided(intervals: &[PatternInterval], laws: &[LawStop], omega: f64) -> Vec<([f64; 2], PatternInterval)> {
    let spans = laws.iter().flat_map(|stop| touch_spans(stop.law.as_ref(), &stop.displacement, omega));
    let mut ends: Vec<f64> = spans.filter(|[a, b]| b - a < TAU).flatten().map(|tau| tau.rem_euclid(TAU)).collect();
    ends.sort_by(f64::total_cmp);
    let parts = |interval: &PatternInterval| {
        let within = ends.iter().copied().filter(|tau| *tau > interval.from && *tau < interval.to);
        let all: Vec<f64> = [interval.from].into_iter().chain(within).chain([interval.to]).collect();
        all.windows(2).map(|pair| ([pair[0], pair[1]], *interval)).collect::<Vec<_>>()
    };
    intervals.iter().flat_map(parts).collect()
}
