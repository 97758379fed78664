use std::f64::consts::TAU;

use super::flow::Flow;
use super::series::{FlowSeries, ORDER, Polynomial};
use super::trajectory::{Piece, Propagator, Running};
use super::{ForcedStructure, Signal};
use crate::TimestepError;
use crate::error::{agrees, fits, positive};
use crate::first_root::Guard;

/// A blow: modal velocities that change at an instant, by what an impulse pushes.
#[derive(Debug, Clone, PartialEq)]
pub struct Blow {
    /// Its instant, s.
    pub instant: f64,
    /// Modal impulse `φᵀ I`, m, √kg m/s.
    pub modal: Vec<f64>,
}

/// What drives a motion from a state, and how long.
pub struct TransientSettings<'a> {
    /// Its length, s.
    pub duration: f64,
    /// The course in time of each load, in the order in which they were pushed.
    pub signals: &'a [&'a dyn Signal],
    /// Blows, in any order.
    pub blows: &'a [Blow],
}

/// Part of a motion, in which no contact changes.
pub struct Stretch<'a> {
    structure: &'a ForcedStructure,
    piece: &'a Piece,
}

/// A quantity along an interval.
#[derive(Debug, Clone, Copy)]
pub struct Along {
    polynomial: Polynomial,
    step: f64,
    length: f64,
}

impl Along {
    /// Value and rate at a time after the beginning of the interval, s.
    pub fn at(&self, t: f64) -> [f64; 2] {
        let [value, slope, _] = self.polynomial.evaluate(t / self.step);
        [value, slope / self.step]
    }

    /// Largest and smallest value.
    pub fn extremes(&self) -> [f64; 2] {
        let end = self.length / self.step;
        let mut negated = self.polynomial;
        negated.a.iter_mut().for_each(|a| *a = -*a);
        [self.polynomial.highest(end), -negated.highest(end)]
    }

    /// Integral over the interval.
    pub fn integral(&self) -> f64 {
        self.step * self.polynomial.integral(self.length / self.step)
    }
}

impl Stretch<'_> {
    /// Its beginning, s.
    pub fn from(&self) -> f64 {
        self.piece.from
    }

    /// Its length, s.
    pub fn length(&self) -> f64 {
        self.piece.length
    }

    /// Whether a contact is closed, or a stop with a law of force acts, which are numbered behind the contacts.
    pub fn is_closed(&self, contact: usize) -> bool {
        match contact.checked_sub(self.flow().closed.len()) {
            None => self.flow().closed[contact],
            Some(stop) => self.piece.acting[stop],
        }
    }

    /// An observed displacement, m.
    pub fn observed(&self, number: usize) -> Along {
        self.along(self.flow().observed[number].from(&self.piece.w))
    }

    /// The value of an observed displacement at the beginning, and by how much it would change in the whole interval at
    /// its rate there, m: cheaper than [`observed`](Self::observed).
    pub fn observed_roughly(&self, number: usize) -> [f64; 2] {
        self.roughly(&self.flow().observed[number])
    }

    /// A contact force, N; zero while the contact is open.
    pub fn force(&self, contact: usize) -> Along {
        self.along(match self.law_of(contact) {
            None => self.flow().forces_along[contact].from(&self.piece.w),
            Some((law, _)) => self.structure.law_force(law, self.flow(), &self.piece.w),
        })
    }

    /// The law of a stop behind the contacts, and its clearance, m.
    fn law_of(&self, contact: usize) -> Option<(usize, f64)> {
        self.structure.law_stops().nth(contact.checked_sub(self.flow().closed.len())?)
    }

    /// The force of a contact at the beginning, and by how much it would change in the whole interval at its rate
    /// there, N: cheaper than [`force`](Self::force).
    pub fn force_roughly(&self, contact: usize) -> [f64; 2] {
        if self.law_of(contact).is_some() {
            let force = self.force(contact);
            let [value, slope] = force.at(0.0);
            return [value, slope * self.piece.length];
        }
        self.roughly(&self.flow().forces_along[contact])
    }

    /// Integral of the force of a contact over the interval, N s.
    pub fn impulse(&self, contact: usize) -> f64 {
        let (flow, w) = (self.flow(), &self.piece.w);
        match self.piece.length == flow.step && self.law_of(contact).is_none() {
            true => flow.step * flow.forces_along[contact].integral(w),
            false => self.force(contact).integral(),
        }
    }

    fn roughly(&self, of: &FlowSeries) -> [f64; 2] {
        let [value, slope] = of.value_and_slope(&self.piece.w);
        [value, slope * self.piece.length / self.flow().step]
    }

    /// The rate at which the gap of an open contact falls at the end of the interval, m/s.
    fn approach(&self, contact: usize) -> f64 {
        match self.law_of(contact) {
            None => -self.along(self.flow().watched[contact].from(&self.piece.w)).at(self.length())[1],
            Some((law, _)) => self.along(self.flow().laws[law].place.from(&self.piece.w)).at(self.length())[1],
        }
    }

    fn along(&self, polynomial: Polynomial) -> Along {
        Along { polynomial, step: self.flow().step, length: self.piece.length }
    }

    fn flow(&self) -> &Flow {
        &self.piece.flow
    }
}

/// One touch of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// The contact, from 0; behind the contacts the stops with a law of force.
    pub contact: usize,
    /// When it closes, s.
    pub instant: f64,
    /// How long it stays closed, or until the end of the motion, s.
    pub duration: f64,
    /// Integral of its force, N s.
    pub impulse: f64,
    /// Rate at which the gap vanishes, m/s; zero of a contact that is closed at the beginning.
    pub approach: f64,
}

/// The touches of a motion, as they happen.
struct Touches {
    current: Vec<Option<Touch>>,
    /// Rate at which the gap of an open contact falls at the end of the latest interval, m/s.
    approach: Vec<f64>,
}

impl Touches {
    /// Takes an interval; tells the touches that end at its beginning.
    fn take(&mut self, stretch: &Stretch<'_>, switched: bool, touched: &mut dyn FnMut(Touch)) {
        for contact in 0..self.current.len() {
            if !stretch.is_closed(contact) {
                if let Some(touch) = self.current[contact].take() {
                    touched(touch);
                }
                if switched || stretch.law_of(contact).is_some() {
                    self.approach[contact] = stretch.approach(contact);
                }
                continue;
            }
            let approach = if stretch.from() > 0.0 { self.approach[contact].max(0.0) } else { 0.0 };
            let new = Touch { contact, instant: stretch.from(), duration: 0.0, impulse: 0.0, approach };
            let touch = self.current[contact].get_or_insert(new);
            touch.impulse += stretch.impulse(contact);
            touch.duration = stretch.from() + stretch.length() - touch.instant;
        }
    }
}

impl ForcedStructure {
    /// The motion from a state (modal coordinates, their rates, displacements of the dissipative stops) under loads of
    /// any course in time: exact between contact instants, but for the order of the steps in which
    /// [laws](Self::push_law) are fulfilled. `observe` is given each interval and whether a contact changes at its end,
    /// and says whether to go on; `touched` each touch when it is over. Periodic loads are left out.
    ///
    /// Returns the state at the end.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`], [`TimestepError::NotPositive`], [`TimestepError::NotFinite`],
    /// [`TimestepError::Chatter`], [`TimestepError::LawStep`], [`TimestepError::Ended`], or errors of a new set of
    /// closed contacts.
    pub fn transient(
        &self,
        state: &[f64],
        settings: &TransientSettings<'_>,
        observe: &mut dyn FnMut(&Stretch<'_>, bool) -> bool,
        touched: &mut dyn FnMut(Touch),
    ) -> Result<Vec<f64>, TimestepError> {
        self.check(state, settings)?;
        let duration = settings.duration;
        let mut propagator = Propagator::new(self, TAU / duration, 0.0)?;
        let mut driven = Driven::new(self, settings);
        let mut w = self.augmented(&self.in_units(state, self.rate().recip()), 0.0, 0.0);
        driven.renew(0.0, &mut w);
        let mut running = propagator.start(w, 0.0)?;
        let n = self.n_contacts() + self.n_law_stops();
        let mut touches = Touches { current: vec![None; n], approach: vec![0.0; n] };
        while running.t < duration {
            driven.go_on_early(&mut running);
            let Some(piece) = propagator.advance(&mut running, driven.until().min(duration))? else {
                driven.go_on(&mut running);
                continue;
            };
            let switched = running.has_switched || piece.flow.closed != running.flow.closed;
            let stretch = Stretch { structure: self, piece: &piece };
            touches.take(&stretch, switched, touched);
            if !observe(&stretch, switched) {
                return Err(TimestepError::Ended);
            }
        }
        touches.current.into_iter().flatten().for_each(touched);
        running.w.truncate(self.n_states());
        Ok(self.in_units(&running.w, self.rate()))
    }

    fn check(&self, state: &[f64], settings: &TransientSettings<'_>) -> Result<(), TimestepError> {
        positive("duration (s)", settings.duration)?;
        fits("entries of the state", self.n_states(), state)?;
        agrees("courses of loads", self.inputs.len() - self.laws.len(), settings.signals.len())?;
        settings.blows.iter().try_for_each(|blow| fits("modal impulses of a blow", self.n_modes(), &blow.modal))
    }
}

/// The loads of a motion on its way.
struct Driven<'a> {
    structure: &'a ForcedStructure,
    signals: &'a [&'a dyn Signal],
    /// Ends of their present pieces (s), and whether these continue.
    ends: Vec<(f64, bool)>,
    /// The first end of one that continues, s.
    soonest: f64,
    /// Blows to come, the next one last.
    blows: Vec<&'a Blow>,
}

impl<'a> Driven<'a> {
    fn new(structure: &'a ForcedStructure, settings: &TransientSettings<'a>) -> Self {
        let mut blows: Vec<&Blow> = settings.blows.iter().collect();
        blows.sort_by(|a, b| b.instant.total_cmp(&a.instant));
        Self {
            structure,
            signals: settings.signals,
            ends: vec![(0.0, false); settings.signals.len()],
            soonest: f64::INFINITY,
            blows,
        }
    }

    /// Up to when nothing changes.
    fn until(&self) -> f64 {
        let ends = self.ends.iter().map(|(end, _)| *end);
        ends.chain(self.blows.last().map(|blow| blow.instant)).fold(f64::INFINITY, f64::min)
    }

    /// Takes the next pieces, and strikes.
    fn go_on(&mut self, running: &mut Running) {
        self.renew(running.t, &mut running.w);
        running.look_ahead();
    }

    /// Takes the next pieces of those that continue and end within the step ahead.
    fn go_on_early(&mut self, running: &mut Running) {
        let ahead = running.t + running.flow.step;
        if self.soonest <= ahead {
            self.take(running.t, |(end, continues)| continues && end <= ahead, &mut running.w);
            running.look_ahead();
        }
    }

    fn renew(&mut self, t: f64, w: &mut [f64]) {
        self.take(t, |(end, _)| end <= t, w);
        let (m, rate) = (self.structure.n_modes(), self.structure.rate());
        while let Some(blow) = self.blows.pop_if(|blow| blow.instant <= t) {
            w[m..2 * m].iter_mut().zip(&blow.modal).for_each(|(v, p)| *v += p / rate);
        }
    }

    /// Takes the pieces from an instant on of the loads whose ends are such.
    fn take(&mut self, t: f64, is_due: impl Fn((f64, bool)) -> bool, w: &mut [f64]) {
        let rate = self.structure.rate();
        for (j, (signal, end)) in self.signals.iter().zip(&mut self.ends).enumerate() {
            if !is_due(*end) {
                continue;
            }
            let piece = signal.piece(t);
            let first = self.structure.first_of_input(j);
            let mut scale = 1.0;
            for (c, u) in w[first..].iter_mut().zip(piece.coefficients) {
                *c = u * scale;
                scale /= rate;
            }
            *end = (piece.until, piece.continues);
        }
        let continuing = self.ends.iter().filter(|(_, continues)| *continues);
        self.soonest = continuing.fold(f64::INFINITY, |soonest, (end, _)| soonest.min(*end));
    }
}

const _: () = assert!(ORDER > super::DEGREE);
