//! Following a disturbed motion until it is known what it becomes.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::timestep::{ForcedMotion, ForcedStructure, MAX_SHOOTING_MODES, TimestepError};
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::Structures;
use num_complex::Complex64;

use super::lines::two_lines;
use super::near::{self, Row};
use super::{Becomes, SettleError, SettleSettings, Size};
use crate::chain;
use crate::motion::{Motion, scene_of, state_of};
use crate::responses::{Model, structure};

/// States of a period that are looked at.
const STATES: usize = 16;

/// States of a period by which the size of a motion is measured.
const FINE: usize = 128;

/// Most periods of the load in one of a motion that is looked for.
const MOST_PERIODS: usize = 16;

/// Periods after which it is looked whether the motion is periodic.
const LOOK: usize = 20;

/// Distance of states up to which an exact motion is sought next to them, up to which they are on it, and up to which
/// an exact motion is that of the point.
const SEEN: f64 = 2e-2;
const THERE: f64 = 1e-3;
const SAME: f64 = 1e-6;

/// Share of the periods, the last ones, in which lines are looked for.
const LAST: usize = 2;

/// A structure under its load, and the exact motion of a point.
pub struct Search {
    structure: ForcedStructure,
    /// Level of the load and its unit, and its angular frequency, rad/s.
    pub level: f64,
    pub unit: &'static str,
    pub omega: f64,
    /// Periods of the load in one of the motion.
    subharmonic: usize,
    /// The exact motion of the point.
    pub start: ForcedMotion,
    /// Distance of the first state of the point to it, over its size.
    pub off: f64,
    rows: Vec<Row>,
}

impl Search {
    /// Reads a point, and finds the exact motion next to it.
    ///
    /// # Errors
    /// [`SettleError`].
    pub fn read(directory: &Path, point: usize) -> Result<Self, SettleError> {
        let scene = scene_of(directory)?;
        if scene.responses.is_empty() {
            return Err(SettleError::NoResponses);
        }
        if scene.has_laws() {
            return Err(SettleError::Laws);
        }
        let rows = near::rows(directory)?;
        let row = rows.get(point).cloned().ok_or_else(|| {
            let (path, points) = (directory.join("branch.csv"), rows.len());
            SettleError::NoSuchPoint { path, point, points }
        })?;
        let response = row.response.checked_sub(1).and_then(|i| scene.responses.get(i));
        let (Some(level), Some(response)) = (row.level, response.filter(|response| response.kind.is_forced())) else {
            return Err(SettleError::NotForced { point, kind: row.kind });
        };
        let subharmonic = response.subharmonic;
        let file = SceneFile::without_text(scene, &directory.join("summary.json").display().to_string());
        let failed = |error: &(dyn std::error::Error + 'static)| SettleError::Structure { reason: chain(error) };
        let (model, _) = Model::with_parts(&file, &Structures::default()).map_err(|error| failed(&error))?;
        let mut structure = structure(&file, &model).map_err(|error| failed(&error))?;
        if structure.n_modes() > MAX_SHOOTING_MODES {
            let (found, most) = (structure.n_modes(), MAX_SHOOTING_MODES);
            return Err(TimestepError::TooManyModes { found, most }.into());
        }
        let omega = TAU * row.frequency_hz;
        let m = structure.n_modes();
        for term in model.response().terms() {
            let by = omega.powi(term.omega_power);
            let scaled = |of: &[Complex64]| of.iter().map(|v| v * by).collect::<Vec<_>>();
            structure.push_load(term.harmonic, &scaled(&term.modal[..m]), &scaled(&term.gaps))?;
        }
        observe_first(&model, &mut structure).map_err(|error| failed(error.as_ref()))?;
        let motion = Motion::read(directory, point)?;
        let near = state_of(&motion, &model).map_err(|reason| SettleError::Structure { reason })?;
        let start = structure.periodic(level, omega, subharmonic, &near);
        let start = start.map_err(|error| SettleError::NoMotion { point, reason: chain(&error) })?;
        let off = structure.distance(&near, &start.state);
        Ok(Self { structure, level, unit: model.unit, omega, subharmonic, start, off, rows })
    }

    /// Follows the disturbed motion; what it becomes, and the periods of the load that this took.
    ///
    /// # Errors
    /// [`SettleError::Integration`].
    pub fn follow(&self, settings: SettleSettings) -> Result<(Becomes, usize), SettleError> {
        let direction = self.structure.disturbance(&self.start)?;
        let state: Vec<f64> =
            self.start.state.iter().zip(direction).map(|(x, d)| x + settings.disturbance * d).collect();
        let mut followed =
            Followed { flashes: Vec::new(), values: Vec::new(), largest: Vec::new(), tried: f64::INFINITY };
        let (mut count, mut found) = (0_usize, None);
        self.structure.flash((self.level, self.omega), &state, STATES, &mut |x, observed| {
            count += 1;
            followed.values.push(observed.first().copied().unwrap_or(0.0));
            if !count.is_multiple_of(STATES) {
                return true;
            }
            followed.end_of_period(x);
            let periods = count / STATES;
            if periods.is_multiple_of(LOOK) {
                found = self.periodic(&mut followed);
            }
            found.is_none() && periods < settings.periods
        })?;
        let periods = count / STATES;
        let becomes = match found {
            Some((motion, periods)) => self.verdict(&motion, periods)?,
            None => self.not_periodic(&followed),
        };
        Ok((becomes, periods))
    }

    /// A stable periodic motion on which the latest states lie.
    fn periodic(&self, followed: &mut Followed) -> Option<(ForcedMotion, usize)> {
        let states = &followed.flashes;
        let last = states.last()?;
        let before = |k: usize| states.len().checked_sub(k + 1).map(|i| &states[i]);
        for periods in (1..=MOST_PERIODS).map(|k| k * self.subharmonic) {
            let distance = self.structure.distance(last, before(periods)?);
            if distance > SEEN {
                continue;
            }
            // Newton's method is worth its time as the motion comes nearer.
            if distance > THERE && distance > 0.3 * followed.tried {
                return None;
            }
            followed.tried = distance;
            let motion = self.structure.periodic(self.level, self.omega, periods, last).ok()?;
            let is_stable = motion.multipliers.first().is_none_or(|most| most.norm() < 1.0);
            let is_there = self.structure.distance(&motion.state, last) < THERE;
            return (is_stable && is_there).then_some((motion, periods));
        }
        None
    }

    fn verdict(&self, motion: &ForcedMotion, periods: usize) -> Result<Becomes, SettleError> {
        let largest_multiplier = motion.multipliers.first().map_or(0.0, |most| most.norm());
        let after = self.size(motion)?;
        // The point may be any of its own periods.
        let returns = periods == self.subharmonic && self.is_start(motion)?;
        if returns || periods > self.subharmonic {
            return Ok(Becomes::Periodic { periods, returns, largest_multiplier, after });
        }
        let hz = self.omega / TAU;
        let nearest_point = near::nearest(&self.rows, self.level, hz, after.fundamental_m);
        Ok(Becomes::Other { periods, largest_multiplier, after, nearest_point })
    }

    /// Whether a motion is that of the point, at the beginning of any period of the load.
    fn is_start(&self, motion: &ForcedMotion) -> Result<bool, SettleError> {
        let mut state = self.start.state.clone();
        for _ in 0..self.subharmonic {
            if self.structure.distance(&state, &motion.state) < SAME {
                return Ok(true);
            }
            state = self.structure.after(self.level, self.omega, 1, &state)?;
        }
        Ok(false)
    }

    /// The displacement over a motion.
    ///
    /// # Errors
    /// [`SettleError::Integration`].
    pub fn size(&self, motion: &ForcedMotion) -> Result<Size, SettleError> {
        let all = FINE * motion.periods;
        let mut values = Vec::with_capacity(all);
        self.structure.flash((self.level, self.omega), &motion.state, FINE, &mut |_, observed| {
            values.push(observed.first().copied().unwrap_or(0.0));
            values.len() < all
        })?;
        let turn = |k: usize| Complex64::cis(-TAU * (k + 1) as f64 / FINE as f64);
        let fundamental: Complex64 = values.iter().enumerate().map(|(k, v)| turn(k) * *v).sum();
        Ok(Size {
            largest_m: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            smallest_m: values.iter().copied().fold(f64::INFINITY, f64::min),
            fundamental_m: 2.0 * fundamental.norm() / all as f64,
        })
    }

    fn not_periodic(&self, followed: &Followed) -> Becomes {
        let periods = followed.largest.len();
        let last = periods / LAST;
        let values = &followed.values[STATES * (periods - last)..];
        let largest = &followed.largest[periods - last..];
        let largest_m = largest.iter().sum::<f64>() / last.max(1) as f64;
        let square = largest.iter().map(|v| (v - largest_m).powi(2)).sum::<f64>() / last.max(1) as f64;
        let (spread_m, hz) = (square.sqrt(), self.omega / TAU);
        match two_lines(values, STATES) {
            Some(lines) => Becomes::TwoLines {
                frequencies_hz: [hz, lines.second * hz],
                beat_hz: lines.beat * hz,
                largest_m,
                spread_m,
            },
            None => {
                let most_m = largest.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                Becomes::Irregular { largest_m, spread_m, most_m }
            }
        }
    }
}

/// What a motion was so far.
struct Followed {
    /// States at the ends of the latest periods of the load.
    flashes: Vec<Vec<f64>>,
    /// The observed displacement, m, so many in each period.
    values: Vec<f64>,
    /// Its largest value in each period, m.
    largest: Vec<f64>,
    /// Distance at which an exact motion was sought last.
    tried: f64,
}

impl Followed {
    fn end_of_period(&mut self, state: &[f64]) {
        let most = self.values[self.values.len() - STATES..].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        self.largest.push(most);
        self.flashes.push(state.to_vec());
        let kept = 2 * MOST_PERIODS * LOOK;
        if self.flashes.len() > 2 * kept {
            self.flashes.drain(..kept);
        }
    }
}

/// Observes the first contact toward its stop.
fn observe_first(model: &Model, structure: &mut ForcedStructure) -> Result<(), crate::Failure> {
    let first = model.contacts.first().or(model.force_places.first()).cloned().unwrap_or_default();
    let Some(row) = model.response().rows(std::slice::from_ref(&first))?.pop() else { return Ok(()) };
    let (m, c) = (structure.n_modes(), structure.n_contacts());
    structure.push_observed(&row.modes[..m], &row.contacts[..c], &[])?;
    Ok(())
}
