use core::f64::consts::FRAC_PI_2;

/// What the response sensor of the loop measures.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ResponseQuantity {
    /// m. Least distorted by higher harmonics, and so the choice of the paper (Section 4).
    #[default]
    Displacement,
    /// m/s.
    Velocity,
    /// m/s².
    Acceleration,
}

impl ResponseQuantity {
    /// Lag of this quantity behind the force where the displacement lags by `displacement_lag`, rad: each derivative
    /// leads its predecessor by a quarter of a period. At phase resonance `π/2`, 0 and `−π/2`.
    pub fn lag(self, displacement_lag: f64) -> f64 {
        displacement_lag - FRAC_PI_2 * f64::from(self.derivatives())
    }

    /// Number of time derivatives from the displacement.
    pub fn derivatives(self) -> u8 {
        match self {
            Self::Displacement => 0,
            Self::Velocity => 1,
            Self::Acceleration => 2,
        }
    }
}
