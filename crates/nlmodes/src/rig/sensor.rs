use nlmodes_experiment::records::{Quantity, Role};

use crate::rig::Chain;

/// Quantity of a motion sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MotionQuantity {
    /// m.
    Displacement,
    /// m/s.
    Velocity,
    /// m/s².
    Acceleration,
}

impl MotionQuantity {
    /// The same as a quantity of a record.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Displacement => Quantity::Displacement,
            Self::Velocity => Quantity::Velocity,
            Self::Acceleration => Quantity::Acceleration,
        }
    }
}

/// Location of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub enum SensorPlace {
    /// The force between exciter and structure.
    Excitation,
    /// The motion of the drive point.
    DrivePoint(MotionQuantity),
    /// The motion of the contact point of the structure.
    StopPoint(MotionQuantity),
    /// The contact force on the stop.
    Stop,
    /// The motion of another point.
    Point {
        /// Quantity.
        motion: MotionQuantity,
        /// Position along the structure, m.
        position: f64,
        /// Mode shapes there, 1/√kg.
        shape: Vec<f64>,
    },
}

impl SensorPlace {
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
    /// Location and quantity.
    pub place: SensorPlace,
    /// Standard deviation of white Gaussian noise, in the unit of the channel.
    pub noise: f64,
    /// What else lies between the quantity and its samples.
    pub chain: Chain,
}

impl Sensor {
    /// A sensor with white Gaussian noise of this standard deviation.
    pub fn new(name: impl Into<String>, place: SensorPlace, noise: f64) -> Self {
        Self { name: name.into(), place, noise, chain: Chain::default() }
    }
}
