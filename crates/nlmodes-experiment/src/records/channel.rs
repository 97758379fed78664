use crate::records::{Quantity, RecordError};

/// What a channel is there for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The force that excites the structure.
    Excitation,
    /// The response where the force acts.
    DrivePoint,
    /// The response elsewhere.
    Response,
    /// The force at the stop.
    Contact,
    /// The phase of the oscillator that drives the excitation.
    ExcitationPhase,
}

impl Role {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Excitation, Self::DrivePoint, Self::Response, Self::Contact, Self::ExcitationPhase];

    /// Name as in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Excitation => "excitation",
            Self::DrivePoint => "drive-point",
            Self::Response => "response",
            Self::Contact => "contact",
            Self::ExcitationPhase => "excitation-phase",
        }
    }

    /// Whether a channel of this role can measure the quantity.
    pub fn fits(self, quantity: Quantity) -> bool {
        match self {
            Self::Excitation | Self::Contact => quantity == Quantity::Force,
            Self::DrivePoint | Self::Response => quantity.time_derivative().is_some(),
            Self::ExcitationPhase => quantity == Quantity::Phase,
        }
    }
}

/// A channel of a record: what was measured where, and how the recorded numbers become SI values.
///
/// `value = sign · recorded / sensitivity`, in `unit`; that times the factor of the unit is the SI value. The signal
/// arrived `delay` seconds late.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name of the column, or in the header.
    pub name: String,
    /// What it measures.
    pub quantity: Quantity,
    /// Unit of the recorded numbers over the sensitivity.
    pub unit: String,
    /// What it is there for.
    pub role: Role,
    /// Position along the structure, m.
    pub position: Option<f64>,
    /// `1` or `−1`: direction of the sensor against that of the coordinate.
    pub sign: f64,
    /// Recorded number per unit, for instance volts per newton.
    pub sensitivity: f64,
    /// By how much the signal arrived late, s.
    pub delay: f64,
    /// Smallest and largest value that the sensor can give, in `unit`.
    pub range: Option<[f64; 2]>,
    /// Relative standard error of the sensitivity, where it was stated.
    pub uncertainty: Option<f64>,
}

impl Channel {
    /// A channel in SI units with sign 1, sensitivity 1, no delay and an unknown range.
    pub fn new(name: impl Into<String>, quantity: Quantity, role: Role, position: Option<f64>) -> Self {
        Self {
            name: name.into(),
            quantity,
            unit: quantity.si_unit().to_owned(),
            role,
            position,
            sign: 1.0,
            sensitivity: 1.0,
            delay: 0.0,
            range: None,
            uncertainty: None,
        }
    }

    /// Factor from recorded numbers to SI values.
    ///
    /// # Errors
    /// [`RecordError::Unit`] for a unit of another quantity, [`RecordError::Sensitivity`] if sensitivity or sign are
    /// zero or not finite.
    pub fn scale(&self) -> Result<f64, RecordError> {
        let unit = || RecordError::Unit {
            channel: self.name.clone(),
            unit: self.unit.clone(),
            quantity: self.quantity,
            known: self.quantity.units().iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
        };
        let factor = self.quantity.factor(&self.unit).ok_or_else(unit)?;
        let scale = self.sign.signum() * factor / self.sensitivity;
        if scale.is_finite() && scale != 0.0 && self.sign != 0.0 {
            return Ok(scale);
        }
        Err(RecordError::Sensitivity { channel: self.name.clone(), sensitivity: self.sensitivity, sign: self.sign })
    }

    /// The range in SI units, lower limit first.
    pub fn si_range(&self) -> Option<[f64; 2]> {
        let factor = self.quantity.factor(&self.unit)?;
        // A turned sensor gives its upper limit where the coordinate is lowest.
        let [a, b] = self.range?.map(|limit| self.sign.signum() * limit * factor);
        Some([a.min(b), a.max(b)])
    }

    /// The same channel for values that are in SI already.
    #[must_use]
    pub fn in_si(&self) -> Self {
        let (range, uncertainty) = (self.si_range(), self.uncertainty);
        Self { range, uncertainty, ..Self::new(self.name.clone(), self.quantity, self.role, self.position) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recorded_numbers_become_si_values() {
        let mut channel = Channel::new("a", Quantity::Acceleration, Role::Response, Some(0.1));
        (channel.unit, channel.sensitivity, channel.sign) = ("g".into(), 0.1, -1.0);
        channel.range = Some([-5.0, 10.0]);
        assert!((channel.scale().unwrap() + 98.0665).abs() < 1e-12);
        let [low, high] = channel.si_range().unwrap();
        assert!((low + 98.0665).abs() < 1e-12 && (high - 49.03325).abs() < 1e-12);
        channel.unit = "mm".into();
        assert!(channel.scale().unwrap_err().to_string().contains("m/s^2"));
        channel.unit = "g".into();
        channel.sensitivity = 0.0;
        assert!(channel.scale().is_err());
    }
}
