//! The beam of Section 4 of the paper, driven as in its test.

use std::f64::consts::TAU;

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::response::{
    Damping, EndReason, ResponseModel, ResponseSettings, damped_mode, frequency_response, phase_resonance,
};
use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes_model::{DofKind, Drop, MasslessContactModel, Side};

fn beam() -> (ResponseModel, f64) {
    let (width, height) = (0.012, 0.020);
    let beam = Beam {
        material: Material::new(181.36e9, 7730.0).unwrap(),
        section: Section::new(width * height, width * height * height * height / 12.0).unwrap(),
        mesh: Mesh::graded(0.62975520, 21, 9.1958536).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let model = beam.assemble(&[Stop::rigid(0.62975520, Direction::Transverse, Side::Positive, 1.03e-3)]).unwrap();
    let massless = MasslessContactModel::new(&model, &Drop).unwrap();
    let open = OpenModes::of_massless(&massless, ModeCount::Lowest(20)).unwrap();
    let first = open.omega_squared()[0].sqrt();
    let mut response = ResponseModel::new(open, &Damping::Ratios(vec![0.0019])).unwrap();
    let deflection = |i: &usize| model.dofs()[*i].kind == DofKind::Deflection;
    let distance = |i: &usize| (model.dofs()[*i].position - 0.0733).abs();
    let drive = (0..model.dofs().len()).filter(deflection).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    response.push_force(drive, 1.0, 1, 0.0).unwrap();
    response.set_drive(drive).unwrap();
    (response, first)
}

#[test]
fn responses_of_the_beam_before_its_rigid_stop_reach_the_ends_of_their_window() {
    let (model, first) = beam();
    // The paper's frequency with the mass of the tip dropped.
    assert!((first / TAU - 40.1).abs() < 0.01);
    let window = [0.97 * first, 1.06 * first];
    let settings = ResponseSettings { harmonics: 5, ..ResponseSettings::new(window) };
    for level in [4.0, 6.0, 8.0] {
        let curve = frequency_response(&model, level, &settings).unwrap();
        assert!(curve.end.has(EndReason::FrequencyWindow));
        assert!((curve.points.last().unwrap().omega / window[1] - 1.0).abs() < 1e-12);
        assert!(curve.points.iter().any(|p| p.motion.contacts[0].touches > 0));
        for point in &curve.points {
            // Away from resonance the power is a thousandth of what swings to and fro, and the stop is rigid: the last
            // digit of the gaps is more than that in its force.
            let balance = point.motion.input_power / point.motion.dissipated_power - 1.0;
            let said = (point.omega / TAU, point.residual, &point.events, point.motion.contacts[0].closed_share);
            assert!(balance.abs() < 1e-9, "{level} N: {balance:e} {said:?}");
        }
    }
    let resonance = phase_resonance(&model, 8.0, &settings).unwrap();
    assert!(resonance.end.complete, "{:?}", resonance.end);
    let mode = damped_mode(&model, 3.0, &settings).unwrap();
    assert!(mode.end.complete, "{:?}", mode.end);
    // A stop does no work: the damping ratio changes by shape and harmonics alone.
    assert!(mode.points.iter().all(|p| (1e-3..4e-3).contains(&p.motion.damping_ratio())));
}
