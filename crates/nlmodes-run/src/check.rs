//! Whether a run would begin, and what it would compute.

use nlmodes_scene::outline::Outline;
use nlmodes_scene::{RecordScene, SceneFile, TestScene};

use crate::updating::updated;
use crate::{Event, Observer, RunError, branches, mass, no_contact, records, virtual_test};

/// What the scene of a structure would compute, where a run of it would begin; what a user should know before, goes to the observer.
///
/// # Errors
/// [`RunError`] that says why no run would begin.
pub fn check(file: &SceneFile, observer: &mut dyn Observer) -> Result<Outline, RunError> {
    if file.scene.n_contact_tables() == 0 {
        return Err(no_contact(file).into());
    }
    let updated = updated(file.clone())?;
    let warning = mass::warning_of(&updated)?;
    warning.iter().for_each(|text| observer.event(Event::Warning(text)));
    let open = branches::check(&updated, observer)?;
    let warned = warning.is_some() || !file.warnings.is_empty();
    Ok(Outline::of_structure(&file.scene, open.as_ref(), warned))
}

/// What would be extracted from records, where all of them are there.
///
/// # Errors
/// [`RunError::Scene`] with each that is not, at its place in the scene.
pub fn check_records(file: &SceneFile<RecordScene>, observer: &mut dyn Observer) -> Result<Outline, RunError> {
    records::check(file, observer).map(|()| Outline::of_records(&file.scene, !file.warnings.is_empty()))
}

/// What a virtual test would record, where it would come to its first sample.
///
/// # Errors
/// [`RunError`] that says why it would not.
pub fn check_test(file: &SceneFile<TestScene>, observer: &mut dyn Observer) -> Result<Outline, RunError> {
    virtual_test::check(file, observer).map(|()| Outline::of_test(&file.scene, !file.warnings.is_empty()))
}
