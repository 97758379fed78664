//! Laws of force in motions in time: the order of their steps, periods in closed form, and laws that are the springs,
//! dampers and elastic stops of a linear structure.

use std::f64::consts::PI;
use std::sync::Arc;

use nlmodes_linalg::Mat;
use nlmodes_timestep::{ForcedStructure, LawSettings, TimeLaw, TimestepError, Touch, TransientSettings};

/// `F = k v + κ v³ + c v̇`.
#[derive(Debug)]
struct Smooth {
    k: f64,
    cubic: f64,
    c: f64,
}

impl TimeLaw for Smooth {
    fn at(&self, v: f64, rate: f64) -> [f64; 3] {
        let Self { k, cubic, c } = self;
        [k * v + cubic * v.powi(3) + c * rate, k + 3.0 * cubic * v * v, *c]
    }
}

/// `F = k ⟨v − g⟩ⁿ`.
#[derive(Debug)]
struct Stop {
    k: f64,
    exponent: f64,
    gap: f64,
}

impl TimeLaw for Stop {
    fn at(&self, v: f64, _: f64) -> [f64; 3] {
        let approach = v - self.gap;
        if approach <= 0.0 {
            return [0.0; 3];
        }
        let slope = self.k * approach.powf(self.exponent - 1.0);
        [slope * approach, self.exponent * slope, 0.0]
    }

    fn stop_gap(&self) -> Option<f64> {
        Some(self.gap)
    }
}

/// Modes without contacts.
fn free(omega_squared: &[f64]) -> ForcedStructure {
    let m = omega_squared.len();
    ForcedStructure::new(omega_squared, &Mat::zeros(m, m), &Mat::zeros(0, m), &Mat::zeros(0, 0), &[]).unwrap()
}

/// State at the end, and touches.
fn moved(structure: &ForcedStructure, state: &[f64], duration: f64) -> (Vec<f64>, Vec<Touch>) {
    let mut touches = Vec::new();
    let settings = TransientSettings { duration, signals: &[], blows: &[] };
    let end = structure.transient(state, &settings, &mut |_, _| true, &mut |touch| touches.push(touch)).unwrap();
    (end, touches)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()))
}

/// `ẍ + x + κ x³ = 0` from rest at A: `T = 4 K(m)/√(1 + κA²)`, `m = κA²/(2(1 + κA²))`.
#[test]
fn duffings_oscillator_returns_after_its_period_with_the_order_of_the_steps() {
    let (cubic, amplitude) = (2.0, 1.5_f64);
    let stiff = 1.0 + cubic * amplitude * amplitude;
    let (mut a, mut g) = (1.0, (1.0 - cubic * amplitude * amplitude / (2.0 * stiff)).sqrt());
    for _ in 0..30 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    let period = 2.0 * PI / (a * stiff.sqrt());
    let mut structure = free(&[1.0]);
    structure.push_law(Arc::new(Smooth { k: 0.0, cubic, c: 0.0 }), &[1.0], &[], &[0.0]).unwrap();
    let off = |structure: &ForcedStructure, periods: f64| {
        distance(&moved(structure, &[amplitude, 0.0], periods * period).0, &[amplitude, 0.0])
    };
    assert!(off(&structure, 10.0) < 1e-9, "{:e}", off(&structure, 10.0));
    // After a time by which no error cancels another, beside short steps.
    let with = |steps: f64| {
        let duration = 4.0 / 3.0 * period;
        let settings = LawSettings { step: Some(duration / steps), ..LawSettings::default() };
        let mut structure = structure.clone();
        structure.set_law_settings(settings).unwrap();
        moved(&structure, &[amplitude, 0.0], duration).0
    };
    let exact = with(48.0);
    // Errors scatter with the phases that the steps meet: the order is that over three times as many of them.
    let errors = [8.0, 24.0].map(|steps: f64| distance(&with(steps), &exact));
    let order = (errors[0] / errors[1]).ln() / 3.0_f64.ln();
    assert!(order > 11.0 && order < 14.0, "{order}: {errors:?}");
    assert!(structure.set_law_settings(LawSettings { tolerance: 0.0, step: None }).is_err());
}

/// One mass before a Hertz stop: period, duration of the touch and approach from the energy.
#[test]
fn a_mass_returns_from_a_hertz_stop_after_the_period_of_a_quadrature() {
    let (k, gap, energy) = (30.0, 0.5, 0.6_f64);
    let mut structure = free(&[1.0]);
    structure.push_law(Arc::new(Stop { k, exponent: 1.5, gap }), &[1.0], &[], &[0.0]).unwrap();
    let potential = |x: f64| 0.5 * x * x + k * (x - gap).max(0.0).powf(2.5) / 2.5;
    let (mut low, mut high) = (gap, 2.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if potential(middle) < energy { low = middle } else { high = middle }
    }
    // Half of the touch: from the turning point to the gap, x = turn − d u².
    let (turn, count) = (0.5 * (low + high), 200_000);
    let part = |j: usize| {
        let (d, u) = (turn - gap, (j as f64 + 0.5) / count as f64);
        2.0 * d * u / (2.0 * (energy - potential(turn - d * u * u))).sqrt()
    };
    let half = (0..count).map(part).sum::<f64>() / count as f64;
    let left = (2.0 * energy).sqrt();
    let period = 2.0 * (half + 0.5 * PI + (gap / left).asin());
    let (end, touches) = moved(&structure, &[-left, 0.0], 3.0 * period);
    assert!(distance(&end, &[-left, 0.0]) < 2e-8, "{end:?}");
    assert_eq!(touches.len(), 3);
    for (i, touch) in touches.iter().enumerate() {
        let instant = period * (i as f64 + 0.5) - half;
        assert_eq!(touch.contact, 0);
        assert!((touch.instant - instant).abs() < 2e-8 && (touch.duration - 2.0 * half).abs() < 2e-8, "{touch:?}");
        assert!((touch.approach - (2.0 * energy - gap * gap).sqrt()).abs() < 1e-8, "{touch:?}");
        assert!(touch.impulse > 2.0 * touch.approach - 2.0 * half * turn && touch.impulse < 2.0 * touch.approach);
    }
}

/// Two modes before an elastic stop, which is exact, and before the law that is the same stop, with what the modes
/// leave over of the flexibility.
#[test]
fn a_stop_with_the_exponent_one_is_an_elastic_stop() {
    let (squares, row, flexible, k, gap) = ([1.0, 9.0], [0.8, -1.1], 0.03, 12.0, 0.2);
    let damping = Mat::from_fn(2, 2, |i, j| if i == j { 0.02 } else { 0.0 });
    let rows = Mat::from_fn(1, 2, |_, j| -row[j]);
    let compliance = Mat::from_fn(1, 1, |_, _| flexible + 1.0 / k);
    let exact = ForcedStructure::new(&squares, &damping, &rows, &compliance, &[gap]).unwrap();
    let mut structure = ForcedStructure::new(&squares, &damping, &Mat::zeros(0, 2), &Mat::zeros(0, 0), &[]).unwrap();
    structure.push_law(Arc::new(Stop { k, exponent: 1.0, gap }), &row, &[], &[flexible]).unwrap();
    let state = [0.1, 0.2, 1.0, -0.7];
    let ((expected, contacts), (end, touches)) = (moved(&exact, &state, 40.0), moved(&structure, &state, 40.0));
    assert!(distance(&end, &expected) < 1e-8, "{end:?} {expected:?}");
    assert!(touches.len() > 5 && touches.len() == contacts.len(), "{} {}", touches.len(), contacts.len());
    for (touch, contact) in touches.iter().zip(&contacts) {
        let pairs = [
            (touch.instant, contact.instant),
            (touch.duration, contact.duration),
            (touch.impulse, contact.impulse),
            (touch.approach, contact.approach),
        ];
        assert!(pairs.iter().all(|(a, b)| (a - b).abs() < 1e-7), "{touch:?} {contact:?}");
    }
}

/// Beside a rigid stop: a linear spring and a damper as laws, and the structure that has both.
#[test]
fn linear_laws_beside_a_rigid_stop_are_those_of_the_structure() {
    let (k, c, row) = (1.7, 0.3, 0.9);
    let build = |square: f64, damping: f64| {
        let [one, rows, flexibility] = [damping, -1.0, 0.004].map(|v| Mat::from_fn(1, 1, |_, _| v));
        ForcedStructure::new(&[square], &one, &rows, &flexibility, &[0.3]).unwrap()
    };
    let exact = build(2.0 + k * row * row, 0.01 + c * row * row);
    let mut structure = build(2.0, 0.01);
    structure.push_law(Arc::new(Smooth { k: 0.5 * k, cubic: 0.0, c }), &[row], &[0.0], &[0.0]).unwrap();
    structure.push_law(Arc::new(Smooth { k: 0.5 * k, cubic: 0.0, c: 0.0 }), &[row], &[0.0], &[0.0, 0.0]).unwrap();
    let (expected, contacts) = moved(&exact, &[-1.0, 2.0], 15.0);
    let (end, touches) = moved(&structure, &[-1.0, 2.0], 15.0);
    assert!(distance(&end, &expected) < 1e-9, "{end:?} {expected:?}");
    assert!(touches.len() > 2 && touches.len() == contacts.len());
    assert!(touches.iter().zip(&contacts).all(|(a, b)| (a.instant - b.instant).abs() < 1e-9));
}

/// A force that jumps is fulfilled by no polynomial.
#[test]
fn a_law_that_jumps_is_refused_where_it_does() {
    #[derive(Debug)]
    struct Dry;
    impl TimeLaw for Dry {
        fn at(&self, _: f64, rate: f64) -> [f64; 3] {
            [rate.signum(), 0.0, 0.0]
        }
    }
    let mut structure = free(&[1.0]);
    structure.push_law(Arc::new(Dry), &[1.0], &[], &[0.0]).unwrap();
    let settings = TransientSettings { duration: 10.0, signals: &[], blows: &[] };
    let found = structure.transient(&[3.0, 0.0], &settings, &mut |_, _| true, &mut |_| ());
    assert!(matches!(found, Err(TimestepError::LawStep { .. })), "{found:?}");
}
