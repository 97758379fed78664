//! The figures of an extraction.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::experiment::extraction::{Measured, RecordExtraction};
use nlmodes::modal::{BranchEnd, Coordinate, Event, ModalBranch, TimeHistory, contact_intervals};
use nlmodes::report::{Abscissa, BranchFigure, Figure, FigureStyle, HistoryFigure, MeasuredFigure, StiffnessFigure};

use super::RecordOutcome;
use crate::Failure;
use crate::curve::figures::{Named, write_all};
use crate::files::HISTORIES;
use crate::overlay::Laid;

/// Most records whose points are numbered.
const NAMED: usize = 12;
/// Amplitudes from this share of that at grazing count as near contact.
const NEAR_CONTACT: f64 = 0.995;
/// Periods of a time history.
const PERIODS: f64 = 2.0;

/// Writes frequency over modal amplitude (with what is laid beside), damping and mode indicator over modal amplitude,
/// and the time histories at the stop.
pub fn write(
    directory: &Path,
    title: &str,
    outcomes: &[RecordOutcome],
    beside: &[Laid],
) -> Result<Vec<Named>, Failure> {
    let found: Vec<&RecordExtraction> = outcomes.iter().filter_map(|outcome| outcome.result.as_ref().ok()).collect();
    let mut all = frequency(title, &found, beside)?;
    all.extend(damping(title, &found)?);
    all.extend(restitution(title, &found)?);
    for (k, found) in found.iter().take(HISTORIES).enumerate() {
        if let Some(history) = found.contact.as_ref().and_then(|contact| contact.history.as_ref()) {
            let history = excerpt(history, PERIODS * TAU / found.omega.value);
            let heading = format!("{} ({:.4} Hz)", found.record, found.omega.value / TAU);
            let figure = HistoryFigure::new(&[&history]).title(&heading).with_acceleration().render()?;
            all.push(Named::new(format!("history_{}.svg", k + 1), heading, figure));
        }
        all.extend(stiffness(found, k + 1)?);
    }
    write_all(directory, &all, &FigureStyle::default())?;
    Ok(all)
}

fn frequency(title: &str, found: &[&RecordExtraction], beside: &[Laid]) -> Result<Vec<Named>, Failure> {
    let Some(branch) = measured(found) else { return Ok(Vec::new()) };
    // Contact begins at an amplitude that then hardly changes: it needs a figure of its own.
    let lines = beside.iter().filter(|laid| !laid.is_scattered);
    let starts = lines.filter_map(|laid| laid.branch.points.first()).map(|point| NEAR_CONTACT * point.modal_amplitude);
    let grazing = starts.reduce(f64::min);
    let mut in_contact = branch.clone();
    in_contact.points.retain(|point| grazing.is_some_and(|least| point.modal_amplitude >= least));
    let figure = frequency_figure(title, &branch, beside)?;
    let mut all = vec![Named::new("frequency_amplitude.svg", "Frequency over modal amplitude", figure)];
    if !in_contact.points.is_empty() {
        // Without its event the axis does not go down to the linear mode at amplitude zero.
        let mut close = beside.to_vec();
        let starts = close.iter_mut().filter_map(|laid| laid.branch.points.first_mut());
        starts.for_each(|point| point.events.retain(|event| !matches!(event, Event::Grazing | Event::LiftOff)));
        let figure = frequency_figure(title, &in_contact, &close)?;
        all.push(Named::new("frequency_contact.svg", "Frequency over modal amplitude, with contact", figure));
    }
    Ok(all)
}

/// Numbers of the measured points, of which there are `own` sets, and of those beside them: nothing was measured
/// between records.
pub fn scattered(beside: &[Laid], own: usize) -> Vec<usize> {
    let others = beside.iter().enumerate().filter(|(_, laid)| laid.is_scattered).map(|(k, _)| own + k);
    (0..own).chain(others).collect()
}

/// The modal points of all records; `None` where no record gives one.
pub fn measured(found: &[&RecordExtraction]) -> Option<ModalBranch> {
    let first = found.iter().find(|found| found.modal.is_some())?;
    let coordinate = |position: &f64| Coordinate { position: *position, kind: "sensor".into() };
    Some(ModalBranch {
        label: "measured".into(),
        coordinates: first.positions.iter().map(coordinate).collect(),
        contact_coordinate: None,
        stop: None,
        points: found.iter().filter_map(|found| found.modal_point()).collect(),
        end: BranchEnd::given("all records"),
    })
}

/// The modal points of these records.
pub fn of_records(outcomes: &[RecordOutcome]) -> Option<ModalBranch> {
    measured(&outcomes.iter().filter_map(|outcome| outcome.result.as_ref().ok()).collect::<Vec<_>>())
}

fn frequency_figure(title: &str, measured: &ModalBranch, beside: &[Laid]) -> Result<Figure, Failure> {
    let branches: Vec<&ModalBranch> = std::iter::once(measured).chain(beside.iter().map(|laid| &laid.branch)).collect();
    let scattered = scattered(beside, 1);
    let mut figure = BranchFigure::new(Abscissa::ModalAmplitude, &branches).title(title).scattered(&scattered);
    // More numbers than these would cover each other.
    for k in (0..measured.points.len()).filter(|_| measured.points.len() <= NAMED) {
        figure = figure.mark(0, k, (k + 1).to_string());
    }
    Ok(figure.render()?)
}

fn damping(title: &str, found: &[&RecordExtraction]) -> Result<Option<Named>, Failure> {
    let usable: Vec<_> = found
        .iter()
        .filter_map(|found| {
            let (modal, excitation) = (found.modal.as_ref()?, found.excitation.as_ref()?);
            Some((modal.amplitude.value, pair(modal.damping?), pair(excitation.pbmif), excitation.power.harmonics))
        })
        .collect();
    let harmonics = usable.iter().map(|(.., harmonics)| *harmonics);
    let (Some(least), Some(most)) = (harmonics.clone().min(), harmonics.max()) else { return Ok(None) };
    let label = if least == most {
        format!("mode indicator ({most} harmonics)")
    } else {
        format!("mode indicator ({least} to {most} harmonics)")
    };
    let amplitudes: Vec<f64> = usable.iter().map(|(amplitude, ..)| *amplitude).collect();
    let damping: Vec<(f64, f64)> = usable.iter().map(|(_, damping, ..)| *damping).collect();
    let pbmif: Vec<(f64, f64)> = usable.iter().map(|(_, _, pbmif, _)| *pbmif).collect();
    let figure = MeasuredFigure::new(&amplitudes)
        .title(title)
        .scattered()
        .bars("bars: uncertainty from the scatter of the record");
    let figure = figure.panel("damping ratio", &damping).panel(&label, &pbmif);
    Ok(Some(Named::new("damping_amplitude.svg", "Damping and mode indicator", figure.render()?)))
}

/// Coefficient of restitution over the approach speed, a dot a record with the spread of its impacts.
fn restitution(title: &str, found: &[&RecordExtraction]) -> Result<Option<Named>, Failure> {
    let statistics = found.iter().filter_map(|found| Some(found.contact.as_ref()?.restitution.as_ref()?.statistics()));
    let (speeds, values): (Vec<f64>, Vec<(f64, f64)>) = statistics.map(|s| (s.approach, (s.mean, s.std))).unzip();
    if speeds.is_empty() {
        return Ok(None);
    }
    let figure = MeasuredFigure::new(&speeds).over("approach speed in m/s").title(title).scattered();
    let figure = figure
        .bars("bars: standard deviation of the impacts of a record")
        .panel("coefficient of restitution", &values)
        .render()?;
    Ok(Some(Named::new("restitution.svg", "Coefficient of restitution", figure)))
}

/// Contact force over displacement with the fitted line.
fn stiffness(found: &RecordExtraction, number: usize) -> Result<Option<Named>, Failure> {
    let Some(contact) = &found.contact else { return Ok(None) };
    let (Some(history), Some(fit)) = (&contact.history, &contact.stiffness) else { return Ok(None) };
    let figure = StiffnessFigure::new(history, fit).title(&found.record).render()?;
    let heading = format!("{}: contact force over displacement, all periods", found.record);
    Ok(Some(Named::new(format!("contact_{number}.svg"), heading, figure)))
}

fn pair(measured: Measured) -> (f64, f64) {
    (measured.value, measured.uncertainty)
}

/// The beginning of a history, with the instants of touching and leaving.
fn excerpt(history: &TimeHistory, duration: f64) -> TimeHistory {
    let n = history.time.partition_point(|t| *t <= duration).min(history.time.len());
    let instants = contact_intervals(history).unwrap_or_default().into_iter().flat_map(|interval| {
        [(interval.touching, true), (interval.leaving, false)]
            .map(|(time, touching)| nlmodes::modal::ContactInstant { time, touching })
    });
    let cut = |series: &[f64]| series[..n].to_vec();
    TimeHistory {
        label: history.label.clone(),
        time: cut(&history.time),
        displacement: cut(&history.displacement),
        velocity: cut(&history.velocity),
        acceleration: cut(&history.acceleration),
        force: cut(&history.force),
        stop: history.stop,
        instants: instants.filter(|instant| instant.time <= duration).collect(),
    }
}
