//! How far and under what force a contact slides in a motion that was computed without friction.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

/// A span of phases in which a contact is closed, with its force `λ(τ) = Re Σ_n force_n e^{inτ}`.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedSpan {
    /// Phase at which it begins, rad.
    pub from: f64,
    /// Phase at which it ends, rad.
    pub to: f64,
    /// Complex amplitudes of the force, harmonic by harmonic, N.
    pub force: Vec<Complex64>,
}

/// Sliding of a contact in a motion that was computed without friction.
///
/// ```text
/// wear_work_rate = 1/T ∮ λ |v_t| dt ,   path = ∫_closed |v_t| dt ,   friction_power = μ wear_work_rate
/// ```
///
/// `λ` is the contact force, `v_t` the velocity within the plane of the contact, relative to the wall or to the node
/// that is touched, and `T` the period of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sliding {
    /// Mean of the contact force times the sliding speed, W: a coefficient of friction makes it a power, one of wear a
    /// rate of wear.
    pub wear_work_rate: f64,
    /// Path that it slides while closed, m a period.
    pub path: f64,
    /// Power that friction with the coefficient of the contact would take out of this motion, W; none where no
    /// coefficient is given.
    pub friction_power: Option<f64>,
}

/// Largest relative error of both integrals.
const ACCURACY: f64 = 1e-7;
/// A cell of the quadrature is not halved more often than this.
const HALVINGS: usize = 40;

impl Sliding {
    /// Of a contact that is closed in these spans of a period and whose tangential displacements are
    /// `u(τ) = Re Σ_n u_n e^{inτ}` (m, one series for each direction, which are orthogonal) in a motion of angular
    /// frequency `omega` (rad/s).
    ///
    /// Both integrals are correct to 1e-7 of their values, also where the speed turns at zero.
    pub fn of(spans: &[ClosedSpan], tangential: &[Vec<Complex64>], omega: f64) -> Self {
        let slopes: Vec<Vec<Complex64>> = tangential.iter().map(|u| slope(u)).collect();
        let cells: Vec<(&ClosedSpan, [f64; 2])> =
            spans.iter().flat_map(|span| cells(span, &slopes).map(move |cell| (span, cell))).collect();
        let value = |span: &ClosedSpan, tau: f64| {
            let speed = slopes.iter().map(|slope| evaluate(slope, tau).powi(2)).sum::<f64>().sqrt();
            [evaluate(&span.force, tau).max(0.0) * speed, speed]
        };
        let [work, path] = integrals(&cells, value);
        Self { wear_work_rate: work * omega / TAU, path, friction_power: None }
    }

    /// The same with the power that friction with this coefficient would take.
    pub fn with_friction(self, coefficient: Option<f64>) -> Self {
        Self { friction_power: coefficient.map(|mu| mu * self.wear_work_rate), ..self }
    }
}

/// The derivative of a series by its phase.
fn slope(z: &[Complex64]) -> Vec<Complex64> {
    z.iter().enumerate().map(|(n, z)| Complex64::new(0.0, n as f64) * z).collect()
}

/// `Re Σ z_n e^{inτ}`, by Horner's scheme.
fn evaluate(z: &[Complex64], tau: f64) -> f64 {
    let turn = Complex64::cis(tau);
    z.iter().rev().fold(Complex64::default(), |sum, z| sum * turn + z).re
}

/// Cells of a span that are no longer than half of the shortest wave in it.
fn cells(span: &ClosedSpan, slopes: &[Vec<Complex64>]) -> impl Iterator<Item = [f64; 2]> + use<> {
    let harmonics = slopes.iter().chain([&span.force]).map(Vec::len).max().unwrap_or(0);
    let (from, width) = (span.from, (span.to - span.from).max(0.0));
    let count = 1 + (harmonics as f64 * width / PI).ceil() as usize;
    (0..count).map(move |k| [k, k + 1].map(|k| from + width * k as f64 / count as f64))
}

/// Integrals of two functions that are nowhere negative over all cells: each is halved until that changes nothing.
fn integrals<S: Copy>(cells: &[(S, [f64; 2])], value: impl Fn(S, f64) -> [f64; 2]) -> [f64; 2] {
    let rule = |(span, ends): (S, [f64; 2])| five_points(ends, |tau| value(span, tau));
    let first: Vec<[f64; 2]> = cells.iter().map(|cell| rule(*cell)).collect();
    let size = first.iter().fold([0.0; 2], |sum, part| plus(sum, *part));
    // A cell with a zero of the speed is halved some 15 times, the others once.
    let allowed = size.map(|size| ACCURACY * size / (16 * cells.len()).max(1) as f64);
    let mut open: Vec<_> = cells.iter().zip(first).map(|(cell, whole)| (*cell, whole, 0)).collect();
    let mut sum = [0.0; 2];
    while let Some(((span, [from, to]), whole, depth)) = open.pop() {
        let middle = 0.5 * (from + to);
        let halves = [[from, middle], [middle, to]].map(|ends| ((span, ends), rule((span, ends))));
        let both = plus(halves[0].1, halves[1].1);
        if depth == HALVINGS || (0..2).all(|k| (both[k] - whole[k]).abs() <= allowed[k]) {
            sum = plus(sum, both);
        } else {
            open.extend(halves.map(|(cell, part)| (cell, part, depth + 1)));
        }
    }
    sum
}

fn plus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Gauss-Legendre quadrature with five points.
fn five_points([from, to]: [f64; 2], value: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let root = 2.0 * (10.0_f64 / 7.0).sqrt();
    let points = [(5.0 - root).sqrt() / 3.0, (5.0 + root).sqrt() / 3.0];
    let wide = 13.0 * 70.0_f64.sqrt();
    let weights = [(322.0 + wide) / 900.0, (322.0 - wide) / 900.0];
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut sum = value(middle).map(|f| 128.0 / 225.0 * f);
    for (x, w) in points.into_iter().zip(weights) {
        for side in [-1.0, 1.0] {
            sum = plus(sum, value(middle + side * x * half).map(|f| w * f));
        }
    }
    sum.map(|sum| half * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(from: f64, to: f64, force: &[f64]) -> ClosedSpan {
        ClosedSpan { from, to, force: force.iter().map(|f| Complex64::from(*f)).collect() }
    }

    fn cosine(amplitude: f64, harmonic: usize, lag: f64) -> Vec<Complex64> {
        let mut z = vec![Complex64::default(); harmonic + 1];
        z[harmonic] = amplitude * Complex64::cis(-lag);
        z
    }

    fn check(found: Sliding, rate: f64, path: f64) {
        let close = |a: f64, b: f64| (a - b).abs() <= ACCURACY * b.abs();
        assert!(close(found.wear_work_rate, rate), "{} of {rate}", found.wear_work_rate);
        assert!(close(found.path, path), "{} of {path}", found.path);
    }

    /// Pressed by a constant force: `λ a ω 2/π` whatever the phase, and four amplitudes a period.
    #[test]
    fn a_body_that_is_pressed_and_oscillates_works_two_over_pi_of_its_largest_power() {
        let (force, a, omega) = (7.0, 2e-4, 300.0);
        for (harmonic, lag) in [(1, 0.0), (1, 0.7), (3, 0.2)] {
            let found = Sliding::of(&[span(0.0, TAU, &[force])], &[cosine(a, harmonic, lag)], omega);
            check(found, force * a * omega * harmonic as f64 * 2.0 / PI, 4.0 * a * harmonic as f64);
        }
        // A place that does not oscillate but stays away does not slide.
        assert_eq!(Sliding::of(&[span(0.0, TAU, &[force])], &[cosine(a, 0, 0.0)], omega).path, 0.0);
    }

    /// A circle is run through with constant speed; on an ellipse with the semi-axes 1 and 1/2 the path is
    /// `4 E(√3/2)`, tabulated.
    #[test]
    fn both_tangential_directions_make_one_path() {
        let circle = [cosine(0.3, 1, 0.0), cosine(0.3, 1, 0.5 * PI)];
        check(Sliding::of(&[span(0.0, TAU, &[2.0])], &circle, 5.0), 2.0 * 0.3 * 5.0, TAU * 0.3);
        let ellipse = [cosine(1.0, 1, 0.4), cosine(0.5, 1, 0.4 + 0.5 * PI)];
        let around = 4.844_224_110_273_838;
        check(Sliding::of(&[span(0.0, TAU, &[2.0])], &ellipse, 1.0), 2.0 * around / TAU, around);
    }

    /// Closed for half of the period with the force `F cos τ`: in quadrature with the speed or in phase.
    #[test]
    fn only_what_slides_while_it_presses_counts() {
        let half = [span(-0.5 * PI, 0.5 * PI, &[0.0, 4.0])];
        let in_phase = Sliding::of(&half, &[cosine(0.1, 1, 0.5 * PI)], 3.0);
        check(in_phase, 4.0 * 0.1 * 3.0 / 4.0, 0.2);
        let in_quadrature = Sliding::of(&half, &[cosine(0.1, 1, 0.0)], 3.0);
        check(in_quadrature, 4.0 * 0.1 * 3.0 / TAU, 0.2);
        // The same in two spans, one of them beyond the end of the period.
        let parts = [span(0.0, 0.5 * PI, &[0.0, 4.0]), span(1.5 * PI, TAU, &[0.0, 4.0])];
        check(Sliding::of(&parts, &[cosine(0.1, 1, 0.0)], 3.0), 4.0 * 0.1 * 3.0 / TAU, 0.2);
        let open = Sliding::of(&[], &[cosine(0.1, 1, 0.0)], 3.0).with_friction(Some(0.3));
        assert_eq!((open.wear_work_rate, open.path, open.friction_power), (0.0, 0.0, Some(0.0)));
    }

    /// Of a motion of many harmonics, against a million midpoints.
    #[test]
    fn many_harmonics_are_integrated_as_well_as_one() {
        let (h, omega) = (25, 90.0);
        let motion = |seed: f64| -> Vec<Complex64> {
            (0..=h).map(|n| Complex64::from_polar(1.0 / (1.0 + n as f64).powf(1.5), seed * (n * n) as f64)).collect()
        };
        let force = motion(0.37).into_iter().enumerate().map(|(n, z)| if n == 0 { 3.0.into() } else { z }).collect();
        let spans = [ClosedSpan { from: 0.4, to: 2.9, force }];
        let tangential = [motion(0.61), motion(0.23)];
        let found = Sliding::of(&spans, &tangential, omega);
        let count = 1_000_000;
        let (mut work, mut path, width) = (0.0, 0.0, 2.5 / f64::from(count));
        for k in 0..count {
            let tau = 0.4 + width * (f64::from(k) + 0.5);
            let speed = tangential.iter().map(|u| evaluate(&slope(u), tau).powi(2)).sum::<f64>().sqrt();
            (work, path) = (work + width * evaluate(&spans[0].force, tau) * speed, path + width * speed);
        }
        check(found, work * omega / TAU, path);
        assert_eq!(found.with_friction(Some(0.5)).friction_power, Some(0.5 * found.wear_work_rate));
    }
}
