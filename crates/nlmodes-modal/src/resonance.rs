use std::fmt;

use crate::{Event, HarmonicCoefficients, ModalPoint};

/// A harmonic above the first is resonant if it has at least this share of the averaged kinetic energy.
pub const RESONANT_SHARE: f64 = 0.25;

/// Largest relative distance of `nω` from an eigenfrequency that a resonance may have: the frequency of a strongly
/// excited mode shifts by its own contacts.
pub const DETUNING: f64 = 0.05;

/// An internal resonance `n : mode k`: harmonic n of the motion excites linear mode k.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct InternalResonance {
    /// Harmonic n, from 2.
    pub harmonic: usize,
    /// Number k of the linear mode, from 1.
    pub mode: usize,
}

impl InternalResonance {
    /// The resonance of harmonic `harmonic`, at this angular frequency (rad/s), with one of the linear modes of angular
    /// frequencies `omega`: of those within [`DETUNING`] the one with the largest coordinate in this harmonic. `modal`
    /// gives the modal coordinates of the motion, modes × (H + 1), where any mode is near.
    pub fn of_harmonic(
        harmonic: usize,
        frequency: f64,
        omega: &[f64],
        modal: impl FnOnce() -> Option<HarmonicCoefficients>,
    ) -> Option<Self> {
        let near: Vec<usize> = (0..omega.len()).filter(|&k| (frequency / omega[k] - 1.0).abs() < DETUNING).collect();
        if near.is_empty() {
            return None;
        }
        let modal = modal()?;
        let size = |k: usize| modal.of(k)[harmonic].norm_sqr();
        let mode = near.into_iter().max_by(|&i, &j| size(i).total_cmp(&size(j)))?;
        Some(Self { harmonic, mode: mode + 1 })
    }
}

impl fmt::Display for InternalResonance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:mode {}", self.harmonic, self.mode)
    }
}

/// An internal-resonance branch: the segment of a branch on which an internal resonance has at least [`RESONANT_SHARE`]
/// of the kinetic energy.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Tongue {
    /// The resonance.
    pub resonance: InternalResonance,
    /// Index of its first point.
    pub start: usize,
    /// Index of its point with the largest share of the kinetic energy in the resonant harmonic.
    pub tip: usize,
    /// Index of its last point; `None` if the branch ends within it.
    pub end: Option<usize>,
    /// Least and largest averaged kinetic energy on it, J.
    pub energy: [f64; 2],
    /// Whether it was skipped: then `start` and `end` are the points of the branch on both sides of it.
    pub skipped: bool,
}

/// The internal-resonance branches in the order of the points.
pub fn tongues(points: &[ModalPoint]) -> Vec<Tongue> {
    let mut found = Vec::new();
    let mut start = 0;
    while start < points.len() {
        let Some(resonance) = points[start].resonance else {
            start += 1;
            continue;
        };
        let last =
            (start..points.len()).take_while(|&i| points[i].resonance == Some(resonance)).last().unwrap_or(start);
        found.extend(tongue(points, resonance, start, last));
        start = last + 1;
    }
    found
}

/// The internal-resonance branch on the points from `start` to `last`, which all have its resonance; `None` for the
/// base point of one that was skipped if no point follows.
fn tongue(points: &[ModalPoint], resonance: InternalResonance, start: usize, last: usize) -> Option<Tongue> {
    let stretch = start..=last;
    let skipped = stretch.clone().any(|i| points[i].has_event(Event::Resumed));
    let share = |i: usize| points[i].harmonic_share(resonance.harmonic);
    let tip = stretch.clone().max_by(|&i, &j| share(i).total_cmp(&share(j)))?;
    let energies = || stretch.clone().map(|i| points[i].kinetic_energy);
    let (least, largest) = (energies().fold(f64::INFINITY, f64::min), energies().fold(0.0, f64::max));
    let ended = last + 1 < points.len() || skipped;
    Some(Tongue { resonance, start, tip, end: ended.then_some(last), energy: [least, largest], skipped })
}

impl ModalPoint {
    /// The integral of all contact forces over a period, N·s; `None` if no contact is known.
    pub fn impulse(&self) -> Option<f64> {
        (!self.contacts.is_empty()).then(|| self.contacts.iter().map(|contact| contact.impulse).sum())
    }

    /// Whether this event happens here.
    pub fn has_event(&self, event: Event) -> bool {
        self.events.contains(&event)
    }

    /// Whether the linear mode ends here, since a stop is touched or left.
    pub fn leaves_linear_mode(&self) -> bool {
        self.has_event(Event::Grazing) || self.has_event(Event::LiftOff)
    }

    /// Share of harmonic `n` in the averaged kinetic energy; zero for harmonics beyond the highest.
    pub fn harmonic_share(&self, n: usize) -> f64 {
        let total: f64 = self.harmonic_energy.iter().sum();
        self.harmonic_energy.get(n).map_or(0.0, |energy| energy / total.max(f64::MIN_POSITIVE))
    }

    /// The harmonic above the first, or above that of the load, with the largest share of the kinetic energy, and that
    /// share.
    pub fn largest_higher_harmonic(&self) -> Option<(usize, f64)> {
        let of_load = ((self.listed_omega() / self.omega).round() as usize).max(1);
        let higher = (of_load + 1..self.harmonic_energy.len()).map(|n| (n, self.harmonic_share(n)));
        higher.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The harmonic by which the motion may take part in an internal resonance: the largest higher one, where it has a
    /// share of [`RESONANT_SHARE`].
    pub fn resonant_harmonic(&self) -> Option<usize> {
        self.largest_higher_harmonic().filter(|(_, share)| *share >= RESONANT_SHARE).map(|(harmonic, _)| harmonic)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HarmonicCoefficients;

    /// A point with this share of the energy in harmonic 3.
    fn point(share: f64, energy: f64, events: &[Event]) -> ModalPoint {
        let resonance = (share >= RESONANT_SHARE).then_some(InternalResonance { harmonic: 3, mode: 2 });
        ModalPoint {
            omega: 1.0,
            coefficients: HarmonicCoefficients::zeros(1, 3),
            kinetic_energy: energy,
            harmonic_energy: vec![0.0, energy * (1.0 - share), 0.0, energy * share],
            resonance,
            total_energy: 2.0 * energy,
            modal_amplitude: 1.0,
            fundamental: 1.0,
            peak: 1.0,
            events: events.to_vec(),
            ..ModalPoint::default()
        }
    }

    #[test]
    fn the_impulse_of_a_point_is_that_of_all_its_contacts() {
        let mut at = point(0.0, 1.0, &[]);
        assert_eq!(at.impulse(), None, "no contact is known");
        let contact = |impulse: f64| crate::ContactPeriod {
            closed_share: 0.1,
            peak_force: 3.0,
            mean_force: 0.5 * impulse,
            impulse,
            touches: 1,
            approach_velocity: 0.2,
            sliding: None,
        };
        at.contacts = vec![contact(0.25), contact(0.0), contact(1.5)];
        assert_eq!(at.impulse(), Some(1.75));
    }

    #[test]
    fn a_tongue_has_start_tip_end_and_energies() {
        let shares = [0.0, 0.1, 0.3, 0.9, 1.0, 0.8, 0.25, 0.1];
        let points: Vec<ModalPoint> =
            shares.iter().enumerate().map(|(i, s)| point(*s, 1.0 + if i == 5 { 9.0 } else { i as f64 }, &[])).collect();
        let found = tongues(&points);
        assert_eq!(found.len(), 1);
        let tongue = &found[0];
        assert_eq!((tongue.start, tongue.tip, tongue.end, tongue.energy), (2, 4, Some(6), [3.0, 10.0]));
        assert_eq!(tongue.resonance.to_string(), "3:mode 2");
        assert!(!tongue.skipped);
        assert_eq!(tongues(&points[..5])[0].end, None);
        assert_eq!(points[3].largest_higher_harmonic().map(|(n, _)| n), Some(3));
        assert!((points[3].harmonic_share(3) - 0.9).abs() < 1e-15 && points[3].harmonic_share(7) == 0.0);
    }

    #[test]
    fn a_tongue_may_begin_anywhere_and_have_any_energy() {
        for before in 0..4 {
            for unit in [1.0, 1e-6] {
                let shares = std::iter::repeat_n(0.0, before).chain([0.5, 0.9, 0.5, 0.0]);
                let points: Vec<ModalPoint> =
                    shares.enumerate().map(|(i, s)| point(s, (1 + i) as f64 * unit, &[])).collect();
                let found = tongues(&points);
                let energy = [(1 + before) as f64 * unit, (3 + before) as f64 * unit];
                assert_eq!(found.len(), 1, "{before}");
                assert_eq!((found[0].start, found[0].tip, found[0].energy), (before, before + 1, energy));
            }
        }
    }

    #[test]
    fn two_tongues_may_lie_next_to_each_other() {
        let mut points = vec![point(0.5, 1.0, &[]), point(0.9, 2.0, &[]), point(0.5, 3.0, &[]), point(0.0, 4.0, &[])];
        points[2].resonance = Some(InternalResonance { harmonic: 2, mode: 3 });
        let found = tongues(&points);
        let ends: Vec<_> = found.iter().map(|tongue| (tongue.resonance.mode, tongue.start, tongue.end)).collect();
        assert_eq!(ends, [(2, 0, Some(1)), (3, 2, Some(2))]);
    }

    #[test]
    fn a_skipped_tongue_has_its_two_feet() {
        let mut points =
            vec![point(0.0, 1.0, &[]), point(0.05, 2.0, &[Event::TongueFoot]), point(0.1, 3.0, &[Event::Resumed])];
        for foot in &mut points[1..] {
            foot.resonance = Some(InternalResonance { harmonic: 3, mode: 2 });
        }
        points.push(point(0.05, 4.0, &[]));
        let found = tongues(&points);
        assert_eq!(found.len(), 1);
        assert!(found[0].skipped && found[0].start == 1 && found[0].end == Some(2));
    }
}
