//! What a fit found, in words.

use std::fmt::{Display, Formatter, Result};

use crate::fit::FitOutcome;

/// Probability below which noise with the stated deviations does not explain what a fit leaves.
const UNLIKELY: f64 = 0.01;

impl Display for FitOutcome {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{} steps, {} curves; ", self.iterations, self.curves)?;
        let (left, free) = (self.chi_squared, self.degrees_of_freedom);
        match self.deviations_are_stated {
            true => write!(f, "sum of squares over the deviations {left:.4} with {free} degrees of freedom")?,
            false => write!(f, "deviations of the points from what is left, with {free} degrees of freedom")?,
        }
        if let Some(probability) = self.probability {
            write!(f, ", probability {probability:.3}")?;
            if probability < UNLIKELY {
                write!(f, "\nwarning: the curve leaves more than the stated deviations: the model or they are wrong")?;
            }
        }
        for own in &self.parameters {
            let change = 100.0 * (own.value / own.start - 1.0);
            let (name, value, std, start) = (&own.variable, own.value, own.std, own.start);
            let share = 100.0 * (std / value).abs();
            write!(f, "\n  {name}: {value:.6e} ± {std:.1e} ({share:.2} %), {change:+.2} % from {start:.6e}")?;
        }
        for (i, own) in self.parameters.iter().enumerate() {
            for (j, other) in self.parameters.iter().enumerate().skip(i + 1) {
                let rho = self.correlation[i][j];
                write!(f, "\n  correlation of {} and {}: {rho:+.3}", own.variable, other.variable)?;
            }
        }
        if self.interpolation > 0.1 {
            let share = self.interpolation;
            write!(f, "\nwarning: between its points the curve is uncertain by up to {share:.2} of a deviation")?;
        }
        let set: Vec<String> = self.set.iter().map(|set| format!("--set {set}")).collect();
        write!(f, "\nwith them: nlmodes-cli run SCENE {}", set.join(" "))
    }
}
