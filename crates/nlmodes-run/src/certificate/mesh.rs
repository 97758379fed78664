//! The linear frequency compared with that of the next finer mesh, and with the mass of the contacts.

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::model::{MassShift, linear_modes};
use nlmodes_scene::assemble::{OpenStructure, element_model};
use nlmodes_scene::counted;
use nlmodes_scene::scene::{Contact, Scene, SceneStructure, Structure};

use super::{Check, ErrorSource, Number, SourceKind};

const MESH: &str = "mesh";
/// Most elements of the finer mesh: its modes take a fraction of a second.
const MOST: usize = 2000;

/// Most rigid-body motions of a straight structure, and their frequency, over that of the last mode beyond them, up to
/// which a mode is one.
const RIGID_MOTIONS: usize = 3;
const RIGID: f64 = 1e-3;

/// Change of the linear frequency of the mode with twice as many elements: contacts open, but those that press at rest,
/// their mass kept.
pub fn frequency(scene: &Scene, open: Option<&OpenStructure>) -> Check {
    let missing = |why: &str, how| Check::missing(MESH, Some(Number::Frequency), why, how);
    let own = match &scene.structure {
        SceneStructure::Straight(own) => own,
        SceneStructure::Several(_) => return missing("there are several structures", "elements twice as many in each"),
        SceneStructure::Reduced(_) => {
            return missing("the structure was reduced elsewhere", "modes and flexibility of a finer mesh");
        }
        SceneStructure::Matrices(_) => {
            return missing("the structure comes from files", "a finer mesh in the program that wrote them");
        }
    };
    if own.modes.is_some() {
        return missing("frequencies are imposed on the modes", "the same scene without [structure.modes]");
    }
    let Some(finer) = own.with_twice_the_elements() else {
        return missing("parts are at nodes that a finer mesh has elsewhere", "structure.elements twice as large");
    };
    if finer.elements > MOST {
        return missing("more than 1000 elements", "structure.elements twice as large");
    }
    let mode = scene.method.mode;
    let rest = open.and_then(|open| {
        let closed = open.state.as_ref()?.rest.closed.get(..open.modes.n_contacts())?;
        Some((open.modes.n_modes(), closed))
    });
    let pressed = rest.filter(|(_, closed)| closed.contains(&true));
    let frequencies = match pressed {
        Some(pressed) => {
            let contacts = at_same_places(own, &finer, &scene.contacts);
            let fine = contacts.and_then(|contacts| omega_at_rest(&finer, &contacts, pressed, mode));
            (omega_at_rest(own, &scene.contacts, pressed, mode), fine)
        }
        None => (omega(own, mode), omega(&finer, mode)),
    };
    match frequencies {
        (Some(coarse), Some(fine)) if fine > 0.0 => {
            let words = format!(
                "linear frequency of mode {mode} with {} elements for {}; forces were not compared. Says nothing where \
                    the elements are the structure, as in a chain of masses",
                finer.elements, own.elements
            );
            let source = ErrorSource {
                kind: SourceKind::Mesh,
                name: counted(own.elements, "element"),
                command: format!("--set structure.elements={}", finer.elements),
            };
            Check::estimate(MESH, (Number::Frequency, source), (coarse / fine - 1.0).abs(), words)
        }
        _ => missing("the linear modes of the finer mesh were not found", "structure.elements twice as large"),
    }
}

fn omega(structure: &Structure, mode: usize) -> Option<f64> {
    let model = element_model(structure, &[]).ok()?;
    let found = linear_modes(model.mass(), model.stiffness(), mode + RIGID_MOTIONS).ok()?;
    let least = RIGID * found.omega.last()?;
    found.omega.get(mode.checked_sub(1)?).copied().filter(|omega| *omega > least)
}

/// Share of the length within which a node of the finer mesh is at the place of one of the mesh.
const SAME_PLACE: f64 = 1e-9;

/// The contacts at the nodes of the finer mesh; none where one of them has no node there.
fn at_same_places(own: &Structure, finer: &Structure, contacts: &[Contact]) -> Option<Vec<Contact>> {
    let [from, to] = [own.mesh().ok()?, finer.mesh().ok()?];
    let node = |contact: &Contact| {
        let place = *from.nodes().get(contact.node)?;
        to.nodes().iter().position(|at| (at - place).abs() <= SAME_PLACE * own.length)
    };
    contacts.iter().map(|contact| Some(Contact { node: node(contact)?, ..*contact })).collect()
}

/// The same with the contacts of `closed` held, of as many open modes as are taken of the structure.
fn omega_at_rest(
    structure: &Structure,
    contacts: &[Contact],
    (modes, closed): (usize, &[bool]),
    mode: usize,
) -> Option<f64> {
    let model = element_model(structure, contacts).ok()?;
    let open = OpenModes::of_model(&model, ModeCount::Lowest(modes)).ok()?;
    let squares = open.closed_modes(closed).ok()?.omega_squared;
    squares.get(mode.checked_sub(1)?).map(|square| square.sqrt())
}

/// Change of the linear frequency by the mass that the contacts lose; nothing where they lose none, or the frequency is
/// one that was measured: imposed, or met by parameters.
pub(crate) fn contact_mass(shift: Option<MassShift>) -> Option<Check> {
    let shift = shift?;
    let source = ErrorSource {
        kind: SourceKind::ContactMass,
        name: "mass of the contacts left out".to_owned(),
        command: "--set 'reduction.kind=\"open-modes\"'".to_owned(),
    };
    let words = format!("linear frequency of mode {} without the mass of the contact nodes", shift.mode);
    Some(Check::estimate("contact mass", (Number::Frequency, source), shift.relative().abs(), words))
}

/// What the digits of the files leave open of the linear frequency of a mode; nothing of other structures.
pub(crate) fn digits(open: &OpenStructure, mode: usize) -> Option<Check> {
    let share = open.modes.left_open(mode)?;
    let (files, _) = open.files.as_ref()?;
    let source = ErrorSource {
        kind: SourceKind::Digits,
        name: format!("{} of the files", files.digits[0]),
        command: "matrices in double precision".to_owned(),
    };
    let words = format!(
        "standard deviation of the linear frequency of mode {mode} with the stiffness known to {}",
        files.digits[0]
    );
    Some(Check::estimate("digits", (Number::Frequency, source), share, words))
}
