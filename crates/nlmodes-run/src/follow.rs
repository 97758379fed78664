//! A fold, a first touch, a phase resonance or a mode at an energy, followed over a parameter of a scene: the jump
//! frequency over a gap.
//!
//! The scene is computed first, in memory: each fold of its response, each first touch, the resonance or the mode is
//! then followed by two-parameter continuation, both ways from the value of the scene.

mod error;
mod family;
mod mode;
mod response;
mod text;
mod written;

pub use error::FollowError;

use std::path::Path;

use nlmodes::branches::Watch;
use nlmodes::modal::{BranchEnd, cubic};
use nlmodes::report::columns::FollowRow;
use nlmodes::report::hertz;
use nlmodes::response::{ParameterCurve, ParameterPoint};
use nlmodes_scene::assemble::Structures;
use serde::Serialize;

use family::Texts;

/// What is followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wanted {
    /// The folds of a response over the frequency, where it jumps.
    Folds {
        /// Its level, in the unit of the load; none for the only one.
        level: Option<f64>,
    },
    /// Where a response over the frequency first touches a stop.
    Touches {
        /// Its level, in the unit of the load; none for the only one.
        level: Option<f64>,
    },
    /// The phase resonance at a level.
    Resonance {
        /// The level, in the unit of the load; none for the only one.
        level: Option<f64>,
    },
    /// The mode at an averaged kinetic energy.
    Mode {
        /// The energy, J.
        energy_j: f64,
    },
}

/// What is followed, over which parameter, and how far.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FollowSettings {
    /// What is followed.
    pub wanted: Wanted,
    /// Key of the parameter, as `--set` takes it.
    pub key: String,
    /// The values between which it is followed, in the unit of the key.
    pub window: [f64; 2],
}

/// What was followed.
#[derive(Debug, Clone, Serialize)]
pub struct FollowOutcome {
    /// What was asked for.
    #[serde(flatten)]
    pub settings: FollowSettings,
    /// Title of the scene.
    pub title: String,
    /// Value of the parameter in the scene.
    pub value: f64,
    /// The curves.
    pub curves: Vec<Followed>,
}

/// A curve over the parameter.
#[derive(Debug, Clone, Serialize)]
pub struct Followed {
    /// Its name.
    pub name: String,
    /// Why it ends at its lower and upper end.
    pub ends: [String; 2],
    /// Whether both ends are those of the window.
    pub is_complete: bool,
    /// Its points.
    #[serde(skip)]
    pub points: Vec<FollowRow>,
}

impl FollowOutcome {
    /// Whether all curves go from one end of the window to the other.
    pub fn is_complete(&self) -> bool {
        self.curves.iter().all(|curve| curve.is_complete)
    }
}

impl Followed {
    /// From a curve of motions of so many periods of the load.
    fn new(name: String, curve: &ParameterCurve, subharmonic: usize) -> Self {
        let [below, above] = &curve.ends;
        let message = |end: &BranchEnd| end.message.clone();
        let points = curve.points.iter().map(|point| row(point, subharmonic)).collect();
        Self { name, ends: [message(below), message(above)], is_complete: below.complete && above.complete, points }
    }
}

impl Followed {
    /// Whether it passes this frequency (Hz) at a value: a curve that turns comes back as another fold.
    fn passes(&self, value: f64, frequency: f64) -> bool {
        self.points.windows(2).any(|pair| {
            let [a, b] = [&pair[0], &pair[1]];
            let [low, high] = [a.value.min(b.value), a.value.max(b.value)];
            if !(low..=high).contains(&value) || low == high {
                return false;
            }
            let (h, t) = (b.value - a.value, (value - a.value) / (b.value - a.value));
            let [f, g] = [a.frequency_hz, b.frequency_hz];
            let between = cubic([f, g], [a.d_frequency_d_value, b.d_frequency_d_value], h, t);
            let chord = f + t * (g - f);
            // What the cubic leaves is a small part of what it adds to the chord.
            (between - frequency).abs() <= (SAME * frequency).max(OF_CURVATURE * (between - chord).abs())
        })
    }
}

/// Relative difference of frequencies that are the same, and the same over what a step of a curve bends.
const SAME: f64 = 1e-7;
const OF_CURVATURE: f64 = 0.05;

/// The point of a curve with this number of periods of the load in one; the number of the curve is not known yet.
fn row(point: &ParameterPoint, subharmonic: usize) -> FollowRow {
    let own = point.motion.point();
    FollowRow {
        curve: 0,
        value: point.value,
        frequency_hz: hertz(own.omega * subharmonic as f64),
        d_frequency_d_value: point.by_value / std::f64::consts::TAU,
        fundamental_m: point.amplitude,
        peak_m: own.peak,
        peak_contact_force_n: own.peak_contact_force,
        impulse_ns: own.impulse().unwrap_or(0.0),
        energy_j: own.kinetic_energy,
        level: point.motion.at.level,
        residual: point.residual,
        turns: point.turns,
    }
}

/// Follows what is wanted of the scene in a file, with overrides as `--set` takes them.
///
/// # Errors
/// [`FollowError`].
pub fn follow(
    path: &Path,
    overrides: &[String],
    settings: &FollowSettings,
    watch: &Watch,
) -> Result<FollowOutcome, FollowError> {
    let text =
        std::fs::read_to_string(path).map_err(|source| FollowError::Unreadable { path: path.to_path_buf(), source })?;
    follow_text((&path.display().to_string(), &text), overrides, settings, watch)
}

/// The same of a scene as text; its name stands in messages, and paths of its files count from the directory of that.
///
/// # Errors
/// [`FollowError`].
pub fn follow_text(
    scene: (&str, &str),
    overrides: &[String],
    settings: &FollowSettings,
    watch: &Watch,
) -> Result<FollowOutcome, FollowError> {
    let structures = Structures::default();
    let texts = Texts::of(scene, overrides, settings)?;
    let curves = match settings.wanted {
        Wanted::Mode { energy_j } => mode::follow(&texts, settings, energy_j, (&structures, watch))?,
        _ => response::follow(&texts, settings, (&structures, watch))?,
    };
    let title = texts.base.scene.title.clone();
    Ok(FollowOutcome { settings: settings.clone(), title, value: texts.value(), curves })
}
