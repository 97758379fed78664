//! A branch that comes back to grazing and goes on without contact.

use std::f64::consts::TAU;

use nlmodes_modal::{BranchEnd, EndReason, ModalPoint};

use super::branch::ComputedBranch;
use super::{BranchPointRule, BranchStart};

impl ComputedBranch {
    /// A branch from grazing that ends on its linear mode says so, and is not complete: it was to lead to motions with
    /// contact, and what lies beyond the place where it turned was not found.
    pub(super) fn review_return(&mut self) {
        let is_asked_for = self.origin.is_some() || self.settings.at_branch_point == BranchPointRule::All;
        if self.settings.start != BranchStart::Grazing || is_asked_for {
            return;
        }
        let mode = self.settings.mode;
        let (grazing, word) = (self.grazing.energy, self.grazing.word());
        let without = if self.grazing.lifts_off { "no stop opens" } else { "without contact" };
        let BranchEnd { reasons, message, complete } = &mut self.branch.end;
        if !reasons.contains(&EndReason::MinEnergy) {
            return;
        }
        let Some(Return { at, highest }) = returned(&self.branch.points) else { return };
        let [at, highest] = [at, highest].map(|point| (point, &self.branch.points[point]));
        *complete = false;
        *message += &format!(
            ": at point {} the branch came back to {word}, and went on along the linear mode {mode}, {without}; at \
            most, at point {} ({:.4} Hz), it had {:.4} {word} energies, and what lies beyond that was not found",
            at.0,
            highest.0,
            highest.1.omega / TAU,
            highest.1.kinetic_energy / grazing,
        );
    }
}

/// Where a branch lost its last contact, and the point with most energy before.
#[derive(Debug, PartialEq)]
struct Return {
    at: usize,
    highest: usize,
}

/// The return of a branch that ends without contact; none where it never had one, or still has.
fn returned(points: &[ModalPoint]) -> Option<Return> {
    let touches = |point: &ModalPoint| point.contact_intervals > 0;
    let last = points.iter().rposition(touches)?;
    let highest = (0..=last).max_by(|&i, &j| points[i].kinetic_energy.total_cmp(&points[j].kinetic_energy))?;
    (last + 1 < points.len()).then_some(Return { at: last + 1, highest })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes_modal::HarmonicCoefficients;

    fn point((kinetic_energy, contact_intervals): (f64, usize)) -> ModalPoint {
        ModalPoint {
            omega: TAU,
            coefficients: HarmonicCoefficients::zeros(1, 1),
            kinetic_energy,
            total_energy: 2.0 * kinetic_energy,
            modal_amplitude: 1.0,
            fundamental: 1.0,
            peak: 1.0,
            contact_intervals,
            ..ModalPoint::default()
        }
    }

    #[test]
    fn a_branch_returns_where_its_last_contact_opens_for_good() {
        let of = |points: &[(f64, usize)]| returned(&points.iter().copied().map(point).collect::<Vec<_>>());
        // Up, without contact for one point, up again, and back to grazing.
        let back = of(&[(1.0, 0), (1.1, 1), (1.05, 0), (1.3, 2), (1.02, 1), (1.0, 0), (0.4, 0)]);
        assert_eq!(back, Some(Return { at: 5, highest: 3 }));
        // The loop of the rod dips below grazing with contact; a linear mode never had any.
        assert_eq!(of(&[(1.0, 0), (9.0, 1), (0.9, 1)]), None);
        assert_eq!(of(&[(1.0, 0), (0.5, 0)]), None);
    }
}
