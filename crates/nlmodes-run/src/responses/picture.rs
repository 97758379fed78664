//! The first curve of a scene with responses, without files, as data of the page.

use nlmodes::branches::Watch;
use nlmodes::modal::{ModalBranch, TimeHistory};
use nlmodes::report::HtmlReport;
use nlmodes::response::StepLog;
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::Structures;
use nlmodes_scene::scene::StabilityChoice;

use super::curves::{follow, jobs};
use super::model::Model;
use super::{histories, page};
use crate::{Failure, RunError};

/// Most points: somebody waits for them.
const MOST_POINTS: usize = 600;
/// Instants of a period of the contacts.
const SAMPLES: usize = 120;

/// Computes the first curve of the first response, at its first level, without stability.
///
/// # Errors
/// [`RunError`] if there is no curve, [`RunError::Ended`] if it was asked to end.
pub fn picture(file: &SceneFile, watch: &Watch, structures: &Structures) -> Result<String, RunError> {
    let mut file = file.clone();
    file.scene.stability = StabilityChoice::Never;
    file.scene.continuation.max_points = file.scene.continuation.max_points.min(MOST_POINTS);
    let model = Model::sharing(&file, structures)?;
    let scene = &file.scene;
    let Some(job) = jobs(scene).into_iter().next() else { return Err(RunError::Ended) };
    let name = job.name(scene, &model);
    let curves = follow(&model, scene, job, (&name, &StepLog::default()), watch.clone());
    if watch.has_ended() {
        return Err(RunError::Ended);
    }
    let Some(first) = curves.first() else { return Err(RunError::Ended) };
    if let Err(why) = first.said() {
        return Err(file.error_at("response", why, "this response", &[]).into());
    }
    let branches: [&ModalBranch; 1] = [&first.branch];
    let motion = |_: usize, point: usize| -> Option<Vec<TimeHistory>> {
        if watch.asks_to_end() {
            return None;
        }
        histories::of_point(&model, scene, (first, point), SAMPLES, &name).ok()
    };
    let report = HtmlReport::new(&scene.title, &branches)
        .clamped_at(&model.held_ends)
        .stops(&page::stops(&model))
        .contact_motion(&motion);
    let text = report.data().map_err(|error| RunError::Files(Failure::from(error)))?;
    if watch.has_ended() { Err(RunError::Ended) } else { Ok(text) }
}
