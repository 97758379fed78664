use std::f64::consts::TAU;

use nlmodes_linalg::{DenseLu, Mat, max_norm, symmetric_eigen};

use super::PlacedLaw;
use crate::periodic::structure::ModalStructure;
use crate::{Grazing, HbmError, ModeAtRest, modal_lift_off};

/// Share of the squared frequency by which laws may change it where a nonlinear mode begins: its start is a linear mode
/// to that accuracy, and Newton's method does the rest.
const BARELY_NONLINEAR: f64 = 1e-4;

/// The same where displacements are of the size at which laws matter.
const NONLINEAR: f64 = 0.1;

/// Displacement of a law by a mode, over the sum of its shares, below which it is at a node.
const NODE: f64 = 1e-10;

/// Samples of a period in which that is evaluated, and most halvings of the amplitude, from one metre at a law on.
const SAMPLES: usize = 64;
const HALVINGS: usize = 200;

/// Squared frequency over the largest below which a mode is a rigid-body motion.
const RIGID: f64 = 1e-12;

/// Where a nonlinear mode of a structure with laws begins.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ModeStart {
    /// Where a stop is first touched, if nothing but stops is nonlinear; else so small that the other laws hardly
    /// change its frequency, and at most half of the amplitude that touches a stop.
    #[default]
    Linear,
    /// At this averaged kinetic energy, J.
    Energy(f64),
    /// At this amplitude of the first law in the linear mode, m.
    Amplitude(f64),
}

/// A linear mode of the structure with the tangents of its laws at rest.
struct Tangent {
    omega_squared: f64,
    shape: Vec<f64>,
}

/// Where a nonlinear mode of a structure with laws begins: linear mode `mode` (from 1) of the structure with the
/// tangents of its laws at rest.
///
/// # Errors
/// [`HbmError::LawAtNode`] for an amplitude of a law that the mode does not move, as [`modal_lift_off`] but for modes
/// that move no contact, [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`], [`HbmError::PressedAtRest`] or
/// [`HbmError::Linalg`].
pub fn modal_start(structure: &ModalStructure, mode: usize, start: ModeStart) -> Result<Grazing, HbmError> {
    if structure.is_pressed() {
        let contact = structure.gaps().iter().position(|g| *g < 0.0).unwrap_or(0);
        return Err(HbmError::PressedAtRest { contact, gap: structure.gaps()[contact] });
    }
    let Tangent { omega_squared, shape } = tangent_mode(structure, mode)?;
    let (m, omega) = (structure.n_moving(), omega_squared.sqrt());
    let (rest, closed) = (vec![0.0; m], vec![false; structure.n_contacts()]);
    let touching = match modal_lift_off(
        structure,
        ModeAtRest { mode, omega_squared, shape: &shape, rest: &rest, closed: &closed },
    ) {
        Ok(touching) => Some(touching),
        Err(HbmError::NeverTouches { .. }) => None,
        Err(error) => return Err(error),
    };
    let least = touching.as_ref().map_or(f64::INFINITY, |touching| touching.amplitude.abs());
    let (first, _) = first_stop(structure, &shape);
    let smooth: Vec<PlacedLaw> = structure.laws().iter().filter(|law| !stands_back(law)).cloned().collect();
    let amplitude = match start {
        ModeStart::Energy(energy) => 2.0 * energy.sqrt() / omega,
        ModeStart::Amplitude(of_law) => of_law / first_law(structure, &shape).ok_or(HbmError::LawAtNode { mode })?,
        ModeStart::Linear if smooth.is_empty() && least.min(first.abs()).is_finite() => least.min(first.abs()),
        ModeStart::Linear => {
            let largest = amplitude_within(&smooth, &shape, omega_squared, BARELY_NONLINEAR);
            largest.min(0.5 * least.min(first.abs()))
        }
    };
    // Where the displacement at the phase zero is toward the stop that is touched first.
    let amplitude = if first.abs() <= least && first < 0.0 { -amplitude } else { amplitude };
    // Lengths of the problem are those at which laws or stops matter, not those at which the mode begins.
    let length = touching.as_ref().map_or_else(|| length(structure, &shape, omega_squared), |found| found.length);
    let contact = touching.as_ref().map_or(0, |touching| touching.contact);
    let padded = |eta: &[f64]| eta.iter().copied().chain(std::iter::repeat(0.0)).take(structure.n_modes()).collect();
    let damping = |j: usize, k: usize| shape[j] * structure.damping().entry(j, k) * shape[k];
    let damping: f64 = (0..m).flat_map(|j| (0..m).map(move |k| (j, k))).map(|(j, k)| damping(j, k)).sum();
    Ok(Grazing {
        mode,
        omega,
        damping_ratio: damping / (2.0 * omega),
        amplitude,
        energy: 0.25 * omega_squared * amplitude * amplitude,
        contact,
        length,
        lifts_off: false,
        opening: vec![0.0; structure.n_contacts()],
        mean: padded(&rest),
        shape: padded(&shape),
    })
}

/// Whether a law is a stop with a clearance.
fn stands_back(law: &PlacedLaw) -> bool {
    law.law.stop_gap().is_some_and(|gap| gap > 0.0)
}

/// Amplitude at which a mode first touches a law that is a stop with a clearance, negative where that is at the phase
/// 1/2, and the clearance, m; infinite where it touches none.
fn first_stop(structure: &ModalStructure, shape: &[f64]) -> (f64, f64) {
    let of = |law: &PlacedLaw| {
        let gap = law.law.stop_gap().filter(|gap| *gap > 0.0)?;
        let terms = shape.iter().zip(&law.modes).map(|(s, r)| s * r);
        let (row, size) = (terms.clone().sum::<f64>(), terms.map(f64::abs).sum::<f64>());
        (row.abs() > NODE * size).then_some((gap / row, gap))
    };
    let all = structure.laws().iter().filter_map(of);
    all.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap_or((f64::INFINITY, f64::INFINITY))
}

/// Displacement of the first law by a mode of unit amplitude, 1/√kg; none where it is at a node of the mode.
fn first_law(structure: &ModalStructure, shape: &[f64]) -> Option<f64> {
    let moved = |law: &PlacedLaw| shape.iter().zip(&law.modes).map(|(s, r)| s * r).sum::<f64>().abs();
    let all: Vec<f64> = structure.laws().iter().map(moved).collect();
    let size = shape.iter().zip(structure.laws().first()?.modes.iter()).map(|(s, r)| (s * r).abs()).sum::<f64>();
    all.first().copied().filter(|first| *first > NODE * size)
}

/// Displacement of a law, m, at which laws change the frequency of a mode by a tenth, or the clearance of the stop
/// that is touched first if that is less.
///
/// # Errors
/// As [`modal_start`].
pub fn law_length(structure: &ModalStructure, mode: usize) -> Result<f64, HbmError> {
    let Tangent { omega_squared, shape } = tangent_mode(structure, mode)?;
    Ok(length(structure, &shape, omega_squared))
}

fn length(structure: &ModalStructure, shape: &[f64], omega_squared: f64) -> f64 {
    let (_, gap) = first_stop(structure, shape);
    let smooth: Vec<PlacedLaw> = structure.laws().iter().filter(|law| !stands_back(law)).cloned().collect();
    if smooth.is_empty() && gap.is_finite() {
        return gap;
    }
    displacement(structure, shape, amplitude_within(structure.laws(), shape, omega_squared, NONLINEAR)).min(gap)
}

/// Largest displacement of a law, m, by a mode of this amplitude.
fn displacement(structure: &ModalStructure, shape: &[f64], amplitude: f64) -> f64 {
    let moved = |law: &PlacedLaw| shape.iter().zip(&law.modes).map(|(s, r)| s * r).sum::<f64>() * amplitude;
    max_norm(structure.laws().iter().map(moved))
}

/// `(Ω² + Rᵀ (I + K H)⁻¹ K R) φ = ω² φ` with the tangents `K` of the laws at rest.
fn tangent_mode(structure: &ModalStructure, mode: usize) -> Result<Tangent, HbmError> {
    let (m, laws) = (structure.n_moving(), structure.laws());
    if mode == 0 || mode > m {
        return Err(HbmError::NoSuchMode { mode, available: m });
    }
    let slopes: Vec<f64> = laws.iter().map(|law| law.law.at(0.0, 0.0).stiffness).collect();
    let n = laws.len();
    let failed = |source| HbmError::Linalg { what: "linear modes with the tangents of laws", source };
    let coupled = Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) + slopes[i] * laws[i].laws[j]);
    let right = Mat::from_fn(n, m, |l, k| slopes[l] * laws[l].modes[k]);
    let pressed = if n == 0 { right } else { DenseLu::factor(&coupled).map_err(failed)?.solve_columns(&right) };
    let entry = |i: usize, j: usize| {
        let own = if i == j { structure.omega_squared()[i] } else { 0.0 };
        own + (0..n).map(|l| laws[l].modes[i] * pressed[(l, j)]).sum::<f64>()
    };
    let (squares, shapes) =
        symmetric_eigen(&Mat::from_fn(m, m, |i, j| 0.5 * (entry(i, j) + entry(j, i)))).map_err(failed)?;
    let largest = max_norm(squares.iter().copied());
    let omega_squared = squares[mode - 1];
    if omega_squared <= RIGID * largest {
        let first_elastic = squares.iter().position(|w| *w > RIGID * largest).map(|k| k + 1);
        return Err(HbmError::RigidBodyMode { mode, first_elastic });
    }
    Ok(Tangent { omega_squared, shape: (0..m).map(|k| shapes[(k, mode - 1)]).collect() })
}

/// The largest modal amplitude, of those that halve one metre at a law, at which the laws change the squared frequency
/// of a mode by at most this share: by their forces over a period, `(2/a) ⟨r F(a r cos τ) cos τ⟩` beside the tangent.
fn amplitude_within(laws: &[PlacedLaw], shape: &[f64], omega_squared: f64, share: f64) -> f64 {
    let rows: Vec<f64> = laws.iter().map(|law| shape.iter().zip(&law.modes).map(|(s, r)| s * r).sum()).collect();
    let omega = omega_squared.sqrt();
    let change = |amplitude: f64| -> f64 {
        let of = |(placed, row): (&PlacedLaw, &f64)| {
            let tangent = placed.law.at(0.0, 0.0);
            let sample = |j: usize| {
                let tau = TAU * j as f64 / SAMPLES as f64;
                let (v, rate) = (amplitude * row * tau.cos(), -omega * amplitude * row * tau.sin());
                let change = placed.law.at(v, rate).force - tangent.force;
                let beyond = change - tangent.stiffness * v - tangent.damping * rate;
                // Even laws push in the mean alone.
                beyond.abs() * row.abs()
            };
            (0..SAMPLES).map(sample).sum::<f64>() * 2.0 / (SAMPLES as f64 * amplitude)
        };
        laws.iter().zip(&rows).map(of).sum()
    };
    let largest = max_norm(rows.iter().copied());
    let mut amplitude = if largest > 0.0 { 1.0 / largest } else { 1.0 / max_norm(shape.iter().copied()) };
    for _ in 0..HALVINGS {
        if change(amplitude) <= share * omega_squared {
            break;
        }
        amplitude *= 0.5;
    }
    amplitude
}
