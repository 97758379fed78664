//! Units as people and programs spell them.

use crate::records::Quantity;

/// Alternative spellings, in the order of replacement; without blanks.
const SPELLINGS: [(&str, &str); 21] = [
    ("²", "^2"),
    ("**", "^"),
    ("µ", "u"),
    ("μ", "u"),
    ("micron", "um"),
    ("m.s", "m/s"),
    ("m·s", "m/s"),
    ("m*s", "m/s"),
    ("/s-2", "/s^2"),
    ("/s^-2", "/s^2"),
    ("/s-1", "/s"),
    ("/s^-1", "/s"),
    ("sec", "s"),
    ("/s/s", "/s^2"),
    ("/s2", "/s^2"),
    ("/(s^2)", "/s^2"),
    ("mps2", "m/s^2"),
    ("mps^2", "m/s^2"),
    ("mps", "m/s"),
    ("ips", "in/s"),
    ("inch", "in"),
];

/// Meaning of a unit name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnitWord {
    /// Of this quantity, with its factor to SI.
    Known(Quantity, f64),
    /// A voltage, which becomes a quantity by a sensitivity.
    Voltage,
}

/// The usual spelling of a unit.
pub fn usual(text: &str) -> String {
    let bare: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    SPELLINGS.iter().fold(bare, |text, (found, usual)| text.replace(found, usual))
}

/// Meaning of a word, case-insensitive if unambiguous; `None` for an unknown unit.
pub fn read(text: &str) -> Option<UnitWord> {
    let word = usual(text);
    if ["v", "mv", "uv", "volt", "volts"].contains(&word.to_lowercase().as_str()) {
        return Some(UnitWord::Voltage);
    }
    let all =
        || Quantity::ALL.into_iter().flat_map(|q| q.units().iter().map(move |(name, factor)| (q, *name, *factor)));
    if let Some((quantity, _, factor)) = all().find(|(_, name, _)| *name == word) {
        return Some(UnitWord::Known(quantity, factor));
    }
    let mut alike = all().filter(|(_, name, _)| name.eq_ignore_ascii_case(&word));
    let (quantity, _, factor) = alike.next()?;
    alike.all(|(q, _, f)| (q, f) == (quantity, factor)).then_some(UnitWord::Known(quantity, factor))
}

/// Seconds in a unit of time; `None` for a word that is none.
pub fn seconds(text: &str) -> Option<f64> {
    let word = text.trim().to_lowercase().replace(['µ', 'μ'], "u");
    match word.as_str() {
        "s" | "sec" | "secs" | "second" | "seconds" => Some(1.0),
        "ms" | "msec" | "millisecond" | "milliseconds" => Some(1e-3),
        "us" | "usec" | "microsecond" | "microseconds" => Some(1e-6),
        "ns" | "nsec" | "nanosecond" | "nanoseconds" => Some(1e-9),
        "min" | "minute" | "minutes" => Some(60.0),
        "h" | "hr" | "hour" | "hours" => Some(3600.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_understood_as_people_spell_them() {
        let known = |text: &str| match read(text) {
            Some(UnitWord::Known(quantity, factor)) => (quantity, factor),
            other => panic!("{text}: {other:?}"),
        };
        for text in ["m/s^2", "m/s**2", "m/s2", "M/S^2", "m/sec^2", "m / s²", "mps2", "m/s/s", "m.s-2", "m/(s^2)"] {
            assert_eq!(known(text), (Quantity::Acceleration, 1.0), "{text}");
        }
        for text in ["g", "G"] {
            assert_eq!(known(text), (Quantity::Acceleration, 9.80665), "{text}");
        }
        assert_eq!(known("mils"), (Quantity::Displacement, 2.54e-5));
        assert_eq!(known("ips"), (Quantity::Velocity, 0.0254));
        assert_eq!(known("in/sec"), (Quantity::Velocity, 0.0254));
        assert_eq!(known("µm"), (Quantity::Displacement, 1e-6));
        assert_eq!((known("mN"), known("MN")), ((Quantity::Force, 1e-3), (Quantity::Force, 1e6)));
        assert_eq!(read("mV"), Some(UnitWord::Voltage));
        assert!(["", "NONE", "furlong", "Mn"].iter().all(|text| read(text).is_none()));
        assert_eq!((seconds("ms"), seconds("Sec"), seconds("NONE")), (Some(1e-3), Some(1.0), None));
    }
}
