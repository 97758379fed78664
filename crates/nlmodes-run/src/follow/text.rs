//! What was followed, in words.

use std::fmt::{Display, Formatter, Result};

use nlmodes::report::columns::FollowRow;
use nlmodes_scene::number;

use super::{FollowOutcome, Followed};

impl Display for FollowOutcome {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "over {}, {} in the scene", self.settings.key, number(self.value))?;
        self.curves.iter().try_for_each(|curve| write!(f, "\n{curve}"))
    }
}

impl Display for Followed {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{}: {} points", self.name, self.points.len())?;
        let ends = [self.points.first(), self.points.last()];
        for (point, why) in ends.iter().zip(&self.ends) {
            if let Some(point) = point {
                write!(f, "\n  {}: {why}", at(point))?;
            }
        }
        for point in self.points.iter().filter(|point| point.turns) {
            write!(f, "\n  turns at {}: it comes back from there as another one", at(point))?;
        }
        Ok(())
    }
}

fn at(point: &FollowRow) -> String {
    let hz = nlmodes_scene::rounded(point.frequency_hz, 9);
    format!(
        "{} → {} Hz ({:+.4e} Hz per unit)",
        number(nlmodes_scene::rounded(point.value, 9)),
        number(hz),
        point.d_frequency_d_value
    )
}
