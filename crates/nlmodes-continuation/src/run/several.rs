//! Crossings at which several directions become free at once: `det [J; tᵀ]` need not change its sign.

use super::{Crossing, Run, between};
use crate::corrector::Correction;
use crate::events::Located;
use crate::pencil::Bordered;
use crate::step::reach;
use crate::vectors::along;
use crate::{EventKind, Refusal};

/// Most corrections of the place of such a branch point, and the change that ends them.
const CORRECTIONS: usize = 6;
const SETTLED: f64 = 1e-9;

impl<E: std::error::Error + 'static> Run<'_, '_, E> {
    /// The branch point at these shares of a short step, where the Jacobian becomes singular more than once.
    ///
    /// # Errors
    /// If no other half-branches leave from there, and the step can be shortened: it may have jumped to another curve.
    pub(super) fn several_passed(
        &mut self,
        end: &Correction,
        h: f64,
        border: Option<&Bordered>,
        singular: &[f64],
    ) -> Result<Option<Crossing>, Refusal> {
        if singular.len() < 2 {
            return Ok(None);
        }
        let mean = singular.iter().sum::<f64>() / singular.len() as f64;
        let located = self.singular_point(mean * h, end, h);
        // Where a contact sets in, the Jacobian changes unevenly: it may seem to become singular and be regular all the
        // way.
        let is_singular = self.becomes_singular(&located.point.z, border);
        let choice = if is_singular { self.arms_at(&located, end, h) } else { None };
        match choice {
            Some(choice) => Ok(Some((located, choice))),
            None if h > 10.0 * self.control.limits.min => Err(Refusal::CloseCurves),
            None => Ok(None),
        }
    }

    /// The point next to `s` at which the Jacobian is singular: secant steps in terms of the Jacobian at the base
    /// point.
    fn singular_point(&mut self, mut s: f64, end: &Correction, h: f64) -> Located {
        let mut found = None;
        for _ in 0..CORRECTIONS {
            // The point itself may be out of reach, for the bordered Jacobian is singular there.
            let mut beside = [0.0, -10.0 * SETTLED, 10.0 * SETTLED].into_iter();
            let reached =
                beside.find_map(|d| Some((s + d, reach(self.system, &mut self.corrector, &self.base, s + d).ok()?)));
            let Some((at, c)) = reached else { break };
            let here = self.corrector.border();
            found = Some((at, c));
            let share = here.zip(self.base.border.as_ref()).and_then(|(here, base)| here.nearest_singular(base));
            let Some(next) = share.map(|share| (share * at).clamp(0.0, h)) else { break };
            let moved = (next - at).abs();
            s = next;
            if moved < SETTLED {
                break;
            }
        }
        let kinds = vec![EventKind::BranchPoint];
        if let Some((s, point)) = found {
            return Located { s, kinds, point };
        }
        let z = along(&self.base.z, s, &self.base.tangent);
        let residual = self.corrector.evaluate(self.system, &z).unwrap_or(f64::INFINITY);
        let tangent = between(&self.base.tangent, &end.tangent, s / h);
        Located { s, kinds, point: Correction { z, tangent, residual, iterations: 0, ..end.clone() } }
    }
}
