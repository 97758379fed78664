use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

use nlmodes_continuation::{Budget, RunLog, TreeBranch, WatchedLog};
use nlmodes_hbm::{CondensedStructure, Grazing, Symmetry};
use nlmodes_modal::{BranchEnd, Event, ModalPoint};
use nlmodes_model::MasslessContactModel;

use super::accuracy::first_harmonics;
use super::branch::{BranchOrigin, BranchProgress, ComputedBranch, branch_end, label, modal_branch};
use super::found::{First, Found};
use super::prepare::{check_window, condense, exact, linear_start, shooting_modes};
use super::skip;
use super::start::{Seed, seed};
use super::trace::Tracer;
use super::{
    AccuracyReached, BranchError, BranchMethod, BranchPointRule, BranchSettings, BranchStart, Ended, FOLLOWING,
};

/// Branches of a nonlinear mode that are connected by branch points.
#[derive(Debug)]
#[non_exhaustive]
pub struct ComputedTree {
    /// Each follows the one that it leaves; the first one is never missing.
    pub branches: Vec<ComputedBranch>,
    /// Half-branches of branch points that were found but not followed, since [`BranchSettings::max_branches`] was
    /// reached.
    pub not_followed: usize,
}

/// Computes the nonlinear mode of `model` as one branch. Each point is shown to `observe` when it is found, its
/// stability follows when the branch is complete.
///
/// # Errors
/// As [`compute_tree`].
pub fn compute_branch(
    model: MasslessContactModel,
    settings: &BranchSettings,
    mut observe: impl FnMut(&ModalPoint) -> ControlFlow<()>,
) -> Result<ComputedBranch, BranchError> {
    let settings = BranchSettings { max_branches: 1, ..settings.clone() };
    let mut tree = compute_tree(model, &settings, |progress| match progress {
        BranchProgress::Found { point, .. } => observe(point),
        BranchProgress::Withdrawn { .. } => ControlFlow::Continue(()),
    })?;
    Ok(tree.branches.swap_remove(0))
}

/// Computes the nonlinear mode of `model` with all branches that the settings ask for: by MS-HBM where its contact
/// nodes are massless, by conventional HBM where it was made with spring tips, or either exactly by shooting.
///
/// # Errors
/// [`BranchError`] if there is no branch at all; one that ends early comes back with its points and the reason.
pub fn compute_tree(
    model: MasslessContactModel,
    settings: &BranchSettings,
    observe: impl FnMut(BranchProgress) -> ControlFlow<()>,
) -> Result<ComputedTree, BranchError> {
    compute_tree_with_log(model, settings, &mut (), observe)
}

/// As [`compute_tree`], each step of the continuation going into a log. Steps that this holds already, from an earlier
/// computation with the same model and settings, are not computed again: their points are shown to `observe`, and the
/// computation goes on behind them.
///
/// # Errors
/// As [`compute_tree`].
pub fn compute_tree_with_log(
    model: MasslessContactModel,
    settings: &BranchSettings,
    log: &mut dyn RunLog,
    mut observe: impl FnMut(BranchProgress) -> ControlFlow<()>,
) -> Result<ComputedTree, BranchError> {
    let (mut settings, fewest, mut at_least) = (settings.clone(), settings.harmonics, 0);
    if let Some(accuracy) = settings.accuracy {
        settings.harmonics = first_harmonics(accuracy, &settings.growth, fewest);
    }
    let mut log = WatchedLog { log, watch: settings.watch.clone() };
    loop {
        match with_modes(&model, &settings, [fewest, at_least], &mut log, &mut observe) {
            Ok(WithModes::Done(tree)) => return Ok(tree),
            Ok(WithModes::TooFew(modes)) => at_least = 2 * modes,
            // Whatever failed, it did since nothing was evaluated any more.
            Err(_) if settings.watch.has_ended() => return Err(Ended.into()),
            Err(error) => return Err(error),
        }
        // Where nothing more is wanted, the next point will tell.
        let _ = observe(BranchProgress::Withdrawn { branch: 0, kept: 0 });
    }
}

/// What comes of a number of held modes.
enum WithModes {
    Done(ComputedTree),
    /// So many do not reach the accuracy.
    TooFew(usize),
}

fn with_modes(
    model: &MasslessContactModel,
    settings: &BranchSettings,
    [fewest, at_least]: [usize; 2],
    log: &mut dyn RunLog,
    observe: &mut dyn FnMut(BranchProgress) -> ControlFlow<()>,
) -> Result<WithModes, BranchError> {
    if settings.method == BranchMethod::Shooting {
        shooting_modes(model, settings)?;
    }
    let structure = Arc::new(condense(model.clone(), settings, at_least)?);
    let mut budget = Budget::new(settings.stability_budget_s);
    let start = begin(&structure, settings)?;
    check_window(settings, &start)?;
    let mut tracer = Tracer::new(&structure, &start, settings, fewest, log)?;
    let seed = seed(&structure, settings, &start, &mut tracer.problem, tracer.log)?;
    let from_grazing = settings.start == BranchStart::Grazing && !start.touches_at_rest();
    let start_event = match from_grazing {
        true if start.lifts_off => Event::LiftOff,
        true => Event::Grazing,
        false => Event::Start,
    };
    settings.watch.begins(FOLLOWING)?;
    let (traced, not_followed) = match settings.at_branch_point {
        BranchPointRule::All => all(&mut tracer, &seed, start_event, observe)?,
        _ if settings.skips_internal_resonances() => {
            let (found, end) = skip::follow(&mut tracer, seed, start_event, observe)?;
            (vec![Traced { found, end, origin: None }], 0)
        }
        _ => (vec![one(&mut tracer, &seed, start_event, observe)?], 0),
    };
    if tracer.too_few_modes {
        return Ok(WithModes::TooFew(structure.n_held_modes()));
    }
    let branches = traced.into_iter().enumerate();
    let mut branches: Vec<ComputedBranch> =
        branches.map(|(number, traced)| computed(&tracer, &structure, settings, number, traced)).collect();
    for number in 0..branches.len() {
        let began = Instant::now();
        let added = branches[number].find_stability(&mut budget);
        branches[number].stability_time = began.elapsed();
        let origins = branches.iter_mut().filter_map(|branch| branch.origin.as_mut());
        for origin in origins.filter(|origin| origin.branch == number) {
            origin.point += added.iter().filter(|before| **before <= origin.point).count();
        }
    }
    Ok(WithModes::Done(ComputedTree { branches, not_followed }))
}

/// A branch with its name and its structure.
fn computed(
    tracer: &Tracer,
    structure: &Arc<CondensedStructure>,
    settings: &BranchSettings,
    number: usize,
    Traced { found, end, origin }: Traced,
) -> ComputedBranch {
    let name = if number == 0 {
        label(settings, structure.model().contact_coordinates(), structure.n_coupled_modes())
    } else {
        format!("branch {number}")
    };
    let unknowns = found.unknowns;
    // δ is the last unknown, whatever the number of harmonics.
    let free = settings.symmetry == Symmetry::None && settings.method == BranchMethod::HarmonicBalance;
    let unfolding = unknowns.iter().filter_map(|x| x.last().filter(|_| free)).map(|delta| delta.abs());
    let accuracy = settings.accuracy.map(|_| AccuracyReached {
        largest_held_modes_estimate: found.largest_held_modes_error,
        changes: found.points.iter().filter(|point| point.has_event(Event::Harmonics)).count(),
        ..AccuracyReached::default()
    });
    let mut computed = ComputedBranch {
        largest_unfolding: unfolding.reduce(f64::max),
        branch: modal_branch(tracer, name, found.points, end),
        structure: Arc::clone(structure),
        grazing: tracer.grazing.clone(),
        origin,
        unknowns,
        evaluations: found.evaluations,
        stability_time: Duration::ZERO,
        contact_iterations: tracer.contact_iterations(),
        refused_steps: found.refused_steps,
        accuracy,
        settings: settings.clone(),
    };
    computed.review_accuracy();
    computed.review_departure();
    computed.review_return();
    computed
}

/// Where the nonlinear mode begins. That of shooting on few modes is the grazing of these.
pub(super) fn begin(structure: &CondensedStructure, settings: &BranchSettings) -> Result<Grazing, BranchError> {
    match settings.method {
        BranchMethod::HarmonicBalance => linear_start(structure, settings),
        BranchMethod::Shooting => {
            let start = linear_start(structure, settings)?;
            let own = exact(structure.model(), settings, &start)?.scales();
            Ok(start.counted_by(own.omega, own.energy))
        }
    }
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
    start_event: Event,
    observe: &mut dyn FnMut(BranchProgress) -> ControlFlow<()>,
) -> Result<Traced, BranchError> {
    let (mut count, limit) = (0, tracer.settings.max_points);
    let (found, stop) = tracer.trace(seed, None, First::Named(start_event), |progress| {
        observe(progress)?;
        count = match progress {
            BranchProgress::Found { .. } => count + 1,
            BranchProgress::Withdrawn { kept, .. } => kept,
        };
        if count < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    let end = branch_end(&stop, tracer, found.points.len());
    Ok(Traced { found, end, origin: None })
}

/// All branches that are connected by branch points, and the number of half-branches left; the limit of points holds
/// for all together.
fn all(
    tracer: &mut Tracer,
    seed: &Seed,
    start_event: Event,
    observe: &mut dyn FnMut(BranchProgress) -> ControlFlow<()>,
) -> Result<(Vec<Traced>, usize), BranchError> {
    let (mut count, limit) = (0, tracer.settings.max_points);
    let (found, tree) = tracer.trace_tree(seed, start_event, |branch, point| {
        observe(BranchProgress::Found { branch, point })?;
        count += 1;
        if count < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    let origin = |b: &TreeBranch| {
        let from = b.origin?;
        let at = tree.branches[from.branch].branch.crossings.get(from.crossing)?.point;
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
