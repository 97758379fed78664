//! Results of other runs, and of tests, laid over those of a scene, with the differences in numbers.

mod compared;
mod contacts;
mod curves;
mod differences;
mod read;
mod said;
mod stops;
mod unused;
mod written;

pub(crate) use compared::Overlaid;
pub(crate) use curves::{LaidCurve, curves};
pub use differences::{Difference, Equal, at_equal_frequency, differences};
pub use read::{Laid, OverlayError, read};
pub(crate) use read::{MODES, OF_TESTS, contacts_beside, contacts_of, read_with_unused};
pub(crate) use said::{by, percent};
pub use said::{sentence, sentence_at_equal_frequency, table};
pub use stops::{StopChange, changes, lines, stops_table};
pub(crate) use unused::Unused;
pub use written::{write, write_stops};

pub use crate::sheet::SheetError;

use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::Overlay;

use crate::{Observer, RunError, refusal};

/// What is laid over the results of a scene, of responses a curve of the first of these kinds; of how many rows nothing
/// is used, goes to the observer.
///
/// # Errors
/// [`RunError`] at the overlay that cannot be read.
pub(crate) fn laid_over<S>(
    file: &SceneFile<S>,
    overlays: &[Overlay],
    kinds: &[&str],
    observer: &mut dyn Observer,
) -> Result<Vec<Laid>, RunError> {
    read_all(file, overlays, observer, |overlay| read_with_unused(overlay, kinds))
}

/// The same, each read in this way.
///
/// # Errors
/// As [`laid_over`].
pub(crate) fn read_all<S, T>(
    file: &SceneFile<S>,
    overlays: &[Overlay],
    observer: &mut dyn Observer,
    read: impl Fn(&Overlay) -> Result<(T, Unused), OverlayError>,
) -> Result<Vec<T>, RunError> {
    let mut all = Vec::new();
    for (k, overlay) in overlays.iter().enumerate() {
        let (laid, unused) = read(overlay).map_err(|error| refusal::at(file, &format!("overlay.{k}.path"), &error))?;
        observer.warn(unused.sentence(&overlay.path));
        all.push(laid);
    }
    Ok(all)
}
