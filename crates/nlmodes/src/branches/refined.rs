//! Points of a branch solved again with more harmonics or more modes: what the numbers change by.

use nlmodes_hbm::{CondensedStructure, RealSeries};
use nlmodes_modal::ModalPoint;

use super::homotopy::{self, Effort};
use super::prepare::periodic;
use super::start::one_point;
use super::{BranchError, BranchSettings, ComputedBranch};

/// Numbers of harmonics tried one after the other where the step to the last is too far.
const STEPS: usize = 5;
/// Relative distance up to which two solutions of the same equations are one.
const SAME: f64 = 1e-5;

impl ComputedBranch {
    /// The motion of the averaged kinetic energy of point `point` with `harmonics` harmonics and the held modes of
    /// `structure`: that of the branch, or one with the same contacts and other modes. Newton's method at that energy
    /// leads there from the point, at once or over numbers of harmonics in between; `None` where neither does, or where
    /// it does not lead back from there with the harmonics and modes of the branch: what was found is then another
    /// motion of that energy, on another arm.
    ///
    /// # Errors
    /// [`BranchError::NotHarmonic`] for a branch whose unknowns are not harmonics of the contacts; [`BranchError`] if
    /// the problem cannot be evaluated.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn refined(
        &self,
        point: usize,
        harmonics: usize,
        structure: &CondensedStructure,
    ) -> Result<Option<ModalPoint>, BranchError> {
        if self.is_exact() {
            return Err(BranchError::NotHarmonic);
        }
        if let Some(found) = self.over(point, &[harmonics], structure)? {
            return Ok(Some(found));
        }
        let own = self.settings_at(point).harmonics;
        let mut steps: Vec<usize> =
            (1..=STEPS).map(|k| own + (harmonics.saturating_sub(own) * k).div_ceil(STEPS)).collect();
        steps.dedup();
        if steps.last() == Some(&harmonics) && steps.len() > 1 { self.over(point, &steps, structure) } else { Ok(None) }
    }

    /// From a point over these numbers of harmonics, at its energy.
    fn over(
        &self,
        point: usize,
        steps: &[usize],
        structure: &CondensedStructure,
    ) -> Result<Option<ModalPoint>, BranchError> {
        let own = self.settings_at(point);
        let p = (self.branch.points[point].kinetic_energy / self.grazing.energy).ln();
        let mut series = RealSeries { symmetry: own.symmetry, n_harmonics: own.harmonics };
        let (mut x, mut found) = (self.unknowns[point].clone(), None);
        for &harmonics in steps {
            let settings = BranchSettings { harmonics, ..own.clone() };
            let mut problem = periodic(structure, &settings, &self.grazing)?;
            let Some(finer) = problem.harmonics() else { return Err(BranchError::NotHarmonic) };
            let guess: Vec<f64> = finer.resized(&x, series).into_iter().chain([p]).collect();
            series = finer.series();
            let coordinate = guess.len() - 1;
            let mut energy = vec![0.0; guess.len()];
            energy[coordinate] = 1.0;
            let corrected = one_point(&settings, &self.grazing, &mut problem, &guess, &energy, &mut ()).or_else(|| {
                // A step in between is worth a way of its own.
                let effort = Effort::LITTLE;
                let try_it = steps.len() > 1;
                try_it.then(|| homotopy::solve(&mut problem, &guess, coordinate, &settings.step, effort, &mut ()))?
            });
            let Some((next, _)) = corrected else { return Ok(None) };
            found = Some(problem.modal_point(&next, 0.0)?);
            x = next;
        }
        Ok(if self.leads_back(point, &x, series)? { found } else { None })
    }

    /// Whether Newton's method at the energy of a point leads from this motion to the point.
    fn leads_back(&self, point: usize, x: &[f64], series: RealSeries) -> Result<bool, BranchError> {
        let (own, settings) = (&self.unknowns[point], self.settings_at(point));
        let p = (self.branch.points[point].kinetic_energy / self.grazing.energy).ln();
        let mut problem = periodic(&self.structure, &settings, &self.grazing)?;
        let Some(coarser) = problem.harmonics() else { return Err(BranchError::NotHarmonic) };
        let guess: Vec<f64> = coarser.resized(x, series).into_iter().chain([p]).collect();
        let mut energy = vec![0.0; guess.len()];
        energy[own.len()] = 1.0;
        let found = one_point(&settings, &self.grazing, &mut problem, &guess, &energy, &mut ());
        let size = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
        Ok(found.is_some_and(|(back, _)| {
            let off: Vec<f64> = back.iter().zip(own).map(|(a, b)| a - b).collect();
            size(&off) <= SAME * size(own)
        }))
    }
}
