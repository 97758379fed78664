/// When a loop counts as locked.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LockSettings {
    /// Largest lag error, rad.
    pub tolerance: f64,
    /// Time for which the error has to stay below it, s.
    pub duration: f64,
}

impl Default for LockSettings {
    /// One degree for half a second.
    fn default() -> Self {
        Self { tolerance: 1f64.to_radians(), duration: 0.5 }
    }
}

impl LockSettings {
    /// Time within the tolerance, s, after another step with this error.
    pub(crate) fn count(&self, within: f64, error: Option<f64>, step: f64) -> f64 {
        if error.is_some_and(|error| error.abs() <= self.tolerance) { within + step } else { 0.0 }
    }
}
