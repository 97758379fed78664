use crate::scene::{UpdatedParameter, Updating};
use crate::{Diagnostic, Diagnostics};

/// The updating of one structure, which is the same everywhere along its axis, with the numbers of all modes.
pub fn checked(written: &Updating, uniform: bool, diagnostics: &mut Diagnostics<'_>) -> Updating {
    let mut updating = written.clone();
    if updating.modes.is_empty() {
        updating.modes = (1..=updating.frequencies_hz.len()).collect();
    }
    if uniform {
        is_paired(&updating, diagnostics);
        has_enough(&updating, diagnostics);
        is_distinct(&updating, diagnostics);
    } else {
        let diagnostic = Diagnostic::error("`updating` fits parameters of one rod or beam without segments");
        diagnostics.put("updating", diagnostic, "the structure of this scene is another one");
    }
    updating
}

fn is_paired(updating: &Updating, diagnostics: &mut Diagnostics<'_>) {
    let (modes, frequencies) = (updating.modes.len(), updating.frequencies_hz.len());
    if modes != frequencies {
        let diagnostic = Diagnostic::error("`updating` needs one mode for each frequency");
        diagnostics.put(
            "updating.modes",
            diagnostic,
            format!("found {modes}, expected {frequencies}, one a frequency"),
        );
    }
}

fn has_enough(updating: &Updating, diagnostics: &mut Diagnostics<'_>) {
    let (wanted, given) = (updating.parameters.len(), updating.frequencies_hz.len());
    if wanted > given {
        let diagnostic = Diagnostic::error("`updating` has more parameters than frequencies to find them from");
        diagnostics.put("updating.frequencies_hz", diagnostic, format!("found {given}, expected {wanted} or more"));
    }
}

fn is_distinct(updating: &Updating, diagnostics: &mut Diagnostics<'_>) {
    let parameters = &updating.parameters;
    if let Some(i) = (1..parameters.len()).find(|&i| parameters[..i].contains(&parameters[i])) {
        let diagnostic = Diagnostic::error(format!("`updating.parameters` names \"{}\" twice", parameters[i].name()));
        diagnostics.put("updating.parameters", diagnostic, "expected each once");
        return;
    }
    let both = [UpdatedParameter::YoungsModulus, UpdatedParameter::Density].iter().all(|p| parameters.contains(p));
    if both {
        let diagnostic = Diagnostic::error("`updating.parameters` cannot have both modulus and density").help(
            "frequencies depend on their ratio alone: weigh the structure for its density, and update the modulus",
        );
        diagnostics.put("updating.parameters", diagnostic, "expected one of the two");
    }
    let modes = &updating.modes;
    if let Some(i) = (1..modes.len()).find(|&i| modes[..i].contains(&modes[i])) {
        let diagnostic = Diagnostic::error(format!("`updating.modes` names mode {} twice", modes[i]));
        diagnostics.put("updating.modes", diagnostic, "expected each once");
    }
}
