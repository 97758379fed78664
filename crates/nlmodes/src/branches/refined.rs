//! Points of a branch solved again with more harmonics or more modes: what the numbers change by.

use nlmodes_continuation::RunLog;
use nlmodes_hbm::{CondensedStructure, Grazing, RealSeries};
use nlmodes_modal::ModalPoint;

use super::homotopy::{self, Effort};
use super::periodic::Periodic;
use super::prepare::periodic;
use super::start::one_point;
use super::{BranchError, BranchSettings, ComputedBranch};
use crate::response::FinerSettings;

impl ComputedBranch {
    /// The motion of the averaged kinetic energy of point `point` with `harmonics` harmonics and the held modes of
    /// `structure`: that of the branch, or one with the same contacts and other modes. Newton's method at that energy
    /// leads there from the point, at once or over numbers of harmonics in between; `None` where neither does, or where
    /// it does not lead back from there with the harmonics and modes of the branch: what was found is then another
    /// motion of that energy, on another half-branch.
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
        let own = self.settings_at(point).harmonics;
        FinerSettings::default().reach([own, harmonics], |steps| self.over(point, steps, structure))
    }

    /// From a point over these numbers of harmonics, at its energy.
    fn over(
        &self,
        point: usize,
        steps: &[usize],
        structure: &CondensedStructure,
    ) -> Result<Option<ModalPoint>, BranchError> {
        let own = self.settings_at(point);
        let of_branch = RealSeries { symmetry: own.symmetry, n_harmonics: own.harmonics };
        let (mut x, mut series, mut found) = (self.unknowns[point].clone(), of_branch, None);
        for &harmonics in steps {
            let settings = BranchSettings { harmonics, ..own.clone() };
            let mut problem = periodic(structure, &settings, &self.grazing)?;
            let Some(finer) = problem.harmonics() else { return Err(BranchError::NotHarmonic) };
            let guess = finer.resized(&with(&x, self.energy_of(point)), series);
            let along = self.along(point).map(|along| finer.resized(&with(&along, 0.0), of_branch));
            series = finer.series();
            let (guess, along) = (guess.as_slice(), along.as_deref());
            let corrected = at_energy(&settings, &self.grazing, &mut problem, (guess, along), &mut ()).or_else(|| {
                // A step in between is worth a way of its own.
                let (coordinate, effort) = (guess.len() - 1, Effort::LITTLE);
                let try_it = steps.len() > 1;
                try_it.then(|| homotopy::solve(&mut problem, guess, coordinate, &settings.step, effort, &mut ()))?
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
        let mut problem = periodic(&self.structure, &settings, &self.grazing)?;
        let Some(coarser) = problem.harmonics() else { return Err(BranchError::NotHarmonic) };
        let guess = coarser.resized(&with(x, self.energy_of(point)), series);
        let along = self.along(point).map(|along| with(&along, 0.0));
        let found = at_energy(&settings, &self.grazing, &mut problem, (&guess, along.as_deref()), &mut ());
        Ok(found.is_some_and(|(back, _)| FinerSettings::default().is_same(&back, own)))
    }

    /// The difference of the unknowns of the neighbours of a point, where they have as many.
    fn along(&self, point: usize) -> Option<Vec<f64>> {
        let [before, behind] = [point.saturating_sub(1), (point + 1).min(self.unknowns.len() - 1)];
        let (own, before, behind) = (&self.unknowns[point], &self.unknowns[before], &self.unknowns[behind]);
        let along: Vec<f64> = behind.iter().zip(before).map(|(a, b)| a - b).collect();
        (own.len() == before.len() && own.len() == behind.len() && along.iter().any(|v| *v != 0.0)).then_some(along)
    }
}

/// `(x, p)`.
fn with(x: &[f64], last: f64) -> Vec<f64> {
    x.iter().copied().chain([last]).collect()
}

/// The motion at the energy of a guess `(x, p)` of other harmonics or modes. Newton's method goes first to the motion
/// on the plane across the branch, `along` whose direction the guess is not changed: before a stop much stiffer than
/// the structure the energy of a guess off the equations depends on its forces, and is no guide.
pub(super) fn at_energy(
    settings: &BranchSettings,
    grazing: &Grazing,
    problem: &mut Periodic<'_>,
    (guess, along): (&[f64], Option<&[f64]>),
    log: &mut dyn RunLog,
) -> Option<(Vec<f64>, f64)> {
    let (p, x) = guess.split_last()?;
    let mut solve = |z: &[f64], across: &[f64]| one_point(settings, grazing, problem, z, across, log);
    let next = along.and_then(|along| solve(guess, along));
    let from = next.map_or_else(|| x.to_vec(), |(x, _)| x);
    solve(&with(&from, *p), &with(&vec![0.0; from.len()], 1.0))
}
