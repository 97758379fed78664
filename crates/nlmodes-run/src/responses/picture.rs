//! The curves of the first response of a scene, without files, as data of the page.

use nlmodes::branches::Watch;
use nlmodes::response::StepLog;
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::Structures;
use nlmodes_scene::scene::StabilityChoice;

use super::curves::{ComputedResponse, follow, jobs};
use super::viewed::viewed;
use crate::RunError;
use crate::curve::Curve;
use crate::curve::picture::{self, MOST_POINTS};
use crate::model::Model;

/// Computes the first curve of each level of the first response, without stability.
///
/// # Errors
/// [`RunError`] if there is no curve, [`RunError::Ended`] if it was asked to end.
pub fn picture(file: &SceneFile, watch: &Watch, structures: &Structures) -> Result<String, RunError> {
    let file = plain(file);
    let model = Model::sharing(&file, structures)?;
    let (scene, levels) = (&file.scene, levels(&file, &model, watch)?);
    let shown = viewed(scene, &model, &levels);
    let curves: Vec<&dyn Curve> = shown.iter().map(|curve| curve as &dyn Curve).collect();
    picture::picture(scene, &curves, watch)
}

/// The scene for somebody who waits: without stability, and not too many points.
pub(super) fn plain(file: &SceneFile) -> SceneFile {
    let mut file = file.clone();
    file.scene.stability = StabilityChoice::Never;
    file.scene.continuation.max_points = file.scene.continuation.max_points.min(MOST_POINTS);
    file
}

/// The first curve of each level of the first response.
pub(super) fn levels(file: &SceneFile, model: &Model, watch: &Watch) -> Result<Vec<ComputedResponse>, RunError> {
    let scene = &file.scene;
    let mut levels = Vec::new();
    for job in jobs(scene).into_iter().filter(|job| job.response() == 0) {
        let name = job.name(scene, model);
        let curves = follow(model, scene, job, (&name, &StepLog::default()), watch.clone());
        if watch.has_ended() {
            return Err(RunError::Ended);
        }
        let Some(first) = curves.into_iter().next() else { return Err(RunError::Ended) };
        if let Err(why) = first.said() {
            return Err(file.error_at("response", why, "this response", &[]).into());
        }
        levels.push(first);
    }
    Ok(levels)
}
