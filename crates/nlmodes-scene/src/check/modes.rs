//! `[structure.modes]`: what must hold between its values.

use crate::raw::RawModes;
use crate::rule::number;
use crate::scene::ImposedModes;
use crate::{Findings, Problem};

const FREQUENCIES: &str = "structure.modes.frequencies_hz";

pub fn check(raw: &RawModes, findings: &mut Findings<'_>) -> Option<ImposedModes> {
    let frequencies_hz = raw.frequencies_hz.clone()?;
    let is_paired = is_paired(raw.damping_ratios.as_deref(), frequencies_hz.len(), findings);
    let ascends = ascends(&frequencies_hz, FREQUENCIES, findings);
    (is_paired && ascends).then(|| ImposedModes { frequencies_hz, damping_ratios: raw.damping_ratios.clone() })
}

fn is_paired(ratios: Option<&[f64]>, wanted: usize, findings: &mut Findings<'_>) -> bool {
    let Some(found) = ratios.map(<[f64]>::len).filter(|found| *found != wanted) else { return true };
    let problem = Problem::error("`structure.modes` has not one damping ratio for each frequency");
    let label = format!("found {found}, expected {wanted}, one a frequency");
    findings.put("structure.modes.damping_ratios", problem, label);
    false
}

/// Whether each frequency of the list at `path` is above the one before; said at the first that is not.
pub fn ascends(frequencies: &[f64], path: &str, findings: &mut Findings<'_>) -> bool {
    let Some(k) = (1..frequencies.len()).find(|&k| frequencies[k] <= frequencies[k - 1]) else { return true };
    let problem = Problem::error(format!("`{path}` does not ascend"));
    findings.put(&format!("{path}.{k}"), problem, format!("expected more than {} Hz", number(frequencies[k - 1])));
    false
}
