//! Systems whose residual is rounded, along directions that are nearly free.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{
    Bound, Continuation, EventKind, Linearization, ParametricSystem, Scaling, StepSettings, StopReason,
};

use crate::samples::events;

/// Singular value of the direction of `y`.
const SIGMA: f64 = 1e-9;

/// Rounding of the residual.
const NOISE: f64 = 4e-16;

/// `x − sin p = 0`, `σ (y − cos p) + noise = 0`, with noise of a few units of rounding that changes with every digit of
/// the unknowns, as that of a long sum does.
struct NearlyFree;

impl NearlyFree {
    fn noise(z: [f64; 3]) -> f64 {
        let mixed = z.iter().fold(0x9e37_79b9_7f4a_7c15_u64, |h, v| {
            (h ^ v.to_bits()).wrapping_mul(0xbf58_476d_1ce4_e5b9).rotate_left(29)
        });
        NOISE * (mixed as f64 / u64::MAX as f64 * 2.0 - 1.0)
    }
}

impl ParametricSystem for NearlyFree {
    type Error = Infallible;

    fn dim(&self) -> usize {
        2
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        out.residual[0] = x[0] - p.sin();
        out.residual[1] = SIGMA * (x[1] - p.cos()) + Self::noise([x[0], x[1], p]);
        let rows = [[1.0, 0.0, -p.cos()], [0.0, SIGMA, SIGMA * p.sin()]];
        for (i, row) in rows.iter().enumerate() {
            (0..3).for_each(|j| out.jacobian[(i, j)] = row[j]);
        }
        Ok(())
    }
}

#[test]
fn a_curve_that_rounding_blurs_by_more_than_newtons_method_settles_to_is_followed_within_that() {
    let settings = Continuation {
        bounds: vec![Bound { coordinate: 2, min: -1.0, max: 6.0 }],
        max_points: 2000,
        ..Continuation::default()
    };
    let branch =
        settings.run(&mut NearlyFree, &[0.0, 1.0], 0.0, &[1.0, 0.0, 1.0], |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 2, value: 6.0 }, "{} points", branch.points.len());
    for q in &branch.points {
        assert!((q.x[0] - q.p.sin()).abs() < 1e-11);
        // The residual says no more about y.
        assert!((q.x[1] - q.p.cos()).abs() < 2.0 * NOISE / SIGMA, "{:e} at {}", q.x[1] - q.p.cos(), q.p);
    }
    assert!(branch.points.len() < 400, "{} points", branch.points.len());
}

/// The same up to `p = 1`, beyond which there is no solution.
struct Ending;

impl ParametricSystem for Ending {
    type Error = Infallible;

    fn dim(&self) -> usize {
        2
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        NearlyFree.linearize(x, p, out)?;
        if p > 1.0 {
            out.residual[0] = 1.0;
        }
        Ok(())
    }
}

/// Points of it are known to about `noise/σ`, 10⁻⁷: steps of that length would lead anywhere, whatever shortest one is
/// permitted.
#[test]
fn a_branch_that_ends_is_not_looked_for_by_steps_shorter_than_rounding_blurs_it() {
    for min in [1e-6, 1e-8] {
        let step = StepSettings { min, ..StepSettings::default() };
        let settings = Continuation { step, max_points: 2000, ..Continuation::default() };
        let branch =
            settings.run(&mut Ending, &[0.0, 1.0], 0.0, &[1.0, 0.0, 1.0], |_| ControlFlow::Continue(())).unwrap();
        let StopReason::StepTooSmall { step, .. } = branch.stop else { panic!("{:?}", branch.stop) };
        assert!(step > 10.0 * NOISE / SIGMA && step < 1e-3, "{step:e}");
        let last = branch.points.last().unwrap();
        assert!(last.p <= 1.0 && last.p > 1.0 - 3.0 * step, "{:e} before the end", 1.0 - last.p);
    }
}

/// `x − √(p² + δ²) = 0`, `σ (y − cos p) = 0` in units of unknowns, parameter and equations: the second equation is
/// small beside its unit, and rounded as what is so small. Within a bend of radius δ the steps must be shorter than it.
struct SmallRow {
    units: [f64; 3],
}

/// Radius of the bend: steps of a third of it are within the shortest one that is permitted, 10⁻⁶, and far below those
/// that rounding of numbers near one would permit, 50 · 8 ε/σ ≈ 10⁻⁴.
const RADIUS: f64 = 1e-5;

impl ParametricSystem for SmallRow {
    type Error = Infallible;

    fn dim(&self) -> usize {
        2
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let [a, b, unit] = self.units;
        let (x, y, p) = (x[0] / a, x[1] / a, p / b);
        let root = p.hypot(RADIUS);
        out.residual = vec![unit * (x - root), unit * SIGMA * (y - p.cos())];
        let rows = [[1.0, 0.0, -p / root], [0.0, SIGMA, SIGMA * p.sin()]];
        for (i, row) in rows.iter().enumerate() {
            row.iter().zip([a, a, b]).enumerate().for_each(|(j, (of, size))| out.jacobian[(i, j)] = unit * of / size);
        }
        Ok(())
    }

    fn scaling(&self) -> Option<Scaling> {
        let [a, b, unit] = self.units;
        Some(Scaling { unknowns: vec![a, a, b], equations: vec![unit, unit] })
    }
}

/// Were that row taken to be rounded as one near one is, no step short enough for the bend would be tried.
#[test]
fn a_row_that_is_small_beside_its_unit_does_not_keep_steps_from_becoming_short_enough_for_a_bend() {
    for units in [[1.0; 3], [1024.0, 0.125, 4096.0], [3e-4, 7e5, 1e-6]] {
        let [a, b, _] = units;
        let settings = Continuation {
            bounds: vec![Bound { coordinate: 2, min: -0.5 * b, max: 0.5 * b }],
            watched: vec![0],
            max_points: 500,
            ..Continuation::default()
        };
        let start = [a * 0.3_f64.hypot(RADIUS), a * 0.3_f64.cos()];
        let observe = |_: &_| ControlFlow::Continue(());
        let branch = settings.run(&mut SmallRow { units }, &start, -0.3 * b, &[-a, 0.0, b], observe).unwrap();
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 2, value: 0.5 * b }, "{units:?}");
        // The bend is followed: it is no kink, has a point where the unknown is least, and several around that.
        assert!(events(&branch, |e| *e == EventKind::Kink).is_empty(), "{units:?}");
        let least = events(&branch, |e| *e == EventKind::UnknownFold { index: 0 });
        assert_eq!(least.len(), 1, "{units:?}");
        assert!((least[0].p / b).abs() < 1e-4 * RADIUS && (least[0].x[0] / a / RADIUS - 1.0).abs() < 1e-4, "{units:?}");
        let within = branch.points.iter().filter(|q| (q.p / b).abs() < RADIUS).count();
        assert!(within >= 5, "{units:?}: {within} points");
        for q in &branch.points {
            let (x, y, p) = (q.x[0] / a, q.x[1] / a, q.p / b);
            assert!((x - p.hypot(RADIUS)).abs() < 1e-11 && (y - p.cos()).abs() < 1e-9, "{units:?} at {p}");
        }
    }
}
