//! Errors of a computation, at the key of the scene that they are about.

use std::error::Error;

use nlmodes::branches::BranchError;
use nlmodes::hbm::HbmError;
use nlmodes::model::ModelError;
use nlmodes::model::reduction::OpenModes;
use nlmodes::timestep::TimestepError;
use nlmodes_scene::assemble::{OpenStructure, StaticState, Strainless};
use nlmodes_scene::doubts::contacts_balance;
use nlmodes_scene::scene::{Direction, ResponseKind, Scene, SceneStructure, StructureKind};
use nlmodes_scene::{SceneError, SceneFile, short};

use crate::{RunError, chain};

/// An error of a branch of a structure in open modes: where it floats and its contacts do not hold it, that is the
/// reason.
pub fn of_branch_in(file: &SceneFile, open: Option<&OpenStructure>, error: &BranchError) -> RunError {
    let is_static = matches!(error, BranchError::Hbm(HbmError::Model(ModelError::Linalg { .. })));
    let error = of_branch(file, error);
    if is_static { unless_floating(file, open, error) } else { error }
}

/// An error of statics, or that the contacts do not hold the structure, if they do not.
pub fn unless_floating(file: &SceneFile, open: Option<&OpenStructure>, error: RunError) -> RunError {
    unless_held(file, open).err().unwrap_or(error)
}

/// A structure in open modes must be held by its contacts where nothing else does.
///
/// # Errors
/// [`RunError`] that says which body floats and what to do.
pub fn unless_held(file: &SceneFile, open: Option<&OpenStructure>) -> Result<(), RunError> {
    match open.and_then(|open| Some((open, open.modes.rigid_motions().ok()?))) {
        Some((open, (rigid, left))) if left > 0 => Err(floating(file, open, (rigid, left))),
        _ => Ok(()),
    }
}

/// A structure that responds to loads must be held: while its contacts are open nothing says where it is.
///
/// # Errors
/// [`RunError`] that says which body floats and what to do.
pub fn unless_supported(file: &SceneFile, modes: &OpenModes, open: Option<&OpenStructure>) -> Result<(), RunError> {
    let conservative = file.scene.responses.iter().all(|response| response.kind == ResponseKind::Mode);
    let rigid = modes.rigid_motions().map_or(0, |(rigid, _)| rigid);
    // One that a steady force presses onto its contacts has a place at rest.
    if conservative || rigid == 0 || !modes.steady_force().is_empty() {
        return Ok(());
    }
    // Those of files are known by body, and with what their digits leave open.
    let known = open.map(|open| &open.strainless).filter(|strainless| strainless.count() > 0);
    let of_axis = Strainless::of_rigid_bodies(rigid);
    let title = format!(
        "the structure floats{}: it has {}, and while its contacts are open nothing says where it is",
        known.map(bodies).unwrap_or_default(),
        known.unwrap_or(&of_axis).text()
    );
    let unseen = known.and_then(Strainless::unseen_text);
    let help: Vec<&str> = [support(&file.scene)].into_iter().chain(unseen.as_deref()).collect();
    Err(file.error_at("structure", &title, "", &help).into())
}

/// Which bodies these are, in brackets.
fn bodies(strainless: &Strainless) -> String {
    let nodes: Vec<String> = strainless.floating.iter().map(u64::to_string).collect();
    match nodes.len() {
        0 => String::new(),
        1 => format!(" (the body of node {})", nodes[0]),
        _ => format!(" (the bodies of nodes {})", nodes.join(", ")),
    }
}

/// A branch begins with a mode that strains something, and contacts that do not hold the structure balance each other.
///
/// # Errors
/// [`RunError`] that says which motions of the structure strain nothing, and what to do.
pub fn unless_branch(file: &SceneFile, open: Option<&OpenStructure>) -> Result<(), RunError> {
    let (mode, Some(open)) = (file.scene.method.mode, open) else { return Ok(()) };
    if open.state.as_ref().is_some_and(StaticState::is_carried) {
        return unless_held_by_weight(file, open);
    }
    let count = open.strainless.count();
    if count > 0 && mode > count && !contacts_balance(open, count) {
        return unless_held(file, Some(open));
    }
    if mode > count {
        return Ok(());
    }
    let title = format!(
        "mode {mode} strains nothing{}: the structure has {}",
        if open.strainless.unseen_hz > 0.0 { " that the digits of the files show" } else { "" },
        open.strainless.text()
    );
    let first = open.modes.omega_squared().get(count).map(|square| nlmodes::report::hertz(square.sqrt()));
    let expected = first.map_or_else(
        || "expected a structure with an elastic mode".to_owned(),
        |hz| format!("expected {} or more: that is the first elastic mode, {} Hz", count + 1, short(hz)),
    );
    let unseen = open.strainless.unseen_text();
    let help: Vec<&str> = [support(&file.scene)].into_iter().chain(unseen.as_deref()).collect();
    Err(file.error_at("method.mode", &title, &expected, &help).into())
}

/// About the rest of a structure that its contacts carry, all motions vibrate but those that no contact feels.
///
/// # Errors
/// [`RunError`] that says which mode is the first that vibrates.
pub fn unless_held_by_weight(file: &SceneFile, open: &OpenStructure) -> Result<(), RunError> {
    let (mode, unfelt) = (file.scene.method.mode, open.modes.unfelt_motions().len());
    let Some(state) = open.state.as_ref().filter(|state| state.is_carried() && mode <= unfelt) else { return Ok(()) };
    let first = if unfelt == 1 { "mode 1 is a rigid-body motion" } else { "the first modes are rigid-body motions" };
    let title = format!("mode {mode} strains nothing: {first} that no contact feels");
    let closed = open.modes.closed_modes(&state.rest.closed).ok();
    let first = closed.and_then(|modes| modes.omega_squared.get(unfelt).copied());
    let expected = first.map_or_else(
        || "expected a structure with an elastic mode".to_owned(),
        |square| {
            let hz = short(nlmodes::report::hertz(square.sqrt()));
            format!("expected {} or more: that is the first mode on its contacts, {hz} Hz", unfelt + 1)
        },
    );
    let help = format!("`--set method.mode={}`; modes are counted about the rest on the contacts", unfelt + 1);
    Err(file.error_at("method.mode", &title, &expected, &[&help]).into())
}

/// Position of a support that would help.
fn support(scene: &Scene) -> &'static str {
    match &scene.structure {
        SceneStructure::Straight(_) | SceneStructure::Several(_) => {
            "a support is missing: `start`, `end` or a `[[structure.spring]]`"
        }
        SceneStructure::Matrices(_) => {
            "a support is missing: boundary conditions of the model before its matrices are written, or nodes in \
            `structure.fixed`"
        }
        SceneStructure::Reduced(_) => {
            "a support is missing: boundary conditions of the model before it is reduced, or a soft spring to the \
            ground"
        }
    }
}

/// A structure that its contacts do not hold: the mean of contact forces could not be balanced.
fn floating(file: &SceneFile, open: &OpenStructure, (rigid, left): (usize, usize)) -> RunError {
    let (modes, strain) = if rigid == 1 { ("mode", "strains") } else { ("modes", "strain") };
    let body = bodies(&open.strainless);
    let title = format!(
        "the structure can move as a rigid body{body}: {rigid} {modes} {strain} nothing, and holding all contacts \
        leaves {left} of these motions"
    );
    file.error_at("structure", &title, "", &[support(&file.scene)]).into()
}

/// An error of a branch, at the key of the scene that it is about.
pub fn of_branch(file: &SceneFile, error: &BranchError) -> RunError {
    let path = match error {
        BranchError::Ended(_) => return RunError::Ended,
        BranchError::Hbm(HbmError::NoMassBehindContacts { .. }) => {
            let help = [
                "more `structure.elements` leave nodes with mass beside the stops; `nlmodes-cli modes` shows what is \
                left",
            ];
            return file.error_at("method.mass_redistribution", &chain(error), "", &help).into();
        }
        BranchError::Hbm(HbmError::NeverTouches { mode, frequency_hz, .. }) if stops_beside_bending(&file.scene) => {
            let title =
                format!("mode {mode} ({frequency_hz:.4} Hz) never touches a stop: all stops act along the beam");
            let label = format!("mode {mode} moves across the beam: expected \"transverse\"");
            let help =
                "an axial stop is met by axial modes only: `nlmodes-cli modes` lists all, `method.mode` takes one";
            return file.error_at("contact.0.direction", &title, &label, &[help]).into();
        }
        BranchError::Hbm(
            HbmError::NoSuchMode { .. } | HbmError::NeverTouches { .. } | HbmError::RigidBodyMode { .. },
        ) => "method.mode",
        BranchError::Hbm(HbmError::TouchesAtRest { contact, .. }) => {
            let key = format!("contact.{contact}.gap_m");
            return file
                .error_at(&key, &chain(error), "here", &["a small positive gap starts at the first touch"])
                .into();
        }
        BranchError::Timestep(TimestepError::TooManyModes { most, .. }) => {
            let (key, help) =
                ("method.held_modes", "the modes left out answer statically; or take fewer `structure.elements`");
            let label = format!("expected `held_modes` in this table: a whole number from 1 to {most}");
            return file.error_at(key, &chain(error), &label, &[help]).into();
        }
        BranchError::StartOutsideWindow { .. } => {
            let help =
                "`nlmodes-cli modes` lists the linear frequencies; `continuation.start_frequency_hz` starts elsewhere";
            let label = "expected a window that holds the start";
            return file.error_at("continuation.frequency_hz", &chain(error), label, &[help]).into();
        }
        BranchError::NotEven => "method.symmetry",
        BranchError::Hbm(HbmError::Harmonics { .. }) => "method.harmonics",
        BranchError::Hbm(HbmError::Samples { .. }) => "method.samples",
        BranchError::NoStartTouching { .. } => "contact.0.gap_m",
        BranchError::NoStart { .. } => "continuation.start_frequency_hz",
        BranchError::NoStartAtEnergy { .. } => "continuation.start_energy_ratio",
        BranchError::Contact(_) => "method.contact_solver",
        BranchError::Hbm(HbmError::Model(ModelError::HeldRigidBody { .. })) => {
            let help = "supports, or springs in this direction (`[[structure.spring]]`), hold it; with \
            `reduction.kind = \"open-modes\"` it may float";
            return file.error_at("structure", &chain(error), "", &[help]).into();
        }
        BranchError::Hbm(HbmError::Linalg { .. } | HbmError::Model(_)) => "structure",
        _ => "method",
    };
    // Where Newton's method fails the scene is not to blame.
    let unlucky = matches!(
        error,
        BranchError::NoStart { .. }
            | BranchError::NoStartAtEnergy { .. }
            | BranchError::NoStartTouching { .. }
            | BranchError::Continuation(_)
    );
    let said = file.error_at(path, &chain(error), "", &[]);
    if unlucky { RunError::Failed(said) } else { said.into() }
}

/// Whether all stops of a beam are along its axis.
fn stops_beside_bending(scene: &Scene) -> bool {
    let is_beam = scene.structure.straight().is_some_and(|structure| structure.kind() == StructureKind::Beam);
    is_beam && scene.contacts.iter().all(|c| c.direction == Direction::Axial)
}

/// An error at a key of the scene.
pub fn at<S>(file: &SceneFile<S>, path: &str, error: &(dyn Error + 'static)) -> RunError {
    file.error_at(path, &chain(error), "", &[]).into()
}

/// The same with a mark at the value of the key.
pub fn here(file: &SceneFile, path: &str, error: &(dyn Error + 'static)) -> RunError {
    file.error_at(path, &chain(error), "here", &[]).into()
}

/// A scene of a motion in time has no branch.
///
/// # Errors
/// [`RunError`] at its table.
pub fn unless_in_time(file: &SceneFile) -> Result<(), RunError> {
    if file.scene.transient.is_none() {
        return Ok(());
    }
    let title = "the scene asks for a motion in time, which has no branch";
    let help = "`nlmodes-cli run` computes it";
    Err(file.error_at("transient", title, "expected a scene without [transient] here", &[help]).into())
}

/// A scene without a stop, of which no nonlinear mode can be computed.
pub fn no_contact(file: &SceneFile) -> SceneError {
    let help = [
        "a stop is described under a heading [[contact]], a spring with a law of force under [[spring]]; `nlmodes-cli \
        modes` computes the linear modes without them",
    ];
    file.error_at("contact", "without a stop there is no nonlinear mode to compute", "", &help)
}
