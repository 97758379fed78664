//! Files of a structure and contacts of its nodes.

use std::path::Path;

use nlmodes_io::{
    Address, ContactChoice, ContactNodes, FeFiles, Format, GapChoice, NodeChoice, NormalChoice, Partner, UnitSystem,
};

use super::contact::{law, laws_apart};
use crate::raw::{NameOrNumbers, NumberOrName, RawMatrices, RawMatrixScene, RawNodeContact, RawNormal};
use crate::scene::Matrices;
use crate::{Diagnostic, Diagnostics};

/// The files and the contacts that are sound; paths count from `base`.
pub fn check(raw: &RawMatrixScene, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<Matrices> {
    let files = files(&raw.structure, base, diagnostics);
    let contacts = raw.contact.iter().flatten().enumerate();
    let contacts: Vec<Option<ContactChoice>> = contacts.map(|(i, raw)| contact(raw, i, base, diagnostics)).collect();
    let written = raw.contact.iter().flatten().enumerate();
    let laws = written.map(|(i, raw)| law(i, &raw.stop, raw.friction_estimate, diagnostics)).collect();
    let units_are_assumed = raw.structure.units.is_none();
    let (contacts, law_contacts) = laws_apart(contacts, laws, diagnostics)?;
    Some(Matrices { files: files?, contacts, law_contacts, units_are_assumed })
}

fn files(raw: &RawMatrices, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<FeFiles> {
    let units = parsed::<UnitSystem>("units", raw.units.as_deref().unwrap_or("m-kg-s"), diagnostics);
    let format = match raw.format.as_deref() {
        Some(name) => Some(parsed::<Format>("format", name, diagnostics)?),
        None => None,
    };
    let fixed = raw.fixed.iter().flatten().map(|choice| match choice {
        NumberOrName::Number(node) => NodeChoice::Node(*node),
        NumberOrName::Name(set) => NodeChoice::Set(set.clone()),
    });
    Some(FeFiles {
        stiffness: Address::parse(&raw.stiffness).within(base),
        mass: Address::parse(&raw.mass).within(base),
        dofs: raw.dofs.as_ref().map(|path| base.join(path)),
        mesh: raw.mesh.as_ref().map(|path| base.join(path)),
        format,
        units: units?,
        fixed: fixed.collect(),
    })
}

pub(super) fn parsed<T: std::str::FromStr<Err: std::fmt::Display>>(
    key: &str,
    text: &str,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<T> {
    let found = text.parse::<T>();
    if let Err(error) = &found {
        diagnostics.put(&format!("structure.{key}"), Diagnostic::error(error.to_string()), "found here");
    }
    found.ok()
}

fn contact(raw: &RawNodeContact, i: usize, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<ContactChoice> {
    let before = diagnostics.count();
    let partner = partner(raw, i, base, diagnostics);
    let nodes = nodes_of(raw, i, diagnostics);
    let normal = normal(raw, i, diagnostics);
    let gap = gap(raw, i, diagnostics);
    let sound = diagnostics.count() == before;
    let (stiffness, damping, friction_estimate) =
        (raw.stop.stiffness_n_m, raw.stop.damping_n_s_m, raw.friction_estimate);
    sound.then_some(ContactChoice { nodes: nodes?, partner, normal, gap, stiffness, damping, friction_estimate })
}

/// A diagnostic of contact `i`, at the key if there is one.
fn refuse(i: usize, key: &str, title: &str, label: &str, diagnostics: &mut Diagnostics<'_>) {
    let path = if key.is_empty() { format!("contact.{i}") } else { format!("contact.{i}.{key}") };
    diagnostics.put(&path, Diagnostic::error(format!("`{path}`: {title}")), label);
}

fn partner(raw: &RawNodeContact, i: usize, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Partner {
    if raw.pair_tolerance_m.is_some() && raw.against.is_none() {
        let path = format!("contact.{i}.pair_tolerance_m");
        let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
        diagnostics.put(&path, diagnostic, "only nodes that are sought among those of `against` have a tolerance");
    }
    match (&raw.against, &raw.pairs) {
        (None, None) => Partner::Wall,
        (Some(against), None) => Partner::Nearest(nodes(against), raw.pair_tolerance_m),
        (None, Some(path)) => Partner::Table(base.join(path)),
        (Some(_), Some(path)) => {
            refuse(i, "pairs", "`against` says it already", "expected one of `against` and `pairs`", diagnostics);
            Partner::Table(base.join(path))
        }
    }
}

fn nodes_of(raw: &RawNodeContact, i: usize, diagnostics: &mut Diagnostics<'_>) -> Option<ContactNodes> {
    match (raw.node, &raw.nodes, &raw.pairs) {
        (None, None, Some(_)) => Some(ContactNodes::OfPairs),
        (Some(node), None, None) => Some(ContactNodes::Numbers(vec![node])),
        (None, Some(chosen), None) => Some(nodes(chosen)),
        // What is missing was reported already.
        (None, None, None) => None,
        _ => {
            let label = "expected one of `node`, `nodes` and `pairs`";
            refuse(i, "", "the nodes are given twice", label, diagnostics);
            None
        }
    }
}

fn normal(raw: &RawNodeContact, i: usize, diagnostics: &mut Diagnostics<'_>) -> Option<NormalChoice> {
    match &raw.normal {
        Some(RawNormal::Vector(vector)) if vector.iter().all(|x| *x == 0.0) => {
            refuse(i, "normal", "the normal has no direction", "expected 3 numbers, not all 0", diagnostics);
            None
        }
        Some(RawNormal::Vector(vector)) => Some(NormalChoice::Vector(*vector)),
        Some(RawNormal::Word(_)) => Some(NormalChoice::Surface),
        None => {
            if raw.pairs.is_none() {
                let label = "expected `normal` in this table: 3 numbers in square brackets, or \"surface\"";
                refuse(i, "", "the direction to what the nodes touch is missing", label, diagnostics);
            }
            None
        }
    }
}

fn gap(raw: &RawNodeContact, i: usize, diagnostics: &mut Diagnostics<'_>) -> Option<GapChoice> {
    match (raw.gap_m, raw.wall_point_m) {
        (Some(_), Some(_)) => {
            let label = "expected one of `gap_m` and `wall_point_m`";
            refuse(i, "wall_point_m", "`gap_m` says the gap already", label, diagnostics);
            None
        }
        (None, Some(_)) if raw.against.is_some() || raw.pairs.is_some() => {
            let label = "expected `gap_m` of two bodies";
            refuse(i, "wall_point_m", "there is no wall between two bodies", label, diagnostics);
            None
        }
        (Some(gap), None) => Some(GapChoice::Same(gap)),
        (None, Some(point)) => Some(GapChoice::WallPoint(point)),
        (None, None) => {
            if raw.pairs.is_none() && raw.against.is_none() {
                let label = "expected `gap_m`, or `wall_point_m` of a wall, in this table";
                refuse(i, "", "the gap is missing", label, diagnostics);
            }
            None
        }
    }
}

/// The nodes of a contact or a load.
pub fn nodes(raw: &NameOrNumbers) -> ContactNodes {
    match raw {
        NameOrNumbers::Name(name) => ContactNodes::Set(name.clone()),
        NameOrNumbers::Numbers(numbers) => ContactNodes::Numbers(numbers.clone()),
    }
}
