//! The same branch with several contact solvers.

mod difference;
mod measure;
mod table;
mod text;

use nlmodes::branches::{BranchError, ComputedBranch};
use nlmodes::hbm::HbmError;
use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::MethodKind;

use crate::settings::models;
use crate::{RunError, chain, refusal};
pub use difference::Difference;
use difference::difference;
use measure::{branch, largest_violation};
pub use table::{Row, Run, write};
pub use text::text;

/// Computes the branch with each solver; the first branch is the reference of the others.
///
/// # Errors
/// [`RunError`] where the scene is to blame, whatever the solver.
pub fn rows(file: &SceneFile, solvers: &[String]) -> Result<Vec<Row>, RunError> {
    if file.scene.method.kind == MethodKind::Shooting {
        let title = "there are no contact solvers to compare in method \"shooting\"";
        let help = "it solves contact problems at the start of a motion only; method.kind = \"ms-hbm\" solves one at \
            each instant";
        return Err(file.error_at("method.kind", title, "expected \"ms-hbm\" or \"hbm\" here", &[help]).into());
    }
    if !file.scene.responses.is_empty() {
        let title = "contact solvers are compared on the branch of a nonlinear mode, not on responses";
        let help = "`run --set method.contact_solver=NAME` computes responses with another solver";
        return Err(file.error_at("response", title, "expected a scene without [[response]]", &[help]).into());
    }
    refusal::unless_in_time(file)?;
    let model = models(file)?.massless;
    let mut reference: Option<ComputedBranch> = None;
    let mut rows = Vec::new();
    for solver in solvers {
        let outcome = match branch(&file.scene, &model, solver) {
            Ok((computed, time)) => {
                let violation = largest_violation(&computed).map_err(|error| refusal::of_branch(file, &error))?;
                let difference = reference.as_ref().map(|first| difference(&first.branch, &computed.branch));
                let run = Run::new(&computed, time, violation, difference);
                reference.get_or_insert(computed);
                Ok(run)
            }
            Err(error) if concerns_the_solver(&error) => Err(chain(&error)),
            Err(error) => return Err(refusal::of_branch(file, &error)),
        };
        rows.push(Row { solver: solver.clone(), outcome });
    }
    Ok(rows)
}

/// Whether another solver may succeed where this error was met; all other errors are those of the scene.
fn concerns_the_solver(error: &BranchError) -> bool {
    matches!(
        error,
        BranchError::Contact(_)
            | BranchError::Continuation(_)
            | BranchError::Hbm(HbmError::Contact { .. } | HbmError::Compliance(_))
    )
}
