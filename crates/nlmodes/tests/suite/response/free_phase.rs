//! A damped mode whose phase turns a long way from its first point to its last.

use std::f64::consts::TAU;

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::response::{Damping, ResponseModel, ResponseSettings, damped_mode};
use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes_model::{Drop, MasslessContactModel, Side};

/// A tube of 1.5 m between two supports, a rigid stop on one side at mid-span, 1 %: lengths in metres, or in
/// millimetres with forces in newtons and masses in tonnes.
fn tube(unit: f64) -> ResponseModel {
    let length = 1.5 * unit;
    let section = Section::new(1.1215e-4 * unit.powi(2), 4.0842e-9 * unit.powi(4)).unwrap();
    let section = section.with_shear_factor(0.5).unwrap();
    let beam = Beam {
        material: Material::new(200e9 / unit.powi(2), 7850.0 / unit.powi(4)).unwrap(),
        section,
        mesh: Mesh::uniform(length, 6).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Pinned,
        end: Support::Pinned,
    };
    let stop = Stop::rigid(0.5 * length, Direction::Transverse, Side::Positive, 0.3e-3 * unit);
    let massless = MasslessContactModel::new(&beam.assemble(&[stop]).unwrap(), &Drop).unwrap();
    let open = OpenModes::of_massless(&massless, ModeCount::Lowest(12)).unwrap();
    ResponseModel::new(open, &Damping::Ratios(vec![0.01])).unwrap()
}

#[test]
fn every_point_of_a_long_damped_mode_is_solved_to_rounding() {
    for unit in [1.0, 1e3] {
        let window = [15.0, 70.0].map(|f| f * TAU);
        let settings = ResponseSettings { harmonics: 7, ..ResponseSettings::new(window) };
        let curve = damped_mode(&tube(unit), 50.0, &settings).unwrap();
        assert!(curve.end.complete, "{:?}", curve.end);
        let worst = curve.points.iter().map(|point| point.residual).fold(0.0, f64::max);
        assert!(worst < 1e-10, "{worst:e}");
        for point in &curve.points {
            let power = 2.0 * point.motion.kinetic_energy * point.motion.at.xi;
            assert!((power / point.motion.dissipated_power - 1.0).abs() < 1e-11 && point.motion.at.xi > 0.0);
        }
    }
}
