use nlmodes_hbm::{CondensedStructure, Projection};
use nlmodes_modal::{DETUNING, HarmonicCoefficients, InternalResonance, ModalPoint};
use nlmodes_model::{LinearModes, open_modes};

/// Recognises internal resonances of a structure; its linear modes are computed when they are first needed.
pub(super) struct Resonances<'s> {
    structure: &'s CondensedStructure,
    /// Projection onto the linear modes known, and their angular frequencies, rad/s.
    modes: Option<(Projection, Vec<f64>)>,
    /// Angular frequency up to which the modes are known, rad/s.
    known: f64,
}

impl<'s> Resonances<'s> {
    pub fn new(structure: &'s CondensedStructure) -> Self {
        Self { structure, modes: None, known: 0.0 }
    }

    /// The resonance in which a point takes part: the harmonic above the first with the most kinetic energy, if that is
    /// a good share, and the linear mode near its frequency that looks most like it. `project` gives the modal
    /// coordinates of the point.
    pub fn of(
        &mut self,
        point: &ModalPoint,
        project: impl FnOnce(&Projection) -> Option<HarmonicCoefficients>,
    ) -> Option<InternalResonance> {
        let harmonic = point.resonant_harmonic()?;
        let frequency = harmonic as f64 * point.omega;
        if self.known < frequency * (1.0 + DETUNING) {
            self.known = 2.0 * frequency;
            self.modes = linear_modes_up_to(self.structure, self.known)
                .map(|modes| (Projection::new(self.structure, &modes), modes.omega));
        }
        let (onto, omega) = self.modes.as_ref()?;
        InternalResonance::of_harmonic(harmonic, frequency, omega, || project(onto))
    }
}

/// The linear modes up to an angular frequency; `None` if they cannot be computed.
fn linear_modes_up_to(structure: &CondensedStructure, omega: f64) -> Option<LinearModes> {
    // Between two held eigenfrequencies lies at most one free one for each contact coordinate.
    let held = structure.modes().iter().filter(|m| m.lambda < omega * omega).count();
    let hidden = structure.n_held_modes() - structure.modes().len();
    let count = held + hidden + structure.n_contact_dofs();
    open_modes(structure.model(), count).ok()
}
