use nlmodes_linalg::{Mat, column};
use nlmodes_timestep::{FlowSeries, LinearFlow, TURN};

use crate::rig::RigError;
use crate::rig::error::finite;
use crate::rig::functional::Functional;
use crate::rig::state_space::StateSpace;

/// Maximum number of parts into which a sampling interval is divided by default.
const MOST_PARTS: usize = 1000;

/// Degree of the polynomial that represents the drive within one step.
pub(crate) const DEGREE: usize = 7;

/// Maximum number of switchings of one contact in one step.
const MOST_SWITCHES: usize = 32;

/// Input over one step: `u = Σ u_j τ^j` with `τ` from 0 to 1.
pub(crate) type Input = [f64; DEGREE + 1];

/// Exact propagation of a piecewise linear system from contact instant to contact instant.
///
/// Between two instants `ẋ = A x + c + b u` is a [`LinearFlow`] with the unit of time of one step, of the state, a one
/// and the coefficients of the input.
#[derive(Debug, Clone)]
pub(crate) struct Propagator {
    step: f64,
    /// Open, closed.
    sides: [Side; 2],
}

#[derive(Debug, Clone)]
struct Side {
    flow: LinearFlow,
    /// The distance of an open contact, the penetration of a closed one.
    guard: Option<FlowSeries>,
}

impl Propagator {
    /// Prepares steps of `interval / substeps`, or with the smallest sufficient number of parts.
    pub(crate) fn new(space: &StateSpace, interval: f64, substeps: Option<usize>) -> Result<Self, RigError> {
        // A bound of all eigenvalues.
        let norm =
            |a: &Mat<f64>| (0..a.ncols()).map(|j| column(a, j).iter().map(|a| a.abs()).sum()).fold(0.0, f64::max);
        let fastest = space.systems.iter().map(|system| norm(&system.a)).fold(0.0, f64::max);
        let limit = TURN / finite("fastest rate of the rig (1/s)", fastest)?;
        let needed = (interval / limit).ceil().max(1.0) as usize;
        let step = interval / substeps.unwrap_or(needed.min(MOST_PARTS)).max(1) as f64;
        if step > limit * (1.0 + 1e-12) {
            return Err(RigError::StepTooLarge { step, limit, substeps: needed });
        }
        Ok(Self { step, sides: [Side::new(space, false, step)?, Side::new(space, true, step)?] })
    }

    /// Length of a step, s.
    pub(crate) fn step(&self) -> f64 {
        self.step
    }

    /// One step of `x`; `closed` is whether the contact is closed, before and after.
    pub(crate) fn advance(&self, x: &mut [f64], closed: &mut bool, u: &Input, time: f64) -> Result<(), RigError> {
        let mut w: Vec<f64> = x.iter().chain(&[1.0]).chain(u).copied().collect();
        let mut left = 1.0;
        for _ in 0..=MOST_SWITCHES {
            let Side { flow, guard } = &self.sides[usize::from(*closed)];
            let next = flow.after(&w, left);
            let Some(switch) = guard.as_ref().and_then(|guard| guard.first_fall(&w, &next, left)) else {
                x.copy_from_slice(&next[..x.len()]);
                return Ok(());
            };
            w = flow.after(&w, switch);
            left -= switch;
            *closed = !*closed;
        }
        Err(RigError::Chatter { time, most: MOST_SWITCHES })
    }
}

impl Side {
    fn new(space: &StateSpace, closed: bool, step: f64) -> Result<Self, RigError> {
        let (n, system) = (space.size(), &space.systems[usize::from(closed)]);
        let mut matrix = Mat::zeros(n + 2 + DEGREE, n + 2 + DEGREE);
        for i in 0..n {
            (0..n).for_each(|j| matrix[(i, j)] = step * system.a[(i, j)]);
            (matrix[(i, n)], matrix[(i, n + 1)]) = (step * system.c[i], step * space.b[i]);
        }
        // About the present instant: the derivative of u_j is (j + 1) u_{j+1}.
        (1..=DEGREE).for_each(|j| matrix[(n + j, n + 1 + j)] = j as f64);
        let flow = LinearFlow::new(matrix, 1.0)?;
        let side = if closed { 1.0 } else { -1.0 };
        let guard = |Functional { row, constant, .. }: &Functional| {
            let mut all: Vec<f64> = row.iter().chain([constant]).map(|v| side * v).collect();
            all.resize(n + 2 + DEGREE, 0.0);
            flow.along(&all)
        };
        Ok(Self { guard: space.penetration.as_ref().map(guard), flow })
    }
}
