use nlmodes_experiment::phase_loop::{EmergencyReason, PhaseLoopError};
use nlmodes_linalg::LinalgError;
use nlmodes_model::ModelError;
use nlmodes_model::reduction::ReductionError;
use thiserror::Error;

/// Why a virtual rig cannot be built or cannot continue.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RigError {
    /// The computation was cancelled.
    #[error("interrupted")]
    Interrupted,
    /// A quantity that must be positive and finite is not.
    #[error("{what} must be positive and finite, not {value}")]
    NotPositive {
        /// The quantity, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A quantity that must not be negative is, or is not finite.
    #[error("{what} must be zero or positive, not {value}")]
    Negative {
        /// The quantity, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A quantity is not a number.
    #[error("{what} must be finite, not {value}")]
    NotFinite {
        /// The quantity, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A list does not have one entry per mode.
    #[error("{what}: {found} values for {modes} modes")]
    ModeCount {
        /// The list.
        what: String,
        /// Number of modes.
        modes: usize,
        /// Number of values.
        found: usize,
    },
    /// A rigid stop needs the static flexibility of its point.
    #[error(
        "a rigid stop needs the residual flexibility of the modes that were left out (m/N) to be positive, not \
         {residual}: \
         without it the contact node would have mass, and an impact law would be needed"
    )]
    RigidStopWithoutFlexibility {
        /// Residual flexibility, m/N.
        residual: f64,
    },
    /// A sensor at the stop, but there is no stop.
    #[error("sensor `{sensor}` measures at the stop, but there is none")]
    NoStop {
        /// The sensor.
        sensor: String,
    },
    /// There is no such sensor.
    #[error("channel {channel}: there are {channels}")]
    NoChannel {
        /// Requested index.
        channel: usize,
        /// Number of channels.
        channels: usize,
    },
    /// The integration step is too large to be exact.
    #[error(
        "integration step too large: {step} s, at most {limit} s for the fastest motion of this rig; \
         at least {substeps} steps a sampling interval are needed"
    )]
    StepTooLarge {
        /// Step, s.
        step: f64,
        /// Longest step, s.
        limit: f64,
        /// Sufficient number of steps per sampling interval.
        substeps: usize,
    },
    /// The angle of the drive in one integration step is too large to be represented.
    #[error(
        "the drive turns by {angle} rad in one integration step, at most {limit} rad: sample faster or drive more \
         slowly"
    )]
    DriveTooFast {
        /// Angle `ω h`, rad.
        angle: f64,
        /// Largest, rad.
        limit: f64,
    },
    /// Contact opened and closed more often in one step than is possible for a piecewise linear motion of this size.
    #[error("contact switched more than {most} times in one step at {time} s")]
    Chatter {
        /// Time, s.
        time: f64,
        /// Maximum.
        most: usize,
    },
    /// The motion left the range of numbers.
    #[error("the motion is not finite at {time} s")]
    Diverged {
        /// Time, s.
        time: f64,
    },
    /// A structure has fewer modes than requested.
    #[error("{wanted} modes were asked for, but the structure has {found}")]
    TooFewModes {
        /// Requested.
        wanted: usize,
        /// Available.
        found: usize,
    },
    /// The modes of a structure cannot be computed.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A structure cannot be reduced to its modes.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// Its static deflections cannot be computed.
    #[error(transparent)]
    Statics(#[from] LinalgError),
    /// The loop is rejected.
    #[error(transparent)]
    Loop(#[from] PhaseLoopError),
    /// A filter behind a sensor that reads derivatives of the drive.
    #[error(
        "a cell or filter cannot follow a sensor that an ideal force moves directly: the residual flexibility of the \
         drive point gives its velocity and acceleration derivatives of the drive"
    )]
    DriveInSensor,
    /// The control ended the test.
    #[error("the control of the test stopped it at {time} s: {}", reason_in_words(*.reason))]
    Stopped {
        /// Why.
        reason: EmergencyReason,
        /// When, s.
        time: f64,
    },
    /// A limit without a channel that tells it.
    #[error("the {what} is limited, but no channel for it is named")]
    LimitWithoutChannel {
        /// What is limited.
        what: &'static str,
    },
    /// The sampling interval of the loop differs from that of the rig.
    #[error("the loop has a sampling interval of {of_loop} s, the rig one of {of_rig} s")]
    SamplingIntervals {
        /// Of the loop, s.
        of_loop: f64,
        /// Of the rig, s.
        of_rig: f64,
    },
    /// The loop is set for a quantity other than that of its response sensor.
    #[error("the loop expects a response in {expected}, but sensor `{sensor}` measures in {found}")]
    ResponseQuantity {
        /// The sensor.
        sensor: String,
        /// Unit that the loop expects.
        expected: &'static str,
        /// Unit of the sensor.
        found: &'static str,
    },
}

fn reason_in_words(reason: EmergencyReason) -> &'static str {
    match reason {
        EmergencyReason::None => "no reason",
        EmergencyReason::Operator => "the operator wanted it",
        EmergencyReason::Stroke => "the displacement exceeded its limit",
        EmergencyReason::ContactForce => "the contact force exceeded its limit",
        EmergencyReason::Force => "the force of the exciter exceeded its limit",
        EmergencyReason::Silence => "no readings of force or response for too long",
    }
}

pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, RigError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(RigError::NotPositive { what, value }) }
}

pub(crate) fn not_negative(what: &'static str, value: f64) -> Result<f64, RigError> {
    if value >= 0.0 && value.is_finite() { Ok(value) } else { Err(RigError::Negative { what, value }) }
}

pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, RigError> {
    if value.is_finite() { Ok(value) } else { Err(RigError::NotFinite { what, value }) }
}
