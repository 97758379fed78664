//! From motions in open modes to points of a curve, which tables, figures and page share with other computations.

use std::sync::Arc;

use nlmodes::hbm::{HbmError, MotionChange, PeriodicMotion, ResponseRow, largest_value};
use nlmodes::modal::{
    BranchEnd, Driven, Gradient, HarmonicCoefficients, InternalResonance, ModalBranch, ModalPoint, Participation,
};
use nlmodes::response::{Appropriation, ResponseError, ResponseModel, ResponsePoint, Weights};
use nlmodes_scene::scene::ResponseKind;
use num_complex::Complex64;

use crate::curve::LINEAR_MODES;
use crate::gradients::gradient;
use crate::model::{Model, Parameter};
use crate::physical::count_from_drawing;
use crate::sliding::speed;

/// What turns motions into points of a curve.
pub struct Converter<'a> {
    model: &'a Model,
    /// The structure with the drive point of the response.
    system: &'a ResponseModel,
    kind: ResponseKind,
    subharmonic: usize,
    rows: Vec<ResponseRow>,
    /// Displacement of the first contact toward its stop or, without one, of the first spring.
    contact: Option<ResponseRow>,
    /// Rows of the displacements within the planes of the contacts.
    tangents: Vec<ResponseRow>,
    /// Angular frequencies of the linear modes, rad/s.
    omega: Vec<f64>,
}

/// Modal coordinates of the lowest so many modes in a motion, modes × (H + 1), m √kg.
pub fn modal_coordinates(motion: &PeriodicMotion, modes: usize) -> HarmonicCoefficients {
    let mut modal = HarmonicCoefficients::zeros(modes, motion.eta.len().saturating_sub(1));
    for (n, eta) in motion.eta.iter().enumerate() {
        eta.iter().take(modes).enumerate().for_each(|(k, eta)| modal.of_mut(k)[n] = *eta);
    }
    modal
}

/// Rounding of a displacement, whose terms cancel where a rigid stop holds it, m.
fn rounding(row: &ResponseRow, motion: &PeriodicMotion) -> f64 {
    let of = |row: &[f64], all: &[Vec<Complex64>]| {
        let terms = all.iter().flat_map(|z| z.iter().zip(row)).map(|(z, r)| r.abs() * z.norm());
        terms.sum::<f64>() * row.len() as f64
    };
    f64::EPSILON * (of(&row.modes, &motion.eta) + of(&row.contacts, &motion.forces))
}

impl<'a> Converter<'a> {
    pub fn new(
        model: &'a Model,
        system: &'a ResponseModel,
        kind: ResponseKind,
        subharmonic: usize,
    ) -> Result<Self, ResponseError> {
        let rows = model.response().rows_of_dofs(&model.recorded)?;
        let first: Vec<Weights> = model.contacts.iter().chain(&model.springs).take(1).cloned().collect();
        let contact = model.response().rows(&first)?.into_iter().next();
        let weights: Vec<Weights> = model.tangents.all().map(|tangent| tangent.weights.clone()).collect();
        let tangents = model.response().rows(&weights)?;
        let omega = model.open_modes().omega_squared().iter().map(|square| square.max(0.0).sqrt()).collect();
        Ok(Self { model, system, kind, subharmonic, rows, contact, tangents, omega })
    }

    /// The curve of these motions, of appropriation with the forces of each.
    pub fn branch(
        &self,
        label: String,
        points: &[ResponsePoint],
        forces: &[Appropriation],
        end: BranchEnd,
    ) -> Result<ModalBranch, ResponseError> {
        let point = |(k, point): (usize, &ResponsePoint)| self.point(point, forces.get(k));
        let points = points.iter().enumerate().map(point).collect::<Result<_, _>>()?;
        Ok(ModalBranch { points, end, ..self.model.no_branch(&label, String::new()) })
    }

    /// A point; of appropriation with what its forces do.
    pub fn point(
        &self,
        point: &ResponsePoint,
        appropriated: Option<&Appropriation>,
    ) -> Result<ModalPoint, ResponseError> {
        let motion = &point.motion;
        let mut coefficients = HarmonicCoefficients::zeros(self.rows.len(), motion.eta.len() - 1);
        for (d, row) in self.rows.iter().enumerate() {
            let displacement = self.model.response().displacement(row, motion, self.subharmonic);
            coefficients.of_mut(d).copy_from_slice(&displacement);
            coefficients.of_mut(d)[0] += self.model.moved.get(d).copied().unwrap_or(0.0);
        }
        let mut found = ModalPoint {
            coefficients,
            stability: appropriated.and_then(|found| found.stability).or(point.stability),
            fundamental: self.fundamental(point),
            peak: self.peak(motion),
            driven: Some(self.driven(point, appropriated)?),
            gradients: self.gradients(point),
            ..point.modal_point()
        };
        self.model.state.iter().for_each(|state| count_from_drawing(state, &mut found));
        self.slide(motion, &mut found)?;
        found.resonance = found.resonant_harmonic().and_then(|harmonic| {
            let modal = || Some(modal_coordinates(motion, self.omega.len()));
            InternalResonance::of_harmonic(harmonic, harmonic as f64 * found.omega, &self.omega, modal)
        });
        Ok(found)
    }

    /// Derivatives by the parameters of the scene.
    fn gradients(&self, point: &ResponsePoint) -> Arc<[Gradient]> {
        let of = |(parameter, found): (&Parameter, &MotionChange)| {
            let moved = parameter.states.iter().map(|(model, _, weight)| weight * model.toward_first());
            gradient((&parameter.key, parameter.value), found, self.subharmonic, moved.sum())
        };
        self.model.parameters.iter().zip(&point.gradients).map(of).collect()
    }

    /// Says how the contacts of the point slide, where any does.
    fn slide(&self, motion: &PeriodicMotion, found: &mut ModalPoint) -> Result<(), ResponseError> {
        if self.model.tangents.is_empty() {
            return Ok(());
        }
        let spans = match found.contacts.iter().any(|contact| contact.closed_share > 0.0) {
            true => self.model.response().contact_pattern(motion, self.subharmonic)?.closed_spans(),
            false => vec![Vec::new(); found.contacts.len()],
        };
        let modal = (0..motion.eta.first().map_or(0, Vec::len)).map(|r| {
            let of: Vec<Complex64> = motion.eta.iter().map(|eta| eta[r]).collect();
            speed(&of).powi(2)
        });
        let modal = modal.sum::<f64>().sqrt();
        let base = self.base_displacement(motion);
        let all: Vec<(Option<Vec<Complex64>>, f64)> = self
            .tangents
            .iter()
            .zip(self.model.tangents.all())
            .map(|(row, tangent)| {
                let mut series = self.model.response().displacement(row, motion, self.subharmonic);
                series.get_mut(self.subharmonic).into_iter().for_each(|u| *u += tangent.base * base);
                (Some(series), row.modes.iter().map(|w| w * w).sum::<f64>().sqrt() * modal)
            })
            .collect();
        let sliding = self.model.tangents.sliding(&spans, |j| all[j].clone(), motion.at.omega);
        found.contacts.iter_mut().zip(sliding).for_each(|(contact, sliding)| contact.sliding = sliding);
        Ok(())
    }

    /// Amplitude of the displacement of the base, m, a cosine; zero of one that does not shake.
    fn base_displacement(&self, motion: &PeriodicMotion) -> f64 {
        let omega = motion.at.omega * self.subharmonic as f64;
        match self.model.unit {
            "m" => motion.at.level,
            "m/s²" => motion.at.level / (omega * omega),
            _ => 0.0,
        }
    }

    /// Participation of the lowest linear modes in a point and its motion; the phase is that of the first contact along
    /// its coordinate.
    pub fn participation(&self, point: &ModalPoint, motion: &PeriodicMotion) -> Result<Participation, ResponseError> {
        let anchor = self.contact_harmonics(motion).get(1).copied().unwrap_or_default() * self.first_side();
        let modal = modal_coordinates(motion, LINEAR_MODES.min(self.omega.len()));
        Ok(Participation::of_point(point, &modal, anchor).map_err(HbmError::from)?)
    }

    /// Displacement of the first contact toward its stop, harmonic by harmonic, m.
    fn contact_harmonics(&self, motion: &PeriodicMotion) -> Vec<Complex64> {
        let of = |row: &ResponseRow| self.model.response().displacement(row, motion, self.subharmonic);
        self.contact.as_ref().map_or_else(Vec::new, of)
    }

    /// Largest displacement of the first contact toward its stop from rest, or of the first spring, m.
    fn peak(&self, motion: &PeriodicMotion) -> f64 {
        match motion.contacts.first() {
            Some(contact) => contact.peak,
            None => largest_value(&self.contact_harmonics(motion)),
        }
    }

    fn first_side(&self) -> f64 {
        self.model.sides.first().copied().unwrap_or(1.0)
    }

    /// Amplitude of the first contact at the frequency of the load, m; of a free motion with the sign of its
    /// displacement at the phase zero.
    fn fundamental(&self, point: &ResponsePoint) -> f64 {
        let Some(row) = &self.contact else { return f64::NAN };
        let z = self.contact_harmonics(&point.motion).get(self.subharmonic).copied().unwrap_or_default();
        if z.norm() <= rounding(row, &point.motion) {
            return 0.0;
        }
        if self.kind.is_forced() { z.norm() } else { z.norm() * self.first_side() * z.re.signum() }
    }

    fn driven(&self, point: &ResponsePoint, appropriated: Option<&Appropriation>) -> Result<Driven, ResponseError> {
        let (motion, level) = (&point.motion, self.kind.is_forced().then_some(point.level));
        let plain = Driven {
            omega: point.omega,
            level,
            force: level.filter(|_| self.model.unit == "N"),
            drive: Some(point.drive).filter(|drive| drive.norm() > 0.0),
            input_power: level.map(|_| motion.input_power),
            dissipated_power: motion.dissipated_power,
            damping_ratio: (self.kind == ResponseKind::DampedMode).then(|| motion.damping_ratio()),
            indicator: None,
            mode_distance: None,
        };
        if let Some(found) = appropriated {
            return Ok(Driven {
                force: found.forces.first().and_then(|f| f.get(1)).map(|f| f.norm()),
                indicator: found.power.map(|power| power.indicator()),
                mode_distance: Some(found.distance),
                ..plain
            });
        }
        if level.is_some() {
            let power = self.system.force_power(motion, self.subharmonic)?;
            return Ok(Driven { indicator: power.map(|power| power.indicator()), ..plain });
        }
        // Of a mode: a test that drives it with one harmonic at the drive point.
        let q = self.system.drive_harmonics(motion)?;
        let speed = |n: usize| n as f64 * motion.at.omega * q.get(n).map_or(0.0, |q| q.norm());
        let all = (1..q.len()).map(|n| speed(n).powi(2)).sum::<f64>().sqrt();
        let force = (self.kind == ResponseKind::DampedMode).then(|| 2.0 * motion.dissipated_power / speed(1));
        Ok(Driven { force, indicator: Some(speed(1) / all), ..plain })
    }
}
