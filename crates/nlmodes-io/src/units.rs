use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::Component;

/// The consistent units in which a model was written, and what turns them into m, kg, s.
///
/// A displacement `q` of the file is `L q` metres, a rotation stays in radians, an energy is `M L²/T²` of the file's
/// joules. So
///
/// ```text
/// K_SI = M L²/T² K / (l_i l_j) ,  M_SI = M L² M / (l_i l_j)
/// l = L for displacements, 1 for rotations and generalised coordinates
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "String", try_from = "String"))]
pub struct UnitSystem {
    /// Metres in a unit of length.
    length: f64,
    /// Kilograms in a unit of mass.
    mass: f64,
    /// Seconds in a unit of time.
    time: f64,
    names: [&'static str; 3],
}

const LENGTHS: [(&str, f64); 6] =
    [("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("um", 1e-6), ("in", 0.0254), ("ft", 0.3048)];
/// A slinch is lbf s²/in, a slug lbf s²/ft.
const MASSES: [(&str, f64); 7] = [
    ("kg", 1.0),
    ("t", 1e3),
    ("g", 1e-3),
    ("mg", 1e-6),
    ("lb", 0.453_592_37),
    ("slinch", 4.448_221_615_260_5 / 0.0254),
    ("slug", 4.448_221_615_260_5 / 0.3048),
];
const TIMES: [(&str, f64); 3] = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6)];

impl UnitSystem {
    /// Metres, kilograms, seconds.
    pub const SI: Self = Self { length: 1.0, mass: 1.0, time: 1.0, names: ["m", "kg", "s"] };

    /// Metres in the file's unit of length.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// What turns a stiffness between two components into N/m, N, N·m, as they need.
    ///
    /// ```
    /// use nlmodes_io::{Component, UnitSystem};
    /// let units: UnitSystem = "mm-t-s".parse()?;
    /// assert_eq!(units.stiffness(Component::X, Component::Y), 1e3); // N/mm
    /// assert_eq!(units.mass(Component::X, Component::X), 1e3);      // t
    /// assert_eq!(units.stiffness(Component::RX, Component::RX), 1e-3); // N mm
    /// # Ok::<(), nlmodes_io::UnknownUnits>(())
    /// ```
    pub fn stiffness(&self, i: Component, j: Component) -> f64 {
        self.mass(i, j) / (self.time * self.time)
    }

    /// What turns a mass between two components into kg, kg·m, kg·m².
    pub fn mass(&self, i: Component, j: Component) -> f64 {
        let lengths = [i, j].into_iter().filter(|c| c.translation().is_none()).count();
        (0..lengths).fold(self.mass, |factor, _| factor * self.length)
    }
}

impl Default for UnitSystem {
    fn default() -> Self {
        Self::SI
    }
}

impl TryFrom<String> for UnitSystem {
    type Error = UnknownUnits;

    fn try_from(name: String) -> Result<Self, UnknownUnits> {
        name.parse()
    }
}

impl From<UnitSystem> for String {
    fn from(units: UnitSystem) -> Self {
        units.to_string()
    }
}

impl fmt::Display for UnitSystem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.names.join("-"))
    }
}

/// There is no such system of units.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "there are no units `{name}`; expected SI or length-mass-time, as mm-t-s, with m, mm, cm, um, in or ft; kg, t, g, \
        mg, \
     lb, slinch or slug; s, ms or us"
)]
pub struct UnknownUnits {
    /// The requested quantity.
    pub name: String,
}

impl FromStr for UnitSystem {
    type Err = UnknownUnits;

    fn from_str(name: &str) -> Result<Self, UnknownUnits> {
        if name.eq_ignore_ascii_case("SI") {
            return Ok(Self::SI);
        }
        let unknown = || UnknownUnits { name: name.to_owned() };
        let parts: Vec<&str> = name.split('-').collect();
        let [length, mass, time] = parts[..] else { return Err(unknown()) };
        let of = |table: &[(&'static str, f64)], name: &str| {
            table.iter().find(|(known, _)| *known == name).copied().ok_or_else(unknown)
        };
        let (length, mass, time) = (of(&LENGTHS, length)?, of(&MASSES, mass)?, of(&TIMES, time)?);
        Ok(Self { length: length.1, mass: mass.1, time: time.1, names: [length.0, mass.0, time.0] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newtons_come_out_of_every_system() {
        // 210 GPa mm is 2.1e8 N/m: E times a length is a stiffness.
        for (units, modulus, length) in
            [("mm-t-s", 2.1e5, 1.0), ("mm-kg-ms", 2.1e2, 1.0), ("m-kg-s", 2.1e11, 1e-3), ("mm-g-ms", 2.1e5, 1.0)]
        {
            let units: UnitSystem = units.parse().unwrap();
            let stiffness = modulus * length * units.stiffness(Component::X, Component::X);
            assert!((stiffness / 2.1e8 - 1.0).abs() < 1e-14, "{units}: {stiffness}");
        }
        let inches: UnitSystem = "in-slinch-s".parse().unwrap();
        // One lbf/in is 175.12683524647636 N/m.
        assert!((inches.stiffness(Component::Z, Component::X) / 175.126_835_246_476_36 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn energy_of_a_mixed_motion_is_the_same_in_two_systems() {
        // ½ qᵀ K q with a displacement of 2 mm and a rotation of 0.1 rad, in mm-t-s and in SI.
        let units: UnitSystem = "mm-t-s".parse().unwrap();
        let (u, r) = (Component::X, Component::RY);
        let (k_uu, k_ur, k_rr) = (100.0, 30.0, 5000.0);
        let in_file = 100.0 * 2.0 * 2.0 / 2.0 + 30.0 * 2.0 * 0.1 + 5000.0 * 0.1 * 0.1 / 2.0; // N mm
        let (u_si, r_si) = (2e-3, 0.1);
        let si = k_uu * units.stiffness(u, u) * u_si * u_si / 2.0
            + k_ur * units.stiffness(u, r) * u_si * r_si
            + k_rr * units.stiffness(r, r) * r_si * r_si / 2.0;
        assert!((si - in_file * 1e-3).abs() < 1e-15);
    }

    #[test]
    fn unknown_units_are_refused() {
        for name in ["", "mm", "mm-t", "mm-t-s-s", "MM-T-S", "mm-s-t"] {
            assert_eq!(name.parse::<UnitSystem>(), Err(UnknownUnits { name: name.into() }));
        }
        for name in ["SI", "si", "Si", "m-kg-s"] {
            assert_eq!(name.parse(), Ok(UnitSystem::SI));
        }
        assert_eq!("mm-kg-ms".parse::<UnitSystem>().unwrap().to_string(), "mm-kg-ms");
    }
}
