use schemars::JsonSchema;
use serde::Deserialize;

use super::RawPlace;

/// A spring or damper with a law of force, between a place and the ground or another place. Linear springs of rods and
/// beams are written under `[[structure.spring]]`.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawLawSpring {
    /// The place whose displacement it resists, and the direction
    #[serde(flatten)]
    pub place: RawPlace,
    /// The place that the other end is fixed to, instead of the ground; its direction is that of the spring
    pub against: Option<RawPlace>,
    /// The law of force
    pub law: RawLaw,
}

/// The force of a spring by its displacement, or of a damper by its velocity: one of these.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(extend(
    "oneRequired" = ["polynomial", "table", "power", "exponential", "bilinear", "damper", "damper_table", "function"]
))]
pub struct RawLaw {
    /// Coefficients of displacement, its square, its cube and so on, in N/m, N/m², N/m³ …
    #[schemars(length(min = 1, max = 20))]
    pub polynomial: Option<Vec<f64>>,
    /// Table displacement_m,force_n through the origin, joined by monotone cubic pieces; relative to the scene
    #[schemars(length(min = 1))]
    pub table: Option<String>,
    /// Power of the displacement
    pub power: Option<RawPower>,
    /// Exponential of the displacement
    pub exponential: Option<RawExponential>,
    /// Stiffness that changes at a displacement
    pub bilinear: Option<RawBilinear>,
    /// Power of the velocity
    pub damper: Option<RawDamper>,
    /// Table velocity_m_s,force_n through the origin, like `table`
    #[schemars(length(min = 1))]
    pub damper_table: Option<String>,
    /// Name of a law that a program supplies with the scene, as `nlmodes.Law` does in Python
    #[schemars(length(min = 1))]
    pub function: Option<String>,
}

/// `F = k |v|ⁿ sgn v`.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawPower {
    /// `k`, in N over the n-th power of a metre
    pub stiffness: f64,
    /// `n`
    #[schemars(range(min = 1.0, max = 20.0))]
    pub exponent: f64,
    /// Whether it acts against positive displacements alone, as a Hertz contact that touches at rest
    #[serde(default)]
    pub one_sided: bool,
}

/// `F = F₀ (e^{v/v₀} − 1)`.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawExponential {
    /// `F₀`
    #[schemars(extend("unit" = "N", "exclusiveMinimum" = 0.0))]
    pub force_n: f64,
    /// `v₀`
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub length_m: f64,
}

/// Stiffness that changes at a displacement on either side.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawBilinear {
    /// Stiffness near rest
    #[schemars(extend("unit" = "N/m"))]
    pub stiffness_n_m: f64,
    /// Stiffness beyond the displacement
    #[schemars(extend("unit" = "N/m", "minimum" = 0.0))]
    pub beyond_n_m: f64,
    /// The displacement
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub from_m: f64,
}

/// `F = c |v̇|ⁿ sgn v̇`.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawDamper {
    /// `c`, in N over the n-th power of m/s
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub coefficient: f64,
    /// `n`
    #[schemars(range(min = 1.0, max = 20.0))]
    pub exponent: f64,
}
