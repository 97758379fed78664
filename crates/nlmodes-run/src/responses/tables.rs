//! Tables of the points: `branch.csv`, `contacts.csv`, `harmonics.npz`, `appropriation.csv`.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use nlmodes::hbm::ContactMotion;
use nlmodes::modal::ModalBranch;
use nlmodes::report::{
    BRANCH_COLUMNS, RESPONSE_COLUMNS, ReportError, hertz, write_contacts, write_file, write_harmonics,
};
use nlmodes::response::{Appropriation, ResponseModel, ResponsePoint};
use nlmodes_scene::scene::{ResponseKind, Scene};

use super::convert::Converter;
use super::curves::ComputedResponse;
use super::model::Model;
use crate::Failure;
use crate::forces::{self, Forces};

/// Writes `branch.csv` of the curves that are there.
pub fn write_points(
    directory: &Path,
    scene: &Scene,
    model: &Model,
    curves: &[ComputedResponse],
) -> Result<(), ReportError> {
    fs::create_dir_all(directory).map_err(|source| ReportError::Io { path: directory.to_path_buf(), source })?;
    let failed = |error: Failure| ReportError::Io {
        path: directory.join("branch.csv"),
        source: std::io::Error::other(error.to_string()),
    };
    let table = table(scene, model, curves).map_err(failed)?;
    write_file(directory.join("branch.csv"), &table)
}

fn table(scene: &Scene, model: &Model, curves: &[ComputedResponse]) -> Result<Vec<u8>, Failure> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(BRANCH_COLUMNS.into_iter().chain(RESPONSE_COLUMNS.map(|column| column.name)))?;
    let converter = Converter::new(model)?;
    let mut number = 0;
    for (k, computed) in curves.iter().enumerate() {
        let system = model.with_drive(computed.response)?;
        let subharmonic = scene.responses[computed.response].subharmonic;
        for (index, point) in computed.points().iter().enumerate() {
            let row = Row { number, index, curve: k, computed, point, subharmonic };
            table.write_record(row.cells(model, &system, &converter)?)?;
            number += 1;
        }
    }
    Ok(table.into_inner().map_err(|error| error.into_error())?)
}

struct Row<'a> {
    number: usize,
    index: usize,
    curve: usize,
    computed: &'a ComputedResponse,
    point: &'a ResponsePoint,
    subharmonic: usize,
}

impl Row<'_> {
    fn cells(&self, model: &Model, system: &ResponseModel, converter: &Converter<'_>) -> Result<Vec<String>, Failure> {
        let (point, motion) = (self.point, &self.point.motion);
        let is_forced = self.computed.is_forced();
        let cell = |value: f64| if value.is_finite() { format!("{value:?}") } else { String::new() };
        let when = |is: bool, value: f64| if is { cell(value) } else { String::new() };
        let first = |value: &dyn Fn(&ContactMotion) -> f64| {
            motion.contacts.first().map_or_else(String::new, |c| cell(value(c)))
        };
        let appropriated = self.computed.appropriations.get(self.index);
        let stability = appropriated.and_then(|found| found.stability.as_ref()).or(point.stability.as_ref());
        let judged =
            |value: &dyn Fn(&nlmodes::response::Stability) -> String| stability.map_or_else(String::new, value);
        let names: Vec<&str> = point.events.iter().map(|event| event.name()).collect();
        let expected = match appropriated {
            Some(found) => expected_of(found),
            None => expected(self.computed.kind, system, point, self.subharmonic)?,
        };
        let is_drive = point.drive.norm() > 0.0;
        let impulse: f64 = motion.contacts.iter().map(|c| c.mean_force * TAU / motion.at.omega).sum();
        Ok(vec![
            self.number.to_string(),
            cell(hertz(point.omega)),
            cell(motion.kinetic_energy),
            cell(motion.total_energy),
            cell(motion.modal_amplitude()),
            cell(converter.fundamental(point, is_forced, self.subharmonic)),
            first(&|c| c.peak),
            first(&|c| c.closed_share),
            motion.contacts.iter().map(|c| c.touches).sum::<usize>().to_string(),
            cell(motion.contacts.iter().map(|c| c.peak_force).fold(0.0, f64::max)),
            cell(point.residual),
            names.join(" "),
            String::new(),
            judged(&|s| s.stable.map_or_else(String::new, |stable| stable.to_string())),
            judged(&|s| cell(s.largest.norm())),
            judged(&|s| cell(s.largest.arg().to_degrees())),
            (motion.eta.len() - 1).to_string(),
            String::new(),
            cell(impulse),
            (self.computed.response + 1).to_string(),
            self.computed.kind.name().to_owned(),
            self.curve.to_string(),
            self.computed.name.clone(),
            self.computed.is_detached.to_string(),
            when(is_forced, point.level),
            match is_forced {
                true => when(model.unit == "N", point.level),
                false => cell(expected.force),
            },
            when(is_forced && model.unit == "m/s²", point.level),
            when(is_forced && model.unit == "m", point.level),
            when(is_drive, point.drive.norm()),
            when(is_forced && is_drive, point.lag().to_degrees()),
            when(is_forced, motion.input_power),
            cell(motion.dissipated_power),
            when(self.computed.kind == ResponseKind::DampedMode, motion.damping_ratio()),
            cell(expected.indicator),
            judged(&|s| cell(s.error)),
            cell(expected.distance),
        ])
    }
}

/// Force and indicator of a test.
struct Expected {
    force: f64,
    indicator: f64,
    distance: f64,
}

/// What the forces of appropriation come to: the fundamental of the first one, and how near the motion is to the mode.
fn expected_of(found: &Appropriation) -> Expected {
    Expected {
        force: found.forces.first().and_then(|f| f.get(1)).map_or(f64::NAN, |f| f.norm()),
        indicator: found.power.map_or(f64::NAN, |power| power.indicator()),
        distance: found.distance,
    }
}

/// The indicator of the forces that act; for a mode, force and indicator of a test that drives it with one harmonic at
/// the drive point.
fn expected(
    kind: ResponseKind,
    system: &ResponseModel,
    point: &ResponsePoint,
    subharmonic: usize,
) -> Result<Expected, Failure> {
    let motion = &point.motion;
    if kind.is_forced() {
        let power = system.force_power(motion, subharmonic)?;
        let indicator = power.map_or(f64::NAN, |power| power.indicator());
        return Ok(Expected { force: point.level, indicator, distance: f64::NAN });
    }
    let q = system.drive_harmonics(motion)?;
    let speed = |n: usize| n as f64 * motion.at.omega * q.get(n).map_or(0.0, |q| q.norm());
    let all = (1..q.len()).map(|n| speed(n).powi(2)).sum::<f64>().sqrt();
    let force = if kind == ResponseKind::DampedMode { 2.0 * motion.dissipated_power / speed(1) } else { f64::NAN };
    Ok(Expected { force, indicator: speed(1) / all, distance: f64::NAN })
}

/// Writes `appropriation.csv`, the forces of each drive point in each harmonic, where they were computed.
pub fn write_forces(directory: &Path, curves: &[ComputedResponse]) -> Result<(), Failure> {
    let mut rows = Vec::new();
    let mut first = 0;
    for computed in curves {
        for (i, (found, point)) in computed.appropriations.iter().zip(computed.points()).enumerate() {
            let of = |(drive, force): (usize, &'_ Vec<_>)| Forces {
                point: first + i,
                omega: point.omega,
                drive,
                amplitudes: force.iter().skip(1).copied().collect(),
            };
            rows.extend(found.forces.iter().enumerate().map(of));
        }
        first += computed.points().len();
    }
    forces::write(directory, &rows)
}

/// Writes `contacts.csv` and `harmonics.npz` of all points, in the order of `branch.csv`.
pub fn write_motions(
    directory: &Path,
    scene: &Scene,
    model: &Model,
    curves: &[ComputedResponse],
) -> Result<(), Failure> {
    let converter = Converter::new(model)?;
    let mut all: Option<ModalBranch> = None;
    for computed in curves {
        let branch = converter.branch(scene, computed);
        match &mut all {
            Some(all) => all.points.extend(branch.points),
            None => all = Some(branch),
        }
    }
    let Some(all) = all else { return Ok(()) };
    write_contacts(directory.join("contacts.csv"), &all)?;
    Ok(write_harmonics(directory.join("harmonics.npz"), &all)?)
}
