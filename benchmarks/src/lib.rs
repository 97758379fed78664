//! The structures that benches (`benches/`) and studies (`examples/`) are about, and the kernels whose cost is watched.

use std::f64::consts::TAU;
use std::time::Duration;

use nlmodes::experiment::phase_loop::{LevelSchedule, LoopSettings, Resonance, TestSettings};
use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes::model::{ContactLaw, DofKind, Drop, MasslessContactModel, Side, StructuralModel};
use nlmodes::rig::{ControlChannels, Exciter, ModalReduction, Session};
use nlmodes::virtual_test::{Bench, BenchNoise, BenchPoint, BenchStop, DRIVE_DISPLACEMENT, FORCE};
use rustix::time::{ClockId, clock_gettime};

pub mod free_modes;
pub mod kernels;
pub mod verification;

/// Whatever goes wrong.
pub type Failure = Box<dyn std::error::Error>;

/// The rod of Section 3 of the paper.
///
/// # Errors
/// None, with positive `elements`.
pub fn rod(elements: usize, mass_matrix: MassMatrix) -> Result<MasslessContactModel, Failure> {
    let stop = Stop::rigid(20.0, Direction::Axial, Side::Positive, 0.5);
    Ok(MasslessContactModel::new(&rod_before(stop, elements, mass_matrix)?, &Drop)?)
}

/// The same rod with the mass of its tip, before a spring of `stiffness`, N/m, in the place of the rigid stop: for
/// conventional harmonic balance.
///
/// # Errors
/// Without elements.
pub fn rod_before_a_spring(elements: usize, stiffness: f64) -> Result<MasslessContactModel, Failure> {
    let stop = Stop::rigid(20.0, Direction::Axial, Side::Positive, 0.5).on_spring(stiffness);
    let model = rod_before(stop, elements, MassMatrix::Consistent)?;
    Ok(MasslessContactModel::with_spring_tips(&model, None)?)
}

fn rod_before(stop: Stop, elements: usize, mass_matrix: MassMatrix) -> Result<StructuralModel, Failure> {
    let rod = Rod {
        material: Material::new(210e9, 9000.0)?,
        area: 1.0,
        mesh: Mesh::uniform(20.0, elements)?,
        mass_matrix,
        start: Support::Clamped,
        end: Support::Free,
    };
    Ok(rod.assemble(&[stop])?)
}

/// Clamped-free rod with `EA = ρA = L = 1` and a rigid stop at a distance of 1 from its tip, consistent mass.
///
/// # Errors
/// None, with positive `elements`.
pub fn unit_rod(elements: usize) -> Result<StructuralModel, Failure> {
    let rod = Rod {
        material: Material::new(1.0, 1.0)?,
        area: 1.0,
        mesh: Mesh::uniform(1.0, elements)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    Ok(rod.assemble(&[Stop::rigid(1.0, Direction::Axial, Side::Positive, 1.0)])?)
}

/// Length of the beam of Section 4 of the paper, m.
pub const BEAM_LENGTH: f64 = 0.629_755_20;

/// Gap of its stop, m.
pub const BEAM_GAP: f64 = 1.03e-3;

fn beam_of(youngs_modulus: f64, mesh: Mesh) -> Result<Beam, Failure> {
    Ok(Beam {
        material: Material::new(youngs_modulus, 7730.0)?.with_poissons_ratio(0.3)?,
        section: Section::rectangle(0.012, 0.020)?.with_shear_factor(5.0 / 6.0)?,
        mesh,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    })
}

/// The beam of Section 4 of the paper, before the mass of its contact node is dropped.
///
/// # Errors
/// None.
pub fn beam_structure() -> Result<StructuralModel, Failure> {
    let beam = beam_of(181.36e9, Mesh::graded(BEAM_LENGTH, 21, 9.195_853_6)?)?;
    Ok(beam.assemble(&[Stop::rigid(BEAM_LENGTH, Direction::Transverse, Side::Positive, BEAM_GAP)])?)
}

/// The beam of Section 4 of the paper, the mass of its contact node dropped.
///
/// # Errors
/// None.
pub fn beam() -> Result<MasslessContactModel, Failure> {
    Ok(MasslessContactModel::new(&beam_structure()?, &Drop)?)
}

/// The cantilever over a row of ten stops of `configs/beam_ten_stops.toml`.
///
/// # Errors
/// None.
pub fn beam_with_ten_stops() -> Result<StructuralModel, Failure> {
    const GAPS: [f64; 10] =
        [1.9793e-5, 7.4090e-5, 1.5559e-4, 2.5747e-4, 3.7348e-4, 4.9803e-4, 6.2633e-4, 7.5450e-4, 8.7965e-4, 1e-3];
    let beam = Beam {
        material: Material::new(210e9, 7800.0)?.with_poissons_ratio(0.3)?,
        mesh: Mesh::uniform(0.6, 20)?,
        ..beam_of(210e9, Mesh::uniform(0.6, 20)?)?
    };
    // The tip first, as in the scene.
    let stop =
        |(i, gap): (usize, &f64)| Stop::rigid(0.06 * (i + 1) as f64, Direction::Transverse, Side::Positive, *gap);
    Ok(beam.assemble(&GAPS.iter().enumerate().rev().map(stop).collect::<Vec<_>>())?)
}

/// The bench of Section 5 under the loop, with the stop in contact: ideal force, compliant stop, noise, 20 kHz.
///
/// # Errors
/// None.
pub fn rig() -> Result<Session, Failure> {
    let (bench, reduction) = bench(ContactLaw::Elastic { stiffness: 2.3e6 })?;
    let omega = bench.omega[0];
    let resonance = Resonance { omega, damping_ratio: bench.damping_ratios[0] };
    let settings = LoopSettings::new(resonance, TAU * 40.0, bench.interval);
    let control = TestSettings::new(settings, LevelSchedule::new(&[10.0])?);
    let channels = ControlChannels::new(FORCE, DRIVE_DISPLACEMENT);
    let mut session = Session::new(bench.setup(&reduction), &control, channels)?;
    session.go(10.0, 1.0)?;
    session.run(1.0)?;
    Ok(session)
}

/// The bench of Section 5, with ideal force, noise, 20 kHz.
fn bench(law: ContactLaw) -> Result<(Bench, ModalReduction), Failure> {
    const FREQUENCIES_HZ: [f64; 6] = [40.10, 268.62, 758.26, 1371.82, 2427.72, 3508.31];
    const DAMPING_RATIOS: [f64; 6] = [0.0019, 0.0076, 0.0005, 0.0017, 0.0010, 0.0014];
    const INTERVAL: f64 = 5e-5;
    let beam = beam_of(187.60e9, Mesh::graded(BEAM_LENGTH, 21, 9.195_853_6)?)?;
    let model = beam.assemble(&[])?;
    let reduction = ModalReduction::new(model.mass(), model.stiffness(), model.dofs(), DofKind::Deflection, 6)?;
    let point = |position: f64| -> Result<BenchPoint, Failure> {
        Ok(BenchPoint { position, weights: beam.deflection_at(model.dofs(), position)? })
    };
    let accelerometers: Result<Vec<BenchPoint>, Failure> =
        [0.20, 0.31, 0.39, 0.48, 0.55, 0.59].into_iter().map(point).collect();
    let bench = Bench {
        omega: FREQUENCIES_HZ.map(|hz| TAU * hz).to_vec(),
        damping_ratios: DAMPING_RATIOS.to_vec(),
        drive: point(0.1 * BEAM_LENGTH)?,
        stop: Some(BenchStop { at: point(BEAM_LENGTH)?, side: Side::Positive, gap: BEAM_GAP, law }),
        accelerometers: accelerometers?,
        exciter: Exciter::IdealForce,
        interval: INTERVAL,
        noise: BenchNoise { force: 0.02, displacement: 5e-8, velocity: 2e-5, acceleration: 0.05, contact_force: 0.1 },
        seed: 1,
        chains: Vec::new(),
    };
    Ok((bench, reduction))
}

/// Time that the processor has spent on the calling thread; other programs on the machine do not count. Under callgrind
/// and other simulators it may go back: differences are to be taken with `saturating_sub`.
pub fn thread_time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec.unsigned_abs(), u32::try_from(now.tv_nsec).unwrap_or(0))
}

/// Processor time of one run of `work`, s: the smallest of `rounds` rounds, each of as many runs as take a few
/// milliseconds.
pub fn smallest_time<T>(rounds: usize, mut work: impl FnMut() -> T) -> f64 {
    let mut runs = 1;
    let mut time = |runs: usize| {
        let before = thread_time();
        (0..runs).for_each(|_| {
            std::hint::black_box(work());
        });
        thread_time().saturating_sub(before).as_secs_f64() / runs as f64
    };
    let mut least = time(runs);
    while runs < 1 << 20 && least * (runs as f64) < 2e-3 {
        runs *= 2;
        least = time(runs);
    }
    (1..rounds).fold(least, |least, _| least.min(time(runs)))
}
