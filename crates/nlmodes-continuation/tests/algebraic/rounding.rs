//! Systems whose residual is rounded, along directions that are nearly free.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{Bound, Continuation, Linearization, ParametricSystem, StopReason};

/// Singular value of the direction of `y`.
const SIGMA: f64 = 1e-9;

/// Rounding of the residual.
const NOISE: f64 = 4e-16;

/// `x − sin p = 0`, `σ (y − cos p) + noise = 0`, with noise of a few units of rounding that changes with every digit of the unknowns, as that
/// of a long sum does.
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
