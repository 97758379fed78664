//! Stops with a law of force: periods from quadrature and from the beta function, Jacobians against differences, power
//! in balance, and a damped, forced motion with its multipliers against integration in time.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use nlmodes_hbm::{
    Coordinates, ForceLaw, HertzStop, Load, LoadTerm, ModalDamping, ModalStructure, ModeStart, PeriodicSystem,
    PhaseLag, PlacedLaw, Polynomial, PowerSpring, ResponseRow, Scales, Symmetry, modal_start,
};
use nlmodes_linalg::Mat;
use nlmodes_model::Side;
use num_complex::Complex64;

use crate::support::modal::{Open, newton, settings, solver, worst_column};
use crate::support::{on_springs, rod};

/// One mass on a spring of this squared frequency, before laws; those that are stops are on the positive side, with
/// a sign on the negative one.
fn oscillator(omega_squared: f64, ratio: f64, laws: &[(f64, Arc<dyn ForceLaw>)]) -> ModalStructure {
    let damping = ModalDamping::ratios(&[omega_squared], &[ratio]);
    let structure =
        ModalStructure::new(vec![omega_squared], Mat::zeros(0, 1), &Mat::zeros(0, 0), vec![], &[], damping).unwrap();
    let of = |(side, law): &(f64, Arc<dyn ForceLaw>)| PlacedLaw {
        law: law.clone(),
        modes: vec![*side],
        contacts: vec![],
        laws: vec![0.0; laws.len()],
    };
    structure.with_laws(laws.iter().map(of).collect(), 1024).unwrap()
}

fn hertz(stiffness: f64, gap: f64, dissipation: f64) -> Arc<dyn ForceLaw> {
    Arc::new(HertzStop { stiffness, exponent: 1.5, gap, dissipation })
}

/// The conservative motion of an oscillator with this energy.
fn mode_at(structure: &ModalStructure, harmonics: usize, energy: f64) -> nlmodes_hbm::PeriodicMotion {
    let start = modal_start(structure, None, 1, ModeStart::Linear).unwrap();
    let settings = settings(harmonics, Coordinates::Automatic);
    let solver = solver();
    let mut system =
        PeriodicSystem::conservative_mode(structure, Symmetry::Even, settings, start.scales(), solver.as_ref())
            .unwrap();
    let (mut x, mut p, steps) = (start.unknowns(&system), 0.0, 40);
    let total = |system: &mut PeriodicSystem, x: &[f64], p: f64| system.motion(x, p).unwrap().total_energy;
    let end = (energy / total(&mut system, &x, 0.0)).ln();
    for j in 1..=steps {
        p = end * f64::from(j) / f64::from(steps);
        (x, _) = newton(&mut system, x, p);
    }
    // The parameter is the logarithm of the kinetic energy: secants to the whole one.
    let mut before = None;
    for _ in 0..20 {
        (x, _) = newton(&mut system, x, p);
        let defect = (total(&mut system, &x, p) / energy).ln();
        if defect.abs() < 1e-13 {
            break;
        }
        let slope = before.map_or(1.0, |(q, last): (f64, f64)| (defect - last) / (p - q));
        before = Some((p, defect));
        p -= defect / slope;
    }
    system.motion(&x, p).unwrap()
}

/// A mass on a spring before one stop: `T = 2 ∫ dx/√(2(E − V))` between the turning points, in `x = m − h cos θ`.
#[test]
fn a_mass_before_a_hertz_stop_has_the_period_of_a_quadrature_in_two_systems_of_units() {
    // Metres and kilograms, and the same in millimetres and tonnes: forces in newton, one mode of unit mass each.
    for (length, mass) in [(1.0, 1.0), (1e3, 1e-3)] {
        let (stiffness, gap) = (30.0, 0.5);
        let (row, k) = (1.0 / f64::sqrt(mass), stiffness * mass * length / f64::powf(length, 1.5));
        let law = hertz(k, gap * length, 0.0);
        let energy = 0.6;
        let structure = oscillator(1.0, 0.0, &[(row, law)]);
        let motion = mode_at(&structure, 60, energy * mass * length * length);
        let potential = |x: f64| 0.5 * x * x + stiffness * (x - gap).max(0.0).powf(2.5) / 2.5;
        let (mut low, mut high) = (gap, 2.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if potential(middle) < energy { low = middle } else { high = middle }
        }
        let (right, left) = (0.5 * (low + high), -(2.0 * energy).sqrt());
        // From each turning point to the gap, where the potential has its kink: x = turn ± d u².
        let from = |turn: f64| -> f64 {
            let (d, count) = (gap - turn, 40000);
            let part = |j: usize| {
                let u = (j as f64 + 0.5) / count as f64;
                2.0 * d.abs() * u / (2.0 * (energy - potential(turn + d * u * u))).sqrt()
            };
            (0..count).map(part).sum::<f64>() / count as f64
        };
        let omega = PI / (from(left) + from(right));
        assert!((motion.at.omega / omega - 1.0).abs() < 1e-7, "{} {omega}", motion.at.omega);
        let contact = motion.contacts[0];
        assert_eq!((motion.contacts.len(), contact.touches), (1, 1));
        assert!((contact.closed_share - from(right) * omega / PI).abs() < 1e-6, "{contact:?}");
        assert!((contact.peak / (right * length) - 1.0).abs() < 1e-6, "{contact:?} {right}");
        let force = stiffness * (right - gap).powf(1.5) * mass * length;
        assert!((contact.peak_force / force - 1.0).abs() < 1e-5, "{contact:?} {force}");
        // At that instant a derivative jumps: what harmonics leave out of the velocity falls with their power 5/2.
        let approach = (2.0 * energy - gap * gap).sqrt() * length;
        assert!((contact.approach / approach - 1.0).abs() < 1e-4, "{contact:?} {approach}");
        // The mean force is that of the spring.
        let spring = -motion.eta[0][0].re / row;
        assert!((contact.mean_force / spring - 1.0).abs() < 1e-9, "{contact:?} {spring}");
    }
}

/// Two stops that touch, so stiff that the spring between them is nothing: `m ẍ = −k |x|ⁿ sgn x`,
/// `T = 4 A/v √(π) Γ(1 + 1/(n+1))/Γ(1/2 + 1/(n+1))`, `v² = 2 k A^{n+1}/((n+1) m)`.
#[test]
fn a_mass_between_two_hertz_stops_that_touch_has_the_period_of_the_beta_function() {
    for (exponent, gammas) in [
        (1.5, 0.887_263_817_503_075_5 / 1.068_628_702_119_319),
        (3.0, 0.906_402_477_055_477_3 / 1.225_416_702_465_177_9),
    ] {
        let stop = HertzStop { stiffness: 1e10, exponent, gap: 0.0, dissipation: 0.0 };
        let structure = oscillator(1.0, 0.0, &[(1.0, Arc::new(stop)), (-1.0, Arc::new(stop))]);
        let speed = (2.0 * 1e10 / (exponent + 1.0_f64)).sqrt();
        let omega = 2.0 * PI * speed / (4.0 * PI.sqrt() * gammas);
        let settings = settings(41, Coordinates::Automatic);
        let scales = Scales::new(1.0, omega, 0.25 * omega * omega);
        let solver = solver();
        let mut system =
            PeriodicSystem::conservative_mode(&structure, Symmetry::Even, settings, scales, solver.as_ref()).unwrap();
        let mut x = vec![0.0; system.n_coefficients()];
        x[1] = 1.0;
        x[system.n_coefficients() / 2 + 1] = -1.0;
        x.push(1.0);
        let (x, residual) = newton(&mut system, x, 0.0);
        // Of forces of 1e10.
        assert!(residual < 1e-5, "{residual:e}");
        let motion = system.motion(&x, 0.0).unwrap();
        // The mean of forces of 1e10 on a spring of 1 N/m is rounding.
        assert!(motion.eta[0][0].norm() < 1e-5);
        let amplitude: f64 = motion.eta[1..].iter().map(|eta| eta[0].re).sum();
        // ω ~ A^{(n−1)/2}.
        let expected = omega * amplitude.abs().powf(0.5 * (exponent - 1.0));
        assert!((motion.at.omega / expected - 1.0).abs() < 3e-8, "{exponent}: {} {expected}", motion.at.omega);
        assert!(motion.contacts.iter().all(|c| c.touches == 1 && (c.closed_share - 0.5).abs() < 1e-9));
    }
}

/// Contacts with their laws.
type Laws = Vec<(usize, Arc<dyn ForceLaw>)>;

/// A rod in few modes before a rigid stop and, behind its node, two stops with a law of force and a cubic spring.
fn before_stops(length: f64, dissipation: f64) -> (Open, Laws, ModalStructure) {
    let stops = [(2, Side::Negative, 0.45 * length)];
    let open = Open::lowest(&on_springs(&rod(6, 1.0, 1.0, 1.0, &stops), &[3.0, 3.0]), 4);
    let stiff = open.omega_squared[0];
    let k = |share: f64| share * stiff / length.sqrt();
    let dissipation = dissipation / (length * stiff.sqrt());
    let laws: Vec<(usize, Arc<dyn ForceLaw>)> = vec![
        (5, hertz(k(0.8), 0.5 * length, dissipation)),
        (4, Arc::new(Polynomial { coefficients: vec![0.0, 0.0, 0.3 * stiff / length.powi(2)] })),
        (4, Arc::new(HertzStop { stiffness: stiff / length, exponent: 2.0, gap: 0.5 * length, dissipation: 0.0 })),
    ];
    let structure = open.structure(ModalDamping::ratios(&open.omega_squared, &[0.03, 0.01]));
    let structure = structure.with_laws(open.placed(&laws), 4096).unwrap();
    (open, laws, structure)
}

fn row(open: &Open, laws: &[(usize, Arc<dyn ForceLaw>)], dof: usize) -> ResponseRow {
    let mut row = open.row(dof, true);
    let probe: Arc<dyn ForceLaw> = Arc::new(PowerSpring { stiffness: 0.0, exponent: 1.0, one_sided: false });
    let placed = open.placed(&[laws, &[(dof, probe)]].concat());
    row.contacts.extend(&placed[laws.len()].laws[..laws.len()]);
    row
}

fn load(open: &Open, laws: &[(usize, Arc<dyn ForceLaw>)], structure: &ModalStructure, size: f64) -> Load {
    let mut term: LoadTerm = open.force(4, 1, Complex64::new(size, 0.1 * size));
    let row = row(open, laws, 4);
    let c = structure.n_contacts();
    term.gaps.extend(row.contacts[c..].iter().map(|h| Complex64::new(size, 0.1 * size) * *h));
    Load::new(structure, vec![term]).unwrap()
}

fn unknowns(system: &PeriodicSystem, extra: &[f64]) -> Vec<f64> {
    let (width, n) = (system.series().width(), system.n_coefficients());
    let coefficient = |i: usize| {
        let (harmonic, _) = system.series().harmonic(i % width);
        let main = if i % width == 1 { 1.3 } else { 0.0 };
        main + 0.2 * (1.7 * i as f64 + 0.6).sin() / (1.0 + harmonic as f64).powi(2)
    };
    (0..n).map(coefficient).chain(extra.iter().copied()).collect()
}

#[test]
fn jacobians_with_hertz_stops_are_right() {
    let check = |system: &mut PeriodicSystem, extra: &[f64], p: f64, what: &str| {
        let x = unknowns(system, extra);
        system.hold_phase(&x);
        let contacts = system.motion(&x, p).unwrap().contacts;
        assert!(contacts[1..].iter().all(|c| c.closed_share > 0.02 && c.closed_share < 0.9), "{what} {contacts:?}");
        // Touches are found, so that residuals have no steps: differences see rounding and their own order alone.
        let defect = worst_column(system, &x, p, 1e-6);
        assert!(defect < 1e-7, "{what}: {defect:e}");
    };
    for length in [1.0, 1e-3] {
        let (open, laws, structure) = before_stops(length, 0.3);
        let stiff = open.omega_squared[0];
        let scales = Scales::new(length, stiff.sqrt(), stiff * length * length);
        let (settings, solver) = (settings(4, Coordinates::Automatic), solver());
        let mut damped = PeriodicSystem::damped_mode(&structure, settings, scales, solver.as_ref()).unwrap();
        check(&mut damped, &[1.07, 0.04], 0.3, "damped mode");
        for symmetry in [Symmetry::Even, Symmetry::None] {
            let extra: &[f64] = if symmetry == Symmetry::Even { &[1.07] } else { &[1.07, 0.03] };
            let mut system =
                PeriodicSystem::conservative_mode(&structure, symmetry, settings, scales, solver.as_ref()).unwrap();
            // What dissipates is left out, and the elastic part of the stop stays.
            assert!(system.structure().laws().iter().all(|placed| !placed.law.dissipates()));
            assert_eq!(system.structure().law_stops().count(), structure.law_stops().count());
            check(&mut system, extra, 0.3, "conservative mode");
        }
        let load = load(&open, &laws, &structure, 0.3 * stiff * length);
        let (driven, base) = (load.clone(), stiff.sqrt());
        let mut forced =
            PeriodicSystem::frequency_response(&structure, driven, 1.2, base, settings, scales, solver.as_ref())
                .unwrap();
        check(&mut forced, &[], 1.05, "frequency response");
        let lag = PhaseLag { row: row(&open, &laws, 4), harmonic: 1, lag: FRAC_PI_2 };
        let mut resonance =
            PeriodicSystem::phase_resonance(&structure, load, lag, 1.0, settings, scales, solver.as_ref()).unwrap();
        check(&mut resonance, &[1.1], 0.2, "phase resonance");
    }
}

/// What the load puts in, the damping of the modes and the stops take out.
#[test]
fn powers_of_a_forced_motion_before_a_stop_that_dissipates_balance() {
    let (open, laws, structure) = before_stops(1.0, 0.5);
    let stiff = open.omega_squared[0];
    let (scales, load) = (Scales::new(1.0, stiff.sqrt(), stiff), load(&open, &laws, &structure, 0.4 * stiff));
    let (omega, settings, solver) = (0.8 * stiff.sqrt(), settings(9, Coordinates::Automatic), solver());
    let mut system =
        PeriodicSystem::force_response(&structure, load, omega, 1.0, settings, scales, solver.as_ref()).unwrap();
    let mut x = vec![0.0; system.n_coefficients()];
    for j in 1..=40 {
        (x, _) = newton(&mut system, x, 0.025 * f64::from(j));
    }
    let motion = system.motion(&x, 1.0).unwrap();
    let off = motion.input_power / motion.dissipated_power - 1.0;
    assert!(motion.contacts[1].touches == 1 && off.abs() < 1e-9, "{off:e} {motion:?}");
    // The stop takes out more than the rest of it.
    let damped = |n: usize| -> f64 {
        let of = |k: usize| structure.damping().entry(k, k) * motion.eta[n][k].norm_sqr();
        0.5 * (n as f64 * omega).powi(2) * (0..open.n_modes()).map(of).sum::<f64>()
    };
    let of_modes: f64 = (1..motion.eta.len()).map(damped).sum();
    assert!(motion.dissipated_power > 1.05 * of_modes, "{} {of_modes}", motion.dissipated_power);
}

/// An oscillator before a stop that dissipates, forced: its state after a period of Runge and Kutta in steps that end
/// at the touches, and the monodromy matrix of these, against harmonics and multipliers.
#[test]
fn a_forced_motion_before_a_hertz_stop_and_its_multipliers_are_those_of_an_integration_in_time() {
    let (ratio, omega, force) = (0.05, 1.3, 0.4);
    let law = HertzStop { stiffness: 8.0, exponent: 1.5, gap: 0.4, dissipation: 0.2 };
    let structure = oscillator(1.0, ratio, &[(1.0, Arc::new(law))]);
    let term = LoadTerm { harmonic: 1, omega_power: 0, modal: vec![Complex64::from(force)], gaps: vec![0.0.into()] };
    let load = Load::new(&structure, vec![term]).unwrap();
    let (scales, solver) = (Scales::new(1.0, omega, 1.0), solver());
    let rate = |t: f64, z: [f64; 6]| {
        let at = law.at(z[0], z[1]);
        let mut out = [0.0; 6];
        out[0] = z[1];
        out[1] = force * (omega * t).cos() - 2.0 * ratio * z[1] - z[0] - at.force;
        for column in [2, 4] {
            out[column] = z[column + 1];
            out[column + 1] = -(2.0 * ratio + at.damping) * z[column + 1] - (1.0 + at.stiffness) * z[column];
        }
        out
    };
    let steps = 60000;
    let h = 2.0 * PI / omega / f64::from(steps);
    let period = |mut z: [f64; 6]| {
        for j in 0..steps {
            let t = h * f64::from(j);
            let add = |k: [f64; 6], by: f64| std::array::from_fn(|i| z[i] + by * k[i]);
            let a = rate(t, z);
            let b = rate(t + 0.5 * h, add(a, 0.5 * h));
            let c = rate(t + 0.5 * h, add(b, 0.5 * h));
            let d = rate(t + h, add(c, h));
            z = std::array::from_fn(|i| z[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        z
    };
    let mut last = f64::INFINITY;
    for harmonics in [10, 40, 160] {
        let settings = settings(harmonics, Coordinates::Automatic);
        let mut system =
            PeriodicSystem::force_response(&structure, load.clone(), omega, 1.0, settings, scales, solver.as_ref())
                .unwrap();
        let mut x = vec![0.0; system.n_coefficients()];
        for j in 1..=20 {
            (x, _) = newton(&mut system, x, 0.05 * f64::from(j));
        }
        let motion = system.motion(&x, 1.0).unwrap();
        assert!(motion.contacts[0].touches == 1 && motion.contacts[0].closed_share > 0.1);
        let state = |order: i32| -> f64 {
            let terms = motion.eta.iter().enumerate();
            terms.map(|(n, eta)| (eta[0] * Complex64::new(0.0, n as f64 * omega).powi(order)).re).sum()
        };
        let begin = [state(0), state(1)];
        let end = period([begin[0], begin[1], 1.0, 0.0, 0.0, 1.0]);
        let off = (end[0] - begin[0]).abs().max((end[1] - begin[1]).abs());
        assert!(off < 0.2 * last, "{harmonics}: {off:e} {last:e}");
        last = off;
        if harmonics == 160 {
            assert!(off < 1e-6, "{off:e}");
            let (trace, determinant) = (end[2] + end[5], end[2] * end[5] - end[4] * end[3]);
            let floquet = system.floquet(&x, 1.0, solver.as_ref()).unwrap();
            let sum: Complex64 = floquet.multipliers.iter().sum();
            let product: Complex64 = floquet.multipliers.iter().product();
            // Runge and Kutta pass the roots in the slopes at both ends of a touch with 1e-6 each.
            assert!((sum.re - trace).abs() < 5e-6, "{sum} {trace}");
            assert!((product.re - determinant).abs() < 5e-6, "{product} {determinant}");
        }
    }
}

/// A mode begins where the stop is first touched, toward it at the phase zero.
#[test]
fn a_mode_before_a_hertz_stop_begins_at_its_clearance() {
    for side in [1.0, -1.0] {
        let structure = oscillator(4.0, 0.0, &[(side, hertz(3.0, 0.25, 0.0))]);
        let start = modal_start(&structure, None, 1, ModeStart::Linear).unwrap();
        assert!((start.amplitude - side * 0.25).abs() < 1e-15 && start.length == 0.25, "{start:?}");
        // Beside a spring that bends it begins below that.
        let cubic: Arc<dyn ForceLaw> = Arc::new(Polynomial { coefficients: vec![0.0, 0.0, 5.0] });
        let structure = oscillator(4.0, 0.0, &[(1.0, cubic), (side, hertz(3.0, 0.25, 0.0))]);
        let start = modal_start(&structure, None, 1, ModeStart::Linear).unwrap();
        assert!(start.amplitude.abs() < 0.13, "{start:?}");
    }
}
