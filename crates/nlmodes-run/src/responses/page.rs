//! `report.html` of responses: the curves with their motions.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::modal::{ModalBranch, ModalPoint, TimeHistory};
use nlmodes::report::{DataTable, HtmlReport, StopLine};
use nlmodes_scene::number;
use nlmodes_scene::scene::Scene;

use super::curves::ComputedResponse;
use super::figures::{self, Named, kind};
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
    (figures, is_overlaid): (Vec<Named>, bool),
) -> Result<(), Failure> {
    let shown: Vec<&ComputedResponse> = curves.iter().filter(|c| !c.branch.points.is_empty()).collect();
    let references: Vec<&ModalBranch> = shown.iter().map(|computed| &computed.branch).collect();
    let motion = |branch: usize, point: usize| -> Option<Vec<TimeHistory>> {
        let computed = shown[branch];
        histories::of_point(model, scene, (computed, point), SAMPLES, &computed.branch.label).ok()
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
    for table in tables(certificate, None, None) {
        report = report.closing_table(table);
    }
    for text in &model.warnings {
        report = report.warning(text);
    }
    report = certificate.on_the_head(report, None);
    for sentence in sentences {
        report = report.line(sentence.clone());
    }
    for computed in curves {
        if let Err(why) = computed.said() {
            report = report.line(format!("{}: {why}", computed.branch.label));
        }
    }
    for (label, value) in quantities(model.unit) {
        let of = |computed: &&ComputedResponse| computed.branch.points.iter().map(value).collect();
        report = report.quantity(label, shown.iter().map(of).collect());
    }
    for (k, (name, title, figure)) in figures.into_iter().enumerate() {
        report = match (k, axes(name)) {
            // What is laid over stands in the figure as it was written.
            (0, Some(axes)) if is_overlaid => {
                report.main_figure(title, figure.clone(), axes).leading_figure(title, figure)
            }
            (0, Some(axes)) => report.main_figure(title, figure, axes),
            (0, None) => report.leading_figure(title, figure),
            _ => report.figure(title, figure),
        };
    }
    Ok(report.write(directory.join("report.html"))?)
}

/// A quantity of the page: its name with its unit, and what a point has of it.
type Quantity = (String, fn(&ModalPoint) -> f64);

/// Amplitude of the first contact, that of the drive point, its lag, and the level, in the order of [`axes`].
fn quantities(unit: &str) -> [Quantity; 4] {
    [
        ("fundamental of the first contact in m".to_owned(), |point| point.fundamental.abs()),
        ("fundamental of the drive point in m".to_owned(), figures::drive),
        ("lag of the drive point in degrees".to_owned(), figures::lag),
        (format!("level in {unit}"), figures::level),
    ]
}

/// Axes of a figure, by the name of its file; none where the page has no such quantity.
fn axes(figure: &str) -> Option<[&'static str; 2]> {
    match figure {
        "responses.svg" => Some(["frequency", "quantity0"]),
        "force_response.svg" => Some(["quantity3", "quantity0"]),
        "drive.svg" => Some(["frequency", "quantity1"]),
        _ => None,
    }
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
        for point in &computed.at_levels {
            let force = point.peak_contact_force;
            let stable = match point.stability.and_then(|s| s.stable) {
                Some(true) => "yes",
                Some(false) => "no",
                None => "uncertain",
            };
            table.rows.push(vec![
                computed.branch.label.clone(),
                number(figures::level(point)),
                format!("{:.6}", point.listed_omega() / TAU),
                format!("{:.5e}", figures::drive(point)),
                number(format!("{force:.5e}").parse().unwrap_or(force)),
                stable.to_owned(),
            ]);
        }
    }
    table
}
