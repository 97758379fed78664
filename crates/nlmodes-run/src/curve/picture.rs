//! A curve without files, as data of the page.

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

/// The curve as the page's script takes it.
///
/// # Errors
/// [`RunError::Ended`] if it was asked to end.
pub fn picture(scene: &Scene, curve: &dyn Curve, watch: &Watch) -> Result<String, RunError> {
    if watch.has_ended() {
        return Err(RunError::Ended);
    }
    let branch = curve.branch();
    let branches: [&ModalBranch; 1] = [branch];
    let motion = |_: usize, point: usize| {
        if watch.asks_to_end() { None } else { curve.histories(point, SAMPLES, "").ok() }
    };
    let report = HtmlReport::new(&scene.title, &branches)
        .clamped_at(&stops::held_ends(scene, branch))
        .stops(&curve.stops())
        .contact_motion(&motion);
    let text = report.data().map_err(|error| RunError::Files(Failure::from(error)))?;
    if watch.has_ended() { Err(RunError::Ended) } else { Ok(text) }
}
