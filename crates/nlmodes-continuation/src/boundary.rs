use std::fmt;

/// Of `z = (x, p)`.
type Function = dyn Fn(&[f64]) -> f64;

/// The boundary between two smooth pieces of a [`ParametricSystem`](crate::ParametricSystem): where a smooth function
/// of `z = (x, p)` vanishes.
pub struct Boundary {
    value: Box<Function>,
}

impl Boundary {
    /// From a function that is positive on the one piece and negative on the other.
    pub fn new(value: impl Fn(&[f64]) -> f64 + 'static) -> Self {
        Self { value: Box::new(value) }
    }

    /// The function at `z`, n + 1: positive before the boundary, negative beyond.
    pub fn value(&self, z: &[f64]) -> f64 {
        (self.value)(z)
    }
}

impl fmt::Debug for Boundary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Boundary")
    }
}
