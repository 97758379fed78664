//! Points of a branch that have the modal amplitude of another's, to compare their motions.

use nlmodes_hbm::RealSeries;
use nlmodes_modal::{Event, ModalPoint};

use super::prepare::periodic;
use super::start::one_point;
use super::{BranchError, ComputedBranch};

/// Steps of the secants; a few are enough between neighbouring points.
const MAX_STEPS: usize = 40;
/// Relative deviation of the amplitude.
const TOLERANCE: f64 = 1e-9;

/// A solution between the points of a branch.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PointBetween {
    /// The point.
    pub point: ModalPoint,
    /// Its scaled unknowns.
    pub unknowns: Vec<f64>,
}

impl ComputedBranch {
    /// The solution with this modal amplitude (m√kg), found between two neighbouring points of the branch; where the
    /// branch has it several times, that nearest to the angular frequency `near`. `None` if the branch does not reach
    /// it.
    ///
    /// # Errors
    /// [`BranchError`] if the periodic problem cannot be evaluated.
    pub fn at_amplitude(&self, amplitude: f64, near: f64) -> Result<Option<PointBetween>, BranchError> {
        let points = &self.branch.points;
        let off = |k: usize| points[k].modal_amplitude / amplitude - 1.0;
        let brackets = (1..points.len())
            .filter(|&k| off(k - 1) * off(k) <= 0.0 && off(k - 1) != off(k) && !points[k].has_event(Event::Resumed));
        let distance = |k: usize| (0.5 * (points[k - 1].omega + points[k].omega) - near).abs();
        match brackets.min_by(|&a, &b| distance(a).total_cmp(&distance(b))) {
            Some(k) => self.between(k - 1, amplitude, [off(k - 1), off(k)]),
            None => Ok(None),
        }
    }

    /// Regula falsi (Illinois) in the share of the way from point `k` to the next, corrected across it.
    fn between(&self, k: usize, amplitude: f64, ends: [f64; 2]) -> Result<Option<PointBetween>, BranchError> {
        let settings = self.settings_at(k + 1);
        let mut problem = periodic(&self.structure, &settings, &self.grazing)?;
        let ends_with_p = [k, k + 1].map(|k| self.solution(k));
        // The number of harmonics may change between the two.
        let n_harmonics = self.settings_at(k).harmonics;
        let [from, to] = match problem.harmonics() {
            Some(finer) if n_harmonics != settings.harmonics => {
                let series = RealSeries { symmetry: settings.symmetry, n_harmonics };
                let [from, to] = ends_with_p;
                [finer.resized(&from, series), to]
            }
            _ => ends_with_p,
        };
        let way: Vec<f64> = to.iter().zip(&from).map(|(b, a)| b - a).collect();
        let length = way.iter().map(|w| w * w).sum::<f64>().sqrt();
        let direction: Vec<f64> = way.iter().map(|w| w / length).collect();
        let (mut shares, mut off, mut last) = ([0.0, 1.0], ends, None);
        for _ in 0..MAX_STEPS {
            let share = (shares[0] * off[1] - shares[1] * off[0]) / (off[1] - off[0]);
            let guess: Vec<f64> = from.iter().zip(&way).map(|(a, w)| a + share * w).collect();
            let Some((x, _)) = one_point(&settings, &self.grazing, &mut problem, &guess, &direction, &mut ()) else {
                return Ok(None);
            };
            let mut point = problem.modal_point(&x, 0.0)?;
            point.coefficients = point.coefficients.truncated(settings.harmonics);
            let found = point.modal_amplitude / amplitude - 1.0;
            if found.abs() < TOLERANCE {
                return Ok(Some(PointBetween { point, unknowns: x }));
            }
            let end = usize::from((found > 0.0) == (off[1] > 0.0));
            (shares[end], off[end]) = (share, found);
            // An end that stays twice counts half.
            if last == Some(end) {
                off[1 - end] *= 0.5;
            }
            last = Some(end);
        }
        Ok(None)
    }
}
