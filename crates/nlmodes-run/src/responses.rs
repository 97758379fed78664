//! Damped and forced motions of a scene: response curves, phase resonance, damped and conservative modes.

mod certified;
mod convert;
mod curves;
#[cfg(feature = "explore")]
mod effects;
mod figures;
mod gradients;
mod levels;
mod overlaid;
mod page;
mod picture;
mod summary;
mod sweeps;
mod tables;
mod unstable;
mod viewed;

use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

use nlmodes::report::ReportError;
use nlmodes::report::columns::ResponseDifferenceRow;
use nlmodes::response::StepLog;
use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::Scene;

use crate::certificate::Certificate;
use crate::claim::Claim;
use crate::curve::space::Period;
use crate::curve::stress::{Stress, chosen};
use crate::curve::{self, Curve, histories};
use crate::doubts;
use crate::journal::Journal;
use crate::model::Model;
use crate::overlay::LaidCurve;
use crate::settings::Checked;
use crate::style::style_of;
use crate::updating::updated;
use crate::{Event, Failure, Observer, Over, RunError, links, no_contact};
pub use curves::ComputedResponse;
use curves::{Job, detached, follow, jobs};
pub(crate) use curves::{curves_at, resonances_to};
#[cfg(feature = "explore")]
pub(crate) use effects::effects;
pub(crate) use gradients::{change, watched};
pub use levels::Level;
pub(crate) use picture::picture;
use sweeps::Sweep;
use viewed::{pictured_of, viewed};

/// What came out of the responses of a scene.
#[derive(Debug)]
pub struct ResponsesOutcome {
    /// The scene, with parameters that were updated.
    pub scene: Scene,
    /// The curves in the order of the scene; detached ones behind them.
    pub curves: Vec<ComputedResponse>,
    /// What a sweep over the frequency meets at each level.
    pub levels: Vec<Level>,
    /// Unit of the levels.
    pub level_unit: &'static str,
    /// What was looked at in the curves, and which of their numbers to use.
    pub certificate: Certificate,
    /// From the beginning to the last file.
    pub wall_time: Duration,
    /// Whether it was asked to end before all curves were there.
    pub is_cut_off: bool,
    /// Curves of the scene that were not begun then.
    pub not_begun: usize,
    /// Why some files are not there: everything else is.
    pub failure: Option<Failure>,
}

impl ResponsesOutcome {
    /// Whether all curves ended where they were meant to, and all files are there.
    pub fn is_complete(&self) -> bool {
        !self.is_cut_off && self.failure.is_none() && self.curves.iter().all(ComputedResponse::is_complete)
    }
}

/// The scene whose responses are computed: they are with one method.
///
/// # Errors
/// [`RunError`] at the second method.
pub fn one_method(files: &[SceneFile]) -> Result<&SceneFile, RunError> {
    match files {
        [] => Err(RunError::NoScene),
        [file] => Ok(file),
        [_, second, ..] => {
            let title = "responses are computed with one method";
            Err(second.error_at("method", title, "expected one table [method]", &[]).into())
        }
    }
}

/// Computes the responses of a scene and writes its tables, figures and page.
///
/// Each step is in `steps.jsonl` as soon as it is taken, and a run that goes on repeats those that are there.
/// `branch.csv` is written anew after each curve; the other files at the end, also of a run that is asked to end.
///
/// # Errors
/// [`RunError`] if the scene cannot be computed or nothing can be written; a curve that ended early or has no start is
/// in the outcome.
pub fn run(file: &SceneFile, over: Over, observer: &mut dyn Observer) -> Result<ResponsesOutcome, RunError> {
    let laid = overlaid::read(file, observer)?;
    if file.scene.is_linear() {
        return Err(no_contact(file).into());
    }
    links::refuse(&file.scene.output_directory)?;
    let claim = Claim::of_scenes(std::slice::from_ref(file), over, observer)?;
    let began = Instant::now();
    let file = updated(file.clone())?;
    let model = Model::new(&file)?;
    doubts::tell(&file.scene, model.reduction.as_ref(), observer);
    observer.warn(&model.warnings);
    let journal = Rc::new(RefCell::new(Journal::begun(&file.scene, &claim, observer)?));
    let (scene, curves) = (&file.scene, Vec::new());
    let (stress, failed) = match Stress::of(scene, model.reduction.as_ref(), &model.response().load_shapes()) {
        Ok(stress) => (stress, None),
        Err(failure) => (None, Some(failure)),
    };
    let stress = stress.as_ref();
    observer.warn(model.stress_left_out(scene));
    let mut following = Following { scene, model: &model, claim: &claim, journal, observer, curves, stress, failed };
    let not_begun = following.all()?;
    let Following { observer, curves, failed, .. } = following;
    let sweeps = if not_begun.is_some() { Vec::new() } else { sweeps::all(&file, &model, observer)? };
    let certificate = certified::certificate(&file.scene, &model, &curves);
    let mut levels = levels::all(&curves, &sweeps);
    if observer.certifies() && !observer.is_cancelled() {
        let mut look = |check, point, number| {
            observer.event(Event::Looking { check, point, number });
            !observer.is_cancelled()
        };
        unstable::follow((&file.scene, &model), &curves, &mut levels, &mut look);
    }
    let beside = |curve: &LaidCurve| (curve.clone(), overlaid::beside(curve, &curves));
    let compared: Vec<(LaidCurve, Vec<ResponseDifferenceRow>)> = laid.iter().map(beside).collect();
    observer.warn(compared.iter().filter_map(|(curve, found)| overlaid::left_out(curve, found)));
    let n_points = curves.iter().map(|computed| computed.branch.points.len()).sum();
    observer.warn(histories::missing(&file.scene.files, "run", n_points));
    let period = period(&file.scene, &model, &curves, stress);
    observer.warn(period.as_ref().ok().and_then(Option::as_ref).and_then(Period::warning));
    let written = |period: Option<Period>| {
        let said = (&certificate, levels.as_slice());
        files(&file.scene, &model, (&curves, &laid, &sweeps), (&compared, period.as_ref()), said, began)
    };
    let failure = period.and_then(written).err().or(failed);
    Ok(ResponsesOutcome {
        scene: file.scene,
        curves,
        levels,
        level_unit: model.unit,
        certificate,
        wall_time: began.elapsed(),
        is_cut_off: not_begun.is_some(),
        not_begun: not_begun.unwrap_or(0),
        failure,
    })
}

/// Follows the curves of a scene, one after the other.
struct Following<'a> {
    scene: &'a Scene,
    model: &'a Model,
    claim: &'a Claim,
    journal: Rc<RefCell<Journal>>,
    observer: &'a mut dyn Observer,
    curves: Vec<ComputedResponse>,
    stress: Option<&'a Stress>,
    /// Why stress is not known.
    failed: Option<Failure>,
}

impl Following<'_> {
    /// Follows all, detached ones behind the others; how many of the scene were not begun, where it was asked to end.
    fn all(&mut self) -> Result<Option<usize>, RunError> {
        let not_begun = self.until_asked_to_end()?;
        if not_begun.is_some() && self.curves.iter().all(|computed| computed.motions.is_none()) {
            return Err(RunError::Ended);
        }
        // The table of an earlier run is kept until this one has come as far.
        if !self.is_new() {
            self.write_points()?;
        }
        Ok(not_begun)
    }

    fn until_asked_to_end(&mut self) -> Result<Option<usize>, RunError> {
        let (scene, wanted) = (self.scene, jobs(self.scene));
        let of = wanted.len();
        for (number, job) in wanted.into_iter().enumerate() {
            if self.follow(job, number + 1, of)? {
                return Ok(Some(of - number - 1));
            }
        }
        let (mut found, mut number) = (detached(scene, &self.curves), of);
        while let Some(job) = found.pop().filter(|_| number < of + MOST_DETACHED) {
            number += 1;
            if self.follow(job, number, number + found.len())? {
                return Ok(Some(0));
            }
            found = detached(scene, &self.curves);
        }
        Ok(None)
    }

    /// Follows a curve, with those that branch off, and writes the table; whether it is to end there.
    fn follow(&mut self, job: Job<'_>, number: usize, of: usize) -> Result<bool, RunError> {
        let (name, log) = (job.name(self.scene, self.model), StepLog::new(self.journal.clone()));
        self.observer.event(Event::Curve { number, of, name: &name });
        let found = follow(self.model, self.scene, job, (&name, &log), self.observer.watch());
        for (further, computed) in found.iter().enumerate() {
            self.observer.event(Event::CurveDone {
                name: &computed.branch.label,
                is_further: further > 0,
                outcome: computed.said(),
                is_complete: computed.is_complete(),
            });
        }
        let first = self.curves.len();
        self.curves.extend(found);
        let failure = self.stress(first).err();
        self.failed = self.failed.take().or(failure);
        if let Some(failure) = self.journal.borrow_mut().failure.take() {
            return Err(self.unwritable(failure));
        }
        self.claim.take_at_once()?;
        if self.is_new() {
            self.write_points()?;
        }
        Ok(self.observer.is_cancelled())
    }

    /// Says how large the stress of the curves from the one with this number on is.
    fn stress(&mut self, first: usize) -> Result<(), Failure> {
        let (Some(stress), model) = (self.stress, self.model) else { return Ok(()) };
        let of = |one: &viewed::Viewed<'_>| {
            let place = |dof| model.recorded.binary_search(&dof).ok();
            let moves =
                |point: usize, dofs: &[usize]| chosen(&one.branch().points.get(point)?.coefficients, dofs, place);
            Ok((one.number(), stress.of_points(one, model.reduction.as_ref(), moves)?))
        };
        let shown = viewed(self.scene, model, &self.curves);
        let latest = shown.iter().filter(|one| one.number() >= first);
        let found = latest.map(of).collect::<Result<Vec<_>, Failure>>()?;
        for (number, stress) in found {
            let points = &mut self.curves[number].branch.points;
            points.iter_mut().zip(stress).for_each(|(point, found)| point.stress = found);
        }
        Ok(())
    }

    /// Whether points are new, not repeated from an earlier run.
    fn is_new(&self) -> bool {
        self.journal.borrow().computing.get()
    }

    fn write_points(&self) -> Result<(), RunError> {
        let directory = &self.scene.output_directory;
        tables::write_points(directory, self.scene, self.model, &self.curves).map_err(|source| self.unwritable(source))
    }

    fn unwritable(&self, source: ReportError) -> RunError {
        RunError::Unwritable { directory: self.scene.output_directory.clone(), source, kept: true }
    }
}

/// A period of the curve that is pictured, where figures or a page show it.
fn period(
    scene: &Scene,
    model: &Model,
    curves: &[ComputedResponse],
    stress: Option<&Stress>,
) -> Result<Option<Period>, Failure> {
    let solids = stress.and_then(Stress::solids);
    let is_shown = scene.files.figures || scene.files.page;
    let shown = viewed(scene, model, curves);
    let pictured = shown.get(pictured_of(&shown)).filter(|_| is_shown);
    pictured.map_or(Ok(None), |curve| Period::of(model.reduction.as_ref(), curve, solids))
}

/// Most detached curves that are followed.
const MOST_DETACHED: usize = 20;

/// Writes what is made of whole curves.
fn files(
    scene: &Scene,
    model: &Model,
    (curves, laid, sweeps): (&[ComputedResponse], &[LaidCurve], &[Sweep]),
    (compared, period): (&[(LaidCurve, Vec<ResponseDifferenceRow>)], Option<&Period>),
    (certificate, levels): (&Certificate, &[Level]),
    began: Instant,
) -> Result<(), Failure> {
    let directory = &scene.output_directory;
    overlaid::write(directory, compared)?;
    let shown = viewed(scene, model, curves);
    let each: Vec<&dyn Curve> = shown.iter().map(|curve| curve as &dyn Curve).collect();
    curve::tables::write(directory, &each)?;
    curve::tables::write_motions(directory, &scene.files, &each)?;
    tables::write_forces(directory, curves)?;
    if let Some(period) = period {
        period.write(scene)?;
    }
    let said = (certificate, levels);
    summary::write(directory, (scene, model), (curves, sweeps), said, period, began)?;
    let pictured = pictured_of(&shown);
    let Some(curve) = each.get(pictured).filter(|_| scene.files.figures || scene.files.page) else { return Ok(()) };
    let (figures, references) =
        (figures::all(scene, model, (curves, laid), sweeps)?, histories::own_references(*curve)?);
    if scene.files.figures {
        let style = style_of(&scene.files);
        curve::figures::write_all(directory, &figures, &style)?;
        let title = match each.len() {
            1 => scene.title.clone(),
            _ => format!("{}: {}", scene.title, curve.branch().label),
        };
        curve::figures::write(directory, scene, (&each, pictured), &title)?;
        histories::write(directory, &references, &style)?;
    }
    if !scene.files.page {
        return Ok(());
    }
    let sentences = compared.iter().map(|(curve, found)| overlaid::sentence(curve, found)).collect();
    let (is_overlaid, references) = (!laid.is_empty(), references.as_slice());
    let content = page::Shown { certificate, levels, sentences, is_overlaid, figures, references, period };
    page::write(directory, (scene, model), (&shown, curves), content)
}

/// Whether a run of the responses would begin.
///
/// # Errors
/// [`RunError`] that says why it would not.
pub fn check(file: &SceneFile, observer: &mut dyn Observer) -> Result<Checked, RunError> {
    overlaid::read(file, observer)?;
    let model = Model::new(file)?;
    observer.warn(&model.warnings);
    doubts::tell(&file.scene, model.reduction.as_ref(), observer);
    Ok((model.reduction, model.state))
}
