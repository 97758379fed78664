//! The curves of a scene, one after the other.

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use nlmodes::branches::Watch;
use nlmodes::hbm::Coordinates;
use nlmodes::modal::{ModalBranch, ModalPoint, Participation};
use nlmodes::response::{
    Appropriation, EndReason, Event, FinerSettings, ResponseCurve, ResponseError, ResponseModel, ResponsePoint,
    ResponseSettings, StepLog, appropriation, branching_responses, conservative_mode, damped_mode, detached_response,
    force_response, frequency_response, lies_on, phase_resonance, response_from_other_end,
};
use nlmodes_scene::number;
use nlmodes_scene::scene::{AtBranchPoint, Response, ResponseKind, Scene, StabilityChoice, Switching};

use super::convert::Converter;
use super::gradients::gradients;
use crate::chain;
use crate::model::Model;

/// A curve that was computed.
#[derive(Debug)]
pub struct ComputedResponse {
    /// Number of the response in the scene, from 0.
    pub response: usize,
    /// What was followed.
    pub kind: ResponseKind,
    /// The level, in the unit of the load; the largest one of a curve over the level, none of modes.
    pub level: Option<f64>,
    /// Whether it is a response that no curve from the ends of the window reaches.
    pub is_detached: bool,
    /// The curve with its name and its end; without points where there is none.
    pub branch: ModalBranch,
    /// Participation of the lowest linear modes at each point.
    pub participation: Vec<Participation>,
    /// Of a curve of phase resonances: each one at the levels that were asked for, in the order of the curve.
    pub at_levels: Vec<ModalPoint>,
    /// Points of it solved again with twice as many harmonics: their numbers, and what they became.
    pub finer: Vec<(usize, Option<ModalPoint>)>,
    /// The motions of its points, if there is a curve.
    pub motions: Option<ResponseCurve>,
    /// Of appropriation: the forces at each point of the mode, and what they do.
    pub appropriations: Vec<Appropriation>,
    /// What it took.
    pub wall_time: Duration,
}

impl ComputedResponse {
    /// Whether it is there and ended where it was meant to.
    pub fn is_complete(&self) -> bool {
        self.branch.end.complete
    }

    /// What is reported of it.
    pub fn said(&self) -> Result<(usize, &str), &str> {
        let message = self.branch.end.message.as_str();
        if self.motions.is_some() { Ok((self.branch.points.len(), message)) } else { Err(message) }
    }
}

/// A curve to compute.
#[derive(Debug, Clone)]
pub struct Job<'a> {
    response: usize,
    wanted: &'a Response,
    level: Option<f64>,
    /// A point of a detached curve.
    from: Option<ResponsePoint>,
}

/// The curves of a scene: one for each level of responses over the frequency.
pub fn jobs(scene: &Scene) -> Vec<Job<'_>> {
    let mut all = Vec::new();
    for (response, wanted) in scene.responses.iter().enumerate() {
        let largest = wanted.levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let levels: Vec<Option<f64>> = match wanted.kind {
            ResponseKind::Frequency => wanted.levels.iter().copied().map(Some).collect(),
            kind if kind.is_forced() => vec![Some(largest)],
            _ => vec![None],
        };
        all.extend(levels.into_iter().map(|level| Job { response, wanted, level, from: None }));
    }
    all
}

/// Phase resonances at the level of a response over the frequency that lie on none of its curves: each begins a
/// detached one.
pub fn detached<'a>(scene: &'a Scene, curves: &[ComputedResponse]) -> Vec<Job<'a>> {
    let mut found = Vec::new();
    for (response, wanted) in scene.responses.iter().enumerate().filter(|(_, r)| r.kind == ResponseKind::Frequency) {
        for &level in &wanted.levels {
            let own: Vec<&ResponseCurve> = curves
                .iter()
                .filter(|c| c.response == response && c.level == Some(level))
                .filter_map(|c| c.motions.as_ref())
                .collect();
            // Where the curve from the end of the window was lost, what lies beyond is no island.
            if own.is_empty() || own.iter().any(|curve| !curve.end.complete) {
                continue;
            }
            let resonances = curves.iter().filter(|c| c.kind == ResponseKind::PhaseResonance).filter(|c| {
                let other = &scene.responses[c.response];
                other.subharmonic == wanted.subharmonic && other.drive == wanted.drive
            });
            let resonances = resonances.filter_map(|c| c.motions.as_ref()).flat_map(|curve| &curve.at_levels);
            let window = [wanted.frequency_hz[0], wanted.frequency_hz[1]].map(|hz| TAU * hz);
            let island = resonances
                .filter(|point| (point.level / level - 1.0).abs() < 1e-9)
                .filter(|point| (window[0]..=window[1]).contains(&point.omega))
                .find(|point| !own.iter().any(|curve| lies_on(point, curve)));
            found.extend(island.map(|point| Job { response, wanted, level: Some(level), from: Some(point.clone()) }));
        }
    }
    found
}

impl Job<'_> {
    /// Number of its response in the scene, from 0.
    pub fn response(&self) -> usize {
        self.response
    }

    /// Its name in legends.
    pub fn name(&self, scene: &Scene, model: &Model) -> String {
        let unit = model.unit;
        let of_kind = scene.responses.iter().filter(|r| r.kind == self.wanted.kind).count();
        let name = match (self.wanted.kind, self.level) {
            (ResponseKind::Frequency, Some(level)) => format!("{} {unit}", number(level)),
            (ResponseKind::Force, _) => {
                format!("{} Hz", number(self.wanted.frequency_hz.first().copied().unwrap_or(0.0)))
            }
            (ResponseKind::PhaseResonance, _) if self.wanted.lag_deg == 90.0 => "phase resonance".to_owned(),
            (ResponseKind::PhaseResonance, _) => format!("lag {}°", number(self.wanted.lag_deg)),
            (ResponseKind::DampedMode, _) => "damped mode".to_owned(),
            (ResponseKind::Appropriation, _) => {
                format!("appropriation, {} harmonics", self.wanted.controlled_harmonics)
            }
            _ => "nonlinear mode".to_owned(),
        };
        let name = if self.from.is_some() { format!("{name}, detached") } else { name };
        let name = if self.wanted.subharmonic > 1 { format!("{name}, 1/{}", self.wanted.subharmonic) } else { name };
        let is_named = matches!(self.wanted.kind, ResponseKind::Frequency | ResponseKind::Force);
        if of_kind > 1 && !is_named { format!("{name} ({})", self.response + 1) } else { name }
    }
}

/// Computes a curve, and those that branch off where motions have several periods of the load; its steps go to the log.
pub fn follow(
    model: &Model,
    scene: &Scene,
    job: Job<'_>,
    (name, log): (&str, &StepLog),
    watch: Watch,
) -> Vec<ComputedResponse> {
    let began = Instant::now();
    let settings = ResponseSettings { watch, log: log.clone(), ..settings(model, scene, &job) };
    let computed = |(branch, participation, at_levels, finer), motions, appropriations| ComputedResponse {
        response: job.response,
        kind: job.wanted.kind,
        level: job.level,
        is_detached: job.from.is_some(),
        branch,
        participation,
        at_levels,
        finer,
        motions,
        appropriations,
        wall_time: began.elapsed(),
    };
    let followed = model.with_drive(job.response).and_then(|system| {
        let held = job.level.filter(|_| job.wanted.kind == ResponseKind::Frequency);
        let gradients = gradients(model, (scene, job.response, held), &settings, &system)?;
        let settings = settings.with_gradients(gradients);
        let (curves, accuracy) = accurate(&system, scene, &job, &settings)?;
        let converter = Converter::new(model, &system, job.wanted.kind, job.wanted.subharmonic)?;
        let mut all = Vec::new();
        for Followed { curve, further, is_cut } in curves {
            let forces = if job.wanted.kind == ResponseKind::Appropriation {
                appropriations(model, &system, &curve, job.wanted.controlled_harmonics, &settings)?
            } else {
                Vec::new()
            };
            let cut = match is_cut {
                true => "; with it there are continuation.max_branches curves, and no more are followed",
                false => "",
            };
            let mut end = curve.end.clone();
            end.message += &format!("{accuracy}{cut}{}{}", not_held(&forces), not_followed(&curve, &job, scene));
            let name = further.map_or_else(|| name.to_owned(), |further| format!("{name}, {further}"));
            let branch = converter.branch(name, &curve.points, &forces, end)?;
            let at_levels =
                curve.at_levels.iter().map(|point| converter.point(point, None)).collect::<Result<_, _>>()?;
            let finer = curve.finer.iter().map(|finer| {
                let found = finer.found.as_deref().map(|found| converter.point(found, None)).transpose()?;
                Ok((finer.point, found))
            });
            let finer = finer.collect::<Result<Vec<_>, ResponseError>>()?;
            let motions = branch.points.iter().zip(&curve.points);
            let participation =
                motions.map(|(point, own)| converter.participation(point, &own.motion)).collect::<Result<_, _>>()?;
            all.push(computed((branch, participation, at_levels, finer), Some(curve), forces));
        }
        Ok(all)
    });
    followed.unwrap_or_else(|error| {
        let none = (model.no_branch(name, chain(&error)), Vec::new(), Vec::new(), Vec::new());
        vec![computed(none, None, Vec::new())]
    })
}

/// What is to be reported of forces that were computed and do not hold the mode.
fn not_held(forces: &[Appropriation]) -> String {
    let count = |is: &dyn Fn(&Appropriation) -> bool| forces.iter().filter(|found| is(found)).count();
    let lost = count(&|found| found.motion.is_none());
    let unstable = count(&|found| found.stability.is_some_and(|s| s.stable == Some(false)));
    let mut said = String::new();
    if lost > 0 {
        said += &format!(
            "; of {lost} of its points no motion next to the mode was found under the forces, and the columns are \
            empty there"
        );
    }
    if unstable > 0 {
        said += &format!(
            "; under the forces of {unstable} of its points the motion is unstable at a frequency that is held"
        );
    }
    said
}

/// The forces that hold each point of a mode.
fn appropriations(
    model: &Model,
    system: &ResponseModel,
    curve: &ResponseCurve,
    controlled: usize,
    settings: &ResponseSettings,
) -> Result<Vec<Appropriation>, ResponseError> {
    let one = |point: &ResponsePoint| appropriation(system, point, &model.force_places, controlled, settings);
    curve.points.iter().take_while(|_| !settings.watch.asks_to_end()).map(one).collect()
}

/// Doublings of the number of harmonics that may leave what they change as large as it was, before no more are tried:
/// next to a rigid stop motions with few and with many harmonics may have nothing in common.
const IN_VAIN: usize = 3;

/// Share of the change before above which that of twice as many harmonics is as large as it was.
const AS_LARGE: f64 = 0.7;

/// The curves of a job; with an accuracy, of twice as many harmonics as long as these change more than that, and with
/// what to say of it.
fn accurate(
    system: &ResponseModel,
    scene: &Scene,
    job: &Job<'_>,
    settings: &ResponseSettings,
) -> Result<(Vec<Followed>, String), ResponseError> {
    let mut own = settings.clone();
    let (mut before, mut in_vain) = (f64::INFINITY, 0);
    loop {
        let found = curve(system, scene, job, &own)?;
        let Some(accuracy) = scene.method.accuracy else { return Ok((found, String::new())) };
        let change = found.iter().filter_map(|followed| followed.curve.truncation()).fold(0.0, f64::max);
        let more = (2 * own.harmonics).min(accuracy.max_harmonics);
        let is_reached = change <= accuracy.error;
        in_vain += usize::from(change.is_infinite() || change > AS_LARGE * before);
        before = change;
        if is_reached || more == own.harmonics || in_vain == IN_VAIN || own.watch.asks_to_end() {
            let said = match is_reached {
                true => format!("; {} harmonics reach the accuracy", own.harmonics),
                false if change.is_finite() => {
                    format!(
                        "; the accuracy is not reached: twice {} harmonics change it by {change:.1e}",
                        own.harmonics
                    )
                }
                false => format!(
                    "; the accuracy is not reached: next to motions with {} harmonics there are none with twice as \
                     many, as before stops that are rigid; stiffness_n_m of a [[contact]] makes a stop elastic",
                    own.harmonics
                ),
            };
            return Ok((found, said));
        }
        own.harmonics = more;
    }
}

fn curve(
    system: &ResponseModel,
    scene: &Scene,
    job: &Job<'_>,
    settings: &ResponseSettings,
) -> Result<Vec<Followed>, ResponseError> {
    let level = job.level.unwrap_or(0.0);
    let energy = scene.max_energy_ratio(!job.wanted.frequency_hz.is_empty());
    let curve = match job.wanted.kind {
        ResponseKind::DampedMode => damped_mode(system, energy, settings),
        ResponseKind::Mode | ResponseKind::Appropriation => conservative_mode(system, energy, settings),
        ResponseKind::PhaseResonance => phase_resonance(system, level, settings),
        ResponseKind::Force => {
            force_response(system, TAU * job.wanted.frequency_hz.first().copied().unwrap_or(0.0), level, settings)
        }
        ResponseKind::Frequency => match &job.from {
            Some(point) => detached_response(system, point, settings),
            None => return over_frequency(system, scene, job, settings),
        },
    };
    Ok(vec![Followed { curve: curve?, further: None, is_cut: false }])
}

/// A curve, and what its name says more where it follows the one that was asked for.
struct Followed {
    curve: ResponseCurve,
    further: Option<String>,
    /// Whether there are as many curves with it as may be: other half-branches may be left.
    is_cut: bool,
}

/// What the name of a curve from the upper end of the window says more.
const UPPER: &str = "from the upper end";

/// A response over the frequency; the curves that branch off where they are wanted, and the one from the other end of
/// the window where that is another.
fn over_frequency(
    system: &ResponseModel,
    scene: &Scene,
    job: &Job<'_>,
    settings: &ResponseSettings,
) -> Result<Vec<Followed>, ResponseError> {
    let level = job.level.unwrap_or(0.0);
    let branches = settings.subharmonic > 1 || scene.continuation.at_branch_point == AtBranchPoint::All;
    let from_lower_end = match branches {
        true => branching_responses(system, level, settings),
        false => frequency_response(system, level, settings).map(|curve| vec![curve]),
    };
    let mut curves = match from_lower_end {
        // Where no motion is found at the lower end, the upper one may have one.
        Err(error @ (ResponseError::NoStart { .. } | ResponseError::NoStartTouching { .. }))
            if settings.subharmonic == 1 && !settings.watch.asks_to_end() =>
        {
            let curve = response_from_other_end(system, level, settings, &[])?.ok_or(error)?;
            return Ok(vec![Followed { curve, further: Some(UPPER.to_owned()), is_cut: false }]);
        }
        curves => curves?,
    };
    let goes_on = curves.first().is_some_and(|curve| !curve.end.has(EndReason::Stopped));
    let other = match goes_on && settings.subharmonic == 1 {
        true => response_from_other_end(system, level, settings, &curves)?,
        false => None,
    };
    let known = curves.len();
    let is_cut = |k: usize| k == 0 && branches && known == settings.max_branches;
    curves.extend(other);
    let further = |k: usize| match k {
        0 => None,
        _ if k < known => Some(format!("branch {k}")),
        _ => Some(UPPER.to_owned()),
    };
    let followed = |(k, curve)| Followed { curve, further: further(k), is_cut: is_cut(k) };
    Ok(curves.into_iter().enumerate().map(followed).collect())
}

/// The curves of a response (number in the scene) over the frequency at one of its levels, without stability, and the
/// settings with which they are computed.
///
/// # Errors
/// [`ResponseError`] where there is none.
pub fn curves_at(
    model: &Model,
    scene: &Scene,
    (response, level): (usize, f64),
    watch: Watch,
) -> Result<(ResponseSettings, Vec<ResponseCurve>), ResponseError> {
    let own = jobs(scene).into_iter().find(|job| job.response == response && job.level == Some(level));
    let job = own.ok_or(ResponseError::Setting { what: "the level", value: level, expected: "one of the scene" })?;
    let settings = ResponseSettings { watch, stability: false, finer: None, ..settings(model, scene, &job) };
    let found = over_frequency(&model.with_drive(response)?, scene, &job, &settings)?;
    Ok((settings, found.into_iter().map(|followed| followed.curve).collect()))
}

/// The curve of phase resonances of a response (number in the scene) up to a level, and the settings with which it is
/// computed.
///
/// # Errors
/// [`ResponseError`] where there is none.
pub fn resonances_to(
    model: &Model,
    scene: &Scene,
    (response, level): (usize, f64),
    watch: Watch,
) -> Result<(ResponseSettings, ResponseCurve), ResponseError> {
    let job = jobs(scene).into_iter().find(|job| job.response == response);
    let job = job.ok_or(ResponseError::Setting { what: "the level", value: level, expected: "one of the scene" })?;
    let settings = ResponseSettings { watch, stability: false, finer: None, ..settings(model, scene, &job) };
    let curve = phase_resonance(&model.with_drive(response)?, level, &settings)?;
    Ok((settings, curve))
}

/// What is to be reported of a curve beside its end: branch points whose other half-branches are not there.
fn not_followed(curve: &ResponseCurve, job: &Job<'_>, scene: &Scene) -> String {
    let n = curve.points.iter().filter(|point| point.events.contains(&Event::BranchPoint)).count();
    let is_tree = job.wanted.kind == ResponseKind::Frequency && job.from.is_none();
    let all = scene.continuation.at_branch_point == AtBranchPoint::All;
    if n == 0 || (all && is_tree) {
        return String::new();
    }
    let points = if n == 1 { "a branch point".to_owned() } else { format!("{n} branch points") };
    let follows = match is_tree {
        true => "continuation.at_branch_point = \"all\" follows them",
        false => "they are not followed",
    };
    format!("; at {points} other motions begin: {follows}")
}

/// Window about the mode where the scene has none.
const WINDOW: [f64; 2] = [0.5, 2.5];

fn settings(model: &Model, scene: &Scene, job: &Job<'_>) -> ResponseSettings {
    let (method, response) = (&scene.method, job.wanted);
    let mode = model.mode_frequency(method.mode).unwrap_or(1.0);
    let window = match (response.frequency_hz.as_slice(), scene.continuation.frequency_hz) {
        (&[low, high], _) => [TAU * low, TAU * high],
        (_, Some(window)) if !response.kind.is_forced() => window.map(|hz| TAU * hz),
        _ => WINDOW.map(|share| share * mode),
    };
    let over_frequency = scene.responses.iter().filter(|r| r.kind == ResponseKind::Frequency);
    let mut levels: Vec<f64> = over_frequency.flat_map(|r| &r.levels).chain(&response.levels).copied().collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let settings = ResponseSettings::new(window);
    ResponseSettings {
        harmonics: method.harmonics,
        switching: match method.switching {
            Switching::Exact => nlmodes::hbm::Switching::Exact,
            Switching::Sampled => nlmodes::hbm::Switching::Sampled { samples: method.samples },
        },
        coordinates: Coordinates::Automatic,
        contact_solver: method.contact_solver.name().to_owned(),
        mode: method.mode,
        lag: response.lag_deg.to_radians(),
        subharmonic: response.subharmonic,
        stability: scene.stability != StabilityChoice::Never,
        stability_budget_s: scene.stability_budget_s,
        exact_motions: match scene.stability {
            StabilityChoice::Always => usize::MAX,
            _ => settings.exact_motions,
        },
        finer: Some(FinerSettings::default()),
        max_points: scene.continuation.max_points,
        max_branches: scene.continuation.max_branches,
        levels,
        ..settings
    }
}
