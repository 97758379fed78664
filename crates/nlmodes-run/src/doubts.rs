//! Warnings about the files of a structure, before the computation.

use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::Scene;

use crate::{Event, Observer};

/// Reports warnings about the files of a structure.
pub fn tell(scene: &Scene, open: Option<&OpenStructure>, observer: &mut dyn Observer) {
    let doubts = open.map(|open| nlmodes_scene::doubts::of(scene, open)).unwrap_or_default();
    doubts.iter().for_each(|text| observer.event(Event::Warning(text)));
}
