//! Points at which three directions are free to move, or nearly: curves in space.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{Branch, Continuation, EventKind, Linearization, ParametricSystem, StopReason};

use crate::samples::{assert_sound, events, window};

/// Two equations for (x, y, p): `f` returns each one with its gradient; `piece` numbers the smooth pieces.
pub struct Spatial<F, G> {
    f: F,
    piece: G,
    at: [f64; 3],
}

pub type Equation = (f64, [f64; 3]);

pub fn spatial<F: Fn([f64; 3]) -> [Equation; 2]>(f: F) -> Spatial<F, fn([f64; 3]) -> u64> {
    Spatial { f, piece: |_| 0, at: [0.0; 3] }
}

impl<F: Fn([f64; 3]) -> [Equation; 2], G: Fn([f64; 3]) -> u64> ParametricSystem for Spatial<F, G> {
    type Error = Infallible;

    fn dim(&self) -> usize {
        2
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
        self.at = [x[0], x[1], p];
        for (i, (value, gradient)) in (self.f)(self.at).into_iter().enumerate() {
            out.residual[i] = value;
            (0..3).for_each(|j| out.jacobian[(i, j)] = gradient[j]);
        }
        Ok(())
    }

    fn pattern(&self) -> u64 {
        (self.piece)(self.at)
    }
}

fn trace<S: ParametricSystem>(settings: &Continuation, mut system: S, from: [f64; 3], along: [f64; 3]) -> Branch {
    settings.run(&mut system, &from[..2], from[2], &along, |_| ControlFlow::Continue(())).unwrap()
}

const CROSSING: fn(&EventKind) -> bool = |e| *e == EventKind::BranchPoint;

/// `σ₁ x = δ₊^{3/2}`, `σ₂ y = k δ₊^{3/2}` with `δ = p + a x + b y`: comes along the p axis and leaves in the direction
/// (1/σ₁, k/σ₂, −a/σ₁ − b k/σ₂), but for δ, which stays small.
#[test]
fn a_grazing_fold_is_passed_where_three_directions_are_nearly_free() {
    for (sigma, k, a, b) in [
        ([1e-4, 1e-4], 1.0, 1.0, 0.0),
        ([1e-4, 1e-4], 1.0, 3.0, 5.0),
        ([1e-6, 1e-4], 300.0, 2.0, 1.0),
        ([1e-5, 2e-4], -7.0, 4.0, -6.0),
        ([4e-6, 4e-5], 3.0, 10.0, 10.0),
    ] {
        let [s1, s2]: [f64; 2] = sigma;
        let depth = move |z: [f64; 3]| z[2] + a * z[0] + b * z[1];
        let f = move |z: [f64; 3]| {
            let d = depth(z).max(0.0);
            let (force, slope) = (d.powf(1.5), 1.5 * d.sqrt());
            [
                (s1 * z[0] - force, [s1 - slope * a, -slope * b, -slope]),
                (s2 * z[1] - k * force, [-k * slope * a, s2 - k * slope * b, -k * slope]),
            ]
        };
        let system = Spatial { f, piece: move |z| u64::from(depth(z) > 0.0), at: [0.0; 3] };
        let settings = Continuation { max_points: 400, ..window(2, -1.0, 1.0) };
        let branch = trace(&settings, system, [0.0, 0.0, -0.537], [0.0, 0.0, 1.0]);
        let case = format!("{sigma:?} {k} {a} {b}");
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 2, value: -1.0 }, "{case}");
        assert_sound(&branch, &settings);
        assert!(branch.points.len() < 200, "{} points, {case}", branch.points.len());
        let last = branch.points.last().unwrap();
        let ratio = k * s1 / s2;
        assert!((last.x[1] - ratio * last.x[0]).abs() < 1e-6 * last.x[0].abs(), "{case}: {:?}", last.z());
        assert!(last.x[0] * (a + b * ratio) > 0.99, "{case}: {:?}", last.z());
        let changes = events(&branch, |e| matches!(e, EventKind::PatternChange { .. }));
        assert_eq!(changes.len(), 1, "{case}");
        assert!(changes[0].z().iter().all(|z| z.abs() < 2e-6), "{case}: {:?}", changes[0].z());
        assert!(events(&branch, CROSSING).is_empty(), "{case}");
    }
}

/// `x² = p²`, `y (y² − p²) = 0`: six lines.
pub fn six_lines([x, y, p]: [f64; 3]) -> [Equation; 2] {
    [(x * x - p * p, [2.0 * x, 0.0, -2.0 * p]), (y * (y * y - p * p), [0.0, 3.0 * y * y - p * p, -2.0 * y * p])]
}

#[test]
fn all_arms_of_six_lines_through_a_point_in_space_are_found() {
    for (x, y) in [(1.0, 0.0), (1.0, 1.0), (-1.0, 1.0)] {
        let settings = window(2, -1.0, 1.0);
        let branch = trace(&settings, spatial(six_lines), [-0.613 * x, -0.613 * y, -0.613], [x, y, 1.0]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 2, value: 1.0 });
        assert_sound(&branch, &settings);
        assert!(branch.points.iter().all(|q| (q.x[0] - x * q.p).abs() < 1e-7 && (q.x[1] - y * q.p).abs() < 1e-7));
        assert_eq!(events(&branch, CROSSING).len(), 1);
        let arms = &branch.crossings[0].arms;
        assert_eq!(arms.len(), 11);
        for (i, j) in (0..11).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let distance: f64 = arms[i].start.z.iter().zip(&arms[j].start.z).map(|(a, b)| (a - b).powi(2)).sum();
            assert!(distance.sqrt() > 1e-6, "one arm twice");
        }
        for arm in arms {
            let z = &arm.start.z;
            assert!((z[0].abs() / z[2].abs() - 1.0).abs() < 1e-3, "{z:?}");
            let y = (z[1] / z[2]).abs();
            assert!(y < 1e-3 || (y - 1.0).abs() < 1e-3, "{z:?}");
        }
    }
}

/// The same lines with the crossings opened: `x² = p² + g²`, and `y (y² − p² − g²) = 0`.
#[test]
fn of_six_curves_closer_than_a_step_in_space_the_own_one_is_kept() {
    for gap in [1e-4, 1e-3, 1e-2, 0.05] {
        let f = |[x, y, p]: [f64; 3]| {
            let square = p * p + gap * gap;
            [
                (x * x - square, [2.0 * x, 0.0, -2.0 * p]),
                (y * (y * y - square), [0.0, 3.0 * y * y - square, -2.0 * y * p]),
            ]
        };
        for y in [0.0, 1.0] {
            let settings = window(2, -1.0, 1.0);
            let start = (0.9_f64 * 0.9 + gap * gap).sqrt();
            let branch = trace(&settings, spatial(f), [start, y * start, -0.9], [-1.0, -y, 1.0]);
            assert_eq!(branch.stop, StopReason::Bound { coordinate: 2, value: 1.0 }, "gap {gap}");
            assert_sound(&branch, &settings);
            let own = |q: &f64| *q >= gap * (1.0 - 1e-9);
            assert!(branch.points.iter().all(|q| own(&q.x[0])), "jump at gap {gap}, y {y}");
            assert!(branch.points.iter().all(|q| y == 0.0 || own(&q.x[1])), "jump at gap {gap}, y {y}");
            assert!(events(&branch, CROSSING).is_empty());
        }
    }
}

/// `x² = p²`, `y² = p²`: four lines. The sign of `det [J; tᵀ]` does not tell.
#[test]
fn a_point_at_which_the_determinant_keeps_its_sign_is_named_and_passed_straight() {
    let f =
        |[x, y, p]: [f64; 3]| [(x * x - p * p, [2.0 * x, 0.0, -2.0 * p]), (y * y - p * p, [0.0, 2.0 * y, -2.0 * p])];
    let settings = window(2, -1.0, 1.0);
    let branch = trace(&settings, spatial(f), [0.613, -0.613, -0.613], [-1.0, 1.0, 1.0]);
    assert_eq!(branch.stop, StopReason::Bound { coordinate: 2, value: 1.0 });
    assert!(branch.points.iter().all(|q| (q.x[0] + q.p).abs() < 1e-7 && (q.x[1] - q.p).abs() < 1e-7));
    let crossings = events(&branch, CROSSING);
    assert_eq!(crossings.len(), 1);
    assert!(crossings[0].z().iter().all(|z| z.abs() < 1e-6));
    assert_eq!(branch.crossings[0].arms.len(), 7);
}

/// `x² = p² + g²`, `y² = p² + g²`: a jump to the opposite of four curves leaves the sign of `det [J; tᵀ]` as it was.
#[test]
fn of_four_curves_closer_than_a_step_in_space_the_own_one_is_kept() {
    for gap in [1e-4, 1e-3, 1e-2, 0.05] {
        let f = |[x, y, p]: [f64; 3]| {
            let square = p * p + gap * gap;
            [(x * x - square, [2.0 * x, 0.0, -2.0 * p]), (y * y - square, [0.0, 2.0 * y, -2.0 * p])]
        };
        let settings = window(2, -1.0, 1.0);
        let start = (0.9_f64 * 0.9 + gap * gap).sqrt();
        let branch = trace(&settings, spatial(f), [start, start, -0.9], [-1.0, -1.0, 1.0]);
        assert_eq!(branch.stop, StopReason::Bound { coordinate: 2, value: 1.0 }, "gap {gap}");
        assert_sound(&branch, &settings);
        assert!(
            branch.points.iter().all(|q| q.x[0] >= gap * (1.0 - 1e-9) && q.x[1] >= gap * (1.0 - 1e-9)),
            "gap {gap}"
        );
        assert!(events(&branch, CROSSING).is_empty());
        assert!(branch.points.len() < 300, "{} points at gap {gap}", branch.points.len());
    }
}
