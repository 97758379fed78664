//! The branches of a scene, of each of its methods and numbers of harmonics.

pub(crate) mod curve;
mod page;
mod references;
mod several;
mod sink;
mod starts;
mod summary;

use std::time::{Duration, Instant};

use nlmodes::branches::{
    BranchError, BranchSettings, ComputedBranch, ComputedTree, check_branch, compute_tree_with_log,
};
use nlmodes::modal::{EndReason, ModalBranch, Participation};
use nlmodes::model::{MasslessContactModel, StructuralModel};
use nlmodes::report::write_branch;
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::{OpenStructure, StaticState, Structures, node_contacts};
use nlmodes_scene::scene::Scene;

use crate::certificate::{Certificate, Sources};
use crate::claim::Claim;
use crate::curve::space::Period;
use crate::curve::stress::{Stress, moves_of_branch};
use crate::curve::{Curve, LINEAR_MODES, figures, histories, tables};
use crate::journal::Journal;
use crate::linear::{LinearFrequencies, frequencies};
use crate::open_modes::OpenLinearModes;
use crate::outcome::{PartOutcome, RunOutcome};
use crate::overlay::{self, Laid, Overlaid};
use crate::physical::recover;
use crate::settings::{Checked, Models, branch_settings, models, models_sharing, starts};
use crate::style::style_of;
use crate::updating::updated;
use crate::{Event, Failure, Observer, Over, RunError, doubts, gradients, links, mass, no_contact, refusal, sliding};
use curve::BranchCurve;
use sink::{Sink, branch_directory};

/// Computes the branches of scenes that differ in their method only, and writes their files into the directory that the
/// first one names.
///
/// Each point is in `branch.csv`, and the step to it in `steps.jsonl`, as soon as it is found. Nothing is written
/// before the first one. Several methods or numbers of harmonics have a folder each, and common figures beside these.
///
/// # Errors
/// [`RunError`] if there are no results; a branch that ended early is in the outcome.
pub fn run(scenes: Vec<SceneFile>, over: Over, observer: &mut dyn Observer) -> Result<RunOutcome, RunError> {
    run_sharing(scenes, over, observer, &Structures::default())
}

/// The same with structures from files that other runs have read and reduced, and that this one leaves to others.
///
/// # Errors
/// As [`run`].
pub fn run_sharing(
    scenes: Vec<SceneFile>,
    over: Over,
    observer: &mut dyn Observer,
    structures: &Structures,
) -> Result<RunOutcome, RunError> {
    for file in &scenes {
        refusal::unless_in_time(file)?;
        if file.scene.n_contact_tables() == 0 {
            return Err(no_contact(file).into());
        }
        links::refuse(&file.scene.output_directory)?;
    }
    // Of a scene with several methods all lay the same over.
    let first = scenes.first().ok_or(RunError::NoScene)?;
    let laid = overlay::laid_over(first, &first.scene.overlays, &overlay::MODES, observer)?;
    let claim = Claim::of_scenes(&scenes, over, observer)?;
    let of = scenes.len();
    let mut files = Vec::new();
    for (number, file) in scenes.into_iter().enumerate() {
        if file.scene.updating.is_some() {
            observer.event(Event::Updating { number, of, scene: &file.scene });
        }
        let file = updated(file)?;
        if let Some(updating) = &file.scene.updating {
            observer.event(Event::Updated(updating));
        }
        files.push(file);
    }
    match several::parts(&files).as_slice() {
        [only] => {
            let part = one_branch(&only.file, &claim, &laid, observer, structures)?;
            Ok(RunOutcome { parts: vec![part], compared: Vec::new(), failure: None, is_cut_off: false })
        }
        parts => several::run(&files, parts, (&claim, &laid), observer, structures),
    }
}

/// One branch with all its files, and how it ended.
fn one_branch(
    file: &SceneFile,
    claim: &Claim,
    laid: &[Laid],
    observer: &mut dyn Observer,
    structures: &Structures,
) -> Result<PartOutcome, RunError> {
    let scene = &file.scene;
    let directory = &scene.output_directory;
    let unwritable = |source, kept| RunError::Unwritable { directory: directory.clone(), source, kept };
    let began = Instant::now();
    let Models { model, massless, open, state } = models_sharing(file, structures)?;
    observer.event(Event::Begun(scene));
    doubts::tell(scene, open.as_ref(), observer);
    refusal::unless_branch(file, open.as_ref())?;
    gradients::check(file, open.as_ref())?;
    let modes = mass::open_modes(file, &model, &massless)
        .map_err(|error| refusal::unless_floating(file, open.as_ref(), error))?;
    observer.warn(mass::warning(scene, &modes));
    let mut journal = Journal::begun(scene, claim, observer)?;
    let mut sink = Sink::new(directory, claim, (journal.computing.clone(), state.as_ref()), observer);
    let tree = compute(scene, massless.clone(), &mut journal, &mut sink);
    sink.finish();
    if let Some(failure) = sink.failure.take().or(journal.failure) {
        return Err(unwritable(failure, !sink.is_empty()));
    }
    let mut tree = tree.map_err(|error| refusal::of_branch_in(file, open.as_ref(), &error))?;
    let stability_time: Duration = tree.branches.iter().map(|computed| computed.stability_time).sum();
    let points_time = began.elapsed().saturating_sub(stability_time);
    let thorough = observer.certifies() && !observer.is_cancelled();
    let watch = observer.watch();
    let shift = mass::shift(scene, &modes);
    let sources = Sources { scene, open: open.as_ref(), shift, thorough, points_time, watch: &watch };
    let mut look = |check, point, number| {
        observer.event(Event::Looking { check, point, number });
        !observer.is_cancelled()
    };
    let certificates: Vec<Certificate> =
        tree.branches.iter().map(|branch| Certificate::of(branch, sources, &mut look)).collect();
    let found = whole(scene, &model, &massless, &modes, &tree);
    let slid = slid(scene, (&model, open.as_ref()), structures, &mut tree.branches);
    let differentiated =
        gradients::of_branches(scene, open.as_ref(), (structures, observer.watch()), &mut tree.branches);
    observer.warn(differentiated.as_ref().ok().and_then(|without| without_gradients(*without)));
    recover(scene, (open.as_ref(), state.as_ref()), &mut tree.branches);
    let stress = Stress::of(scene, open.as_ref(), &[]);
    let stress_left_out = Stress::left_out(scene, open.as_ref(), 0);
    observer.warn(&stress_left_out);
    let stressed = match &stress {
        Ok(Some(stress)) => stressed(scene, (stress, open.as_ref()), state.as_ref(), &mut tree.branches),
        _ => Ok(()),
    };
    let rewritten = rewritten(scene, &tree.branches);
    let solids = stress.as_ref().ok().and_then(|stress| stress.as_ref()?.solids());
    let laid = tree.branches.first().map(|first| Overlaid::new(laid, &BranchCurve::new(first, &[], state.as_ref())));
    let (written, linear, participation) = match found {
        Ok((mut linear, participation)) => {
            open.iter().for_each(|open| linear.complete(scene, open));
            let is_shown = scene.files.figures || scene.files.page;
            let curves = tree.branches.iter().zip(&participation);
            let curves: Vec<BranchCurve<'_>> =
                curves.map(|(one, found)| BranchCurve::new(one, found, state.as_ref())).collect();
            let period = match curves.first().filter(|_| is_shown) {
                Some(first) => Period::of(open.as_ref(), first, solids),
                None => Ok(None),
            };
            let found = period.as_ref().ok().and_then(Option::as_ref);
            observer.warn(found.and_then(Period::warning));
            let about = About {
                linear: &linear,
                period: found,
                open: open.as_ref(),
                state: state.as_ref(),
                stress_left_out: stress_left_out.as_deref(),
            };
            let curves: Vec<&dyn Curve> = curves.iter().map(|curve| curve as &dyn Curve).collect();
            let written = match &laid {
                Some(laid) => write(scene, &about, (&tree, &curves, &certificates, laid), began),
                None => Ok(()),
            };
            let written =
                written.and(period.map(drop)).and(slid).and(stressed).and(differentiated.map(drop)).and(rewritten);
            let written = written.and(stress.as_ref().map(drop).map_err(|error| error.to_string().into()));
            (written, linear, participation)
        }
        Err(error) => (Err(error), LinearFrequencies::default(), Vec::new()),
    };
    let part = PartOutcome {
        scene: scene.clone(),
        is_complete: written.is_ok() && tree.branches.iter().all(|computed| computed.branch.end.complete),
        tree,
        state,
        linear,
        participation,
        certificates,
        points_time,
        compared: laid.as_ref().map(Overlaid::lines).unwrap_or_default(),
        wall_time: began.elapsed(),
        failure: written.err(),
    };
    let n_points = part.tree.branches.first().map_or(0, |computed| computed.branch.points.len());
    observer.warn(histories::missing(&part.scene.files, "branch", n_points));
    observer.event(Event::Done(&part));
    Ok(part)
}

/// Says how the contacts of the branches slide.
fn slid(
    scene: &Scene,
    (model, open): (&StructuralModel, Option<&OpenStructure>),
    structures: &Structures,
    branches: &mut [ComputedBranch],
) -> Result<(), Failure> {
    let found = if open.is_some() { None } else { node_contacts(scene, structures)? };
    let nodes = open.map_or(found.as_ref(), |open| open.files.as_ref());
    sliding::of_branches(scene, (model, open), nodes, branches)
}

/// Says how large the stress of the branches is.
fn stressed(
    scene: &Scene,
    (stress, open): (&Stress, Option<&OpenStructure>),
    state: Option<&StaticState>,
    branches: &mut [ComputedBranch],
) -> Result<(), Failure> {
    for computed in branches {
        let moves = |point: usize, dofs: &[usize]| moves_of_branch(scene, open, computed, point, dofs);
        let found = stress.of_points(&BranchCurve::new(computed, &[], state), open, moves)?;
        computed.branch.points.iter_mut().zip(found).for_each(|(point, found)| point.stress = found);
    }
    Ok(())
}

/// Writes the tables of all branches anew, with what was found of their points at the end.
fn rewritten(scene: &Scene, branches: &[ComputedBranch]) -> Result<(), Failure> {
    for (number, computed) in branches.iter().enumerate() {
        write_branch(branch_directory(&scene.output_directory, number).join("branch.csv"), &computed.branch)?;
    }
    Ok(())
}

/// What is to be reported where points have no derivatives.
fn without_gradients(points: usize) -> Option<String> {
    let are = if points == 1 {
        "1 point has no gradient: it is".to_owned()
    } else {
        format!("{points} points have no gradients: they are")
    };
    (points > 0).then(|| format!("{are} not found again at the same energy, as next to a fold of the energy"))
}

/// Whether a run of the scene would begin, with each of its numbers of harmonics.
///
/// # Errors
/// [`RunError`] that says why it would not.
pub(crate) fn check(file: &SceneFile, observer: &mut dyn Observer) -> Result<Checked, RunError> {
    if !file.scene.responses.is_empty() {
        return crate::responses::check(file, observer);
    }
    if file.scene.transient.is_some() {
        return crate::transient::check(file, observer);
    }
    overlay::laid_over(file, &file.scene.overlays, &overlay::MODES, observer)?;
    let Models { massless, open, state, .. } = models(file)?;
    doubts::tell(&file.scene, open.as_ref(), observer);
    refusal::unless_branch(file, open.as_ref())?;
    let list = &file.scene.method.harmonics_list;
    // They differ in size only.
    let harmonics = list.iter().copied().max().unwrap_or(file.scene.method.harmonics);
    let (start, _) = starts(file.scene.continuation.start());
    let settings = BranchSettings { start, harmonics, ..branch_settings(&file.scene) };
    check_branch(&massless, &settings).map_err(|error| refusal::of_branch_in(file, open.as_ref(), &error))?;
    Ok((open, state))
}

/// The branches from their start; where both ways are asked for, the way down first and then, behind its points in
/// reverse order, the way up.
fn compute(
    scene: &Scene,
    model: MasslessContactModel,
    journal: &mut Journal,
    sink: &mut Sink,
) -> Result<ComputedTree, BranchError> {
    let (start, other) = starts(scene.continuation.start());
    let settings = BranchSettings { start, watch: sink.observer.watch(), ..branch_settings(scene) };
    let mut tree = compute_tree_with_log(model.clone(), &settings, journal, |progress| sink.take(progress))?;
    let ended = sink.failure.is_some() || journal.failure.is_some() || sink.observer.is_cancelled();
    let (Some(start), false) = (other, ended) else { return Ok(tree) };
    let first = tree.branches.swap_remove(0);
    sink.begin_again(first.branch.points.iter().skip(1).rev());
    let settings = BranchSettings { start, ..settings };
    let mut tree = match compute_tree_with_log(model, &settings, journal, |progress| sink.take(progress)) {
        Err(BranchError::Ended(_)) => {
            sink.begin_again(first.branch.points.iter());
            tree.branches.push(one_way_only(first));
            return Ok(tree);
        }
        tree => tree?,
    };
    let second = tree.branches.swap_remove(0);
    tree.branches.push(second.preceded_by(first));
    Ok(tree)
}

/// The way down of a branch that was asked to end before its way up began.
fn one_way_only(mut first: ComputedBranch) -> ComputedBranch {
    first.branch.end.message += "; the other way was not begun";
    (first.branch.end.reasons, first.branch.end.complete) = (vec![EndReason::Stopped], false);
    first
}

/// What several files show of the structure and of whole branches: computed once.
fn whole(
    scene: &Scene,
    model: &StructuralModel,
    massless: &MasslessContactModel,
    open: &OpenLinearModes,
    tree: &ComputedTree,
) -> Result<(LinearFrequencies, Vec<Vec<Participation>>), Failure> {
    let linear = frequencies(scene, model, massless, open)?;
    let participation = tree.branches.iter().map(|computed| computed.participation(LINEAR_MODES));
    Ok((linear, participation.collect::<Result<_, _>>()?))
}

/// Writes all files that are made of whole branches.
fn write(
    scene: &Scene,
    about: &About<'_>,
    (tree, curves, certificates, laid): (&ComputedTree, &[&dyn Curve], &[Certificate], &Overlaid),
    began: Instant,
) -> Result<(), Failure> {
    let directory = &scene.output_directory;
    if let Some(period) = about.period {
        period.write(scene)?;
    }
    for (number, curve) in curves.iter().enumerate() {
        tables::write(&branch_directory(directory, number), &[*curve])?;
    }
    starts::write(directory, scene, (about.open, about.state), &tree.branches)?;
    summary::write(directory, (scene, about), (tree, certificates), began.elapsed())?;
    let Some(first) = curves.first() else { return Ok(()) };
    tables::write_motions(directory, &scene.files, &[*first])?;
    laid.write(directory, "overlay")?;
    if !(scene.files.figures || scene.files.page) {
        return Ok(());
    }
    let references = histories::own_references(*first)?;
    if scene.files.figures {
        let shown: Vec<&ModalBranch> = curves.iter().map(|curve| curve.branch()).chain(laid.branches()).collect();
        let scattered = laid.scattered(curves.len());
        figures::frequencies(directory, scene, (&shown, &scattered), &first.pictured(), &references)?;
        figures::write(directory, scene, (curves, 0), &scene.title)?;
        histories::write(directory, &references, &style_of(&scene.files))?;
    }
    if !scene.files.page {
        return Ok(());
    }
    let branches: Vec<&ComputedBranch> = tree.branches.iter().collect();
    let certified: Vec<&Certificate> = certificates.iter().collect();
    let methods = Overlaid::others(&[]);
    let shown = (branches.as_slice(), curves, certified.as_slice());
    page::write(directory, &[scene], about.linear, shown, (laid, &methods), (&references, about.period))
}

/// What is known about the branches beside their points.
struct About<'a> {
    linear: &'a LinearFrequencies,
    period: Option<&'a Period>,
    open: Option<&'a OpenStructure>,
    state: Option<&'a StaticState>,
    /// Why stress is not recovered, if only the size of the structure prevents it.
    stress_left_out: Option<&'a str>,
}
