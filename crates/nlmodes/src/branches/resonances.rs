use nlmodes_hbm::CondensedStructure;
use nlmodes_modal::{HarmonicCoefficients, InternalResonance, ModalPoint};

/// The resonance in which a point takes part: the harmonic above the first with the most kinetic energy, if that is a
/// good share, and the linear mode near its frequency that looks most like it. `project` gives the coordinates of the
/// point in the open modes.
pub(super) fn resonance(
    structure: &CondensedStructure,
    point: &ModalPoint,
    project: impl FnOnce() -> Option<HarmonicCoefficients>,
) -> Option<InternalResonance> {
    let harmonic = point.resonant_harmonic()?;
    let frequency = harmonic as f64 * point.omega;
    InternalResonance::of_harmonic(harmonic, frequency, &structure.open_frequencies(), project)
}
