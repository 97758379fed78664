use num_complex::Complex64;

use super::load::Load;
use super::operating_point::OperatingPoint;
use super::structure::ResponseRow;
use super::weights::StructureWeights;
use crate::series::RealSeries;
use crate::trigonometric::inner;
use crate::{HbmError, Symmetry};

/// A motion as closing equations see it.
#[derive(Clone, Copy)]
pub struct Motion<'a> {
    /// Frequency, negative damping and level.
    pub at: OperatingPoint,
    /// Parameter of the branch.
    pub p: f64,
    /// Scaled coefficients of the coordinates.
    pub x: &'a [f64],
    /// Modal coordinates of a harmonic, m.
    pub eta: &'a dyn Fn(usize) -> Vec<Complex64>,
    /// Averaged kinetic energy, J, where an equation [asks](ClosingEquation::asks_for_energy) for it.
    pub kinetic_energy: f64,
    /// Contact forces of a harmonic, c.
    pub forces: &'a dyn Fn(usize) -> Vec<Complex64>,
    /// The load.
    pub load: &'a Load,
}

/// Value and derivatives of a closing equation; the real part of products with complex weights counts.
#[derive(Debug, Clone, Default)]
pub struct Functional {
    /// Value.
    pub value: f64,
    /// Weights (m) of the modal coordinates of a harmonic.
    pub eta: Vec<(usize, Vec<Complex64>)>,
    /// Derivative with respect to the averaged kinetic energy, 1/J.
    pub by_energy: f64,
    /// Weights (c) of the contact forces of a harmonic.
    pub forces: Vec<(usize, Vec<Complex64>)>,
    /// Weights of the scaled coefficients; empty for none.
    pub x: Vec<f64>,
    /// Derivatives with respect to ω, ξ and the level where all else is fixed.
    pub by: [f64; 3],
    /// Derivative with respect to the parameter where all else is fixed.
    pub by_parameter: f64,
}

/// An equation that closes a periodic problem.
pub trait ClosingEquation: Send {
    /// Value and derivatives.
    ///
    /// # Errors
    /// [`HbmError`] where the equation has no value.
    fn evaluate(&self, motion: &Motion) -> Result<Functional, HbmError>;

    /// Derivative by the structure where the motion is fixed, times a factor, added to weights: of equations that know
    /// something of the structure, such as where its drive point is.
    fn weigh_structure(&self, motion: &Motion, factor: f64, weights: &mut StructureWeights) {
        let _ = (motion, factor, weights);
    }

    /// Whether it depends on the averaged kinetic energy.
    fn asks_for_energy(&self) -> bool {
        false
    }

    /// Notified of every point that is evaluated, before it is.
    fn approached(&mut self, x: &[f64], series: RealSeries) {
        let _ = (x, series);
    }

    /// Notified of every point from which the branch goes on.
    fn accepted(&mut self, x: &[f64], series: RealSeries) {
        let _ = (x, series);
    }

    /// The same equation of a problem with another number of harmonics; what it was told of points is not kept.
    fn anew(&self) -> Box<dyn ClosingEquation>;
}

/// `ln(E_av/E_ref) − p = 0` with the averaged kinetic energy `E_av = ¼ Σ n²ω² |η_n|²`, eq. (16).
#[derive(Debug, Clone, Copy)]
pub struct EnergyGiven {
    /// Energy at the parameter zero, J.
    pub reference: f64,
}

impl ClosingEquation for EnergyGiven {
    fn evaluate(&self, motion: &Motion) -> Result<Functional, HbmError> {
        let (omega, energy) = (motion.at.omega, motion.kinetic_energy);
        if !(energy.is_finite() && energy > 0.0) {
            return Err(HbmError::Motion { omega, energy });
        }
        Ok(Functional {
            value: (energy / self.reference).ln() - motion.p,
            by_energy: 1.0 / energy,
            by_parameter: -1.0,
            ..Functional::default()
        })
    }

    fn asks_for_energy(&self) -> bool {
        true
    }

    fn anew(&self) -> Box<dyn ClosingEquation> {
        Box::new(*self)
    }
}

/// Another equation as it is at the parameter zero, while something else is the parameter.
pub(super) struct AtZero(pub Box<dyn ClosingEquation>);

impl ClosingEquation for AtZero {
    fn evaluate(&self, motion: &Motion) -> Result<Functional, HbmError> {
        Ok(Functional { by_parameter: 0.0, ..self.0.evaluate(&Motion { p: 0.0, ..*motion })? })
    }

    fn weigh_structure(&self, motion: &Motion, factor: f64, weights: &mut StructureWeights) {
        self.0.weigh_structure(&Motion { p: 0.0, ..*motion }, factor, weights);
    }

    fn asks_for_energy(&self) -> bool {
        self.0.asks_for_energy()
    }

    fn approached(&mut self, x: &[f64], series: RealSeries) {
        self.0.approached(x, series);
    }

    fn accepted(&mut self, x: &[f64], series: RealSeries) {
        self.0.accepted(x, series);
    }

    fn anew(&self) -> Box<dyn ClosingEquation> {
        Box::new(Self(self.0.anew()))
    }
}

/// `Σ n (c_n s̄_n − s_n c̄_n) = 0`: the phase of the last accepted point is held, and before any is accepted that of
/// the one evaluated first.
#[derive(Debug, Clone, Default)]
pub struct PhaseCondition {
    weights: Vec<f64>,
}

impl ClosingEquation for PhaseCondition {
    fn evaluate(&self, motion: &Motion) -> Result<Functional, HbmError> {
        let mut x = self.weights.clone();
        x.resize(motion.x.len(), 0.0);
        Ok(Functional { value: inner(&x, motion.x), x, ..Functional::default() })
    }

    fn approached(&mut self, x: &[f64], series: RealSeries) {
        if self.weights.is_empty() {
            self.accepted(x, series);
        }
    }

    fn accepted(&mut self, x: &[f64], series: RealSeries) {
        if series.symmetry == Symmetry::Even {
            return;
        }
        let width = series.width();
        let turned = |i: usize| {
            let (coordinate, m) = (i / width, i % width);
            series.turned(m).map_or(0.0, |(other, factor)| factor * x[coordinate * width + other])
        };
        let size = x.len() / width * width;
        let weights: Vec<f64> = (0..size).map(turned).collect();
        let length = inner(&weights, &weights).sqrt();
        if length > 0.0 {
            self.weights = weights.iter().map(|w| w / length).collect();
        }
    }

    fn anew(&self) -> Box<dyn ClosingEquation> {
        Box::<Self>::default()
    }
}

/// `arg(q_n e^{iφ}) = 0`: the displacement `q` lags a cosine in its harmonic `n` by the angle φ; 90° is phase
/// resonance.
#[derive(Debug, Clone)]
pub struct PhaseLag {
    /// The displacement, such as that of the drive point.
    pub row: ResponseRow,
    /// Harmonic of the base frequency.
    pub harmonic: usize,
    /// Lag φ, rad.
    pub lag: f64,
}

impl PhaseLag {
    /// Complex amplitude of the displacement, with its derivatives by ω, ξ and the level through the load alone.
    fn amplitude(&self, motion: &Motion) -> (Complex64, [Complex64; 3]) {
        let n = self.harmonic;
        let own = motion.load.row(n, &self.row.loads, motion.at);
        let of = |row: &[f64], z: &[Complex64]| row.iter().zip(z).map(|(r, z)| z * *r).sum::<Complex64>();
        (of(&self.row.modes, &(motion.eta)(n)) + of(&self.row.contacts, &(motion.forces)(n)) + own.value, own.by)
    }
}

impl ClosingEquation for PhaseLag {
    fn evaluate(&self, motion: &Motion) -> Result<Functional, HbmError> {
        let (q, by) = self.amplitude(motion);
        if !(q.norm_sqr() > 0.0 && q.is_finite()) {
            return Err(HbmError::DriveAtRest { harmonic: self.harmonic });
        }
        let factor = -Complex64::I / q;
        let weights = |row: &[f64]| vec![(self.harmonic, row.iter().map(|r| factor * *r).collect())];
        Ok(Functional {
            value: (q * Complex64::cis(self.lag)).arg(),
            eta: weights(&self.row.modes),
            forces: weights(&self.row.contacts),
            by: by.map(|by| (factor * by).re),
            ..Functional::default()
        })
    }

    fn anew(&self) -> Box<dyn ClosingEquation> {
        Box::new(self.clone())
    }

    fn weigh_structure(&self, motion: &Motion, factor: f64, weights: &mut StructureWeights) {
        let (q, _) = self.amplitude(motion);
        weights.add_drive(-Complex64::I / q * factor, &self.row, self.harmonic, motion);
    }
}
