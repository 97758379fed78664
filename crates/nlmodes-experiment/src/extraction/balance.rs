//! Forces against the motion: the equation of motion of a linear mode at the fundamental, and the power of all of them.
//!
//! ```text
//! (ω_m² − ω² + 2iζ_m ω_m ω) η_m = φ_m(drive) F − φ_m(stop) F_c          its real part: the force at the stop shifts the frequency
//! ½ Re(F v*) = Σ_k ζ_k ω_k ω² |η_k|² + ½ Re(F_c v_stop*)                 its imaginary part, all modes: power
//! ```

use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use crate::extraction::Finding;
use crate::extraction::scale::likely_unit;
use crate::records::Channel;

/// Factor between the shift of the frequency and the force at the stop that is told.
const SHIFT: f64 = 3.0;
/// Error of a squared eigenfrequency, relative.
const EIGENVALUE: f64 = 0.02;
/// Power of the force over what the damping ratios dissipate that is told: above, where a structure may lose power elsewhere, and below.
const POWER: [f64; 2] = [1.0 / 3.0, 5.0];
/// Error of the phase of the force at the stop, rad.
const PHASE: f64 = 0.01;
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
        let too_large = own.abs() > SHIFT * (shift.abs() + EIGENVALUE);
        let too_small = shift.abs() > 2.0 * EIGENVALUE && own.abs() < (shift.abs() - EIGENVALUE) / SHIFT;
        let factor = own / shift;
        (own.is_finite() && (too_large || too_small)).then(|| Finding::WrongScale {
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
        let [low, high] = POWER;
        let expected = linear + lost;
        let too_much = !self.unknown_contact && power > high * (expected + blurred).max(linear);
        let too_little = power < low * (expected - blurred) && power > 0.0;
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
