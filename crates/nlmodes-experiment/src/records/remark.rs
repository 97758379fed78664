use std::fmt;

/// Remarks from reading a record.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    /// Channels begin or end at different instants: what they have in common was taken.
    StartsDiffer {
        /// The channel that begins last.
        channel: String,
        /// Its start, s.
        start: f64,
        /// The channel that begins first.
        first: String,
        /// Its start, s.
        first_start: f64,
        /// Samples that all have in common.
        samples: usize,
    },
    /// The instants of the samples are uneven: values at even ones were taken.
    UnevenTimes {
        /// Largest deviation from an even axis, over the sampling interval.
        deviation: f64,
    },
    /// The unit in a file contradicts the scene, or the file itself.
    HeaderDisagrees {
        /// Name of the channel.
        channel: String,
        /// The unit in the file, and what it contradicts.
        header: String,
    },
}

impl Remark {
    /// Short name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::StartsDiffer { .. } => "starts-differ",
            Self::UnevenTimes { .. } => "uneven-times",
            Self::HeaderDisagrees { .. } => "header-disagrees",
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StartsDiffer { channel, start, first, first_start, samples } => write!(
                f,
                "channel \"{channel}\" begins at {start} s, \"{first}\" at {first_start} s: the {samples} samples are \
                    taken that all \
                 channels have in common"
            ),
            Self::UnevenTimes { deviation } => write!(
                f,
                "the time stamps are up to {deviation:.2} sampling intervals from an even axis: values at even \
                    instants are taken, by polynomials through the samples about them"
            ),
            Self::HeaderDisagrees { channel, header } => write!(f, "channel \"{channel}\": the file says {header}"),
        }
    }
}
