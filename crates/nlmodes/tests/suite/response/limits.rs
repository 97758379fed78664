//! Limits with known answers, in several systems of units: linear responses, damping proportional to the mass, no
//! damping, multipliers, published numbers.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nlmodes::hbm::Polynomial;
use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::response::{
    Damping, EndReason, Event, ResponseCurve, ResponseModel, ResponseSettings, appropriation, conservative_mode,
    damped_mode, detached_response, force_response, frequency_response, phase_resonance,
};
use nlmodes_fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_model::{Contact, ContactLaw, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};
use num_complex::Complex64;

/// Length, mass and time of a system of units, in one another.
#[derive(Clone, Copy)]
struct Units {
    length: f64,
    mass: f64,
    time: f64,
}

const UNITS: [Units; 3] = [
    Units { length: 1.0, mass: 1.0, time: 1.0 },
    Units { length: 1e3, mass: 1e-3, time: 1.0 },
    Units { length: 2e-2, mass: 7e2, time: 3e-4 },
];

impl Units {
    fn force(self) -> f64 {
        self.mass * self.length / self.time / self.time
    }
}

/// A rod with `EA = ρA = L = g₀ = 1` in these units, tip dropped, and a force at the node `driven`.
fn rod(units: Units, elements: usize, gap: f64, damping: &Damping, driven: usize) -> ResponseModel {
    let rod = Rod {
        material: Material::new(units.force(), units.mass / units.length).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(units.length, elements).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(units.length, Direction::Axial, Side::Positive, gap * units.length);
    let massless = MasslessContactModel::new(&rod.assemble(&[stop]).unwrap(), &Drop).unwrap();
    let open = OpenModes::of_massless(&massless, ModeCount::Lowest(40)).unwrap();
    let mut model = ResponseModel::new(open, damping).unwrap();
    model.push_force(driven, units.force(), 1, 0.0).unwrap();
    model.set_drive(driven).unwrap();
    model
}

fn window(units: Units, low: f64, high: f64, harmonics: usize) -> ResponseSettings {
    ResponseSettings { harmonics, ..ResponseSettings::new([low, high].map(|f| f * TAU / units.time)) }
}

/// `|q_drive|` of the linear structure from its modes.
fn linear(model: &ResponseModel, driven: usize, force: f64, omega: f64) -> Complex64 {
    let (structure, open) = (model.structure(), model.open_modes());
    let share = |k: usize| {
        let shape = open.shapes()[(driven, k)];
        let d = Complex64::new(structure.omega_squared()[k] - omega * omega, omega * structure.damping().entry(k, k));
        shape * shape * force / d
    };
    (0..open.n_modes()).map(share).sum()
}

#[test]
fn where_nothing_touches_the_response_is_the_linear_one() {
    for units in UNITS {
        let model = rod(units, 6, 1e6, &Damping::Ratios(vec![0.02]), 2);
        let curve = frequency_response(&model, 0.1, &window(units, 0.1, 0.9, 5)).unwrap();
        assert!(curve.end.complete && curve.points.len() > 20);
        for point in &curve.points {
            let exact = linear(&model, 2, 0.1 * units.force(), point.omega);
            assert!(
                (point.drive - exact).norm() < 1e-12 * exact.norm(),
                "{:e}",
                (point.drive - exact).norm() / exact.norm()
            );
            assert_eq!(point.stability.unwrap().stable, Some(true));
        }
    }
}

#[test]
fn a_stop_of_vanishing_stiffness_changes_nothing() {
    let m = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)]).unwrap();
    let k = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)]).unwrap();
    let dof = |node| Dof { node, position: node as f64, kind: DofKind::Axial };
    let law = ContactLaw::Elastic { stiffness: 1e-14 };
    let stop = Contact { law, ..Contact::rigid(0, Side::Positive, 0.1) };
    let structure = StructuralModel::new(m, k, vec![dof(0), dof(1)], vec![stop]).unwrap();
    let open = OpenModes::of_model(&structure, ModeCount::Lowest(2)).unwrap();
    let mut model = ResponseModel::new(open, &Damping::Ratios(vec![0.01])).unwrap();
    model.push_force(1, 1.0, 1, 0.0).unwrap();
    model.set_drive(1).unwrap();
    let curve = frequency_response(&model, 0.1, &ResponseSettings::new([0.5, 0.8])).unwrap();
    assert!(curve.points.iter().any(|p| p.motion.contacts[0].touches > 0));
    for point in &curve.points {
        let exact = linear(&model, 1, 0.1, point.omega);
        assert!(
            (point.drive - exact).norm() < 1e-12 * exact.norm(),
            "{:e}",
            (point.drive - exact).norm() / exact.norm()
        );
    }
}

/// The frequency (rad/s) of a mode at an energy, between its points.
fn omega_at(curve: &ResponseCurve, energy: f64) -> f64 {
    let found = curve.points.iter().min_by(|a, b| {
        let off = |p: &nlmodes::response::ResponsePoint| (p.motion.kinetic_energy / energy - 1.0).abs();
        off(a).total_cmp(&off(b))
    });
    found.unwrap().omega
}

#[test]
fn damping_proportional_to_the_mass_leaves_the_conservative_mode_with_a_known_ratio() {
    for units in UNITS {
        let alpha = 0.03 / units.time;
        let model = rod(units, 2, 1.0, &Damping::Rayleigh { mass: alpha, stiffness: 0.0 }, 0);
        let settings = window(units, 0.2, 0.8, 7);
        let damped = damped_mode(&model, 5.0, &settings).unwrap();
        let free = conservative_mode(&model, 5.0, &settings).unwrap();
        assert!([&damped, &free].iter().all(|curve| curve.end.has(EndReason::MaxEnergy)));
        for point in &damped.points {
            assert!((point.motion.at.xi / alpha - 1.0).abs() < 1e-9, "{:e}", point.motion.at.xi / alpha - 1.0);
            assert!((point.motion.damping_ratio() - alpha / (2.0 * point.omega)).abs() < 1e-9);
        }
        let (a, b) = (damped.points.last().unwrap(), free.points.last().unwrap());
        assert!((a.omega / b.omega - 1.0).abs() < 1e-9, "{:e}", a.omega / b.omega - 1.0);
        assert!((omega_at(&damped, a.motion.kinetic_energy) / a.omega - 1.0).abs() < 1e-12);
    }
}

#[test]
fn without_damping_a_damped_mode_needs_no_power() {
    for units in UNITS {
        let model = rod(units, 2, 1.0, &Damping::Ratios(vec![0.0]), 0);
        let curve = damped_mode(&model, 5.0, &window(units, 0.2, 0.8, 7)).unwrap();
        assert!(curve.end.has(EndReason::MaxEnergy));
        for point in &curve.points {
            assert!(point.motion.at.xi.abs() < 1e-10 * point.omega, "{:e}", point.motion.at.xi / point.omega);
        }
    }
}

/// Two masses on springs, one before a spring of 100 N/m at 1 m, with a force on the other: an example that comes along
/// with NLvib.
fn two_masses() -> ResponseModel {
    let m = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)]).unwrap();
    let k = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)]).unwrap();
    let dof = |node| Dof { node, position: node as f64, kind: DofKind::Axial };
    let law = ContactLaw::Elastic { stiffness: 100.0 };
    let stop = Contact { law, ..Contact::rigid(0, Side::Positive, 1.0) };
    let structure = StructuralModel::new(m, k, vec![dof(0), dof(1)], vec![stop]).unwrap();
    let open = OpenModes::of_model(&structure, ModeCount::Lowest(2)).unwrap();
    let mut model = ResponseModel::new(open, &Damping::Rayleigh { mass: 0.0, stiffness: 0.03 }).unwrap();
    model.push_force(1, 1.0, 1, 0.0).unwrap();
    model.set_drive(1).unwrap();
    model
}

#[test]
fn a_period_doubling_is_located_where_a_multiplier_passes_minus_one() {
    let settings = ResponseSettings { harmonics: 10, ..ResponseSettings::new([0.6, 0.76]) };
    let curve = frequency_response(&two_masses(), 0.1, &settings).unwrap();
    let lost = curve.points.iter().find(|p| p.events.contains(&Event::PeriodDoubling)).unwrap();
    assert!(
        (lost.stability.unwrap().magnitude() - 1.0).abs() < 1e-3 && lost.stability.unwrap().angle_deg() == Some(180.0),
        "{:?}",
        lost.stability
    );
    assert!(lost.residual < 1e-9);
}

#[test]
fn two_masses_of_a_published_example_have_its_peak_with_63_harmonics() {
    let model = two_masses();
    let settings = ResponseSettings { harmonics: 63, stability: false, ..ResponseSettings::new([0.5, 0.76]) };
    let curve = frequency_response(&model, 0.1, &settings).unwrap();
    let best =
        (0..curve.points.len()).max_by(|&a, &b| curve.points[a].drive.norm().total_cmp(&curve.points[b].drive.norm()));
    let best = best.unwrap().clamp(1, curve.points.len() - 2);
    // The same curve in short steps about its highest point: a parabola through three points misses the peak by the
    // fourth power of their distance.
    let near = curve.points[best].omega;
    let settings = ResponseSettings { window: [near - 4e-4, near + 4e-4], ..settings };
    let curve = detached_response(&model, &curve.points[best], &settings).unwrap();
    let points: Vec<(f64, f64)> = curve.points.iter().map(|p| (p.omega, p.drive.norm())).collect();
    let top =
        (0..points.len()).max_by(|&a, &b| points[a].1.total_cmp(&points[b].1)).unwrap().clamp(1, points.len() - 2);
    let [a, b, c] = [points[top - 1], points[top], points[top + 1]];
    let (s, t) = ((b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0));
    let curvature = (t - s) / (c.0 - a.0);
    let at = 0.5 * (a.0 + b.0) - s / (2.0 * curvature);
    let peak = b.1 + (at - b.0) * (s + curvature * (at - a.0));
    assert!((peak - 0.9363067661).abs() < 1e-9, "{peak:.10} at {at:.10}");
}

#[test]
fn each_passage_of_a_level_is_reported_on_the_curve_of_phase_resonances() {
    for units in UNITS {
        let model = rod(units, 2, 1.0, &Damping::Ratios(vec![0.01]), 0);
        let settings = ResponseSettings { levels: vec![0.1, 0.2], ..window(units, 0.3, 0.6, 40) };
        let curve = phase_resonance(&model, 0.2, &settings).unwrap();
        let at: Vec<_> = curve.at_levels.iter().filter(|p| (p.level - 0.2).abs() < 1e-12).collect();
        assert_eq!(at.len(), 1);
        assert!((at[0].omega * units.time / TAU - 0.4400260004).abs() < 1e-8, "{}", at[0].omega * units.time / TAU);
        assert!((at[0].lag() - TAU / 4.0).abs() < 1e-9);
        assert!(curve.at_levels.iter().any(|p| (p.level - 0.1).abs() < 1e-12));
    }
}

#[test]
fn more_controlled_harmonics_bring_the_structure_nearer_to_its_mode() {
    for units in &UNITS[..2] {
        let model = rod(*units, 10, 1.0, &Damping::Ratios(vec![0.01]), 4);
        let settings = window(*units, 0.2, 0.8, 10);
        let mode = conservative_mode(&model, 1.3, &settings).unwrap();
        let last = mode.points.last().unwrap();
        let of = |n: usize| appropriation(&model, last, &[vec![(4, 1.0)]], n, &settings).unwrap();
        let all = [1, 3, 5].map(of);
        let distances = all.each_ref().map(|a| a.distance);
        assert!(distances.iter().all(|d| d.is_finite() && *d < 0.5), "{distances:?}");
        assert!(distances[0] > 2.0 * distances[1] && distances[1] > distances[2] * 0.5, "{distances:?}");
        for one in &all {
            // Each controlled harmonic gets the power that it loses; the motion differs from the mode, and the sum with
            // it.
            let power = one.power.unwrap();
            let motion = one.motion.as_ref().unwrap();
            assert!((power.active / motion.dissipated_power - 1.0).abs() < 1e-9);
            assert!(power.indicator() > 0.3 && power.indicator() <= 1.0 + 1e-12, "{}", power.indicator());
        }
    }
}

#[test]
fn a_force_over_the_level_meets_the_response_over_the_frequency() {
    for units in UNITS {
        let model = rod(units, 2, 1.0, &Damping::Ratios(vec![0.01]), 0);
        let settings = window(units, 0.3, 0.42, 9);
        let over_frequency = frequency_response(&model, 0.05, &settings).unwrap();
        let over_level = force_response(&model, 0.42 * TAU / units.time, 0.05, &settings).unwrap();
        let (a, b) = (over_frequency.points.last().unwrap(), over_level.points.last().unwrap());
        assert!(over_frequency.end.has(EndReason::FrequencyWindow) && over_level.end.has(EndReason::Limit));
        assert!((a.omega / settings.window[1] - 1.0).abs() < 1e-12);
        assert!((a.drive - b.drive).norm() < 1e-9 * a.drive.norm());
    }
}

/// `K(m)` by the arithmetic-geometric mean.
fn complete_elliptic(m: f64) -> f64 {
    let (mut a, mut g) = (1.0, (1.0 - m).sqrt());
    for _ in 0..30 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    PI / (2.0 * a)
}

/// Duffing's oscillator without damping under the load of which `A cn(p t | m)` is the response. Disturbances fulfil
/// the equation of Lamé, of which `cn dn` is a solution where `p² = 1/(1 − 5 m)`: the response turns back there, at
/// `π p/(2 K(m))`.
#[test]
fn a_fold_of_duffings_response_is_where_elliptic_functions_have_it() {
    let (m, amplitude) = (0.1_f64, 1.0_f64);
    let square = 1.0 / (1.0 - 5.0 * m);
    let (alpha, kappa) = (square * (1.0 - 2.0 * m), 2.0 * m * square / (amplitude * amplitude));
    let (k, nome) = (complete_elliptic(m), (-PI * complete_elliptic(1.0 - m) / complete_elliptic(m)).exp());
    let omega = PI * square.sqrt() / (2.0 * k);
    let one = sparse_from_triplets(1, 1, &[(0, 0, 1.0)]).unwrap();
    let dof = Dof { node: 0, position: 0.0, kind: DofKind::Axial };
    let structure = StructuralModel::new(one.clone(), one, vec![dof], Vec::new()).unwrap();
    let open = OpenModes::of_model(&structure, ModeCount::Lowest(1)).unwrap();
    let mut model = ResponseModel::new(open, &Damping::Ratios(vec![0.0])).unwrap();
    model.add_law(&vec![(0, 1.0)], Arc::new(Polynomial { coefficients: vec![0.0, 0.0, kappa] }), 64).unwrap();
    for n in (0..10).map(|j| 2 * j + 1) {
        let q = nome.powf(0.5 * f64::from(n));
        let cn = amplitude * 2.0 * PI / (m.sqrt() * k) * q / (1.0 + q * q);
        model.push_force(0, (1.0 - alpha) * cn, n as usize, 0.0).unwrap();
    }
    model.set_drive(0).unwrap();
    let settings =
        ResponseSettings { harmonics: 21, from_upper_end: true, ..ResponseSettings::new([0.9 * omega, 1.5 * omega]) };
    let curve = frequency_response(&model, 1.0, &settings).unwrap();
    let fold = curve.points.iter().find(|point| point.events.contains(&Event::Fold)).unwrap();
    assert!((fold.omega / omega - 1.0).abs() < 1e-10, "{} {omega}", fold.omega);
    let fundamental = {
        let q = nome.sqrt();
        amplitude * 2.0 * PI / (m.sqrt() * k) * q / (1.0 + q * q)
    };
    assert!((fold.drive.norm() / fundamental - 1.0).abs() < 1e-6, "{} {fundamental}", fold.drive);
}
