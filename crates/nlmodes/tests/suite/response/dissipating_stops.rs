//! Stops on a spring with a damper beside it: against exact shooting, limits, and their power.

use std::f64::consts::TAU;

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::response::{
    Damping, ResponseCurve, ResponseError, ResponseModel, ResponsePoint, ResponseSettings, damped_mode,
    frequency_response,
};
use nlmodes_fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
use nlmodes_linalg::Mat;
use nlmodes_model::{Drop, MasslessContactModel, Side};
use nlmodes_timestep::{ForcedMotion, ForcedStructure};
use num_complex::Complex64;

/// A rod of two elements before an elastic stop, the mass of its tip left out, 1 %, a force at its middle; stop and
/// damper over `EA/L` and `√(EA ρA)`.
#[derive(Clone, Copy)]
struct Case {
    ea: f64,
    rho_a: f64,
    length: f64,
    gap: f64,
    stop: f64,
    damper: f64,
}

const UNIT: Case = Case { ea: 1.0, rho_a: 1.0, length: 1.0, gap: 1.0, stop: 3.0, damper: 0.5 };
const STEEL: Case = Case { ea: 4e7, rho_a: 1.6, length: 0.7, gap: 2e-4, stop: 3.0, damper: 0.5 };

impl Case {
    fn stiffness(&self) -> f64 {
        self.stop * self.ea / self.length
    }

    fn constant(&self) -> f64 {
        self.damper * (self.ea * self.rho_a).sqrt()
    }

    fn frequency(&self) -> f64 {
        (self.ea / self.rho_a).sqrt() / self.length
    }

    fn level(&self, force: f64) -> f64 {
        force * self.ea * self.gap / self.length
    }

    fn model(&self) -> ResponseModel {
        let rod = Rod {
            material: Material::new(self.ea, self.rho_a).unwrap(),
            area: 1.0,
            mesh: Mesh::uniform(self.length, 2).unwrap(),
            mass_matrix: MassMatrix::Consistent,
            start: Support::Clamped,
            end: Support::Free,
        };
        let stop = Stop::rigid(self.length, Direction::Axial, Side::Positive, self.gap).on_spring(self.stiffness());
        let massless = MasslessContactModel::new(&rod.assemble(&[stop]).unwrap(), &Drop).unwrap();
        let open = OpenModes::of_massless(&massless, ModeCount::Lowest(10)).unwrap();
        let mut model = ResponseModel::new(open, &Damping::Ratios(vec![0.01])).unwrap();
        model.push_force(0, 1.0, 1, 0.0).unwrap();
        model.set_drive(0).unwrap();
        if self.damper > 0.0 {
            model.add_stop_damper(0, self.constant()).unwrap();
        }
        model
    }

    fn window(&self, low: f64, high: f64, harmonics: usize) -> ResponseSettings {
        let rad = |f: f64| f * TAU * self.frequency();
        ResponseSettings { harmonics, ..ResponseSettings::new([rad(low), rad(high)]) }
    }

    fn response(&self, force: f64, low: f64, high: f64, harmonics: usize) -> ResponseCurve {
        frequency_response(&self.model(), self.level(force), &self.window(low, high, harmonics)).unwrap()
    }

    /// The exact motion near a point.
    fn exact(&self, point: &ResponsePoint) -> ForcedMotion {
        let plain = Case { damper: 0.0, ..*self }.model();
        let (of, open) = (plain.structure(), plain.open_modes());
        let damping = Mat::from_fn(1, 1, |_, _| of.damping().entry(0, 0));
        let mut exact =
            ForcedStructure::new(of.omega_squared(), &damping, of.rows(), open.flexibility(), of.gaps()).unwrap();
        exact.push_load(1, &[Complex64::from(open.shapes()[(0, 0)])], &[Complex64::default()]).unwrap();
        exact.push_damped_stop(0, self.stiffness(), self.constant()).unwrap();
        let motion = &point.motion;
        let sum = |z: &[Vec<Complex64>], order: i32| -> f64 {
            let nu = |n: usize| Complex64::new(0.0, n as f64 * motion.at.omega);
            z.iter().enumerate().map(|(n, z)| (nu(n).powi(order) * z[0]).re).sum()
        };
        let near = [sum(&motion.eta, 0), sum(&motion.eta, 1), sum(&motion.stops, 0)];
        exact.periodic(point.level, point.omega, 1, &near).unwrap()
    }
}

/// The powers that the modes and the stop take out of a motion, from its amplitudes.
fn lost(case: &Case, model: &ResponseModel, point: &ResponsePoint) -> [f64; 2] {
    let (motion, own) = (&point.motion, model.structure().damping().entry(0, 0));
    let sum = |z: &[Vec<Complex64>], factor: f64| -> f64 {
        let nu = |n: usize| n as f64 * motion.at.omega;
        z.iter().enumerate().map(|(n, z)| 0.5 * factor * (nu(n) * z[0].norm()).powi(2)).sum()
    };
    [sum(&motion.eta, own), sum(&motion.stops, case.constant())]
}

#[test]
fn responses_are_those_of_exact_shooting_and_their_power_balances() {
    for case in [UNIT, STEEL] {
        let model = case.model();
        let mut errors = Vec::new();
        for harmonics in [10, 40] {
            let curve = case.response(0.2, 0.3, 0.6, harmonics);
            assert!(curve.end.complete, "{:?}", curve.end);
            let touching: Vec<&ResponsePoint> =
                curve.points.iter().filter(|p| p.motion.contacts[0].peak_force > 0.0).collect();
            assert!(touching.len() > 10);
            for point in &touching {
                let balance = point.motion.input_power / point.motion.dissipated_power - 1.0;
                assert!(balance.abs() < 1e-12, "{balance:e}");
                let [modes, stop] = lost(&case, &model, point);
                assert!(stop > 0.0 && ((modes + stop) / point.motion.dissipated_power - 1.0).abs() < 1e-12);
            }
            let mut worst = [0.0_f64; 4];
            for point in touching.iter().step_by(touching.len() / 5) {
                let (exact, contact) = (case.exact(point), &point.motion.contacts[0]);
                let shape = model.open_modes().shapes()[(0, 0)];
                let drive = exact.modal_harmonic(0, 1) * shape;
                // The body comes as far as the stop gives way.
                let reach = contact.peak - case.gap;
                let off = [
                    (point.drive - drive).norm() / drive.norm(),
                    contact.peak_force / exact.peak_force(0) - 1.0,
                    contact.closed_share - exact.closed_share(0),
                    point.stability.unwrap().magnitude() - exact.multipliers[0].norm(),
                ];
                assert!(reach > 0.0 && reach < exact.peak_force(0) / case.stiffness());
                worst = [0, 1, 2, 3].map(|i| worst[i].max(off[i].abs()));
            }
            errors.push(worst);
        }
        let [coarse, fine] = errors[..] else { panic!("two numbers of harmonics") };
        // The velocity of the stop has corners, so errors fall with the second power of the number of harmonics.
        assert!(fine[0] < 5e-4 && fine[1] < 2e-2 && fine[2] < 1e-3 && fine[3] < 5e-3, "{coarse:?} {fine:?}");
        assert!(fine[0] < 0.1 * coarse[0] && (0..4).all(|i| fine[i] < 0.25 * coarse[i]), "{coarse:?} {fine:?}");
    }
}

#[test]
fn a_damped_mode_holds_the_power_of_its_stop() {
    for case in [UNIT, STEEL] {
        let curve = damped_mode(&case.model(), 20.0, &case.window(0.3, 0.7, 15)).unwrap();
        assert!(curve.end.complete, "{:?}", curve.end);
        assert!((curve.points[0].motion.damping_ratio() - 0.01).abs() < 1e-10);
        for point in &curve.points {
            let power = 2.0 * point.motion.kinetic_energy * point.motion.at.xi;
            assert!((power / point.motion.dissipated_power - 1.0).abs() < 1e-11);
        }
        let plain = Case { damper: 0.0, ..case };
        let elastic = damped_mode(&plain.model(), 20.0, &plain.window(0.3, 0.7, 15)).unwrap();
        let last = |curve: &ResponseCurve| curve.points.last().unwrap().motion.damping_ratio();
        assert!(last(&curve) > 1.5 * last(&elastic), "{} {}", last(&curve), last(&elastic));
    }
}

#[test]
fn a_vanishing_damper_leaves_the_elastic_stop_and_one_that_is_felt_lowers_the_peak() {
    let peak = |case: Case| {
        let curve = case.response(0.2, 0.3, 0.6, 25);
        assert!(curve.end.complete);
        curve.points.iter().map(|p| p.drive.norm()).fold(0.0, f64::max)
    };
    let elastic = peak(Case { damper: 0.0, ..UNIT });
    let nearly = peak(Case { damper: 1e-5, ..UNIT });
    assert!((nearly / elastic - 1.0).abs() < 1e-3, "{nearly} {elastic}");
    let weak = peak(Case { damper: 0.1, ..UNIT });
    assert!(weak < 0.98 * elastic, "{weak} {elastic}");
}

#[test]
fn dampers_that_cannot_be_are_refused() {
    let mut model = Case { damper: 0.0, ..UNIT }.model();
    assert!(matches!(model.add_stop_damper(0, -1.0), Err(ResponseError::Setting { .. })));
    assert!(matches!(model.add_stop_damper(3, 1.0), Err(ResponseError::Problem(_))));
    model.add_stop_damper(0, 1.0).unwrap();
    assert!(matches!(model.add_stop_damper(0, 1.0), Err(ResponseError::Problem(_))));
}
