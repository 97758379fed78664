use std::collections::HashSet;

use nlmodes_io::{ContactChoice, GapChoice, NodeContact, Partner};

use super::{Subject, of_all, short};

/// Gap and distance of a pair differ by less than this share of the distance where the mesh is coarse or drawn to few
/// digits.
const DIFFERS: f64 = 0.1;
/// Share of the extent of nodes that touch by which they may be off their places, as in the search for partners.
const BESIDE: f64 = 1e-3;

/// Gaps that do not go with the places of the nodes.
pub fn doubts(subject: &Subject<'_>) -> Vec<String> {
    let extent = subject.extent();
    let solid: HashSet<u32> = subject.skin.nodes().into_iter().collect();
    let of = |(origin, choice, contacts): (usize, &ContactChoice, Vec<&NodeContact>)| {
        let large = extent.and_then(|extent| beyond(origin, choice, &contacts, extent));
        let pressed = pressed(origin, choice, &contacts).filter(|_| large.is_none());
        let off = extent
            .filter(|_| large.is_none())
            .and_then(|extent| off(subject, &solid, origin, (choice, &contacts), extent));
        [large, pressed, off].into_iter().flatten().collect::<Vec<_>>()
    };
    subject.choices().flat_map(of).collect()
}

/// The key of the gap.
fn key(origin: usize, choice: &ContactChoice) -> String {
    match (choice.gap, &choice.partner) {
        (Some(GapChoice::WallPoint(_)), _) => format!("`contact.{origin}.wall_point_m`"),
        (Some(GapChoice::Same(_)), _) => format!("`contact.{origin}.gap_m`"),
        (None, Partner::Table(_)) => format!("`contact.{origin}.pairs`"),
        (None, _) => format!("the mesh at `contact.{origin}`"),
    }
}

/// A gap larger than the structure.
fn beyond(origin: usize, choice: &ContactChoice, contacts: &[&NodeContact], extent: f64) -> Option<String> {
    let largest = contacts.iter().max_by(|a, b| a.gap.abs().total_cmp(&b.gap.abs()))?;
    (largest.gap.abs() > extent).then(|| {
        format!(
            "{} has a gap of {} m at node {}, beside a structure of {} m: gaps and walls are in m, whatever \
                `structure.units` says of the files",
            key(origin, choice),
            short(largest.gap),
            largest.node,
            short(extent)
        )
    })
}

/// A wall, or a partner in the mesh, behind the nodes; for `gap_m` this is reported when the scene is read.
fn pressed(origin: usize, choice: &ContactChoice, contacts: &[&NodeContact]) -> Option<String> {
    if matches!(choice.gap, Some(GapChoice::Same(_))) {
        return None;
    }
    let behind: Vec<&&NodeContact> = contacts.iter().filter(|contact| contact.gap < 0.0).collect();
    let deepest = behind.iter().min_by(|a, b| a.gap.total_cmp(&b.gap))?;
    Some(format!(
        "{} has a negative gap at {}: at rest the structure is pressed against this stop, which stands up to {} m \
            (node {}) beyond where it would just touch; so it is \
         computed, with the force of rest in the mean",
        key(origin, choice),
        of_all(behind.len(), contacts.len()),
        short(-deepest.gap),
        deepest.node
    ))
}

/// A gap between two solids that is not their distance, nor that of a mesh in which they touch.
fn off(
    subject: &Subject<'_>,
    solid: &HashSet<u32>,
    origin: usize,
    (choice, contacts): (&ContactChoice, &[&NodeContact]),
    extent: f64,
) -> Option<String> {
    choice.gap?;
    let mesh = subject.model.mesh.as_ref()?;
    let is_solid = |node: u64| mesh.index_of(node).is_some_and(|index| solid.contains(&(index as u32)));
    let tolerance = match choice.partner {
        Partner::Nearest(_, Some(tolerance)) => tolerance,
        _ => BESIDE * extent,
    };
    let error = |contact: &NodeContact| {
        let drawn = contact.distance_in(subject.model)?;
        let other = contact.against.filter(|other| is_solid(contact.node) && is_solid(*other))?;
        let error = (contact.gap - drawn).abs();
        (drawn > tolerance && error > tolerance && error > DIFFERS * drawn).then_some((error, other, drawn))
    };
    let wrong: Vec<_> = contacts.iter().filter_map(|contact| Some((*contact, error(contact)?))).collect();
    let (contact, (_, other, drawn)) = wrong.iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    Some(format!(
        "{} has a gap of {} m, but in the mesh node {} is {} m from node {} along the normal ({} differ so): with \
            `gap_m` left out, the distances of the mesh are the gaps",
        key(origin, choice),
        short(contact.gap),
        contact.node,
        short(*drawn),
        other,
        of_all(wrong.len(), contacts.len()).replace("nodes", "pairs").replace("its node", "the pair"),
    ))
}
