//! Harmonics of the force under control in the loop of the virtual rig, against the conservative mode of the same
//! structure and against the law itself.

use std::f64::consts::{FRAC_PI_2, TAU};

use nlmodes::experiment::phase_loop::{
    LevelSchedule, LoopSettings, PhaseLoopError, Resonance, SteadyCriteria, TestSettings,
};
use nlmodes::linalg::sparse_from_triplets;
use nlmodes::modal::LinearModes;
use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::model::{ContactLaw, Side};
use nlmodes::response::{Damping, ResponseModel, ResponsePoint, ResponseSettings, conservative_mode};
use nlmodes::rig::{
    ControlChannels, ControlledHarmonics, DrivePoint, Exciter, Finding, LinearStructure, MotionQuantity, RigError,
    RigSetup, Sensor, SensorPlace, Session, Shaker, Stop, VirtualTest,
};
use num_complex::Complex64;

const HZ: f64 = 40.0;
/// Frequencies over the first: with contact its third and fifth harmonic come near the second and the third.
const RATIOS: [f64; 3] = [1.0, 2.9, 4.8];
const MODES: usize = RATIOS.len();
const DAMPING: f64 = 0.01;
const INTERVAL: f64 = 5e-5;
const HARMONICS: usize = 20;
const DRIVE: f64 = 0.3;
const ACCELEROMETERS: [f64; 4] = [0.15, 0.55, 0.75, 0.95];
/// Channels of force, displacement at the drive point, and first accelerometer.
const CHANNELS: [usize; 3] = [0, 1, 2];

/// A structure of 1 m with the shapes of a clamped-free rod, in some system of units: its mass (kg) and the gap at its
/// end (m).
#[derive(Clone, Copy)]
struct Structure {
    mass: f64,
    gap: f64,
}

const LARGE: Structure = Structure { mass: 1.0, gap: 1e-3 };
const SMALL: Structure = Structure { mass: 3e-7, gap: 2e-6 };

impl Structure {
    /// A force that does to this one what `newtons` do to [`LARGE`].
    fn force(self, newtons: f64) -> f64 {
        newtons * self.mass * self.gap / (LARGE.mass * LARGE.gap)
    }

    fn shape(self, x: f64) -> Vec<f64> {
        (0..MODES).map(|k| (2.0 / self.mass).sqrt() * ((k as f64 + 0.5) * 0.5 * TAU * x).sin()).collect()
    }

    /// Flexibility at the rigid stop, m/N.
    fn residual(self) -> f64 {
        5e-6 / self.mass
    }

    fn setup(self, exciter: Exciter) -> RigSetup {
        let point = |x: f64| {
            let place = SensorPlace::Point { motion: MotionQuantity::Acceleration, position: x, shape: self.shape(x) };
            Sensor::new(format!("a_{x}"), place, 0.0)
        };
        let mut sensors = vec![
            Sensor::new("force", SensorPlace::Excitation, 0.0),
            Sensor::new("x_drive", SensorPlace::DrivePoint(MotionQuantity::Displacement), 0.0),
        ];
        sensors.extend(ACCELEROMETERS.map(point));
        let stop = Stop {
            position: 1.0,
            shape: self.shape(1.0),
            side: Side::Positive,
            gap: self.gap,
            law: ContactLaw::Rigid,
            residual: self.residual(),
        };
        RigSetup {
            structure: LinearStructure { omega: omega(), damping_ratios: vec![DAMPING; MODES] },
            drive_point: DrivePoint { position: DRIVE, shape: self.shape(DRIVE), residual: 0.0 },
            exciter,
            stop: Some(stop),
            sensors,
            interval: INTERVAL,
            substeps: None,
            seed: 1,
        }
    }

    fn wanted(self, harmonics: usize) -> ControlledHarmonics {
        let places: Vec<f64> = std::iter::once(DRIVE).chain(ACCELEROMETERS).collect();
        let shapes: Vec<Vec<f64>> = places.iter().map(|x| self.shape(*x)).collect();
        let modes = LinearModes::new(&places, &omega(), &[DAMPING; MODES], &shapes).unwrap();
        ControlledHarmonics { harmonics, modes, channels: (CHANNELS[1]..=5).collect(), drive: 0 }
    }

    /// The conservative mode, by harmonic balance of the same modes before the same stop.
    fn mode(self) -> Vec<ResponsePoint> {
        let mass: Vec<_> = (0..MODES).map(|i| (i, i, 1.0)).collect();
        let stiffness: Vec<_> = omega().iter().enumerate().map(|(i, ω)| (i, i, ω * ω)).collect();
        let direction: Vec<_> = self.shape(1.0).iter().enumerate().map(|(i, s)| (i, 0, -s)).collect();
        let matrix = |columns, entries: &[(usize, usize, f64)]| sparse_from_triplets(MODES, columns, entries).unwrap();
        let (mass, stiffness, direction) = (matrix(MODES, &mass), matrix(MODES, &stiffness), matrix(1, &direction));
        let (gaps, residual) = (vec![self.gap], vec![self.residual()]);
        let open = OpenModes::new(mass, stiffness, direction, gaps, residual, ModeCount::Lowest(MODES)).unwrap();
        let model = ResponseModel::new(open, &Damping::Ratios(vec![DAMPING; MODES])).unwrap();
        let window = [0.9, 1.6].map(|ratio| ratio * TAU * HZ);
        let settings = ResponseSettings { harmonics: HARMONICS, ..ResponseSettings::new(window) };
        conservative_mode(&model, 10.0, &settings).unwrap().points
    }

    fn test(self, exciter: Exciter, levels: &[f64], harmonics: Option<ControlledHarmonics>) -> VirtualTest {
        VirtualTest {
            rig: self.setup(exciter),
            control: TestSettings::new(settings(), LevelSchedule::new(levels).unwrap()),
            channels: ControlChannels::new(CHANNELS[0], CHANNELS[1]),
            harmonics,
        }
    }

    /// A session that was held at this level of an ideal force, and what keeps it from being steady.
    fn held(self, harmonics: usize, newtons: f64) -> (Session, Vec<Finding>) {
        let wanted = (harmonics > 1).then(|| self.wanted(harmonics));
        let mut session = self.test(Exciter::IdealForce, &[self.force(1.0)], wanted).session().unwrap();
        session.run(3.0).unwrap();
        session.go(self.force(newtons), 1.0).unwrap();
        let (_, findings) = session.settle(&SteadyCriteria::default()).unwrap();
        (session, findings)
    }
}

fn omega() -> Vec<f64> {
    RATIOS.map(|ratio| TAU * HZ * ratio).to_vec()
}

fn settings() -> LoopSettings {
    LoopSettings::new(Resonance { omega: TAU * HZ, damping_ratio: DAMPING }, TAU * 39.8, INTERVAL)
}

/// Harmonics 0 to [`HARMONICS`] of the modal coordinates over forty periods, from these themselves and not from
/// sensors.
fn motion(session: &mut Session) -> Vec<Vec<Complex64>> {
    let samples = (40.0 * TAU / session.state().phase().omega() / INTERVAL).round() as usize;
    let (mut sums, mut weights) = (vec![vec![Complex64::ZERO; MODES]; HARMONICS + 1], 0.0);
    for k in 0..samples {
        let weight = (0.5 * TAU * (k as f64 + 0.5) / samples as f64).sin().powi(4);
        let theta = session.state().phase().drive_phase();
        let q = session.rig().modal_coordinates();
        for (n, sum) in sums.iter_mut().enumerate() {
            let wave = Complex64::cis(-(n as f64) * theta) * (2.0 * weight);
            sum.iter_mut().zip(&q).for_each(|(sum, q)| *sum += wave * q);
        }
        weights += weight;
        session.step().unwrap();
    }
    sums.iter_mut().flatten().for_each(|sum| *sum /= weights);
    sums
}

/// Distance of velocities from those of a mode, over the latter, with the motion turned by `turn` of the fundamental.
fn distance(q: &[Vec<Complex64>], target: &[Vec<Complex64>], turn: f64) -> f64 {
    let (mut off, mut all) = (0.0, 0.0);
    for n in 1..target.len().max(q.len()) {
        for k in 0..MODES {
            let at = |of: &[Vec<Complex64>]| of.get(n).map_or(Complex64::ZERO, |q| q[k]);
            off += (n * n) as f64 * (at(q) * Complex64::cis(n as f64 * turn) - at(target)).norm_sqr();
            all += (n * n) as f64 * at(target).norm_sqr();
        }
    }
    (off / all).sqrt()
}

/// Distance of the nearest motion of the branch, between its points by a straight line and at the best instant.
fn nearest(q: &[Vec<Complex64>], mode: &[ResponsePoint]) -> f64 {
    let mut best = f64::INFINITY;
    for pair in mode.windows(2) {
        let [a, b] = [&pair[0].motion.eta, &pair[1].motion.eta];
        for step in 0..50 {
            let share = f64::from(step) / 50.0;
            let mix = |(a, b): (&Complex64, &Complex64)| a * (1.0 - share) + b * share;
            let target: Vec<Vec<Complex64>> =
                a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(mix).collect()).collect();
            let turn = (target[1][0] * q[1][0].conj()).arg();
            for extra in -60..=60 {
                best = best.min(distance(q, &target, turn + 4e-3 * f64::from(extra)));
            }
        }
    }
    best
}

/// What the law asks for in harmonic `n` of a motion whose modal coordinates are known: `iν Σ 2ζ_kω_k|η_k|² / X̄`, N.
fn law(structure: Structure, q: &[Complex64], nu: f64) -> Complex64 {
    let taken: f64 = q.iter().zip(omega()).map(|(q, ω)| 2.0 * DAMPING * ω * q.norm_sqr()).sum();
    let at_drive: Complex64 = q.iter().zip(structure.shape(DRIVE)).map(|(q, φ)| q * φ).sum();
    Complex64::new(0.0, nu * taken) / at_drive.conj()
}

#[test]
fn each_controlled_harmonic_brings_the_motion_nearer_to_the_mode() {
    let mode = LARGE.mode();
    for newtons in [1.6, 2.0, 2.4] {
        let distances = [1, 3, 5].map(|harmonics| {
            let (mut session, findings) = LARGE.held(harmonics, newtons);
            assert!(findings.is_empty(), "{newtons} N, {harmonics}: {findings:?}");
            nearest(&motion(&mut session), &mode)
        });
        // 0.037, 0.015, 0.010; 0.039, 0.017, 0.012; 0.038, 0.021, 0.015. Where there is no contact at all it is 0.005
        // and more: a force at one point.
        let [one, three, five] = distances;
        assert!(one > 0.03 && three < 0.6 * one && five < 0.75 * three, "{newtons} N: {distances:?}");
    }
}

#[test]
fn the_force_is_what_the_law_asks_for_in_any_units() {
    let mut shares = Vec::new();
    for structure in [LARGE, SMALL] {
        let (mut session, findings) = structure.held(4, 2.0);
        assert!(findings.is_empty(), "{findings:?}");
        let omega = session.record(1.0).unwrap().1.omega;
        let force = session.state().harmonics().force().to_vec();
        let (turned, q) = (session.force_harmonics(), motion(&mut session));
        assert_eq!(force.len(), 4);
        for n in 2..=4 {
            let expected = law(structure, &q[n], n as f64 * omega);
            let off = (force[n - 1] - expected).norm() / force[0].norm();
            assert!(off < 1e-3, "harmonic {n}: {} for {expected}", force[n - 1]);
        }
        // The fundamental is in phase with the velocity, and the drive's own.
        assert!(
            (turned[0].arg() - FRAC_PI_2).abs() < 1e-3 && (turned[0].norm() / structure.force(2.0) - 1.0).abs() < 1e-3
        );
        shares.push([1, 2, 3].map(|n| turned[n] / turned[0].norm()));
    }
    let same = shares[0].iter().zip(&shares[1]).all(|(a, b)| (a - b).norm() < 1e-5);
    assert!(same && shares[0][1].norm() > 0.05, "{shares:?}");
}

#[test]
fn a_shaker_is_measured_before_its_harmonics_are_controlled() {
    let test = |harmonics| LARGE.test(Exciter::Shaker(Shaker::default()), &[0.2, 3.0], harmonics);
    let alone = test(None).run(|_| {}).unwrap();
    assert!(alone.iter().all(|level| level.force_harmonics.is_empty()));
    let levels = test(Some(LARGE.wanted(3))).run(|_| {}).unwrap();
    for level in &levels {
        assert!(level.findings.is_empty(), "{} V: {:?}", level.level, level.findings);
        assert_eq!(level.force_harmonics.len(), 3);
    }
    // Below contact there is nothing to put into the harmonics.
    let share = |level: usize, n: usize| levels[level].force_harmonics[n - 1].norm() / levels[level].steady.force;
    assert!(share(0, 2) < 1e-4 && share(0, 3) < 1e-4, "{} {}", share(0, 2), share(0, 3));
    assert!(share(1, 3) > 0.02, "{} {:?}", share(1, 3), levels[1].steady);
}

#[test]
fn a_drive_point_that_a_harmonic_does_not_move_is_said() {
    // The second mode alone takes part in the harmonic, and has a node there: 2 ζ ω |η|² / |x| has no bound.
    let mut wanted = LARGE.wanted(2);
    let blind = vec![vec![1e-9, 0.0, 0.0], LARGE.shape(0.15), LARGE.shape(0.55), LARGE.shape(0.75), LARGE.shape(0.95)];
    let places: Vec<f64> = wanted.modes.positions().to_vec();
    wanted.modes = LinearModes::new(&places, &omega(), &[0.9; MODES], &blind).unwrap();
    let mut session = LARGE.test(Exciter::IdealForce, &[2.5], Some(wanted)).session().unwrap();
    session.run(2.0).unwrap();
    let (_, findings) = session.settle(&SteadyCriteria { longest: 3.0, ..SteadyCriteria::default() }).unwrap();
    let said = findings.iter().find(|f| matches!(f, Finding::HarmonicLimit { harmonic: 2 }));
    assert!(said.is_some_and(|f| f.name() == "harmonic-limit" && f.to_string().contains("harmonic 2")), "{findings:?}");
}

#[test]
fn what_cannot_be_controlled_is_refused_before_the_test() {
    let good = LARGE.test(Exciter::IdealForce, &[1.0], Some(LARGE.wanted(3)));
    good.check().unwrap();
    let with = |change: &dyn Fn(&mut ControlledHarmonics)| {
        let mut test = good.clone();
        test.harmonics.as_mut().into_iter().for_each(change);
        test.check().unwrap_err()
    };
    let refused = with(&|wanted| wanted.harmonics = 1);
    assert!(matches!(refused, RigError::Loop(PhaseLoopError::ControlledHarmonics { harmonics: 1, .. })));
    assert!(matches!(with(&|wanted| wanted.harmonics = 9), RigError::Loop(PhaseLoopError::ControlledHarmonics { .. })));
    let refused = with(&|wanted| wanted.channels.truncate(4));
    assert!(matches!(refused, RigError::Loop(PhaseLoopError::Sensors { sensors: 4, expected: 5, drive: 0 })));
    assert!(matches!(with(&|wanted| wanted.drive = 5), RigError::Loop(PhaseLoopError::Sensors { .. })));
    assert!(matches!(with(&|wanted| wanted.channels[1] = CHANNELS[0]), RigError::ResponseQuantity { .. }));
    assert!(matches!(with(&|wanted| wanted.channels[1] = 60), RigError::NoChannel { .. }));
    // Five harmonics of twice the frequency are sampled at 1 kHz, as the loop alone needs, eight are not.
    let mut slow = good.clone();
    slow.rig.interval = 1e-3;
    (slow.control.phase.step, slow.control.phase.cut_off) = (1e-3, 10.0);
    let refused = slow.check();
    assert!(matches!(refused, Err(RigError::Loop(PhaseLoopError::AboveNyquist { harmonic: 8, .. }))), "{refused:?}");
    slow.harmonics = None;
    slow.check().unwrap();
    // Nothing answers before there is a level.
    let silent = LARGE.test(Exciter::IdealForce, &[0.0], Some(LARGE.wanted(3))).session();
    assert!(matches!(silent, Err(RigError::NotPositive { what: "level", .. })));
}
