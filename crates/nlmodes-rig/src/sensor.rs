use nlmodes_experiment::records::{Quantity, Role};

/// What a motion sensor measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// m.
    Displacement,
    /// m/s.
    Velocity,
    /// m/s².
    Acceleration,
}

impl Motion {
    /// The same as a quantity of a record.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Displacement => Quantity::Displacement,
            Self::Velocity => Quantity::Velocity,
            Self::Acceleration => Quantity::Acceleration,
        }
    }
}

/// What a sensor is attached to.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// The force between exciter and structure.
    Excitation,
    /// The motion of the drive point.
    DrivePoint(Motion),
    /// The motion of the point of the structure that meets the stop.
    StopPoint(Motion),
    /// The contact force on the stop.
    Stop,
    /// The motion of another point.
    Point {
        /// What is measured.
        motion: Motion,
        /// Position along the structure, m.
        position: f64,
        /// Mode shapes there, 1/√kg.
        shape: Vec<f64>,
    },
}

impl Place {
    /// Quantity of the channel.
    pub fn quantity(&self) -> Quantity {
        match self {
            Self::Excitation | Self::Stop => Quantity::Force,
            Self::DrivePoint(motion) | Self::StopPoint(motion) | Self::Point { motion, .. } => motion.quantity(),
        }
    }

    /// Role of the channel.
    pub fn role(&self) -> Role {
        match self {
            Self::Excitation => Role::Excitation,
            Self::DrivePoint(_) => Role::DrivePoint,
            Self::Stop => Role::Contact,
            Self::StopPoint(_) | Self::Point { .. } => Role::Response,
        }
    }
}

/// A sensor, and a channel of the records.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Name of the channel.
    pub name: String,
    /// Where and what.
    pub place: Place,
    /// Standard deviation of white Gaussian noise, in the unit of the channel.
    pub noise: f64,
}

impl Sensor {
    /// A sensor with white Gaussian noise of this standard deviation.
    pub fn new(name: impl Into<String>, place: Place, noise: f64) -> Self {
        Self { name: name.into(), place, noise }
    }
}
