use std::path::Path;

use super::archive::{write_archive, write_array, write_numbers, write_texts};
use crate::ReportError;
use crate::columns::Column;

/// Arrays of `transient.npz`.
pub const TRANSIENT_ARRAYS: [Column; 10] = [
    Column::new("time_s", "T, s", "instants, from the beginning of the motion"),
    Column::new("place", "P", "names of the places, and of the contacts behind them"),
    Column::new(
        "displacement_m",
        "P × T, m",
        "displacement of each place in its direction and of each contact toward its stop, from the drawing; relative \
            to a base that shakes",
    ),
    Column::new("velocity_m_s", "P × T, m/s", "its rate"),
    Column::new("force_n", "C × T, N", "force of each contact, positive away from the stop"),
    Column::new("envelope_time_s", "W, s", "middles of the windows of the envelope"),
    Column::new("envelope_max_m", "P × W, m", "largest displacement in each window, of the instants in it"),
    Column::new("envelope_min_m", "P × W, m", "smallest one"),
    Column::new("spectrum_frequency_hz", "F, Hz", "multiples of the inverse of the duration"),
    Column::new(
        "spectrum_m",
        "P × F, m",
        "amplitude of the displacement at each frequency, with a window of Hann: a steady cosine reads its amplitude",
    ),
];

/// The histories of a motion in time, and what is made of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TransientHistories {
    /// Instants, s.
    pub time: Vec<f64>,
    /// Names of the places.
    pub places: Vec<String>,
    /// Displacement of each, m.
    pub displacement: Vec<Vec<f64>>,
    /// Velocity of each, m/s.
    pub velocity: Vec<Vec<f64>>,
    /// Force of each contact, N.
    pub force: Vec<Vec<f64>>,
    /// Of each place the middle (s), the largest and the smallest value (m) of each window.
    pub envelope: Vec<Vec<[f64; 3]>>,
    /// Frequencies of the spectra, Hz.
    pub frequency: Vec<f64>,
    /// Of each place the amplitudes at these, m.
    pub spectrum: Vec<Vec<f64>>,
}

/// Writes the histories of a motion in time as a NumPy archive with the arrays of `columns::FILES`.
///
/// # Errors
/// [`ReportError::SeriesLength`] if a history has another number of instants than the others, [`ReportError::Io`] if
/// the file cannot be written.
pub fn write_transient(path: impl AsRef<Path>, of: &TransientHistories) -> Result<(), ReportError> {
    let (instants, windows) = (of.time.len(), of.envelope.first().map_or(0, Vec::len));
    let lengths = |series: &'static str, all: &[Vec<f64>], expected: usize| {
        let wrong = all.iter().map(Vec::len).find(|found| *found != expected);
        let label = || "motion in time".to_owned();
        wrong.map_or(Ok(()), |found| Err(ReportError::SeriesLength { label: label(), series, found, expected }))
    };
    lengths("displacement_m", &of.displacement, instants)?;
    lengths("velocity_m_s", &of.velocity, instants)?;
    lengths("force_n", &of.force, instants)?;
    lengths("spectrum_m", &of.spectrum, of.frequency.len())?;
    let envelope = |part: usize| of.envelope.iter().flatten().map(move |window| window[part]);
    let middles: Vec<f64> = of.envelope.first().into_iter().flatten().map(|window| window[0]).collect();
    let places: Vec<&str> = of.places.iter().map(String::as_str).collect();
    write_archive(path.as_ref(), |archive| {
        write_numbers(archive, "time_s", &of.time)?;
        write_texts(archive, "place", &places)?;
        for (name, all, length) in [
            ("displacement_m", &of.displacement, instants),
            ("velocity_m_s", &of.velocity, instants),
            ("force_n", &of.force, instants),
            ("spectrum_m", &of.spectrum, of.frequency.len()),
        ] {
            write_array(archive, name, &[all.len(), length], all.iter().flatten().copied())?;
        }
        write_numbers(archive, "envelope_time_s", &middles)?;
        write_array(archive, "envelope_max_m", &[of.envelope.len(), windows], envelope(1))?;
        write_array(archive, "envelope_min_m", &[of.envelope.len(), windows], envelope(2))?;
        write_numbers(archive, "spectrum_frequency_hz", &of.frequency)
    })
}
