//! `report.html` of responses: the curves with their motions.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::modal::{ModalBranch, TimeHistory};
use nlmodes::report::{DataTable, HtmlReport, StopLine};
use nlmodes_scene::number;
use nlmodes_scene::scene::Scene;

use super::convert::Converter;
use super::curves::ComputedResponse;
use super::figures::{Named, kind};
use super::histories;
use super::model::Model;
use crate::Failure;
use crate::certificate::{Certificate, tables};

/// Samples of a period of each contact that moves on the page.
const SAMPLES: usize = 1000;

/// Writes the page.
pub fn write(
    directory: &Path,
    scene: &Scene,
    model: &Model,
    (curves, certificate, sentences): (&[ComputedResponse], &Certificate, &[String]),
    figures: Vec<Named>,
) -> Result<(), Failure> {
    let converter = Converter::new(model)?;
    let shown: Vec<&ComputedResponse> = curves.iter().filter(|c| !c.points().is_empty()).collect();
    let branches: Vec<ModalBranch> = shown.iter().map(|computed| converter.branch(scene, computed)).collect();
    let references: Vec<&ModalBranch> = branches.iter().collect();
    let motion = |branch: usize, point: usize| -> Option<Vec<TimeHistory>> {
        let computed = shown[branch];
        let subharmonic = scene.responses[computed.response].subharmonic;
        histories::of_point(model, computed.points().get(point)?, subharmonic, SAMPLES, &computed.name).ok()
    };
    let harmonics = scene.method.harmonics;
    let mut report = HtmlReport::new(&scene.title, &references)
        .line(format!("Damped and forced motions; {harmonics} harmonics, {} modes", model.open_modes().n_modes()))
        .clamped_at(&model.held_ends)
        .stops(&stops(model))
        .kinds(&shown.iter().map(|computed| kind(computed.kind)).collect::<Vec<_>>())
        .contact_motion(&motion)
        .table(resonances(model, curves))
        .document("Scene as read, in SI units", scene)?;
    for table in tables(certificate, None) {
        report = report.closing_table(table);
    }
    for text in &model.warnings {
        report = report.line(format!("Warning: {text}"));
    }
    for sentence in sentences {
        report = report.line(sentence.clone());
    }
    for computed in curves.iter().filter(|c| c.curve.is_err()) {
        report = report.line(format!("{}: {}", computed.name, computed.message));
    }
    for (k, (_, title, figure)) in figures.into_iter().enumerate() {
        report = if k == 0 { report.leading_figure(title, figure) } else { report.figure(title, figure) };
    }
    Ok(report.write(directory.join("report.html"))?)
}

/// The stops that have a coordinate.
pub fn stops(model: &Model) -> Vec<StopLine> {
    let line = |(i, gap): (usize, &f64)| {
        Some(StopLine {
            coordinate: model.contact_coordinates.get(i).copied().flatten()?,
            position: model.sides[i] * gap,
            positive: model.sides[i] > 0.0,
        })
    };
    model.gaps.iter().enumerate().filter_map(line).collect()
}

/// Phase resonances at the levels of the scene.
fn resonances(model: &Model, curves: &[ComputedResponse]) -> DataTable {
    let level = format!("level, {}", model.unit);
    let head = ["curve", level.as_str(), "frequency, Hz", "drive point, m", "largest contact force, N", "stable"];
    let mut table = DataTable::new("Phase resonances at the levels of the scene", &head);
    for computed in curves {
        for point in computed.curve.iter().flat_map(|curve| &curve.at_levels) {
            let force = point.motion.contacts.iter().map(|c| c.peak_force).fold(0.0, f64::max);
            let stable = match point.stability.and_then(|s| s.stable) {
                Some(true) => "yes",
                Some(false) => "no",
                None => "uncertain",
            };
            table.rows.push(vec![
                computed.name.clone(),
                number(point.level),
                format!("{:.6}", point.omega / TAU),
                format!("{:.5e}", point.drive.norm()),
                number(format!("{force:.5e}").parse().unwrap_or(force)),
                stable.to_owned(),
            ]);
        }
    }
    table
}
