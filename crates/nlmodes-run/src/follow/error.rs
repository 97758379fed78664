//! Why nothing is followed.

use std::io;
use std::path::PathBuf;

use nlmodes::response::ResponseError;
use nlmodes_scene::SceneError;
use thiserror::Error;

use crate::RunError;

/// Why nothing is followed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FollowError {
    /// The scene cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// Its file.
        path: PathBuf,
        /// Why not.
        #[source]
        source: io::Error,
    },
    /// The scene is not sound, or its parameter has no gradients.
    #[error("{}", .0.text(false))]
    Scene(SceneError),
    /// The window does not hold the value of the scene.
    #[error(
        "`{key}` is {value} in the scene, outside of {} to {}; expected a window that holds it",
        window[0], window[1]
    )]
    Window {
        /// The parameter.
        key: String,
        /// Its value.
        value: f64,
        /// The window.
        window: [f64; 2],
    },
    /// The scene has no such curve.
    #[error("{0}")]
    NoCurve(String),
    /// The scene cannot be computed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A motion is not found again, or the structure changes as it cannot be followed.
    #[error(transparent)]
    Response(#[from] ResponseError),
}

impl From<SceneError> for FollowError {
    fn from(refused: SceneError) -> Self {
        Self::Scene(refused)
    }
}
