//! The beam of Section 4 by MS-HBM, with a rigid stop and with an elastic one, and by conventional HBM: what Section
//! 5.2 says in numbers.
//!
//! `cargo run --release --example beam_comparison -- FOLDER` prints the tables of
//! `benchmarks/results/beam_comparison.md` and writes its figures.

use std::error::Error;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::path::PathBuf;

use nlmodes::branches::{BranchSettings, ComputedBranch, compute_branch};
use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes::modal::{HarmonicBasis, HarmonicCoefficients, ModalPoint, Participation, TimeHistory};
use nlmodes::model::{Conserve, Drop, MasslessContactModel, Side, StructuralModel, linear_modes};
use nlmodes::report::{Abscissa, BranchFigure, HistoryFigure};
use num_complex::Complex64;

type Outcome<T> = Result<T, Box<dyn Error>>;

const LENGTH: f64 = 0.629_755_20;
/// Contact stiffness of Section 5.1, N/m.
const STIFFNESS: f64 = 2.3e6;
/// Modal amplitudes at which the methods are compared, m √kg; P1 and P2 are the second and the last.
const AMPLITUDES: [f64; 4] = [6e-4, 7e-4, 8e-4, 9e-4];
const SAMPLES: usize = 2048;

/// The cantilever with the Young's modulus `modulus` before its stop, on a spring where a stiffness is given.
fn beam(modulus: f64, stiffness: Option<f64>) -> Outcome<StructuralModel> {
    let beam = Beam {
        material: Material::new(modulus, 7730.0)?.with_poissons_ratio(0.3)?,
        section: Section::rectangle(0.012, 0.020)?.with_shear_factor(5.0 / 6.0)?,
        mesh: Mesh::graded(LENGTH, 21, 9.195_853_6)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(LENGTH, Direction::Transverse, Side::Positive, 1.03e-3);
    Ok(beam.assemble(&[stiffness.map_or(stop, |k| stop.on_spring(k))])?)
}

/// Without the mass of the tip, modulus updated to 40.10 Hz (Table 1).
fn ms_hbm(stiffness: Option<f64>) -> Outcome<MasslessContactModel> {
    Ok(MasslessContactModel::new(&beam(181.36e9, stiffness)?, &Drop)?)
}

/// The mass of the tip given to its neighbours, so that the modulus of the structure with its mass holds.
fn conserved(stiffness: f64) -> Outcome<MasslessContactModel> {
    Ok(MasslessContactModel::new(&beam(187.60e9, Some(stiffness))?, &Conserve)?)
}

/// With the mass of the tip, modulus updated to 40.10 Hz (Table 1).
fn hbm(stiffness: f64) -> Outcome<MasslessContactModel> {
    Ok(MasslessContactModel::with_spring_tips(&beam(187.60e9, Some(stiffness))?, None)?)
}

fn branch(model: &MasslessContactModel, label: &str, energy_ratio: f64) -> Outcome<ComputedBranch> {
    let settings =
        BranchSettings { label: label.into(), max_energy_ratio: Some(energy_ratio), ..BranchSettings::default() };
    Ok(compute_branch(model.clone(), &settings, |_| ControlFlow::Continue(()))?)
}

fn last(branch: &ComputedBranch) -> Outcome<&ModalPoint> {
    Ok(branch.branch.points.last().ok_or("a branch without points")?)
}

/// The branch up to the modal amplitude `amplitude`, by Newton's method with secants on the energy ratio.
fn up_to_amplitude(model: &MasslessContactModel, label: &str, amplitude: f64) -> Outcome<ComputedBranch> {
    let at = |ratio: f64| -> Outcome<(ComputedBranch, f64)> {
        let found = branch(model, label, ratio)?;
        let off = last(&found)?.modal_amplitude / amplitude - 1.0;
        Ok((found, off))
    };
    let (mut low, mut high) = (1.05, 6.5);
    let (mut off_low, mut off_high) = (at(low)?.1, at(high)?.1);
    for _ in 0..60 {
        // Regula falsi (Illinois): the old end's weight is halved where it stays.
        let ratio = (low * off_high - high * off_low) / (off_high - off_low);
        let (found, off) = at(ratio)?;
        if off.abs() < 1e-10 {
            return Ok(found);
        }
        if (off > 0.0) == (off_high > 0.0) {
            (high, off_high, off_low) = (ratio, off, 0.5 * off_low);
        } else {
            (low, off_low, off_high) = (ratio, off, 0.5 * off_high);
        }
    }
    Err(format!("{label}: no point with the modal amplitude {amplitude}").into())
}

/// Tip motion and force over the period of the last point.
fn history(branch: &ComputedBranch, label: &str) -> Outcome<TimeHistory> {
    Ok(branch.time_history(branch.branch.points.len() - 1, 0, SAMPLES, label)?)
}

/// Largest value of the first five harmonics of a force.
fn truncated_peak(history: &TimeHistory) -> Outcome<f64> {
    let mut basis = HarmonicBasis::new(5, SAMPLES)?;
    let mut coefficients = vec![Default::default(); 6];
    basis.analyze(&history.force[..SAMPLES], &mut coefficients);
    let mut series = vec![0.0; SAMPLES];
    basis.synthesize(&coefficients, &mut series);
    Ok(series.into_iter().fold(0.0, f64::max))
}

/// Largest difference of two displacements at the same phase, over the largest displacement.
fn displacement_difference(one: &TimeHistory, other: &TimeHistory) -> f64 {
    let pairs = one.displacement.iter().zip(&other.displacement);
    let size = one.displacement.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
    pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / size
}

/// Participation of the first two linear modes in a point, eq. (30), of harmonics 1 to `last`; the motion is even in
/// time and needs no shift.
fn participation(branch: &ComputedBranch, point: &ModalPoint, last: usize) -> Outcome<Vec<f64>> {
    let model = branch.structure.model();
    let modes = linear_modes(model.mass(), model.stiffness(), 2)?;
    let inertia = model.mass().as_ref() * &modes.shapes;
    let mut modal = HarmonicCoefficients::zeros(2, point.coefficients.n_harmonics());
    for k in 0..2 {
        for (n, value) in modal.of_mut(k).iter_mut().enumerate() {
            let projected = (0..inertia.nrows()).map(|d| point.coefficients.of(d)[n] * inertia[(d, k)]);
            *value = projected.sum::<Complex64>() / point.modal_amplitude;
        }
    }
    Ok(Participation::new(&modal, 1..=last).factors)
}

fn row(name: &str, branch: &ComputedBranch, reference: &TimeHistory) -> Outcome<String> {
    let (point, history) = (last(branch)?, history(branch, name)?);
    let impulse = history.force[..SAMPLES].iter().sum::<f64>() / SAMPLES as f64 * TAU / point.omega;
    Ok(format!(
        "| {name} | {:.4} | {:.1} | {:.1} | {:.4} | {:.2} | {} | {:.4} | {:.2} | {:.2} |",
        point.omega / TAU,
        point.peak_contact_force,
        truncated_peak(&history)?,
        impulse,
        100.0 * point.contact_fraction,
        point.contact_intervals,
        1e3 * point.peak,
        100.0 * displacement_difference(reference, &history),
        100.0 * point.harmonic_energy.last().unwrap_or(&0.0) / point.kinetic_energy,
    ))
}

fn main() -> Outcome<()> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("which folder?")?);
    std::fs::create_dir_all(&folder)?;
    let models = [
        ("MS-HBM, rigid stop", ms_hbm(None)?),
        ("MS-HBM, 2.3e6 N/m", ms_hbm(Some(STIFFNESS))?),
        ("HBM, 2.3e6 N/m", hbm(STIFFNESS)?),
        ("MS-HBM, 2.3e6 N/m, mass conserved", conserved(STIFFNESS)?),
        ("HBM, 2.3e7 N/m", hbm(10.0 * STIFFNESS)?),
        ("HBM, 2.3e5 N/m", hbm(0.1 * STIFFNESS)?),
    ];
    let mut histories: Vec<TimeHistory> = Vec::new();
    for amplitude in AMPLITUDES {
        println!("\nmodal amplitude {amplitude:e} m √kg");
        println!(
            "method | Hz | peak force N | of its 5 harmonics | impulse N s | contact % | touches | peak mm | apart % | \
                5th harmonic %"
        );
        let rigid = up_to_amplitude(&models[0].1, models[0].0, amplitude)?;
        let reference = history(&rigid, models[0].0)?;
        for (name, model) in &models {
            let found = up_to_amplitude(model, name, amplitude)?;
            println!("{}", row(name, &found, &reference)?);
            let [all, first] = [5, 1].map(|last_harmonic| participation(&found, last(&found)?, last_harmonic));
            println!("    participation, harmonics 1-5: {:.4?}, fundamental: {:.5?}", all?, first?);
            if amplitude == AMPLITUDES[3] && histories.len() < 3 {
                histories.push(history(&found, name)?);
            }
        }
    }
    let branches = models[..3].iter().map(|(name, model)| branch(model, name, 6.0)).collect::<Outcome<Vec<_>>>()?;
    for found in &branches {
        let start = &found.branch.points[0];
        println!("{}: touches at {:.5e} m √kg, {:.4} Hz", found.branch.label, start.modal_amplitude, start.omega / TAU);
        println!("    participation there: {:?}", participation(found, start, 5)?);
    }
    let curves: Vec<_> = branches.iter().map(|found| &found.branch).collect();
    let figure = BranchFigure::new(Abscissa::ModalAmplitude, &curves).title("Cantilever with a one-sided stop");
    figure.render()?.write(folder.join("beam_methods.svg"))?;
    let histories: Vec<&TimeHistory> = histories.iter().collect();
    let figure = HistoryFigure::new(&histories).title("P2: modal amplitude 9e-4 m √kg");
    figure.render()?.write(folder.join("beam_histories.svg"))?;
    Ok(())
}
