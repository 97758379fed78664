//! A motion in time under any loads.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{BaseDirection, Place};

/// A motion in time under any loads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Transient {
    /// Its length, s.
    pub duration: f64,
    /// Where it begins.
    pub from: TransientStart,
    /// Samples a second of its histories, if given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sample_rate: Option<f64>,
    /// Parts of the envelope.
    pub envelope_windows: usize,
    /// Loads.
    pub loads: Vec<TransientLoad>,
    /// Places whose motion is written; empty for those of the loads.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub places: Vec<Place>,
}

/// Where a motion begins.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TransientStart {
    /// Undeformed and still.
    Rest,
    /// Where static loads and stops that press leave it.
    Static,
    /// On a computed motion, at its phase zero.
    Point {
        /// Directory written by a run.
        results: PathBuf,
        /// Number of the point.
        point: usize,
    },
}

/// A load with its course in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TransientLoad {
    /// What it acts on.
    pub on: LoadOn,
    /// When it begins, s.
    pub start: f64,
    /// Its course.
    pub course: Course,
}

/// What a load acts on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoadOn {
    /// A force at a place.
    Force(Place),
    /// The acceleration of the base, with which stops move.
    Base(BaseDirection),
}

/// The course of a load in time, N or m/s².
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Course {
    /// `amplitude cos(2π frequency t + phase)`.
    Sine {
        /// Amplitude.
        amplitude: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Phase, degrees.
        phase_deg: f64,
    },
    /// A cosine whose frequency is linear in time.
    Chirp {
        /// Amplitude.
        amplitude: f64,
        /// Frequency at the beginning, Hz.
        from_hz: f64,
        /// Frequency at the end or where it turns, Hz.
        to_hz: f64,
        /// Whether it comes back in the second half.
        back: bool,
        /// Its length, s.
        length: f64,
    },
    /// Straight lines between the rows of a file.
    Table(PathBuf),
    /// Noise with a flat spectrum in a band.
    Noise {
        /// Effective value.
        rms: f64,
        /// Lowest and highest frequency, Hz.
        band_hz: [f64; 2],
        /// Number from which it is made.
        seed: u32,
    },
    /// Half a period of a sine.
    HalfSine {
        /// Largest value.
        peak: f64,
        /// Width, s.
        width: f64,
    },
    /// An impulse without duration.
    Impact {
        /// Impulse, N s.
        impulse: f64,
    },
}
