//! Curves without files, as data of the page.

use nlmodes::branches::Watch;
use nlmodes::modal::ModalBranch;
use nlmodes::report::HtmlReport;
use nlmodes_scene::scene::Scene;

use super::{Curve, stops};
use crate::{Failure, RunError};

/// Most points: somebody waits for them.
pub const MOST_POINTS: usize = 600;
/// Instants of a period of the contacts.
const SAMPLES: usize = 120;

/// The curves as the page's script takes them.
///
/// # Errors
/// [`RunError::Ended`] if it was asked to end.
pub fn picture(scene: &Scene, curves: &[&dyn Curve], watch: &Watch) -> Result<String, RunError> {
    if watch.has_ended() {
        return Err(RunError::Ended);
    }
    let Some(first) = curves.first() else { return Err(RunError::Ended) };
    let branches: Vec<&ModalBranch> = curves.iter().map(|curve| curve.branch()).collect();
    let motion = |curve: usize, point: usize| {
        if watch.asks_to_end() { None } else { curves.get(curve)?.histories(point, SAMPLES, "").ok() }
    };
    let report = HtmlReport::new(&scene.title, &branches)
        .clamped_at(&stops::held_ends(scene, first.branch()))
        .stops(&first.stops())
        .contact_motion(&motion);
    let text = report.data().map_err(|error| RunError::Files(Failure::from(error)))?;
    if watch.has_ended() { Err(RunError::Ended) } else { Ok(text) }
}
