//! Systems with known solutions, and what every branch of them is asked.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Branch, BranchPoint, Continuation, EventKind, Linearization, ParametricSystem};

/// `f(x, p) = 0` in the plane: `f` returns value, ∂/∂x and ∂/∂p; `piece` numbers the smooth pieces.
pub struct Planar<F, G> {
    pub f: F,
    pub piece: G,
    at: (f64, f64),
}

/// A smooth curve.
pub fn smooth<F: Fn(f64, f64) -> [f64; 3]>(f: F) -> Planar<F, fn(f64, f64) -> u64> {
    piecewise(f, |_, _| 0)
}

/// A curve with pieces.
pub fn piecewise<F: Fn(f64, f64) -> [f64; 3], G: Fn(f64, f64) -> u64>(f: F, piece: G) -> Planar<F, G> {
    Planar { f, piece, at: (0.0, 0.0) }
}

impl<F: Fn(f64, f64) -> [f64; 3], G: Fn(f64, f64) -> u64> ParametricSystem for Planar<F, G> {
    type Error = Infallible;

    fn dim(&self) -> usize {
        1
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        self.at = (x[0], p);
        [out.residual[0], out.jacobian[(0, 0)], out.jacobian[(0, 1)]] = (self.f)(x[0], p);
        Ok(())
    }

    fn pattern(&self) -> u64 {
        (self.piece)(self.at.0, self.at.1)
    }
}

/// A planar curve in five dimensions: `y = A (x, p)` with three more unknowns, each equation mixed with the others.
pub struct Embedded<S>(pub S);

/// Rows of A.
const LIFT: [[f64; 2]; 3] = [[0.7, 0.2], [-0.3, 0.9], [0.1, -0.4]];

impl<S: ParametricSystem> ParametricSystem for Embedded<S> {
    type Error = S::Error;

    fn dim(&self) -> usize {
        4
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), S::Error> {
        let mut planar = Linearization::new(1);
        self.0.linearize(&x[..1], p, &mut planar)?;
        for i in 0..4 {
            (0..5).for_each(|j| out.jacobian[(i, j)] = 0.0);
            let share = if i == 0 { 1.0 } else { 0.1 * i as f64 };
            out.residual[i] = share * planar.residual[0];
            (out.jacobian[(i, 0)], out.jacobian[(i, 4)]) =
                (share * planar.jacobian[(0, 0)], share * planar.jacobian[(0, 1)]);
            for (k, [a, b]) in LIFT.iter().enumerate().filter(|(k, _)| *k + 1 == i || i == 0) {
                out.residual[i] += x[k + 1] - a * x[0] - b * p;
                out.jacobian[(i, k + 1)] += 1.0;
                out.jacobian[(i, 0)] -= a;
                out.jacobian[(i, 4)] -= b;
            }
        }
        Ok(())
    }

    fn pattern(&self) -> u64 {
        self.0.pattern()
    }
}

impl<S> Embedded<S> {
    /// Unknowns and direction for those of the planar curve.
    pub fn lift(x: f64, p: f64) -> Vec<f64> {
        [x].into_iter().chain(LIFT.iter().map(|[a, b]| a * x + b * p)).collect()
    }
}

/// Settings with one window of one coordinate.
pub fn window(coordinate: usize, min: f64, max: f64) -> Continuation {
    Continuation { bounds: vec![Bound { coordinate, min, max }], ..Continuation::default() }
}

/// The branch of a planar curve.
pub fn trace<S: ParametricSystem>(settings: &Continuation, mut system: S, from: [f64; 2], along: [f64; 2]) -> Branch {
    settings.run(&mut system, &from[..1], from[1], &along, |_| ControlFlow::Continue(())).unwrap()
}

/// The points at which events of this kind happen.
pub fn events(branch: &Branch, is: impl Fn(&EventKind) -> bool) -> Vec<&BranchPoint> {
    branch.points.iter().filter(|q| q.events.iter().any(&is)).collect()
}

/// That the residual is small everywhere, that no event is reported twice, and that consecutive points are no further
/// apart than a step.
pub fn assert_sound(branch: &Branch, settings: &Continuation) {
    for q in &branch.points {
        assert!(q.residual <= 1e-10, "residual {:e} at {:?}", q.residual, q.z());
        let length: f64 = q.tangent.iter().map(|t| t * t).sum();
        assert!((length - 1.0).abs() < 1e-10);
    }
    let distance = |a: &BranchPoint, b: &BranchPoint| {
        let (a, b, sizes) = (a.z(), b.z(), &branch.scales.unknowns);
        a.iter().zip(&b).zip(sizes).map(|((a, b), size)| ((a - b) / size).powi(2)).sum::<f64>().sqrt()
    };
    for pair in branch.points.windows(2) {
        // Beyond four sizes that are found steps grow in proportion.
        let sizes = branch.scales.unknowns.iter();
        let far = pair[1].z().iter().zip(sizes).fold(4.0_f64, |m, (z, size)| m.max((z / size).abs())) / 4.0;
        let far = if branch.scales.unknowns.iter().all(|size| *size == 1.0) { 1.0 } else { far };
        assert!(distance(&pair[0], &pair[1]) <= 1.2 * far * settings.step.max);
        let twice = pair[0].events.iter().any(|e| pair[1].events.contains(e));
        assert!(!twice || distance(&pair[0], &pair[1]) > 1e-6, "{:?} twice at {:?}", pair[0].events, pair[0].z());
    }
}
