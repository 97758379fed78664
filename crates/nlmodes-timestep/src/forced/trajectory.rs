use std::collections::HashMap;
use std::sync::Arc;

use nlmodes_contact::{LcpWorkspace, solver_by_name};
use nlmodes_linalg::Mat;

use super::ForcedStructure;
use super::flow::Flow;
use super::laws::{LawSteps, LawTransitions};
use super::series::{may_fall, reach, size};
use crate::TimestepError;
use crate::dynamics::PATIENCE;
use crate::first_root::first_negative;
use crate::phase::dot;

/// Maximum number of steps of a trajectory that is kept.
const MAX_PIECES: usize = 2_000_000;

/// Length over a step up to which two instants are one.
const SAME: f64 = 1e-12;

/// A step within which no contact changes.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub from: f64,
    pub length: f64,
    pub flow: Arc<Flow>,
    pub w: Vec<f64>,
    /// Length of the step in which the laws of force are fulfilled, at least that of the piece, s.
    pub law_step: f64,
    /// Which stops with a law of force act, in their order.
    pub acting: Arc<Vec<bool>>,
}

impl Piece {
    /// Raises the largest values of the observed displacements to those in it; `end` is `w` at its end.
    pub fn raise(&self, largest: &mut [f64], end: &[f64]) {
        largest.iter_mut().enumerate().for_each(|(i, most)| *most = self.observed_highest(i, *most, end));
    }

    fn observed_highest(&self, number: usize, most: f64, end: &[f64]) -> f64 {
        let of = &self.flow.observed[number];
        let (before, after) = (of.leading(&self.w), of.leading(end));
        if before[0].max(after[0]) + reach(&before).max(reach(&after)) <= most {
            return most;
        }
        most.max(of.from(&self.w).highest(self.length / self.flow.step))
    }
}

/// Motions of a structure at one frequency and level.
pub(super) struct Propagator<'a> {
    pub structure: &'a ForcedStructure,
    omega: f64,
    level: f64,
    flows: HashMap<Vec<bool>, Arc<Flow>>,
    free: Vec<Vec<f64>>,
    workspace: Box<dyn LcpWorkspace>,
    laws: LawSteps<'a>,
}

/// A motion on its way.
pub(super) struct Running {
    pub w: Vec<f64>,
    pub t: f64,
    /// What the sum of the steps is short of.
    short: f64,
    pub flow: Arc<Flow>,
    /// First coefficients of the guards along the step ahead.
    ahead: Vec<[f64; 4]>,
    idle: usize,
    /// Whether a stop with a law of force begins or ends to act here.
    pub has_switched: bool,
}

impl Running {
    /// Looks at the guards anew after a change of `w`.
    pub fn look_ahead(&mut self) {
        self.ahead = self.flow.watched.iter().map(|guard| guard.leading(&self.w)).collect();
    }

    /// Adds a length to the time, with the compensation of Kahan.
    fn go(&mut self, length: f64) {
        let length = length - self.short;
        let t = self.t + length;
        (self.t, self.short) = (t, (t - self.t) - length);
    }

    fn arrive(&mut self, t: f64) {
        (self.t, self.short) = (t, 0.0);
    }
}

impl<'a> Propagator<'a> {
    pub fn new(structure: &'a ForcedStructure, omega: f64, level: f64) -> Result<Self, TimestepError> {
        let workspace = solver_by_name("active-set")?.workspace(&structure.compliance)?;
        let free = structure.free_gaps(level);
        Ok(Self { structure, omega, level, flows: HashMap::new(), free, workspace, laws: LawSteps::new(structure) })
    }

    /// The motion from a state at one instant to another, step by step, and the state at its end.
    pub fn propagate(&mut self, state: &[f64], from: f64, to: f64) -> Result<(Vec<Piece>, Vec<f64>), TimestepError> {
        let mut running = self.start(self.structure.augmented(state, self.omega, from), from)?;
        let mut pieces = Vec::new();
        while let Some(piece) = self.advance(&mut running, to)? {
            pieces.push(piece);
            if pieces.len() > MAX_PIECES {
                return Err(TimestepError::TooManyContacts { time: running.t, most: MAX_PIECES });
            }
        }
        running.w.truncate(self.structure.n_states());
        Ok((pieces, running.w))
    }

    /// A motion that begins with `w` at an instant.
    pub fn start(&mut self, w: Vec<f64>, t: f64) -> Result<Running, TimestepError> {
        let flow = self.flow_of(&w)?;
        let mut running = Running { w, t, short: 0.0, flow, ahead: Vec::new(), idle: 0, has_switched: false };
        running.look_ahead();
        self.laws.begin(&running);
        Ok(running)
    }

    /// Goes on to the next contact instant, by a step at most and not beyond `until`; none where that is reached.
    pub fn advance(&mut self, running: &mut Running, until: f64) -> Result<Option<Piece>, TimestepError> {
        if self.structure.laws.is_empty() {
            return self.go(running, until);
        }
        loop {
            let (from, end) = (running.t, self.laws.go(running, until)?);
            let acting = Arc::clone(&self.laws.acting);
            let piece = self.go(running, end)?;
            running.has_switched = self.laws.end(running.t);
            match piece {
                Some(piece) => return Ok(Some(Piece { law_step: end - from, acting, ..piece })),
                None if running.t >= until => return Ok(None),
                None => {}
            }
        }
    }

    fn go(&mut self, running: &mut Running, until: f64) -> Result<Option<Piece>, TimestepError> {
        let patience = PATIENCE.map(|p| p * self.free.len() + 2);
        loop {
            let flow = Arc::clone(&running.flow);
            let left = until - running.t + running.short;
            if left <= SAME * flow.step + 2.0 * f64::EPSILON * until.abs() {
                running.arrive(until);
                return Ok(None);
            }
            let is_last = left <= (1.0 + SAME) * flow.step;
            let length = if left < (1.0 - SAME) * flow.step { left } else { flow.step };
            let next = flow.after(&running.w, length);
            let ahead: Vec<[f64; 4]> = flow.watched.iter().map(|guard| guard.leading(&next)).collect();
            let switch = match wrong(&flow, running) {
                Some(contact) => Some((0.0, contact)),
                None => first_switch(&flow, running, &ahead, length),
            };
            let Some((gone, contact)) = switch else {
                let (from, w) = (running.t, std::mem::replace(&mut running.w, next));
                running.ahead = ahead;
                running.idle = 0;
                if is_last {
                    running.arrive(until)
                } else {
                    running.go(length)
                }
                return Ok(Some(self.piece(from, length, flow, w)));
            };
            let (from, at) = (running.t, flow.after(&running.w, gone));
            let w = std::mem::replace(&mut running.w, at);
            running.go(gone);
            self.structure.turn_oscillators(&mut running.w, self.omega, running.t);
            running.idle = if gone > 1e-13 * until.abs() { 0 } else { running.idle + 1 };
            if running.idle > patience[1] {
                return Err(TimestepError::Chatter { time: running.t, switches: running.idle });
            }
            running.flow = match running.idle > patience[0] {
                true => self.flow_of(&flow.after(&running.w, 1e-4 * flow.step))?,
                false => {
                    let mut closed = flow.closed.clone();
                    closed[contact] = !closed[contact];
                    self.flow(&closed)?
                }
            };
            running.look_ahead();
            if gone > 0.0 {
                return Ok(Some(self.piece(from, gone, flow, w)));
            }
        }
    }

    fn piece(&self, from: f64, length: f64, flow: Arc<Flow>, w: Vec<f64>) -> Piece {
        Piece { from, length, flow, w, law_step: length, acting: Arc::clone(&self.laws.acting) }
    }

    fn flow_of(&mut self, w: &[f64]) -> Result<Arc<Flow>, TimestepError> {
        let gaps: Vec<f64> = self.free.iter().map(|row| dot(row, w)).collect();
        let (mut closed, mut lambda) = (vec![false; gaps.len()], vec![0.0; gaps.len()]);
        self.workspace.solve(&gaps, &mut closed, &mut lambda)?;
        self.flow(&closed)
    }

    fn flow(&mut self, closed: &[bool]) -> Result<Arc<Flow>, TimestepError> {
        if let Some(flow) = self.flows.get(closed) {
            return Ok(Arc::clone(flow));
        }
        let flow = Arc::new(self.structure.flow(closed, self.omega, self.level)?);
        self.flows.insert(closed.to_vec(), Arc::clone(&flow));
        Ok(flow)
    }
}

impl ForcedStructure {
    /// The derivative of the last state with respect to the first: a product of exponentials, since nothing jumps at a
    /// contact instant. All steps between two instants have one exponential together, but for laws of force, whose
    /// reactions follow the state of each step.
    pub(super) fn transition(&self, pieces: &[Piece]) -> Result<Mat<f64>, TimestepError> {
        let states = self.n_states();
        let unit = Mat::identity(states, states);
        if !self.laws.is_empty() {
            let mut laws = LawTransitions::new(self);
            return pieces.iter().try_fold(unit, |before, piece| Ok(laws.over(piece)? * before));
        }
        let all: Vec<usize> = (0..states).collect();
        let mut each = pieces.chunk_by(|a, b| Arc::ptr_eq(&a.flow, &b.flow)).map(|pieces| {
            let [first, ..] = pieces else { return Ok(Mat::identity(states, states)) };
            first.flow.transition_of(&all, pieces.iter().map(|piece| piece.length).sum())
        });
        each.try_fold(unit, |before, step| Ok(step? * before))
    }
}

/// A contact whose guard is negative beyond rounding: its set does not belong to this state.
fn wrong(flow: &Flow, running: &Running) -> Option<usize> {
    let values = running.ahead.iter().map(|ahead| ahead[0]).enumerate();
    let mut negative = values.filter(|(_, value)| *value < 0.0);
    negative.find(|(i, value)| -value > 1e-9 * size(&flow.guards[*i], &running.w)).map(|(i, _)| i)
}

/// Time and index of the first contact change within a part of a step, at whose end guards begin with `after`.
fn first_switch(flow: &Flow, running: &Running, after: &[[f64; 4]], length: f64) -> Option<(f64, usize)> {
    let near = running.ahead.iter().zip(after).enumerate();
    let near = near.filter(|(_, (before, after))| may_fall(before, after));
    let (contacts, guards): (Vec<usize>, Vec<_>) = near.map(|(i, _)| (i, flow.watched[i].guard(&running.w))).unzip();
    first_negative(&guards, length / flow.step).map(|(when, k)| (when * flow.step, contacts[k]))
}
