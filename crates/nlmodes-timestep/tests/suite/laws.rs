//! Laws of force in motions in time: the order of their steps, periods in closed form, and laws that are the springs,
//! dampers and elastic stops of a linear structure.

use std::f64::consts::PI;
use std::sync::Arc;

use nlmodes_linalg::Mat;
use nlmodes_timestep::{
    DEGREE, Flash, ForcedStructure, LawSettings, Signal, SignalPiece, TimeLaw, TimestepError, Touch, TransientSettings,
};
use num_complex::Complex64;

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

/// `cos(ω t + phase)` times a level, in pieces of a twentieth of a radian.
struct Turning(f64, f64, f64);

impl Signal for Turning {
    fn piece(&self, from: f64) -> SignalPiece {
        let &Turning(level, omega, phase) = self;
        let mut coefficients = [0.0; DEGREE + 1];
        let mut factor = level;
        for (k, c) in coefficients.iter_mut().enumerate() {
            *c = factor * (omega * from + phase + 0.5 * PI * k as f64).cos();
            factor *= omega / (k + 1) as f64;
        }
        SignalPiece { coefficients, until: from + 0.05 / omega, continues: true }
    }
}

const LOAD: [Complex64; 2] = [Complex64::new(0.5, 0.1), Complex64::new(0.2, -0.3)];
const MOVES_GAP: Complex64 = Complex64::new(0.02, 0.01);
const MOVES_LAWS: [Complex64; 2] = [Complex64::new(0.03, -0.01), Complex64::new(-0.01, 0.02)];

/// Two modes before a stop, with a cubic spring with a damper and a stop with a law, under a periodic load that moves
/// gap and laws beyond the modes; as a load of the structure, or as two inputs, those of its real and imaginary part.
fn under_a_load(is_input: bool) -> ForcedStructure {
    let damping = Mat::from_fn(2, 2, |i, j| [[0.06, 0.01], [0.01, 0.2]][i][j]);
    let rows = Mat::from_fn(1, 2, |_, j| [-1.2, 0.4][j]);
    let compliance = Mat::from_fn(1, 1, |_, _| 0.05);
    let mut structure = ForcedStructure::new(&[1.0, 6.0], &damping, &rows, &compliance, &[0.5]).unwrap();
    let parts: [fn(Complex64) -> f64; 2] = [|z| z.re, |z| -z.im];
    match is_input {
        true => parts.iter().for_each(|of| structure.push_input(&LOAD.map(of), &[of(MOVES_GAP)]).unwrap()),
        false => structure.push_load(1, &LOAD, &[MOVES_GAP]).unwrap(),
    }
    let smooth = Smooth { k: 0.2, cubic: 0.8, c: 0.05 };
    let laws: [Arc<dyn TimeLaw>; 2] = [Arc::new(smooth), Arc::new(Stop { k: 20.0, exponent: 1.5, gap: 0.4 })];
    let (modes, contacts) = ([[0.9, -0.5], [-0.7, 0.6]], [0.02, -0.01]);
    let among = [vec![0.01], vec![0.003, 0.02]];
    for (l, law) in laws.into_iter().enumerate() {
        let moves = MOVES_LAWS[l];
        let by_inputs: Vec<f64> = if is_input { parts.map(|of| of(moves)).to_vec() } else { Vec::new() };
        structure.push_law(law, &modes[l], &[contacts[l]], &[by_inputs, among[l].clone()].concat()).unwrap();
        structure.move_law(if is_input { &[] } else { std::slice::from_ref(&moves) }).unwrap();
    }
    assert!(structure.move_law(&[MOVES_GAP; 2]).is_err());
    structure
}

#[test]
fn laws_under_a_periodic_load_are_those_under_the_same_load_in_time() {
    let (level, omega, state) = (0.9, 0.8, [0.3, -0.2, 0.4, 0.1]);
    let periodic = under_a_load(false).after(level, omega, 3, &state).unwrap();
    let [cos, sin] = [0.0, -0.5 * PI].map(|phase| Turning(level, omega, phase));
    let settings = TransientSettings { duration: 6.0 * PI / omega, signals: &[&cos, &sin], blows: &[] };
    let mut touches = [0, 0];
    let mut count = |touch: Touch| touches[touch.contact] += 1;
    let in_time = under_a_load(true).transient(&state, &settings, &mut |_, _| true, &mut count).unwrap();
    assert!(touches[0] > 1 && touches[1] > 1, "{touches:?}");
    assert!(distance(&periodic, &in_time) < 1e-9, "{periodic:?} {in_time:?}");
}

#[test]
fn a_periodic_motion_with_laws_comes_back_and_its_multipliers_are_those_of_differences() {
    let structure = under_a_load(false);
    for (level, omega) in [(0.9, 0.8), (2.0, 1.3)] {
        let near = structure.after(level, omega, 60, &[0.0; 4]).unwrap();
        let motion = structure.periodic(level, omega, 1, &near).unwrap();
        assert!(motion.touches(0) > 0 && motion.residual < 1e-10, "{} {:e}", motion.touches(0), motion.residual);
        let step = 1e-5;
        let column = |j: usize| {
            let [up, down] = [step, -step].map(|h| {
                let moved: Vec<f64> = (0..4).map(|i| motion.state[i] + if i == j { h } else { 0.0 }).collect();
                structure.after(level, omega, 1, &moved).unwrap()
            });
            (0..4).map(|i| (up[i] - down[i]) / (2.0 * step)).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..4).map(column).collect();
        let jacobian = Mat::from_fn(4, 4, |i, j| columns[j][i]);
        let square = &jacobian * &jacobian;
        let [trace, of_square] = [&jacobian, &square].map(|of| (0..4).map(|i| of[(i, i)]).sum::<f64>());
        let sum = |power: i32| motion.multipliers.iter().map(|z| z.powi(power)).sum::<Complex64>().re;
        assert!((trace - sum(1)).abs() < 1e-6, "{trace} {}", sum(1));
        assert!((of_square - sum(2)).abs() < 1e-6, "{of_square} {}", sum(2));
        // Several states of it, each off by a hundredth, lead to the same motion.
        let mut states = vec![motion.state.iter().map(|v| 1.01 * v).collect::<Vec<f64>>()];
        let mut take = |Flash { state: x, .. }: Flash<'_>| {
            states.push(x.iter().map(|v| 1.01 * v).collect());
            states.len() < 4
        };
        structure.flash((level, omega), &motion.state, 4, &mut take).unwrap();
        let through = structure.periodic_through(level, omega, 1, &states).unwrap();
        assert!(distance(&through.state, &motion.state) < 1e-8, "{:?} {:?}", through.state, motion.state);
    }
}

/// Duffing's oscillator under the load of which `A cn(p t | m)` is the response: `ẍ + 2 ζ ẋ + x + κ x³` with
/// `p² = α + κ A²`, `m = κ A²/(2 p²)` in place of the one. Fourier coefficients of cn by its nome.
#[test]
fn duffings_oscillator_follows_a_load_of_elliptic_functions() {
    let (cubic, amplitude, alpha, ratio) = (0.7, 1.3_f64, 0.6, 0.05);
    let p = (alpha + cubic * amplitude * amplitude).sqrt();
    let m = cubic * amplitude * amplitude / (2.0 * p * p);
    let complete = |m: f64| {
        let (mut a, mut g) = (1.0, (1.0 - m).sqrt());
        for _ in 0..30 {
            (a, g) = (0.5 * (a + g), (a * g).sqrt());
        }
        PI / (2.0 * a)
    };
    let (k, nome) = (complete(m), (-PI * complete(1.0 - m) / complete(m)).exp());
    let omega = PI * p / (2.0 * k);
    let mut structure = free_damped(2.0 * ratio);
    for n in (0..14).map(|j| 2 * j + 1) {
        let q = nome.powf(0.5 * n as f64);
        let x = amplitude * 2.0 * PI / (m.sqrt() * k) * q / (1.0 + q * q);
        // (1 − α) x + 2 ζ ẋ
        let force = Complex64::new(1.0 - alpha, 2.0 * ratio * n as f64 * omega) * x;
        structure.push_load(n, &[force], &[]).unwrap();
    }
    structure.push_law(Arc::new(Smooth { k: 0.0, cubic, c: 0.0 }), &[1.0], &[], &[0.0]).unwrap();
    structure.move_law(&[Complex64::default(); 14]).unwrap();
    let motion = structure.periodic(1.0, omega, 1, &[1.2, 0.1]).unwrap();
    assert!(distance(&motion.state, &[amplitude, 0.0]) < 1e-10, "{:?}", motion.state);
    let product: Complex64 = motion.multipliers.iter().product();
    assert!((product.re / (-2.0 * ratio * motion.period()).exp() - 1.0).abs() < 1e-10, "{product}");
}

/// One mode of 1 rad/s with a damper.
fn free_damped(damping: f64) -> ForcedStructure {
    let one = Mat::from_fn(1, 1, |_, _| damping);
    ForcedStructure::new(&[1.0], &one, &Mat::zeros(0, 1), &Mat::zeros(0, 0), &[]).unwrap()
}
