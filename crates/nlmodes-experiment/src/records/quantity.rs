use std::fmt;

use crate::records::unit;

/// Standard gravity, m/s².
const STANDARD_GRAVITY: f64 = 9.806_65;
/// International pound of force, N.
const POUND: f64 = 4.448_221_615_260_5;
/// International inch, m.
const INCH: f64 = 0.0254;

/// What a channel measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Force, N.
    Force,
    /// Displacement, m.
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Acceleration, m/s².
    Acceleration,
    /// Phase, rad.
    Phase,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Force, Self::Displacement, Self::Velocity, Self::Acceleration, Self::Phase];

    /// Name as in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Phase => "phase",
        }
    }

    /// Unit inside the program.
    pub fn si_unit(self) -> &'static str {
        self.units()[0].0
    }

    /// How often displacement is differentiated in time to give this; `None` for force and phase.
    pub fn time_derivative(self) -> Option<u32> {
        match self {
            Self::Displacement => Some(0),
            Self::Velocity => Some(1),
            Self::Acceleration => Some(2),
            Self::Force | Self::Phase => None,
        }
    }

    /// Units that are understood, the SI unit first, each with its factor to SI.
    pub fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Force => &[
                ("N", 1.0),
                ("kN", 1e3),
                ("mN", 1e-3),
                ("MN", 1e6),
                ("lbf", POUND),
                ("lb", POUND),
                ("kgf", STANDARD_GRAVITY),
                ("kp", STANDARD_GRAVITY),
            ],
            Self::Displacement => &[
                ("m", 1.0),
                ("mm", 1e-3),
                ("cm", 1e-2),
                ("um", 1e-6),
                ("nm", 1e-9),
                ("in", INCH),
                ("mil", 1e-3 * INCH),
                ("mils", 1e-3 * INCH),
                ("ft", 12.0 * INCH),
            ],
            Self::Velocity => &[
                ("m/s", 1.0),
                ("mm/s", 1e-3),
                ("cm/s", 1e-2),
                ("um/s", 1e-6),
                ("in/s", INCH),
                ("mil/s", 1e-3 * INCH),
                ("ft/s", 12.0 * INCH),
            ],
            Self::Acceleration => &[
                ("m/s^2", 1.0),
                ("mm/s^2", 1e-3),
                ("cm/s^2", 1e-2),
                ("g", STANDARD_GRAVITY),
                ("gn", STANDARD_GRAVITY),
                ("mg", 1e-3 * STANDARD_GRAVITY),
                ("in/s^2", INCH),
                ("ft/s^2", 12.0 * INCH),
            ],
            Self::Phase => &[
                ("rad", 1.0),
                ("deg", std::f64::consts::PI / 180.0),
                ("°", std::f64::consts::PI / 180.0),
                ("cycles", std::f64::consts::TAU),
            ],
        }
    }

    /// Factor from a unit to SI, however it is spelled: `m/s²`, `m/s2` and `m/s**2` are one. `None` for a unit that
    /// does not measure this.
    pub fn factor(self, unit: &str) -> Option<f64> {
        let usual = unit::usual(unit);
        self.units().iter().find(|(name, _)| *name == usual).map(|(_, factor)| *factor)
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_belong_to_one_quantity() {
        assert_eq!(Quantity::Displacement.factor("mm"), Some(1e-3));
        assert_eq!(Quantity::Acceleration.factor("g"), Some(9.80665));
        assert_eq!(Quantity::Force.factor("mm"), None);
        assert_eq!(Quantity::Phase.factor("deg"), Some(1f64.to_radians()));
        assert!(Quantity::ALL.iter().all(|q| q.factor(q.si_unit()) == Some(1.0)));
    }
}
