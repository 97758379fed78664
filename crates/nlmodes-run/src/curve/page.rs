//! `report.html`: the curves of a run on one page.

use std::ops::RangeInclusive;
use std::path::Path;

use nlmodes::modal::{ModalBranch, Participation};
use nlmodes::report::{DataTable, HtmlReport};
use serde_json::Value;

use super::figures::Named;
use super::histories::Reference;
use super::space::Period;
use super::{Curve, LINEAR_MODES, gradients};
use crate::Failure;
use crate::certificate::{Certificate, tables};

/// Instants of a period of the contacts that move on the page, beside those at which they close and open; it keeps
/// those that its curves need.
const MOTION_SAMPLES: usize = 400;

/// The verification report of curves on a page.
pub struct Certified<'a> {
    /// The report.
    pub certificate: &'a Certificate,
    /// Name of its curve among several.
    pub name: Option<String>,
    /// Number of its curve, whose points its tables name.
    pub curve: Option<usize>,
}

/// What a page shows beside its curves.
#[derive(Default)]
pub struct Content<'a> {
    /// Its title.
    pub title: &'a str,
    /// Ends of the structure that do not move in the direction of the first contact.
    pub held: Vec<f64>,
    /// What is reported first.
    pub lines: Vec<String>,
    /// What is reported after that of the verification reports.
    pub further_lines: Vec<String>,
    /// Warnings before those of the verification reports.
    pub warnings: Vec<String>,
    /// The verification reports.
    pub certified: Vec<Certified<'a>>,
    /// Tables.
    pub tables: Vec<DataTable>,
    /// Figures behind those of the gradients.
    pub figures: Vec<Named>,
    /// Trees of names and values.
    pub documents: Vec<(String, Value)>,
    /// Results of other runs.
    pub laid: Vec<&'a ModalBranch>,
    /// Numbers of those among all curves that are points without a line.
    pub scattered: Vec<usize>,
    /// Number of the curve whose motion is pictured, and of which these are: the first by default.
    pub pictured: usize,
    /// Points with time histories.
    pub references: &'a [Reference],
    /// The motion of a structure from files.
    pub period: Option<&'a Period>,
}

/// Writes the page about these curves, or about points that are only laid over each other, with what `further` adds;
/// its points with a name are those of the pictures of one curve, and the references, whose time histories it shows.
pub fn write(
    directory: &Path,
    curves: &[&dyn Curve],
    content: Content<'_>,
    further: impl for<'r> FnOnce(HtmlReport<'r>) -> HtmlReport<'r>,
) -> Result<(), Failure> {
    let branches: Vec<&ModalBranch> =
        curves.iter().map(|curve| curve.branch()).chain(content.laid.iter().copied()).collect();
    let contact_motion = |curve: usize, point: usize| curves.get(curve)?.histories(point, MOTION_SAMPLES, "").ok();
    let own = curves.iter().map(|curve| curve.participation().to_vec());
    let participation: Vec<Vec<Participation>> =
        own.chain(content.laid.iter().map(|branch| unknown(branch.points.len()))).collect();
    let participation: Vec<&[Participation]> = participation.iter().map(Vec::as_slice).collect();
    let mut report = HtmlReport::new(content.title, &branches).scattered(&content.scattered);
    if !curves.is_empty() {
        report = report.first_points(&curves.iter().map(|curve| curve.first()).collect::<Vec<_>>());
        report = report.contact_motion(&contact_motion).participation(&participation);
    }
    for text in content.lines {
        report = report.line(text);
    }
    for text in content.warnings {
        report = report.warning(text);
    }
    for Certified { certificate, name, curve } in &content.certified {
        report = certificate.on_the_head(report, name.as_deref());
        for table in tables(certificate, name.as_deref(), *curve) {
            report = report.closing_table(table);
        }
    }
    for text in content.further_lines {
        report = report.line(text);
    }
    let first = curves.first().map(|curve| curve.branch());
    for table in content.tables.into_iter().chain(first.and_then(gradients::table)) {
        report = report.table(table);
    }
    for (title, figure) in first.into_iter().flat_map(gradients::figures) {
        report = report.figure(title, figure);
    }
    for Named { title, figure, .. } in content.figures {
        report = report.figure(title, figure);
    }
    for (title, document) in &content.documents {
        report = report.document(title, document)?;
    }
    if let Some(wireframe) = content.period.and_then(Period::wireframe) {
        report = report.wireframe(wireframe.clone());
    }
    if let Some(pictured) = curves.get(content.pictured) {
        report = report.clamped_at(&content.held).stops(&pictured.stops());
        for (k, point) in pictured.pictured().into_iter().enumerate() {
            report = report.mark(content.pictured, point, (k + 1).to_string());
        }
    }
    for reference in content.references {
        report = report.mark(content.pictured, reference.point, &reference.name);
        for curves in reference.curves() {
            report = report.histories_at(curves.title, &curves.histories, &curves.stops);
        }
    }
    Ok(further(report).write(directory.join("report.html"))?)
}

/// The participation of so many points of which none is known.
fn unknown(points: usize) -> Vec<Participation> {
    let none = vec![f64::NAN; LINEAR_MODES];
    let one = Participation {
        factors: none.clone(),
        quadrature: none.clone(),
        harmonics: RangeInclusive::new(1, 0),
        energy_shares: none,
    };
    vec![one; points]
}
