//! Numbers without a pattern, the same each time.

/// Signs from a linear congruential generator, the same each time.
pub(crate) struct Signs(u64);

impl Default for Signs {
    fn default() -> Self {
        Self(1)
    }
}

impl Signs {
    pub fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if self.0 >> 63 == 0 { 1.0 } else { -1.0 }
    }

    /// A number between −1 and 1, to which no symmetry is known.
    pub fn draw_between(&mut self) -> f64 {
        let sign = self.draw();
        sign * ((self.0 << 1) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
