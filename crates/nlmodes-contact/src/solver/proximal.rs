use super::{
    polish::Polish,
    workspace::{Method, Outcome, Workspace},
};
use crate::{LcpError, LcpMatrix, LcpSolver, LcpWorkspace, kernel, sample::Sample, scaled::Scaled};

pub(crate) const NAME: &str = "proximal";

/// Fixed point of the proximal point function, `λ = max(0, λ − r g)`, which is eq. (11) as an equation.
///
/// In units in which the diagonal of `A` is near one and with `r = 1/(1.02 ρ)`, ρ the largest eigenvalue of `A`, the
/// plain iteration descends and cannot diverge; if ρ is underestimated, the descent test fails and `r` is reduced. By
/// default it is accelerated (Nesterov, restarted when the momentum points uphill), and after 16, 32, 64, … iterations
/// the closed set is read off and its block solved exactly: the iteration need only find the set. Matrices with a
/// condition above about 1e5 may end with [`LcpError::NotConverged`], which carries the best iterate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proximal {
    /// Maximum number of iterations. Default 20 000.
    pub max_iterations: usize,
    /// Violation at which to end without the exact solution. Default 1e-11.
    pub tolerance: f64,
    /// Momentum. Default true.
    pub accelerated: bool,
    /// Exact solution with the closed set found. Default true; false leaves the bare fixed point for reference.
    pub polished: bool,
}

impl Default for Proximal {
    fn default() -> Self {
        Self { max_iterations: 20_000, tolerance: 1e-11, accelerated: true, polished: true }
    }
}

impl LcpSolver for Proximal {
    fn name(&self) -> &'static str {
        NAME
    }

    fn workspace(&self, a: &LcpMatrix) -> Result<Box<dyn LcpWorkspace>, LcpError> {
        let c = a.n_contacts();
        let step = 1.0 / (1.02 * spectral_radius(a.scaled()));
        let zeros = || vec![0.0; c];
        let state = State { last: zeros(), last_gap: zeros(), point: zeros(), point_gap: zeros(), momentum: 1.0 };
        let best = Best { lambda: zeros(), violation: f64::INFINITY };
        let descent =
            Descent { settings: *self, step, state, best, start: zeros(), mark: zeros(), polish: Polish::new(c) };
        Ok(Box::new(Workspace::new(a, descent)))
    }
}

/// Largest eigenvalue by power iteration, at most the bound of Gershgorin.
fn spectral_radius(matrix: &Scaled) -> f64 {
    let c = matrix.n_contacts();
    let bound = (0..c).map(|j| matrix.column(j).iter().map(|v| v.abs()).sum()).fold(f64::MIN_POSITIVE, f64::max);
    let (zeros, mut image) = (vec![0.0; c], vec![0.0; c]);
    let mut x: Vec<f64> = (0..c).map(|i| 1.0 + 0.5 * (3.7 * i as f64).sin()).collect();
    let mut radius = 0.0;
    for _ in 0..100 {
        let norm = kernel::dot(&x, &x).sqrt();
        x.iter_mut().for_each(|v| *v /= norm);
        matrix.gap(&zeros, &x, &mut image);
        let next = kernel::dot(&x, &image);
        if next.is_nan() || next <= radius * (1.0 + 1e-6) {
            break;
        }
        radius = next;
        std::mem::swap(&mut x, &mut image);
    }
    radius.clamp(f64::MIN_POSITIVE, bound)
}

struct Descent {
    settings: Proximal,
    step: f64,
    state: State,
    best: Best,
    /// Forces of the last problem, the initial guess of the next.
    start: Vec<f64>,
    /// Forces at the last check.
    mark: Vec<f64>,
    polish: Polish,
}

/// The iterate before, and the extrapolated point with its gaps.
struct State {
    last: Vec<f64>,
    last_gap: Vec<f64>,
    point: Vec<f64>,
    point_gap: Vec<f64>,
    momentum: f64,
}

struct Best {
    lambda: Vec<f64>,
    violation: f64,
}

impl Method for Descent {
    const NAME: &'static str = NAME;

    fn run(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        self.begin(sample, closed);
        let mut next_check = 16;
        for iteration in 1..=self.settings.max_iterations {
            self.iterate(sample);
            if iteration % 8 == 0 && self.note(sample) <= self.settings.tolerance {
                return self.finish(sample, closed, iteration);
            }
            if iteration == next_check {
                next_check *= 2;
                let outcome = self.check(sample, closed);
                if outcome.verdict.is_accepted() || outcome.infeasible {
                    self.start.copy_from_slice(&sample.lambda);
                    return Outcome { iterations: iteration, ..outcome };
                }
            }
        }
        self.note(sample);
        sample.lambda.copy_from_slice(&self.best.lambda);
        self.finish(sample, closed, self.settings.max_iterations)
    }
}

impl Descent {
    fn begin(&mut self, sample: &mut Sample, closed: &[bool]) {
        for ((l, start), closed) in sample.lambda.iter_mut().zip(&self.start).zip(closed) {
            *l = if *closed { *start } else { 0.0 };
        }
        sample.judge();
        self.mark.copy_from_slice(&sample.lambda);
        self.best.violation = f64::INFINITY;
        self.state.restart(sample);
    }

    /// One projected step from the extrapolated point, and the next extrapolation.
    fn iterate(&mut self, sample: &mut Sample) {
        let state = &mut self.state;
        state.last.copy_from_slice(&sample.lambda);
        state.last_gap.copy_from_slice(&sample.gap);
        for ((l, p), g) in sample.lambda.iter_mut().zip(&state.point).zip(&state.point_gap) {
            let moved = p - self.step * g;
            *l = if moved > 0.0 { moved } else { 0.0 };
        }
        sample.refresh_gaps();
        if state.climbed(sample, self.step) {
            self.step *= 0.7;
            sample.lambda.copy_from_slice(&state.last);
            sample.gap.copy_from_slice(&state.last_gap);
            state.restart(sample);
        } else if !self.settings.accelerated || state.points_uphill(sample) {
            state.restart(sample);
        } else {
            state.extrapolate(sample);
        }
    }

    /// Remembers the iterate if it is the best so far. Returns its violation.
    fn note(&mut self, sample: &Sample) -> f64 {
        let violation = sample.violation();
        if violation < self.best.violation || self.best.violation.is_infinite() {
            self.best.violation = violation;
            self.best.lambda.copy_from_slice(&sample.lambda);
        }
        violation
    }

    /// Looks for a proof of infeasibility, then polishes.
    fn check(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        self.note(sample);
        let infeasible = self.runs_away(sample);
        self.mark.copy_from_slice(&sample.lambda);
        if infeasible || !self.settings.polished {
            return Outcome { infeasible, ..self.finish(sample, closed, 0) };
        }
        self.polish.run(sample, closed)
    }

    /// Whether the forces since the last check grew along a ray that proves infeasibility.
    fn runs_away(&self, sample: &mut Sample) -> bool {
        for ((z, l), mark) in sample.ray.iter_mut().zip(&sample.lambda).zip(&self.mark) {
            *z = l - mark;
        }
        sample.is_proven_infeasible()
    }

    fn finish(&mut self, sample: &mut Sample, closed: &mut [bool], iterations: usize) -> Outcome {
        let verdict = sample.judge();
        self.start.copy_from_slice(&sample.lambda);
        closed.iter_mut().zip(&sample.lambda).for_each(|(closed, l)| *closed = *l > 0.0);
        Outcome { iterations, verdict, infeasible: false }
    }
}

impl State {
    fn restart(&mut self, sample: &Sample) {
        self.momentum = 1.0;
        self.point.copy_from_slice(&sample.lambda);
        self.point_gap.copy_from_slice(&sample.gap);
    }

    /// Whether the energy curves more along the step than `1 / step`: then the step was too long.
    fn climbed(&self, sample: &Sample, step: f64) -> bool {
        let (mut curvature, mut length) = (0.0, 0.0);
        for i in 0..self.point.len() {
            let moved = sample.lambda[i] - self.point[i];
            curvature += moved * (sample.gap[i] - self.point_gap[i]);
            length += moved * moved;
        }
        curvature > 1.01 * length / step
    }

    /// Whether the last move and the projected gradient point against each other.
    fn points_uphill(&self, sample: &Sample) -> bool {
        let product = |i: usize| (self.point[i] - sample.lambda[i]) * (sample.lambda[i] - self.last[i]);
        (0..self.point.len()).map(product).sum::<f64>() > 0.0
    }

    /// The gaps are affine in the forces, so those of the extrapolated point need no product with `A`.
    fn extrapolate(&mut self, sample: &Sample) {
        let next = 0.5 * (1.0 + (1.0 + 4.0 * self.momentum * self.momentum).sqrt());
        let factor = (self.momentum - 1.0) / next;
        self.momentum = next;
        for i in 0..self.point.len() {
            self.point[i] = sample.lambda[i] + factor * (sample.lambda[i] - self.last[i]);
            self.point_gap[i] = sample.gap[i] + factor * (sample.gap[i] - self.last_gap[i]);
        }
    }
}
