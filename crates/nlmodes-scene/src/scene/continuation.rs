use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{AtBranchPoint, FrequencyDirection, InternalResonance};

/// How far the branch is followed: to a limit of energy, of frequency, or whichever comes first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Continuation {
    /// Averaged kinetic energy at which the branch ends, relative to that at grazing; default: 10, or 1e4 with
    /// a frequency window and with `[[spring]]`, where modes start almost linear
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 1.0))]
    pub max_energy_ratio: Option<f64>,
    /// Frequency window [lowest, highest], where the branch ends
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("unit" = "Hz"), inner(range(min = 0.0)))]
    pub frequency_hz: Option<[f64; 2]>,
    /// Maximum number of points of the branch
    #[serde(default = "max_points")]
    #[schemars(range(min = 2, max = 1_000_000))]
    pub max_points: usize,
    /// Frequency on the backbone at which to start, instead of at grazing
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("unit" = "Hz", "exclusiveMinimum" = 0.0))]
    pub start_frequency_hz: Option<f64>,
    /// Averaged kinetic energy on the backbone at which to start, relative to that at grazing
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 1.0))]
    pub start_energy_ratio: Option<f64>,
    /// Averaged kinetic energy at which a nonlinear mode of a structure with `[[spring]]` starts; default: where the
    /// springs hardly change the linear mode and no stop is touched yet
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("unit" = "J", "exclusiveMinimum" = 0.0))]
    pub start_energy_j: Option<f64>,
    /// The same, as the amplitude of the first spring in the linear mode
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub start_amplitude_m: Option<f64>,
    /// Direction in which the branch leaves `start_frequency_hz` or `start_energy_ratio`
    #[serde(default)]
    pub direction: FrequencyDirection,
    /// Which half-branch is followed at a branch point
    #[serde(default)]
    pub at_branch_point: AtBranchPoint,
    /// Maximum number of branches with `at_branch_point = "all"`
    #[serde(default = "max_branches")]
    #[schemars(range(min = 1, max = 1000))]
    pub max_branches: usize,
    /// What to do where an internal resonance leads the branch away from the backbone
    #[serde(default)]
    pub internal_resonance: InternalResonance,
}

/// Where a branch starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// At the linear mode that just touches the stop.
    Grazing,
    /// On the backbone at a frequency.
    Frequency {
        /// The frequency, Hz.
        hz: f64,
        /// Which way from there.
        direction: FrequencyDirection,
    },
    /// On the backbone at an energy.
    Energy {
        /// Averaged kinetic energy over that at grazing.
        ratio: f64,
        /// Which way from there.
        direction: FrequencyDirection,
    },
}

/// Where modes end whose scene gives neither an energy nor a frequency window: about three times the amplitude that
/// touches the stop.
const ENERGY_RATIO: f64 = 10.0;

/// The same within a frequency window, at whose edge a mode ends that does not saturate before, and of modes that start
/// where springs hardly matter: a hundred times that amplitude, where a cubic spring matters as much as the structure.
const FAR_ENERGY_RATIO: f64 = 1e4;

impl Continuation {
    /// Averaged kinetic energy at which a mode ends, relative to that where it starts. `goes_far` has the higher
    /// default: a structure with springs, or a mode within a frequency window.
    pub fn energy_limit(&self, goes_far: bool) -> f64 {
        self.max_energy_ratio.unwrap_or(if goes_far { FAR_ENERGY_RATIO } else { ENERGY_RATIO })
    }

    /// Where the branch starts.
    pub fn start(&self) -> Start {
        let direction = self.direction;
        match (self.start_frequency_hz, self.start_energy_ratio) {
            (Some(hz), _) => Start::Frequency { hz, direction },
            (None, Some(ratio)) => Start::Energy { ratio, direction },
            (None, None) => Start::Grazing,
        }
    }
}

impl Default for Continuation {
    fn default() -> Self {
        Self {
            max_energy_ratio: None,
            frequency_hz: None,
            max_points: max_points(),
            start_frequency_hz: None,
            start_energy_ratio: None,
            start_energy_j: None,
            start_amplitude_m: None,
            direction: FrequencyDirection::default(),
            at_branch_point: AtBranchPoint::default(),
            max_branches: max_branches(),
            internal_resonance: InternalResonance::default(),
        }
    }
}

fn max_points() -> usize {
    5000
}

fn max_branches() -> usize {
    20
}
