use std::ops::ControlFlow;
use std::sync::Arc;

use nlmodes_continuation::TreeBranch;
use nlmodes_modal::{BranchEnd, ModalPoint};
use nlmodes_model::MasslessContactModel;

use super::branch::{BranchOrigin, BranchProgress, ComputedBranch, branch_end, label, modal_branch};
use super::prepare::{check_window, condense, linear_start};
use super::skip;
use super::start::{Seed, seed};
use super::trace::{First, Found, Tracer};
use super::{BranchPointRule, BranchSettings, BranchStart, ResonanceRule, StudyError};

/// Branches of a nonlinear mode that are connected by branch points.
#[derive(Debug)]
pub struct ComputedTree {
    /// Each stands behind the one that it leaves; the first one is never missing.
    pub branches: Vec<ComputedBranch>,
    /// Arms of branch points that were found but not followed, since [`BranchSettings::max_branches`] was reached.
    pub not_followed: usize,
}

/// Computes the nonlinear mode of `model` as one branch. Each point is shown to `observe` when it is found.
///
/// # Errors
/// As [`compute_tree`].
pub fn compute_branch(
    model: MasslessContactModel,
    settings: &BranchSettings,
    mut observe: impl FnMut(&ModalPoint) -> ControlFlow<()>,
) -> Result<ComputedBranch, StudyError> {
    let settings = BranchSettings { max_branches: 1, ..settings.clone() };
    let mut tree = compute_tree(model, &settings, |progress| match progress {
        BranchProgress::Found { point, .. } => observe(point),
        BranchProgress::Withdrawn { .. } => ControlFlow::Continue(()),
    })?;
    Ok(tree.branches.swap_remove(0))
}

/// Computes the nonlinear mode of `model` with all branches that the settings ask for: by MS-HBM where its contact nodes are massless,
/// by conventional HBM where it was made with spring tips.
///
/// # Errors
/// [`StudyError`] if there is no branch at all; one that ends early comes back with its points and the reason.
pub fn compute_tree(
    model: MasslessContactModel,
    settings: &BranchSettings,
    mut observe: impl FnMut(BranchProgress) -> ControlFlow<()>,
) -> Result<ComputedTree, StudyError> {
    let structure = Arc::new(condense(model, settings)?);
    let start = linear_start(&structure, settings)?;
    check_window(settings, &start)?;
    let mut tracer = Tracer::new(&structure, &start, settings)?;
    let seed = seed(&structure, settings, &start, &tracer.problem)?;
    let from_grazing = settings.start == BranchStart::Grazing && !start.touches_at_rest();
    let start_event = if from_grazing { "grazing" } else { "start" };
    let (traced, not_followed) = match (settings.at_branch_point, settings.internal_resonance) {
        (BranchPointRule::All, _) => all(&mut tracer, &seed, start_event, &mut observe)?,
        (_, ResonanceRule::Skip) => {
            let (found, end) = skip::follow(&mut tracer, seed, start_event, &mut observe)?;
            (vec![Traced { found, end, origin: None }], 0)
        }
        (_, ResonanceRule::Follow) => (vec![one(&mut tracer, &seed, start_event, &mut observe)?], 0),
    };
    let branches = traced.into_iter().enumerate().map(|(number, traced)| {
        let Traced { found, end, origin } = traced;
        let name = if number == 0 {
            label(settings, structure.model().contact_coordinates())
        } else {
            format!("branch {number}")
        };
        let unknowns: Vec<Vec<f64>> = found.unknowns;
        let unfolding = unknowns.iter().filter_map(|x| tracer.problem.unfolding(x)).map(f64::abs);
        ComputedBranch {
            largest_unfolding: unfolding.reduce(f64::max),
            branch: modal_branch(&tracer, name, found.points, end),
            structure: Arc::clone(&structure),
            grazing: start.clone(),
            origin,
            unknowns,
            evaluations: found.evaluations,
            contact_iterations: tracer.problem.contact_iterations(),
            refused_steps: found.refused_steps,
            settings: settings.clone(),
        }
    });
    let branches = branches.collect();
    Ok(ComputedTree { branches, not_followed })
}

/// A branch before it is given its name and its structure.
struct Traced {
    found: Found,
    end: BranchEnd,
    origin: Option<BranchOrigin>,
}

fn one(
    tracer: &mut Tracer,
    seed: &Seed,
    start_event: &str,
    observe: &mut dyn FnMut(BranchProgress) -> ControlFlow<()>,
) -> Result<Traced, StudyError> {
    let (mut count, limit) = (0, tracer.settings.max_points);
    let (found, stop) = tracer.trace(seed, None, First::Named(start_event), |point| {
        observe(BranchProgress::Found { branch: 0, point })?;
        count += 1;
        if count < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    let end = branch_end(&stop, tracer, found.points.len());
    Ok(Traced { found, end, origin: None })
}

/// All branches that are connected by branch points, and the number of arms left; the limit of points holds for all together.
fn all(
    tracer: &mut Tracer,
    seed: &Seed,
    start_event: &str,
    observe: &mut dyn FnMut(BranchProgress) -> ControlFlow<()>,
) -> Result<(Vec<Traced>, usize), StudyError> {
    let (mut count, limit) = (0, tracer.settings.max_points);
    let (found, tree) = tracer.trace_tree(seed, start_event, |branch, point| {
        observe(BranchProgress::Found { branch, point })?;
        count += 1;
        if count < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    let origin = |b: &TreeBranch| {
        let from = b.origin?;
        let at = tree.branches[from.branch].branch.crossings[from.crossing].point;
        Some(BranchOrigin { branch: from.branch, point: found[from.branch].index_of(at) })
    };
    let origins: Vec<Option<BranchOrigin>> = tree.branches.iter().map(origin).collect();
    let traced = found.into_iter().zip(&tree.branches).zip(origins).map(|((found, b), origin)| {
        // The limit is that of all branches together.
        let shown = if count < limit { found.points.len() } else { limit };
        Traced { end: branch_end(&b.branch.stop, tracer, shown), found, origin }
    });
    Ok((traced.collect(), tree.not_followed))
}
