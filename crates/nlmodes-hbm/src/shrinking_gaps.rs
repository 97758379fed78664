use nlmodes_continuation::{Linearization, ParametricSystem, Scaling};

use crate::{HbmError, MixedShooting};

/// Contacts that stand back from their gaps.
#[derive(Debug, Clone)]
pub(crate) struct Opening {
    /// By how much each contact stands back in full, m, c.
    full: Vec<f64>,
    s: f64,
    /// Derivative of the coefficients of `q_N` by the parameter, m, n_N × width.
    pub dq: Vec<f64>,
}

/// The way to motions before contacts that touch at rest, from the linear mode before contacts that stand back.
///
/// ```text
/// R(x; g₀ + s² o) = 0 ,   E_av = E_ref ,   s from 1 to 0
/// ```
///
/// At a given energy a gap, made smaller, is an energy that grows at a given gap, without end: the solution with the
/// gap zero is where the backbone of any gap leads. `o` is the opening ([`Grazing::opening`](crate::Grazing::opening)),
/// the parameter is `s`, the unknowns are those of [`MixedShooting`], and the energy is kept at that of the scales. The
/// square keeps stops that face each other apart where a step passes zero. At `s = 1`,
/// [`Grazing::unknowns`](crate::Grazing::unknowns) are a solution; at `s = 0` a solution is one of the
/// [`MixedShooting`] itself at `p = 0`.
pub struct ShrinkingGaps<'p, 's> {
    problem: &'p mut MixedShooting<'s>,
}

impl<'s> MixedShooting<'s> {
    /// This problem with each contact standing back by `s²` of `opening`, m, c.
    ///
    /// # Panics
    /// If there are not c of them.
    pub fn shrinking_gaps(&mut self, opening: &[f64]) -> ShrinkingGaps<'_, 's> {
        assert_eq!(opening.len(), self.structure().n_contacts(), "an opening for each contact");
        self.opening = Some(Opening { full: opening.to_vec(), s: 1.0, dq: vec![0.0; self.b.len()] });
        ShrinkingGaps { problem: self }
    }

    /// Adds to `q_N` what the opening of its contacts does: `K_NN⁻¹ W S s² o` while a set is closed.
    pub(crate) fn open_contacts(&mut self) {
        let Some(opening) = &mut self.opening else { return };
        let (structure, series, c) = (self.structure, self.sweep.series, opening.full.len());
        opening.dq.fill(0.0);
        for spectrum in &self.sweep.spectra {
            let set = self.sweep.sets.get(spectrum.set);
            let constant = series.coefficients_of(&spectrum.averages);
            let forces: Vec<f64> = (0..c).map(|i| set.force(i, &opening.full)).collect();
            for (d, dq) in opening.dq.chunks_exact_mut(series.width()).enumerate() {
                let offset: f64 = (0..c).map(|i| structure.body.compliance_w()[(d, i)] * forces[i]).sum();
                dq.iter_mut().zip(&constant).for_each(|(dq, constant)| *dq += offset * constant);
            }
        }
        let s = opening.s;
        let moved = self.q.iter_mut().zip(&mut self.kept).zip(&mut opening.dq);
        moved.for_each(|((q, kept), dq)| {
            *q += s * s * *dq;
            *kept -= s * s * *dq;
            *dq *= 2.0 * s;
        });
    }
}

impl ParametricSystem for ShrinkingGaps<'_, '_> {
    type Error = HbmError;

    fn dim(&self) -> usize {
        self.problem.dim()
    }

    fn linearize(&mut self, x: &[f64], s: f64, out: &mut Linearization) -> Result<(), HbmError> {
        if let Some(opening) = &mut self.problem.opening {
            opening.s = s;
            self.problem.standing_back.iter_mut().zip(&opening.full).for_each(|(o, full)| *o = s * s * full);
        }
        self.problem.linearize(x, 0.0, out)
    }

    fn scaling(&self) -> Option<Scaling> {
        Some(Scaling::unit(self.dim()))
    }

    fn pattern(&self) -> u64 {
        self.problem.pattern()
    }

    fn accepted(&mut self, x: &[f64], _: f64) {
        self.problem.accepted(x, 0.0);
    }
}

impl Drop for ShrinkingGaps<'_, '_> {
    fn drop(&mut self) {
        self.problem.opening = None;
        self.problem.standing_back.fill(0.0);
    }
}
