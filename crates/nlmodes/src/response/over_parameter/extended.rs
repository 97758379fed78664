//! The equations of a motion with a condition, beside a parameter of the structure.

use std::error::Error;

use nlmodes_contact::{LcpSolver, solver_by_name};
use nlmodes_continuation::{BranchPoint, Linearization, ParametricSystem, Scaling};
use nlmodes_hbm::{HbmError, PeriodicSystem, Scales, Source, Symmetry, Watched};
use nlmodes_linalg::Mat;

use super::fold::Border;
use super::{AtValue, Family};
use crate::response::{ResponseError, ResponseSettings};

/// What a motion has to be beside a solution.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// Nothing: of a mode at a given energy, or a phase resonance at a given level.
    None,
    /// A fold of a response over the frequency.
    Fold(Border),
    /// A contact is touched from outside.
    Touch {
        /// The contact.
        contact: usize,
    },
}

/// The periodic problem at each value of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Problem {
    /// A response over the frequency, in this unit (rad/s).
    Response {
        /// Units of its unknowns.
        scales: Scales,
        /// Unit of the frequency.
        unit: f64,
    },
    /// A phase resonance at the level of the structure, with the lag of the settings.
    Resonance {
        /// Units of its unknowns.
        scales: Scales,
    },
    /// A conservative mode at the energy of its unit.
    Mode {
        /// Units of its unknowns, and the energy.
        scales: Scales,
        /// Its symmetry in time.
        symmetry: Symmetry,
    },
}

/// By how many units of length a contact is set back that is to be touched: more than it could be passed by.
const APART: f64 = 1e3;

/// Half the distance, in the unit of the unknowns, of the Jacobians whose difference says how a fold moves.
const SECOND: f64 = 1e-4;

impl Problem {
    /// The system with the structure at a value.
    pub fn system(
        &self,
        at: &AtValue,
        settings: &ResponseSettings,
        solver: &dyn LcpSolver,
        condition: &Condition,
    ) -> Result<PeriodicSystem, ResponseError> {
        let apart = match condition {
            Condition::Touch { contact } => {
                let mut gaps = at.model.structure().gaps().to_vec();
                gaps[*contact] += self.apart();
                Some(at.model.structure().with_gaps(gaps)?)
            }
            _ => None,
        };
        let structure = apart.as_ref().unwrap_or_else(|| at.model.structure());
        let periodic = settings.periodic();
        Ok(match *self {
            Self::Response { scales, unit } => {
                let load = at.model.load(settings)?;
                PeriodicSystem::frequency_response(structure, load, at.level, unit, periodic, scales, solver)?
            }
            Self::Resonance { scales } => {
                let load = at.model.load(settings)?;
                let drive = at.model.drive(settings)?.ok_or(ResponseError::NoDrive)?;
                PeriodicSystem::phase_resonance(structure, load, drive, at.level, periodic, scales, solver)?
            }
            Self::Mode { scales, symmetry } => {
                PeriodicSystem::conservative_mode(structure, symmetry, periodic, scales, solver)?
            }
        })
    }

    /// Unit of lengths, m.
    pub fn length(&self) -> f64 {
        match self {
            Self::Response { scales, .. } | Self::Resonance { scales } | Self::Mode { scales, .. } => scales.length,
        }
    }

    /// By how much a contact is set back that is to be touched, m.
    pub fn apart(&self) -> f64 {
        APART * self.length()
    }
}

/// What is known of the structure at the value evaluated last.
struct Known {
    value: f64,
    at: AtValue,
    system: PeriodicSystem,
}

/// The equations over the parameter.
pub struct Extended<'s, 'f> {
    family: &'s mut Family<'f>,
    pub settings: &'s ResponseSettings,
    problem: Problem,
    condition: Condition,
    solver: Box<dyn LcpSolver>,
    /// The value at the parameter zero, and its unit.
    scale: (f64, f64),
    /// Number of unknowns of the periodic problem.
    n: usize,
    known: Option<Known>,
    /// The borders along the null vectors found last.
    next: Option<Border>,
    /// The contact pattern of the motion evaluated last.
    pattern: u64,
    /// Why the structure was not there the last time it was not.
    pub failed: Option<String>,
}

impl<'s, 'f> Extended<'s, 'f> {
    /// Over the parameter, whose value is `value + unit p`.
    pub fn new(
        family: &'s mut Family<'f>,
        settings: &'s ResponseSettings,
        problem: Problem,
        condition: Condition,
        scale: (f64, f64),
        (x, s): (&[f64], f64),
    ) -> Result<Self, ResponseError> {
        let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
        let n = x.len();
        let (known, next, pattern, failed) = (None, None, 0, None);
        let mut new = Self { family, settings, problem, condition, solver, scale, n, known, next, pattern, failed };
        if let Condition::Fold(_) = new.condition {
            let mut lin = Linearization::new(n);
            let value = new.scale.0;
            new.at(value)?.linearize(x, s, &mut lin)?;
            new.condition = Condition::Fold(Border::of(&lin.jacobian.subcols(0, n).to_owned())?);
        }
        Ok(new)
    }

    /// The unknowns at the start.
    pub fn start(&mut self, x: &[f64], s: f64) -> Result<Vec<f64>, ResponseError> {
        let value = self.scale.0;
        let system = self.at(value)?;
        system.hold_phase(x);
        let mut z = x.to_vec();
        z.extend((self.condition != Condition::None).then_some(s));
        Ok(z)
    }

    /// The value of the parameter at `p`.
    pub fn value(&self, p: f64) -> f64 {
        self.scale.0 + self.scale.1 * p
    }

    /// The unknowns of the periodic problem and its own parameter.
    pub fn split<'z>(&self, z: &'z [f64]) -> (&'z [f64], f64) {
        (&z[..self.n], z.get(self.n).copied().unwrap_or(0.0))
    }

    /// The periodic problem at a value.
    pub fn at(&mut self, value: f64) -> Result<&mut PeriodicSystem, ResponseError> {
        Ok(&mut self.known(value)?.system)
    }

    /// The displacement whose amplitude is reported.
    pub fn watched(&mut self, value: f64) -> Result<Option<Watched>, ResponseError> {
        Ok(self.known(value)?.at.watched.clone())
    }

    /// Derivative of the base frequency by the parameter along the curve, rad/s per unit of it.
    pub fn frequency_slope(&self, at: &BranchPoint) -> f64 {
        let n = at.x.len();
        let system = self.known.as_ref().map(|known| &known.system);
        let source = system.map(|system| (system.closing().omega, system.n_coefficients()));
        let (column, unit) = match source {
            Some((Source::Parameter { scale }, _)) => (self.n, scale),
            Some((Source::Unknown { index, scale }, first)) => (first + index, scale),
            _ => return f64::NAN,
        };
        unit * at.tangent[column] / (self.scale.1 * at.tangent[n])
    }

    /// An error of the continuation, in words.
    pub fn why(&self, error: &dyn Error) -> String {
        let (mut causes, mut next) = (String::new(), error.source());
        while let Some(cause) = next {
            causes += &format!(": {cause}");
            next = cause.source();
        }
        let failed = self.failed.as_ref().map_or_else(String::new, |why| format!(": {why}"));
        format!("{error}{causes}{failed}")
    }

    fn known(&mut self, value: f64) -> Result<&mut Known, ResponseError> {
        let is_same = self.known.as_ref().is_some_and(|known| known.value == value);
        if !is_same {
            let at = (self.family)(value).map_err(|why| {
                self.failed = Some(why.clone());
                ResponseError::AtValue { value, why }
            })?;
            let system = self.problem.system(&at, self.settings, self.solver.as_ref(), &self.condition)?;
            if system.n_coefficients() > self.n {
                let why = "the number of unknowns changes with it".to_owned();
                return Err(ResponseError::AtValue { value, why });
            }
            self.known = Some(Known { value, at, system });
        }
        self.known.as_mut().ok_or(ResponseError::Stopped)
    }

    /// `g` at a fold with its derivatives by the unknowns, the frequency and the parameter, per unit of that.
    fn fold(
        &mut self,
        (x, s, value): (&[f64], f64, f64),
        jacobian: &Mat<f64>,
        border: &Border,
    ) -> Result<(f64, Vec<f64>), ResponseError> {
        let n = self.n;
        let found = border.function(&jacobian.subcols(0, n).to_owned())?;
        let size = found.v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let step = SECOND / size;
        let known = self.known(value)?;
        let mut beside = |sign: f64| -> Result<(Mat<f64>, Vec<f64>), ResponseError> {
            let there: Vec<f64> = x.iter().zip(&found.v).map(|(x, v)| x + sign * step * v).collect();
            let mut lin = Linearization::new(n);
            let by_value = known.system.linearize_over(&there, s, &known.at.change, &mut lin)?;
            Ok((lin.jacobian, by_value))
        };
        let ((above, above_by), (below, below_by)) = (beside(1.0)?, beside(-1.0)?);
        let along = |of: &dyn Fn(usize) -> f64| -(0..n).map(|i| found.w[i] * of(i)).sum::<f64>() / (2.0 * step);
        let mut by: Vec<f64> = (0..=n).map(|k| along(&|i| above[(i, k)] - below[(i, k)])).collect();
        by.push(along(&|i| above_by[i] - below_by[i]));
        self.next = Some(border.moved(&found));
        Ok((found.g, by))
    }

    /// The smallest gap of a contact, in the unit of lengths, with its derivatives in the same order.
    fn touch(&mut self, (x, s, value): (&[f64], f64, f64), contact: usize) -> Result<(f64, Vec<f64>), ResponseError> {
        let (apart, length) = (self.problem.apart(), self.problem.length());
        let known = self.known(value)?;
        let opening = known.system.opening(contact, (x, s), &known.at.change)?.ok_or(HbmError::Size {
            what: "contacts that are open",
            expected: 1,
            found: 0,
        })?;
        let by = opening.by.iter().chain([&opening.by_parameter]).map(|by| by / length);
        Ok(((opening.value - apart) / length, by.collect()))
    }
}

impl ParametricSystem for Extended<'_, '_> {
    type Error = ResponseError;

    fn dim(&self) -> usize {
        self.n + usize::from(self.condition != Condition::None)
    }

    fn scaling(&self) -> Option<Scaling> {
        Some(Scaling::unit(self.dim()))
    }

    fn linearize(&mut self, z: &[f64], p: f64, out: &mut Linearization) -> Result<(), ResponseError> {
        let (n, value, value_unit) = (self.n, self.value(p), self.scale.1);
        let (x, s) = self.split(z);
        let known = self.known(value)?;
        let mut own = Linearization::new(n);
        let by_value = known.system.linearize_over(x, s, &known.at.change, &mut own)?;
        let pattern = known.system.pattern();
        let last = match self.condition.clone() {
            Condition::None => None,
            Condition::Fold(border) => Some(self.fold((x, s, value), &own.jacobian, &border)?),
            Condition::Touch { contact } => Some(self.touch((x, s, value), contact)?),
        };
        self.pattern = pattern;
        // Of a mode the energy is held, of a phase resonance the level: there is no column of its own parameter.
        let columns = if last.is_some() { n + 1 } else { n };
        out.residual[..n].copy_from_slice(&own.residual);
        for j in 0..columns {
            (0..n).for_each(|i| out.jacobian[(i, j)] = own.jacobian[(i, j)]);
        }
        (0..n).for_each(|i| out.jacobian[(i, columns)] = by_value[i] * value_unit);
        if let Some((g, by)) = last {
            out.residual[n] = g;
            (0..=n).for_each(|j| out.jacobian[(n, j)] = by[j]);
            out.jacobian[(n, n + 1)] = by[n + 1] * value_unit;
        }
        Ok(())
    }

    fn pattern(&self) -> u64 {
        self.pattern
    }

    fn accepted(&mut self, z: &[f64], _p: f64) {
        let x = self.split(z).0.to_vec();
        if let Some(known) = &mut self.known {
            known.system.hold_phase(&x);
        }
        if let (Condition::Fold(border), Some(next)) = (&mut self.condition, self.next.take()) {
            *border = next;
        }
    }
}
