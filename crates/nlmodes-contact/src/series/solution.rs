use crate::{LcpStatistics, kernel};

/// Forces, gaps and closed contacts of all samples of a [`Series`](crate::Series).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeriesSolution {
    pub(super) c: usize,
    pub(super) lambda: Vec<f64>,
    pub(super) gaps: Vec<f64>,
    pub(super) closed: Vec<bool>,
    pub(super) statistics: Vec<LcpStatistics>,
}

impl SeriesSolution {
    /// Number of samples.
    pub fn n_samples(&self) -> usize {
        self.statistics.len()
    }

    /// Forces λ of a sample (c, N).
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn lambda(&self, sample: usize) -> &[f64] {
        &self.lambda[self.range(sample)]
    }

    /// Gaps g of a sample (c, m).
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn gaps(&self, sample: usize) -> &[f64] {
        &self.gaps[self.range(sample)]
    }

    /// The contacts of a sample that are closed (c).
    ///
    /// # Panics
    /// If there is no such sample.
    pub fn closed(&self, sample: usize) -> &[bool] {
        &self.closed[self.range(sample)]
    }

    /// Cost of each sample.
    pub fn statistics(&self) -> &[LcpStatistics] {
        &self.statistics
    }

    pub(super) fn range(&self, sample: usize) -> std::ops::Range<usize> {
        sample * self.c..(sample + 1) * self.c
    }

    pub(super) fn resize(&mut self, c: usize, samples: usize) {
        self.c = c;
        self.lambda.resize(c * samples, 0.0);
        self.gaps.resize(c * samples, 0.0);
        self.closed.resize(c * samples, false);
        self.statistics.resize(samples, LcpStatistics::default());
    }

    /// Initial guess of a sample: the closed contacts extrapolated from the previous samples, or none.
    pub(super) fn guess(&mut self, sample: usize, previous: bool) {
        let start = sample * self.c;
        match (previous, sample) {
            (true, 2..) => self.extrapolate(sample),
            (true, 1) => self.closed.copy_within(0..self.c, start),
            _ => self.closed[start..start + self.c].fill(false),
        }
    }

    /// Predicts a closed contact if the force of a closed one, or the penetration of an open one, is positive after
    /// linear extrapolation from the previous two samples.
    fn extrapolate(&mut self, sample: usize) {
        let (last, before) = (self.range(sample - 1), self.range(sample - 2));
        let (closed, guess) = self.closed.split_at_mut(sample * self.c);
        let guess = &mut guess[..self.c];
        if !kernel::any(&closed[last.clone()]) {
            // Without forces only the gaps matter, and usually nothing closes.
            let gaps = || self.gaps[last.clone()].iter().zip(&self.gaps[before.clone()]).map(|(g, b)| 2.0 * g - b);
            if gaps().fold(true, |open, gap| open & (gap >= 0.0)) {
                guess.fill(false);
            } else {
                guess.iter_mut().zip(gaps()).for_each(|(guess, gap)| *guess = gap < 0.0);
            }
            return;
        }
        let forces = self.lambda[last.clone()].iter().zip(&self.lambda[before.clone()]);
        let gaps = self.gaps[last.clone()].iter().zip(&self.gaps[before]);
        for (((guess, closed), force), gap) in guess.iter_mut().zip(&closed[last]).zip(forces).zip(gaps) {
            let (force, gap) = (2.0 * force.0 - force.1, 2.0 * gap.0 - gap.1);
            *guess = (*closed & (force > 0.0)) | (!*closed & (gap < 0.0));
        }
    }
}
