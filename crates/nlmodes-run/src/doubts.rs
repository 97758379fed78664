//! Warnings about the files of a structure, before the computation.

use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::Scene;

use crate::Observer;

/// Reports warnings about the files of a structure.
pub fn tell(scene: &Scene, open: Option<&OpenStructure>, observer: &mut dyn Observer) {
    observer.warn(open.map(|open| nlmodes_scene::doubts::of(scene, open)).unwrap_or_default());
}
