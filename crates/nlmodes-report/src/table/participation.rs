use std::f64::consts::TAU;
use std::path::Path;

use crate::ReportError;
use crate::columns::Column;
use crate::output::replace_file;
use nlmodes_modal::{ModalBranch, Participation};

/// Columns of `participation.csv`.
pub const PARTICIPATION_COLUMNS: [Column; 7] = [
    Column::new("point", "", "number of the point, that of `branch.csv`"),
    Column::new("frequency_hz", "Hz", "nonlinear modal frequency"),
    Column::new("modal_amplitude", "m √kg", "nonlinear modal amplitude"),
    Column::new("harmonics", "", "those in the sum, first to last"),
    Column::new(
        "participation_…",
        "",
        "participation of a linear mode in phase with the fundamental of the first contact, normalised by the modal amplitude; NaN without a fundamental",
    ),
    Column::new("quadrature_…", "", "the same in quadrature; zero for motions that are even in time"),
    Column::new("energy_share_…", "", "share of a linear mode in the averaged kinetic energy, all harmonics, 0 to 1"),
];

/// Writes the participation of linear modes as CSV, one row per point: `point`, `frequency_hz`, `modal_amplitude`,
/// `harmonics` (those in the sum, `1-5`), then `participation_1`, `participation_2`, … in quadrature `quadrature_1`, …,
/// and the shares in the energy `energy_share_1`, …
///
/// # Errors
/// [`ReportError::SeriesLength`] if there are not as many as points, [`ReportError::Io`] if the file cannot be written.
pub fn write_participation(
    path: impl AsRef<Path>,
    branch: &ModalBranch,
    participation: &[Participation],
) -> Result<(), ReportError> {
    let (found, expected) = (participation.len(), branch.points.len());
    if found != expected {
        let label = branch.label.clone();
        return Err(ReportError::SeriesLength { label, series: "participation", found, expected });
    }
    let modes = participation.first().map_or(0, |p| p.factors.len());
    replace_file(path.as_ref(), |file| {
        let mut table = csv::Writer::from_writer(file);
        let columns = |name: &'static str| (1..=modes).map(move |k| format!("{name}_{k}"));
        let first = ["point", "frequency_hz", "modal_amplitude", "harmonics"].map(str::to_owned);
        table.write_record(
            first
                .into_iter()
                .chain(columns("participation"))
                .chain(columns("quadrature"))
                .chain(columns("energy_share")),
        )?;
        for (index, (point, p)) in branch.points.iter().zip(participation).enumerate() {
            let harmonics = format!("{}-{}", p.harmonics.start(), p.harmonics.end());
            let numbers = [point.omega / TAU, point.modal_amplitude].map(|value| format!("{value:?}"));
            let [frequency, amplitude] = numbers;
            let shares: Vec<f64> = (0..modes).map(|k| p.energy_shares.get(k).copied().unwrap_or(f64::NAN)).collect();
            let values = p.factors.iter().chain(&p.quadrature).chain(&shares).map(|value| format!("{value:?}"));
            table.write_record([index.to_string(), frequency, amplitude, harmonics].into_iter().chain(values))?;
        }
        table.flush()
    })
}
