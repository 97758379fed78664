//! The figures of an extraction.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::experiment::extraction::{Measured, RecordExtraction};
use nlmodes::modal::{BranchEnd, Coordinate, ModalBranch, TimeHistory, contact_intervals};
use nlmodes::report::{Abscissa, BranchFigure, HistoryFigure, MeasuredFigure, StiffnessFigure};

use super::Outcome;
use crate::config::RecordScene;

/// Most records with a time history.
const HISTORIES: usize = 20;
/// Periods of a time history.
const PERIODS: f64 = 2.0;

/// Writes frequency over modal amplitude, damping and mode indicator over modal amplitude, and the time histories at the stop.
pub fn write(directory: &Path, scene: &RecordScene, outcomes: &[Outcome]) -> Result<(), Box<dyn Error>> {
    let found: Vec<&RecordExtraction> = outcomes.iter().filter_map(|outcome| outcome.result.as_ref().ok()).collect();
    frequency(directory, scene, &found)?;
    damping(directory, scene, &found)?;
    restitution(directory, scene, &found)?;
    for (k, found) in found.iter().take(HISTORIES).enumerate() {
        if let Some(history) = found.contact.as_ref().and_then(|contact| contact.history.as_ref()) {
            let history = excerpt(history, PERIODS * TAU / found.omega.value);
            let title = format!("{} ({:.4} Hz)", found.record, found.omega.value / TAU);
            let figure = HistoryFigure::new(&[&history]).title(title).with_acceleration().render()?;
            figure.write(directory.join(format!("history_{}.svg", k + 1)))?;
        }
        stiffness(directory, found, k + 1)?;
    }
    Ok(())
}

fn frequency(directory: &Path, scene: &RecordScene, found: &[&RecordExtraction]) -> Result<(), Box<dyn Error>> {
    let points: Vec<_> = found.iter().filter_map(|found| found.modal_point()).collect();
    let Some(first) = found.iter().find(|found| found.modal.is_some()) else { return Ok(()) };
    let coordinate = |position: &f64| Coordinate { position: *position, kind: "sensor".into() };
    let branch = ModalBranch {
        label: "measured".into(),
        coordinates: first.positions.iter().map(coordinate).collect(),
        contact_coordinate: None,
        stop: None,
        points,
        end: BranchEnd { reason: "records".into(), message: "all records".into(), complete: true },
    };
    let branches = [&branch];
    let mut figure = BranchFigure::new(Abscissa::ModalAmplitude, &branches).title(&scene.title);
    for k in 0..branch.points.len() {
        figure = figure.mark(0, k, (k + 1).to_string());
    }
    Ok(figure.render()?.write(directory.join("frequency_amplitude.svg"))?)
}

fn damping(directory: &Path, scene: &RecordScene, found: &[&RecordExtraction]) -> Result<(), Box<dyn Error>> {
    let usable: Vec<_> = found
        .iter()
        .filter_map(|found| {
            let (modal, excitation) = (found.modal.as_ref()?, found.excitation.as_ref()?);
            Some((modal.amplitude.value, pair(modal.damping?), pair(excitation.pbmif), excitation.power.harmonics))
        })
        .collect();
    let harmonics = usable.iter().map(|(.., harmonics)| *harmonics);
    let (Some(least), Some(most)) = (harmonics.clone().min(), harmonics.max()) else { return Ok(()) };
    let label = if least == most {
        format!("mode indicator ({most} harmonics)")
    } else {
        format!("mode indicator ({least} to {most} harmonics)")
    };
    let amplitudes: Vec<f64> = usable.iter().map(|(amplitude, ..)| *amplitude).collect();
    let damping: Vec<(f64, f64)> = usable.iter().map(|(_, damping, ..)| *damping).collect();
    let pbmif: Vec<(f64, f64)> = usable.iter().map(|(_, _, pbmif, _)| *pbmif).collect();
    let figure = MeasuredFigure::new(&amplitudes).title(&scene.title).panel("damping", &damping).panel(&label, &pbmif);
    Ok(figure.render()?.write(directory.join("damping_amplitude.svg"))?)
}

/// Coefficient of restitution over the approach speed, a dot a record with the spread of its impacts.
fn restitution(directory: &Path, scene: &RecordScene, found: &[&RecordExtraction]) -> Result<(), Box<dyn Error>> {
    let statistics = found.iter().filter_map(|found| Some(found.contact.as_ref()?.restitution.as_ref()?.statistics()));
    let (speeds, values): (Vec<f64>, Vec<(f64, f64)>) = statistics.map(|s| (s.approach, (s.mean, s.std))).unzip();
    if speeds.is_empty() {
        return Ok(());
    }
    let figure = MeasuredFigure::new(&speeds).over("approach speed in m/s").title(&scene.title);
    Ok(figure.panel("coefficient of restitution", &values).render()?.write(directory.join("restitution.svg"))?)
}

/// Contact force over displacement with the fitted line.
fn stiffness(directory: &Path, found: &RecordExtraction, number: usize) -> Result<(), Box<dyn Error>> {
    let Some(contact) = &found.contact else { return Ok(()) };
    let (Some(history), Some(fit)) = (&contact.history, &contact.stiffness) else { return Ok(()) };
    let figure = StiffnessFigure::new(history, fit).title(&found.record).render()?;
    Ok(figure.write(directory.join(format!("contact_{number}.svg")))?)
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

/// Removes the figures of an earlier extraction, which would not belong to the records of this one.
pub fn remove(directory: &Path) {
    let histories = (1..=HISTORIES).flat_map(|k| [format!("history_{k}.svg"), format!("contact_{k}.svg")]);
    let common = ["frequency_amplitude.svg", "damping_amplitude.svg", "restitution.svg"].map(str::to_owned);
    // What cannot be removed cannot be overwritten either, which is said when it is.
    histories.chain(common).for_each(|name| drop(std::fs::remove_file(directory.join(name))));
}
