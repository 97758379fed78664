use std::path::Path;

use nlmodes::modal::HarmonicCoefficients;
use nlmodes_scene::scene::Scene;

use crate::verify::{VerifyError, results};

/// A periodic motion of results as its harmonics.
pub struct Motion {
    /// Its angular frequency, rad/s.
    pub omega: f64,
    /// Coefficients of the displacements of the recorded degrees of freedom, m.
    pub coefficients: HarmonicCoefficients,
}

impl Motion {
    /// Reads a point of `harmonics.npz`.
    ///
    /// # Errors
    /// [`VerifyError`] if there is none.
    pub fn read(directory: &Path, point: usize) -> Result<Self, VerifyError> {
        let path = directory.join(results::HARMONICS);
        if !path.is_file() {
            return Err(VerifyError::Missing { name: results::HARMONICS });
        }
        let (omega, coefficients, _) = results::read_motion(&path, point)?;
        Ok(Self { omega, coefficients })
    }
}

/// The scene of results.
///
/// # Errors
/// [`VerifyError`] if there are none.
pub(crate) fn scene_of(directory: &Path) -> Result<Scene, VerifyError> {
    results::scene_of(directory)
}
