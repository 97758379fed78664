use super::{ForceLaw, LawForce};

/// `F = k₁ v + k₂ v² + k₃ v³ + …`, coefficients in N/m, N/m², N/m³, ….
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial {
    /// `k₁, k₂, …`.
    pub coefficients: Vec<f64>,
}

impl ForceLaw for Polynomial {
    fn at(&self, v: f64, _: f64) -> LawForce {
        let (mut force, mut stiffness) = (0.0, 0.0);
        for (i, k) in self.coefficients.iter().enumerate().rev() {
            force = force * v + k;
            stiffness = stiffness * v + (i + 1) as f64 * k;
        }
        LawForce { force: force * v, stiffness, damping: 0.0 }
    }

    fn potential(&self, v: f64) -> f64 {
        let terms = self.coefficients.iter().enumerate().rev();
        terms.fold(0.0, |sum, (i, k)| sum * v + k / (i + 2) as f64) * v * v
    }

    fn degree(&self) -> Option<usize> {
        Some(self.coefficients.len())
    }
}

/// `F = k |v|ⁿ sgn v`; one-sided, `F = k ⟨v⟩ⁿ` with `⟨v⟩ = max(v, 0)`, of a Hertz contact that touches at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerSpring {
    /// `k`, N/mⁿ.
    pub stiffness: f64,
    /// `n`, at least one.
    pub exponent: f64,
    /// Whether it acts against positive displacements alone.
    pub one_sided: bool,
}

impl ForceLaw for PowerSpring {
    fn at(&self, v: f64, _: f64) -> LawForce {
        if self.one_sided && v <= 0.0 {
            return LawForce::default();
        }
        let slope = self.stiffness * v.abs().powf(self.exponent - 1.0);
        LawForce { force: slope * v, stiffness: self.exponent * slope, damping: 0.0 }
    }

    fn potential(&self, v: f64) -> f64 {
        if self.one_sided && v <= 0.0 {
            return 0.0;
        }
        self.stiffness * v.abs().powf(self.exponent + 1.0) / (self.exponent + 1.0)
    }
}

/// `F = F₀ (e^{v/v₀} − 1)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponential {
    /// `F₀`, N.
    pub force: f64,
    /// `v₀`, m.
    pub length: f64,
}

impl ForceLaw for Exponential {
    fn at(&self, v: f64, _: f64) -> LawForce {
        let s = v / self.length;
        LawForce { force: self.force * s.exp_m1(), stiffness: self.force / self.length * s.exp(), damping: 0.0 }
    }

    fn potential(&self, v: f64) -> f64 {
        let s = v / self.length;
        self.force * self.length * (s.exp_m1() - s)
    }
}

/// A spring whose stiffness changes at a displacement on either side: `k₁` up to `|v| = v₁`, `k₂` beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bilinear {
    /// `k₁`, N/m.
    pub inner: f64,
    /// `k₂`, N/m.
    pub outer: f64,
    /// `v₁`, m.
    pub knee: f64,
}

impl ForceLaw for Bilinear {
    fn at(&self, v: f64, _: f64) -> LawForce {
        let beyond = (v.abs() - self.knee).max(0.0).copysign(v);
        let stiffness = if v.abs() > self.knee { self.outer } else { self.inner };
        LawForce { force: self.inner * v + (self.outer - self.inner) * beyond, stiffness, damping: 0.0 }
    }

    fn potential(&self, v: f64) -> f64 {
        let beyond = (v.abs() - self.knee).max(0.0);
        0.5 * (self.inner * v * v + (self.outer - self.inner) * beyond * beyond)
    }
}

/// `F = c |v̇|ⁿ sgn v̇`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerDamper {
    /// `c`, N (s/m)ⁿ.
    pub coefficient: f64,
    /// `n`, at least one.
    pub exponent: f64,
}

impl ForceLaw for PowerDamper {
    fn at(&self, _: f64, rate: f64) -> LawForce {
        let slope = self.coefficient * rate.abs().powf(self.exponent - 1.0);
        LawForce { force: slope * rate, stiffness: 0.0, damping: self.exponent * slope }
    }

    fn potential(&self, _: f64) -> f64 {
        0.0
    }

    fn degree(&self) -> Option<usize> {
        // Odd powers are polynomials.
        (self.exponent % 2.0 == 1.0).then_some(self.exponent as usize)
    }

    fn dissipates(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Derivatives against differences, and the force as the derivative of the potential.
    #[test]
    fn forces_are_derivatives_of_their_potentials() {
        let laws: [Box<dyn ForceLaw>; 6] = [
            Box::new(Polynomial { coefficients: vec![2.0, -0.7, 3.0, 0.4] }),
            Box::new(PowerSpring { stiffness: 3.0, exponent: 1.5, one_sided: false }),
            Box::new(PowerSpring { stiffness: 3.0, exponent: 1.5, one_sided: true }),
            Box::new(Exponential { force: 0.8, length: 0.6 }),
            Box::new(Bilinear { inner: 2.0, outer: 9.0, knee: 0.4 }),
            Box::new(PowerDamper { coefficient: 1.3, exponent: 2.0 }),
        ];
        let h = 1e-6;
        for law in &laws {
            for v in [-1.1, -0.3, 0.2, 0.9] {
                let rate = 0.8 - v;
                let at = law.at(v, rate);
                let slope = (law.at(v + h, rate).force - law.at(v - h, rate).force) / (2.0 * h);
                let damping = (law.at(v, rate + h).force - law.at(v, rate - h).force) / (2.0 * h);
                let force = (law.potential(v + h) - law.potential(v - h)) / (2.0 * h);
                assert!((slope - at.stiffness).abs() < 1e-7, "{law:?} at {v}: {slope} {at:?}");
                assert!((damping - at.damping).abs() < 1e-7, "{law:?} at {v}: {damping} {at:?}");
                let stored = if law.dissipates() { 0.0 } else { at.force };
                assert!((force - stored).abs() < 1e-7, "{law:?} at {v}: {force} {at:?}");
            }
        }
    }
}
