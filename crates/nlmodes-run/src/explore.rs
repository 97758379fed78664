//! The first branch of a scene without files, as data of the page: computed anew while somebody changes the scene.

use std::ops::ControlFlow;

use nlmodes::branches::{BranchPointRule, BranchSettings, Histories, StabilityRule, Watch, compute_branch};
use nlmodes::modal::{ModalBranch, ModalPoint};
use nlmodes::report::HtmlReport;
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::Structures;

use crate::branches::{held_ends, stop_lines};
use crate::settings::{Models, branch_settings, models_sharing, starts};
use crate::{Failure, RunError, refusal};

/// Most points: somebody waits for them.
const MOST_POINTS: usize = 600;
/// Instants of a period of the contacts.
const SAMPLES: usize = 120;

/// Computes the branch of a scene from its start; one way where it goes both ways, without stability. Of a scene with
/// responses the first curve of the first one.
///
/// It is shown as the page's script takes it: JSON of the branch with the motions of its points. `watch` may end it;
/// what `structures` know of files is not read and reduced again.
///
/// # Errors
/// [`RunError`] if there is no branch, [`RunError::Ended`] if it was asked to end.
pub fn picture(file: &SceneFile, watch: Watch, structures: &Structures) -> Result<String, RunError> {
    if !file.scene.responses.is_empty() {
        return crate::responses::picture(file, &watch, structures);
    }
    let Models { model: _, massless, .. } = models_sharing(file, structures)?;
    let plain = branch_settings(&file.scene);
    let settings = BranchSettings {
        start: starts(file.scene.continuation.start).0,
        stability: StabilityRule::Never,
        at_branch_point: match plain.at_branch_point {
            BranchPointRule::All => BranchPointRule::Stay,
            rule => rule,
        },
        max_points: plain.max_points.min(MOST_POINTS),
        watch: watch.clone(),
        ..plain
    };
    let ended = watch.clone();
    let going_on = |_: &ModalPoint| match ended.has_ended() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let computed = compute_branch(massless, &settings, going_on).map_err(|error| refusal::of_branch(file, &error))?;
    if watch.has_ended() {
        return Err(RunError::Ended);
    }
    let branches: [&ModalBranch; 1] = [&computed.branch];
    let histories = std::cell::RefCell::new(Histories::of(&computed));
    let motion = |_: usize, point: usize| {
        let mut histories = histories.try_borrow_mut().ok()?;
        if watch.has_ended() { None } else { histories.at(point, SAMPLES, "").ok() }
    };
    let report = HtmlReport::new(&file.scene.title, &branches)
        .clamped_at(&held_ends(&file.scene, &computed))
        .stops(&stop_lines(&computed))
        .contact_motion(&motion);
    let text = report.data().map_err(|error| RunError::Files(Failure::from(error)))?;
    if watch.has_ended() { Err(RunError::Ended) } else { Ok(text) }
}
