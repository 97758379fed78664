//! `report.html`: the run on one page.

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::path::Path;

use nlmodes::branches::{ComputedBranch, Histories, figure_points};
use nlmodes::modal::{ModalBranch, Participation};
use nlmodes::report::{DataTable, HtmlReport};

use super::figures::{SHOWN_MODES, held_ends};
use super::histories::Reference;
use super::motion::Period;
use super::overlaid::Overlaid;
use super::stops;
use super::summary::method_used;
use crate::Failure;
use crate::certificate::{self, Certificate};
use crate::linear::{LinearFrequencies, modal_model};
use nlmodes_scene::scene::Scene;

/// Instants of a period of the contacts that move on the page, beside those at which they close and open; it keeps
/// those that its curves need.
const MOTION_SAMPLES: usize = 400;

/// What the page shows beside the branches.
pub struct Shown<'a> {
    /// Points with time histories.
    pub references: &'a [Reference],
    /// Results of other runs.
    pub laid: &'a Overlaid,
    /// Differences of the other methods from the first.
    pub methods: &'a Overlaid,
    /// The motion of a structure from files.
    pub period: Option<&'a Period>,
}

/// Writes the page about these branches of scenes that differ in their method only; its points with a name are those of
/// the figures of the first branch, and the references of `shown`, whose time histories it shows.
pub fn write(
    directory: &Path,
    scenes: &[&Scene],
    linear: &LinearFrequencies,
    (all, certificates): (&[&ComputedBranch], &[&Certificate]),
    participation: &[&[Participation]],
    shown: &Shown<'_>,
) -> Result<(), Failure> {
    let Shown { references, laid, methods, period } = *shown;
    let (Some(first), Some(scene)) = (all.first(), scenes.first()) else { return Ok(()) };
    let computed = all.iter().map(|computed| &computed.branch);
    let branches: Vec<&ModalBranch> = computed.chain(laid.branches()).collect();
    let histories = RefCell::new(all.iter().map(|computed| Histories::of(computed)).collect::<Vec<_>>());
    let contact_motion =
        |branch: usize, point: usize| histories.borrow_mut().get_mut(branch)?.at(point, MOTION_SAMPLES, "").ok();
    let participation: Vec<Vec<Participation>> = participation.iter().map(|found| lowest(found)).collect();
    let unknown: Vec<Vec<Participation>> = laid.branches().map(|branch| unknown(branch.points.len())).collect();
    let participation: Vec<&[Participation]> = participation.iter().chain(&unknown).map(Vec::as_slice).collect();
    let method = method_used(scene, first);
    let mut report = HtmlReport::new(&scene.title, &branches)
        .line(format!("{}; {}", first.branch.label, method.name))
        .clamped_at(&held_ends(scene, first))
        .stops(&stops::lines(first))
        .contact_motion(&contact_motion)
        .participation(&participation)
        .scattered(&laid.scattered(all.len()))
        .table(linear_table(linear))
        .document("Scene as read, in SI units", scene)?
        .document("Method as used", &method)?;
    if let Some(text) = &linear.mass_warning {
        report = report.warning(text);
    }
    let name = |computed: &ComputedBranch| (all.len() > 1).then(|| computed.branch.label.clone());
    for (certificate, computed) in certificates.iter().zip(all) {
        report = certificate.on_the_head(report, name(computed).as_deref());
    }
    if let Some(text) = scene.structure.straight().and_then(modal_model) {
        report = report.line(text);
    }
    if let Some(wireframe) = period.and_then(Period::wireframe) {
        report = report.wireframe(wireframe.clone());
    }
    for text in methods.sentences().chain(laid.sentences()) {
        report = report.line(text);
    }
    for table in methods.tables().chain(laid.tables()) {
        report = report.table(table);
    }
    for computed in all {
        if let Some(table) = beyond_accuracy(computed) {
            report = report.table(table);
        }
    }
    for (branch, (computed, certificate)) in all.iter().zip(certificates).enumerate() {
        for table in certificate::tables(certificate, name(computed).as_deref(), Some(branch)) {
            report = report.closing_table(table);
        }
    }
    for (k, scene) in scenes.iter().enumerate().skip(1) {
        report = report.document(format!("Method {} of the scene", k + 1), &scene.method)?;
    }
    for (k, point) in figure_points(&first.branch).into_iter().enumerate() {
        report = report.mark(0, point, (k + 1).to_string());
    }
    for reference in references {
        report = report.mark(0, reference.point, &reference.name);
        for curves in reference.curves() {
            report = report.histories_at(curves.title, &curves.histories, &curves.stops);
        }
    }
    Ok(report.write(directory.join("report.html"))?)
}

/// The participation of so many points of which none is known.
fn unknown(points: usize) -> Vec<Participation> {
    let none = vec![f64::NAN; SHOWN_MODES];
    let one = Participation {
        factors: none.clone(),
        quadrature: none.clone(),
        harmonics: RangeInclusive::new(1, 0),
        energy_shares: none,
    };
    vec![one; points]
}

/// The participation of the modes that are shown.
fn lowest(found: &[Participation]) -> Vec<Participation> {
    let of = |point: &Participation| {
        let mut point = point.clone();
        point.factors.truncate(SHOWN_MODES);
        point.quadrature.truncate(SHOWN_MODES);
        point.energy_shares.truncate(SHOWN_MODES);
        point
    };
    found.iter().map(of).collect()
}

/// Where the accuracy that was asked for is not reached, if it is not.
fn beyond_accuracy(computed: &ComputedBranch) -> Option<DataTable> {
    let stretches = computed.beyond_accuracy();
    let points = computed.accuracy?.points_beyond;
    let title = format!("{points} of {} points do not reach the accuracy", computed.branch.points.len());
    let head =
        ["first point", "last point", "lowest frequency, Hz", "highest frequency, Hz", "largest estimated error"];
    let mut table = DataTable::new(title, &head);
    table.rows = stretches
        .iter()
        .map(|stretch| {
            let hz = stretch.frequency.map(|omega| format!("{:.6}", omega / TAU));
            let estimate = format!("{:.1e}", stretch.largest_estimate);
            stretch.points.map(|k| k.to_string()).into_iter().chain(hz).chain([estimate]).collect()
        })
        .collect();
    (!stretches.is_empty()).then_some(table)
}

fn linear_table(found: &LinearFrequencies) -> DataTable {
    let columns = [
        Some(("contact mass kept", &found.mass_kept)),
        found.mass_redistributed.as_ref().map(|f| ("contact mass taken away", f)),
        found.contacts_held.as_ref().map(|f| ("contacts held", f)),
        found.of_the_elements.as_ref().map(|f| ("of the elements, none imposed", f)),
    ];
    let columns: Vec<(&str, &Vec<f64>)> = columns.into_iter().flatten().collect();
    let head: Vec<&str> = ["mode"].into_iter().chain(columns.iter().map(|(name, _)| *name)).collect();
    let mut table = DataTable::new("Linear frequencies, Hz", &head);
    for k in 0..found.mass_kept.len() {
        let cell = |(_, f): &(&str, &Vec<f64>)| f.get(k).map_or_else(|| "–".to_owned(), |f| format!("{f:.5}"));
        table.rows.push([(k + 1).to_string()].into_iter().chain(columns.iter().map(cell)).collect());
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{branch_settings, models};
    use nlmodes::branches::{BranchSettings, compute_branch};
    use std::ops::ControlFlow;

    #[test]
    fn stops_stand_at_the_positions_of_their_contacts_whatever_the_size() -> Result<(), Failure> {
        // Up to 4000 degrees of freedom are recorded all; beyond, some of them.
        for elements in [40, 4500] {
            let text = format!(
                "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = {elements}\nstart = \"clamped\"\n\
                 material = {{ youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }}\nsection = {{ area_m2 = 1e-4 }}\n\
                 [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-3\n\
                 [[contact]]\nat_m = 0.5\ndirection = \"axial\"\nside = \"negative\"\ngap_m = 2e-3\n\
                 [method]\nharmonics = 1\n[continuation]\nmax_energy_ratio = 2.0\nmax_points = 2\n"
            );
            let files =
                nlmodes_scene::parse_each_method("rod.toml", &text, &[]).map_err(|refused| refused.text(false))?;
            let massless = models(&files[0])?.massless;
            let settings = BranchSettings { held_modes: Some(20), ..branch_settings(&files[0].scene) };
            let computed = compute_branch(massless, &settings, |_| ControlFlow::Continue(()))?;
            let stops = stops::lines(&computed);
            let at: Vec<f64> = stops.iter().map(|stop| computed.branch.coordinates[stop.coordinate].position).collect();
            assert!(at.len() == 2 && (at[0] - 1.0).abs() < 1e-9 && (at[1] - 0.5).abs() < 1e-9, "{elements}: {at:?}");
            let stands: Vec<(f64, bool)> = stops.iter().map(|stop| (stop.position, stop.positive)).collect();
            assert_eq!(stands, [(1e-3, true), (-2e-3, false)]);
        }
        Ok(())
    }
}
