use nlmodes_io::{ContactChoice, Mesh, NodeContact, NormalChoice, Partner};

use super::{Subject, of_all, vector};

/// A normal points into the body if its product with the outward one is below this: edges and vertices have the mean
/// normal of their faces, to which a valid direction may be perpendicular.
const INWARD: f64 = -0.5;

/// Walls within the structure.
pub fn doubts(subject: &Subject<'_>) -> Vec<String> {
    let Some(mesh) = &subject.model.mesh else { return Vec::new() };
    let before_walls = |choice: &ContactChoice| {
        choice.partner == Partner::Wall && matches!(choice.normal, Some(NormalChoice::Vector(_)))
    };
    let choices = subject.choices().filter(|(_, choice, _)| before_walls(choice));
    choices.filter_map(|(origin, _, contacts)| inward(subject, mesh, origin, &contacts)).collect()
}

fn inward(subject: &Subject<'_>, mesh: &Mesh, origin: usize, contacts: &[&NodeContact]) -> Option<String> {
    let set: Vec<u32> = contacts.iter().filter_map(|contact| Some(mesh.index_of(contact.node)? as u32)).collect();
    let normals = subject.skin.normals_within(mesh, &set);
    let outward = |contact: &&NodeContact| unit(normals[mesh.index_of(contact.node)?]);
    let known: Vec<(&NodeContact, [f64; 3])> =
        contacts.iter().filter_map(|contact| Some((*contact, outward(contact)?))).collect();
    let along = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let &(first, out) = known.first()?;
    known.iter().all(|(contact, out)| along(contact.normal, *out) < INWARD).then(|| {
        format!(
            "`contact.{origin}.normal` {} points into the structure at {}; outward is {} at node {}: a wall on that \
                side would lie within it. Turn the normal \
             round, or take the nodes of the face that touches",
            vector(first.normal),
            of_all(known.len(), contacts.len()),
            vector(out),
            first.node
        )
    })
}

fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0).then(|| vector.map(|x| x / length))
}
