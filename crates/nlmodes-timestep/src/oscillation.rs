use crate::first_root::{Approximation, Guard, root};

/// A guard along a motion: `f(t) = c + Σ_k a_k cos ω_k t + b_k sin(ω_k t)/ω_k + d_k (1 − cos ω_k t)/ω_k²`, with `t` in
/// place of `sin(ω t)/ω` and `t²/2` in place of the last factor where `ω = 0`.
pub(crate) struct Oscillation<'m> {
    /// Squared angular frequencies, rad²/s².
    pub lambda: &'m [f64],
    /// Angular frequencies, rad/s.
    pub omega: &'m [f64],
    pub a: Vec<f64>,
    pub b: Vec<f64>,
    /// Of modes under a steady force; empty for none.
    pub d: Vec<f64>,
    pub constant: f64,
}

/// `cos ωt` and `sin(ωt)/ω`.
pub(crate) fn cosine_and_sine(omega: f64, t: f64) -> (f64, f64) {
    if omega == 0.0 {
        return (1.0, t);
    }
    let (sin, cos) = (omega * t).sin_cos();
    (cos, sin / omega)
}

/// `(1 − cos ωt)/ω² = 2 (sin(ωt/2)/ω)²`.
pub(crate) fn fall(omega: f64, t: f64) -> f64 {
    2.0 * cosine_and_sine(omega, 0.5 * t).1.powi(2)
}

/// `∫ (1 − cos ωt)/ω² dt = (t − sin(ωt)/ω)/ω²` from 0 to `t`: a series where that would be a difference of equal
/// numbers.
pub(crate) fn fall_integral(omega: f64, t: f64) -> f64 {
    let turn = omega * t;
    if turn.abs() > 0.1 {
        return (t - turn.sin() / omega) / (omega * omega);
    }
    let square = turn * turn;
    t.powi(3) / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)))
}

impl Oscillation<'_> {
    /// `f`, `f'` and `f''` at `t`.
    pub fn evaluate(&self, t: f64) -> [f64; 3] {
        self.sum(t, self.omega.iter().map(|omega| cosine_and_sine(*omega, t)))
    }

    /// The first modes' share of `f`, `f'` and `f''` at `t`, with their `cos ω_k t` and `sin(ω_k t)/ω_k`.
    fn sum(&self, t: f64, turns: impl Iterator<Item = (f64, f64)>) -> [f64; 3] {
        let mut value = [self.constant, 0.0, 0.0];
        for (k, (cos, sin)) in turns.enumerate() {
            let (a, b, lambda) = (self.a[k], self.b[k], self.lambda[k]);
            let share = a * cos + b * sin;
            value[0] += share;
            value[1] += b * cos - a * lambda * sin;
            value[2] -= lambda * share;
            let d = self.d.get(k).copied().unwrap_or(0.0);
            if d != 0.0 {
                value[0] += d * fall(self.omega[k], t);
                value[1] += d * sin;
                value[2] += d * cos;
            }
        }
        value
    }

    /// `f` at the beginning, rounded as [`evaluate`](Self::evaluate) rounds it.
    pub fn beginning(&self) -> f64 {
        self.a.iter().fold(self.constant, |sum, a| sum + a)
    }

    /// Angular frequencies and `d` of the modes under a steady force.
    fn pulled(&self) -> impl Iterator<Item = (f64, f64)> {
        self.omega.iter().copied().zip(self.d.iter().copied()).filter(|(_, d)| *d != 0.0)
    }

    /// `∫ f dt` from 0 to `end`.
    pub fn integral(&self, end: f64) -> f64 {
        let terms = (0..self.omega.len())
            .map(|k| self.a[k] * cosine_and_sine(self.omega[k], end).1 + self.b[k] * fall(self.omega[k], end));
        let pulled = self.pulled().map(|(omega, d)| d * fall_integral(omega, end));
        self.constant * end + terms.sum::<f64>() + pulled.sum::<f64>()
    }

    /// Sum of the magnitudes of the amplitudes: the scale of rounding errors of `f`.
    pub fn size(&self) -> f64 {
        let terms = self.omega.iter().zip(self.a.iter().zip(&self.b));
        // A drift is not included: its value at the end is not known here.
        let amplitude = |(ω, (a, b)): (&f64, (&f64, &f64))| a.hypot(if *ω > 0.0 { b / ω } else { 0.0 });
        self.constant.abs() + terms.map(amplitude).sum::<f64>()
    }

    /// `−f`.
    pub fn negated(mut self) -> Self {
        self.a.iter_mut().chain(&mut self.b).chain(&mut self.d).for_each(|x| *x = -*x);
        self.constant = -self.constant;
        self
    }

    /// Smallest value in `[0, end]`: samples, eight in the shortest period, then the zero of the slope next to the best
    /// one.
    pub fn lowest(&self, end: f64) -> f64 {
        let highest = self.omega.last().copied().unwrap_or(0.0);
        let cells = 16 + (8.0 * highest * end / std::f64::consts::TAU).min(1e5) as usize;
        let at = |j: usize| end * j as f64 / cells as f64;
        let samples = (0..=cells).map(|j| (j, self.evaluate(at(j))[0]));
        let Some((best, value)) = samples.min_by(|a, b| a.1.total_cmp(&b.1)) else { return f64::NAN };
        let (from, to) = (at(best.saturating_sub(1)), at((best + 1).min(cells)));
        if self.evaluate(from)[1] < 0.0 && self.evaluate(to)[1] > 0.0 {
            return value.min(self.evaluate(root(self, 1, from, to))[0]);
        }
        value
    }
}

/// A cell, and `cos ωt` and `sin(ωt)/ω` of the modes that are slow in it, in its middle.
#[derive(Debug, Default)]
pub(crate) struct Turned {
    middle: f64,
    r: f64,
    slow: Vec<(f64, f64)>,
}

/// Bounds for the modes below and from each mode on, one more than modes.
pub(crate) struct Bounds {
    /// Of the third derivative of the modes below.
    third: Vec<f64>,
    /// Of value, slope and curvature of the other modes.
    fast: Vec<[f64; 3]>,
}

impl Guard for Oscillation<'_> {
    type Shared = Turned;
    type Bounds = Bounds;

    fn bounds(&self) -> Option<Bounds> {
        let modes = self.omega.len();
        let (mut third, mut fast) = (vec![0.0; modes + 1], vec![[0.0; 3]; modes + 1]);
        let speed = |k: usize| {
            let pulled = self.d.get(k).map_or(0.0, |d| if *d == 0.0 { 0.0 } else { 2.0 * d.abs() / self.omega[k] });
            (self.omega[k] * self.a[k]).hypot(self.b[k]) + pulled
        };
        let speeds: Vec<f64> = (0..modes).map(speed).collect();
        for (k, speed) in speeds.iter().enumerate() {
            third[k + 1] = third[k] + if self.omega[k] > 0.0 { self.lambda[k] * speed } else { 0.0 };
        }
        for (k, speed) in speeds.iter().enumerate().rev() {
            let [value, slope, curvature] = fast[k + 1];
            fast[k] = [value + speed / self.omega[k], slope + speed, curvature + speed * self.omega[k]];
        }
        third[modes].is_finite().then_some(Bounds { third, fast })
    }

    /// A mode is slow as long as the bound of what its Taylor polynomial leaves, `(ωr)³/6` of its amplitude, is no more
    /// than the amplitude.
    fn share(&self, middle: f64, r: f64, shared: &mut Turned) {
        let slow = self.omega.partition_point(|omega| (omega * r).powi(3) <= 6.0);
        (shared.middle, shared.r) = (middle, r);
        shared.slow.clear();
        shared.slow.extend(self.omega[..slow].iter().map(|omega| cosine_and_sine(*omega, middle)));
    }

    /// The Taylor polynomial of the slow modes; of the others no more is known than how far they can go.
    fn approximate(&self, bounds: &Bounds, cell: &Turned) -> Approximation {
        let slow = cell.slow.len();
        let polynomial = self.sum(cell.middle, cell.slow.iter().copied());
        let mut within = Approximation::taylor(polynomial, bounds.third[slow], cell.r);
        within.differences.iter_mut().zip(bounds.fast[slow]).for_each(|(difference, fast)| *difference += fast);
        within
    }

    fn evaluate(&self, t: f64) -> [f64; 3] {
        self.evaluate(t)
    }

    fn size(&self) -> f64 {
        self.size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::first_root::{first_negative, lowest_of_convex};
    use std::f64::consts::PI;

    fn first(lambda: &[f64], a: &[f64], b: &[f64], constant: f64, end: f64) -> Option<f64> {
        let omega: Vec<f64> = lambda.iter().map(|λ| λ.sqrt()).collect();
        let (a, b) = (a.to_vec(), b.to_vec());
        let guard = Oscillation { lambda, omega: &omega, a, b, d: Vec::new(), constant };
        first_negative(&[guard], end).map(|(t, _)| t)
    }

    #[test]
    fn the_first_root_of_a_cosine_is_found_over_many_periods() {
        let root = first(&[4.0], &[1.0], &[0.0], 0.5, 1000.0).unwrap();
        assert!((root - PI / 3.0).abs() < 1e-15);
        assert_eq!(first(&[4.0], &[1.0], &[0.0], 1.0 + 1e-12, 1000.0), None);
    }

    #[test]
    fn two_roots_that_nearly_meet_are_found_and_a_graze_is_not() {
        // 1 − δ + cos t is negative for 2 √(2δ) about π.
        for δ in [1e-2, 1e-6, 1e-12, 1e-14] {
            let root = first(&[1.0], &[1.0], &[0.0], 1.0 - δ, 2.0 * PI).unwrap();
            assert!((PI - root) / (2.0 * δ).sqrt() - 1.0 < 0.1 && root < PI, "{δ:e}: {root}");
            assert_eq!(first(&[1.0], &[1.0], &[0.0], 1.0 + δ, 2.0 * PI), None, "{δ:e}");
        }
    }

    #[test]
    fn the_root_at_the_start_does_not_count_unless_the_function_falls_there() {
        // sin t leaves zero upwards, −sin t downwards, 1 − cos t touches.
        assert!((first(&[1.0], &[0.0], &[1.0], 0.0, 10.0).unwrap() - PI).abs() < 1e-15);
        assert!(first(&[1.0], &[0.0], &[-1.0], 0.0, 10.0).unwrap() < 1e-15);
        assert_eq!(first(&[1.0], &[-1.0], &[0.0], 1.0, 6.0), None);
    }

    /// Convex and concave cells, drifts, grazing and two modes: the same root, or none, in any unit.
    #[test]
    fn roots_do_not_depend_on_the_unit_of_the_function() {
        type Case = ([f64; 2], [f64; 2], [f64; 2], f64);
        let cases: [Case; 7] = [
            ([1.0, 4.0], [1.0, 0.0], [0.0; 2], 0.5),
            ([1.0, 4.0], [1.0, 0.0], [0.0; 2], 1.0 - 1e-6),
            ([1.0, 4.0], [1.0, 0.0], [0.0; 2], 1.0 + 1e-6),
            ([0.0, 900.0], [0.0, 0.3], [-1.0, 2.0], 1.5),
            ([1.0, 49.0], [0.3, 0.2], [0.5, -0.7], 0.4),
            ([1.0, 49.0], [0.3, 0.2], [0.5, -0.7], 0.75),
            ([0.01, 1e4], [-0.5, 1e-3], [0.0, 0.1], 0.51),
        ];
        for (lambda, a, b, constant) in cases {
            let expected = first(&lambda, &a, &b, constant, 40.0);
            for unit in [1e-9, 1e-3, 1e6] {
                let found = first(&lambda, &a.map(|a| a * unit), &b.map(|b| b * unit), constant * unit, 40.0);
                assert_eq!(found.is_some(), expected.is_some(), "{lambda:?} {constant} in {unit}");
                assert!(found.zip(expected).is_none_or(|(f, e)| (f - e).abs() < 1e-9), "{found:?} {expected:?}");
            }
            // Nothing before it is below zero.
            let f = |t: f64| {
                let terms = (0..2).map(|k| {
                    let (cos, sin) = cosine_and_sine(lambda[k].sqrt(), t);
                    a[k] * cos + b[k] * sin
                });
                constant + terms.sum::<f64>()
            };
            let end = expected.unwrap_or(40.0) - 1e-6;
            assert!((0..=20_000).all(|j| f(end * f64::from(j) / 2e4) > -1e-12), "{lambda:?} {constant}");
            assert!(expected.is_none_or(|t| f(t + 1e-6) < 0.0));
        }
    }

    #[test]
    fn what_is_zero_all_the_time_has_no_root() {
        assert_eq!(first(&[1.0, 30.0], &[0.0; 2], &[0.0; 2], 0.0, 1e3), None);
        assert_eq!(first(&[1.0], &[1e-17], &[0.0], 1.0 - 1.0, 1e3), Some(PI / 2.0));
    }

    #[test]
    fn drift_and_oscillation_together() {
        // 2 − t + 0.5 cos 40 t
        let root = first(&[0.0, 1600.0], &[0.0, 0.5], &[-1.0, 0.0], 2.0, 10.0).unwrap();
        let f = |t: f64| 2.0 - t + 0.5 * (40.0 * t).cos();
        assert!(f(root).abs() < 1e-13);
        let earlier = (0..100_000).map(|j| root * (1.0 - 1e-9) * j as f64 / 1e5).map(f);
        assert!(earlier.fold(f64::INFINITY, f64::min) > 0.0);
    }

    /// `1 + 2 t` beside `0.5 cos 3t − 0.7 sin 3t`, with all closed forms.
    fn mixed<'m>(lambda: &'m [f64], omega: &'m [f64]) -> Oscillation<'m> {
        Oscillation { lambda, omega, a: vec![0.4, 0.5], b: vec![2.0, -2.1], d: Vec::new(), constant: 0.6 }
    }

    #[test]
    fn values_slopes_and_integral_of_a_drift_with_an_oscillation_are_those_of_the_closed_form() {
        let (lambda, omega) = ([0.0, 9.0], [0.0, 3.0]);
        let f = mixed(&lambda, &omega);
        for t in [0.0, 0.3, 1.7, 20.0_f64] {
            let (sin, cos) = (3.0 * t).sin_cos();
            let expected = [1.0 + 2.0 * t + 0.5 * cos - 0.7 * sin, 2.0 - 1.5 * sin - 2.1 * cos, -4.5 * cos + 6.3 * sin];
            f.evaluate(t).iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{t}: {a} {b}"));
            let integral = t + t * t + 0.5 * sin / 3.0 - 0.7 * (1.0 - cos) / 3.0;
            assert!((f.integral(t) - integral).abs() < 1e-12 * (1.0 + t * t), "{t}: {}", f.integral(t));
        }
        // The third derivative is 27 √(0.5² + 0.7²) at most, and the oscillation alone goes √(0.5² + 0.7²) far.
        let bounds = f.bounds().unwrap();
        assert!((bounds.third[2] - 27.0 * 0.74_f64.sqrt()).abs() < 1e-12 && bounds.third[1] == 0.0);
        let expected = [1.0, 3.0, 9.0].map(|factor| factor * 0.74_f64.sqrt());
        assert!(bounds.fast[1].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12) && bounds.fast[2] == [0.0; 3]);
        let negated = mixed(&lambda, &omega).negated();
        assert!(negated.evaluate(0.9).iter().zip(f.evaluate(0.9)).all(|(a, b)| (a + b).abs() < 1e-14));
    }

    #[test]
    fn in_each_cell_a_guard_differs_from_its_approximation_by_no_more_than_its_bounds() {
        let lambda = [0.0, 1.0, 30.0, 4e3, 5e5];
        let omega = lambda.map(f64::sqrt);
        let a = vec![0.3, 1.0, -0.2, 0.01, -2e-4];
        let b = vec![-0.1, 0.4, 0.7, 0.9, 0.3];
        let f = Oscillation { lambda: &lambda, omega: &omega, a, b, d: vec![0.0, 0.5, 0.0, 3.0, 0.0], constant: 0.2 };
        let bounds = f.bounds().unwrap();
        let mut cell = Turned::default();
        for (middle, r) in [(5.0, 5.0), (0.3, 1.7), (2.0, 0.3), (7.7, 0.02), (1.1, 1e-3)] {
            f.share(middle, r, &mut cell);
            let Approximation { polynomial: [value, slope, curvature], differences } = f.approximate(&bounds, &cell);
            let mut largest = [0.0_f64; 3];
            for s in (-500..=500).map(|j| r * f64::from(j) / 500.0) {
                let polynomial = [value + slope * s + 0.5 * curvature * s * s, slope + curvature * s, curvature];
                let at = f.evaluate(middle + s);
                (0..3).for_each(|i| largest[i] = largest[i].max((at[i] - polynomial[i]).abs()));
            }
            assert!(
                largest.iter().zip(differences).all(|(found, bound)| *found <= bound),
                "{r}: {largest:?} {differences:?}"
            );
        }
    }

    #[test]
    fn the_lowest_value_is_at_an_end_or_where_the_slope_rises_through_zero() {
        let omega = [2.0];
        let of = |a: f64, b: f64| {
            let (a, b) = (vec![a], vec![b]);
            Oscillation { lambda: &[4.0], omega: &omega, a, b, d: Vec::new(), constant: 0.25 }
        };
        // cos 2t up to its minimum, at π/2, and before.
        for (end, expected) in [(0.5, 1.0_f64.cos()), (1.5, 3.0_f64.cos()), (1.6, -1.0), (40.0, -1.0)] {
            assert!((of(1.0, 0.0).lowest(end) - 0.25 - expected).abs() < 1e-12, "{end}: {}", of(1.0, 0.0).lowest(end));
        }
        // sin 2t has its minimum at the beginning unless the interval is long enough.
        for (end, expected) in [(1.5, 0.0), (1.7, 3.4_f64.sin()), (2.5, -1.0)] {
            assert!((of(0.0, 2.0).lowest(end) - 0.25 - expected).abs() < 1e-12, "{end}");
        }
        let f = of(1.0, 0.0);
        let half = 0.5 * PI;
        assert_eq!(lowest_of_convex(&f, 1.7, 2.0), 1.7);
        assert_eq!(lowest_of_convex(&f, 1.2, 1.4), 1.4);
        assert!((lowest_of_convex(&f, 1.2, 2.0) - half).abs() < 1e-14);
    }
}
