//! `modal_points.csv`: a row a record.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::experiment::extraction::{Measured, RecordExtraction};
use nlmodes::report::columns::{ModalPointRow, Numbered, Row, Sometimes};
use nlmodes::report::{ReportError, write_rows, write_rows_to};

use super::{RecordOutcome, Segment};
use crate::Failure;

/// Least number of participation columns.
const PARTICIPATIONS: usize = 2;

/// The table of records, or of the levels of a test.
pub struct Table {
    like: ModalPointRow,
    drive: Option<&'static str>,
    rows: Vec<ModalPointRow>,
}

impl Table {
    /// With the participation of so many modes, and a column for the level of the drive of a test.
    pub fn new(modes: usize, drive: Option<&'static str>) -> Self {
        let none = || Numbered(vec![None; modes.max(PARTICIPATIONS)]);
        let level = |of: &str| Sometimes((drive == Some(of)).then_some(None));
        let like = ModalPointRow {
            drive_v: level("V"),
            drive_n: level("N"),
            participation: none(),
            participation_uncertainty: none(),
            ..ModalPointRow::unknown()
        };
        Self { like, drive, rows: Vec::new() }
    }

    /// With columns for the segment of each record.
    #[must_use]
    pub fn with_segments(mut self) -> Self {
        self.like.segment = Sometimes(Some(String::new()));
        (self.like.from_s, self.like.to_s) = (Sometimes(Some(None)), Sometimes(Some(None)));
        self
    }

    /// Adds a row. Cells that a record does not give are empty.
    pub fn push(&mut self, outcome: &RecordOutcome) {
        let level = |of: &str| Sometimes((self.drive == Some(of)).then_some(outcome.level));
        let modes = self.like.participation.0.len();
        let segment = outcome.segment.as_ref();
        let instant = |of: fn(&Segment) -> f64| Sometimes(self.like.from_s.0.map(|_| segment.map(of)));
        let (from_s, to_s) = (instant(|segment| segment.from), instant(|segment| segment.to));
        let segment = segment.map_or_else(String::new, |segment| segment.name.clone());
        let extracted = outcome.result.as_ref().ok().map(|found| row(found, modes));
        self.rows.push(ModalPointRow {
            record: outcome.record.clone(),
            segment: Sometimes(self.like.segment.0.is_some().then_some(segment)),
            from_s,
            to_s,
            drive_v: level("V"),
            drive_n: level("N"),
            findings: outcome.finding_names(),
            ..extracted.unwrap_or_else(|| self.like.clone())
        });
    }

    /// What there is, as text.
    ///
    /// # Errors
    /// None but those of a writer to memory.
    pub fn into_bytes(self) -> Result<Vec<u8>, Failure> {
        let mut bytes = Vec::new();
        write_rows_to(&mut bytes, &self.like, self.rows)?;
        Ok(bytes)
    }

    /// Writes what there is; a file of that name is replaced at once.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), ReportError> {
        write_rows(path, &self.like, self.rows.iter().cloned())
    }
}

/// A value and its uncertainty, as two cells.
fn both(measured: Option<Measured>) -> [Option<f64>; 2] {
    [measured.map(|m| m.value), measured.map(|m| m.uncertainty)].map(finite)
}

fn finite(value: Option<f64>) -> Option<f64> {
    value.filter(|value| value.is_finite())
}

/// The first so many values of a list.
fn first(values: Option<&Vec<f64>>, count: usize) -> Numbered<Option<f64>> {
    Numbered((0..count).map(|k| finite(values?.get(k).copied())).collect())
}

/// What was extracted, without the columns of the test.
pub fn row(found: &RecordExtraction, modes: usize) -> ModalPointRow {
    let (modal, excitation, contact) = (found.modal.as_ref(), found.excitation.as_ref(), found.contact.as_ref());
    let impacts = contact.and_then(|c| c.restitution.as_ref()).map(|restitution| restitution.statistics());
    let stiffness = contact.and_then(|c| c.stiffness);
    let [frequency_hz, frequency_hz_uncertainty] = both(Some(found.omega.times(1.0 / TAU)));
    let [modal_amplitude, modal_amplitude_uncertainty] = both(modal.map(|m| m.amplitude));
    let [damping, damping_uncertainty] = both(modal.and_then(|m| m.damping));
    let [drive_fundamental_m, drive_fundamental_m_uncertainty] = both(excitation.map(|e| e.drive));
    let [lag_deg, lag_deg_uncertainty] = both(excitation.map(|e| e.lag.times(1f64.to_degrees())));
    let modal_lag = excitation.and_then(|e| e.modal_lag);
    let [modal_lag_deg, modal_lag_deg_uncertainty] = both(modal_lag.map(|lag| lag.times(1f64.to_degrees())));
    let [phase_indicator, phase_indicator_uncertainty] = both(excitation.and_then(|e| e.phase_indicator));
    let [pbmif, pbmif_uncertainty] = both(excitation.map(|e| e.pbmif));
    let [peak_contact_force_n, peak_contact_force_n_uncertainty] = both(contact.map(|c| c.peak_force));
    let [contact_stiffness_n_m, contact_stiffness_n_m_uncertainty] =
        both(stiffness.map(|s| Measured { value: s.stiffness, uncertainty: s.stiffness_error }));
    let [force_n, force_n_uncertainty] = both(excitation.map(|e| e.force));
    let [power_w, power_w_uncertainty] = both(excitation.map(|e| e.fundamental_power));
    let [total_power_w, total_power_w_uncertainty] = both(excitation.map(|e| e.total_power));
    let [contact_dissipation_w, contact_dissipation_w_uncertainty] = both(modal.and_then(|m| m.contact_dissipation));
    let balance = found.balance.as_ref();
    let [balance_peak_force_n, balance_peak_force_n_uncertainty] = both(balance.map(|b| b.peak_force));
    let [balance_impulse_ns, balance_impulse_ns_uncertainty] = both(balance.map(|b| b.impulse));
    let [balance_restitution, balance_restitution_uncertainty] = both(balance.and_then(|b| b.restitution));
    let [balance_stiffness_n_m, balance_stiffness_n_m_uncertainty] = both(balance.and_then(|b| b.stiffness));
    let [energy_j, energy_j_uncertainty] = both(modal.map(|m| m.kinetic_energy));
    ModalPointRow {
        frequency_hz,
        modal_amplitude,
        damping,
        drive_fundamental_m,
        lag_deg,
        modal_lag_deg,
        phase_indicator,
        pbmif,
        pbmif_harmonics: excitation.map(|e| e.power.harmonics),
        participation: first(modal.map(|m| &m.participation.factors), modes),
        participation_harmonics: modal.map(|_| found.harmonics),
        peak_contact_force_n,
        contact_stiffness_n_m,
        restitution_mean: finite(impacts.as_ref().map(|s| s.mean)),
        restitution_std: finite(impacts.as_ref().map(|s| s.std)),
        approach_speed_m_s: finite(impacts.as_ref().map(|s| s.approach)),
        impacts: impacts.as_ref().map(|s| s.n_impacts),
        contact_fraction: finite(contact.map(|c| c.closed_fraction)),
        force_n,
        power_w,
        total_power_w,
        linear_dissipation_w: finite(modal.map(|m| m.dissipation.total())),
        contact_dissipation_w,
        balance_peak_force_n,
        balance_impulse_ns,
        balance_restitution,
        balance_stiffness_n_m,
        energy_j,
        periods: Some(found.periods),
        frequency_hz_uncertainty,
        modal_amplitude_uncertainty,
        damping_uncertainty,
        drive_fundamental_m_uncertainty,
        lag_deg_uncertainty,
        modal_lag_deg_uncertainty,
        phase_indicator_uncertainty,
        pbmif_uncertainty,
        peak_contact_force_n_uncertainty,
        contact_stiffness_n_m_uncertainty,
        force_n_uncertainty,
        power_w_uncertainty,
        total_power_w_uncertainty,
        contact_dissipation_w_uncertainty,
        balance_peak_force_n_uncertainty,
        balance_impulse_ns_uncertainty,
        balance_restitution_uncertainty,
        balance_stiffness_n_m_uncertainty,
        energy_j_uncertainty,
        participation_uncertainty: first(modal.map(|m| &m.participation_uncertainty), modes),
        ..ModalPointRow::unknown()
    }
}
