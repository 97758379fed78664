use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Linearization, ParametricSystem, Scaling};

use crate::periodic::PeriodicSystem;
use crate::{CondensedStructure, Grazing, HbmError, MixedShootingSettings, Scales};

/// The way to motions before contacts that touch at rest, from the linear mode before contacts that are set back.
///
/// ```text
/// R(x; g₀ + s² o) = 0 ,   E_av = E_ref ,   s from 1 to 0
/// ```
///
/// At a given energy a gap, made smaller, is an energy that grows at a given gap, without end: the solution with the
/// gap zero is where the backbone of any gap leads. `o` is the opening ([`Grazing::opening`](crate::Grazing::opening)),
/// the parameter is `s`, the unknowns are those of [`MixedShooting`](crate::MixedShooting), and the energy is kept at
/// that of the scales. The square keeps stops that face each other apart where a step passes zero. At `s = 1`,
/// [`start`](Self::start) is a solution; at `s = 0` a solution is one of the [`MixedShooting`](crate::MixedShooting)
/// itself at `p = 0`.
pub struct ShrinkingGaps {
    system: PeriodicSystem,
}

impl ShrinkingGaps {
    /// The problem of these settings with each contact standing back by `s²` of `opening`, m, c.
    ///
    /// # Errors
    /// As [`MixedShooting::new`](crate::MixedShooting::new), [`HbmError::Size`] and [`HbmError::NotFinite`].
    pub fn new(
        structure: &CondensedStructure,
        settings: MixedShootingSettings,
        scales: Scales,
        opening: &[f64],
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let system = structure.conservative_mode(settings, scales, solver)?;
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
