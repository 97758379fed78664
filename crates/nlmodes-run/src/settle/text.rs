//! What a motion becomes, in words.

use nlmodes_scene::{number, short};

use super::{Becomes, Settled, Size};

impl Settled {
    /// As JSON.
    pub fn json(&self) -> String {
        serde_json::to_value(self).map_or_else(|error| error.to_string(), |value| format!("{value:#}"))
    }

    /// In words, line by line.
    pub fn text(&self) -> String {
        let mut lines = vec![format!(
            "point {}: {:.6} Hz, {} {}",
            self.point,
            self.frequency_hz,
            number(self.level),
            self.level_unit
        )];
        if let Some([re, im]) = self.multiplier {
            let imaginary = if im == 0.0 { String::new() } else { format!(" ± {} i", short(im.abs())) };
            lines.push(format!("largest multiplier     {}{imaginary}", short(re)));
        }
        lines.push(format!("motion of the point    {}", size(&self.before)));
        lines.push(match self.distance_to_exact {
            Some(off) => format!("exact motion next to it, off by {} of its size", short(off)),
            None => "no exact motion was found next to it: its harmonics leave out too much".to_owned(),
        });
        lines.push(format!("becomes                {}", self.becomes.text()));
        lines.extend(self.becomes.after().map(|after| format!("its motion             {}", size(after))));
        let periods = self.integrated_periods;
        lines.push(match self.distance_to_exact {
            Some(_) => format!(
                "after {periods} periods of the load, disturbed by {} of its size along the vector of that multiplier",
                short(self.disturbance)
            ),
            None => format!("after {periods} periods of the load from the state of its harmonics"),
        });
        lines.join("\n")
    }
}

impl Becomes {
    fn after(&self) -> Option<&Size> {
        match self {
            Self::Periodic { after, returns: false, .. } | Self::Other { after, .. } => Some(after),
            _ => None,
        }
    }

    /// In a few words.
    pub(crate) fn short_text(&self) -> String {
        match self {
            Self::Periodic { returns: true, .. } => "themselves again".to_owned(),
            Self::Periodic { periods, .. } => format!("periodic in {periods} periods of the load"),
            Self::TwoLines { beat_hz, .. } => format!("two lines that beat with {} Hz", short(*beat_hz)),
            Self::Irregular { .. } => "irregular".to_owned(),
            Self::Other { nearest_point, .. } => {
                let near = nearest_point.map(|point| format!(", that of point {point}")).unwrap_or_default();
                format!("another motion of the same period{near}")
            }
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Periodic { returns: true, largest_multiplier, .. } => {
                let how = if *largest_multiplier > 1.0 { "itself, left too slowly to be seen" } else { "itself again" };
                format!("periodic: {how}, multipliers up to {}", short(*largest_multiplier))
            }
            Self::Periodic { periods, largest_multiplier, .. } => format!(
                "periodic: one period in {periods} of the load, multipliers up to {}",
                short(*largest_multiplier)
            ),
            Self::TwoLines { frequencies_hz: [load, second], beat_hz, largest_m, spread_m } => format!(
                "two lines: {load:.6} Hz and {second:.6} Hz, which beat with {} Hz; up to {} ± {} m",
                short(*beat_hz),
                short(*largest_m),
                short(*spread_m)
            ),
            Self::Irregular { largest_m, spread_m, most_m } => format!(
                "irregular: up to {} ± {} m from period to period of the load, {} m at most",
                short(*largest_m),
                short(*spread_m),
                short(*most_m)
            ),
            Self::Other { periods, nearest_point, largest_multiplier, .. } => {
                let periods = if *periods == 1 { String::new() } else { format!(", one period in {periods}") };
                let near = nearest_point.map(|point| format!(", that of point {point}")).unwrap_or_default();
                let most = short(*largest_multiplier);
                format!("another motion{periods}{near}, multipliers up to {most}")
            }
        }
    }
}

fn size(size: &Size) -> String {
    let [least, most, fundamental] = [size.smallest_m, size.largest_m, size.fundamental_m].map(short);
    format!("{least} to {most} m, {fundamental} m at the frequency of the load")
}
