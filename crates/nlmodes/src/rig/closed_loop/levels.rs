use std::ops::ControlFlow;

use nlmodes_experiment::phase_loop::{AmplitudeSettings, Controlled, TestSettings};

use super::ClosedLoop;
use super::motion::LockedMotion;
use super::newton::{Derivatives, Guess, period};
use crate::rig::session::EVER;
use crate::rig::{RigError, Session, VirtualTest};

/// Parts of the way from level to level, at most: where motions turn back, the last part finds none.
const PARTS: usize = 64;
/// Time constants of the resonance after which the motion of a loop that was left alone is looked at: from rest it has
/// only to be near enough for Newton's method, a jump has to arrive.
const FROM_REST: [usize; 4] = [1, 2, 4, 8];
const AFTER_A_JUMP: [usize; 3] = [6, 12, 24];
/// Largest relative distance of the frequency of a motion from that at which it was looked for.
const NEAR: f64 = 5e-3;

/// A level of a test before it is run.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HeldLevel {
    /// The level.
    pub level: f64,
    /// Its motion at phase resonance; none if none was found.
    pub motion: Option<LockedMotion>,
    /// Whether it was not reached from the level before, as where that branch of motions ends, but looked for.
    pub jumped: bool,
    /// Whether the motion that leads here, or that of the level before, is not held: it wanders, and need not get here.
    pub after_lost: bool,
    /// Time until it is steady, s, from its multipliers and the criteria of the schedule; infinite if never.
    pub settling: f64,
    /// The same motion with the amplitude of the response under control, where phase control alone loses it.
    pub by_amplitude: Option<LockedMotion>,
}

impl HeldLevel {
    /// Whether phase control holds the level, from a level before that it holds, and it is steady within the longest
    /// time of the schedule.
    pub fn is_held(&self, longest: f64) -> bool {
        self.motion.as_ref().is_some_and(LockedMotion::is_held) && self.settling <= longest && !self.after_lost
    }
}

/// The levels of a test one after the other, each from the motion of the one before.
#[derive(Debug)]
pub struct LevelsAhead {
    system: ClosedLoop,
    levels: Vec<f64>,
    next: usize,
    last: Option<LockedMotion>,
    /// Whether the motion that leads to the next level is not held.
    lost: bool,
    known: Option<Derivatives>,
}

impl LevelsAhead {
    /// The levels of this test. Higher harmonics of the force are taken not to be controlled.
    ///
    /// # Errors
    /// Those of [`VirtualTest::check`].
    pub fn new(test: &VirtualTest) -> Result<Self, RigError> {
        test.check()?;
        let system = ClosedLoop::new(&test.rig, &test.control, &test.channels);
        let levels = test.control.schedule.levels().collect();
        Ok(Self { system, levels, next: 0, last: None, lost: false, known: None })
    }

    /// All of them, as long as `asked`, called before each, permits.
    ///
    /// # Errors
    /// Those of the rig; [`RigError::Interrupted`].
    pub fn all(mut self, asked: impl Fn() -> ControlFlow<()>) -> Result<Vec<HeldLevel>, RigError> {
        let mut found = Vec::with_capacity(self.levels.len());
        while let Some(level) = self.levels.get(self.next).copied() {
            if asked().is_break() {
                return Err(RigError::Interrupted);
            }
            self.next += 1;
            found.push(self.level(level)?);
        }
        Ok(found)
    }

    fn level(&mut self, level: f64) -> Result<HeldLevel, RigError> {
        let before = self.last.clone();
        let followed = match &before {
            Some(before) => self.followed(before, level)?,
            None => None,
        };
        let followed = followed.map(|at| self.system.locked(level, at)).transpose()?.flatten();
        // What cannot be held leads elsewhere, perhaps to a motion that can.
        let left = followed.as_ref().is_some_and(|followed| !followed.is_held());
        let (motion, jumped, waited) = match followed {
            Some(followed) if followed.is_held() => (Some(followed), false, 0.0),
            lost => match self.looked_for(lost.as_ref().or(before.as_ref()), level)? {
                Some((at, waited)) => {
                    let found = self.system.locked(level, at)?;
                    if lost.is_none() || found.as_ref().is_some_and(LockedMotion::is_held) {
                        (found, before.is_some(), waited)
                    } else {
                        (lost, false, 0.0)
                    }
                }
                None => (lost, false, 0.0),
            },
        };
        let settling = motion.as_ref().map_or(f64::INFINITY, |motion| self.settling(before.as_ref(), motion));
        let settling = if jumped { waited + settling } else { settling };
        let held = motion.as_ref().is_some_and(LockedMotion::is_held);
        let after_lost = std::mem::replace(&mut self.lost, left || !held) || left;
        let by_amplitude = match &motion {
            Some(motion) if !motion.is_held() => self.by_amplitude(motion)?,
            _ => None,
        };
        if motion.is_some() {
            self.last.clone_from(&motion);
        }
        Ok(HeldLevel { level, motion, jumped, after_lost, settling, by_amplitude })
    }

    /// Along the motions of the levels between; none where they end.
    fn followed(&mut self, before: &LockedMotion, level: f64) -> Result<Option<Guess>, RigError> {
        let whole = level - before.level;
        let (mut at, mut reached, mut part) = (before.at.clone(), 0.0, 1.0);
        let mut earlier: Option<(f64, Guess)> = None;
        while reached < 1.0 {
            let next = if reached + part > 1.0 - 1e-9 { 1.0 } else { reached + part };
            let guess = match &earlier {
                Some((share, earlier)) => earlier.between(&at, (next - share) / (reached - share)),
                None => at.clone(),
            };
            match self.system.periodic(before.level + next * whole, &guess, &mut self.known)? {
                Some(found) => {
                    earlier = Some((reached, std::mem::replace(&mut at, found)));
                    reached = next;
                    part *= 2.0;
                }
                None => {
                    part *= 0.5;
                    self.known = None;
                    if part * (PARTS as f64) < 1.0 {
                        return Ok(None);
                    }
                }
            }
        }
        Ok(Some(at))
    }

    /// Where the loop goes by itself, from the motion before or from rest, and after which time, s.
    fn looked_for(&mut self, before: Option<&LockedMotion>, level: f64) -> Result<Option<(Guess, f64)>, RigError> {
        let control = &self.system.control;
        let (interval, plan) = (self.system.rig.interval, control.schedule);
        let constant = 1.0 / control.phase.resonance.decay_rate().max(f64::MIN_POSITIVE);
        let mut session = self.system.session(before.map_or(level, |before| before.level), interval, EVER)?;
        match before {
            Some(before) => {
                session.begin_at(before.level, before.omega, 0.0);
                session.set_numbers(&before.at.y);
                session.go(level, plan.ramp)?;
            }
            None => session.run(plan.ramp + plan.start)?,
        }
        let instants = if before.is_some() { &AFTER_A_JUMP[..] } else { &FROM_REST[..] };
        let mut waited = 0.0;
        for instant in instants {
            let until = (*instant as f64 * constant).min(plan.settling.longest);
            if until <= waited {
                break;
            }
            session.run(until - waited)?;
            waited = until;
            self.known = None;
            let guess = begun(&mut session)?;
            let found = self.system.periodic(level, &guess, &mut self.known)?;
            // Newton's method may go to a motion that the loop is nowhere near.
            if let Some(found) = found.filter(|found| (found.omega / guess.omega - 1.0).abs() < NEAR) {
                return Ok(Some((found, waited)));
            }
        }
        Ok(None)
    }

    /// Time until the drifts of response and frequency, decaying from the step between two levels, are within their
    /// tolerances, and the windows that judge them are full.
    fn settling(&self, before: Option<&LockedMotion>, motion: &LockedMotion) -> f64 {
        let (criteria, rate) = (self.system.control.schedule.settling, motion.decay_rate());
        if rate <= 0.0 {
            return f64::INFINITY;
        }
        let change = |of: fn(&LockedMotion) -> f64| before.map_or(1.0, |before| (1.0 - of(before) / of(motion)).abs());
        let decay = |change: f64, tolerance: f64| (change * rate / tolerance).ln().max(0.0) / rate;
        let amplitude = decay(change(|motion| motion.response), criteria.amplitude_drift);
        // From rest the frequency is that of the resonance to begin with.
        let frequency = before.map_or(0.0, |_| decay(change(|motion| motion.omega), criteria.frequency_drift));
        amplitude.max(frequency) + (criteria.windows * criteria.periods) as f64 * period(motion.omega)
    }

    /// The same motion with its amplitude as the level.
    fn by_amplitude(&self, motion: &LockedMotion) -> Result<Option<LockedMotion>, RigError> {
        let control = &self.system.control;
        if control.amplitude.controlled == Controlled::Response {
            return Ok(None);
        }
        let drive = motion.level;
        let amplitude = AmplitudeSettings::response(&control.phase, drive);
        let control = TestSettings { amplitude, ..control.clone() };
        let system = ClosedLoop { control, ..self.system.clone() };
        let mut y = motion.at.y.clone();
        // The last numbers of the control are the drive and the error of the amplitude.
        let behind = y.len() - system.states();
        y.splice(behind..behind, [drive, 0.0]);
        let guess = Guess { y, omega: motion.omega };
        let found = system.periodic(motion.response, &guess, &mut None)?;
        Ok(found.map(|at| system.locked(motion.response, at)).transpose()?.flatten())
    }
}

/// The motion at the beginning of the next period.
fn begun(session: &mut Session) -> Result<Guess, RigError> {
    let mut phase = session.state().phase().drive_phase();
    loop {
        session.step()?;
        let now = session.state().phase().drive_phase();
        if now < phase {
            return Ok(Guess { y: session.numbers(), omega: session.state().phase().omega() });
        }
        phase = now;
    }
}
