use crate::raw::RawUpdating;
use crate::scene::{UpdatedParameter, Updating};
use crate::{Findings, Problem};

/// The updating of one structure, which is the same everywhere along its axis.
pub fn check(raw: &RawUpdating, uniform: bool, findings: &mut Findings<'_>) -> Option<Updating> {
    if !uniform {
        let problem = Problem::error("`updating` fits parameters of one rod or beam without segments");
        findings.put("updating", problem, "the structure of this scene is another one");
        return None;
    }
    let frequencies_hz = raw.frequencies_hz.clone()?;
    let parameters = raw.parameters.clone().unwrap_or_else(|| vec![UpdatedParameter::YoungsModulus]);
    let modes = match &raw.modes {
        Some(modes) => modes.iter().map(|mode| *mode as usize).collect(),
        None => (1..=frequencies_hz.len()).collect(),
    };
    let updating = Updating { parameters, frequencies_hz, modes, done: None };
    let sound = [is_paired(&updating, findings), has_enough(&updating, findings), is_distinct(&updating, findings)];
    (sound == [true; 3]).then_some(updating)
}

fn is_paired(updating: &Updating, findings: &mut Findings<'_>) -> bool {
    let (modes, frequencies) = (updating.modes.len(), updating.frequencies_hz.len());
    if modes != frequencies {
        let problem = Problem::error("`updating` has not one mode for each frequency");
        findings.put("updating.modes", problem, format!("found {modes}, expected {frequencies}, one a frequency"));
    }
    modes == frequencies
}

fn has_enough(updating: &Updating, findings: &mut Findings<'_>) -> bool {
    let (wanted, given) = (updating.parameters.len(), updating.frequencies_hz.len());
    if wanted > given {
        let problem = Problem::error("`updating` has more parameters than frequencies to find them from");
        findings.put("updating.frequencies_hz", problem, format!("found {given}, expected {wanted} or more"));
    }
    wanted <= given
}

fn is_distinct(updating: &Updating, findings: &mut Findings<'_>) -> bool {
    let parameters = &updating.parameters;
    if let Some(i) = (1..parameters.len()).find(|&i| parameters[..i].contains(&parameters[i])) {
        let problem = Problem::error(format!("`updating.parameters` names \"{}\" twice", parameters[i].name()));
        findings.put("updating.parameters", problem, "expected each once");
        return false;
    }
    let both = [UpdatedParameter::YoungsModulus, UpdatedParameter::Density].iter().all(|p| parameters.contains(p));
    if both {
        let problem = Problem::error("`updating.parameters` cannot have both modulus and density").help(
            "frequencies depend on their ratio alone: weigh the structure for its density, and update the modulus",
        );
        findings.put("updating.parameters", problem, "expected one of the two");
    }
    let modes = &updating.modes;
    let repeated = (1..modes.len()).find(|&i| modes[..i].contains(&modes[i]));
    if let Some(i) = repeated {
        let problem = Problem::error(format!("`updating.modes` names mode {} twice", modes[i]));
        findings.put("updating.modes", problem, "expected each once");
    }
    !both && repeated.is_none()
}
