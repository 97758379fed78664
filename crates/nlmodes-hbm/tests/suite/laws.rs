//! Laws of force beside stops: Jacobians against differences, power in balance,
//! and a linear law against what the linear structure does with it.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use crate::support;

use nlmodes_hbm::{
    Bilinear, Coordinates, Exponential, ForceLaw, Load, LoadTerm, ModalDamping, ModalStructure, PeriodicSettings,
    PeriodicSystem, PhaseLag, PlacedLaw, Polynomial, PowerDamper, PowerSpring, Scales, Switching, Symmetry,
};
use nlmodes_linalg::Mat;
use nlmodes_model::Side;
use num_complex::Complex64;
use support::modal::{Open, newton, settings, solver, worst_column};
use support::{on_springs, rod};

/// One mass without a stop on a spring with this law beside it.
pub fn oscillator(law: Arc<dyn ForceLaw>, ratio: f64) -> ModalStructure {
    let damping = ModalDamping::ratios(&[1.0], &[ratio]);
    let structure = ModalStructure::new(vec![1.0], Mat::zeros(0, 1), &Mat::zeros(0, 0), vec![], &[], damping).unwrap();
    let placed = PlacedLaw { law, modes: vec![1.0], contacts: vec![], laws: vec![0.0] };
    structure.with_laws(vec![placed], 1024).unwrap()
}

/// A rod in few modes before two stops with a law of each kind at other nodes.
fn with_laws(length: f64, is_damped: bool) -> (Open, ModalStructure) {
    let stops = [(6, Side::Positive, length), (2, Side::Negative, 0.45 * length)];
    let open = Open::lowest(&on_springs(&rod(6, 1.0, 1.0, 1.0, &stops), &[3.0, 3.0]), 4);
    let stiff = open.omega_squared[0];
    let cubic = Polynomial { coefficients: vec![0.2 * stiff, 0.1 * stiff / length, 0.3 * stiff / length.powi(2)] };
    let square = PowerDamper { coefficient: 0.1 / length, exponent: 2.0 };
    let mut laws: Vec<(usize, Arc<dyn ForceLaw>)> = vec![
        (4, Arc::new(cubic)),
        (5, Arc::new(Exponential { force: 0.1 * stiff * length, length: 2.0 * length })),
        (4, Arc::new(PowerSpring { stiffness: 0.2 * stiff / length.sqrt(), exponent: 1.5, one_sided: true })),
    ];
    if is_damped {
        laws.push((3, Arc::new(square)));
    }
    let structure = open.structure(ModalDamping::ratios(&open.omega_squared, &[0.03, 0.01]));
    let structure = structure.with_laws(open.placed(&laws), 4096).unwrap();
    (open, structure)
}

fn unknowns(system: &PeriodicSystem, extra: &[f64]) -> Vec<f64> {
    let (width, n) = (system.series().width(), system.n_coefficients());
    let coefficient = |i: usize| {
        let (harmonic, _) = system.series().harmonic(i % width);
        let main = if i % width == 1 { 1.7 - 0.4 * (i / width) as f64 } else { 0.0 };
        main + 0.3 * (1.7 * i as f64 + 0.6).sin() / (1.0 + harmonic as f64).powi(2)
    };
    (0..n).map(coefficient).chain(extra.iter().copied()).collect()
}

/// A law has a kink in its slope at most: differences with a step of 1e-6 see it where a sample passes it.
fn check(system: &mut PeriodicSystem, extra: &[f64], p: f64, what: &str) {
    let x = unknowns(system, extra);
    system.hold_phase(&x);
    assert!(system.motion(&x, p).unwrap().contacts.iter().any(|c| c.closed_share > 0.05 && c.closed_share < 0.95));
    let defect = worst_column(system, &x, p, 1e-6);
    assert!(defect < 2e-6, "{what}: {defect:e}");
}

#[test]
fn jacobians_with_laws_beside_stops_are_right() {
    for length in [1.0, 1e-3] {
        let (open, structure) = with_laws(length, true);
        let stiff = open.omega_squared[0];
        let scales = Scales::new(length, stiff.sqrt(), stiff * length * length);
        let (settings, solver) = (settings(4, Coordinates::Automatic), solver());
        let mut damped = PeriodicSystem::damped_mode(&structure, settings, scales, solver.as_ref()).unwrap();
        check(&mut damped, &[1.07, 0.04], 0.3, "damped mode");
        for symmetry in [Symmetry::Even, Symmetry::None] {
            let extra: &[f64] = if symmetry == Symmetry::Even { &[1.07] } else { &[1.07, 0.03] };
            let mut system =
                PeriodicSystem::conservative_mode(&structure, symmetry, settings, scales, solver.as_ref()).unwrap();
            check(&mut system, extra, 0.3, "conservative mode");
        }
        let row = row(&open, &structure, 4);
        let load = load(&open, &structure, 4, 0.3 * stiff * length);
        let mut forced = PeriodicSystem::frequency_response(
            &structure,
            load.clone(),
            1.2,
            stiff.sqrt(),
            settings,
            scales,
            solver.as_ref(),
        )
        .unwrap();
        check(&mut forced, &[], 1.05, "frequency response");
        let lag = PhaseLag { row, harmonic: 1, lag: FRAC_PI_2 };
        let mut resonance =
            PeriodicSystem::phase_resonance(&structure, load, lag, 1.0, settings, scales, solver.as_ref()).unwrap();
        check(&mut resonance, &[1.1], 0.2, "phase resonance");
    }
}

/// Displacement of a degree of freedom with what forces at contacts, laws and there itself move statically.
fn row(open: &Open, structure: &ModalStructure, dof: usize) -> nlmodes_hbm::ResponseRow {
    let mut row = open.row(dof, true);
    // By the symmetry of the flexibility a probe at that place, as a law, tells what others do to it.
    let n = structure.laws().len();
    let probe: Arc<dyn ForceLaw> = Arc::new(Polynomial { coefficients: vec![0.0] });
    let places = [(4, probe.clone()), (5, probe.clone()), (4, probe.clone()), (3, probe.clone()), (dof, probe)];
    let placed = open.placed(&places);
    row.contacts.extend(&placed[4].laws[..n]);
    row
}

fn load(open: &Open, structure: &ModalStructure, dof: usize, size: f64) -> Load {
    let mut term: LoadTerm = open.force(dof, 1, Complex64::new(size, 0.1 * size));
    let row = row(open, structure, dof);
    let c = structure.n_contacts();
    term.gaps.extend(row.contacts[c..].iter().map(|h| Complex64::new(size, 0.1 * size) * *h));
    Load::new(structure, vec![term]).unwrap()
}

/// What the load puts in, the damping of the modes and the dampers take out, whatever is stored in between.
#[test]
fn powers_of_a_forced_motion_with_laws_and_stops_balance() {
    let (open, structure) = with_laws(1.0, true);
    let stiff = open.omega_squared[0];
    let scales = Scales::new(1.0, stiff.sqrt(), stiff);
    let load = load(&open, &structure, 4, 0.3 * stiff);
    let mut system = PeriodicSystem::force_response(
        &structure,
        load,
        1.3 * stiff.sqrt(),
        1.0,
        settings(8, Coordinates::Automatic),
        scales,
        solver().as_ref(),
    )
    .unwrap();
    let mut x = vec![0.0; system.n_coefficients()];
    for j in 1..=40 {
        (x, _) = newton(&mut system, x, 0.02 * f64::from(j));
    }
    let motion = system.motion(&x, 0.8).unwrap();
    assert!(motion.input_power > 0.0);
    let off = motion.input_power / motion.dissipated_power - 1.0;
    assert!(off.abs() < 1e-9, "{off:e} {motion:?}");
}

/// A law that is a straight line is a spring: the forced motion is that of the structure which has it in its stiffness.
#[test]
fn a_linear_law_and_a_linear_damper_are_those_of_the_structure() {
    let stops = [(6, Side::Positive, 5.0)];
    let model = rod(6, 1.0, 1.0, 1.0, &stops);
    let all = Open::massless(&model);
    let few = Open::massless(&model);
    let spring: Arc<dyn ForceLaw> = Arc::new(Polynomial { coefficients: vec![0.7] });
    let damper: Arc<dyn ForceLaw> = Arc::new(PowerDamper { coefficient: 0.2, exponent: 1.0 });
    let structure = all.structure(ModalDamping::none(all.n_modes()));
    let structure = structure.with_laws(few.placed(&[(4, spring), (4, damper)]), 64).unwrap();
    let omega = 0.8 * all.omega_squared[0].sqrt();
    let term = all.force(2, 1, Complex64::new(0.1, 0.0));
    let term = LoadTerm { gaps: term.gaps.iter().copied().chain([Complex64::default(); 2]).collect(), ..term };
    let load = Load::new(&structure, vec![term]).unwrap();
    let settings = settings(3, Coordinates::Automatic);
    let scales = Scales::new(1.0, omega, 1.0);
    let mut system =
        PeriodicSystem::force_response(&structure, load, omega, 1.0, settings, scales, solver().as_ref()).unwrap();
    let rest = vec![0.0; system.n_coefficients()];
    let (x, _) = newton(&mut system, rest, 1.0);
    let motion = system.motion(&x, 1.0).unwrap();
    // (Ω² − ω² + r rᵀ (k + iωc)) η = p, solved as complex numbers by Gauss.
    let m = all.n_modes();
    let law = Complex64::new(0.7, 0.2 * omega);
    let r = |k: usize| all.shapes[(4, k)];
    let mut a: Vec<Vec<Complex64>> = (0..m)
        .map(|i| {
            let own = |j: usize| if i == j { all.omega_squared[i] - omega * omega } else { 0.0 };
            (0..m).map(|j| law * (r(i) * r(j)) + own(j)).chain([Complex64::from(0.1 * all.shapes[(2, i)])]).collect()
        })
        .collect();
    for k in 0..m {
        for i in 0..m {
            if i != k {
                let factor = a[i][k] / a[k][k];
                let from = a[k].clone();
                a[i].iter_mut().zip(from).for_each(|(to, from)| *to -= factor * from);
            }
        }
    }
    for (k, row) in a.iter().enumerate() {
        let eta = row[m] / row[k];
        assert!((motion.eta[1][k] - eta).norm() < 1e-9, "{k}: {} {eta}", motion.eta[1][k]);
    }
}

/// A knee that the motion passes, by the closed form of two harmonic pieces.
#[test]
fn a_bilinear_spring_has_the_period_of_its_pieces() {
    // m = 1, k = 1 within |x| < 0.5, 1 + 8 beyond, amplitude 1.
    let (knee, inner, outer, amplitude) = (0.5_f64, 1.0_f64, 9.0_f64, 1.0_f64);
    // From the knee outward: x = c + a cos(√k₂ t), c from the force at the knee.
    let center = knee - inner * knee / outer;
    let outside = (((knee - center) / (amplitude - center)).acos()) / outer.sqrt();
    let speed = (outer * ((amplitude - center).powi(2) - (knee - center).powi(2))).sqrt();
    let inside = (knee * inner.sqrt() / speed).atan() / inner.sqrt();
    let omega = 2.0 * PI / (4.0 * (outside + inside));
    let structure = oscillator(Arc::new(Bilinear { inner: 0.0, outer: 8.0, knee }), 0.0);
    let settings = PeriodicSettings { harmonics: 61, switching: Switching::Exact, coordinates: Coordinates::Automatic };
    let scales = Scales::new(amplitude, omega, 0.25 * omega * omega);
    let mut system =
        PeriodicSystem::conservative_mode(&structure, Symmetry::Even, settings, scales, solver().as_ref()).unwrap();
    let mut x = vec![0.0; system.n_coefficients()];
    x[1] = 1.0;
    x.push(1.0);
    // The amplitude follows from the energy: secant on the parameter.
    let largest = |x: &[f64]| -> f64 { x[..62].iter().sum::<f64>() };
    let (mut p, mut before) = (0.0, None);
    for _ in 0..20 {
        (x, _) = newton(&mut system, x, p);
        let defect = largest(&x) - amplitude;
        let slope = before.map_or(0.5, |(q, last): (f64, f64)| (defect - last) / (p - q));
        if defect.abs() < 1e-12 {
            break;
        }
        before = Some((p, defect));
        p -= defect / slope;
    }
    let found = system.motion(&x, p).unwrap().at.omega;
    assert!((found / omega - 1.0).abs() < 2e-6, "{found} {omega}");
}

/// Multipliers of Duffing's forced oscillator against the monodromy matrix by small steps of Runge and Kutta, and those
/// of a rod with stops and laws by their product `e^{−∮ tr}`.
#[test]
fn multipliers_with_laws_are_those_of_the_variational_equation() {
    let (kappa, ratio, omega) = (0.8, 0.05, 1.4);
    let structure = oscillator(Arc::new(Polynomial { coefficients: vec![0.0, 0.0, kappa] }), ratio);
    let term = LoadTerm { harmonic: 1, omega_power: 0, modal: vec![Complex64::from(0.3)], gaps: vec![0.0.into()] };
    let load = Load::new(&structure, vec![term]).unwrap();
    let scales = Scales::new(1.0, omega, 1.0);
    let settings = settings(9, Coordinates::Automatic);
    let mut system =
        PeriodicSystem::force_response(&structure, load, omega, 1.0, settings, scales, solver().as_ref()).unwrap();
    let mut x = vec![0.0; system.n_coefficients()];
    x[1] = 1.0;
    let (x, residual) = newton(&mut system, x, 1.0);
    assert!(residual < 1e-13);
    let floquet = system.floquet(&x, 1.0, solver().as_ref()).unwrap();
    let series = system.series();
    let place = |tau: f64| -> f64 {
        let term = |i: usize| {
            let (n, is_sine) = series.harmonic(i);
            let angle = n as f64 * tau;
            x[i] * if is_sine { angle.sin() } else { angle.cos() }
        };
        (0..series.width()).map(term).sum()
    };
    let slope = |t: f64, z: [f64; 2]| {
        let v = place(omega * t);
        [z[1], -2.0 * ratio * z[1] - (1.0 + 3.0 * kappa * v * v) * z[0]]
    };
    let steps = 4000;
    let h = 2.0 * PI / omega / f64::from(steps);
    let run = |mut z: [f64; 2]| {
        for j in 0..steps {
            let t = h * f64::from(j);
            let add = |z: [f64; 2], k: [f64; 2], by: f64| [z[0] + by * k[0], z[1] + by * k[1]];
            let a = slope(t, z);
            let b = slope(t + 0.5 * h, add(z, a, 0.5 * h));
            let c = slope(t + 0.5 * h, add(z, b, 0.5 * h));
            let d = slope(t + h, add(z, c, h));
            z = [0, 1].map(|i| z[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        z
    };
    let (first, second) = (run([1.0, 0.0]), run([0.0, 1.0]));
    let (trace, determinant) = (first[0] + second[1], first[0] * second[1] - first[1] * second[0]);
    let found: Complex64 = floquet.multipliers.iter().sum();
    assert!((found.re - trace).abs() < 1e-6 && found.im.abs() < 1e-9, "{found} {trace}");
    let product: Complex64 = floquet.multipliers.iter().product();
    assert!((product.re - determinant).abs() < 1e-9, "{product} {determinant}");

    let (open, structure) = with_laws(1.0, false);
    let stiff = open.omega_squared[0];
    let load = self::load(&open, &structure, 4, 0.3 * stiff);
    let omega = 1.3 * stiff.sqrt();
    let mut system = PeriodicSystem::force_response(
        &structure,
        load,
        omega,
        1.0,
        settings,
        Scales::new(1.0, stiff.sqrt(), stiff),
        solver().as_ref(),
    )
    .unwrap();
    let mut x = vec![0.0; system.n_coefficients()];
    for j in 1..=40 {
        (x, _) = newton(&mut system, x, 0.02 * f64::from(j));
    }
    let floquet = system.floquet(&x, 0.8, solver().as_ref()).unwrap();
    let damping: f64 = (0..open.n_modes()).map(|k| structure.damping().entry(k, k)).sum();
    let product: Complex64 = floquet.multipliers.iter().product();
    let expected = (-damping * 2.0 * PI / omega).exp();
    assert!((product.norm() / expected - 1.0).abs() < 1e-9, "{product} {expected}");
}

/// A forced motion with two stops and laws over one period, by Runge and Kutta from its own state at its beginning:
/// contact forces and laws are solved at each instant together. It comes back to where it began, the better the more
/// harmonics there are. Without dampers, whose rate would need that of the forces.
#[test]
fn a_forced_motion_with_stops_and_laws_is_that_of_an_integration_in_time() {
    let (open, structure) = with_laws(1.0, false);
    let stiff = open.omega_squared[0];
    let omega = 1.3 * stiff.sqrt();
    let load = load(&open, &structure, 4, 0.3 * stiff);
    let term = load.terms()[0].clone();
    let (level, scales) = (0.8, Scales::new(1.0, stiff.sqrt(), stiff));
    let mut before: Option<(usize, Vec<f64>)> = None;
    let mut off = |harmonics: usize| -> f64 {
        let settings = settings(harmonics, Coordinates::Automatic);
        let mut system =
            PeriodicSystem::force_response(&structure, load.clone(), omega, 1.0, settings, scales, solver().as_ref())
                .unwrap();
        // From rest with few harmonics, then each time from fewer.
        let width = system.series().width();
        let mut x = vec![0.0; system.n_coefficients()];
        match &before {
            None => (1..=40).for_each(|j| x = newton(&mut system, x.clone(), level / 40.0 * f64::from(j)).0),
            Some((fewer, known)) => {
                x.chunks_mut(width).zip(known.chunks(*fewer)).for_each(|(x, known)| x[..*fewer].copy_from_slice(known));
                x = newton(&mut system, x, level).0;
            }
        }
        before = Some((width, x.clone()));
        let motion = system.motion(&x, level).unwrap();
        assert!(motion.contacts.iter().any(|contact| contact.closed_share > 0.01));
        let m = open.n_modes();
        let state = |order: i32| -> Vec<f64> {
            let at = |k: usize| {
                let terms = motion.eta.iter().enumerate();
                terms.map(|(n, eta)| (eta[k] * Complex64::new(0.0, n as f64 * omega).powi(order)).re).sum::<f64>()
            };
            (0..m).map(at).collect()
        };
        let begin: Vec<f64> = state(0).into_iter().chain(state(1)).collect();
        let rate = |t: f64, z: &[f64]| -> Vec<f64> { rate(&structure, &term, level, omega, t, z) };
        let steps = 6000;
        let h = 2.0 * PI / omega / f64::from(steps);
        let mut z = begin.clone();
        for j in 0..steps {
            let t = h * f64::from(j);
            let add = |k: &[f64], by: f64| -> Vec<f64> { z.iter().zip(k).map(|(z, k)| z + by * k).collect() };
            let a = rate(t, &z);
            let b = rate(t + 0.5 * h, &add(&a, 0.5 * h));
            let c = rate(t + 0.5 * h, &add(&b, 0.5 * h));
            let d = rate(t + h, &add(&c, h));
            z = (0..2 * m).map(|i| z[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i])).collect();
        }
        let size = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let (change, of): (Vec<f64>, Vec<f64>) = ((0..m).map(|k| z[k] - begin[k]).collect(), begin[..m].to_vec());
        size(&change) / size(&of)
    };
    // Steps four times as short change the last figure by 1e-9: what is left is that of harmonics.
    let missing = [8, 20, 40, 80].map(&mut off);
    assert!(missing[3] < 1e-6 && missing.is_sorted_by(|a, b| *a > 1.5 * b), "{missing:?}");
}

/// `(η̇, η̈)` at a state, with the forces of two contacts and of all laws.
fn rate(structure: &ModalStructure, term: &LoadTerm, level: f64, omega: f64, t: f64, z: &[f64]) -> Vec<f64> {
    let (m, laws) = (structure.n_modes(), structure.laws());
    let turned = Complex64::cis(omega * t) * level;
    let (eta, speed) = z.split_at(m);
    let of = |row: &[f64], q: &[f64]| row.iter().zip(q).map(|(r, q)| r * q).sum::<f64>();
    let row = |i: usize| -> Vec<f64> { (0..m).map(|k| structure.rows()[(i, k)]).collect() };
    let a = structure.compliance().a();
    let free: Vec<f64> = (0..2).map(|i| structure.gaps()[i] + of(&row(i), eta) + (term.gaps[i] * turned).re).collect();
    let (mut lambda, mut force) = ([0.0; 2], vec![0.0; laws.len()]);
    for _ in 0..60 {
        let y: Vec<f64> = (0..2)
            .map(|i| free[i] + laws.iter().zip(&force).map(|(law, f)| law.contacts[i] * f).sum::<f64>())
            .collect();
        lambda = contact_forces([[a[(0, 0)], a[(0, 1)]], [a[(1, 0)], a[(1, 1)]]], [y[0], y[1]]);
        let next: Vec<f64> = (0..laws.len())
            .map(|l| {
                let law = &laws[l];
                let v = of(&law.modes, eta)
                    + of(&law.contacts, &lambda)
                    + of(&law.laws, &force)
                    + (term.gaps[2 + l] * turned).re;
                -law.law.at(v, of(&law.modes, speed)).force
            })
            .collect();
        force = next;
    }
    let push = |k: usize| {
        let contacts: f64 = (0..2).map(|i| structure.rows()[(i, k)] * lambda[i]).sum();
        let laws: f64 = laws.iter().zip(&force).map(|(law, f)| law.modes[k] * f).sum();
        contacts + laws + (term.modal[k] * turned).re
    };
    let acceleration =
        (0..m).map(|k| push(k) - structure.omega_squared()[k] * eta[k] - structure.damping().entry(k, k) * speed[k]);
    speed.iter().copied().chain(acceleration).collect()
}

/// `0 ≤ λ ⊥ A λ + y ≥ 0` of two contacts, by trying which are closed.
fn contact_forces(a: [[f64; 2]; 2], y: [f64; 2]) -> [f64; 2] {
    let determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    let both = [(a[0][1] * y[1] - a[1][1] * y[0]) / determinant, (a[1][0] * y[0] - a[0][0] * y[1]) / determinant];
    let tried = [[0.0, 0.0], [-y[0] / a[0][0], 0.0], [0.0, -y[1] / a[1][1]], both];
    let fits = |lambda: &[f64; 2]| {
        (0..2).all(|i| {
            let gap = a[i][0] * lambda[0] + a[i][1] * lambda[1] + y[i];
            lambda[i] >= -1e-14 && (lambda[i] > 0.0 || gap >= -1e-14)
        })
    };
    tried.into_iter().find(fits).unwrap_or(both)
}
