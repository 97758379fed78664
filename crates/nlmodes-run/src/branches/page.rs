//! What the page of a run says of its branches beside their curves.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::branches::ComputedBranch;
use nlmodes::report::DataTable;
use nlmodes_scene::scene::Scene;
use serde::Serialize;
use serde_json::Value;

use super::summary::method_used;
use crate::Failure;
use crate::certificate::Certificate;
use crate::curve::Curve;
use crate::curve::histories::Reference;
use crate::curve::page::{self, Certified, Content};
use crate::curve::space::Period;
use crate::curve::stops::held_ends;
use crate::linear::{LinearFrequencies, modal_model};
use crate::overlay::Overlaid;

/// Writes the page about these branches of scenes that differ in their method only: with what is laid over and the
/// differences of the other methods from the first, points with time histories, and the motion of a structure from
/// files.
pub fn write(
    directory: &Path,
    scenes: &[&Scene],
    linear: &LinearFrequencies,
    (all, curves, certificates): (&[&ComputedBranch], &[&dyn Curve], &[&Certificate]),
    (laid, methods): (&Overlaid, &Overlaid),
    (references, period): (&[Reference], Option<&Period>),
) -> Result<(), Failure> {
    let (Some(first), Some(scene)) = (all.first(), scenes.first()) else { return Ok(()) };
    let method = method_used(scene, first);
    let certified = certificates.iter().zip(all).enumerate().map(|(branch, (certificate, computed))| Certified {
        certificate,
        name: (all.len() > 1).then(|| computed.branch.label.clone()),
        curve: Some(branch),
    });
    let own = scene.structure.straight().and_then(modal_model);
    let mut documents = vec![("Scene as read, in SI units".to_owned(), json(scene)?)];
    documents.push(("Method as used".to_owned(), json(&method)?));
    for (k, scene) in scenes.iter().enumerate().skip(1) {
        documents.push((format!("Method {} of the scene", k + 1), json(&scene.method)?));
    }
    let tables = methods.tables().chain(laid.tables()).chain(all.iter().filter_map(|one| beyond_accuracy(one)));
    let content = Content {
        title: &scene.title,
        held: held_ends(scene, &first.branch),
        lines: vec![format!("{}; {}", first.branch.label, method.name)],
        further_lines: own.into_iter().chain(methods.sentences()).chain(laid.sentences()).collect(),
        warnings: linear.mass_warning.iter().cloned().collect(),
        certified: certified.collect(),
        tables: [linear_table(linear)].into_iter().chain(tables).collect(),
        documents,
        laid: laid.branches().collect(),
        scattered: laid.scattered(all.len()),
        references,
        period,
        ..Content::default()
    };
    page::write(directory, curves, content, |report| report)
}

fn json(content: &impl Serialize) -> Result<Value, Failure> {
    Ok(serde_json::to_value(content)?)
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
    let columns = found.columns("contact mass taken away");
    let head: Vec<&str> = ["mode"].into_iter().chain(columns.iter().map(|(name, _)| *name)).collect();
    let mut table = DataTable::new("Linear frequencies, Hz", &head);
    for k in 0..found.mass_kept.len() {
        let cell = |(_, f): &(&str, &[f64])| f.get(k).map_or_else(|| "–".to_owned(), |f| format!("{f:.5}"));
        table.rows.push([(k + 1).to_string()].into_iter().chain(columns.iter().map(cell)).collect());
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::branches::curve::BranchCurve;
    use crate::physical;
    use crate::settings::{Models, branch_settings, models};
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
            let Models { massless, open, state, .. } = models(&files[0])?;
            let settings = BranchSettings { held_modes: Some(20), ..branch_settings(&files[0].scene) };
            let mut computed = compute_branch(massless, &settings, |_| ControlFlow::Continue(()))?;
            physical::recover(&files[0].scene, (open.as_ref(), state.as_ref()), [&mut computed]);
            let stops = BranchCurve::new(&computed, &[], state.as_ref()).stops();
            let at: Vec<f64> = stops.iter().map(|stop| computed.branch.coordinates[stop.coordinate].position).collect();
            assert!(at.len() == 2 && (at[0] - 1.0).abs() < 1e-9 && (at[1] - 0.5).abs() < 1e-9, "{elements}: {at:?}");
            let stands: Vec<(f64, bool)> = stops.iter().map(|stop| (stop.position, stop.positive)).collect();
            assert_eq!(stands, [(1e-3, true), (-2e-3, false)]);
        }
        Ok(())
    }
}
