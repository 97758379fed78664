//! What looks wrong in the files of a structure and in its contacts, once they are read: nothing that prevents
//! of a computation.

mod alone;
mod amplitude;
mod base;
mod digits;
mod distances;
mod mesh;
mod modes;
mod normals;
mod reduced;
mod scale;

pub(crate) use base::unplaced_unknowns;
pub use modes::contacts_balance;
use nlmodes_io::{ContactChoice, FeModel, NodeContact, Skin};

use crate::assemble::OpenStructure;
use crate::rule::significant;
use crate::scene::{Matrices, Scene};

/// What a user should know of a structure from files, or of one that was reduced elsewhere, before trusting what comes
/// out, in sentences; none of other structures.
pub fn of(scene: &Scene, open: &OpenStructure) -> Vec<String> {
    if let Some(elsewhere) = &open.elsewhere {
        return reduced::doubts(elsewhere, open).into_iter().chain(modes::doubts(scene, open)).collect();
    }
    let (Some(matrices), Some((model, found))) = (scene.structure.matrices(), &open.files) else {
        return modes::of_bodies(scene, open).into_iter().collect();
    };
    let skin = model.mesh.as_ref().map(Skin::of_solids).unwrap_or_default();
    let subject = Subject { matrices, model, found, skin: &skin };
    let (scale, mesh) = (scale::doubts(&subject), mesh::doubts(&subject));
    // With other units all distances are others.
    let distances = if scale.is_some() { Vec::new() } else { distances::doubts(&subject) };
    let mode = if scale.is_some() { None } else { amplitude::doubt(scene, open, &subject) };
    let mesh = mesh.into_iter().chain(alone::doubt(&subject));
    let contacts = normals::doubts(&subject).into_iter().chain(distances);
    let modes = mode.into_iter().chain(digits::doubt(scene, open, model)).chain(modes::doubts(scene, open));
    mesh.chain(scale).chain(contacts).chain(modes).chain(base::doubt(scene, &subject)).collect()
}

/// What is looked at.
struct Subject<'a> {
    matrices: &'a Matrices,
    model: &'a FeModel,
    found: &'a [NodeContact],
    /// Of the solids of the mesh.
    skin: &'a Skin,
}

impl Subject<'_> {
    /// Each choice of contacts with its number and those that come of it.
    fn choices(&self) -> impl Iterator<Item = (usize, &ContactChoice, Vec<&NodeContact>)> {
        let of = |origin| self.found.iter().filter(move |contact| contact.origin == origin).collect();
        self.matrices.contacts.iter().enumerate().map(move |(origin, choice)| (origin, choice, of(origin)))
    }

    /// Longest side of the box around the nodes that have rows, m; none where fewer than two places are known.
    fn extent(&self) -> Option<f64> {
        let places: Vec<[f64; 3]> =
            self.model.nodes().into_iter().filter_map(|node| self.model.place_of(node)).collect();
        let side = |axis: usize| {
            let values = || places.iter().map(|place| place[axis]);
            values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
        };
        let longest = (0..3).map(side).fold(0.0, f64::max);
        (longest > 0.0 && longest.is_finite()).then_some(longest)
    }
}

/// `all 4 nodes` or `3 of 4 nodes`.
fn of_all(some: usize, all: usize) -> String {
    match (some == all, all) {
        (true, 1) => "its node".into(),
        (true, _) => format!("all {all} nodes"),
        (false, _) => format!("{some} of {all} nodes"),
    }
}

/// To three digits.
fn short(x: f64) -> String {
    significant(x, 3)
}

fn vector(vector: [f64; 3]) -> String {
    let [x, y, z] = vector.map(short);
    format!("[{x}, {y}, {z}]")
}
