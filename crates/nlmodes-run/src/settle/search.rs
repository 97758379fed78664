//! Following a disturbed motion until it is known what it becomes.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::response::Weights;
use nlmodes::timestep::{ForcedMotion, ForcedStructure, MAX_SHOOTING_MODES, TimestepError};
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::Structures;
use nlmodes_scene::scene::ResponseKind;
use num_complex::Complex64;

use super::lines::two_lines;
use super::near::{self, Row};
use super::{Becomes, SettleSettings, Size};
use crate::model::Model;
use crate::motion::{Motion, state_of};
use crate::verify::VerifyError;
use crate::verify::results::scene_of;

/// States of a period that are looked at.
const STATES: usize = 16;

/// States of a period by which the size of a motion is measured.
const FINE: usize = 512;

/// Parts of a period of the load from whose states, those of the harmonics, an exact motion is sought one after the
/// other: the more, the more unstable it may be.
const SHOTS: [usize; 3] = [1, 8, 32];

/// Most periods of the load in one of a motion that is looked for.
const MOST_PERIODS: usize = 16;

/// Periods after which it is looked whether the motion is periodic.
const LOOK: usize = 20;

/// Distance of states up to which an exact motion is sought next to them, up to which they are on it, and up to which
/// an exact motion is that of the point.
const SEEN: f64 = 2e-2;
const THERE: f64 = 1e-3;
const SAME: f64 = 1e-6;

/// Distance of the states from which on an exact motion is none of the point.
const FAR: f64 = 0.1;

/// Largest distance after so many periods of the load, over the least one after any number, from which a motion of
/// these is sought.
const NEARER: f64 = 3.0;

/// Distance to an unstable motion over that after so many periods up to which a motion of these is not sought: it would
/// be the unstable one.
const LEAVES: f64 = 30.0;

/// What a search for an exact motion takes in periods of following, for each of its own: no more time goes into
/// searches than into following.
const SEARCH: usize = 20;

/// By how many powers of e the slowest mode decays while a motion is followed, and the fewest and most periods of the
/// load for that.
const FOLDS: f64 = 25.0;
const PERIODS: [f64; 2] = [1500.0, 3000.0];

/// Share of the periods, the last ones, in which lines are looked for.
const LAST: usize = 2;

/// A structure under its load, and the motion of a point.
pub struct Search {
    structure: ForcedStructure,
    /// The point, and the unit of its level.
    pub at: Forced,
    pub unit: &'static str,
    /// Whether it is one of a nonlinear mode, without load.
    is_free: bool,
    /// The exact motion next to the point, if there is one.
    pub start: Option<ForcedMotion>,
    /// Its state at the beginning, as its harmonics have it.
    near: Vec<f64>,
    /// Its displacement, as its harmonics have it.
    pub before: Size,
    rows: Vec<Row>,
}

/// A point of a response: its number, the level, the frequency of the load (rad/s), and how many periods of it are one
/// of the motion.
#[derive(Debug, Clone, Copy)]
pub struct Forced {
    pub point: usize,
    pub level: f64,
    pub omega: f64,
    pub subharmonic: usize,
}

impl Search {
    /// Reads a point of a forced response.
    ///
    /// # Errors
    /// [`VerifyError`].
    pub fn read(directory: &Path, point: usize) -> Result<Self, VerifyError> {
        Self::read_if(directory, point, ResponseKind::is_forced)
    }

    /// Reads a point of a forced response, or of a nonlinear mode without damping.
    ///
    /// # Errors
    /// [`VerifyError`].
    pub fn read_any(directory: &Path, point: usize) -> Result<Self, VerifyError> {
        Self::read_if(directory, point, |kind| kind.is_forced() || kind == ResponseKind::Mode)
    }

    fn read_if(directory: &Path, point: usize, is: impl Fn(ResponseKind) -> bool) -> Result<Self, VerifyError> {
        let scene = scene_of(directory)?;
        if scene.responses.is_empty() {
            return Err(VerifyError::NoResponses);
        }
        let rows = near::rows(directory)?;
        let row = rows.get(point).cloned().ok_or_else(|| {
            let (path, points) = (directory.join("branch.csv"), rows.len());
            VerifyError::NoSuchRow { path, point, points }
        })?;
        let (row, of) = row;
        let response = of.response.checked_sub(1).and_then(|i| scene.responses.get(i));
        let Some(response) = response.filter(|response| is(response.kind)) else {
            return Err(VerifyError::NotForced { point, kind: of.kind });
        };
        // A free motion has no level.
        let level = if response.kind.is_forced() { of.level } else { Some(0.0) };
        let Some(level) = level else { return Err(VerifyError::NotForced { point, kind: of.kind }) };
        let subharmonic = if response.kind.is_forced() { response.subharmonic } else { 1 };
        let is_free = !response.kind.is_forced();
        let file = SceneFile::without_text(scene, &directory.join("summary.json").display().to_string());
        let (model, _) =
            Model::with_parts(&file, &Structures::default()).map_err(|error| VerifyError::structure(&error))?;
        let motion = Motion::read(directory, point)?;
        let at = Forced { point, level, omega: TAU * row.frequency_hz, subharmonic };
        let structure = match is_free {
            true => model.response().conservative_in_time(),
            false => model.response().in_time(at.omega),
        };
        let structure = structure.map_err(|error| VerifyError::structure(&error))?;
        Self::of(structure, &model, (at, is_free), &motion, rows)
    }

    /// Of a point with its motion among those of `rows`; finds the exact motion next to it.
    ///
    /// # Errors
    /// [`VerifyError`].
    pub fn new(model: &Model, at: Forced, motion: &Motion, rows: Vec<Row>) -> Result<Self, VerifyError> {
        let structure = model.response().in_time(at.omega).map_err(|error| VerifyError::structure(&error))?;
        Self::of(structure, model, (at, false), motion, rows)
    }

    fn of(
        mut structure: ForcedStructure,
        model: &Model,
        (at, is_free): (Forced, bool),
        motion: &Motion,
        rows: Vec<Row>,
    ) -> Result<Self, VerifyError> {
        let Forced { level, omega, subharmonic, .. } = at;
        if structure.n_modes() > MAX_SHOOTING_MODES {
            let (found, most) = (structure.n_modes(), MAX_SHOOTING_MODES);
            return Err(TimestepError::TooManyModes { found, most }.into());
        }
        let first = model.first_place();
        observe(model, &mut structure, &first, (omega, is_free))
            .map_err(|error| VerifyError::structure(error.as_ref()))?;
        let state = |share: f64| state_of(motion, model, share).map_err(|reason| VerifyError::Structure { reason });
        let near = state(0.0)?;
        let mut start = None;
        // A free motion is one of a family, which no load holds.
        for parts in SHOTS.into_iter().filter(|_| !is_free) {
            let parts = parts * subharmonic;
            let states = (0..parts).map(|k| state(k as f64 / parts as f64)).collect::<Result<Vec<_>, _>>()?;
            let found = structure.periodic_through(level, omega, subharmonic, &states);
            start = found.ok().filter(|found| structure.distance(&near, &found.state) < FAR);
            if start.is_some() {
                break;
            }
        }
        let moved: f64 = first.iter().map(|&(d, w)| w * model.moved.get(d).copied().unwrap_or(0.0)).sum();
        let values: Vec<f64> = motion.samples(&first, FINE * subharmonic).iter().map(|v| v - moved).collect();
        let before = size(&values, subharmonic);
        Ok(Self { structure, at, is_free, unit: model.unit, start, near, before, rows })
    }

    /// Whether a load drives it.
    pub fn is_forced(&self) -> bool {
        !self.is_free
    }

    /// Modes of the structure.
    pub fn n_modes(&self) -> usize {
        self.structure.n_modes()
    }

    /// Difference of the state of the point after a period of its motion to that at the beginning, over its size.
    ///
    /// # Errors
    /// [`VerifyError::Integration`].
    pub fn missing(&self) -> Result<f64, VerifyError> {
        let end = self.structure.after(self.at.level, self.at.omega, self.at.subharmonic, &self.near)?;
        Ok(self.structure.distance(&self.near, &end))
    }

    /// Distance of the first state of the point to that of the exact motion, over its size.
    pub fn off(&self) -> Option<f64> {
        Some(self.structure.distance(&self.near, &self.start.as_ref()?.state))
    }

    /// Follows the disturbed motion; what it becomes, and the periods of the load that this took.
    ///
    /// # Errors
    /// [`VerifyError::Integration`].
    pub fn follow(&self, settings: SettleSettings) -> Result<(Becomes, usize), VerifyError> {
        // Where no exact motion is near, the point itself is disturbed by what its harmonics leave out.
        let state: Vec<f64> = match &self.start {
            Some(start) => {
                let direction = self.structure.disturbance(start)?;
                start.state.iter().zip(direction).map(|(x, d)| x + settings.disturbance * d).collect()
            }
            None => self.near.clone(),
        };
        let start = self.start.iter().filter(|start| !is_stable(start));
        let mut followed = Followed {
            flashes: Vec::new(),
            values: Vec::new(),
            largest: Vec::new(),
            most: NONE,
            searched: 0,
            ahead: None,
            unstable: start.map(|start| (start.state.clone(), self.at.subharmonic)).collect(),
        };
        let (mut count, mut found) = (0_usize, None);
        let most = settings.periods.unwrap_or_else(|| self.periods(settings.disturbance));
        self.structure.flash((self.at.level, self.at.omega), &state, STATES, &mut |flash| {
            count += 1;
            followed.values.push(flash.observed.first().copied().unwrap_or(0.0));
            followed.most = flash.largest.first().copied().unwrap_or(0.0).max(followed.most);
            if !count.is_multiple_of(STATES) {
                return true;
            }
            followed.end_of_period(flash.state);
            let periods = count / STATES;
            if periods.is_multiple_of(LOOK) {
                found = self.periodic(&mut followed);
            }
            found.is_none() && periods < most
        })?;
        let periods = count / STATES;
        let becomes = match found.or_else(|| self.not_left(&followed, settings.disturbance)) {
            Some((motion, periods)) => self.verdict(&motion, periods)?,
            None => self.not_periodic(&followed),
        };
        Ok((becomes, periods))
    }

    /// A stable periodic motion on which the latest states lie.
    fn periodic(&self, followed: &mut Followed) -> Option<(ForcedMotion, usize)> {
        let states = &followed.flashes;
        let last = states.last()?;
        let is_there = |(motion, periods): &(ForcedMotion, usize)| {
            let latest = states.iter().rev().take(*periods);
            latest.into_iter().any(|state| self.structure.distance(&motion.state, state) < THERE)
        };
        if let Some((motion, periods)) = followed.ahead.as_ref().filter(|ahead| is_there(ahead)) {
            return Some(self.shortest(motion, *periods));
        }
        let before = |k: usize| states.len().checked_sub(k + 1).map(|i| &states[i]);
        let counts = (1..=MOST_PERIODS).map(|k| k * self.at.subharmonic);
        let distances = counts.filter_map(|k| Some((k, self.structure.distance(last, before(k)?))));
        let distances: Vec<(usize, f64)> = distances.collect();
        let least = distances.iter().fold(f64::INFINITY, |least, (_, distance)| least.min(*distance));
        // A motion of several periods may nearly be one of fewer.
        let near = |distance: f64| distance < THERE || distance < SEEN.min(NEARER * least);
        for (periods, distance) in distances.into_iter().filter(|(_, distance)| near(*distance)) {
            let is_known = |(state, of): &(Vec<f64>, usize)| {
                periods.is_multiple_of(*of) && self.structure.distance(state, last) < LEAVES * distance
            };
            let is_due = followed.searched <= followed.largest.len();
            if !is_due || followed.unstable.iter().any(is_known) {
                continue;
            }
            followed.searched += SEARCH * periods;
            let found = self.structure.periodic(self.at.level, self.at.omega, periods, last);
            let Ok(motion) = found else { continue };
            if !is_stable(&motion) {
                followed.unstable.push((motion.state, periods));
            } else {
                let ahead = (motion, periods);
                if is_there(&ahead) {
                    return Some(self.shortest(&ahead.0, periods));
                }
                // A motion of several periods next to it would be the same.
                followed.ahead = Some(ahead);
                return None;
            }
        }
        None
    }

    /// The motion of the point where a disturbance that grows or decays so slowly cannot have left it yet.
    fn not_left(&self, followed: &Followed, disturbance: f64) -> Option<(ForcedMotion, usize)> {
        let (start, last) = (self.start.as_ref()?, followed.flashes.last()?);
        let most = start.multipliers.first()?.norm();
        let grown = disturbance * most.powf(followed.largest.len() as f64 / self.at.subharmonic as f64);
        (grown < SEEN && self.structure.distance(&start.state, last) < SEEN)
            .then(|| (start.clone(), self.at.subharmonic))
    }

    /// A motion of several periods of the load, or the one of fewer that it repeats.
    fn shortest(&self, motion: &ForcedMotion, periods: usize) -> (ForcedMotion, usize) {
        let Forced { level, omega, subharmonic, .. } = self.at;
        let fewer = (1..periods / subharmonic).map(|k| k * subharmonic).filter(|k| periods.is_multiple_of(*k));
        let again = |count: &usize| {
            let end = self.structure.after(level, omega, *count, &motion.state);
            end.is_ok_and(|end| self.structure.distance(&end, &motion.state) < SAME)
        };
        let found = fewer
            .into_iter()
            .find(again)
            .and_then(|count| Some((self.structure.periodic(level, omega, count, &motion.state).ok()?, count)));
        found.unwrap_or_else(|| (motion.clone(), periods))
    }

    fn verdict(&self, motion: &ForcedMotion, periods: usize) -> Result<Becomes, VerifyError> {
        let largest_multiplier = motion.multipliers.first().map_or(0.0, |most| most.norm());
        let after = Self::size(motion);
        let nearest = near::nearest(&self.rows, self.at.level, self.at.omega / TAU, after.fundamental_m);
        // The point may be any of its own periods.
        let is_own = match &self.start {
            Some(start) => self.is_on(motion, start)?,
            // Without an exact motion of the point, that whose amplitude is its own among all curves.
            None => nearest.is_some_and(|points| points.contains(&self.at.point)),
        };
        let returns = periods == self.at.subharmonic && is_own;
        if returns || periods > self.at.subharmonic {
            return Ok(Becomes::Periodic { periods, returns, largest_multiplier, after });
        }
        let nearest_point = nearest.map(|[point, _]| point);
        Ok(Becomes::Other { periods, largest_multiplier, after, nearest_point })
    }

    /// Whether a motion is that of the point, at the beginning of any period of the load.
    fn is_on(&self, motion: &ForcedMotion, start: &ForcedMotion) -> Result<bool, VerifyError> {
        let mut state = start.state.clone();
        for _ in 0..self.at.subharmonic {
            if self.structure.distance(&state, &motion.state) < SAME {
                return Ok(true);
            }
            state = self.structure.after(self.at.level, self.at.omega, 1, &state)?;
        }
        Ok(false)
    }

    /// The displacement over a motion.
    pub fn size(motion: &ForcedMotion) -> Size {
        let [smallest_m, largest_m] = motion.observed_extremes(0);
        Size { largest_m, smallest_m, fundamental_m: motion.observed_harmonic(0, motion.periods).norm() }
    }

    /// Periods of the load that are followed at most: until the slowest mode has decayed, behind the growth of the
    /// disturbance.
    fn periods(&self, disturbance: f64) -> usize {
        let per_period = TAU / self.at.omega;
        let decay = self.structure.slowest_decay() * per_period;
        let most = self.start.as_ref().and_then(|start| start.multipliers.first()).map_or(1.0, |most| most.norm());
        let growth = most.ln() / self.at.subharmonic as f64;
        let slow = |rate: f64, folds: f64| if rate > 0.0 { folds / rate } else { f64::INFINITY };
        let grown = if growth > 0.0 { slow(growth, -disturbance.ln()) } else { 0.0 };
        (grown + slow(decay, FOLDS)).clamp(PERIODS[0], PERIODS[1]).ceil() as usize
    }

    fn not_periodic(&self, followed: &Followed) -> Becomes {
        let periods = followed.largest.len();
        let last = periods / LAST;
        let values = &followed.values[STATES * (periods - last)..];
        let largest = &followed.largest[periods - last..];
        let largest_m = largest.iter().sum::<f64>() / last.max(1) as f64;
        let square = largest.iter().map(|v| (v - largest_m).powi(2)).sum::<f64>() / last.max(1) as f64;
        let (spread_m, hz) = (square.sqrt(), self.at.omega / TAU);
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

fn is_stable(motion: &ForcedMotion) -> bool {
    motion.multipliers.first().is_none_or(|most| most.norm() < 1.0)
}

/// What a motion was so far.
struct Followed {
    /// States at the ends of the latest periods of the load.
    flashes: Vec<Vec<f64>>,
    /// The observed displacement, m, so many in each period.
    values: Vec<f64>,
    /// Its largest value in each period, m.
    largest: Vec<f64>,
    /// That of the present period so far.
    most: f64,
    /// Periods that searches for exact motions have taken.
    searched: usize,
    /// A stable motion next to which it came, with its periods.
    ahead: Option<(ForcedMotion, usize)>,
    /// States of unstable motions next to which it was, with their periods.
    unstable: Vec<(Vec<f64>, usize)>,
}

/// Before any value.
const NONE: f64 = f64::NEG_INFINITY;

impl Followed {
    fn end_of_period(&mut self, state: &[f64]) {
        self.largest.push(std::mem::replace(&mut self.most, NONE));
        self.flashes.push(state.to_vec());
        let kept = 2 * MOST_PERIODS * LOOK;
        if self.flashes.len() > 2 * kept {
            self.flashes.drain(..kept);
        }
    }
}

/// The size of a displacement over so many periods of the load, from values behind equal parts of these.
fn size(values: &[f64], periods: usize) -> Size {
    let all = values.len();
    let turn = |k: usize| Complex64::cis(-TAU * ((k + 1) * periods) as f64 / all as f64);
    let fundamental: Complex64 = values.iter().enumerate().map(|(k, v)| turn(k) * *v).sum();
    Size {
        largest_m: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        smallest_m: values.iter().copied().fold(f64::INFINITY, f64::min),
        fundamental_m: 2.0 * fundamental.norm() / all as f64,
    }
}

/// Observes a displacement.
fn observe(
    model: &Model,
    structure: &mut ForcedStructure,
    of: &Weights,
    (omega, is_free): (f64, bool),
) -> Result<(), crate::Failure> {
    let Some(row) = model.response().rows(std::slice::from_ref(of))?.pop() else { return Ok(()) };
    let (m, c) = (structure.n_modes(), structure.n_contacts());
    // Free motions are without the laws that dissipate.
    let laws = model.response().structure().laws().iter().map(|placed| &placed.law);
    let is_there = laws.map(|law| !is_free || !law.dissipates() || law.without_dissipation().is_some());
    let by_laws: Vec<f64> =
        row.contacts[c..].iter().zip(is_there).filter(|(_, there)| *there).map(|(by, _)| *by).collect();
    structure.push_observed(&row.modes[..m], &row.contacts[..c], &by_laws)?;
    let terms = row.loads.iter().zip(model.response().terms());
    let moved: Vec<Complex64> = terms.map(|(moved, term)| moved * omega.powi(term.omega_power)).collect();
    // A free motion has no load.
    structure.move_observed(if is_free { &[] } else { &moved })?;
    Ok(())
}
