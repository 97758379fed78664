//! `[structure.modes]`: what must hold between its values.

use crate::rule::number;
use crate::scene::ImposedModes;
use crate::{Diagnostic, Diagnostics};

const FREQUENCIES: &str = "structure.modes.frequencies_hz";

pub fn check(modes: &ImposedModes, diagnostics: &mut Diagnostics<'_>) {
    is_paired(modes.damping_ratios.as_deref(), modes.frequencies_hz.len(), diagnostics);
    ascends(&modes.frequencies_hz, FREQUENCIES, diagnostics);
}

fn is_paired(ratios: Option<&[f64]>, wanted: usize, diagnostics: &mut Diagnostics<'_>) {
    let Some(found) = ratios.map(<[f64]>::len).filter(|found| *found != wanted) else { return };
    let diagnostic = Diagnostic::error("`structure.modes` needs one damping ratio for each frequency");
    let label = format!("found {found}, expected {wanted}, one a frequency");
    diagnostics.put("structure.modes.damping_ratios", diagnostic, label);
}

/// Whether each frequency of the list at `path` is above the one before; reported at the first that is not.
pub fn ascends(frequencies: &[f64], path: &str, diagnostics: &mut Diagnostics<'_>) -> bool {
    let Some(k) = (1..frequencies.len()).find(|&k| frequencies[k] <= frequencies[k - 1]) else { return true };
    let diagnostic = Diagnostic::error(format!("`{path}` is not in ascending order"));
    diagnostics.put(
        &format!("{path}.{k}"),
        diagnostic,
        format!("expected more than {} Hz", number(frequencies[k - 1])),
    );
    false
}
