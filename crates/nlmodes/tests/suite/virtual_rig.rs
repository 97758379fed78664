//! The backbone that the loop finds on the virtual rig against the computed one of the same modes and the same stop.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, ResonanceRule, compute_branch};
use nlmodes::experiment::extraction::ExtractionSettings;
use nlmodes::experiment::phase_loop::{
    EmergencyReason, LevelSchedule, Limits, LoopSettings, Resonance, SteadyCriteria, TestSettings,
};
use nlmodes::fem::{Beam, MassMatrix, Material, Mesh, Section, Support};
use nlmodes::linalg::sparse_from_triplets;
use nlmodes::modal::ModalBranch;
use nlmodes::model::{Contact, ContactLaw, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};
use nlmodes::rig::{ControlChannels, Exciter, ModalReduction, RigError, Session, Shaker, VirtualTest};
use nlmodes::virtual_test::{self, Bench, BenchNoise, BenchPoint, BenchStop, DRIVE_DISPLACEMENT, FORCE};
use num_complex::Complex64;

const LENGTH: f64 = 0.62975520;
/// Table 1 of the paper.
const FREQUENCIES_HZ: [f64; 6] = [40.10, 268.62, 758.26, 1371.82, 2427.72, 3508.31];
const DAMPING_RATIOS: [f64; 6] = [0.0019, 0.0076, 0.0005, 0.0017, 0.0010, 0.0014];
const STIFFNESS: f64 = 2.3e6;
const GAP: f64 = 1.03e-3;

/// The finite-element beam of the paper with its bench: stop at the tip, exciter at a tenth of the length.
fn bench(exciter: Exciter) -> (Bench, ModalReduction) {
    let beam = Beam {
        material: Material::new(187.60e9, 7730.0).unwrap(),
        section: Section::rectangle(0.012, 0.020).unwrap(),
        mesh: Mesh::graded(LENGTH, 21, 9.1958536).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let model = beam.assemble(&[]).unwrap();
    let reduction = ModalReduction::new(model.mass(), model.stiffness(), model.dofs(), DofKind::Deflection, 6).unwrap();
    let point = |position: f64| BenchPoint { position, weights: beam.deflection_at(model.dofs(), position).unwrap() };
    let law = ContactLaw::Elastic { stiffness: STIFFNESS };
    let bench = Bench {
        omega: FREQUENCIES_HZ.map(|hz| TAU * hz).to_vec(),
        damping_ratios: DAMPING_RATIOS.to_vec(),
        drive: point(0.1 * LENGTH),
        stop: Some(BenchStop { at: point(LENGTH), side: Side::Positive, gap: GAP, law }),
        accelerometers: [0.20, 0.31, 0.39, 0.48, 0.55, 0.59].map(point).to_vec(),
        exciter,
        interval: 5e-5,
        noise: BenchNoise { force: 0.02, displacement: 5e-8, velocity: 2e-5, acceleration: 0.05, contact_force: 0.1 },
        seed: 1,
        chains: Vec::new(),
    };
    (bench, reduction)
}

fn loop_settings() -> LoopSettings {
    let resonance = Resonance { omega: TAU * FREQUENCIES_HZ[0], damping_ratio: DAMPING_RATIOS[0] };
    LoopSettings::new(resonance, TAU * 40.0, 5e-5)
}

/// The modes as degrees of freedom, and the massless tip of the stop's spring: `K = [Λ + k φ φᵀ, −k φ; −k φᵀ, k]`.
fn modal_model(tip: &[f64]) -> MasslessContactModel {
    let (mut k, mut m) = (vec![(6, 6, STIFFNESS)], Vec::new());
    for (i, hz) in FREQUENCIES_HZ.iter().enumerate() {
        m.push((i, i, 1.0));
        k.push((i, i, (TAU * hz).powi(2)));
        k.extend([(i, 6, -STIFFNESS * tip[i]), (6, i, -STIFFNESS * tip[i])]);
        k.extend((0..6).map(|j| (i, j, STIFFNESS * tip[i] * tip[j])));
    }
    let [stiffness, mass] = [k, m].map(|entries| sparse_from_triplets(7, 7, &entries).unwrap());
    let dof = |node| Dof { node, position: node as f64, kind: DofKind::Deflection };
    let stop = Contact::rigid(6, Side::Positive, GAP);
    let model = StructuralModel::new(mass, stiffness, (0..7).map(dof).collect(), vec![stop]).unwrap();
    MasslessContactModel::new(&model, &Drop).unwrap()
}

/// Conservative backbone with twenty harmonics, past its internal resonances, from contact to 42.5 Hz.
fn backbone(tip: &[f64]) -> ModalBranch {
    let settings = BranchSettings {
        harmonics: 20,
        internal_resonance: ResonanceRule::Skip,
        frequency_hz: Some([40.0, 42.5]),
        ..BranchSettings::default()
    };
    compute_branch(modal_model(tip), &settings, |_| ControlFlow::Continue(())).unwrap().branch
}

/// Distance, Hz, from `hz` to the nearest frequency of the branch at this modal amplitude.
fn distance(branch: &ModalBranch, amplitude: f64, hz: f64) -> f64 {
    let crossing = |pair: &[nlmodes::modal::ModalPoint]| {
        let [a, b] = [&pair[0], &pair[1]].map(|point| (point.modal_amplitude, point.omega / TAU));
        let share = (amplitude - a.0) / (b.0 - a.0);
        (0.0..=1.0).contains(&share).then_some(hz - (a.1 + share * (b.1 - a.1)))
    };
    branch.points.windows(2).filter_map(crossing).min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN)
}

/// `√Σ |q_k,1|²` of eqs. (21), (22) over forty periods, from the modal coordinates themselves: only the loop is on
/// trial here.
fn modal_amplitude(session: &mut Session) -> f64 {
    let samples = (40.0 * TAU / session.state().phase().omega() / 5e-5).round() as usize;
    let (mut sums, mut weights) = ([Complex64::ZERO; 6], 0.0);
    for k in 0..samples {
        let weight = (std::f64::consts::PI * (k as f64 + 0.5) / samples as f64).sin().powi(4);
        let wave = Complex64::cis(-session.state().phase().drive_phase()) * (2.0 * weight);
        sums.iter_mut().zip(session.rig().modal_coordinates()).for_each(|(sum, q)| *sum += wave * q);
        weights += weight;
        session.step().unwrap();
    }
    sums.iter().map(|sum| (sum / weights).norm_sqr()).sum::<f64>().sqrt()
}

#[test]
fn the_loop_follows_the_computed_backbone_from_contact_to_42_hertz() {
    let (bench, reduction) = bench(Exciter::IdealForce);
    let setup = Bench { noise: BenchNoise::default(), ..bench }.setup(&reduction);
    let branch = backbone(&setup.stop.as_ref().unwrap().shape);
    assert!(branch.end.complete, "{:?}", branch.end);
    let control = TestSettings::new(loop_settings(), LevelSchedule::new(&[4.2]).unwrap());
    let mut session = Session::new(setup, &control, ControlChannels::new(FORCE, DRIVE_DISPLACEMENT)).unwrap();
    session.run(2.0).unwrap();
    let mut reached = 0.0;
    for level in [4.4, 4.7, 5.0, 5.4, 5.6, 7.0] {
        session.go(level, 1.0).unwrap();
        let (_, findings) = session.settle(&SteadyCriteria::default()).unwrap();
        assert!(findings.is_empty(), "{level} N: {findings:?}");
        let hz = session.record(1.0).unwrap().1.omega / TAU;
        let amplitude = modal_amplitude(&mut session);
        let off = distance(&branch, amplitude, hz);
        assert!(off.abs() < 0.1, "{level} N: {hz} Hz, {amplitude} m√kg, off by {off} Hz");
        reached = hz;
    }
    assert!(reached > 41.8, "{reached}");
}

#[test]
fn levels_before_one_that_fails_are_kept() {
    let (bench, reduction) = bench(Exciter::IdealForce);
    let settling = SteadyCriteria { longest: 0.2, ..SteadyCriteria::default() };
    let levels = LevelSchedule { settling, record: 0.2, ..LevelSchedule::new(&[1.0, 5.0, 2.0]).unwrap() };
    // The force of the second level is above its limit.
    let limits = Limits { force: 3.0, ..Limits::default() };
    let test = VirtualTest {
        rig: bench.setup(&reduction),
        control: TestSettings { limits, ..TestSettings::new(loop_settings(), levels) },
        channels: ControlChannels::new(FORCE, DRIVE_DISPLACEMENT),
        harmonics: None,
    };
    let run = virtual_test::run(&test, &ExtractionSettings::default(), |_| {});
    assert_eq!((run.levels.len(), run.levels[0].outcome.level), (1, 1.0));
    let reason = EmergencyReason::Force;
    assert!(matches!(run.failure, Some(RigError::Stopped { reason: r, .. }) if r == reason), "{:?}", run.failure);
}

#[test]
fn a_bench_is_tested_and_its_levels_are_extracted() {
    let (bench, reduction) = bench(Exciter::Shaker(Shaker::default()));
    let settings = ExtractionSettings {
        linear_modes: Some(bench.linear_modes(&reduction).unwrap()),
        stop: bench.extraction_stop(),
        pbmif_harmonics: Some(50),
        ..ExtractionSettings::default()
    };
    let test = VirtualTest {
        rig: bench.setup(&reduction),
        control: TestSettings::new(loop_settings(), LevelSchedule::new(&[0.75, 2.0]).unwrap()),
        channels: ControlChannels::new(FORCE, DRIVE_DISPLACEMENT),
        harmonics: None,
    };
    let virtual_test::TestRun { levels, failure } = virtual_test::run(&test, &settings, |_| {});
    assert!(failure.is_none(), "{failure:?}");
    let points: Vec<_> = levels
        .iter()
        .map(|level| {
            assert_eq!(level.finding_names(), "");
            level.extraction.as_ref().unwrap().modal_point().unwrap()
        })
        .collect();
    // The drive point has the residual flexibility of the elements, a few percent less than the exact one inside an
    // element.
    assert!((points[0].omega / TAU - 40.1007).abs() < 1e-3, "{}", points[0].omega / TAU);
    let branch = backbone(&test.rig.stop.as_ref().unwrap().shape);
    let off = distance(&branch, points[1].modal_amplitude, points[1].omega / TAU);
    assert!(off.abs() < 0.1 && points[1].peak_contact_force > 30.0, "{off}");
}
