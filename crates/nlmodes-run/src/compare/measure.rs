//! What is measured of a contact solver.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use nlmodes::branches::{BranchError, BranchSettings, ComputedBranch, compute_branch};
use nlmodes::model::MasslessContactModel;

use crate::settings::{branch_settings, starts};
use nlmodes_scene::scene::Scene;

/// Instants of a period at which contacts are checked.
const INSTANTS: usize = 256;

/// The branch of the scene with a contact solver, and the time that it took.
pub fn branch(
    scene: &Scene,
    model: &MasslessContactModel,
    solver: &str,
) -> Result<(ComputedBranch, Duration), BranchError> {
    let settings = BranchSettings { contact_solver: solver.to_owned(), ..branch_settings(scene) };
    // With a number of modes the motions of contacts are the unknowns, however many contacts there are.
    let all = scene.is_in_open_modes().then(|| model.linear_dofs().len());
    let settings = BranchSettings { held_modes: settings.held_modes.or(all), ..settings };
    let one_way = |start| {
        let settings = BranchSettings { start, ..settings.clone() };
        compute_branch(model.clone(), &settings, |_| ControlFlow::Continue(()))
    };
    let began = Instant::now();
    let (first, second) = starts(scene.continuation.start());
    let mut computed = one_way(first)?;
    if let Some(second) = second {
        computed = one_way(second)?.preceded_by(computed);
    }
    Ok((computed, began.elapsed()))
}

/// Largest `max(−g, −Aλ, |min(g, Aλ)|)` over the points of a branch and the instants of their periods, over the
/// amplitude at grazing.
pub fn largest_violation(computed: &ComputedBranch) -> Result<f64, BranchError> {
    let Some(last) = computed.unknowns.len().checked_sub(1) else { return Ok(0.0) };
    let (mut problem, mut width) = (computed.problem(last)?, computed.unknowns[last].len());
    computed.unknowns.iter().enumerate().try_fold(0.0_f64, |worst, (point, x)| {
        if x.len() != width {
            (problem, width) = (computed.problem(point)?, x.len());
        }
        let checked = problem.check_contact(x, INSTANTS)?;
        Ok(worst.max(checked.penetration).max(checked.tension).max(checked.complementarity))
    })
}
