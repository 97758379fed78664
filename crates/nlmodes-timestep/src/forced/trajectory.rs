use std::collections::HashMap;
use std::sync::Arc;

use nlmodes_contact::{LcpWorkspace, solver_by_name};
use nlmodes_linalg::Mat;

use super::ForcedStructure;
use super::flow::Flow;
use crate::TimestepError;
use crate::phase::dot;

/// Maximum number of steps of a trajectory.
const MAX_PIECES: usize = 2_000_000;

/// Number of switchings without progress, per contact, after which the contact problem just ahead decides, and after
/// which the integration fails.
const PATIENCE: [usize; 2] = [2, 8];

/// A step within which no contact changes.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub from: f64,
    pub length: f64,
    pub flow: Arc<Flow>,
    pub w: Vec<f64>,
}

/// Motions of a structure at one frequency and level.
pub(super) struct Propagator<'a> {
    structure: &'a ForcedStructure,
    omega: f64,
    level: f64,
    flows: HashMap<Vec<bool>, Arc<Flow>>,
    free: Vec<Vec<f64>>,
    workspace: Box<dyn LcpWorkspace>,
}

impl<'a> Propagator<'a> {
    pub fn new(structure: &'a ForcedStructure, omega: f64, level: f64) -> Result<Self, TimestepError> {
        let workspace = solver_by_name("active-set")?.workspace(&structure.compliance)?;
        let free = structure.free_gaps(level);
        Ok(Self { structure, omega, level, flows: HashMap::new(), free, workspace })
    }

    /// The motion over a time from a state, step by step, and the state at its end.
    pub fn propagate(&mut self, state: &[f64], duration: f64) -> Result<(Vec<Piece>, Vec<f64>), TimestepError> {
        let n = self.structure.n_states();
        let (mut t, mut idle, mut pieces) = (0.0, 0, Vec::new());
        let mut w = self.structure.augmented(state, self.omega, t);
        let mut flow = self.flow_of(&w)?;
        let patience = PATIENCE.map(|p| p * flow.closed.len() + 2);
        while duration - t > 1e-14 * duration {
            // A guard is zero to rounding after its contact instant.
            let values = flow.guards.iter().map(|guard| dot(guard, &w));
            let offsets: Vec<f64> = values.map(|value| (-value).max(0.0)).collect();
            let wrong = (0..offsets.len()).find(|&i| offsets[i] > 1e-9 * size(&flow.guards[i], &w));
            let length = flow.step.min(duration - t);
            let next = flow.after(&w, length);
            let switch = match wrong {
                Some(contact) => Some((0.0, contact)),
                None => first_switch(&flow, &w, &next, length, &offsets),
            };
            let gone = switch.map_or(length, |(when, _)| when);
            let at = if switch.is_some() { flow.after(&w, gone) } else { next };
            if gone > 0.0 {
                pieces.push(Piece { from: t, length: gone, flow: Arc::clone(&flow), w });
            }
            t += gone;
            if pieces.len() > MAX_PIECES {
                return Err(TimestepError::TooManyContacts { time: t, most: MAX_PIECES });
            }
            let Some((_, contact)) = switch else {
                w = at;
                idle = 0;
                continue;
            };
            w = self.structure.augmented(&at[..n], self.omega, t);
            idle = if gone > 1e-13 * duration { 0 } else { idle + 1 };
            if idle > patience[1] {
                return Err(TimestepError::Chatter { time: t, switches: idle });
            }
            flow = match idle > patience[0] {
                true => self.flow_of(&flow.after(&w, 1e-4 * flow.step))?,
                false => {
                    let mut closed = flow.closed.clone();
                    closed[contact] = !closed[contact];
                    self.flow(&closed)?
                }
            };
        }
        Ok((pieces, w[..n].to_vec()))
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

/// The derivative of the last state with respect to the first: a product of exponentials, since nothing jumps at a
/// contact instant.
pub(super) fn transition(pieces: &[Piece], states: usize) -> Result<Mat<f64>, TimestepError> {
    let mut each = pieces.iter().map(|piece| piece.flow.transition(states, piece.length));
    each.try_fold(Mat::identity(states, states), |before, step| Ok(step? * before))
}

fn size(row: &[f64], w: &[f64]) -> f64 {
    row.iter().zip(w).map(|(r, w)| (r * w).abs()).sum()
}

/// Time and index of the first contact change within a step from `w` to `next`.
fn first_switch(flow: &Flow, w: &[f64], next: &[f64], length: f64, offsets: &[f64]) -> Option<(f64, usize)> {
    let mut first: Option<(f64, usize)> = None;
    for (i, (guard, offset)) in flow.guards.iter().zip(offsets).enumerate() {
        let noise = 4.0 * f64::EPSILON * size(guard, w);
        let (lowest, when) = flow.lowest(guard, w, next, length);
        if lowest + offset >= -noise {
            continue;
        }
        let found = flow.root(guard, *offset, 0, w, (0.0, when));
        if first.is_none_or(|(earliest, _)| found < earliest) {
            first = Some((found, i));
        }
    }
    first
}
