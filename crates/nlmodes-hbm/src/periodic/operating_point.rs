use super::closing_equations::ClosingEquation;

/// The scalars of a periodic motion beside its coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatingPoint {
    /// Base angular frequency, rad/s.
    pub omega: f64,
    /// Negative damping `ξ` that keeps a free motion going, 1/s: `D = ω_k² − ν² + iν(ĉ_k − ξ)`.
    pub xi: f64,
    /// Level of the load.
    pub level: f64,
}

/// Where a scalar of the motion comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// It is given.
    Fixed(f64),
    /// It is an unknown behind the coefficients, in this unit.
    Unknown {
        /// Number of the unknown among those behind the coefficients.
        index: usize,
        /// Its unit.
        scale: f64,
    },
    /// It is the parameter of the branch, in this unit.
    Parameter {
        /// Its unit.
        scale: f64,
    },
    /// It is the square of the parameter of the branch.
    Square,
    /// The parameter is its logarithm over this reference.
    LogParameter {
        /// The value at the parameter zero.
        reference: f64,
    },
}

/// A column of the Jacobian behind those of the coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Column {
    /// An unknown behind the coefficients.
    Unknown(usize),
    /// The parameter.
    Parameter,
}

impl Source {
    /// Value at these unknowns and this parameter.
    pub fn at(&self, unknowns: &[f64], p: f64) -> f64 {
        match *self {
            Self::Fixed(value) => value,
            Self::Unknown { index, scale } => scale * unknowns[index],
            Self::Parameter { scale } => scale * p,
            Self::Square => p * p,
            Self::LogParameter { reference } => reference * p.exp(),
        }
    }

    /// The column on which it depends and its derivative.
    pub fn slope(&self, p: f64) -> Option<(Column, f64)> {
        match *self {
            Self::Fixed(_) => None,
            Self::Unknown { index, scale } => Some((Column::Unknown(index), scale)),
            Self::Parameter { scale } => Some((Column::Parameter, scale)),
            Self::Square => Some((Column::Parameter, 2.0 * p)),
            Self::LogParameter { reference } => Some((Column::Parameter, reference * p.exp())),
        }
    }
}

/// What makes a periodic problem square: where frequency, negative damping and level come from, and an equation for
/// each unknown.
pub struct Closing {
    /// Base frequency.
    pub omega: Source,
    /// Negative damping of a free motion.
    pub xi: Source,
    /// Level of the load.
    pub level: Source,
    /// As many equations as there are unknowns behind the coefficients.
    pub equations: Vec<Box<dyn ClosingEquation>>,
}

impl Closing {
    /// The scalars at these unknowns and this parameter.
    pub fn at(&self, unknowns: &[f64], p: f64) -> OperatingPoint {
        let at = |source: &Source| source.at(unknowns, p);
        OperatingPoint { omega: at(&self.omega), xi: at(&self.xi), level: at(&self.level) }
    }

    /// The sources in the order of derivatives: ω, ξ, level.
    pub(crate) fn sources(&self) -> [Source; 3] {
        [self.omega, self.xi, self.level]
    }

    /// The same of a problem with another number of harmonics.
    pub(crate) fn anew(&self) -> Self {
        let equations = self.equations.iter().map(|equation| equation.anew()).collect();
        Self { omega: self.omega, xi: self.xi, level: self.level, equations }
    }

    /// Number of unknowns behind the coefficients.
    pub fn n_unknowns(&self) -> usize {
        self.sources().iter().filter(|s| matches!(s, Source::Unknown { .. })).count()
    }
}
