//! Results of other runs, and of tests, laid over those of a scene, with the differences in numbers.

mod contacts;
mod differences;
mod read;
mod said;
mod stops;
mod written;

pub use differences::{Difference, Equal, at_equal_frequency, differences};
pub use read::{Laid, OverlayError, read};
pub(crate) use read::{contacts_beside, number};
pub(crate) use said::{by, percent};
pub use said::{sentence, sentence_at_equal_frequency, table};
pub use stops::{StopChange, changes, lines, stops_table};
pub use written::{write, write_stops};

use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::Overlay;

use crate::{RunError, refusal};

/// What is laid over the results of a scene.
pub(crate) fn laid_over<S>(file: &SceneFile<S>, overlays: &[Overlay]) -> Result<Vec<Laid>, RunError> {
    let read = |(k, found): (usize, &Overlay)| {
        read(found).map_err(|error| refusal::at(file, &format!("overlay.{k}.path"), &error))
    };
    overlays.iter().enumerate().map(read).collect()
}
