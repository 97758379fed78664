//! Jacobians of damped, forced and conservative problems against differences of their residuals.

use crate::support;

use nlmodes_hbm::{
    Coordinates, DampedStop, Load, LoadTerm, ModalDamping, ModalStructure, PeriodicSystem, PhaseLag, Scales, Symmetry,
};
use nlmodes_model::Side;
use num_complex::Complex64;
use support::modal::{Open, settings, solver, worst_column};
use support::{on_springs, rod};

/// With a step of 1e-6 differences are good to about 1e-10 of rounding; 1e-6 leaves room for third derivatives near
/// resonance.
const TOLERANCE: f64 = 1e-6;

/// Rods in two systems of units with one stop, two on different nodes, two facing each other, and elastic ones.
fn structures() -> Vec<(Open, f64)> {
    let stops: [&[(usize, Side, f64)]; 3] = [
        &[(6, Side::Positive, 1.0)],
        &[(6, Side::Positive, 1.0), (2, Side::Negative, 0.45)],
        &[(6, Side::Positive, 1.0), (6, Side::Negative, 0.7)],
    ];
    let mut all = Vec::new();
    for stops in stops {
        let unit = rod(6, 1.0, 1.0, 1.0, stops);
        all.push((Open::massless(&unit), 1.0));
        let c = stops.len();
        all.push((Open::lowest(&on_springs(&unit, &vec![3.0; c]), 4), 1.0));
        let scaled: Vec<_> = stops.iter().map(|s| (s.0, s.1, 1e-3 * s.2)).collect();
        all.push((Open::massless(&rod(6, 2e8, 40.0, 3.0, &scaled)), 1e-3));
    }
    all
}

fn scales(open: &Open, length: f64) -> Scales {
    Scales::new(length, open.omega_squared[0].sqrt(), open.omega_squared[0] * length * length)
}

/// All coefficients, most in the fundamental, and the given unknowns behind them.
fn unknowns(system: &PeriodicSystem, extra: &[f64]) -> Vec<f64> {
    let (width, n) = (system.series().width(), system.n_coefficients());
    let coefficient = |i: usize| {
        let (harmonic, _) = system.series().harmonic(i % width);
        let main = if i % width == 1 { 1.9 - 0.4 * (i / width) as f64 } else { 0.0 };
        main + 0.3 * (1.7 * i as f64 + 0.6).sin() / (1.0 + harmonic as f64).powi(2)
    };
    (0..n).map(coefficient).chain(extra.iter().copied()).collect()
}

fn check(system: &mut PeriodicSystem, extra: &[f64], p: f64, what: &str) -> f64 {
    let x = unknowns(system, extra);
    system.hold_phase(&x);
    let motion = system.motion(&x, p).unwrap();
    let defect = worst_column(system, &x, p, 1e-6);
    assert!(defect < TOLERANCE, "{what}: {defect:e}");
    motion.contacts.iter().map(|c| c.closed_share).fold(0.0, f64::max)
}

fn dampings(open: &Open) -> Vec<ModalDamping> {
    let w = &open.omega_squared;
    let first = w[0].sqrt();
    let dashpot = (0..w.len()).map(|k| open.shapes[(2, k)]).collect::<Vec<f64>>();
    let size = dashpot.iter().map(|v| v * v).sum::<f64>();
    vec![
        ModalDamping::ratios(w, &[0.03, 0.01]),
        ModalDamping::rayleigh(w, 0.02 * first, 0.01 / first),
        ModalDamping::ratios(w, &[0.01]).with_dashpots(&[(dashpot, 0.1 * first / size)]),
    ]
}

/// A force in two harmonics with phases, one of them at the contact, and a base that moves past fixed stops.
fn load(open: &Open, structure: &ModalStructure, length: f64) -> Load {
    let stiff = open.omega_squared[0] * length;
    let unit = |re: f64, im: f64| Complex64::new(re, im) * stiff;
    let base = LoadTerm {
        harmonic: 1,
        omega_power: 2,
        modal: (0..open.n_modes()).map(|k| Complex64::new(0.1, 0.02 * k as f64) * length).collect(),
        gaps: (0..structure.n_contacts())
            .map(|i| Complex64::new(0.05, 0.03 * i as f64) * length / open.omega_squared[0])
            .collect(),
    };
    open.load(structure, vec![open.force(1, 1, unit(0.3, 0.1)), open.force(5, 2, unit(0.1, -0.2)), base])
}

#[test]
fn jacobians_of_damped_and_conservative_modes_are_right() {
    for (i, (open, length)) in structures().iter().enumerate() {
        let scales = scales(open, *length);
        for coordinates in [Coordinates::Contact, Coordinates::Modal] {
            let settings = settings(4, coordinates);
            for (j, damping) in dampings(open).into_iter().enumerate() {
                let structure = open.structure(damping);
                let mut system = PeriodicSystem::damped_mode(&structure, settings, scales, solver().as_ref()).unwrap();
                let closed = check(&mut system, &[1.07, 0.04], 0.3, &format!("damped {i} {j} {coordinates:?}"));
                assert!(closed > 0.05 && closed < 0.95, "{closed}");
            }
            let structure = open.structure(ModalDamping::none(open.n_modes()));
            for symmetry in [Symmetry::Even, Symmetry::None] {
                let mut system =
                    PeriodicSystem::conservative_mode(&structure, symmetry, settings, scales, solver().as_ref())
                        .unwrap();
                let extra: &[f64] = if symmetry == Symmetry::Even { &[1.07] } else { &[1.07, 0.03] };
                check(&mut system, extra, 0.3, &format!("conservative {i} {symmetry:?} {coordinates:?}"));
            }
        }
    }
}

#[test]
fn jacobians_of_forced_responses_are_right() {
    for (i, (open, length)) in structures().iter().enumerate() {
        let scales = scales(open, *length);
        let first = open.omega_squared[0].sqrt();
        for coordinates in [Coordinates::Contact, Coordinates::Modal] {
            for (j, damping) in dampings(open).into_iter().enumerate() {
                let structure = open.structure(damping);
                let load = load(open, &structure, *length);
                let (settings, solver) = (settings(4, coordinates), solver());
                let what = |kind: &str| format!("{kind} {i} {j} {coordinates:?}");
                let mut system = PeriodicSystem::frequency_response(
                    &structure,
                    load.clone(),
                    0.8,
                    0.3 * first,
                    settings,
                    scales,
                    solver.as_ref(),
                )
                .unwrap();
                let closed = check(&mut system, &[], 3.6, &what("frequency"));
                assert!(closed > 0.05 && closed < 0.95, "{closed}");
                let mut system = PeriodicSystem::force_response(
                    &structure,
                    load.clone(),
                    1.1 * first,
                    1.0,
                    settings,
                    scales,
                    solver.as_ref(),
                )
                .unwrap();
                check(&mut system, &[], 0.7, &what("force"));
                let mut row = open.row(1, true);
                row.loads = vec![row.loads[0] * open.omega_squared[0] * *length];
                let drive = PhaseLag { row, harmonic: 1, lag: 1.2 };
                let mut system =
                    PeriodicSystem::phase_resonance(&structure, load, drive, 0.5, settings, scales, solver.as_ref())
                        .unwrap();
                check(&mut system, &[1.08], 0.4, &what("phase"));
            }
        }
    }
}

/// The structure with spring and damper behind its first stop, and its load.
fn dissipating(structure: &ModalStructure, load: &Load, first: f64) -> (ModalStructure, Load) {
    let stiffness = 1.0 / structure.compliance().a()[(0, 0)];
    let stop = DampedStop { contact: 0, stiffness, damper: 0.3 * stiffness / first };
    let damped = structure.with_damped_stops(&[stop]).unwrap();
    let longer = |term: &LoadTerm| {
        let modal = term.modal.iter().copied().chain([Complex64::default()]).collect();
        LoadTerm { modal, ..term.clone() }
    };
    let load = Load::new(&damped, load.terms().iter().map(longer).collect()).unwrap();
    (damped, load)
}

#[test]
fn jacobians_with_a_stop_that_dissipates_are_right() {
    let mut shares = Vec::new();
    // Unknowns drawn by lot can pinch a node between two stops that face each other: these are left out.
    for (i, (open, length)) in structures().iter().enumerate().take(6) {
        let (scales, first) = (scales(open, *length), open.omega_squared[0].sqrt());
        for coordinates in [Coordinates::Contact, Coordinates::Modal] {
            for (j, damping) in dampings(open).into_iter().enumerate() {
                let elastic = open.structure(damping);
                let (structure, load) = dissipating(&elastic, &load(open, &elastic, *length), first);
                let (settings, solver) = (settings(4, coordinates), solver());
                let what = |kind: &str| format!("{kind} {i} {j} {coordinates:?}");
                let mut system = PeriodicSystem::damped_mode(&structure, settings, scales, solver.as_ref()).unwrap();
                check(&mut system, &[1.07, 0.04], 0.3, &what("damped"));
                let mut system = PeriodicSystem::frequency_response(
                    &structure,
                    load.clone(),
                    0.8,
                    0.3 * first,
                    settings,
                    scales,
                    solver.as_ref(),
                )
                .unwrap();
                let closed = check(&mut system, &[], 3.6, &what("frequency"));
                shares.push(closed);
                let mut row = open.row(1, true);
                row.loads = vec![row.loads[0] * open.omega_squared[0] * *length];
                row.modes.push(0.0);
                let drive = PhaseLag { row, harmonic: 1, lag: 1.2 };
                let mut system =
                    PeriodicSystem::phase_resonance(&structure, load, drive, 0.5, settings, scales, solver.as_ref())
                        .unwrap();
                check(&mut system, &[1.08], 0.4, &what("phase"));
            }
        }
    }
    // These unknowns put the stops somewhere too, in some cases out of reach.
    let touching = shares.iter().filter(|share| (0.05..0.95).contains(*share)).count();
    assert!(touching > 0, "{shares:?}");
}

#[test]
fn jacobians_are_right_at_an_undamped_resonance_of_a_harmonic() {
    for (open, length) in structures() {
        let (scales, first) = (scales(&open, length), open.omega_squared[0].sqrt());
        let structure = open.structure(ModalDamping::none(open.n_modes()));
        for beside in [0.0, 1e-10, -1e-7, 1e-4] {
            let omega = open.omega_squared[1].sqrt() / 3.0 / first * (1.0 + beside);
            for coordinates in [Coordinates::Contact, Coordinates::Modal] {
                for symmetry in [Symmetry::Even, Symmetry::None] {
                    let mut system = PeriodicSystem::conservative_mode(
                        &structure,
                        symmetry,
                        settings(4, coordinates),
                        scales,
                        solver().as_ref(),
                    )
                    .unwrap();
                    let extra: &[f64] = if symmetry == Symmetry::Even { &[omega] } else { &[omega, 0.0] };
                    check(&mut system, extra, 0.3, &format!("{symmetry:?} {coordinates:?} {beside:e}"));
                }
            }
        }
    }
}
