use nlmodes_continuation::{Linearization, ParametricSystem, Scaling};

use crate::periodic::PeriodicSystem;
use crate::{Grazing, HbmError};

/// The way to motions before contacts that touch at rest, from the linear mode before contacts that are set back.
///
/// ```text
/// R(x; g₀ + s² o) = 0 ,   E_av = E_ref ,   s from 1 to 0
/// ```
///
/// At a given energy a gap, made smaller, is an energy that grows at a given gap, without end: the solution with the
/// gap zero is where the backbone of any gap leads. `o` is the opening ([`Grazing::opening`](crate::Grazing::opening)),
/// the parameter is `s`, the unknowns are those of the problem, whose own parameter is zero. The square keeps stops
/// that face each other apart where a step passes zero. At `s = 1`, [`start`](Self::start) is a solution of a
/// conservative mode; at `s = 0` a solution is one of the problem itself.
pub struct ShrinkingGaps {
    system: PeriodicSystem,
}

impl ShrinkingGaps {
    /// This problem with each contact standing back by `s²` of `opening`, m, c.
    ///
    /// # Errors
    /// [`HbmError::Size`] and [`HbmError::NotFinite`].
    pub fn new(system: PeriodicSystem, opening: &[f64]) -> Result<Self, HbmError> {
        Ok(Self { system: system.beside_opening(opening.to_vec())? })
    }

    /// The unknowns of the linear mode before contacts that are set back, a solution at `s = 1`.
    pub fn start(&self, grazing: &Grazing) -> Vec<f64> {
        grazing.unknowns(&self.system)
    }
}

impl ParametricSystem for ShrinkingGaps {
    type Error = HbmError;

    fn dim(&self) -> usize {
        self.system.dim()
    }

    fn linearize(&mut self, x: &[f64], s: f64, out: &mut Linearization) -> Result<(), HbmError> {
        self.system.linearize(x, s * s, out)?;
        let parameter = self.dim();
        out.jacobian.col_mut(parameter).iter_mut().for_each(|by| *by *= 2.0 * s);
        Ok(())
    }

    fn scaling(&self) -> Option<Scaling> {
        self.system.scaling()
    }

    fn pattern(&self) -> u64 {
        self.system.pattern()
    }

    fn accepted(&mut self, x: &[f64], s: f64) {
        self.system.accepted(x, s * s);
    }
}
