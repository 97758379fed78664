use crate::FemError;
use crate::error::positive;

/// Cross section of a beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    area: f64,
    second_moment: f64,
    shear_factor: f64,
}

impl Section {
    /// Shear factor unless told otherwise: that of a rectangle.
    pub const DEFAULT_SHEAR_FACTOR: f64 = 5.0 / 6.0;

    /// Section of area `A` in m² and second moment of area `I` in m⁴ about the bending axis.
    ///
    /// # Errors
    /// [`FemError::NotPositive`].
    pub fn new(area: f64, second_moment: f64) -> Result<Self, FemError> {
        Ok(Self {
            area: positive("cross-section area", area)?,
            second_moment: positive("second moment of area", second_moment)?,
            shear_factor: Self::DEFAULT_SHEAR_FACTOR,
        })
    }

    /// Rectangle of `width` and `height` in m, the height in the direction of the deflection: `I = w h³ / 12`.
    ///
    /// # Errors
    /// [`FemError::NotPositive`].
    pub fn rectangle(width: f64, height: f64) -> Result<Self, FemError> {
        let (w, h) = (positive("section width", width)?, positive("section height", height)?);
        Self::new(w * h, w * h.powi(3) / 12.0)
    }

    /// The same section with another shear factor `κ`: `κ A` is the area that carries a uniform shear stress.
    ///
    /// # Errors
    /// [`FemError::NotPositive`].
    pub fn with_shear_factor(self, shear_factor: f64) -> Result<Self, FemError> {
        Ok(Self { shear_factor: positive("shear factor", shear_factor)?, ..self })
    }

    /// Area `A`, m².
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Second moment of area `I`, m⁴.
    pub fn second_moment(&self) -> f64 {
        self.second_moment
    }

    /// Shear factor `κ`.
    pub fn shear_factor(&self) -> f64 {
        self.shear_factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn height_of_a_rectangle_counts_three_times() {
        let section = Section::rectangle(3.0, 2.0).unwrap();
        assert_eq!((section.area(), section.second_moment()), (6.0, 2.0));
    }

    #[test]
    fn impossible_values_are_refused() {
        for bad in [0.0, -2.0, f64::NAN] {
            assert!(Section::new(bad, 1.0).is_err() && Section::new(1.0, bad).is_err());
            assert!(Section::rectangle(bad, 1.0).is_err() && Section::rectangle(1.0, bad).is_err());
            assert!(Section::new(1.0, 1.0).unwrap().with_shear_factor(bad).is_err());
        }
    }
}
