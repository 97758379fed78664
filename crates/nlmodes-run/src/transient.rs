//! A motion in time under any loads: integrated exactly between contact instants, and its files.

mod histories;
mod noise;
mod prepared;
mod spectrum;
mod start;
mod written;

use std::time::{Duration, Instant};

use nlmodes::timestep::{Signal, TimestepError, Touch, TransientSettings};
use nlmodes_scene::assemble::Structures;
use nlmodes_scene::scene::{Scene, Transient};
use nlmodes_scene::{SceneFile, number};

use crate::claim::Claim;
use crate::model::Model;
use crate::settings::Checked;
use crate::updating::updated;
use crate::{Failure, Observer, Over, RunError, chain, doubts, links, refusal};
use histories::Histories;
use prepared::Prepared;

/// Samples in a period of the highest frequency where the scene does not say how many.
const PER_PERIOD: f64 = 64.0;

/// Most samples of a history, and numbers of all histories.
const MOST_SAMPLES: f64 = 2e7;
const MOST_NUMBERS: f64 = 1e8;

/// What came out of a motion in time.
#[derive(Debug)]
pub struct TransientOutcome {
    /// The scene, with parameters that were updated.
    pub scene: Scene,
    /// What is to be reported, line by line.
    pub lines: Vec<String>,
    /// Why the motion ends before its time, if it does.
    pub ended: Option<String>,
    /// Time of the integration, and of all.
    pub integration: Duration,
    /// From the beginning to the last file.
    pub wall_time: Duration,
    /// Why some files are not there.
    pub failure: Option<Failure>,
}

impl TransientOutcome {
    /// Whether the motion came to its end, and all files are there.
    pub fn is_complete(&self) -> bool {
        self.ended.is_none() && self.failure.is_none()
    }
}

/// Computes the motion in time of a scene and writes its histories, touches, figures and page.
///
/// # Errors
/// [`RunError`] if the scene cannot be computed or nothing can be written.
pub fn run(file: &SceneFile, over: Over, observer: &mut dyn Observer) -> Result<TransientOutcome, RunError> {
    links::refuse(&file.scene.output_directory)?;
    let claim = Claim::of_scenes(std::slice::from_ref(file), over, observer)?;
    let began = Instant::now();
    let file = updated(file.clone())?;
    let begun = begin(&file)?;
    doubts::tell(&file.scene, begun.model.reduction.as_ref(), observer);
    observer.warn(&begun.model.warnings);
    claim.take_at_once()?;
    let integrated = Instant::now();
    let (histories, ended) = move_on(&begun, observer).map_err(|error| refusal::here(&file, "transient", &error))?;
    let integration = integrated.elapsed();
    let lines = written::lines(&begun, &histories);
    let failure = written::write(&begun, &histories, ended.as_deref(), [integration, began.elapsed()]).err();
    Ok(TransientOutcome { scene: file.scene.clone(), lines, ended, integration, wall_time: began.elapsed(), failure })
}

/// Whether a motion in time would begin.
///
/// # Errors
/// [`RunError`] that says why it would not.
pub fn check(file: &SceneFile, observer: &mut dyn Observer) -> Result<Checked, RunError> {
    let Begun { model, .. } = begin(file)?;
    doubts::tell(&file.scene, model.reduction.as_ref(), observer);
    Ok((model.reduction, model.state))
}

/// What a motion begins with.
struct Begun<'a> {
    scene: &'a Scene,
    transient: Transient,
    model: Model,
    prepared: Prepared,
    state: Vec<f64>,
    rate: f64,
}

fn begin(file: &SceneFile) -> Result<Begun<'_>, RunError> {
    let transient = file.scene.transient.clone().ok_or(RunError::NoScene)?;
    let (model, parts) = Model::with_parts(file, &Structures::default())?;
    let prepared = Prepared::new(file, &transient, &model, &parts)?;
    let state = start::state(file, &transient.from, &model)?;
    let rate = rate(&transient, &model, &prepared);
    let samples = rate * transient.duration;
    if samples > MOST_SAMPLES {
        let title = format!("{} samples of each history", number(samples.ceil()));
        let expected = format!("expected at most {} in all: a lower rate, or a shorter motion", number(MOST_SAMPLES));
        return Err(file.error_at("transient.sample_rate_hz", &title, &expected, &[]).into());
    }
    let numbers = samples * (2 * prepared.observed.len() + model.contacts.len()) as f64;
    if numbers > MOST_NUMBERS {
        let title = format!("{} numbers in the histories of all places and contacts", number(numbers.ceil()));
        let expected = format!("expected at most {}: a lower rate, or a shorter motion", number(MOST_NUMBERS));
        return Err(file.error_at("transient.sample_rate_hz", &title, &expected, &[]).into());
    }
    Ok(Begun { scene: &file.scene, transient, model, prepared, state, rate })
}

/// Samples a second: as the scene says, or enough for the highest frequency of the loads and the lowest mode, and not
/// fewer than a table has.
fn rate(transient: &Transient, model: &Model, prepared: &Prepared) -> f64 {
    let lowest = model.open_modes().omega_squared().iter().find(|w| **w > 0.0);
    let lowest = lowest.map_or(0.0, |w| w.sqrt() / std::f64::consts::TAU);
    let own = (PER_PERIOD * prepared.highest_hz.max(lowest)).max(prepared.table_hz);
    transient.sample_rate.unwrap_or(own.max(2.0 / transient.duration))
}

/// The histories of the motion, and why it ends before its time, if it does.
fn move_on(
    Begun { transient, prepared, state, rate, .. }: &Begun<'_>,
    observer: &dyn Observer,
) -> Result<(Histories, Option<String>), TimestepError> {
    let moved: Vec<f64> = prepared.observed.iter().map(|of| of.moved).collect();
    let contacts = prepared.structure.n_contacts() + prepared.structure.n_law_stops();
    let mut histories = Histories::new(&moved, contacts, transient.duration, *rate);
    let mut touches: Vec<Touch> = Vec::new();
    let signals: Vec<&dyn Signal> = prepared.signals.iter().map(AsRef::as_ref).collect();
    let settings = TransientSettings { duration: transient.duration, signals: &signals, blows: &prepared.blows };
    let (mut count, mut until) = (0_u32, 0.0);
    let found = prepared.structure.transient(
        state,
        &settings,
        &mut |stretch, switched| {
            histories.take(stretch, switched, &moved);
            until = stretch.from() + stretch.length();
            count = count.wrapping_add(1);
            !count.is_multiple_of(ASKED) || !observer.is_cancelled()
        },
        &mut |touch| touches.push(touch),
    );
    histories.touches = touches;
    match found {
        Ok(_) => Ok((histories, None)),
        Err(error) if histories.len() < 2 => Err(error),
        Err(TimestepError::Ended) => Ok((histories, Some(format!("it was ended at {until:.6} s")))),
        Err(error) => Ok((histories, Some(format!("it ends at {until:.6} s: {}", chain(&error))))),
    }
}

/// Intervals after which the observer is asked whether to go on.
const ASKED: u32 = 4096;
