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
use nlmodes::modal::{BranchEnd, ModalPoint, cubic};
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
    pub points: Vec<FollowedPoint>,
}

/// A point of it.
#[derive(Debug, Clone)]
pub struct FollowedPoint {
    /// Value of the parameter.
    pub value: f64,
    /// Derivative of the frequency, Hz per unit of the parameter.
    pub d_frequency: f64,
    /// What the motion is.
    pub point: ModalPoint,
    /// Level of the load.
    pub level: f64,
    /// Whether the curve turns here.
    pub turns: bool,
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
        let points = curve.points.iter().map(|point| FollowedPoint::new(point, subharmonic)).collect();
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
            let [f, g] = [hertz(a.point.omega), hertz(b.point.omega)];
            let between = cubic([f, g], [a.d_frequency, b.d_frequency], h, t);
            let chord = f + t * (g - f);
            // What the cubic leaves is a small part of what it adds to the chord.
            (between - frequency).abs() <= (SAME * frequency).max(OF_CURVATURE * (between - chord).abs())
        })
    }
}

/// Relative difference of frequencies that are the same, and the same over what a step of a curve bends.
const SAME: f64 = 1e-7;
const OF_CURVATURE: f64 = 0.05;

impl FollowedPoint {
    fn new(point: &ParameterPoint, subharmonic: usize) -> Self {
        let own = point.motion.point();
        let modal = ModalPoint {
            omega: own.omega * subharmonic as f64,
            fundamental: point.amplitude,
            residual: point.residual,
            ..own
        };
        Self {
            value: point.value,
            d_frequency: point.by_value / std::f64::consts::TAU,
            point: modal,
            level: point.motion.at.level,
            turns: point.turns,
        }
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
