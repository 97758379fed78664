//! A problem in other units is the same problem.

mod zero_start;

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{
    Bound, Branch, Continuation, EventKind, Linearization, ParametricSystem, Scaling, StopReason,
};

use crate::samples::{events, smooth, trace, window};

/// A system whose unknowns, parameter and residual are multiples of those of another one.
pub struct InUnits<S> {
    pub inner: S,
    pub x: f64,
    pub p: f64,
    pub residual: f64,
}

impl<S: ParametricSystem> ParametricSystem for InUnits<S> {
    type Error = S::Error;

    fn dim(&self) -> usize {
        self.inner.dim()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), S::Error> {
        let inner: Vec<f64> = x.iter().map(|x| x / self.x).collect();
        self.inner.linearize(&inner, p / self.p, out)?;
        let n = x.len();
        for i in 0..n {
            out.residual[i] *= self.residual;
            (0..n).for_each(|j| out.jacobian[(i, j)] *= self.residual / self.x);
            out.jacobian[(i, n)] *= self.residual / self.p;
        }
        Ok(())
    }

    fn pattern(&self) -> u64 {
        self.inner.pattern()
    }
}

/// The branch of a planar curve in these units.
fn in_units(
    settings: &Continuation,
    f: impl Fn(f64, f64) -> [f64; 3],
    [x, p, residual]: [f64; 3],
    from: [f64; 2],
    along: [f64; 2],
) -> Branch {
    let mut settings = settings.clone();
    for bound in &mut settings.bounds {
        let unit = [x, p][bound.coordinate];
        (bound.min, bound.max) = (bound.min * unit, bound.max * unit);
    }
    let system = InUnits { inner: smooth(f), x, p, residual };
    trace(&settings, system, [from[0] * x, from[1] * p], [along[0] * x, along[1] * p])
}

fn circle(x: f64, p: f64) -> [f64; 3] {
    [x * x + p * p - 1.0, 2.0 * x, 2.0 * p]
}

/// Through (1, 1).
fn large_circle(x: f64, p: f64) -> [f64; 3] {
    [x * x + p * p - 2.0, 2.0 * x, 2.0 * p]
}

fn pitchfork(x: f64, p: f64) -> [f64; 3] {
    [x * (p - x * x), p - 3.0 * x * x, x]
}

#[test]
fn in_units_that_are_powers_of_two_the_points_are_the_same_bit_for_bit() {
    let closed = Continuation::default();
    let ends = window(1, -1.0, 0.9);
    for [x, p, residual] in
        [[1.0, 1.0, 1048576.0], [16384.0, 1.0, 1.0], [1.0, 0.0009765625, 1.0], [8192.0, 64.0, 4096.0]]
    {
        for (settings, f, from, along) in [
            (&closed, large_circle as fn(f64, f64) -> [f64; 3], [1.0, 1.0], [-1.0, 1.0]),
            (&ends, pitchfork, [0.9, 0.81], [-1.8, -1.0]),
        ] {
            let expected = in_units(settings, f, [1.0; 3], from, along);
            let found = in_units(settings, f, [x, p, residual], from, along);
            let points = |branch: &Branch, x: f64, p: f64| {
                branch.points.iter().map(|q| (q.x[0] / x, q.p / p, q.events.clone())).collect::<Vec<_>>()
            };
            assert_eq!(points(&found, x, p), points(&expected, 1.0, 1.0), "{x} {p} {residual}");
            assert_eq!(found.evaluations, expected.evaluations);
        }
    }
}

#[test]
fn a_circle_in_any_units_is_closed_with_two_folds_and_ends_on_its_bound() {
    for [x, p, residual] in [[1.0, 1.0, 1e6], [1e4, 1.0, 1.0], [1e4, 1e4, 1.0], [1e-3, 1e3, 1e6], [1.0, 1e-6, 1e-9]] {
        for start in 0..25 {
            let (b, a) = (0.25 * f64::from(start) + 0.01).sin_cos();
            let branch = in_units(&Continuation::default(), circle, [x, p, residual], [a, b], [-b, a]);
            let case = format!("{x} {p} {residual} from {a} {b}");
            assert_eq!(branch.stop, StopReason::Closed, "{case}");
            let folds = events(&branch, |e| *e == EventKind::ParameterFold);
            assert_eq!(folds.len(), 2, "{case}");
            assert!(folds.iter().all(|q| ((q.p / p).abs() - 1.0).abs() < 1e-9), "{case}");
            assert!(branch.evaluations < 6000, "{case}: {}", branch.evaluations);
        }
        let branch = in_units(&window(1, -2.0, 0.3), circle, [x, p, residual], [1.0, 0.0], [0.0, 1.0]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 0.3 * p }, "{x} {p} {residual}");
        assert!(branch.points.iter().all(|q| q.p <= 0.3 * p));
    }
}

/// Two bars of stiffness EA, N, with supports 2 m apart, that meet at the height w; load P, N.
/// `P = 2 EA w (1/L − 1/L₀)`, `L² = 1 + w²`.
fn truss(ea: f64, height: f64) -> impl Fn(f64, f64) -> [f64; 3] {
    move |w, load| {
        let (l, l0) = ((1.0 + w * w).sqrt(), (1.0 + height * height).sqrt());
        [2.0 * ea * w * (1.0 / l - 1.0 / l0) - load, 2.0 * ea * (1.0 / (l * l * l) - 1.0 / l0), -1.0]
    }
}

#[test]
fn a_truss_in_newtons_snaps_through_at_the_load_known_in_closed_form() {
    let height = 0.1;
    let l0 = (1.0_f64 + height * height).sqrt();
    // dP/dw = 0 where L³ = L₀.
    let l = l0.cbrt();
    let w = (l * l - 1.0).sqrt();
    for ea in [1.0, 1e6, 2.1e11] {
        let limit = 2.0 * ea * w * (1.0 / l - 1.0 / l0);
        for [x, p, residual] in [[1.0; 3], [1e3, 1.0, 1.0], [1.0, 1e-3, 1e-3], [1e3, 1e-6, 1e6]] {
            let bounds = vec![Bound { coordinate: 0, min: -0.15, max: 1.0 }];
            let settings = Continuation { bounds, ..Continuation::default() };
            let branch = in_units(&settings, truss(ea, height), [x, p, residual], [height, 0.0], [0.0, 1.0]);
            let case = format!("EA = {ea}, units {x} {p} {residual}");
            assert_eq!(branch.stop, StopReason::Bound { coordinate: 0, value: -0.15 * x }, "{case}");
            let folds = events(&branch, |e| *e == EventKind::ParameterFold);
            assert_eq!(folds.len(), 2, "{case}");
            for (fold, sign) in folds.iter().zip([1.0, -1.0]) {
                assert!((fold.p / p / limit - sign).abs() < 1e-9, "{case}: {} of {limit}", fold.p / p);
                assert!((fold.x[0] / x - sign * w).abs() < 1e-5, "{case}");
            }
            assert!(branch.evaluations < 1500, "{case}: {}", branch.evaluations);
        }
    }
}

/// Bratu's problem `u″ + p eᵘ = 0` on n inner nodes, its equations multiplied by `unit`.
struct Bratu {
    n: usize,
    unit: f64,
}

impl ParametricSystem for Bratu {
    type Error = Infallible;

    fn dim(&self) -> usize {
        self.n
    }

    fn linearize(&mut self, u: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        let per_h2 = ((self.n + 1) as f64).powi(2);
        for i in 0..self.n {
            let (left, right) = (if i > 0 { u[i - 1] } else { 0.0 }, u.get(i + 1).copied().unwrap_or(0.0));
            let growth = self.unit * p * u[i].exp();
            out.residual[i] = self.unit * per_h2 * (left - 2.0 * u[i] + right) + growth;
            (0..=self.n).for_each(|j| out.jacobian[(i, j)] = 0.0);
            out.jacobian[(i, i)] = growth - 2.0 * self.unit * per_h2;
            out.jacobian[(i, self.n)] = self.unit * u[i].exp();
            for j in [i.wrapping_sub(1), i + 1].into_iter().filter(|j| *j < self.n) {
                out.jacobian[(i, j)] = self.unit * per_h2;
            }
        }
        Ok(())
    }
}

#[test]
fn a_laplacian_over_the_square_of_the_spacing_costs_no_more_than_one_without() {
    let n = 101;
    let follow = |unit: f64| {
        let settings = window(n / 2, -1.0, 5.0);
        let mut direction = vec![0.0; n + 1];
        direction[n] = 1.0;
        settings.run(&mut Bratu { n, unit }, &vec![0.0; n], 0.0, &direction, |_| ControlFlow::Continue(())).unwrap()
    };
    let fold = |branch: &Branch| events(branch, |e| *e == EventKind::ParameterFold)[0].p;
    let plain = follow(1.0 / 10404.0);
    for unit in [1.0, 1e6, 1e-7] {
        let branch = follow(unit);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: n / 2, value: 5.0 }, "unit {unit}");
        // Central differences: an error of about h².
        assert!((fold(&branch) - 3.513_830_719_125_162).abs() < 3e-4, "{}", fold(&branch));
        assert!((fold(&branch) - fold(&plain)).abs() < 1e-9, "{} {}", fold(&branch), fold(&plain));
        assert!(branch.evaluations <= plain.evaluations + plain.evaluations / 10, "{} evaluations", branch.evaluations);
    }
    assert!(plain.evaluations < 2000, "{} evaluations", plain.evaluations);
}

#[test]
fn a_residual_that_is_rounded_by_more_than_the_tolerance_is_followed_as_far_as_it_is_known() {
    for noise in [1e-12, 1e-10, 1e-8] {
        let f = move |x: f64, p: f64| {
            let mixed = (x.to_bits() ^ p.to_bits().rotate_left(17)).wrapping_mul(0xbf58_476d_1ce4_e5b9).rotate_left(29);
            let rounding = noise * (mixed as f64 / u64::MAX as f64 * 2.0 - 1.0);
            [x - p.sin() + rounding, 1.0, -p.cos()]
        };
        let branch = trace(&window(1, -1.0, 6.0), smooth(f), [0.0, 0.0], [1.0, 1.0]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 1, value: 6.0 }, "noise {noise}");
        assert!(branch.points.iter().all(|q| (q.x[0] - q.p.sin()).abs() < 100.0 * noise), "noise {noise}");
        assert!(branch.points.len() < 400, "{} points", branch.points.len());
    }
}

#[test]
fn a_point_that_is_not_found_is_told_with_residual_tolerance_and_rounding() {
    let start = Continuation::default().run(
        &mut smooth(|x, p| [1e6 * (x * x + p * p + 1.0), 2e6 * x, 2e6 * p]),
        &[1.0],
        1.0,
        &[0.0, 1.0],
        |_| ControlFlow::Continue(()),
    );
    let message = start.unwrap_err().to_string();
    assert!(["residual", "tolerance 1.0e-11", "rounding"].iter().all(|word| message.contains(word)), "{message}");
}

type Curve = crate::samples::Planar<fn(f64, f64) -> [f64; 3], fn(f64, f64) -> u64>;

/// A system that tells its sizes.
struct Sized(InUnits<Curve>, Scaling);

impl ParametricSystem for Sized {
    type Error = Infallible;

    fn dim(&self) -> usize {
        1
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        self.0.linearize(x, p, out)
    }

    fn scaling(&self) -> Option<Scaling> {
        Some(self.1.clone())
    }
}

#[test]
fn sizes_that_are_given_are_used_and_wrong_ones_refused() {
    let system = |unknowns: Vec<f64>, equations: Vec<f64>| {
        let inner = smooth(circle as fn(f64, f64) -> [f64; 3]);
        Sized(InUnits { inner, x: 4096.0, p: 1.0 / 64.0, residual: 1024.0 }, Scaling { unknowns, equations })
    };
    let run = |mut system: Sized| {
        Continuation::default().run(&mut system, &[4096.0], 0.0, &[0.0, 1.0], |_| ControlFlow::Continue(()))
    };
    let found = run(system(vec![4096.0, 1.0 / 64.0], vec![1024.0])).unwrap();
    let expected = trace(&Continuation::default(), smooth(circle), [1.0, 0.0], [0.0, 1.0]);
    // Given sizes leave the longest step as it is; so do those of the circle, which goes nowhere far.
    assert_eq!(found.points.len(), expected.points.len());
    for (q, e) in found.points.iter().zip(&expected.points) {
        assert!((q.x[0] / 4096.0 - e.x[0]).abs() < 1e-9 && (q.p * 64.0 - e.p).abs() < 1e-9);
    }
    assert!(run(system(vec![1.0], vec![1.0])).is_err());
    assert!(run(system(vec![1.0, 0.0], vec![1.0])).is_err());
    assert!(run(system(vec![1.0, 1.0], vec![f64::NAN])).is_err());
}

/// Keeps the points of which it is notified.
struct Told(InUnits<Curve>, Vec<[f64; 2]>);

impl ParametricSystem for Told {
    type Error = Infallible;

    fn dim(&self) -> usize {
        1
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        self.0.linearize(x, p, out)
    }

    fn accepted(&mut self, x: &[f64], p: f64) {
        self.1.push([x[0], p]);
    }
}

#[test]
fn a_system_is_told_the_points_from_which_the_branch_goes_on_in_its_own_units() {
    for [x, p, residual] in [[1.0; 3], [4096.0, 1.0 / 64.0, 1024.0], [3e-5, 7e4, 0.1]] {
        let inner = smooth(circle as fn(f64, f64) -> [f64; 3]);
        let mut system = Told(InUnits { inner, x, p, residual }, Vec::new());
        let along = [-0.6 * x, 0.8 * p];
        let settings = Continuation::default();
        let branch = settings.run(&mut system, &[0.8 * x], 0.6 * p, &along, |_| ControlFlow::Continue(())).unwrap();
        assert!(system.1.len() > 50, "{} points", system.1.len());
        for told in &system.1 {
            let off = (told[0] / x).hypot(told[1] / p) - 1.0;
            assert!(off.abs() < 1e-10, "{told:?} lies {off:e} off the circle");
        }
        // All of the branch but its two folds.
        let plain = branch.points.iter().filter(|q| q.events.is_empty()).map(|q| [q.x[0], q.p]);
        assert_eq!(system.1, plain.collect::<Vec<_>>(), "{x} {p} {residual}");
    }
}
