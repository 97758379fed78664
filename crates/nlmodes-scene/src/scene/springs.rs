//! Springs and dampers with a law of force, beside the stops.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Place;

/// A spring or damper with a law of force between a place and the ground, or another place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LawSpring {
    /// The place whose displacement it resists, and the direction.
    pub at: Place,
    /// The place that it is fastened to in place of the ground.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub against: Option<Place>,
    /// The law of force.
    pub law: SpringLaw,
}

/// Force against displacement, or against velocity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpringLaw {
    /// `k₁ v + k₂ v² + …`, N/m, N/m², ….
    Polynomial(Vec<f64>),
    /// Table of displacement, m, and force, N.
    Table(PathBuf),
    /// `k |v|ⁿ sgn v`.
    Power {
        /// `k`, N/mⁿ.
        stiffness: f64,
        /// `n`.
        exponent: f64,
        /// Whether it acts against positive displacements alone.
        one_sided: bool,
    },
    /// `F₀ (e^{v/v₀} − 1)`.
    Exponential {
        /// `F₀`, N.
        force: f64,
        /// `v₀`, m.
        length: f64,
    },
    /// `k₁` up to `|v| = v₁`, `k₂` beyond.
    Bilinear {
        /// `k₁`, N/m.
        inner: f64,
        /// `k₂`, N/m.
        outer: f64,
        /// `v₁`, m.
        knee: f64,
    },
    /// `c |v̇|ⁿ sgn v̇`.
    Damper {
        /// `c`, N (s/m)ⁿ.
        coefficient: f64,
        /// `n`.
        exponent: f64,
    },
    /// Table of velocity, m/s, and force, N.
    DamperTable(PathBuf),
    /// A law of the program that computes the scene, by its name.
    Function(String),
}
