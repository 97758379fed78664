use std::f64::consts::TAU;

use nlmodes_linalg::{DenseLu, Mat, max_norm, symmetric_eigen};
use nlmodes_model::reduction::RestState;

use super::PlacedLaw;
use crate::periodic::structure::ModalStructure;
use crate::{Grazing, HbmError, ModeAtRest, modal_lift_off_opened};

/// Share of the squared frequency by which laws may change it where a nonlinear mode begins: its start is a linear mode
/// to that accuracy, and Newton's method does the rest.
const BARELY_NONLINEAR: f64 = 1e-4;

/// The same where displacements are of the size at which laws matter.
const NONLINEAR: f64 = 0.1;

/// Displacement of a law by a mode, over the sum of its shares, below which it is at a node.
const NODE: f64 = 1e-10;

/// Samples of a period in which that is evaluated.
const SAMPLES: usize = 64;

/// Energy with which modes begin before contacts that all touch at rest, J: those of any other are these, multiplied.
pub const UNIT_ENERGY: f64 = 1.0;

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

/// A law where it rests.
#[derive(Clone)]
struct Resting<'a> {
    placed: &'a PlacedLaw,
    /// Displacement of its place there, m.
    place: f64,
}

impl Resting<'_> {
    /// Clearance that is left, m; `None` of a law that is no stop.
    fn gap(&self) -> Option<f64> {
        self.placed.law.stop_gap().map(|gap| gap - self.place)
    }

    /// Whether it is a stop with a clearance.
    fn stands_back(&self) -> bool {
        self.gap().is_some_and(|gap| gap > 0.0)
    }

    /// Displacement of its place by a mode of unit amplitude, 1/√kg.
    fn moved(&self, shape: &[f64]) -> f64 {
        shape.iter().zip(&self.placed.modes).map(|(s, r)| s * r).sum()
    }

    /// The sum of the shares of that, without their signs.
    fn size(&self, shape: &[f64]) -> f64 {
        shape.iter().zip(&self.placed.modes).map(|(s, r)| (s * r).abs()).sum()
    }
}

/// The laws where the structure rests, which its contacts press there or, without `rest`, do not.
fn resting<'a>(structure: &'a ModalStructure, rest: Option<&RestState>) -> Vec<Resting<'a>> {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let place = |placed: &PlacedLaw| {
        rest.map_or(0.0, |rest| product(&placed.modes, &rest.eta) + product(&placed.contacts, &rest.forces))
    };
    structure.laws().iter().map(|placed| Resting { placed, place: place(placed) }).collect()
}

/// Where a nonlinear mode of a structure with laws begins: linear mode `mode` (from 1) of the structure with the
/// tangents of its laws at rest and, where its stops press there, these closed. Contacts that touch at rest without
/// force [are set back](Grazing::opening).
///
/// # Errors
/// [`HbmError::LawAtNode`] for an amplitude of a law that the mode does not move, as [`modal_lift_off_opened`] but for
/// modes that move no contact, [`HbmError::NoSuchMode`], [`HbmError::RigidBodyMode`] or [`HbmError::Linalg`].
pub fn modal_start(
    structure: &ModalStructure,
    rest: Option<&RestState>,
    mode: usize,
    start: ModeStart,
) -> Result<Grazing, HbmError> {
    let laws = resting(structure, rest);
    let m = structure.n_moving();
    let still = RestState::still(m, structure.gaps());
    let rest = rest.unwrap_or(&still);
    let Tangent { omega_squared, shape } = tangent_mode(structure, (&laws, &rest.closed), mode)?;
    let omega = omega_squared.sqrt();
    let at = ModeAtRest { mode, omega_squared, shape: &shape, rest };
    let touching = match modal_lift_off_opened(structure, at, UNIT_ENERGY) {
        Ok(touching) => Some(touching),
        Err(HbmError::NeverTouches { .. }) => None,
        Err(error) => return Err(error),
    };
    let least = touching.as_ref().map_or(f64::INFINITY, |touching| touching.amplitude.abs());
    let (first, _) = first_stop(&laws, &shape);
    let smooth: Vec<Resting> = laws.iter().filter(|law| !law.stands_back()).cloned().collect();
    let amplitude = match start {
        ModeStart::Energy(energy) => 2.0 * energy.sqrt() / omega,
        ModeStart::Amplitude(of_law) => of_law / first_law(&laws, &shape).ok_or(HbmError::LawAtNode { mode })?,
        ModeStart::Linear if smooth.is_empty() && least.min(first.abs()).is_finite() => least.min(first.abs()),
        ModeStart::Linear => {
            let largest = amplitude_within(&smooth, &shape, omega_squared, BARELY_NONLINEAR);
            largest.min(0.5 * least.min(first.abs()))
        }
    };
    // Where the displacement at the phase zero is toward the stop that is touched first.
    let amplitude = if first.abs() <= least && first < 0.0 { -amplitude } else { amplitude };
    // Lengths of the problem are those at which laws or stops matter, not those at which the mode begins.
    let length = touching.as_ref().map_or_else(|| length(&laws, &shape, omega_squared), |found| found.length);
    let contact = touching.as_ref().map_or(0, |touching| touching.contact);
    let padded = |eta: &[f64]| eta.iter().copied().chain(std::iter::repeat(0.0)).take(structure.n_modes()).collect();
    let damping = |j: usize, k: usize| shape[j] * structure.damping().entry(j, k) * shape[k];
    let damping: f64 = (0..m).flat_map(|j| (0..m).map(move |k| (j, k))).map(|(j, k)| damping(j, k)).sum();
    let start = Grazing {
        mode,
        omega,
        damping_ratio: damping / (2.0 * omega),
        amplitude,
        energy: 0.25 * omega_squared * amplitude * amplitude,
        contact,
        length,
        lifts_off: false,
        opening: vec![0.0; structure.n_contacts()],
        mean: padded(&rest.eta),
        forces: rest.forces.clone(),
        shape: padded(&shape),
    };
    // Before contacts that touch at rest motions are those of another amplitude, away from these.
    let Some(opened) = touching.filter(Grazing::touches_at_rest) else { return Ok(start) };
    let share = amplitude.abs() / opened.amplitude.abs();
    Ok(Grazing {
        amplitude: share * opened.amplitude,
        length: share * opened.length,
        opening: opened.opening.iter().map(|by| share * by).collect(),
        ..start
    })
}

/// Amplitude at which a mode first touches a law that is a stop with a clearance, negative where that is at the phase
/// 1/2, and the clearance, m; infinite where it touches none.
fn first_stop(laws: &[Resting], shape: &[f64]) -> (f64, f64) {
    let of = |law: &Resting| {
        let gap = law.gap().filter(|gap| *gap > 0.0)?;
        let (row, size) = (law.moved(shape), law.size(shape));
        (row.abs() > NODE * size).then_some((gap / row, gap))
    };
    laws.iter().filter_map(of).min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap_or((f64::INFINITY, f64::INFINITY))
}

/// Displacement of the first law by a mode of unit amplitude, 1/√kg; none where it is at a node of the mode.
fn first_law(laws: &[Resting], shape: &[f64]) -> Option<f64> {
    let first = laws.first()?;
    let moved = first.moved(shape).abs();
    (moved > NODE * first.size(shape)).then_some(moved)
}

/// Displacement of a law, m, at which laws change the frequency of a mode by a tenth, or the clearance of the stop
/// that is touched first if that is less.
///
/// # Errors
/// As [`modal_start`].
pub fn law_length(structure: &ModalStructure, mode: usize) -> Result<f64, HbmError> {
    let laws = resting(structure, None);
    let Tangent { omega_squared, shape } = tangent_mode(structure, (&laws, &[]), mode)?;
    Ok(length(&laws, &shape, omega_squared))
}

fn length(laws: &[Resting], shape: &[f64], omega_squared: f64) -> f64 {
    let (_, gap) = first_stop(laws, shape);
    if laws.iter().all(Resting::stands_back) && gap.is_finite() {
        return gap;
    }
    let amplitude = amplitude_within(laws, shape, omega_squared, NONLINEAR);
    max_norm(laws.iter().map(|law| law.moved(shape) * amplitude)).min(gap)
}

/// `(Ω² + [Yᵀ Rᵀ] B⁻¹ [Y; K R]) φ = ω² φ` with the tangents `K` of the laws at rest, where the contacts of `Y` are
/// closed, and the flexibility between them and laws, `B = [A, H; K Hᵀ, I + K H_vv]`.
fn tangent_mode(
    structure: &ModalStructure,
    (laws, closed): (&[Resting], &[bool]),
    mode: usize,
) -> Result<Tangent, HbmError> {
    let m = structure.n_moving();
    if mode == 0 || mode > m {
        return Err(HbmError::NoSuchMode { mode, available: m });
    }
    let set: Vec<usize> = (0..closed.len()).filter(|i| closed[*i]).collect();
    let slopes: Vec<f64> = laws.iter().map(|law| law.placed.law.at(law.place, 0.0).stiffness).collect();
    let (s, n) = (set.len(), set.len() + laws.len());
    let failed = |source| HbmError::Linalg { what: "linear modes with the tangents of laws", source };
    let coupled = Mat::from_fn(n, n, |i, j| match (i.checked_sub(s), j.checked_sub(s)) {
        (None, None) => structure.static_compliance(set[i], set[j]),
        (None, Some(l)) => laws[l].placed.contacts[set[i]],
        (Some(l), None) => slopes[l] * laws[l].placed.contacts[set[j]],
        (Some(l), Some(k)) => f64::from(u8::from(l == k)) + slopes[l] * laws[l].placed.laws[k],
    });
    let row = |i: usize, k: usize| match i.checked_sub(s) {
        None => structure.rows()[(set[i], k)],
        Some(l) => laws[l].placed.modes[k],
    };
    let right = Mat::from_fn(n, m, |i, k| row(i, k) * i.checked_sub(s).map_or(1.0, |l| slopes[l]));
    let pressed = if n == 0 { right } else { DenseLu::factor(&coupled).map_err(failed)?.solve_columns(&right) };
    let entry = |i: usize, j: usize| {
        let own = if i == j { structure.omega_squared()[i] } else { 0.0 };
        own + (0..n).map(|p| row(p, i) * pressed[(p, j)]).sum::<f64>()
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
fn amplitude_within(laws: &[Resting], shape: &[f64], omega_squared: f64, share: f64) -> f64 {
    let rows: Vec<f64> = laws.iter().map(|law| law.moved(shape)).collect();
    let omega = omega_squared.sqrt();
    let change = |amplitude: f64| -> f64 {
        let of = |(resting, row): (&Resting, &f64)| {
            let Resting { placed, place } = resting;
            let tangent = placed.law.at(*place, 0.0);
            let sample = |j: usize| {
                let tau = TAU * j as f64 / SAMPLES as f64;
                let (v, rate) = (amplitude * row * tau.cos(), -omega * amplitude * row * tau.sin());
                let change = placed.law.at(place + v, rate).force - tangent.force;
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
    while change(amplitude) > share * omega_squared && amplitude > f64::MIN_POSITIVE {
        amplitude *= 0.5;
    }
    amplitude
}
