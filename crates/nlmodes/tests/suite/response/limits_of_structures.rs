//! Limits with known answers for beams and for structures of matrices, each before two stops and in two systems of
//! units: damping proportional to the mass, no damping, powers, and responses that touch nothing.

use std::f64::consts::TAU;

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::response::{
    Damping, EndReason, ResponseCurve, ResponseModel, ResponseSettings, conservative_mode, damped_mode,
    frequency_response,
};
use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, SparseDirection, StructuralModel};
use num_complex::Complex64;

/// One metre, kilogram and second in a system of units.
#[derive(Clone, Copy)]
struct Units {
    metre: f64,
    kilogram: f64,
    second: f64,
}

/// SI; millimetres and tonnes; and one in which nothing is near one.
const UNITS: [Units; 3] = [
    Units { metre: 1.0, kilogram: 1.0, second: 1.0 },
    Units { metre: 1e3, kilogram: 1e-3, second: 1.0 },
    Units { metre: 50.0, kilogram: 0.3, second: 4e3 },
];

impl Units {
    fn newton(self) -> f64 {
        self.kilogram * self.metre / self.second / self.second
    }

    fn newton_per_metre(self) -> f64 {
        self.newton() / self.metre
    }

    fn hertz(self) -> f64 {
        TAU / self.second
    }
}

/// A structure before two stops, driven at one of its degrees of freedom, with the window of its first mode, Hz, and a
/// force, N, that closes both.
struct Case {
    name: &'static str,
    open: fn(Units, f64, usize) -> OpenModes,
    modes: usize,
    driven: usize,
    window: [f64; 2],
    force: f64,
}

const CASES: [Case; 2] = [
    Case { name: "beam", open: beam, modes: 18, driven: 4, window: [20.0, 60.0], force: 20.0 },
    Case { name: "matrices", open: matrices, modes: 3, driven: 1, window: [0.3, 0.9], force: 5.0 },
];

/// A steel cantilever of 0.8 m with a stop below its middle and one above its tip.
fn beam(units: Units, gap: f64, modes: usize) -> OpenModes {
    let pressure = units.newton_per_metre() / units.metre;
    let volume = units.metre * units.metre * units.metre;
    let beam = Beam {
        material: Material::new(210e9 * pressure, 7800.0 * units.kilogram / volume).unwrap(),
        section: Section::rectangle(0.03 * units.metre, 0.02 * units.metre).unwrap(),
        mesh: Mesh::uniform(0.8 * units.metre, 10).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = |at: f64, side, gap: f64| Stop::rigid(at * units.metre, Direction::Transverse, side, gap * units.metre);
    let stops = [stop(0.4, Side::Negative, 0.36e-3 * gap), stop(0.8, Side::Positive, 1e-3 * gap)];
    let massless = MasslessContactModel::new(&beam.assemble(&stops).unwrap(), &Drop).unwrap();
    OpenModes::of_massless(&massless, ModeCount::Lowest(modes)).unwrap()
}

/// Four masses of 1 to 2.5 kg on springs, each held by the ground too; the stops push along directions between two of
/// them.
fn matrices(units: Units, gap: f64, modes: usize) -> OpenModes {
    let (kg, stiffness) = (units.kilogram, units.newton_per_metre());
    let mass: Vec<_> = (0..4).map(|i| (i, i, (1.0 + 0.5 * i as f64) * kg)).collect();
    let mut springs = Vec::new();
    for (i, k) in [12.0, 20.0, 9.0, 15.0].into_iter().enumerate() {
        springs.push((i, i, k * stiffness));
    }
    for (i, j, k) in [(0, 1, 30.0), (1, 2, 45.0), (2, 3, 25.0), (0, 3, 8.0)] {
        springs.extend([(i, i, k), (j, j, k), (i, j, -k), (j, i, -k)].map(|(i, j, k)| (i, j, k * stiffness)));
    }
    let along = |entries: &[(usize, f64)]| SparseDirection::new(entries.to_vec()).unwrap();
    let contacts = vec![
        Contact::new(along(&[(0, -0.8), (1, -0.6)]), 0.85 * gap * units.metre),
        Contact::new(along(&[(2, 0.6), (3, 0.8)]), 1.1 * gap * units.metre),
    ];
    let dofs = (0..4).map(|node| Dof { node, position: node as f64, kind: DofKind::Axial }).collect();
    let sparse = |entries: &[(usize, usize, f64)]| sparse_from_triplets(4, 4, entries).unwrap();
    let structure = StructuralModel::new(sparse(&mass), sparse(&springs), dofs, contacts).unwrap();
    OpenModes::of_model(&structure, ModeCount::Lowest(modes)).unwrap()
}

impl Case {
    fn model(&self, units: Units, gap: f64, damping: &Damping) -> ResponseModel {
        let mut model = ResponseModel::new((self.open)(units, gap, self.modes), damping).unwrap();
        model.push_force(self.driven, self.force * units.newton(), 1, 0.0).unwrap();
        model.set_drive(self.driven).unwrap();
        model
    }

    fn settings(&self, units: Units, harmonics: usize) -> ResponseSettings {
        ResponseSettings { harmonics, ..ResponseSettings::new(self.window.map(|f| f * units.hertz())) }
    }
}

/// Calls `check` with each case in each system of units, and words for what fails.
fn everywhere(check: impl Fn(&Case, Units, &str)) {
    for case in &CASES {
        for units in UNITS {
            check(case, units, &format!("{}, a metre is {}", case.name, units.metre));
        }
    }
}

fn touched(curve: &ResponseCurve, contact: usize) -> bool {
    curve.points.iter().any(|point| point.motion.contacts[contact].touches > 0)
}

#[test]
fn damping_proportional_to_the_mass_leaves_the_conservative_mode_between_two_stops() {
    everywhere(|case, units, said| {
        let alpha = 0.03 * case.window[0] * units.hertz();
        let model = case.model(units, 1.0, &Damping::Rayleigh { mass: alpha, stiffness: 0.0 });
        let settings = case.settings(units, 7);
        let damped = damped_mode(&model, 3.0, &settings).unwrap();
        let free = conservative_mode(&model, 3.0, &settings).unwrap();
        assert!([&damped, &free].iter().all(|curve| curve.end.has(EndReason::MaxEnergy)), "{said}");
        assert!(touched(&damped, 0) && touched(&damped, 1), "{said}");
        for point in &damped.points {
            assert!((point.motion.at.xi / alpha - 1.0).abs() < 1e-9, "{said}: {:e}", point.motion.at.xi / alpha - 1.0);
            let ratio = alpha / (2.0 * point.omega);
            assert!((point.motion.damping_ratio() / ratio - 1.0).abs() < 1e-9, "{said}");
        }
        let [a, b] = [&damped, &free].map(|curve| curve.points.last().unwrap());
        assert!((a.omega / b.omega - 1.0).abs() < 1e-9, "{said}: {:e}", a.omega / b.omega - 1.0);
        assert!((a.motion.kinetic_energy / b.motion.kinetic_energy - 1.0).abs() < 1e-9, "{said}");
    });
}

#[test]
fn without_damping_no_power_is_needed_between_two_stops() {
    everywhere(|case, units, said| {
        let model = case.model(units, 1.0, &Damping::Ratios(vec![0.0]));
        let curve = damped_mode(&model, 3.0, &case.settings(units, 7)).unwrap();
        assert!(curve.end.has(EndReason::MaxEnergy), "{said}");
        assert!(touched(&curve, 0) && touched(&curve, 1), "{said}");
        for point in &curve.points {
            assert!(point.motion.at.xi.abs() < 1e-10 * point.omega, "{said}: {:e}", point.motion.at.xi / point.omega);
        }
    });
}

#[test]
fn powers_balance_between_two_stops() {
    everywhere(|case, units, said| {
        let model = case.model(units, 1.0, &Damping::Ratios(vec![0.02]));
        let curve = frequency_response(&model, 1.0, &case.settings(units, 9)).unwrap();
        assert!(curve.end.complete, "{said}: {:?}", curve.end);
        assert!(touched(&curve, 0) && touched(&curve, 1), "{said}");
        for point in &curve.points {
            // At resonance 12 times more swings to and fro than is lost.
            let swings = point.omega * point.motion.kinetic_energy;
            let balance = (point.motion.input_power - point.motion.dissipated_power) / swings;
            assert!(balance.abs() < 1e-12, "{said}: {balance:e} at {} Hz", point.omega / units.hertz());
        }
    });
}

#[test]
fn what_touches_neither_stop_responds_linearly() {
    everywhere(|case, units, said| {
        let model = case.model(units, 1e6, &Damping::Ratios(vec![0.02]));
        let curve = frequency_response(&model, 1.0, &case.settings(units, 5)).unwrap();
        assert!(curve.end.complete, "{said}: {:?}", curve.end);
        // Modes that are left out respond as if they had no mass.
        let (structure, all) = (model.structure(), (case.open)(units, 1e6, 40));
        for point in &curve.points {
            let share = |k: usize| {
                let (shape, stiffness) = (all.shapes()[(case.driven, k)], all.omega_squared()[k]);
                let dynamic = if k < case.modes {
                    let damping = point.omega * structure.damping().entry(k, k);
                    Complex64::new(stiffness - point.omega * point.omega, damping)
                } else {
                    Complex64::from(stiffness)
                };
                shape * shape * case.force * units.newton() / dynamic
            };
            let exact: Complex64 = (0..all.n_modes()).map(share).sum();
            let error = (point.drive - exact).norm() / exact.norm();
            assert!(error < 1e-12, "{said}: {error:e}");
        }
    });
}
