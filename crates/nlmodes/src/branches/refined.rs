//! Points of a branch solved again with more harmonics or more modes: what the numbers change by.

use nlmodes_hbm::{CondensedStructure, RealSeries};
use nlmodes_modal::ModalPoint;

use super::homotopy::{self, Effort};
use super::periodic::Periodic;
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
        let of_branch = RealSeries { symmetry: own.symmetry, n_harmonics: own.harmonics };
        let (mut x, mut series, mut found) = (self.unknowns[point].clone(), of_branch, None);
        for &harmonics in steps {
            let settings = BranchSettings { harmonics, ..own.clone() };
            let mut problem = periodic(structure, &settings, &self.grazing)?;
            let Some(finer) = problem.harmonics() else { return Err(BranchError::NotHarmonic) };
            let guess = finer.resized(&x, series);
            let along = self.along(point).map(|along| finer.resized(&along, of_branch));
            series = finer.series();
            let corrected = self.at_energy(point, &settings, &mut problem, (&guess, along)).or_else(|| {
                // A step in between is worth a way of its own.
                let guess: Vec<f64> = guess.into_iter().chain([self.energy_of(point)]).collect();
                let (coordinate, effort) = (guess.len() - 1, Effort::LITTLE);
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
        let mut problem = periodic(&self.structure, &settings, &self.grazing)?;
        let Some(coarser) = problem.harmonics() else { return Err(BranchError::NotHarmonic) };
        let guess = coarser.resized(x, series);
        let found = self.at_energy(point, &settings, &mut problem, (&guess, self.along(point)));
        let size = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
        Ok(found.is_some_and(|(back, _)| {
            let off: Vec<f64> = back.iter().zip(own).map(|(a, b)| a - b).collect();
            size(&off) <= SAME * size(own)
        }))
    }

    /// The motion at the energy of a point next to a guess of other harmonics or modes. Newton's method goes first to
    /// the motion on the plane across the branch, `along` whose direction the guess is not changed: before a stop much
    /// stiffer than the structure the energy of a guess off the equations depends on its forces, and is no guide.
    fn at_energy(
        &self,
        point: usize,
        settings: &BranchSettings,
        problem: &mut Periodic<'_>,
        (guess, along): (&[f64], Option<Vec<f64>>),
    ) -> Option<(Vec<f64>, f64)> {
        let p = self.energy_of(point);
        let with = |x: &[f64], last: f64| -> Vec<f64> { x.iter().copied().chain([last]).collect() };
        let mut solve = |z: &[f64], across: &[f64]| one_point(settings, &self.grazing, problem, z, across, &mut ());
        let next = along.and_then(|along| solve(&with(guess, p), &with(&along, 0.0)));
        let from = next.map_or_else(|| guess.to_vec(), |(x, _)| x);
        solve(&with(&from, p), &with(&vec![0.0; from.len()], 1.0))
    }

    /// The difference of the unknowns of the neighbours of a point, where they have as many.
    fn along(&self, point: usize) -> Option<Vec<f64>> {
        let [before, behind] = [point.saturating_sub(1), (point + 1).min(self.unknowns.len() - 1)];
        let (own, before, behind) = (&self.unknowns[point], &self.unknowns[before], &self.unknowns[behind]);
        let along: Vec<f64> = behind.iter().zip(before).map(|(a, b)| a - b).collect();
        (own.len() == before.len() && own.len() == behind.len() && along.iter().any(|v| *v != 0.0)).then_some(along)
    }
}
