//! Forces against the motion: the equation of motion of a linear mode at the fundamental, and the power of all of them.
//!
//! ```text
//! (ω_m² − ω² + 2iζ_m ω_m ω) η_m = φ_m(drive) F − φ_m(stop) F_c          real part: the stop shifts the frequency
//! ½ Re(F v*) = Σ_k ζ_k ω_k ω² |η_k|² + ½ Re(F_c v_stop*)                 its imaginary part, all modes: power
//! ```

use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use crate::extraction::Finding;
use crate::extraction::scale::likely_unit;
use crate::records::Channel;

/// Factor between the shift of the frequency and the force at the stop that is reported.
const SHIFT: f64 = 1.3;
/// Standard error of a squared eigenfrequency, relative.
const EIGENVALUE: f64 = 0.004;
/// Standard errors that the difference must have.
const SIGNIFICANT: f64 = 3.0;
/// Relative error up to which a factor is one.
const KNOWN: f64 = 0.5;
/// Power of the force over what damping ratios and stop take that is reported, above it and below its inverse.
const POWER: f64 = 1.7;
/// Error of the phase of the force at the stop, rad.
const PHASE: f64 = 0.02;
/// Logarithm by which a factor from damping may be off.
const DAMPING_SPREAD: f64 = 0.15;

/// The fundamentals that must balance.
#[derive(Debug)]
pub struct Balance<'a> {
    pub modes: &'a LinearModes,
    /// Modal coordinates, m·√kg.
    pub modal: Vec<Complex64>,
    pub omega: f64,
    /// The excitation: its channel, and the power that it brings in, W, with its standard error.
    pub force: Option<(&'a Channel, [f64; 2])>,
    /// The force at the stop along the coordinate, N, its channel, and the row of the modes there.
    pub contact: Option<(&'a Channel, Complex64, usize)>,
    /// Whether there may be a force at the stop that was not measured.
    pub unknown_contact: bool,
}

impl Balance<'_> {
    /// Reports a force at the stop or an excitation that does not fit the motion.
    pub fn report(&self, findings: &mut Vec<Finding>) {
        let before = findings.len();
        findings.extend(self.contact_scale());
        if findings.len() == before {
            findings.extend(self.force_scale());
        }
    }

    /// The force at the stop against the shift of the frequency from that of the nearest linear mode.
    fn contact_scale(&self) -> Option<Finding> {
        let (channel, force, row) = self.contact?;
        let distance = |omega: f64| (omega / self.omega).ln().abs();
        let omegas = self.modes.omegas();
        let m = (0..omegas.len()).min_by(|a, b| distance(omegas[*a]).total_cmp(&distance(omegas[*b])))?;
        let shift = (self.omega / omegas[m]).powi(2) - 1.0;
        let own = (self.modes.shape(row, m) * force / self.modal[m]).re / omegas[m].powi(2);
        let factor = own / shift;
        let is_off = (own - shift).abs() > SIGNIFICANT * EIGENVALUE && !(SHIFT.recip()..SHIFT).contains(&factor);
        let is_known = EIGENVALUE < KNOWN * shift.abs();
        (own.is_finite() && is_off && is_known).then(|| Finding::WrongScale {
            channel: channel.name.clone(),
            factor,
            uncertainty: factor.abs() * EIGENVALUE / shift.abs(),
            against: format!("the shift of the frequency from that of linear mode {}", m + 1),
            declared: channel.unit.clone(),
            likely: likely_unit(channel, factor, EIGENVALUE / shift.abs()),
            alternatives: vec!["all motion channels, by the inverse".into()],
        })
    }

    /// The power of the excitation against that of damping and stop.
    fn force_scale(&self) -> Option<Finding> {
        let (channel, [power, error]) = self.force?;
        let rates = self.modes.omegas().iter().zip(self.modes.damping_ratios()).zip(&self.modal);
        let linear: f64 = rates.map(|((omega, zeta), eta)| zeta * omega * self.omega.powi(2) * eta.norm_sqr()).sum();
        let (lost, blurred) = self.contact.map_or((0.0, 0.0), |(_, force, row)| {
            let motion: Complex64 = (0..self.modal.len()).map(|k| self.modal[k] * self.modes.shape(row, k)).sum();
            let apparent = 0.5 * force * (Complex64::new(0.0, self.omega) * motion).conj();
            (apparent.re, PHASE * apparent.norm())
        });
        let expected = linear + lost;
        let too_much = !self.unknown_contact && power > POWER * (expected + blurred).max(linear);
        let too_little = power < (expected - blurred) / POWER && power > 0.0;
        let factor = power / expected.max(linear);
        (linear > 0.0 && factor.is_finite() && (too_much || too_little)).then(|| Finding::WrongScale {
            channel: channel.name.clone(),
            factor,
            uncertainty: error / expected.max(linear),
            against: "the power that the damping ratios of the linear modes dissipate".into(),
            declared: channel.unit.clone(),
            likely: likely_unit(channel, factor, DAMPING_SPREAD),
            alternatives: vec![
                "all motion channels, by the inverse".into(),
                "the damping ratios or the scale of the linear modes".into(),
            ],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::{Quantity, Role};

    /// A mode of 100 rad/s and 1 %, in resonance or beside it, whose force at the stop and power are those of the
    /// equation of motion, times the given factors.
    fn factors(
        omega: f64,
        size: f64,
        contact: Option<f64>,
        force: f64,
        unknown_contact: bool,
    ) -> Vec<(String, f64, f64)> {
        let (own, zeta, shape) = (100.0_f64, 0.01, 2.0);
        let modes = LinearModes::new(&[0.3], &[own], &[zeta], &[vec![shape]]).unwrap();
        let eta = Complex64::new(size, 0.0);
        let (drive, stop) = (
            Channel::new("drive", Quantity::Force, Role::Excitation, None),
            Channel::new("stop", Quantity::Force, Role::Contact, None),
        );
        let at_stop = eta * ((omega / own).powi(2) - 1.0) * own * own / shape;
        let power = zeta * own * omega * omega * size * size;
        let balance = Balance {
            modes: &modes,
            modal: vec![eta],
            omega,
            force: Some((&drive, [force * power, 0.1 * force * power])),
            contact: contact.map(|factor| (&stop, factor * at_stop, 0)),
            unknown_contact,
        };
        let mut findings = vec![];
        balance.report(&mut findings);
        let number = |finding: Finding| match finding {
            Finding::WrongScale { channel, factor, uncertainty, .. } => (channel, factor, uncertainty),
            other => panic!("{other}"),
        };
        findings.into_iter().map(number).collect()
    }

    fn is(found: &[(String, f64, f64)], channel: &str, factor: f64, uncertainty: f64) -> bool {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        matches!(found, [(name, f, u)] if name == channel && near(*f, factor) && near(*u, uncertainty))
    }

    /// For motions of metres and of micrometres.
    #[test]
    fn forces_that_balance_are_sound_and_others_have_their_factor() {
        for size in [1.0, 1e-6] {
            for contact in [None, Some(1.0)] {
                for force in [0.65, 1.0, 1.5] {
                    assert!(factors(120.0, size, contact, force, false).is_empty(), "{size} {contact:?} {force}");
                }
                for force in [0.01, 0.25, 4.448, 10.0, 1e3] {
                    let found = factors(120.0, size, contact, force, false);
                    assert!(is(&found, "drive", force, 0.1 * force), "{size} {contact:?} {force}: {found:?}");
                }
            }
            for force in [0.5, 2.0] {
                assert!(is(&factors(100.0, size, None, force, false), "drive", force, 0.1 * force), "{size} {force}");
            }
            assert!(factors(120.0, size, None, 10.0, true).is_empty(), "the stop may take the power");
            assert!(is(&factors(120.0, size, None, 0.01, true), "drive", 0.01, 0.001));
            // A shift of 0.44 of the squared frequency, known to 0.004.
            for contact in [0.01, 0.25, 0.5, 2.0, 4.448, 1e3] {
                let found = factors(120.0, size, Some(contact), 1.0, false);
                assert!(is(&found, "stop", contact, contact * 0.004 / 0.44), "{size} {contact}: {found:?}");
            }
            for contact in [0.8, 1.25] {
                assert!(factors(120.0, size, Some(contact), 1.0, false).is_empty(), "{size} {contact}");
            }
            // Beside the mode's own frequency the shift is within its error.
            assert!(factors(100.5, size, Some(2.0), 1.0, false).is_empty());
            assert!(factors(100.5, size, Some(0.0), 1.0, false).is_empty());
            // Three times its error is reported: 0.0115 of the squared frequency is less, 0.0131 more.
            assert!(factors(100.6, size, Some(0.05), 1.0, false).is_empty());
            assert_eq!(factors(100.7, size, Some(0.05), 1.0, false).len(), 1);
        }
    }

    #[test]
    fn what_the_stop_takes_is_part_of_the_power() {
        let (own, zeta, omega) = (100.0_f64, 0.001, 110.0_f64);
        let modes = LinearModes::new(&[0.3], &[own], &[zeta], &[vec![1.0]]).unwrap();
        let eta = Complex64::new(1e-3, 0.0);
        let linear = zeta * own * omega.powi(2) * eta.norm_sqr();
        let (drive, stop) = (
            Channel::new("drive", Quantity::Force, Role::Excitation, None),
            Channel::new("stop", Quantity::Force, Role::Contact, None),
        );
        // The stop takes nineteen times what the mode does: ½ Re(F_c v*), v = iωη.
        let lost = 19.0 * linear;
        let at_stop = Complex64::new(0.21 * own * own * eta.re, 2.0 * lost / (omega * eta.re));
        let found = |power: f64| {
            let mut findings = vec![];
            let force = Some((&drive, [power, 0.0]));
            let contact = Some((&stop, at_stop, 0));
            Balance { modes: &modes, modal: vec![eta], omega, force, contact, unknown_contact: false }
                .report(&mut findings);
            findings.len()
        };
        assert_eq!([linear, 20.0 * linear, 30.0 * linear, 150.0 * linear].map(found), [1, 0, 0, 1]);
    }
}
