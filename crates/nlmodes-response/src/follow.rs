use std::ops::ControlFlow;

use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Bound, Branch, BranchPoint, Continuation, EventKind, Linearization, ParametricSystem};
use nlmodes_hbm::{Instability, PeriodicSystem, PhaseLag};
use nlmodes_linalg::{DenseLu, Mat};
use num_complex::Complex64;

use crate::{ResponseCurve, ResponseError, ResponseEvent, ResponsePoint, ResponseSettings, Stability};

/// A curve to follow: a system, where it starts, and what its points are called.
pub(crate) struct Curve<'a> {
    pub system: PeriodicSystem,
    pub x: Vec<f64>,
    pub p: f64,
    pub direction: Vec<f64>,
    pub bounds: Vec<Bound>,
    pub drive: Option<PhaseLag>,
    pub settings: &'a ResponseSettings,
    pub solver: &'a dyn LcpSolver,
}

impl Curve<'_> {
    pub fn run(&mut self) -> Result<Branch, ResponseError> {
        let method = Continuation {
            bounds: self.bounds.clone(),
            max_points: self.settings.max_points,
            ..Continuation::default()
        };
        self.system.hold_phase(&self.x);
        let all = |_: &BranchPoint| ControlFlow::Continue(());
        Ok(method.run(&mut self.system, &self.x, self.p, &self.direction, all)?)
    }

    /// Follows the curve; `omega` is the coordinate of the frequency and its unit (of the load, rad/s).
    pub fn follow(&mut self, omega: (usize, f64)) -> Result<ResponseCurve, ResponseError> {
        let branch = self.run()?;
        let mut points: Vec<ResponsePoint> = Vec::with_capacity(branch.points.len());
        for point in &branch.points {
            let next = self.point(point)?;
            points.push(next);
        }
        name_lost_stability(&mut points);
        Ok(ResponseCurve { points, end: crate::CurveEnd::of(&branch.stop, omega.0, omega.1) })
    }

    fn point(&mut self, at: &BranchPoint) -> Result<ResponsePoint, ResponseError> {
        let (x, p, residual) = polished(&mut self.system, at);
        let motion = self.system.motion(&x, p)?;
        let drive = self.drive.as_ref().map_or(Complex64::default(), |drive| {
            let own = self.system.load().terms().iter().zip(&drive.row.loads);
            let own = own.filter(|(term, _)| term.harmonic == drive.harmonic);
            let moved = own.map(|(term, a)| a * motion.at.level * motion.at.omega.powi(term.omega_power));
            motion.displacement(&drive.row)[drive.harmonic] + moved.sum::<Complex64>()
        });
        let stability = match self.settings.stability {
            true => Some(self.stability(&x, p)?),
            false => None,
        };
        let named = at.events.iter().filter_map(|event| match event {
            EventKind::ParameterFold => Some(ResponseEvent::Fold),
            EventKind::BranchPoint => Some(ResponseEvent::BranchPoint),
            EventKind::Kink => Some(ResponseEvent::Kink),
            EventKind::PatternChange { .. } => Some(ResponseEvent::PatternChange),
            _ => None,
        });
        Ok(ResponsePoint {
            omega: motion.at.omega * self.settings.subharmonic as f64,
            level: motion.at.level,
            drive,
            stability,
            residual,
            events: named.collect(),
            motion,
        })
    }

    fn stability(&mut self, x: &[f64], p: f64) -> Result<Stability, ResponseError> {
        let floquet = self.system.floquet(x, p, self.solver)?;
        Ok(Stability {
            stable: floquet.is_stable(),
            largest: floquet.largest(),
            error: floquet.error,
            instability: floquet.instability(),
        })
    }

    /// Number of unknowns, which is the coordinate of the parameter.
    pub fn parameter(&self) -> usize {
        self.system.dim()
    }
}

/// Share of the parameter in the tangent above which it is held while a point is polished.
const HELD: f64 = 0.05;

/// A point taken from the tolerance of the continuation to rounding, by steps of Newton's method at the same parameter, or next to a fold across
/// the tangent; unknowns, parameter and residual. Where powers nearly cancel, that tolerance would be seen in their balance.
fn polished(system: &mut PeriodicSystem, point: &BranchPoint) -> (Vec<f64>, f64, f64) {
    let n = system.dim();
    let mut best = (point.x.clone(), point.p, f64::INFINITY);
    let (mut z, mut at) = (point.z(), Linearization::new(n));
    for _ in 0..4 {
        if system.linearize(&z[..n], z[n], &mut at).is_err() || at.residual_norm() >= best.2 {
            break;
        }
        best = (z[..n].to_vec(), z[n], at.residual_norm());
        let held = point.tangent[n].abs() > HELD;
        let border = |j: usize| if held { f64::from(u8::from(j == n)) } else { point.tangent[j] };
        let square = Mat::from_fn(n + 1, n + 1, |i, j| if i < n { at.jacobian[(i, j)] } else { border(j) });
        let Ok(lu) = DenseLu::factor(&square) else { break };
        let mut step: Vec<f64> = at.residual.iter().copied().chain([0.0]).collect();
        lu.solve_in_place(&mut step);
        z.iter_mut().zip(&step).for_each(|(z, s)| *z -= s);
    }
    best
}

/// Names the losses of stability between neighbouring points that no fold explains.
fn name_lost_stability(points: &mut [ResponsePoint]) {
    let mut last: Option<Stability> = None;
    for point in points {
        let Some(now) = point.stability.filter(|s| s.stable.is_some()) else { continue };
        if let Some(before) = last.filter(|before| before.stable != now.stable) {
            let unstable = if now.stable == Some(false) { now } else { before };
            match unstable.instability {
                Instability::PeriodDoubling => point.events.push(ResponseEvent::PeriodDoubling),
                Instability::NeimarkSacker => point.events.push(ResponseEvent::NeimarkSacker),
                Instability::Fold => {}
            }
        }
        last = Some(now);
    }
}
