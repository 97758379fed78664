use crate::FemError;
use crate::error::positive;

/// Cross section of a beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    area: f64,
    second_moment: f64,
    shear_factor: f64,
    outer_fibre: Option<f64>,
}

impl Section {
    /// Default shear factor: that of a rectangle.
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
            outer_fibre: None,
        })
    }

    /// Rectangle of `width` and `height` in m, the height in the direction of the deflection: `I = w h³ / 12`.
    ///
    /// # Errors
    /// [`FemError::NotPositive`].
    pub fn rectangle(width: f64, height: f64) -> Result<Self, FemError> {
        let (w, h) = (positive("section width", width)?, positive("section height", height)?);
        Self::new(w * h, w * h.powi(3) / 12.0)?.with_outer_fibre(0.5 * h)
    }

    /// Tube, or a round bar if the wall is half of the outer diameter: `A = π (D² − d²)/4`, `I = π (D⁴ − d⁴)/64` with
    /// the inner diameter `d = D − 2t`, and the shear factor of G. R. Cowper (J. Appl. Mech. 33 (1966) 335-340) with `r
    /// = d/D`:
    ///
    /// ```text
    /// κ = 6 (1 + ν) (1 + r²)² / ((7 + 6ν) (1 + r²)² + (20 + 12ν) r²)
    /// ```
    ///
    /// # Errors
    /// [`FemError::NotPositive`]; [`FemError::Wall`] for a wall of more than half of the diameter.
    pub fn tube(outer_diameter: f64, wall: f64, poissons_ratio: f64) -> Result<Self, FemError> {
        let (outer, wall) = (positive("outer diameter", outer_diameter)?, positive("wall thickness", wall)?);
        if 2.0 * wall > outer {
            return Err(FemError::Wall { wall, outer });
        }
        let inner = outer - 2.0 * wall;
        // (D − d)(D + d) = 4 t (D − t), which does not cancel for thin walls.
        let area = std::f64::consts::PI * wall * (outer - wall);
        let squares = outer * outer + inner * inner;
        let (ratio, nu) = ((inner / outer).powi(2), poissons_ratio);
        let plus = (1.0 + ratio).powi(2);
        let shear_factor = 6.0 * (1.0 + nu) * plus / ((7.0 + 6.0 * nu) * plus + (20.0 + 12.0 * nu) * ratio);
        Self::new(area, area * squares / 16.0)?.with_shear_factor(shear_factor)?.with_outer_fibre(0.5 * outer)
    }

    /// The same section with another shear factor `κ`: `κ A` is the area that carries a uniform shear stress.
    ///
    /// # Errors
    /// [`FemError::NotPositive`].
    pub fn with_shear_factor(self, shear_factor: f64) -> Result<Self, FemError> {
        Ok(Self { shear_factor: positive("shear factor", shear_factor)?, ..self })
    }

    /// The same section with its outermost fibre at another distance from the bending axis, m.
    ///
    /// # Errors
    /// [`FemError::NotPositive`].
    pub fn with_outer_fibre(self, distance: f64) -> Result<Self, FemError> {
        Ok(Self { outer_fibre: Some(positive("distance of the outermost fibre", distance)?), ..self })
    }

    /// Area `A`, m².
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Second moment of area `I`, m⁴.
    pub fn second_moment(&self) -> f64 {
        self.second_moment
    }

    /// Distance of the outermost fibre from the bending axis, m, where it is known: half of the height of a rectangle,
    /// of the outer diameter of a tube.
    pub fn outer_fibre(&self) -> Option<f64> {
        self.outer_fibre
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
    fn a_tube_is_a_round_bar_without_its_core() {
        use std::f64::consts::PI;
        for metre in [1.0, 1e-3] {
            let tube = Section::tube(0.10 * metre, 0.02 * metre, 0.3).unwrap();
            let [outer, inner] = [0.10_f64, 0.06].map(|d| [PI * d.powi(2) / 4.0, PI * d.powi(4) / 64.0]);
            assert!((tube.area() / metre.powi(2) / (outer[0] - inner[0]) - 1.0).abs() < 1e-14);
            assert!((tube.second_moment() / metre.powi(4) / (outer[1] - inner[1]) - 1.0).abs() < 1e-14);
        }
        let bar = Section::tube(2.0, 1.0, 0.3).unwrap();
        assert!((bar.area() - PI).abs() < 1e-15 && (bar.second_moment() - PI / 4.0).abs() < 1e-15);
        // Cowper: 6 (1 + ν)/(7 + 6 ν) of a round bar, 2 (1 + ν)/(4 + 3 ν) of a thin tube.
        assert!((bar.shear_factor() - 7.8 / 8.8).abs() < 1e-15);
        assert!((Section::tube(1.0, 1e-9, 0.3).unwrap().shear_factor() - 2.6 / 4.9).abs() < 1e-8);
        assert!(matches!(Section::tube(1.0, 0.6, 0.3), Err(FemError::Wall { .. })));
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
