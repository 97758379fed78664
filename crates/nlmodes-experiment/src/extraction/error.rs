use nlmodes_modal::ModalError;
use thiserror::Error;

use crate::extraction::Finding;

/// Why a record gives no modal point.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ExtractionError {
    /// The record does not serve.
    #[error("{}: {finding}", finding.name())]
    Refused {
        /// The reason.
        finding: Box<Finding>,
        /// Other findings.
        others: Vec<Finding>,
    },
    /// No frequency near the first guess makes the record periodic.
    #[error("no fundamental frequency is found near {guess_hz:.6} Hz in channel \"{channel}\"; give a first guess")]
    NoFrequency {
        /// The first guess, Hz.
        guess_hz: f64,
        /// Name of the channel.
        channel: String,
    },
    /// The harmonics cannot be separated.
    #[error("{harmonics} harmonics of {frequency_hz:.6} Hz cannot be distinguished in {samples} samples")]
    Harmonics {
        /// Number of harmonics.
        harmonics: usize,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Samples.
        samples: usize,
    },
    /// A setting that makes no sense.
    #[error("{setting} is {value}; expected {expected}")]
    Setting {
        /// Which.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// What is expected.
        expected: &'static str,
    },
    /// The modal quantities cannot be formed.
    #[error(transparent)]
    Modal(#[from] ModalError),
}

impl ExtractionError {
    /// Short names of the findings, the decisive one first, separated by spaces.
    pub fn names(&self) -> String {
        match self {
            Self::Refused { finding, others } => Finding::names(std::iter::once(&**finding).chain(others)),
            Self::NoFrequency { .. } => "no-frequency".into(),
            Self::Harmonics { .. } => "harmonics-not-told-apart".into(),
            Self::Setting { .. } => "setting".into(),
            Self::Modal(_) => "no-modal-quantities".into(),
        }
    }
}
