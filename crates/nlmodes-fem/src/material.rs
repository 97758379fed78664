use crate::FemError;
use crate::error::positive;

/// A linear elastic, isotropic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    youngs_modulus: f64,
    density: f64,
    poissons_ratio: f64,
}

impl Material {
    /// Default Poisson's ratio: that of steel. Rods do not need it.
    pub const DEFAULT_POISSONS_RATIO: f64 = 0.3;

    /// Material of Young's modulus `E` in Pa and density `ρ` in kg/m³.
    ///
    /// # Errors
    /// [`FemError::NotPositive`].
    pub fn new(youngs_modulus: f64, density: f64) -> Result<Self, FemError> {
        Ok(Self {
            youngs_modulus: positive("Young's modulus", youngs_modulus)?,
            density: positive("density", density)?,
            poissons_ratio: Self::DEFAULT_POISSONS_RATIO,
        })
    }

    /// The same material with another Poisson's ratio `ν`.
    ///
    /// # Errors
    /// [`FemError::PoissonsRatio`] unless `0 ≤ ν < 0.5`.
    pub fn with_poissons_ratio(self, poissons_ratio: f64) -> Result<Self, FemError> {
        if (0.0..0.5).contains(&poissons_ratio) {
            Ok(Self { poissons_ratio, ..self })
        } else {
            Err(FemError::PoissonsRatio { value: poissons_ratio })
        }
    }

    /// Young's modulus `E`, Pa.
    pub fn youngs_modulus(&self) -> f64 {
        self.youngs_modulus
    }

    /// Density `ρ`, kg/m³.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Poisson's ratio `ν`.
    pub fn poissons_ratio(&self) -> f64 {
        self.poissons_ratio
    }

    /// Shear modulus `G = E / 2(1 + ν)`, Pa.
    pub fn shear_modulus(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shear_modulus_follows_from_the_other_two() {
        let steel = Material::new(208e9, 7800.0).unwrap();
        assert!((steel.shear_modulus() / 80e9 - 1.0).abs() < 1e-15);
        assert_eq!(steel.with_poissons_ratio(0.0).unwrap().shear_modulus(), 104e9);
    }

    #[test]
    fn impossible_values_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Material::new(bad, 1.0), Err(FemError::NotPositive { what: "Young's modulus", .. })));
            assert!(matches!(Material::new(1.0, bad), Err(FemError::NotPositive { what: "density", .. })));
        }
        for bad in [-0.1, 0.5, f64::NAN] {
            assert!(matches!(
                Material::new(1.0, 1.0).unwrap().with_poissons_ratio(bad),
                Err(FemError::PoissonsRatio { .. })
            ));
        }
    }
}
