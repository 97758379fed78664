//! From motions in open modes to modal points of a branch, which tables and page share with other computations.

use std::f64::consts::TAU;

use nlmodes::hbm::{ContactMotion, ResponseRow};
use nlmodes::modal::{BranchEnd, ContactPeriod, EndReason, HarmonicCoefficients, ModalBranch, ModalPoint, Stability};
use nlmodes::response::{ResponseError, ResponsePoint};
use nlmodes_scene::scene::Scene;
use num_complex::Complex64;

use super::curves::ComputedResponse;
use super::model::Model;

/// What turns points of curves into displacements.
pub struct Converter<'a> {
    model: &'a Model,
    rows: Vec<ResponseRow>,
    contacts: Vec<ResponseRow>,
}

impl<'a> Converter<'a> {
    pub fn new(model: &'a Model) -> Result<Self, ResponseError> {
        let response = model.response();
        let (rows, contacts) = (response.rows_of_dofs(&model.recorded)?, response.rows(&model.contacts)?);
        Ok(Self { model, rows, contacts })
    }

    /// The curve as a branch.
    pub fn branch(&self, scene: &Scene, computed: &ComputedResponse) -> ModalBranch {
        let subharmonic = scene.responses[computed.response].subharmonic;
        let point = |point: &ResponsePoint| self.point(point, computed.is_forced(), subharmonic);
        let complete = computed.is_complete();
        let reason = computed.curve.as_ref().map_or(EndReason::NoStart, |curve| curve.end.reason());
        ModalBranch {
            label: computed.name.clone(),
            coordinates: self.model.coordinates.clone(),
            contact_coordinate: self.model.contact_coordinates.first().copied().flatten(),
            stop: self.model.sides.first().zip(self.model.gaps.first()).map(|(side, gap)| side * gap),
            points: computed.points().iter().map(point).collect(),
            end: BranchEnd::new(reason, computed.message.clone(), complete),
        }
    }

    fn point(&self, point: &ResponsePoint, is_forced: bool, subharmonic: usize) -> ModalPoint {
        let motion = &point.motion;
        let displacement = |row: &ResponseRow| self.model.response().displacement(row, motion, subharmonic);
        let mut coefficients = HarmonicCoefficients::zeros(self.rows.len(), motion.eta.len() - 1);
        for (d, row) in self.rows.iter().enumerate() {
            coefficients.of_mut(d).copy_from_slice(&displacement(row));
        }
        let share = |(n, eta): (usize, &Vec<Complex64>)| {
            let nu = n as f64 * motion.at.omega;
            0.25 * nu * nu * eta.iter().map(|e| e.norm_sqr()).sum::<f64>()
        };
        let first = motion.contacts.first();
        let judged = |s: nlmodes::response::Stability| {
            Some(Stability { stable: s.stable?, largest_multiplier: [s.largest.re, s.largest.im] })
        };
        ModalPoint {
            omega: motion.at.omega,
            coefficients,
            kinetic_energy: motion.kinetic_energy,
            harmonic_energy: motion.eta.iter().enumerate().map(share).collect(),
            resonance: None,
            stability: point.stability.and_then(judged),
            total_energy: motion.total_energy,
            modal_amplitude: motion.modal_amplitude(),
            fundamental: self.fundamental(point, is_forced, subharmonic),
            peak: first.map_or(f64::NAN, |c| c.peak),
            contact_fraction: first.map_or(f64::NAN, |c| c.closed_share),
            contact_intervals: motion.contacts.iter().map(|c| c.touches).sum(),
            peak_contact_force: motion.contacts.iter().map(|c| c.peak_force).fold(0.0, f64::max),
            contacts: motion.contacts.iter().map(|c| period(c, motion.at.omega)).collect(),
            residual: point.residual,
            error_estimate: None,
            events: point.events.clone(),
        }
    }

    /// Amplitude of the first contact at the frequency of the load, m; of a free motion with the sign of its
    /// displacement at the phase zero.
    pub fn fundamental(&self, point: &ResponsePoint, is_forced: bool, subharmonic: usize) -> f64 {
        let Some(row) = self.contacts.first() else { return f64::NAN };
        let q = self.model.response().displacement(row, &point.motion, subharmonic);
        let z = q.get(subharmonic).copied().unwrap_or_default();
        let side = self.model.sides.first().copied().unwrap_or(1.0);
        if is_forced { z.norm() } else { z.norm() * side * z.re.signum() }
    }
}

/// One contact over a period of the motion with this angular frequency (rad/s).
fn period(contact: &ContactMotion, omega: f64) -> ContactPeriod {
    ContactPeriod {
        closed_share: contact.closed_share,
        peak_force: contact.peak_force,
        mean_force: contact.mean_force,
        impulse: contact.mean_force * TAU / omega,
        touches: contact.touches,
        approach_velocity: contact.approach,
    }
}
