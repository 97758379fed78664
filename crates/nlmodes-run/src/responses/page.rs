//! `report.html` of responses: the curves with their motions.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::modal::ModalPoint;
use nlmodes::report::DataTable;
use nlmodes_scene::scene::Scene;
use nlmodes_scene::{number, short};

use super::curves::ComputedResponse;
use super::figures::{self, kind};
use super::levels::{self, Level};
use super::viewed::{Viewed, pictured_of};
use crate::Failure;
use crate::certificate::Certificate;
use crate::curve::Curve;
use crate::curve::figures::Named;
use crate::curve::histories::Reference;
use crate::curve::page::{self, Certified, Content};
use crate::curve::space::Period;
use crate::curve::stops::held_ends;
use crate::model::Model;

/// What is on the page beside the curves.
pub struct Shown<'a> {
    /// The verification report of all curves.
    pub certificate: &'a Certificate,
    /// What a sweep meets at each level.
    pub levels: &'a [Level],
    /// Differences of what is laid over, in sentences.
    pub sentences: Vec<String>,
    /// Whether anything is laid over.
    pub is_overlaid: bool,
    /// The figures.
    pub figures: Vec<Named>,
    /// Points with time histories.
    pub references: &'a [Reference],
    /// The motion of a structure from files.
    pub period: Option<&'a Period>,
}

/// Levels at most that are on the head of the page; all of them are in a table.
const ON_THE_HEAD: usize = 4;

/// Writes the page.
pub fn write(
    directory: &Path,
    (scene, model): (&Scene, &Model),
    (curves, all): (&[Viewed<'_>], &[ComputedResponse]),
    shown: Shown<'_>,
) -> Result<(), Failure> {
    let each: Vec<&dyn Curve> = curves.iter().map(|curve| curve as &dyn Curve).collect();
    let (harmonics, modes) = (scene.method.harmonics, model.open_modes().n_modes());
    let without = all.iter().filter_map(|one| Some(format!("{}: {}", one.branch.label, one.said().err()?)));
    let mut figures = shown.figures.into_iter();
    let (first, is_overlaid) = (figures.next(), shown.is_overlaid);
    let content = Content {
        figures: figures.collect(),
        title: &scene.title,
        held: each.first().map_or_else(Vec::new, |first| held_ends(scene, first.branch())),
        lines: std::iter::once(format!("Damped and forced motions; {harmonics} harmonics, {modes} modes"))
            .chain(shown.levels.iter().take(ON_THE_HEAD).map(|level| level.in_a_line(model.unit)))
            .collect(),
        further_lines: shown.sentences.into_iter().chain(without).collect(),
        warnings: model.warnings.clone(),
        certified: vec![Certified { certificate: shown.certificate, name: None, curve: None }],
        tables: vec![levels::table(shown.levels, model.unit), resonances(model, all)],
        documents: vec![("Scene as read, in SI units".to_owned(), serde_json::to_value(scene)?)],
        pictured: pictured_of(curves),
        references: shown.references,
        period: shown.period,
        ..Content::default()
    };
    page::write(directory, &each, content, |mut report| {
        report = report.kinds(&curves.iter().map(|curve| kind(curve.kind())).collect::<Vec<_>>());
        for (label, value) in quantities(model) {
            let of = |curve: &&dyn Curve| curve.branch().points.iter().map(value).collect();
            report = report.quantity(label, each.iter().map(of).collect());
        }
        let Some(Named { file, title, figure }) = first else { return report };
        match axes(&file) {
            // What is laid over is in the figure as it was written.
            Some(axes) if is_overlaid => report.main_figure(&title, figure.clone(), axes).leading_figure(title, figure),
            Some(axes) => report.main_figure(title, figure, axes),
            None => report.leading_figure(title, figure),
        }
    })
}

/// A quantity of the page: its name with its unit, and what a point has of it.
type Quantity = (String, fn(&ModalPoint) -> f64);

/// Amplitude of the first contact or spring, that of the drive point, its lag, and the level, in the order of [`axes`].
fn quantities(model: &Model) -> [Quantity; 4] {
    let (unit, first) = (model.unit, figures::observed(model));
    [
        (format!("{first} in m"), |point| point.fundamental.abs()),
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
                short(force),
                stable.to_owned(),
            ]);
        }
    }
    table
}
