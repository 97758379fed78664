//! The loop on made signals and on the averaged equation of a resonance.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use num_complex::Complex64;
use proptest::prelude::*;

use nlmodes_loop::{
    Gains, LoopSettings, LoopState, LowPass, Order, PhaseDetector, PhaseLockedLoop, PhaseLoopError, Resonance,
    ResponseQuantity,
};

const STEP: f64 = 5e-5;
const RESONANCE: Resonance = Resonance { omega: 251.3, damping_ratio: 0.02 };

fn settings() -> LoopSettings {
    LoopSettings::new(RESONANCE, RESONANCE.omega, STEP)
}

/// Phases and lags measured by the loop from `(force, response)` at a fixed frequency, after four seconds.
fn lags(settings: LoopSettings, signals: impl Fn(f64) -> (f64, f64)) -> Vec<(f64, f64)> {
    let pll = PhaseLockedLoop::new(settings).unwrap();
    let mut state = pll.start().hold_frequency(true);
    let mut lags = Vec::new();
    for k in 0..100_000 {
        let theta = state.drive_phase();
        let (force, response) = signals(theta);
        state = pll.step(&state, force, response);
        if k >= 80_000 {
            lags.push((theta, state.lag()));
        }
    }
    lags
}

/// Mean, and amplitudes at θ and 2θ, over 40 periods (leakage below 1e-3 of them).
fn spectrum(lags: &[(f64, f64)]) -> [f64; 3] {
    let n = lags.len() as f64;
    let mean = lags.iter().map(|(_, y)| y).sum::<f64>() / n;
    let part = |order: f64| {
        let (re, im) = lags.iter().fold((0.0, 0.0), |(re, im), (theta, y)| {
            let (sin, cos) = (order * theta).sin_cos();
            (re + (y - mean) * cos, im + (y - mean) * sin)
        });
        2.0 * f64::hypot(re, im) / n
    };
    [mean, part(1.0), part(2.0)]
}

#[test]
fn demodulation_ripples_at_twice_the_frequency_as_predicted() {
    for (order, lag) in [(Order::First, FRAC_PI_2), (Order::First, 0.4), (Order::Second, FRAC_PI_2)] {
        let detector = PhaseDetector::Demodulation { order };
        let settings = LoopSettings { detector, cut_off: 0.02 * RESONANCE.omega, ..settings() };
        let predicted = detector.ripple(settings.cut_off, RESONANCE.omega, lag, STEP);
        let [mean, once, twice] = spectrum(&lags(settings, |theta| (3.0 * theta.cos(), 1e-5 * (theta - lag).cos())));
        // The prediction is of first order in the gain |H(2ω)|, which is 1 % and 1e-4 here.
        assert!((twice / predicted - 1.0).abs() < 5e-3, "{twice} {predicted}");
        assert!((mean - lag).abs() < 2.0 * predicted.powi(2) + 1e-6 && once < 2e-3 * predicted, "{mean} {once}");
        if order == Order::First {
            assert!((predicted / (2.0 * lag.sin() * 0.01) - 1.0).abs() < 1e-3, "{predicted}");
        }
    }
}

#[test]
fn the_adaptive_detector_has_no_ripple_from_mean_values_and_harmonics() {
    let read = lags(settings(), |theta| {
        let force = 3.0 * theta.cos() + 0.7 * (2.0 * theta + 0.3).cos() - 0.2 * (5.0 * theta).sin();
        (force, 1e-5 * (theta - 1.3).cos() + 4e-6 + 3e-6 * (3.0 * theta).cos())
    });
    for (_, lag) in read {
        assert!((lag - 1.3).abs() < 1e-9, "{lag}");
    }
    assert_eq!(settings().detector.ripple(settings().cut_off, RESONANCE.omega, 1.3, STEP), 0.0);
}

/// Amplitudes come in the units of the signals, and the smallest of them have a phase where no other limit is set.
#[test]
fn fundamentals_have_the_size_and_phase_of_the_signals_in_any_unit() {
    for (force, response) in [(3.0, 1e-5), (2e-6, 4e3), (1e-9, 1e-12)] {
        for detector in [PhaseDetector::default(), PhaseDetector::Demodulation { order: Order::Second }] {
            let settings = LoopSettings { detector, ..settings() };
            // What passes at twice the frequency, of each amplitude.
            let passes = detector.ripple(settings.cut_off, RESONANCE.omega, FRAC_PI_2, STEP) / 2.0;
            let pll = PhaseLockedLoop::new(settings).unwrap();
            let mut state = pll.start().hold_frequency(true);
            run(&pll, &mut state, 60_000, |theta| (force * theta.cos(), response * (theta - 1.3).cos()));
            let [f, x] = state.fundamentals();
            assert!((f / force - 1.0).norm() < passes + 1e-9, "{detector:?}: {f} of {force}");
            assert!((x / response - Complex64::cis(-1.3)).norm() < passes + 1e-9, "{detector:?}: {x} of {response}");
            assert!(state.error().is_some_and(|error| (error - (FRAC_PI_2 - 1.3)).abs() < 2.0 * passes + 1e-9));
        }
    }
}

#[test]
fn a_mean_value_makes_demodulation_ripple_at_the_frequency_itself() {
    let settings = LoopSettings { detector: PhaseDetector::Demodulation { order: Order::First }, ..settings() };
    let gain = LowPass { cut_off: settings.cut_off, order: Order::First }.sampled_gain(RESONANCE.omega, STEP);
    let [_, once, _] = spectrum(&lags(settings, |theta| (theta.cos(), (theta - FRAC_PI_2).cos() + 0.1)));
    // 2 y e^{−iθ} of a mean 0.1 is 0.2 e^{−iθ}; it turns the amplitude by up to its size over that of the fundamental.
    // The ripple of 2ω, 5 % here, couples with it to second order.
    assert!((once / (0.2 * gain) - 1.0).abs() < 0.06, "{once} {gain}");
}

/// Runs the loop against `ψ̇ = (ω − ω_b) − δ (ψ − π/2)`, the averaged resonance; returns the lag error at the end of
/// each second.
fn averaged_resonance(
    pll: &PhaseLockedLoop,
    decay_rate: f64,
    omega_b: f64,
    seconds: usize,
    derivatives: u8,
) -> Vec<f64> {
    let (mut state, mut lag, mut errors) = (pll.start(), FRAC_PI_2, Vec::new());
    let per_second = (1.0 / STEP) as usize;
    for k in 0..seconds * per_second {
        let theta = state.drive_phase();
        let response = (theta - lag + FRAC_PI_2 * f64::from(derivatives)).cos();
        state = pll.step(&state, theta.cos(), response);
        lag += STEP * (state.omega() - omega_b - decay_rate * (lag - FRAC_PI_2));
        if k % per_second == per_second - 1 {
            errors.push(lag - FRAC_PI_2);
        }
    }
    errors
}

#[test]
fn the_target_follows_from_what_the_sensor_measures() {
    use ResponseQuantity::{Acceleration, Displacement, Velocity};
    for (quantity, lag) in [(Displacement, FRAC_PI_2), (Velocity, 0.0), (Acceleration, -FRAC_PI_2)] {
        let pll = PhaseLockedLoop::new(LoopSettings { quantity, ..settings() }).unwrap();
        assert_eq!(pll.target_lag(), lag);
        let errors =
            averaged_resonance(&pll, RESONANCE.decay_rate(), RESONANCE.omega + 5.0, 10, quantity.derivatives());
        assert!(errors[9].abs() < 1e-4, "{quantity:?}: {errors:?}");
    }
}

#[test]
fn the_loop_is_stable_up_to_the_limit_of_routh_and_not_beyond() {
    let low_pass = LowPass { cut_off: 12.0, order: Order::First };
    let proportional = 2.0;
    let limit = Gains { proportional, integral: 0.0 }.integral_limit(RESONANCE, low_pass);
    // What lies beyond for the true resonance is let through for one that is thought to be damped more.
    let believed = Resonance { damping_ratio: 2.0 * RESONANCE.damping_ratio, ..RESONANCE };
    for (factor, stable) in [(0.9, true), (1.1, false)] {
        let gains = Some(Gains { proportional, integral: factor * limit });
        let make = |resonance| {
            PhaseLockedLoop::new(LoopSettings { resonance, cut_off: low_pass.cut_off, gains, ..settings() })
        };
        assert_eq!(make(RESONANCE).is_ok(), stable);
        let errors =
            averaged_resonance(&make(believed).unwrap(), RESONANCE.decay_rate(), RESONANCE.omega + 0.01, 12, 0);
        let size = |range: std::ops::Range<usize>| errors[range].iter().fold(0.0f64, |m, e| m.max(e.abs()));
        let grown = size(9..12) / size(0..3);
        assert!(if stable { grown < 0.4 } else { grown > 3.0 }, "{factor}: {grown} {errors:?}");
    }
    let refused = PhaseLockedLoop::new(LoopSettings {
        cut_off: low_pass.cut_off,
        gains: Some(Gains { proportional, integral: 1.1 * limit }),
        ..settings()
    });
    assert_eq!(refused.unwrap_err(), PhaseLoopError::UnstableGains { proportional, integral: 1.1 * limit, limit });
}

fn run(pll: &PhaseLockedLoop, state: &mut LoopState, steps: usize, signals: impl Fn(f64) -> (f64, f64)) {
    for _ in 0..steps {
        let (force, response) = signals(state.drive_phase());
        *state = pll.step(state, force, response);
    }
}

#[test]
fn the_lock_needs_its_time_and_is_lost_with_the_signal() {
    let pll = PhaseLockedLoop::new(LoopSettings { smallest: [1e-3, 1e-9], ..settings() }).unwrap();
    let good = |theta: f64| (theta.cos(), theta.sin());
    let mut state = pll.start();
    run(&pll, &mut state, 9_990, good);
    assert!(!state.is_locked());
    run(&pll, &mut state, 20_000, good); // the detector first has to come up from zero
    assert!(state.is_locked());
    let before = state;
    run(&pll, &mut state, 10, |_| (f64::NAN, 0.0));
    assert!(!state.is_locked() && state.error().is_none() && state.omega() == before.omega());
    run(&pll, &mut state, 20_000, good);
    assert!(state.is_locked());
    run(&pll, &mut state, 40_000, |_| (0.0, 0.0));
    assert!(!state.is_locked());
}

#[test]
fn the_frequency_stays_in_its_range_and_comes_back_at_once() {
    let range = [RESONANCE.omega - 3.0, RESONANCE.omega + 3.0];
    let pll = PhaseLockedLoop::new(LoopSettings { range, ..settings() }).unwrap();
    let mut state = pll.start();
    run(&pll, &mut state, 200_000, |theta| (theta.cos(), theta.cos())); // no lag: wants to go up for ever
    assert!(state.is_at_limit() && state.omega() == range[1]);
    run(&pll, &mut state, 20_000, |theta| (theta.cos(), (theta - 0.9 * PI).cos()));
    assert!(state.omega() < range[1]);
}

#[test]
fn settings_that_cannot_work_are_refused() {
    let refused = |settings| PhaseLockedLoop::new(settings).unwrap_err();
    assert!(matches!(refused(LoopSettings { step: 0.0, ..settings() }), PhaseLoopError::NotPositive { .. }));
    assert!(matches!(
        refused(LoopSettings { step: 5e-3, ..settings() }),
        PhaseLoopError::AboveNyquist { harmonic: 5, .. }
    ));
    // A quarter of the lowest frequency, and a tenth of the sampling rate where that is less.
    let slow = LoopSettings { detector: PhaseDetector::Demodulation { order: Order::First }, step: 5e-3, ..settings() };
    for (settings, most) in [(settings(), 0.125 * RESONANCE.omega), (slow, 20.0)] {
        PhaseLockedLoop::new(LoopSettings { cut_off: 0.999 * most, ..settings.clone() }).unwrap();
        let PhaseLoopError::CutOff { limit, .. } = refused(LoopSettings { cut_off: 1.001 * most, ..settings }) else {
            panic!("{most}")
        };
        assert!((limit / most - 1.0).abs() < 1e-12, "{limit} {most}");
    }
    assert!(matches!(refused(LoopSettings { start: 1e4, ..settings() }), PhaseLoopError::FrequencyRange { .. }));
    let detector = PhaseDetector::Adaptive { harmonics: 9 };
    assert_eq!(refused(LoopSettings { detector, ..settings() }), PhaseLoopError::Harmonics { harmonics: 9, most: 8 });
    let gains = Some(Gains { proportional: 1.0, integral: 0.0 });
    assert!(matches!(refused(LoopSettings { gains, ..settings() }), PhaseLoopError::UnstableGains { .. }));
    let displacement_lag = f64::NAN;
    assert!(matches!(refused(LoopSettings { displacement_lag, ..settings() }), PhaseLoopError::NotFinite { .. }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn no_signal_drives_the_loop_out_of_its_range(
        glitches in prop::collection::vec(
            (0usize..4000, prop::sample::select(vec![1e308, -1e308, 1e12, f64::NAN, f64::INFINITY, 0.0])), 0..30
        ),
        demodulate: bool
    ) {
        let order = Order::Second;
        let detector = if demodulate { PhaseDetector::Demodulation { order } } else { PhaseDetector::default() };
        let pll = PhaseLockedLoop::new(LoopSettings { detector, ..settings() }).unwrap();
        let mut state = pll.start();
        for k in 0..4000 {
            let theta = state.drive_phase();
            let response = glitches.iter().find(|(at, _)| *at == k).map_or(theta.sin(), |(_, value)| *value);
            state = pll.step(&state, theta.cos(), response);
            let [low, high] = pll.settings().range;
            prop_assert!((low..=high).contains(&state.omega()) && (0.0..=TAU).contains(&state.drive_phase()));
        }
        // A glitch decays with the cut-off, 25/s: 1e12 of it in some two seconds, and then the loop has to come back.
        run(&pll, &mut state, 8 * 20_000, |theta| (theta.cos(), theta.sin()));
        prop_assert!(glitches.iter().any(|(_, value)| value.abs() == 1e308) || state.is_locked());
    }
}
