use nlmodes_model::DofKind;

use crate::dynamics::energy_norm_squared;
use crate::error::positive;
use crate::{ClosedInterval, ContactDynamics, ModalState, Snapshot, TimestepError, Trajectory};

/// Number of instants per period at which peaks are sought.
const SAMPLES: usize = 512;

/// How far a supposedly periodic motion fails to return after one period of the full structure.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Verification {
    /// The period, s.
    pub period: f64,
    /// Energy at the beginning, kinetic and strain, J; under a steady force above that at rest.
    pub energy: f64,
    /// `√(‖Δ‖² / E)` with `‖Δ‖² = ½ Δvᵀ M Δv + ½ Δqᵀ K Δq` of the difference from the initial state, contacts open.
    pub energy_norm: f64,
    /// Largest difference in displacement, relative to the largest displacement in the period.
    pub displacement: f64,
    /// Largest difference in velocity, relative to the largest velocity in the period.
    pub velocity: f64,
    /// Largest change of the energy over the period, relative: rounding of the integration, not an error of the point.
    pub energy_drift: f64,
    /// Closed intervals, in order; one that extends beyond the end of the period counts twice here.
    pub intervals: Vec<ClosedInterval>,
    /// Closed intervals per period, over all contacts: those at both ends joined.
    pub n_intervals: usize,
    /// Share of the period in which each contact is closed.
    pub closed_share: Vec<f64>,
    /// Largest contact force, N.
    pub peak_force: f64,
}

impl Verification {
    /// Propagates `state` over `period` (s) and compares.
    ///
    /// # Errors
    /// Errors of [`ContactDynamics::propagate`]; [`TimestepError::NotPositive`] if there is no energy.
    pub fn new(dynamics: &mut ContactDynamics, state: &ModalState, period: f64) -> Result<Self, TimestepError> {
        let trajectory = dynamics.propagate(state, period)?;
        let at_rest = dynamics.energy_at_rest()?;
        let energies: Vec<f64> = trajectory.energies().iter().map(|energy| energy - at_rest).collect();
        let energy = energies.first().copied().unwrap_or(0.0);
        positive("energy of the motion (J)", energy)?;
        let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
        let missing = energy_norm_squared(
            dynamics.omega(),
            &difference(&trajectory.end.z, &state.z),
            &difference(&trajectory.end.v, &state.v),
        );
        let translations: Vec<bool> = dynamics.model().dofs().iter().map(|d| d.kind != DofKind::Rotation).collect();
        let (displacement, velocity) = gaps_over_peaks(&trajectory, &translations);
        let intervals = trajectory.closed_intervals();
        let n_contacts = dynamics.model().contacts().len();
        Ok(Self {
            period,
            energy,
            energy_norm: (missing / energy).sqrt(),
            displacement,
            velocity,
            energy_drift: energies.iter().fold(0.0_f64, |m, e| m.max((e / energy - 1.0).abs())),
            n_intervals: n_intervals(&intervals, n_contacts, period),
            closed_share: (0..n_contacts).map(|i| share(&intervals, i, period)).collect(),
            peak_force: samples(&trajectory).flat_map(|s| s.forces).fold(0.0, f64::max),
            intervals,
        })
    }
}

fn samples(trajectory: &Trajectory) -> impl Iterator<Item = Snapshot> + '_ {
    (0..=SAMPLES).map(|j| trajectory.at(trajectory.duration() * j as f64 / SAMPLES as f64))
}

/// Largest differences in displacement and velocity at the end, relative to the largest values in the period; rotations
/// are excluded.
fn gaps_over_peaks(trajectory: &Trajectory, translations: &[bool]) -> (f64, f64) {
    let largest = |x: &[f64]| x.iter().zip(translations).filter(|(_, t)| **t).fold(0.0_f64, |m, (x, _)| m.max(x.abs()));
    let gap = |a: &[f64], b: &[f64]| largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>());
    let (first, last) = (trajectory.at(0.0), trajectory.at(trajectory.duration()));
    let peaks = samples(trajectory).fold((f64::MIN_POSITIVE, f64::MIN_POSITIVE), |(q, v), s| {
        (q.max(largest(&s.displacement)), v.max(largest(&s.velocity)))
    });
    (gap(&last.displacement, &first.displacement) / peaks.0, gap(&last.velocity, &first.velocity) / peaks.1)
}

/// Closed intervals per period, over all contacts: those at both ends joined.
pub(crate) fn n_intervals(intervals: &[ClosedInterval], n_contacts: usize, period: f64) -> usize {
    intervals.len() - (0..n_contacts).filter(|&i| joins(intervals, i, period)).count()
}

/// Whether the contact is closed at both ends of the period, by two intervals that belong together.
fn joins(intervals: &[ClosedInterval], contact: usize, period: f64) -> bool {
    let of = || intervals.iter().filter(|i| i.contact == contact);
    of().count() > 1 && of().any(|i| i.from == 0.0) && of().any(|i| i.to == period)
}

pub(crate) fn share(intervals: &[ClosedInterval], contact: usize, period: f64) -> f64 {
    // An empty sum of floats is −0.
    intervals.iter().filter(|i| i.contact == contact).map(|i| (i.to - i.from) / period).sum::<f64>() + 0.0
}
