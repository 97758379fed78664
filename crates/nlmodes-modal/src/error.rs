use thiserror::Error;

/// Why a modal quantity cannot be formed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ModalError {
    /// The harmonics alias.
    #[error("{harmonics} harmonics need at least {needed} samples a period, not {samples}")]
    TooFewSamples {
        /// Highest harmonic.
        harmonics: usize,
        /// Samples a period.
        samples: usize,
        /// Smallest number that works.
        needed: usize,
    },
}
