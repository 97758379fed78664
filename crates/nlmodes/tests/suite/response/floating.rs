//! Bodies that their contacts alone carry, and motions of them that no contact feels.

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::response::{Damping, Dashpot, ResponseModel, ResponseSettings, damped_mode, frequency_response};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_model::{Contact, Dof, DofKind, Side, StructuralModel};
use num_complex::Complex64;

const K: f64 = 400.0;
const STOP: f64 = 900.0;
const WEIGHT: f64 = 10.0;

/// A mass of 1 kg on one of 2 kg above an elastic base, and beside them a third of 3 kg that nothing touches; 10 N push
/// the first two down.
fn model(dashpots: &[Dashpot]) -> ResponseModel {
    let matrix = |entries: &[_]| sparse_from_triplets(3, 3, entries).unwrap();
    let mass = matrix(&[(0, 0, 1.0), (1, 1, 2.0), (2, 2, 3.0)]);
    let stiffness = matrix(&[(0, 0, K), (0, 1, -K), (1, 0, -K), (1, 1, K), (2, 2, 0.0)]);
    let dofs = (0..3).map(|node| Dof { node, position: node as f64, kind: DofKind::Axial }).collect();
    let base = Contact::rigid(1, Side::Negative, 0.1).on_spring(STOP);
    let model = StructuralModel::new(mass, stiffness, dofs, vec![base]).unwrap();
    let open = OpenModes::of_model(&model, ModeCount::Lowest(3)).unwrap();
    assert_eq!((open.n_rigid(), open.unfelt_motions()), (2, vec![1]));
    // In proportion to the masses: no strain but at the base.
    let load = open.load(&[-WEIGHT / 3.0, -2.0 * WEIGHT / 3.0, 0.0]).unwrap();
    let open = open.with_steady_force(load.modal[..2].to_vec()).unwrap();
    let mut model = ResponseModel::new(open, &Damping::Ratios(vec![0.0])).unwrap();
    model.add_dashpots(dashpots).unwrap();
    model.push_force(0, 1.0, 1, 0.0).unwrap();
    model.set_drive(0).unwrap();
    model
}

/// Two dashpots couple all modes. While the base is pressed the two masses are a chain on it, in closed form; beyond,
/// the powers are in balance; and the third mass, which is shaken too little to matter, stays.
#[test]
fn a_body_on_its_base_responds_and_what_nothing_touches_stays() {
    let dashpots = [Dashpot { at: vec![(0, 1.0)], damping: 2.0 }, Dashpot { at: vec![(2, 1.0)], damping: 1.0 }];
    let model = model(&dashpots);
    let settings = ResponseSettings { harmonics: 15, stability: false, ..ResponseSettings::new([8.0, 20.0]) };
    for (level, lets_go) in [(0.3, false), (8.0, true)] {
        let curve = frequency_response(&model, level, &settings).unwrap();
        assert!(curve.end.complete, "{level}: {:?}", curve.end);
        let opened = |point: &&nlmodes::response::ResponsePoint| point.motion.contacts[0].closed_share < 0.95;
        assert_eq!(curve.points.iter().any(|point| opened(&point)), lets_go, "{level}");
        for point in &curve.points {
            let motion = &point.motion;
            assert!((motion.contacts[0].mean_force / WEIGHT - 1.0).abs() < 1e-9);
            assert!((motion.input_power / motion.dissipated_power - 1.0).abs() < 1e-6);
            let third = model.displacement(&model.row(2).unwrap(), motion, 1);
            assert!(third.iter().all(|q| q.norm() < 1e-12), "{third:?}");
            if !lets_go {
                let omega = point.omega;
                let upper = Complex64::new(K - omega * omega, 2.0 * omega);
                let lower = K + STOP - 2.0 * omega * omega;
                let expected = level / (upper - K * K / lower);
                assert!((point.drive / expected - 1.0).norm() < 1e-9, "{omega}: {} {expected}", point.drive);
            }
        }
    }
    // The first mode counts behind the motion that nothing feels.
    let settings = ResponseSettings { harmonics: 5, mode: 2, stability: false, ..ResponseSettings::new([8.0, 20.0]) };
    let mode = damped_mode(&model.without_load(), 2.0, &settings).unwrap();
    let squares = [K + (K + STOP) / 2.0, K * STOP / 2.0];
    let first = (0.5 * squares[0] - (0.25 * squares[0] * squares[0] - squares[1]).sqrt()).sqrt();
    assert!((mode.points[0].omega / first - 1.0).abs() < 1e-2, "{} {first}", mode.points[0].omega);
}
