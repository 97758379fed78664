//! Records in words.

use std::f64::consts::TAU;

use nlmodes::experiment::extraction::{DecayPoint, FreeDecay, Measured, RecordExtraction};
use nlmodes_scene::significant;

/// What was extracted from a record, in a few lines.
pub fn in_words(found: &RecordExtraction) -> String {
    let mut lines = vec![format!("{}: {} periods", found.record, found.periods)];
    let mut row = |name: &str, text: String| lines.push(format!("  {name:<20}{text}"));
    row("frequency", with_error(found.omega.times(1.0 / TAU), "Hz"));
    if let Some(modal) = &found.modal {
        row("modal amplitude", with_error(modal.amplitude, "m √kg"));
        if let Some(damping) = modal.damping {
            row("damping", with_error(damping, ""));
        }
    }
    if let Some(excitation) = &found.excitation {
        row("lag", with_error(excitation.lag.times(1f64.to_degrees()), "°"));
        let harmonics = excitation.power.harmonics;
        row("mode indicator", format!("{} from {harmonics} harmonics", with_error(excitation.pbmif, "")));
    }
    if let Some(lost) = found.modal.as_ref().and_then(|modal| modal.contact_dissipation).filter(|_| touched(found)) {
        row("lost at the contact", with_error(lost, "W"));
    }
    if let Some(balance) = &found.balance {
        row("force by balance", with_error(balance.peak_force, "N at the peak, without the force cell"));
    }
    if let Some(stiffness) = found.contact.as_ref().and_then(|contact| contact.stiffness) {
        let measured = Measured { value: stiffness.stiffness, uncertainty: stiffness.stiffness_error };
        row("contact stiffness", with_error(measured, "N/m"));
    }
    if let Some(restitution) = found.contact.as_ref().and_then(|contact| contact.restitution.as_ref()) {
        let s = restitution.statistics();
        let text = format!(
            "{:.3}, spread {:.3}, at {} m/s ({} impacts)",
            s.mean,
            s.std,
            significant(s.approach, 3),
            s.n_impacts
        );
        row("restitution", text);
    }
    lines.extend(found.findings.iter().map(|finding| format!("  finding {}: {finding}", finding.name())));
    lines.join("\n")
}

/// A free decay in a line: where it begins and ends.
pub fn decay_in_words(record: &str, decay: &FreeDecay) -> String {
    let (Some(first), Some(last)) = (decay.points.first(), decay.points.last()) else {
        return format!("{record}: free from {} s", significant(decay.from, 5));
    };
    let point = |point: &DecayPoint| {
        let frequency = with_error(point.omega.times(1.0 / TAU), "Hz");
        format!("{frequency}, damping {}", with_error(point.damping, ""))
    };
    format!(
        "{record}: free from {} s, {} points from {} at {} m √kg to {} at {} m √kg",
        significant(decay.from, 5),
        decay.points.len(),
        point(first),
        significant(first.amplitude.value, 4),
        point(last),
        significant(last.amplitude.value, 4)
    )
}

/// Whether there is a contact by its force, or by the balance of the modes.
fn touched(found: &RecordExtraction) -> bool {
    found.balance.is_some() || found.contact.as_ref().is_some_and(|contact| contact.closed_fraction > 0.0)
}

/// The figure to the second digit of its error; alone where too few periods give none.
fn with_error(measured: Measured, unit: &str) -> String {
    let Measured { value, uncertainty } = measured;
    let digits = if uncertainty > 0.0 && uncertainty.is_finite() && value != 0.0 {
        ((value.abs().log10().floor() - uncertainty.log10().floor()) as i32 + 2).clamp(2, 12)
    } else {
        6
    };
    let spread = if uncertainty.is_finite() { format!(" ± {}", significant(uncertainty, 2)) } else { String::new() };
    let text = format!("{}{spread} {unit}", significant(value, digits as usize));
    text.trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_without_an_error_stands_alone() {
        let told = |uncertainty: f64| with_error(Measured { value: 40.1, uncertainty }, "Hz");
        assert_eq!([told(0.02), told(f64::NAN)], ["40.1 ± 0.02 Hz", "40.1 Hz"]);
    }
}
