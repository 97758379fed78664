//! Motions under any loads: closed forms, invariants, an integration by small steps, and periodic motions.

use std::f64::consts::{PI, TAU};

use nlmodes_linalg::Mat;
use nlmodes_timestep::{
    Blow, DEGREE, Flash, ForcedStructure, Signal, SignalPiece, TimestepError, Touch, TransientSettings,
};
use num_complex::Complex64;

/// `a cos(ω t + phase)` in pieces of a twentieth of a radian: what a Taylor polynomial leaves over is 1e-15.
struct Turning(f64, f64, f64);

impl Signal for Turning {
    fn piece(&self, from: f64) -> SignalPiece {
        let &Turning(a, omega, phase) = self;
        let mut coefficients = [0.0; DEGREE + 1];
        let mut factor = a;
        for (k, c) in coefficients.iter_mut().enumerate() {
            *c = factor * (omega * from + phase + 0.5 * PI * k as f64).cos();
            factor *= omega / (k + 1) as f64;
        }
        SignalPiece { coefficients, until: from + 0.05 / omega, continues: true }
    }
}

/// Straight lines between points, constant behind the last.
struct Lines(Vec<(f64, f64)>);

impl Signal for Lines {
    fn piece(&self, from: f64) -> SignalPiece {
        let next = self.0.partition_point(|(t, _)| *t <= from);
        let Some(&(until, value)) = self.0.get(next) else {
            return SignalPiece::constant(self.0[next - 1].1, f64::INFINITY);
        };
        let (begin, first) = self.0[next - 1];
        let slope = (value - first) / (until - begin);
        let mut piece = SignalPiece::constant(first + slope * (from - begin), until);
        piece.coefficients[1] = slope;
        piece
    }
}

fn matrix<const N: usize>(of: [[f64; N]; N]) -> Mat<f64> {
    Mat::from_fn(N, N, |i, j| of[i][j])
}

/// State at the end, and touches.
fn moved(
    structure: &ForcedStructure,
    state: &[f64],
    duration: f64,
    signals: &[&dyn Signal],
    blows: &[Blow],
) -> (Vec<f64>, Vec<Touch>) {
    let mut touches = Vec::new();
    let settings = TransientSettings { duration, signals, blows };
    let end = structure.transient(state, &settings, &mut |_, _| true, &mut |touch| touches.push(touch)).unwrap();
    (end, touches)
}

/// A mass of 1 on a spring of 1 before a stop, with a flexibility between them.
fn oscillator(gap: f64, flexibility: f64, damping: f64) -> ForcedStructure {
    let [one, row] = [[[damping]], [[-1.0]]].map(matrix);
    ForcedStructure::new(&[1.0], &one, &row, &matrix([[flexibility]]), &[gap]).unwrap()
}

#[test]
fn an_oscillator_rebounds_from_its_stop_as_in_the_closed_form_and_as_from_a_rigid_one_in_the_limit() {
    let (gap, speed) = (0.4_f64, 1.3_f64);
    let mut errors = Vec::new();
    for flexibility in [0.1, 1e-3, 1e-5] {
        let (end, touches) = moved(&oscillator(gap, flexibility, 0.0), &[0.0, speed], 2.0, &[], &[]);
        assert_eq!(touches.len(), 1);
        let touch = touches[0];
        let instant = (gap / speed).asin();
        let approach = speed * instant.cos();
        // Closed: about z₀ at the frequency of both springs, z = z₀ + A cos θ + B sin θ, until it is at the gap again.
        let (omega, middle) = ((1.0 + 1.0 / flexibility).sqrt(), gap / (1.0 + flexibility));
        let (a, b) = (gap - middle, approach / omega);
        let turn = 2.0 * b.atan2(a);
        let duration = turn / omega;
        let swept = middle * duration + (a * turn.sin() + b * (1.0 - turn.cos())) / omega;
        assert!((touch.instant - instant).abs() < 1e-14, "{touch:?}");
        assert!((touch.approach - approach).abs() < 1e-13);
        assert!((touch.duration / duration - 1.0).abs() < 1e-11, "{} {duration}", touch.duration);
        assert!((touch.impulse - (2.0 * approach - swept)).abs() < 1e-12, "{}", touch.impulse);
        // It leaves with the speed it came with.
        let t = 2.0 - instant - duration;
        let expected = [gap * t.cos() - approach * t.sin(), -gap * t.sin() - approach * t.cos()];
        end.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{flexibility}: {a} {b}"));
        errors.push((touch.impulse - 2.0 * approach).abs());
    }
    // The spring of the mass pushes while it is touched: by the gap times the duration, √a of the flexibility.
    assert!(errors[2] < 5e-3 && errors[2] < 0.11 * errors[1], "{errors:?}");
}

#[test]
fn a_uniform_bar_stays_at_the_wall_for_twice_the_time_of_its_waves_and_leaves_as_it_came() {
    // A free bar of length, mass and wave speed 1 flies at the speed 1 against a wall.
    let bar = |modes: usize| {
        let squares: Vec<f64> = (0..=modes).map(|k| (PI * k as f64).powi(2)).collect();
        let rows = Mat::from_fn(1, modes + 1, |_, k| if k == 0 { -1.0 } else { -2.0_f64.sqrt() });
        let left: f64 = 1.0 / 3.0 - (1..=modes).map(|k| 2.0 / squares[k]).sum::<f64>();
        let none = Mat::zeros(modes + 1, modes + 1);
        ForcedStructure::new(&squares, &none, &rows, &matrix([[left]]), &[0.25]).unwrap()
    };
    let mut errors = Vec::new();
    for modes in [10, 20, 40] {
        let mut state = vec![0.0; 2 * (modes + 1)];
        state[modes + 1] = 1.0;
        let (end, touches) = moved(&bar(modes), &state, 4.0, &[], &[]);
        assert!((touches[0].instant - 0.25).abs() < 1e-12 && (touches[0].approach - 1.0).abs() < 1e-12);
        let impulse: f64 = touches.iter().map(|touch| touch.impulse).sum();
        assert!((end[modes + 1] - (1.0 - impulse)).abs() < 1e-11, "the impulse is the change of momentum");
        let last = touches.last().unwrap();
        errors.push([(impulse / 2.0 - 1.0).abs(), (last.instant + last.duration - 2.25).abs()]);
    }
    assert!(errors[2][0] < 0.02 && errors[2][1] < 0.05, "{errors:?}");
    assert!(errors[2][0] < errors[0][0] && errors[2][1] < errors[0][1], "{errors:?}");
}

#[test]
fn a_damped_mode_decays_for_a_thousand_periods_as_in_the_closed_form() {
    let decay = 1e-3;
    let structure = oscillator(10.0, 0.1, 2.0 * decay);
    let (duration, omega) = (1000.0 * TAU, (1.0 - decay * decay).sqrt());
    let (end, touches) = moved(&structure, &[1.0, -decay], duration, &[], &[]);
    assert!(touches.is_empty());
    let (sin, cos) = (omega * duration).sin_cos();
    let factor = (-decay * duration).exp();
    let expected = [factor * cos, factor * (-decay * cos - omega * sin)];
    end.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-11 * factor, "{end:?} {expected:?}"));
}

/// Three modes with two stops, one beside the other.
fn three_modes(damping: f64) -> ForcedStructure {
    let squares = [1.0, 7.3, 60.0_f64];
    let own = Mat::from_fn(3, 3, |i, j| if i == j { 2.0 * damping * squares[i].sqrt() } else { 0.0 });
    let rows = Mat::from_fn(2, 3, |i, k| [[-1.0, 0.6, 0.3], [0.8, 0.7, -0.5]][i][k]);
    ForcedStructure::new(&squares, &own, &rows, &matrix([[0.02, 0.004], [0.004, 0.03]]), &[0.5, 0.3]).unwrap()
}

/// Kinetic and strain energy of three modes, with that of the flexibility of the contacts.
fn energy(x: &[f64]) -> f64 {
    let (squares, rows) = ([1.0, 7.3, 60.0], [[-1.0, 0.6, 0.3], [0.8, 0.7, -0.5]]);
    let y: Vec<f64> = (0..2).map(|i| [0.5, 0.3][i] + (0..3).map(|k| rows[i][k] * x[k]).sum::<f64>()).collect();
    let (a, b, c) = (0.02, 0.004, 0.03);
    let determinant = a * c - b * b;
    let both = [(-c * y[0] + b * y[1]) / determinant, (b * y[0] - a * y[1]) / determinant];
    let candidates = [[0.0, 0.0], [-y[0] / a, 0.0], [0.0, -y[1] / c], both];
    let is_solution = |f: &[f64; 2]| {
        let gaps = [y[0] + a * f[0] + b * f[1], y[1] + b * f[0] + c * f[1]];
        f.iter().all(|f| *f >= 0.0) && gaps.iter().all(|g| *g >= -1e-12)
    };
    let f = candidates.into_iter().find(is_solution).unwrap();
    let contacts = 0.5 * (a * f[0] * f[0] + 2.0 * b * f[0] * f[1] + c * f[1] * f[1]);
    (0..3).map(|k| 0.5 * (x[3 + k] * x[3 + k] + squares[k] * x[k] * x[k])).sum::<f64>() + contacts
}

#[test]
fn energy_stays_to_rounding_over_thousands_of_touches() {
    let state = [0.3, -0.1, 0.05, 0.7, 0.4, -0.3];
    let (end, touches) = moved(&three_modes(0.0), &state, 2000.0, &[], &[]);
    assert!(touches.len() > 800, "{}", touches.len());
    let drift = energy(&end) / energy(&state) - 1.0;
    assert!(drift.abs() < 1e-12, "{drift:e}");
}

#[test]
fn the_same_motion_is_the_same_to_the_last_bit() {
    let mut structure = three_modes(0.01);
    structure.push_input(&[1.0, 0.3, -0.2], &[0.01, 0.0]).unwrap();
    let turning = Turning(0.8, 1.2, 0.3);
    let run = || moved(&structure, &[0.0; 6], 200.0, &[&turning], &[]);
    let (first, second) = (run(), run());
    assert_eq!(first, second);
    assert!(first.1.len() > 20);
}

#[test]
fn a_slow_load_presses_onto_the_stop_as_in_statics() {
    // F = z + λ and 0 = g − z + A λ while it is closed.
    let (gap, flexibility) = (0.4, 0.25);
    let mut structure = oscillator(gap, flexibility, 0.4);
    structure.push_input(&[1.0], &[-0.02]).unwrap();
    structure.push_observed(&[1.0], &[-flexibility], &[0.02]).unwrap();
    let force = 2.0;
    let ramp = Lines(vec![(0.0, 0.0), (5e3, force), (6e3, force)]);
    let settings = TransientSettings { duration: 6e3, signals: &[&ramp], blows: &[] };
    let mut last = [0.0; 2];
    let mut observe = |stretch: &nlmodes_timestep::Stretch<'_>, _| {
        last = [stretch.observed(0).at(stretch.length())[0], stretch.force(0).at(stretch.length())[0]];
        true
    };
    structure.transient(&[0.0, 0.0], &settings, &mut observe, &mut |_| {}).unwrap();
    // The load bends what is beyond the modes by 0.02 for each unit, toward the stop.
    let pressed = (force + 0.02 * force - gap) / (1.0 + flexibility);
    assert!((last[1] - pressed).abs() < 1e-10, "{last:?} {pressed}");
    assert!((last[0] - gap).abs() < 1e-10, "the contact stands at the stop: {last:?}");
}

#[test]
fn a_blow_and_a_jump_of_the_load_do_what_they_do_to_a_free_mode() {
    let mut structure = oscillator(100.0, 0.1, 0.0);
    structure.push_input(&[1.0], &[0.0]).unwrap();
    let jump = Lines(vec![(0.0, 0.0), (1.0, 0.0), (1.0 + 1e-9, 2.0), (9.0, 2.0)]);
    let blow = Blow { instant: 2.5, modal: vec![0.7] };
    let (end, _) = moved(&structure, &[0.0, 0.0], 6.0, &[&jump], &[blow]);
    let expected = [2.0 * (1.0 - 5.0_f64.cos()) + 0.7 * 3.5_f64.sin(), 2.0 * 5.0_f64.sin() + 0.7 * 3.5_f64.cos()];
    end.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-8, "{end:?} {expected:?}"));
}

#[test]
fn a_periodic_motion_with_touches_stays_one_under_its_load_in_time() {
    let mut periodic = three_modes(0.03);
    let (omega, level) = (1.25, 0.4);
    let modal = [1.0, 0.3, -0.2];
    let complex = |of: &[f64]| of.iter().map(|v| Complex64::from(*v)).collect::<Vec<_>>();
    let gaps = [0.01, -0.02];
    periodic.push_load(1, &complex(&modal), &complex(&gaps)).unwrap();
    let settled = periodic.after(level, omega, 400, &[0.0; 6]).unwrap();
    let motion = periodic.periodic(level, omega, 1, &settled).unwrap();
    assert!(motion.touches(0) > 0 && motion.residual < 1e-13);
    let mut transient = three_modes(0.03);
    transient.push_input(&modal, &gaps).unwrap();
    let turning = Turning(level, omega, 0.0);
    let (end, touches) = moved(&transient, &motion.state, 50.0 * motion.period(), &[&turning], &[]);
    assert!(touches.len() >= 50);
    assert!(transient.distance(&end, &motion.state) < 1e-11, "{}", transient.distance(&end, &motion.state));
    // The shown states of a period are those on the way.
    let mut seen = Vec::new();
    let mut look = |Flash { state: x, .. }: Flash<'_>| {
        seen.push(x.to_vec());
        seen.len() < 8
    };
    periodic.flash((level, omega), &motion.state, 4, &mut look).unwrap();
    assert!(periodic.distance(&seen[3], &motion.state) < 1e-12 && periodic.distance(&seen[5], &seen[1]) < 1e-12);
}

/// Rates of three modes by their differential equation, with contact forces of the open and closed contacts.
fn rates(x: &[f64; 6], load: f64, damping: f64) -> [f64; 6] {
    let (squares, rows) = ([1.0, 7.3, 60.0_f64], [[-1.0, 0.6, 0.3], [0.8, 0.7, -0.5]]);
    let y: Vec<f64> = (0..2).map(|i| [0.5, 0.3][i] + (0..3).map(|k| rows[i][k] * x[k]).sum::<f64>()).collect();
    let (a, b, c) = (0.02, 0.004, 0.03);
    let determinant = a * c - b * b;
    let both = [(-c * y[0] + b * y[1]) / determinant, (b * y[0] - a * y[1]) / determinant];
    let f = match () {
        () if both[0] >= 0.0 && both[1] >= 0.0 => both,
        () if y[0] < 0.0 && y[1] - b * y[0] / a >= 0.0 => [-y[0] / a, 0.0],
        () if y[1] < 0.0 && y[0] - b * y[1] / c >= 0.0 => [0.0, -y[1] / c],
        () => [0.0, 0.0],
    };
    let push = [1.0, 0.3, -0.2];
    std::array::from_fn(|i| match i {
        0..3 => x[3 + i],
        _ => {
            let k = i - 3;
            let contact: f64 = (0..2).map(|j| rows[j][k] * f[j]).sum();
            push[k] * load + contact - squares[k] * x[k] - 2.0 * damping * squares[k].sqrt() * x[3 + k]
        }
    })
}

#[test]
fn touches_under_lines_are_those_of_an_integration_by_small_steps() {
    let mut structure = three_modes(0.02);
    structure.push_input(&[1.0, 0.3, -0.2], &[0.0, 0.0]).unwrap();
    let points: Vec<(f64, f64)> =
        (0..=40).map(|k| (0.5 * f64::from(k), [0.0, 5.3, -3.9, 1.4][k as usize % 4])).collect();
    let lines = Lines(points.clone());
    let (end, touches) = moved(&structure, &[0.0; 6], 20.0, &[&lines], &[]);
    assert!(touches.len() > 5, "{}", touches.len());
    let load = |t: f64| {
        let k = ((t / 0.5) as usize).min(39);
        points[k].1 + (points[k + 1].1 - points[k].1) * (t - points[k].0) / 0.5
    };
    let steps = 400_000;
    let h = 20.0 / f64::from(steps);
    let mut x = [0.0; 6];
    let add = |x: &[f64; 6], k: &[f64; 6], h: f64| std::array::from_fn::<f64, 6, _>(|i| x[i] + h * k[i]);
    for j in 0..steps {
        let t = h * f64::from(j);
        let [first, middle, last] = [t, t + 0.5 * h, t + h].map(load);
        let k1 = rates(&x, first, 0.02);
        let k2 = rates(&add(&x, &k1, 0.5 * h), middle, 0.02);
        let k3 = rates(&add(&x, &k2, 0.5 * h), middle, 0.02);
        let k4 = rates(&add(&x, &k3, h), last, 0.02);
        x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    // At a contact instant the steps are of second order.
    end.iter().zip(x).for_each(|(a, b)| assert!((a - b).abs() < 1e-6, "{end:?} {x:?}"));
}

#[test]
fn histories_have_the_rates_and_extremes_of_the_motion() {
    let mut structure = three_modes(0.02);
    structure.push_input(&[1.0, 0.3, -0.2], &[0.01, -0.02]).unwrap();
    structure.push_observed(&[1.0, -0.6, -0.3], &[-0.02, -0.004], &[-0.01]).unwrap();
    let turning = Turning(0.9, 1.1, 0.0);
    let settings = TransientSettings { duration: 60.0, signals: &[&turning], blows: &[] };
    let mut before: Option<(f64, f64)> = None;
    let mut checked = 0;
    let mut observe = |stretch: &nlmodes_timestep::Stretch<'_>, _| {
        let (along, length) = (stretch.observed(0), stretch.length());
        let [first, last] = [along.at(0.0), along.at(length)];
        assert!(before.is_none_or(|(t, q)| (t - stretch.from()).abs() < 1e-12 && (q - first[0]).abs() < 1e-12));
        before = Some((stretch.from() + length, last[0]));
        let at = |share: f64| along.at(share * length);
        let slope = (at(0.5 + 1e-4)[0] - at(0.5 - 1e-4)[0]) / (2e-4 * length);
        if length > 1e-3 {
            assert!((slope - at(0.5)[1]).abs() < 1e-5 * (1.0 + slope.abs()), "{slope} {}", at(0.5)[1]);
            checked += 1;
        }
        let [most, least] = along.extremes();
        (0..=50).for_each(|k| {
            let q = at(0.02 * f64::from(k))[0];
            assert!(q <= most + 1e-12 && q >= least - 1e-12);
        });
        // Not beyond the stop.
        assert!(most < 0.5 + 1e-12, "{most}");
        let impulse: f64 = (0..1000).map(|k| stretch.force(0).at((f64::from(k) + 0.5) / 1e3 * length)[0]).sum();
        assert!((impulse * length / 1e3 - stretch.impulse(0)).abs() < 1e-6);
        true
    };
    structure.transient(&[0.0; 6], &settings, &mut observe, &mut |_| {}).unwrap();
    assert!(checked > 100);
}

#[test]
fn the_disturbance_of_a_motion_grows_by_its_largest_multiplier() {
    let mut structure = three_modes(0.03);
    let complex = |of: &[f64]| of.iter().map(|v| Complex64::from(*v)).collect::<Vec<_>>();
    structure.push_load(1, &complex(&[1.0, 0.3, -0.2]), &[Complex64::ZERO; 2]).unwrap();
    // Without contact the multipliers are those of the modes, of which the lowest decays most slowly.
    let motion = structure.periodic(1e-3, 1.25, 1, &[0.0; 6]).unwrap();
    let d = structure.disturbance(&motion).unwrap();
    let after = |x: &[f64]| structure.after(1e-3, 1.25, 1, x).unwrap();
    let disturbed: Vec<f64> = motion.state.iter().zip(&d).map(|(x, d)| x + 0.01 * d).collect();
    let (end, end_of_motion) = (after(&disturbed), after(&motion.state));
    let left: Vec<f64> = end.iter().zip(&end_of_motion).map(|(a, b)| (a - b) / 0.01).collect();
    let size = |x: &[f64]| (x[0] * x[0] + x[3] * x[3]).sqrt();
    assert!((size(&left) / size(&d) / motion.multipliers[0].norm() - 1.0).abs() < 0.05);
    assert!(left[1].abs() + left[2].abs() < 1e-6 * size(&d));
}

#[test]
fn what_does_not_fit_is_refused() {
    let mut structure = three_modes(0.0);
    structure.push_input(&[1.0, 0.0, 0.0], &[0.0, 0.0]).unwrap();
    let turning = Turning(1.0, 1.0, 0.0);
    let signals: [&dyn Signal; 1] = [&turning];
    let with = |state: &[f64], duration: f64, signals: &[&dyn Signal], blows: &[Blow]| {
        let settings = TransientSettings { duration, signals, blows };
        structure.transient(state, &settings, &mut |_, _| true, &mut |_| {}).unwrap_err()
    };
    assert!(matches!(with(&[0.0; 5], 1.0, &signals, &[]), TimestepError::Dimension { expected: 6, found: 5, .. }));
    assert!(matches!(with(&[0.0; 6], 1.0, &[], &[]), TimestepError::Dimension { expected: 1, found: 0, .. }));
    assert!(matches!(with(&[0.0; 6], 0.0, &signals, &[]), TimestepError::NotPositive { .. }));
    assert!(matches!(with(&[f64::NAN; 6], 1.0, &signals, &[]), TimestepError::NotFinite { .. }));
    let blow = Blow { instant: 0.5, modal: vec![1.0] };
    assert!(matches!(with(&[0.0; 6], 1.0, &signals, &[blow]), TimestepError::Dimension { expected: 3, .. }));
    let settings = TransientSettings { duration: 1.0, signals: &signals, blows: &[] };
    let ended = structure.transient(&[0.0; 6], &settings, &mut |_, _| false, &mut |_| {}).unwrap_err();
    assert_eq!(ended, TimestepError::Ended);
    assert!(
        structure.push_input(&[1.0], &[0.0, 0.0]).is_err()
            && structure.push_observed(&[1.0; 3], &[0.0], &[0.0]).is_err()
    );
}
