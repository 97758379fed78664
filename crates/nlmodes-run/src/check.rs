//! Whether a run can start, and what it would compute.

use nlmodes_scene::outline::Outline;
use nlmodes_scene::{RecordScene, SceneFile, TestScene};

use crate::updating::updated;
use crate::{Event, Observer, RunError, branches, mass, no_contact, records, virtual_test};

/// Whether there were warnings, which are passed on.
struct Warned<'a> {
    observer: &'a mut dyn Observer,
    /// Whether there was a warning, those of the scene itself included.
    any: bool,
}

impl<'a> Warned<'a> {
    fn of<S>(file: &SceneFile<S>, observer: &'a mut dyn Observer) -> Self {
        Self { observer, any: !file.warnings.is_empty() }
    }
}

impl Observer for Warned<'_> {
    fn event(&mut self, event: Event<'_>) {
        self.any |= matches!(event, Event::Warning(_));
        self.observer.event(event);
    }
}

/// What the scene of a structure would compute, where a run of it would begin; what a user should know before, goes to
/// the observer.
///
/// # Errors
/// [`RunError`] with the reason if no run can start.
pub fn check(file: &SceneFile, observer: &mut dyn Observer) -> Result<Outline, RunError> {
    if file.scene.is_linear() && file.scene.transient.is_none() {
        return Err(no_contact(file).into());
    }
    let (updated, mut told) = (updated(file.clone())?, Warned::of(file, observer));
    mass::warning_of(&updated)?.iter().for_each(|text| told.event(Event::Warning(text)));
    let (open, state) = branches::check(&updated, &mut told)?;
    Ok(Outline::of_structure(&file.scene, (open.as_ref(), state.as_ref()), told.any))
}

/// What would be extracted from records, where all of them are there.
///
/// # Errors
/// [`RunError::Scene`] with each that is not, at its place in the scene.
pub fn check_records(file: &SceneFile<RecordScene>, observer: &mut dyn Observer) -> Result<Outline, RunError> {
    let mut told = Warned::of(file, observer);
    records::check(file, &mut told).map(|()| Outline::of_records(&file.scene, told.any))
}

/// What a virtual test would record, if it can start.
///
/// # Errors
/// [`RunError`] with the reason if not.
pub fn check_test(file: &SceneFile<TestScene>, observer: &mut dyn Observer) -> Result<Outline, RunError> {
    let mut told = Warned::of(file, observer);
    virtual_test::check(file, &mut told).map(|()| Outline::of_test(&file.scene, told.any))
}
