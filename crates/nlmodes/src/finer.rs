//! Points of a curve solved again with more harmonics, whatever equations they solve: which ones, over which numbers of
//! harmonics, and when what is found is next to them.

use std::collections::HashSet;
use std::time::{Duration, Instant};

use nlmodes_continuation::Watch;

/// How points of a curve are solved again with more harmonics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinerSettings {
    /// How many times as many harmonics. Default 2, which shows the error of series that fall with any power.
    pub factor: usize,
    /// Points that suffice: the first of their order, which begins with those of most interest. Default 6.
    pub enough: usize,
    /// Points that are tried at most. Default 12, twice as many as suffice.
    pub tries: usize,
    /// Wall time, over that of the curve, after which no further point is begun. Default 1.
    pub share_of_curve: f64,
    /// Wall time that is spent where that is less, s. Default 0.5.
    pub least_s: f64,
    /// Numbers of harmonics, evenly spaced, over which the last is reached where Newton's method does not lead there at
    /// once. Default 5.
    pub steps: usize,
    /// Relative distance up to which two solutions of the same equations are one, on the way back from more harmonics.
    /// Default 1e-5, far above the tolerance of Newton's method and far below the distance of neighbouring motions.
    pub same_solution: f64,
    /// Parts of the curve at whose ends points are tried behind the chosen ones. Default 8.
    pub parts: usize,
}

impl Default for FinerSettings {
    fn default() -> Self {
        Self {
            factor: 2,
            enough: 6,
            tries: 12,
            share_of_curve: 1.0,
            least_s: 0.5,
            steps: 5,
            same_solution: 1e-5,
            parts: 8,
        }
    }
}

impl FinerSettings {
    /// What `solve` finds over numbers of harmonics that end with `to`: over that alone, else over some between it and
    /// `from`.
    ///
    /// # Errors
    /// Those of `solve`.
    pub(crate) fn reach<M, E>(
        &self,
        [from, to]: [usize; 2],
        mut solve: impl FnMut(&[usize]) -> Result<Option<M>, E>,
    ) -> Result<Option<M>, E> {
        if let Some(found) = solve(&[to])? {
            return Ok(Some(found));
        }
        let part = |k: usize| from + (to.saturating_sub(from) * k).div_ceil(self.steps);
        let mut steps: Vec<usize> = (1..=self.steps).map(part).collect();
        steps.dedup();
        if steps.last() == Some(&to) && steps.len() > 1 { solve(&steps) } else { Ok(None) }
    }

    /// Whether a solution to which Newton's method leads back is the one that was gone out from.
    pub(crate) fn is_same(&self, back: &[f64], own: &[f64]) -> bool {
        let size = |of: &mut dyn Iterator<Item = f64>| of.map(|v| v * v).sum::<f64>().sqrt();
        let off = size(&mut back.iter().zip(own).map(|(a, b)| a - b));
        off <= self.same_solution * size(&mut own.iter().copied())
    }

    /// The points `first`, and behind them some evenly spaced of `all`, each once.
    pub fn order(&self, first: impl IntoIterator<Item = usize>, all: &[usize]) -> Vec<usize> {
        let others = (0..=self.parts).filter_map(|k| all.get(k * all.len().saturating_sub(1) / self.parts).copied());
        let mut known = HashSet::new();
        first.into_iter().chain(others).filter(|point| known.insert(*point)).collect()
    }

    /// Solves points in this order again until enough are found, the time is spent or `watch` asks to end; the curve
    /// took `time`.
    ///
    /// # Errors
    /// Those of `solve`.
    pub fn each<M, E>(
        &self,
        order: &[usize],
        (time, watch): (Duration, &Watch),
        mut solve: impl FnMut(usize) -> Result<Option<M>, E>,
    ) -> Result<Vec<(usize, Option<M>)>, E> {
        let budget = Duration::from_secs_f64(self.least_s).max(time.mul_f64(self.share_of_curve));
        let (began, mut all) = (Instant::now(), Vec::<(usize, Option<M>)>::new());
        for &point in order.iter().take(self.tries) {
            let found = all.iter().filter(|(_, found)| found.is_some()).count();
            if found >= self.enough || (!all.is_empty() && began.elapsed() > budget) || watch.asks_to_end() {
                break;
            }
            all.push((point, solve(point)?));
        }
        Ok(all)
    }
}
