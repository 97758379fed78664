//! For any numbers: an error or a motion, no panic and no infinite loop.

use nlmodes::rig::{
    ContactLaw, Drive, DrivePoint, Exciter, LinearStructure, MotionQuantity, RigSetup, Sensor, SensorPlace, Shaker,
    Side, Stop, VirtualRig,
};
use proptest::prelude::*;

/// Ordinary magnitudes, and occasionally zero, huge, tiny, negative or NaN.
fn number(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        40 => low..high,
        1 => Just(0.0),
        1 => Just(-high),
        1 => prop::sample::select(vec![1e300, 1e-300, 1e12, 1e-12, f64::NAN, f64::INFINITY]),
    ]
}

fn shape() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(number(-3.0, 3.0), 2)
}

fn stop() -> impl Strategy<Value = Stop> {
    let law = prop_oneof![Just(ContactLaw::Rigid), number(1e3, 1e8).prop_map(|k| ContactLaw::Elastic { stiffness: k })];
    let side = prop::sample::select(vec![Side::Positive, Side::Negative]);
    (shape(), side, number(-1e-3, 2e-3), law, number(1e-9, 1e-6)).prop_map(|(shape, side, gap, law, residual)| Stop {
        position: 1.0,
        shape,
        side,
        gap,
        law,
        residual,
    })
}

fn exciter() -> impl Strategy<Value = Exciter> {
    let shaker = (number(0.5, 5.0), number(1e-5, 1e-2), number(1.0, 20.0), number(1e-3, 1.0), number(1e3, 1e7))
        .prop_map(|(resistance, inductance, force_constant, armature_mass, stinger_stiffness)| {
            let shaker = Shaker::default();
            Exciter::Shaker(Shaker {
                resistance,
                inductance,
                force_constant,
                armature_mass,
                stinger_stiffness,
                ..shaker
            })
        });
    prop_oneof![Just(Exciter::IdealForce), shaker]
}

fn setup() -> impl Strategy<Value = RigSetup> {
    let structure = (
        prop::collection::vec(number(50.0, 2e4), 2),
        prop::collection::vec(number(0.0, 0.1), 2),
        shape(),
        number(0.0, 1e-7),
    );
    (structure, stop(), exciter(), number(1e-5, 1e-3)).prop_map(
        |((omega, damping_ratios, shape, residual), stop, exciter, interval)| RigSetup {
            structure: LinearStructure { omega, damping_ratios },
            drive_point: DrivePoint { position: 0.1, shape, residual },
            exciter,
            stop: Some(stop),
            sensors: vec![
                Sensor::new("f", SensorPlace::Excitation, 0.0),
                Sensor::new("a", SensorPlace::StopPoint(MotionQuantity::Acceleration), 1.0),
                Sensor::new("c", SensorPlace::Stop, 0.0),
            ],
            interval,
            substeps: None,
            seed: 0,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn no_setup_panics_or_hangs(setup in setup(), level in number(0.0, 100.0), omega in number(10.0, 1e3)) {
        let Ok(mut rig) = VirtualRig::new(setup.clone()) else { return Ok(()) };
        for k in 0..60 {
            let drive = Drive::sine([level; 2], omega * setup.interval * f64::from(k), omega);
            if rig.advance(&drive).is_err() {
                return Ok(());
            }
            let (force, acceleration) = (rig.read(2).unwrap(), rig.read(1).unwrap());
            // For unphysical stiffness the difference of displacement and gap has no digits left.
            prop_assert!(level.abs() > 1e6 || force >= -1e-9 * (1.0 + acceleration.abs()), "contact pulls by {} \
                N", force);
        }
    }
}
