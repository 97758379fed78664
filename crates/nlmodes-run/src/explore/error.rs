//! Why there is no page.

use std::io;
use std::path::PathBuf;

use nlmodes_scene::SceneError;
use thiserror::Error;

/// Why there is no page of a scene.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExploreError {
    /// The scene cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// Its file.
        path: PathBuf,
        /// Why not.
        #[source]
        source: io::Error,
    },
    /// The scene is not sound.
    #[error("{}", .0.text(false))]
    Scene(SceneError),
    /// There is no scene in the file.
    #[error("there is no scene in {}", .0.display())]
    NoScene(PathBuf),
    /// The machine gives no port or no random number.
    #[error(transparent)]
    Server(#[from] io::Error),
}

impl From<SceneError> for ExploreError {
    fn from(refused: SceneError) -> Self {
        Self::Scene(refused)
    }
}
