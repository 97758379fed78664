use crate::Quantity;

/// Samples of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordChannel {
    /// Name of the sensor.
    pub name: String,
    /// What is measured, in SI units.
    pub quantity: Quantity,
    /// Position along the structure, m, where it has one.
    pub position: Option<f64>,
    /// One value a sampling interval.
    pub samples: Vec<f64>,
}

/// All channels over the same time; the last one is the phase of the drive, `drive_phase`, rad in [0, 2π).
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Sampling interval, s.
    pub interval: f64,
    /// Time of the first sample since the test began, s.
    pub start: f64,
    /// Channels of equal length.
    pub channels: Vec<RecordChannel>,
}

impl Record {
    /// The channel of this name.
    pub fn channel(&self, name: &str) -> Option<&RecordChannel> {
        self.channels.iter().find(|channel| channel.name == name)
    }
}
