//! From motions in open modes to points of a curve, which tables, figures and page share with other computations.

use nlmodes::hbm::ResponseRow;
use nlmodes::modal::{BranchEnd, Driven, HarmonicCoefficients, ModalBranch, ModalPoint};
use nlmodes::response::{Appropriation, ResponseError, ResponseModel, ResponsePoint};
use nlmodes_scene::scene::ResponseKind;

use super::model::Model;

/// What turns motions into points of a curve.
pub struct Converter<'a> {
    model: &'a Model,
    /// The structure with the drive point of the response.
    system: &'a ResponseModel,
    kind: ResponseKind,
    subharmonic: usize,
    rows: Vec<ResponseRow>,
    contact: Option<ResponseRow>,
}

impl<'a> Converter<'a> {
    pub fn new(
        model: &'a Model,
        system: &'a ResponseModel,
        kind: ResponseKind,
        subharmonic: usize,
    ) -> Result<Self, ResponseError> {
        let rows = model.response().rows_of_dofs(&model.recorded)?;
        let contact = model.response().rows(&model.contacts)?.into_iter().next();
        Ok(Self { model, system, kind, subharmonic, rows, contact })
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
        }
        Ok(ModalPoint {
            coefficients,
            stability: appropriated.and_then(|found| found.stability).or(point.stability),
            fundamental: self.fundamental(point),
            driven: Some(self.driven(point, appropriated)?),
            ..point.modal_point()
        })
    }

    /// Amplitude of the first contact at the frequency of the load, m; of a free motion with the sign of its
    /// displacement at the phase zero.
    fn fundamental(&self, point: &ResponsePoint) -> f64 {
        let Some(row) = &self.contact else { return f64::NAN };
        let q = self.model.response().displacement(row, &point.motion, self.subharmonic);
        let z = q.get(self.subharmonic).copied().unwrap_or_default();
        let side = self.model.sides.first().copied().unwrap_or(1.0);
        if self.kind.is_forced() { z.norm() } else { z.norm() * side * z.re.signum() }
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
