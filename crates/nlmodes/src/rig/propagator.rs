use crate::rig::RigError;
use crate::rig::bernstein::first_negative;
use crate::rig::error::finite;
use crate::rig::functional::Functional;
use crate::rig::matrix::{Matrix, add_scaled, dot};
use crate::rig::state_space::{Linear, StateSpace};

/// Order of the Taylor series in time.
const ORDER: usize = 24;

/// Largest `‖A‖ h`: the remainder of the series is then below `2²⁵ / 25! = 2e-18` of the state.
const LARGEST_NORM: f64 = 2.0;

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
/// Between two instants `ẋ = A x + c + b u` is solved by the matrix exponential, with its integrals against the powers
/// of time for the input. A step in which the contact may open or close is written as a Taylor series, whose first sign
/// change of the penetration is isolated and bisected; from there the other system applies.
#[derive(Debug, Clone)]
pub(crate) struct Propagator {
    step: f64,
    /// Open, closed.
    systems: [Exponential; 2],
    /// Penetration and its first two derivatives (m, m per step, m per step²), of the open and of the closed system.
    gauge: Option<[[Functional; 3]; 2]>,
    series: Vec<f64>,
    next: Vec<f64>,
}

/// `Φ = e^{Ah}` and its integrals against `c` and `b τ^j`.
#[derive(Debug, Clone)]
struct Exponential {
    /// `h A`, `h c`, `h b`.
    a: Matrix,
    c: Vec<f64>,
    b: Vec<f64>,
    transition: Matrix,
    constant: Vec<f64>,
    input: Vec<Vec<f64>>,
}

impl Propagator {
    /// Prepares steps of `interval / substeps`, or with the smallest sufficient number of parts.
    pub(crate) fn new(space: &StateSpace, interval: f64, substeps: Option<usize>) -> Result<Self, RigError> {
        let norm = space.systems.iter().map(|system| system.a.norm()).fold(0.0, f64::max);
        let limit = LARGEST_NORM / finite("fastest rate of the rig (1/s)", norm)?;
        let needed = (interval / limit).ceil().max(1.0) as usize;
        let step = interval / substeps.unwrap_or(needed.min(MOST_PARTS)).max(1) as f64;
        if step > limit * (1.0 + 1e-12) {
            return Err(RigError::StepTooLarge { step, limit, substeps: needed });
        }
        let systems = space.systems.each_ref().map(|system| Exponential::new(system, &space.b, step));
        let gauge = space.penetration.as_ref().map(|p| systems.each_ref().map(|system| gauge(p, system)));
        let n = space.size();
        Ok(Self { step, systems, gauge, series: vec![0.0; n * (ORDER + 1)], next: vec![0.0; n] })
    }

    /// Length of a step, s.
    pub(crate) fn step(&self) -> f64 {
        self.step
    }

    /// One step of `x`; `closed` is whether the contact is closed, before and after.
    pub(crate) fn advance(&mut self, x: &mut [f64], closed: &mut bool, u: &Input, time: f64) -> Result<(), RigError> {
        let mut next = std::mem::take(&mut self.next);
        self.systems[usize::from(*closed)].apply(x, u, &mut next);
        let done = match &self.gauge {
            Some(gauge) if !far(&gauge[usize::from(*closed)], *closed, x, &next, u) => {
                self.advance_through_contact(x, closed, u, time)
            }
            _ => {
                x.copy_from_slice(&next);
                Ok(())
            }
        };
        self.next = next;
        done
    }

    /// One step with all its contact instants.
    fn advance_through_contact(
        &mut self,
        x: &mut [f64],
        closed: &mut bool,
        u: &Input,
        time: f64,
    ) -> Result<(), RigError> {
        let mut start = 0.0;
        for switches in 0..=MOST_SWITCHES {
            let part = 1.0 - start;
            let input = shifted(u, start, part);
            self.systems[usize::from(*closed)].expand(x, part, &input, &mut self.series);
            let τ = match self.departure(*closed, switches > 0) {
                Some(τ) if τ < 1.0 => τ,
                _ => {
                    evaluate(&self.series, 1.0, x);
                    return Ok(());
                }
            };
            evaluate(&self.series, τ, x);
            start += τ * part;
            *closed = !*closed;
        }
        Err(RigError::Chatter { time, most: MOST_SWITCHES })
    }

    /// Where the penetration changes its sign in this series: it is negative while open, positive while closed.
    fn departure(&self, closed: bool, just_switched: bool) -> Option<f64> {
        let gauge = self.gauge.as_ref()?;
        let sign = if closed { 1.0 } else { -1.0 };
        let n = self.next_size();
        let mut power = [0.0; ORDER + 1];
        for (k, (value, x)) in power.iter_mut().zip(self.series.chunks_exact(n)).enumerate() {
            *value = sign * (dot(&gauge[0][0].row, x) + if k == 0 { gauge[0][0].constant } else { 0.0 });
        }
        // At a contact instant the penetration is zero to rounding: the series then begins with its velocity.
        if just_switched || (power[0] <= 0.0 && power[1] > 0.0) {
            return first_negative(&power[1..]);
        }
        first_negative(&power)
    }

    fn next_size(&self) -> usize {
        self.series.len() / (ORDER + 1)
    }
}

impl Exponential {
    fn new(system: &Linear, b: &[f64], step: f64) -> Self {
        let n = b.len();
        let scaled = |v: &[f64]| v.iter().map(|v| v * step).collect::<Vec<f64>>();
        let mut a = Matrix::zeros(n);
        let mut unit = vec![0.0; n];
        for j in 0..n {
            unit[j] = step;
            system.a.multiply_add(1.0, &unit, a.column_mut(j));
            unit[j] = 0.0;
        }
        let mut exponential = Self {
            a,
            c: scaled(&system.c),
            b: scaled(b),
            transition: Matrix::zeros(n),
            constant: vec![0.0; n],
            input: vec![vec![0.0; n]; DEGREE + 1],
        };
        exponential.integrate(n);
        exponential
    }

    /// The exponential and its integrals, each by the series that also expands a single step.
    fn integrate(&mut self, n: usize) {
        let mut series = vec![0.0; n * (ORDER + 1)];
        let (c, rest) = (std::mem::replace(&mut self.c, vec![0.0; n]), [0.0; DEGREE + 1]);
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            self.expand(&unit, 1.0, &rest, &mut series);
            evaluate(&series, 1.0, self.transition.column_mut(j));
        }
        let still = vec![0.0; n];
        for j in 0..=DEGREE {
            let mut u = rest;
            u[j] = 1.0;
            self.expand(&still, 1.0, &u, &mut series);
            evaluate(&series, 1.0, &mut self.input[j]);
        }
        self.c = c;
        self.expand(&still, 1.0, &rest, &mut series);
        evaluate(&series, 1.0, &mut self.constant);
    }

    fn apply(&self, x: &[f64], u: &Input, next: &mut [f64]) {
        next.copy_from_slice(&self.constant);
        self.transition.multiply_add(1.0, x, next);
        for (column, u) in self.input.iter().zip(u) {
            add_scaled(next, *u, column);
        }
    }

    /// `x(τ) = Σ x_k τ^k` over the fraction `part` of a step: `(k + 1) x_{k+1} = part · h (A x_k + c δ_k0 + b u_k)`.
    fn expand(&self, x: &[f64], part: f64, u: &Input, series: &mut [f64]) {
        let n = x.len();
        series[..n].copy_from_slice(x);
        for k in 0..ORDER {
            let (known, rest) = series.split_at_mut((k + 1) * n);
            let (now, next) = (&known[k * n..], &mut rest[..n]);
            let factor = part / (k + 1) as f64;
            next.fill(0.0);
            if k == 0 {
                add_scaled(next, factor, &self.c);
            }
            if k <= DEGREE {
                add_scaled(next, factor * u[k], &self.b);
            }
            self.a.multiply_add(factor, now, next);
        }
    }
}

/// Penetration, its velocity and its acceleration, with a step as the unit of time.
fn gauge(penetration: &Functional, system: &Exponential) -> [Functional; 3] {
    let velocity = penetration.derivative(&system.a, &system.c, &system.b);
    let acceleration = velocity.derivative(&system.a, &system.c, &system.b);
    [penetration.clone(), velocity, acceleration]
}

/// Whether the contact cannot switch within a step: at both ends the distance is larger than the velocities and
/// accelerations there allow it to travel. A step resolves all modes (`‖A‖ h ≤ 2`), so there are no larger values in
/// between.
fn far(gauge: &[Functional; 3], closed: bool, x: &[f64], next: &[f64], u: &Input) -> bool {
    let (at, after) = ([u[0], u[1], 2.0 * u[2]], [u.iter().sum(), 0.0, 0.0]);
    let reach = |x: &[f64], input: &[f64; 3]| 2.0 * gauge[1].value(x, input).abs() + gauge[2].value(x, input).abs();
    let (before, behind) = (gauge[0].value(x, &at), gauge[0].value(next, &after));
    if (before > 0.0) != closed || (behind > 0.0) != closed {
        return false;
    }
    before.abs().min(behind.abs()) > reach(x, &at).max(reach(next, &after))
}

/// Horner's rule for all entries of the state.
fn evaluate(series: &[f64], τ: f64, x: &mut [f64]) {
    let n = x.len();
    x.copy_from_slice(&series[ORDER * n..]);
    for term in series[..ORDER * n].chunks_exact(n).rev() {
        for (x, term) in x.iter_mut().zip(term) {
            *x = *x * τ + term;
        }
    }
}

/// The same polynomial on the part of the step from `start`, of length `part`.
fn shifted(u: &Input, start: f64, part: f64) -> Input {
    let mut shifted = *u;
    // Taylor shift by repeated synthetic division, then scaling of the variable.
    for level in 0..DEGREE {
        for j in (level..DEGREE).rev() {
            shifted[j] += start * shifted[j + 1];
        }
    }
    let mut power = 1.0;
    for value in &mut shifted {
        *value *= power;
        power *= part;
    }
    shifted
}
