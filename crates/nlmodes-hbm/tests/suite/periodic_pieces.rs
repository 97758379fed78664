//! Contact patterns of damped and forced motions: where they change between two points, told by a function and by
//! halving.

use crate::support;

use std::f64::consts::FRAC_PI_2;

use nlmodes_continuation::ParametricSystem;
use nlmodes_hbm::{
    Coordinates, LoadTerm, ModalDamping, PeriodicSystem, PhaseLag, RealSeries, Scales, Switching, Symmetry,
};
use nlmodes_model::Side;
use num_complex::Complex64;
use support::modal::{Open, settings, solver};
use support::{condense, problem, rod};

/// Points of a segment on which changes are looked for.
const POINTS: usize = 150;

/// Numbers between −1 and 1.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

fn between(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| (1.0 - share) * a + share * b).collect()
}

/// Unknowns with a large fundamental, a frequency and damping of the right size, and a parameter.
fn point(series: RealSeries, n: usize, dim: usize, draw: &mut Draw) -> Vec<f64> {
    let width = series.width();
    let mut z: Vec<f64> = (0..n)
        .map(|i| {
            let (harmonic, _) = series.harmonic(i % width);
            (if i % width == 1 { 1.6 } else { 0.0 }) + 0.5 * draw.next() / (1.0 + harmonic as f64)
        })
        .collect();
    (n..=dim).for_each(|_| z.push(1.0 + 0.3 * draw.next()));
    z
}

/// Changes whose boundary is known, and all that are seen, on segments between points drawn by lot. Each that is known
/// is where halving finds it.
fn changes<S: ParametricSystem>(system: &mut S, (series, n): (RealSeries, usize), seeds: u64) -> (usize, usize) {
    let dim = system.dim();
    let (mut known, mut all) = (0, 0);
    for seed in 1..=seeds {
        let mut draw = Draw(seed);
        let [a, b] = [(); 2].map(|()| point(series, n, dim, &mut draw));
        let mut before = (a.clone(), system.pattern_at(&a).unwrap());
        for k in 1..=POINTS {
            let z = between(&a, &b, k as f64 / POINTS as f64);
            let piece = system.pattern_at(&z).unwrap();
            let from = std::mem::replace(&mut before, (z.clone(), piece));
            if from.1 == piece {
                continue;
            }
            all += 1;
            let Some(boundary) = system.boundary(&from.0, &z) else { continue };
            if boundary.value(&from.0) <= 0.0 || boundary.value(&z) >= 0.0 {
                continue;
            }
            let (mut low, mut high) = (0.0, 1.0);
            while high - low > 1e-13 {
                let middle = 0.5 * (low + high);
                let same = system.pattern_at(&between(&from.0, &z, middle)).unwrap() == from.1;
                if same { low = middle } else { high = middle }
            }
            if system.pattern_at(&between(&from.0, &z, high + 1e-9)).unwrap() != piece {
                // Two changes that together look like one.
                continue;
            }
            known += 1;
            let value = boundary.value(&between(&from.0, &z, high));
            assert!(value.abs() < 1e-11, "seed {seed}: {value:e}");
        }
    }
    (known, all)
}

#[test]
fn the_function_of_a_boundary_vanishes_where_the_pattern_of_a_damped_or_forced_motion_changes() {
    let stops = [(6, Side::Positive, 1.0), (2, Side::Negative, 0.45)];
    // Two systems of units.
    for (ea, rho_a, length, unit) in [(1.0, 1.0, 1.0, 1.0), (2e8, 40.0, 3.0, 1e-3)] {
        let stops = stops.map(|(node, side, gap)| (node, side, unit * gap));
        let open = Open::massless(&rod(6, ea, rho_a, length, &stops));
        let structure = open.structure(ModalDamping::ratios(&open.omega_squared, &[0.02]));
        let (square, first) = (open.omega_squared[0], open.omega_squared[0].sqrt());
        let scales = Scales::new(unit, first, square * unit * unit);
        // The base moves past its stops: what it adds to the gaps depends on frequency and level.
        let base = LoadTerm {
            harmonic: 1,
            omega_power: 2,
            modal: vec![Complex64::default(); open.n_modes()],
            gaps: (0..2).map(|i| Complex64::new(0.5, 0.3 * i as f64) * unit / square).collect(),
        };
        let load = open.load(&structure, vec![base, open.force(5, 2, Complex64::new(0.0, 0.2 * square * unit))]);
        let drive = PhaseLag { row: open.row(5, false), harmonic: 1, lag: FRAC_PI_2 };
        for coordinates in [Coordinates::Contact, Coordinates::Modal] {
            let (settings, solver) = (settings(5, coordinates), solver());
            let solver = solver.as_ref();
            let systems = [
                PeriodicSystem::damped_mode(&structure, settings, scales, solver),
                PeriodicSystem::conservative_mode(&structure, Symmetry::Even, settings, scales, solver),
                PeriodicSystem::frequency_response(&structure, load.clone(), 1.0, first, settings, scales, solver),
                PeriodicSystem::force_response(&structure, load.clone(), first, 1.0, settings, scales, solver),
                PeriodicSystem::phase_resonance(&structure, load.clone(), drive.clone(), 0.5, settings, scales, solver),
            ];
            for (kind, system) in systems.into_iter().enumerate() {
                let mut system = system.unwrap();
                let unknowns = (system.series(), system.n_coefficients());
                let (known, all) = changes(&mut system, unknowns, 40);
                // The others are two changes within one step.
                assert!(all > 8 && 4 * known > 3 * all, "kind {kind}, {coordinates:?}: {known} of {all}");
            }
        }
    }
}

#[test]
fn the_function_of_a_boundary_vanishes_where_the_pattern_of_a_mode_changes() {
    let stops = [(6, Side::Positive, 1.0), (2, Side::Negative, 0.45)];
    for (ea, rho_a, length, unit) in [(1.0, 1.0, 1.0, 1.0), (2e8, 40.0, 3.0, 1e-3)] {
        let structure = condense(&rod(6, ea, rho_a, length, &stops.map(|(node, side, gap)| (node, side, unit * gap))));
        for symmetry in [Symmetry::Even, Symmetry::None] {
            let (mut system, _) = problem(&structure, 1, 5, symmetry, Switching::Exact);
            assert_eq!(system.contact_iterations(), 0);
            let unknowns = (system.series(), system.n_coefficients());
            let (known, all) = changes(&mut system, unknowns, 150);
            assert!(all > 8 && 4 * known > 3 * all, "{symmetry:?}: {known} of {all}");
            assert!(system.contact_iterations() > 0);
        }
    }
}
