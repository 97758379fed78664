use std::sync::Arc;

use super::{ForceLaw, LawForce};

/// A stop whose force grows with a power of the approach, with dissipation by Hunt and Crossley (1975).
///
/// ```text
/// F = k δⁿ max(0, 1 + χ δ̇) ,   δ = ⟨v − g₀⟩
/// ```
///
/// `n = 3/2` is that of two round bodies (Hertz 1882). It only ever pushes; without dissipation (`χ = 0`) it has a
/// potential.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzStop {
    /// `k`, N/mⁿ.
    pub stiffness: f64,
    /// `n`, at least one.
    pub exponent: f64,
    /// Clearance `g₀` at rest, m; negative of one that presses there.
    pub gap: f64,
    /// `χ`, s/m; zero for none.
    pub dissipation: f64,
}

impl ForceLaw for HertzStop {
    fn at(&self, v: f64, rate: f64) -> LawForce {
        let (approach, share) = (v - self.gap, 1.0 + self.dissipation * rate);
        if approach <= 0.0 || share <= 0.0 {
            return LawForce::default();
        }
        let slope = self.stiffness * approach.powf(self.exponent - 1.0);
        let elastic = slope * approach;
        LawForce {
            force: elastic * share,
            stiffness: self.exponent * slope * share,
            damping: elastic * self.dissipation,
        }
    }

    fn potential(&self, v: f64) -> f64 {
        let approach = (v - self.gap).max(0.0);
        self.stiffness * approach.powf(self.exponent + 1.0) / (self.exponent + 1.0)
    }

    fn dissipates(&self) -> bool {
        self.dissipation > 0.0
    }

    fn without_dissipation(&self) -> Option<Arc<dyn ForceLaw>> {
        Some(Arc::new(Self { dissipation: 0.0, ..*self }))
    }

    fn stop_gap(&self) -> Option<f64> {
        Some(self.gap)
    }

    fn stop_moved(&self, by: f64) -> Option<Arc<dyn ForceLaw>> {
        Some(Arc::new(Self { gap: self.gap - by, ..*self }))
    }

    fn continued(&self, v: f64, rate: f64) -> f64 {
        self.at(v, 0.0).force * (1.0 + self.dissipation * rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Derivatives against differences, and the elastic force as the derivative of the potential.
    #[test]
    fn a_stop_pushes_and_its_derivatives_are_those_of_its_force() {
        let stop = HertzStop { stiffness: 3.0, exponent: 1.5, gap: 0.4, dissipation: 0.7 };
        let h = 1e-6;
        for (v, rate) in [(0.3, 1.0), (0.5, 0.8), (0.9, -0.6), (1.4, -1.3), (1.4, -1.6)] {
            let at = stop.at(v, rate);
            let slope = (stop.at(v + h, rate).force - stop.at(v - h, rate).force) / (2.0 * h);
            let damping = (stop.at(v, rate + h).force - stop.at(v, rate - h).force) / (2.0 * h);
            assert!((slope - at.stiffness).abs() < 1e-8 && (damping - at.damping).abs() < 1e-8, "{v}: {at:?}");
            let stored = (stop.potential(v + h) - stop.potential(v - h)) / (2.0 * h);
            assert!((stop.at(v, 0.0).force - stored).abs() < 1e-8, "{v}: {stored}");
            assert!(at.force >= 0.0);
        }
        assert_eq!(stop.at(1.4, -1.5).force, 0.0);
        let elastic = stop.without_dissipation().unwrap();
        assert!(stop.dissipates() && !elastic.dissipates());
        assert_eq!(elastic.at(0.9, -0.6).force, stop.at(0.9, 0.0).force);
    }
}
