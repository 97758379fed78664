//! Points of a branch solved again with more harmonics or more modes: what the numbers change by.

use nlmodes_hbm::{CondensedStructure, RealSeries};
use nlmodes_modal::ModalPoint;

use super::prepare::periodic;
use super::start::one_point;
use super::{BranchSettings, ComputedBranch, StudyError};

impl ComputedBranch {
    /// The motion of the averaged kinetic energy of point `point` with `harmonics` harmonics and the held modes of `structure`: that of the branch, or one with
    /// the same contacts and other modes. Newton's method at that energy leads there from the point; `None` where it does not.
    ///
    /// # Errors
    /// [`StudyError::NotHarmonic`] for a branch whose unknowns are not harmonics of the contacts; [`StudyError`] if the problem cannot be evaluated.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn refined(
        &self,
        point: usize,
        harmonics: usize,
        structure: &CondensedStructure,
    ) -> Result<Option<ModalPoint>, StudyError> {
        if self.is_exact() {
            return Err(StudyError::NotHarmonic);
        }
        let own = self.settings_at(point);
        let settings = BranchSettings { harmonics, ..own.clone() };
        let mut problem = periodic(structure, &settings, &self.grazing)?;
        let Some(finer) = problem.harmonics() else { return Err(StudyError::NotHarmonic) };
        let from = RealSeries { symmetry: own.symmetry, n_harmonics: own.harmonics };
        let p = (self.branch.points[point].kinetic_energy / self.grazing.energy).ln();
        let guess: Vec<f64> = finer.resized(&self.unknowns[point], from).into_iter().chain([p]).collect();
        let mut energy = vec![0.0; guess.len()];
        energy[guess.len() - 1] = 1.0;
        let found = one_point(&settings, &self.grazing, &mut problem, &guess, &energy, &mut ());
        found.map(|(x, _)| Ok(problem.modal_point(&x, 0.0)?)).transpose()
    }
}
