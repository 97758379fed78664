//! What gradients say of a study, in words.

use std::fmt::{Display, Formatter, Result};

use nlmodes_scene::{number, significant};

use crate::first_order::{Compared, Corner, Effect, FirstOrder, Kept, OfQuantity};

impl Display for FirstOrder {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if let Some(reason) = &self.reason {
            return write!(f, "by gradients nothing: {reason}");
        }
        self.quantities.iter().enumerate().try_for_each(|(k, of)| {
            let between = if k == 0 { "" } else { "\n" };
            write!(f, "{between}{of}")
        })
    }
}

impl Display for OfQuantity {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let name = &self.quantity;
        let (Some(value), Some(std), None) = (self.value, self.std, &self.reason) else {
            let reason = self.reason.as_deref().unwrap_or("the case with the means does not have it");
            return write!(f, "{name} has no gradient: {reason}");
        };
        let value = number(value);
        write!(f, "{name} by gradients: {value} at the means, standard deviation {std:.3e}")?;
        self.of_cases.iter().try_for_each(|of| write!(f, "\n  {of}"))?;
        self.effects.iter().try_for_each(|effect| write!(f, "\n  {effect}"))?;
        self.corners.iter().try_for_each(|corner| write!(f, "\n  {corner}"))?;
        self.limit.iter().try_for_each(|kept| write!(f, "\n  {kept}"))
    }
}

impl Display for Compared {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (std, error, more) = (self.std, self.std_error, 100.0 * self.more);
        write!(f, "that of the cases is {std:.3e} ± {error:.1e}, {more:+.1} %: ")?;
        match self.differs {
            true => write!(f, "the quantity is no straight line over the tolerances, use that of the cases"),
            false => write!(f, "the two agree"),
        }
    }
}

impl Display for Effect {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (name, by) = (&self.variable, self.derivative);
        write!(f, "{name}: {by:.4e} per unit, {:+.3e} for its deviation", by * self.std)?;
        if let Some(share) = self.share {
            write!(f, ", {:.1} % of the variance", 100.0 * share)?;
        }
        match self.index_less_share {
            Some([less, error]) => write!(f, " (Sobol' index {less:+.4} from that, ± {error:.4})"),
            None => Ok(()),
        }
    }
}

impl Display for Corner {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let at: Vec<String> = self.at.iter().map(|(name, value)| format!("{name} = {}", number(*value))).collect();
        write!(f, "{} at {}: {} by gradients, ", self.which, at.join(", "), number(self.predicted))?;
        match self.computed {
            Some(computed) => write!(f, "{} computed there", number(computed))?,
            None => write!(f, "not computed")?,
        }
        if !self.reason.is_empty() {
            write!(f, " ({})", self.reason)?;
        }
        match self.turns_over.as_slice() {
            [] => Ok(()),
            names => {
                write!(f, "; there the derivative by {} has another sign: it is more extreme within", names.join(", "))
            }
        }
    }
}

impl Display for Kept {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{} {}: ", self.which, number(self.limit))?;
        let first = self.first_order.map_or_else(|| "nothing".to_owned(), |share| format!("{:.1} %", 100.0 * share));
        match (self.share, self.computed.map(number)) {
            (Some(0.0), _) if self.first_order == Some(0.0) => write!(f, "the means are beyond it")?,
            (Some(1.0), Some(value)) => write!(f, "{value} at the worst corner of the tolerances")?,
            (Some(share), Some(value)) => {
                let range = |(name, [low, high]): (&String, &[f64; 2])| {
                    format!("{name} from {} to {}", significant(*low, 5), significant(*high, 5))
                };
                let ranges: Vec<String> = self.within.iter().map(range).collect();
                let (percent, ranges) = (100.0 * share, ranges.join(", "));
                write!(
                    f,
                    "kept if all tolerances are {percent:.1} % as wide (by gradients {first}): {ranges}; {value} at \
                     their worst corner"
                )?;
            }
            _ => write!(f, "by gradients kept if all tolerances are {first} as wide; not computed")?,
        }
        if self.reason.is_empty() { Ok(()) } else { write!(f, ": {}", self.reason) }
    }
}
