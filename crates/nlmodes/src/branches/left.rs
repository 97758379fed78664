//! Where a branch goes over to the nonlinear mode of another linear mode.

use std::f64::consts::TAU;

use nlmodes_hbm::Switching;
use nlmodes_modal::{BranchEnd, EndReason, Event, ModalPoint};

use super::BranchPointRule;
use super::branch::ComputedBranch;

/// Relative distance in energy from a corner within which nothing is reported: there the motions on all of its
/// half-branches are alike.
const NEAR: f64 = 0.01;

/// Energy of the other harmonics, over that which the side of an internal-resonance branch would have, below which a
/// point does not lie on that side.
const LITTLE: f64 = 0.1;

/// Where a branch left its nonlinear mode.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LeftMode {
    /// The corner or branch point at which it did.
    pub point: usize,
    /// Whether that is a branch point, at which the rule of the settings chose the way.
    pub at_branch_point: bool,
    /// So many periods of the other mode fill one of the branch.
    pub harmonic: usize,
    /// The linear mode whose nonlinear mode it went over to, where that is known.
    pub mode: Option<usize>,
}

/// Watches a branch for the place where it leaves its mode.
///
/// At the tip of the internal-resonance branch of an n : mode k resonance mode k moves alone, n times a period, and its
/// own nonlinear mode passes there. On the sides of the internal-resonance branch the harmonics that are no multiples
/// of n grow in amplitude like the distance in energy from the tip; along mode k they do not.
#[derive(Debug, Clone, Default)]
pub(super) struct Departure {
    /// Energy of the last corner or branch point.
    corner: Option<f64>,
}

impl Departure {
    /// Whether it is sure at this point, and was not at one before, that the branch has left its mode.
    pub fn is_seen(&mut self, point: &ModalPoint) -> bool {
        if is_corner(point) {
            self.corner = Some(point.kinetic_energy);
            return false;
        }
        let seen = self.corner.is_some_and(|corner| is_alone(point, corner).is_some());
        if seen {
            self.corner = None;
        }
        seen
    }
}

fn is_corner(point: &ModalPoint) -> bool {
    point.has_event(Event::Kink) || point.has_event(Event::BranchPoint)
}

/// The harmonic whose multiples move alone at a point, seen from a corner with this energy.
fn is_alone(point: &ModalPoint, corner: f64) -> Option<usize> {
    let (harmonic, _) = point.largest_higher_harmonic()?;
    let away = (point.kinetic_energy / corner - 1.0).abs();
    let total: f64 = point.harmonic_energy.iter().sum();
    let others = point.harmonic_energy.iter().enumerate().filter(|(n, _)| n % harmonic != 0);
    let others: f64 = others.map(|(_, energy)| energy).sum();
    let beside = (away / (2.0 * harmonic as f64)).powi(2);
    (away > NEAR && others < LITTLE * beside * total).then_some(harmonic)
}

impl ComputedBranch {
    /// Where the branch left its nonlinear mode for good, if it did.
    pub fn left_mode(&self) -> Option<LeftMode> {
        let points = &self.branch.points;
        let sure = points.iter().rposition(|point| point.has_event(Event::OtherMode))?;
        let point = points[..sure].iter().rposition(is_corner)?;
        let harmonic = is_alone(points.last()?, points[point].kinetic_energy)?;
        let resonance = points[point..].iter().filter_map(|p| p.resonance).find(|found| found.harmonic == harmonic);
        let at_branch_point = points[point].has_event(Event::BranchPoint);
        Some(LeftMode { point, at_branch_point, harmonic, mode: resonance.map(|found| found.mode) })
    }

    /// A branch that has left its mode says so at its end, and is not complete where samples took it there.
    pub(super) fn review_departure(&mut self) {
        let Some(left) = self.left_mode() else { return };
        let at = &self.branch.points[left.point];
        let other = left.mode.map_or_else(|| "another mode".to_owned(), |mode| format!("that of mode {mode}"));
        let advice = match self.settings.switching {
            Switching::Sampled { samples } if !left.at_branch_point => {
                format!(": {samples} samples part half-branches that meet there, exact switching joins them")
            }
            _ => String::new(),
        };
        let BranchEnd { reasons, message, complete } = &mut self.branch.end;
        *message += &format!(
            ", but not on the nonlinear mode {own}: at point {point} ({hz:.4} Hz, {energy:.4} {word} energies) the \
                branch left it for {other}, \
             {harmonic} periods of which fill one here{advice}",
            harmonic = left.harmonic,
            own = self.settings.mode,
            word = self.grazing.word(),
            point = left.point,
            hz = at.omega / TAU,
            energy = at.kinetic_energy / self.grazing.energy,
        );
        let chosen = left.at_branch_point || self.settings.at_branch_point != BranchPointRule::Stay;
        let sampled = matches!(self.settings.switching, Switching::Sampled { .. });
        if *complete && !chosen && sampled {
            (*reasons, *complete) = (vec![EndReason::OtherMode], false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes_modal::HarmonicCoefficients;

    /// A point whose third harmonic has all of the energy but this share, `away` from an energy of `unit`.
    fn point(away: f64, others: f64, unit: f64, event: Option<Event>) -> ModalPoint {
        let energy = unit * (1.0 + away);
        ModalPoint {
            omega: 1.0,
            coefficients: HarmonicCoefficients::zeros(1, 3),
            kinetic_energy: energy,
            harmonic_energy: vec![0.0, others * energy, 0.0, (1.0 - others) * energy],
            total_energy: 2.0 * energy,
            modal_amplitude: 1.0,
            fundamental: 1.0,
            peak: 1.0,
            events: event.into_iter().collect(),
            ..ModalPoint::default()
        }
    }

    #[test]
    fn the_other_side_of_a_tongue_is_no_departure_and_the_mode_itself_is_one_in_any_unit() {
        for unit in [1.0, 1e-9, 1e9] {
            for event in [Event::Kink, Event::BranchPoint] {
                let (mut back, mut on) = (Departure::default(), Departure::default());
                assert!(!back.is_seen(&point(0.0, 0.0, unit, Some(event))));
                assert!(!on.is_seen(&point(0.0, 0.0, unit, Some(event))));
                let seen: Vec<bool> = [0.001, 0.02, 0.05, 0.5]
                    .iter()
                    .map(|&away| {
                        // On the loop of the rod the fundamental is half as large as the distance in energy.
                        assert!(!back.is_seen(&point(-away, (away / 6.0).powi(2), unit, None)), "{away}");
                        on.is_seen(&point(away, 1e-8, unit, None))
                    })
                    .collect();
                // It is reported once.
                assert_eq!(seen, [false, true, false, false]);
            }
        }
    }

    #[test]
    fn without_a_corner_nothing_is_left() {
        let mut departure = Departure::default();
        assert!([0.1, 0.5, 2.0].iter().all(|&away| !departure.is_seen(&point(away, 0.0, 1.0, None))));
    }
}
