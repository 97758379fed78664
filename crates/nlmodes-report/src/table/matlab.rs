use std::io::Write;
use std::path::Path;

use super::harmonics::{all_coefficients, common_width};
use super::hertz;
use super::histories::{PointHistories, SERIES};
use super::mat5::{Value, file};
use crate::ReportError;
use crate::columns::Column;
use crate::output::replace_file;
use nlmodes_modal::{ContactPeriod, Event, ModalBranch, ModalPoint};

/// Maximum number of coefficients written.
const MOST_COEFFICIENTS: usize = 1 << 24;

/// Variables of `results.mat`.
pub const MATLAB_VARIABLES: [Column; 4] = [
    Column::new(
        "branch",
        "",
        "structure with the columns of `branch.csv` but `resonance`; `event` is a cell array of texts, what is unknown is NaN",
    ),
    Column::new(
        "contacts",
        "",
        "structure with the columns of `contacts.csv` from `contact_fraction` to `approach_velocity_m_s`, each points × stops",
    ),
    Column::new("harmonics", "", "structure with the arrays of `harmonics.npz`; beyond 2²⁴ coefficients without these"),
    Column::new("histories", "", "structure with the arrays of `histories.npz`"),
];

/// Writes a branch with its motions as a MATLAB file of version 5, with the variables of `columns::FILES`.
///
/// # Errors
/// Errors of [`write_harmonics`](super::write_harmonics) and [`write_histories`](super::write_histories).
pub fn write_matlab(
    path: impl AsRef<Path>,
    branch: &ModalBranch,
    histories: &PointHistories,
) -> Result<(), ReportError> {
    let bytes = file(&[
        ("branch", columns(&branch.points)),
        ("contacts", contacts(&branch.points)),
        ("harmonics", harmonics(branch)?),
        ("histories", motions(histories)?),
    ]);
    replace_file(path.as_ref(), |file| file.write_all(&bytes))
}

fn columns(points: &[ModalPoint]) -> Value {
    let of = |value: &dyn Fn(&ModalPoint) -> f64| Value::column(points.iter().map(value));
    let unknown = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let truth = |value: bool| f64::from(u8::from(value));
    Value::Structure(vec![
        ("point", Value::column((0..points.len()).map(|k| k as f64))),
        ("frequency_hz", of(&|p| hertz(p.omega))),
        ("energy_j", of(&|p| p.kinetic_energy)),
        ("total_energy_j", of(&|p| p.total_energy)),
        ("modal_amplitude", of(&|p| p.modal_amplitude)),
        ("fundamental_m", of(&|p| p.fundamental)),
        ("peak_m", of(&|p| p.peak)),
        ("contact_fraction", of(&|p| p.contact_fraction)),
        ("contact_intervals", of(&|p| p.contact_intervals as f64)),
        ("peak_contact_force_n", of(&|p| p.peak_contact_force)),
        ("residual", of(&|p| p.residual)),
        ("event", Value::Texts(points.iter().map(|p| Event::names(&p.events)).collect())),
        ("stable", of(&|p| unknown(p.stability.map(|s| truth(s.stable))))),
        ("largest_multiplier", of(&|p| unknown(p.stability.map(|s| s.magnitude())))),
        ("multiplier_angle_deg", of(&|p| unknown(p.stability.filter(|s| !s.stable).map(|s| s.angle_deg())))),
        ("harmonics", of(&|p| p.coefficients.n_harmonics() as f64)),
        ("error_estimate", of(&|p| unknown(p.error_estimate))),
        ("impulse_ns", of(&|p| unknown(p.impulse()))),
    ])
}

fn contacts(points: &[ModalPoint]) -> Value {
    let n_contacts = points.iter().map(|point| point.contacts.len()).min().unwrap_or(0);
    let of = |value: fn(&ContactPeriod) -> f64| {
        let rows = points.iter().flat_map(|point| point.contacts.iter().take(n_contacts).map(value));
        Value::rows(&[points.len(), n_contacts], rows)
    };
    Value::Structure(vec![
        ("contact_fraction", of(|c| c.closed_share)),
        ("peak_force_n", of(|c| c.peak_force)),
        ("mean_force_n", of(|c| c.mean_force)),
        ("impulse_ns", of(|c| c.impulse)),
        ("touches", of(|c| c.touches as f64)),
        ("approach_velocity_m_s", of(|c| c.approach_velocity)),
    ])
}

fn harmonics(branch: &ModalBranch) -> Result<Value, ReportError> {
    let width = common_width(branch)?;
    let shape = [branch.points.len(), branch.coordinates.len(), width];
    let mut fields = vec![("omega", Value::column(branch.points.iter().map(|point| point.omega)))];
    if shape.iter().product::<usize>() <= MOST_COEFFICIENTS {
        fields.push(("coefficients", Value::complex_rows(&shape, all_coefficients(branch, width))));
    }
    fields.push(("dof_position_m", Value::column(branch.coordinates.iter().map(|coordinate| coordinate.position))));
    fields.push(("dof_kind", Value::Texts(branch.coordinates.iter().map(|c| c.kind.clone()).collect())));
    Ok(Value::Structure(fields))
}

fn motions(histories: &PointHistories) -> Result<Value, ReportError> {
    let ([contacts, instants], points) = (histories.shape()?, histories.points.len());
    let mut fields = vec![
        ("point", Value::column(histories.points.iter().map(|point| *point as f64))),
        ("stop_m", Value::column(histories.stops().into_iter())),
        ("time_s", Value::rows(&[points, instants], histories.times())),
    ];
    for (name, values) in SERIES {
        fields.push((name, Value::rows(&[points, contacts, instants], histories.series(values))));
    }
    Ok(Value::Structure(fields))
}
