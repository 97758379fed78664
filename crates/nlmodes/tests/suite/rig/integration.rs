//! Motion without control: energy, closed forms, an independent integration, rejected input.

use std::f64::consts::{PI, TAU};

use nlmodes::rig::{
    ContactLaw, Drive, DrivePoint, Exciter, LinearStructure, ModalReduction, MotionQuantity, RigError, RigSetup,
    Sensor, SensorPlace, Shaker, Side, Stop, VirtualRig,
};

use crate::rig::beam;

/// One mode of 1 kg at 40 Hz with a stop at 1 mm.
fn oscillator(law: ContactLaw, residual: f64, side: Side) -> RigSetup {
    RigSetup {
        structure: LinearStructure { omega: vec![TAU * 40.0], damping_ratios: vec![0.0] },
        drive_point: DrivePoint { position: 0.0, shape: vec![1.0], residual: 0.0 },
        exciter: Exciter::IdealForce,
        stop: Some(Stop { position: 0.0, shape: vec![1.0], side, gap: 1e-3, law, residual }),
        sensors: vec![
            Sensor::new("x", SensorPlace::StopPoint(MotionQuantity::Displacement), 0.0),
            Sensor::new("v", SensorPlace::DrivePoint(MotionQuantity::Velocity), 0.0),
            Sensor::new("a", SensorPlace::DrivePoint(MotionQuantity::Acceleration), 0.0),
            Sensor::new("contact", SensorPlace::Stop, 0.0),
        ],
        interval: 5e-5,
        substeps: None,
        seed: 0,
    }
}

fn undamped(mut setup: RigSetup) -> RigSetup {
    setup.structure.damping_ratios.fill(0.0);
    setup
}

/// Largest relative change of energy in two seconds from a deflected shape, and the number of contacts.
fn energy_drift(setup: RigSetup, coordinates: &[f64]) -> (f64, usize) {
    let mut rig = VirtualRig::new(setup).unwrap();
    rig.set_motion(coordinates, &vec![0.0; coordinates.len()]).unwrap();
    let (start, mut drift, mut contacts) = (rig.energy(), 0.0f64, 0);
    for _ in 0..40_000 {
        let before = rig.is_closed();
        rig.advance(&Drive::OFF).unwrap();
        contacts += usize::from(rig.is_closed() && !before);
        drift = drift.max((rig.energy() / start - 1.0).abs());
    }
    (drift, contacts)
}

#[test]
fn energy_is_kept_over_two_seconds_with_either_stop() {
    let compliant = undamped(beam::setup(Exciter::IdealForce));
    let mut hard = compliant.clone();
    let residual = beam::Shapes::new().residual(beam::LENGTH);
    hard.stop = hard.stop.map(|stop| Stop { law: ContactLaw::Rigid, residual, ..stop });
    for setup in [compliant, hard] {
        let (drift, contacts) = energy_drift(setup, &[-9e-4, 2e-5, 0.0, 1e-6, 0.0, 0.0]);
        // Required: 1e-4. Rounding over 40000 steps and a hundred contacts leaves some 1e-11.
        assert!(drift < 1e-9 && contacts > 80, "{drift} {contacts}");
    }
}

#[test]
fn energy_is_kept_at_the_largest_step_and_larger_ones_are_refused() {
    // 2.5 kHz: one step would be too long, the smallest number of parts is just short enough.
    let coarse = RigSetup { interval: 4e-4, ..undamped(beam::setup(Exciter::IdealForce)) };
    let substeps = VirtualRig::new(coarse.clone()).unwrap().substeps();
    assert!(substeps > 1);
    let (drift, contacts) =
        energy_drift(RigSetup { substeps: Some(substeps), ..coarse.clone() }, &[-9e-4, 2e-5, 0.0, 0.0, 0.0, 0.0]);
    // Over 16 s the number of contacts, some 500, depends on the last digits of the modes, which the motion amplifies.
    assert!(drift < 1e-9 && contacts > 400, "{drift} {contacts}");
    let error = VirtualRig::new(RigSetup { substeps: Some(substeps - 1), ..coarse }).unwrap_err();
    assert!(matches!(error, RigError::StepTooLarge { substeps: needed, .. } if needed == substeps), "{error}");
}

/// Period of the free motion: `(π + 2 arcsin(g/a)) / ω` open, and `(π − 2 arctan(...)) / Ω` closed, with `Ω² = ω² + k`.
fn period(amplitude: f64, gap: f64, ω: f64, k: f64) -> f64 {
    let open = (PI + 2.0 * (gap / amplitude).asin()) / ω;
    let speed = ω * (amplitude * amplitude - gap * gap).sqrt();
    let closed_rate = (ω * ω + k).sqrt();
    // Closed: about the equilibrium k g / Ω² from x = g with this speed and back.
    let offset = gap - k * gap / closed_rate.powi(2);
    open + 2.0 / closed_rate * (PI / 2.0 - (offset * closed_rate / speed).atan())
}

#[test]
fn an_impact_oscillator_has_the_period_of_the_closed_form() {
    let (ω, gap, amplitude, stiffness) = (TAU * 40.0, 1e-3, 2e-3, 3e6);
    for (law, residual) in [
        (ContactLaw::Elastic { stiffness }, 0.0),
        (ContactLaw::Rigid, 1.0 / stiffness),
        (ContactLaw::Elastic { stiffness: 2.0 * stiffness }, 0.5 / stiffness),
    ] {
        for side in [Side::Positive, Side::Negative] {
            let mut rig = VirtualRig::new(oscillator(law, residual, side)).unwrap();
            rig.set_motion(&[-side.sign() * amplitude], &[0.0]).unwrap();
            let exact = period(amplitude, gap, ω, stiffness);
            // After 40 periods, and the rest up to a sampling instant by the parabola at the turning point.
            let steps = (40.0 * exact / 5e-5).round() as usize;
            (0..steps).for_each(|_| rig.advance(&Drive::OFF).unwrap());
            let rest = steps as f64 * 5e-5 - 40.0 * exact;
            let q = side.sign() * rig.modal_coordinates()[0];
            assert!((q + amplitude * (ω * rest).cos()).abs() < 1e-10 * amplitude, "{law:?} {q}");
            let v = side.sign() * rig.exact(1).unwrap();
            assert!((v - amplitude * ω * (ω * rest).sin()).abs() < 1e-9 * amplitude * ω, "{law:?} {v}");
        }
    }
}

#[test]
fn a_hard_stop_is_not_penetrated_and_a_compliant_one_by_the_force_over_its_stiffness() {
    let stiffness = 3e6;
    for (law, residual) in [(ContactLaw::Rigid, 1.0 / stiffness), (ContactLaw::Elastic { stiffness }, 0.2 / stiffness)]
    {
        let mut rig = VirtualRig::new(oscillator(law, residual, Side::Positive)).unwrap();
        rig.set_motion(&[-2e-3], &[0.0]).unwrap();
        let mut largest = 0.0f64;
        for _ in 0..5_000 {
            rig.advance(&Drive::OFF).unwrap();
            let (x, force) = (rig.exact(0).unwrap(), rig.exact(3).unwrap());
            let compression = if matches!(law, ContactLaw::Rigid) { 0.0 } else { force / stiffness };
            assert!(force >= 0.0 && (x - 1e-3 <= 1e-18) == (force == 0.0) || (x - 1e-3 - compression).abs() < 1e-15);
            largest = largest.max(force);
        }
        assert!(largest > 100.0);
    }
}

#[test]
fn steady_forced_motion_has_the_frequency_response_of_the_equations() {
    // Amplitude and phase of every channel at 41 Hz, 0.4 N, compared with the complex solution of the modal equations.
    let mut setup = beam::setup(Exciter::IdealForce);
    setup.stop = None;
    setup.sensors.retain(|sensor| !matches!(sensor.place, SensorPlace::StopPoint(_) | SensorPlace::Stop));
    setup.structure.damping_ratios.fill(0.02);
    let ω = TAU * 41.0;
    let channels = setup.sensors.clone();
    let mut rig = VirtualRig::new(setup.clone()).unwrap();
    let drive = |k: usize| Drive::sine([0.4; 2], ω * 5e-5 * k as f64, ω);
    let steps = 60_000;
    (0..steps).for_each(|k| rig.advance(&drive(k)).unwrap());
    for (index, sensor) in channels.iter().enumerate() {
        let (motion, shape, residual) = match &sensor.place {
            SensorPlace::DrivePoint(motion) => (*motion, &setup.drive_point.shape, setup.drive_point.residual),
            SensorPlace::Point { motion, shape, .. } => (*motion, shape, 0.0),
            _ => continue,
        };
        let i = num_complex::Complex64::i();
        let mut response = num_complex::Complex64::from(residual);
        for ((φ, φ_ex), ωk) in shape.iter().zip(&setup.drive_point.shape).zip(&setup.structure.omega) {
            response += φ * φ_ex / (ωk * ωk - ω * ω + 2.0 * i * 0.02 * ωk * ω);
        }
        let order = match motion {
            MotionQuantity::Displacement => 0,
            MotionQuantity::Velocity => 1,
            MotionQuantity::Acceleration => 2,
        };
        let amplitude = 0.4 * response * (i * ω).powi(order);
        let expected = (amplitude * num_complex::Complex64::cis(ω * 5e-5 * steps as f64)).re;
        // Transients decay with ζω = 5/s over 3 s: e^-15 = 3e-7.
        assert!((rig.exact(index).unwrap() - expected).abs() < 1e-6 * amplitude.norm(), "{}", sensor.name);
    }
}

#[test]
fn a_shaker_on_a_blocked_structure_has_its_closed_form() {
    // A structure that cannot move: the force follows from coil, armature and stinger alone.
    let shaker = Shaker::default();
    let setup = RigSetup {
        structure: LinearStructure { omega: vec![TAU * 40.0], damping_ratios: vec![0.1] },
        drive_point: DrivePoint { position: 0.0, shape: vec![0.0], residual: 0.0 },
        exciter: Exciter::Shaker(shaker),
        stop: None,
        sensors: vec![Sensor::new("force", SensorPlace::Excitation, 0.0)],
        interval: 5e-5,
        substeps: None,
        seed: 0,
    };
    let mut rig = VirtualRig::new(setup).unwrap();
    let ω = TAU * 300.0;
    (0..20_000).for_each(|k| rig.advance(&Drive::sine([2.0; 2], ω * 5e-5 * f64::from(k), ω)).unwrap());
    let s = num_complex::Complex64::new(0.0, ω);
    let stinger = shaker.stinger_stiffness + s * shaker.stinger_damping;
    let coil = shaker.resistance + s * shaker.inductance;
    let mechanics =
        s * s * shaker.armature_mass + s * shaker.suspension_damping + shaker.suspension_stiffness + stinger;
    let per_volt = shaker.force_constant / coil / (mechanics + s * shaker.force_constant.powi(2) / coil) * stinger;
    let expected = 2.0 * (per_volt * num_complex::Complex64::cis(ω * 1.0)).re;
    let force = rig.exact(0).unwrap();
    assert!((force - expected).abs() < 1e-9 * per_volt.norm(), "{force} {expected}");
}

/// Free chain of four masses with a massless end node and a rigid stop, in its original coordinates: `q_N = min(b,
/// g_0)` is the complementarity problem solved by hand, integrated by the Störmer-Verlet scheme.
struct Chain {
    q: [f64; 4],
    v: [f64; 4],
    gap: f64,
}

impl Chain {
    /// Springs of 1e6 N/m from the ground through all masses to the end node.
    const K: f64 = 1e6;

    fn accelerations(&self) -> [f64; 4] {
        let end = self.q[3].min(self.gap); // b = q_4: one spring holds the massless node
        let at = |i: usize| if i == 0 { 0.0 } else { self.q[i - 1] };
        let next = |i: usize| if i == 3 { end } else { self.q[i + 1] };
        std::array::from_fn(|i| Self::K * (at(i) - 2.0 * self.q[i] + next(i)))
    }

    fn step(&mut self, h: f64) {
        self.kick(0.5 * h);
        self.q.iter_mut().zip(&self.v).for_each(|(q, v)| *q += h * v);
        self.kick(0.5 * h);
    }

    fn kick(&mut self, h: f64) {
        let a = self.accelerations();
        self.v.iter_mut().zip(a).for_each(|(v, a)| *v += h * a);
    }
}

#[test]
fn a_hard_stop_moves_as_the_massless_node_in_physical_coordinates() {
    // Modes of the open chain: q_i ~ sin((2r−1) π i / (2n+1)), ω = 2 √K sin((2r−1) π / (2 (2n+1))), n = 4.
    let mode = |r: usize, i: usize| ((2 * r + 1) as f64 * PI * (i + 1) as f64 / 9.0).sin() * (4.0f64 / 9.0).sqrt();
    let omega = (0..4).map(|r| 2.0 * Chain::K.sqrt() * ((2 * r + 1) as f64 * PI / 18.0).sin()).collect();
    let setup = RigSetup {
        structure: LinearStructure { omega, damping_ratios: vec![0.0; 4] },
        drive_point: DrivePoint { position: 0.0, shape: vec![0.0; 4], residual: 0.0 },
        exciter: Exciter::IdealForce,
        stop: Some(Stop {
            position: 0.0,
            shape: (0..4).map(|r| mode(r, 3)).collect(),
            side: Side::Positive,
            gap: 0.4,
            law: ContactLaw::Rigid,
            // All modes are kept: the remainder is the massless node on its spring, 1/K_NN.
            residual: 1.0 / Chain::K,
        }),
        sensors: vec![],
        interval: 5e-5,
        substeps: None,
        seed: 0,
    };
    let start = [-0.3, -0.5, -0.6, -0.7];
    let modal: Vec<f64> = (0..4).map(|r| (0..4).map(|i| mode(r, i) * start[i]).sum()).collect();
    let mut rig = VirtualRig::new(setup).unwrap();
    rig.set_motion(&modal, &[0.0; 4]).unwrap();
    let mut chain = Chain { q: start, v: [0.0; 4], gap: 0.4 };
    for _ in 0..1000 {
        rig.advance(&Drive::OFF).unwrap();
        (0..200).for_each(|_| chain.step(2.5e-7));
    }
    let q = rig.modal_coordinates();
    for i in 0..4 {
        let x: f64 = (0..4).map(|r| mode(r, i) * q[r]).sum();
        // The phase error of the scheme is (ω h)²/24, 1e-8 of 100 rad.
        assert!((x - chain.q[i]).abs() < 2e-6, "{x} {}", chain.q[i]);
    }
}

#[test]
fn a_reduced_structure_has_the_flexibility_of_its_elements() {
    let shapes = beam::Shapes::new();
    // The tip is a node: elements and closed form agree to the solver's rounding, cond(K) 1e-16.
    let (exact, elements) = (shapes.residual(beam::LENGTH), shapes.residual_of_elements(beam::LENGTH));
    assert!((elements / exact - 1.0).abs() < 1e-4 && exact > 0.0, "{elements} {exact}");
    // Inside the first element, 73 mm long, the elements miss its own deformation under a load between its nodes.
    let x = 0.1 * beam::LENGTH;
    assert!(shapes.residual_of_elements(x) < shapes.residual(x));
}

#[test]
fn all_modes_of_a_massless_contact_model_leave_the_flexibility_of_its_node() {
    use nlmodes_fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop as Node, Support};
    use nlmodes_model::{DofKind, Drop, MasslessContactModel};
    let rod = Rod {
        material: Material::new(210e9, 9000.0).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(20.0, 5).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let model = rod.assemble(&[Node::rigid(20.0, Direction::Axial, Side::Positive, 0.5)]).unwrap();
    let model = MasslessContactModel::new(&model, &Drop).unwrap();
    let reduce = |count| ModalReduction::new(model.mass(), model.stiffness(), model.dofs(), DofKind::Axial, count);
    let tip = [(model.contact_dofs()[0], 1.0)];
    let all = reduce(4).unwrap();
    assert!((all.residual(&tip) * model.k_nn()[(0, 0)] - 1.0).abs() < 1e-9);
    assert!(reduce(2).unwrap().residual(&tip) > all.residual(&tip));
    assert_eq!(reduce(5).unwrap_err(), RigError::TooFewModes { wanted: 5, found: 4 });
}

#[test]
fn noise_is_deterministic_of_its_size_and_its_own_for_each_channel() {
    let setup = beam::with_noise(beam::setup(Exciter::IdealForce));
    let draw = |setup: RigSetup, channel| {
        let mut rig = VirtualRig::new(setup).unwrap();
        (0..20_000).map(|_| rig.read(channel).unwrap()).collect::<Vec<f64>>()
    };
    let noise = draw(setup.clone(), 0);
    assert_eq!(noise, draw(setup.clone(), 0));
    assert_ne!(noise, draw(RigSetup { seed: 2, ..setup.clone() }, 0));
    let others = draw(setup.clone(), 11);
    let correlation: f64 = noise.iter().zip(&others).map(|(a, b)| a * b / (0.02 * 0.05)).sum::<f64>() / 2e4;
    let variance = noise.iter().map(|x| x * x).sum::<f64>() / 2e4;
    // Four standard deviations of 20000 independent draws.
    assert!((variance.sqrt() / 0.02 - 1.0).abs() < 0.02 && correlation.abs() < 0.03, "{variance} {correlation}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let setup = oscillator(ContactLaw::Rigid, 1e-7, Side::Positive);
    let refused = |change: &dyn Fn(&mut RigSetup)| {
        let mut setup = setup.clone();
        change(&mut setup);
        VirtualRig::new(setup).unwrap_err()
    };
    let no_flexibility = refused(&|s| s.stop.as_mut().unwrap().residual = 0.0);
    assert!(matches!(no_flexibility, RigError::RigidStopWithoutFlexibility { .. }));
    assert!(matches!(refused(&|s| s.stop = None), RigError::NoStop { .. }));
    assert!(matches!(refused(&|s| s.structure.omega[0] = f64::NAN), RigError::NotPositive { .. }));
    assert!(matches!(refused(&|s| s.structure.damping_ratios = vec![]), RigError::ModeCount { .. }));
    assert!(matches!(refused(&|s| s.drive_point.shape = vec![1.0; 2]), RigError::ModeCount { .. }));
    assert!(matches!(refused(&|s| s.sensors[0].noise = -1.0), RigError::Negative { .. }));
    assert!(matches!(
        refused(&|s| s.exciter = Exciter::Shaker(Shaker { inductance: 0.0, ..Shaker::default() })),
        RigError::NotPositive { .. }
    ));
    assert!(matches!(refused(&|s| s.structure.omega[0] = 1e12), RigError::StepTooLarge { .. }));
    assert!(matches!(refused(&|s| s.structure.omega[0] = 1e200), RigError::NotFinite { .. }));
    let mut rig = VirtualRig::new(setup).unwrap();
    assert!(matches!(rig.read(9), Err(RigError::NoChannel { channel: 9, channels: 4 })));
    let fast = Drive::sine([1.0; 2], 0.0, 2e4);
    assert!(matches!(rig.advance(&fast), Err(RigError::DriveTooFast { .. })));
}
