//! The motion of a structure from files: `motion.pvd` for ParaView, and a wireframe for the page.

use std::collections::HashMap;
use std::f64::consts::TAU;

use nlmodes::linalg::Mat;
use nlmodes::modal::TimeHistory;
use nlmodes::report::{ReportError, Wireframe};
use nlmodes_io::{Component, FeModel, Mesh, NodeContact, PointField, Skin, Surface};
use nlmodes_scene::assemble::{OpenStructure, PictureMesh};
use nlmodes_scene::scene::Scene;

use super::stress::{PointStress, Solids};
use super::{Curve, Grid, Instants};
use crate::Failure;

/// Equidistant frames of a period.
pub const FRAMES: usize = 24;
/// Instants in which intervals of contact are sought, and the most of them that have frames of their own.
const INSTANTS: usize = 480;
const MOST_STRETCHES: usize = 8;
/// Force over the largest one from which on a contact has frames of its own, and distance of two frames over the period
/// up to which they are one.
const FELT: f64 = 1e-6;
const SAME: f64 = 1e-9;

/// Angle (rad) by which a surface bends at edges that are drawn where not all can be.
const SHARP: f64 = 0.5;
/// Most edges and corners of a wireframe.
const MOST: [usize; 2] = [6000, 2500];

/// One period of the last point whose motion is shown, of a structure with a mesh.
pub struct Period {
    /// The point.
    pub point: usize,
    surface: Surface,
    frames: Vec<Frame>,
    duration: f64,
    wireframe: Option<Wireframe>,
    dependent: Vec<u64>,
}

impl Period {
    /// The period, with stress where that is recovered; none where no mesh is known.
    ///
    /// # Errors
    /// [`Failure`] if a point cannot be evaluated again.
    pub fn of(
        open: Option<&OpenStructure>,
        curve: &dyn Curve,
        stress: Option<&Solids>,
    ) -> Result<Option<Self>, Failure> {
        let Some(open) = open else { return Ok(None) };
        let Some(known) = Known::of(open) else { return Ok(None) };
        let (Some(mesh), Some(&point)) = (known.mesh(), curve.pictured().last()) else { return Ok(None) };
        let contacts = open.files.as_ref().map_or(&[][..], |(_, contacts)| contacts);
        let touching: Vec<usize> = contacts
            .iter()
            .flat_map(|c| std::iter::once(c.node).chain(c.against))
            .filter_map(|n| mesh.index_of(n))
            .collect();
        let (surface, skin) = (Surface::new(mesh, &touching), Skin::of(mesh));
        let motion = Motion::new(open, known, (mesh, &skin), &surface, curve, point)?;
        let frames: Vec<Frame> = (0..motion.phases.len())
            .map(|k| motion.frame(k, stress.map(|solids| (solids, surface.points()))))
            .collect();
        let wireframe =
            wireframe(format!("Point {}", curve.first() + point), (mesh, &skin), &surface, &frames, &motion.ends);
        let dependent = motion.dependent();
        Ok(Some(Self { point, surface, frames, duration: motion.period, wireframe, dependent }))
    }

    /// What the pictures lack, in a sentence: nodes whose motion the matrices do not hold, since it depends on others.
    pub fn warning(&self) -> Option<String> {
        let first = self.dependent.first()?;
        Some(format!(
            "{} nodes of the surface have displacements without a row in the matrices, and no support in the deck: \
                they depend on others (*EQUATION, *RIGID BODY, \
             *TIE), as node {first} does; their motion is not known, and is left out of motion.pvd and of the \
             wireframe",
            self.dependent.len()
        ))
    }

    /// Its edges as they move, unless they are too many for a page.
    pub fn wireframe(&self) -> Option<&Wireframe> {
        self.wireframe.as_ref()
    }

    /// Writes `motion.pvd` and a frame `motion_000.vtu` … for each phase: equidistant ones, and the beginning, largest
    /// force and end of each interval in which any contact is closed.
    ///
    /// Fields: number of the node, displacement (m, NaN where it is not known), contact force on the structure (N), gap
    /// (m), and, where contacts cover faces of the mesh, contact pressure (Pa), NaN where there is no contact, or no
    /// face; where it is recovered, stress (xx, yy, zz, xy, yz, zx), its equivalent of von Mises and the principal
    /// stress of the largest magnitude (Pa).
    ///
    /// # Errors
    /// [`Failure`] if a file cannot be written.
    pub fn write(&self, scene: &Scene) -> Result<(), Failure> {
        let shown = self.frames.iter().map(|frame| (self.duration * frame.phase, frame.fields()));
        let directory = &scene.output_directory;
        let failed = |source| ReportError::Io { path: directory.join("motion.pvd"), source };
        Ok(self.surface.write(directory, "motion", shown).map_err(failed)?)
    }
}

/// The edges of the surface, or those at which it bends, with the corners that they join.
fn wireframe(
    name: String,
    (mesh, skin): (&Mesh, &Skin),
    surface: &Surface,
    frames: &[Frame],
    ends: &[End],
) -> Option<Wireframe> {
    let all = skin.edges();
    let edges = if all.len() > MOST[0] { skin.sharp_edges(mesh, SHARP) } else { all };
    // Points of the surface that are joined, and those that touch something.
    let row: HashMap<u32, usize> = surface.points().iter().enumerate().map(|(row, index)| (*index, row)).collect();
    let mut touching: Vec<usize> = ends.iter().map(|end| end.place).collect();
    touching.sort_unstable();
    touching.dedup();
    let mut rows: Vec<usize> = edges.iter().flatten().filter_map(|index| row.get(index).copied()).collect();
    rows.extend(&touching);
    rows.sort_unstable();
    rows.dedup();
    if edges.len() > MOST[0] || rows.len() > MOST[1] {
        return None;
    }
    let triple = |values: &[f64], row: usize| [values[3 * row], values[3 * row + 1], values[3 * row + 2]];
    // Corners whose motion is not known are left out with their edges.
    rows.retain(|row| frames.iter().all(|frame| !triple(&frame.displacement, *row).iter().any(|u| u.is_nan())));
    let equidistant = frames.iter().filter(|frame| frame.is_equidistant);
    let corner = |row: usize| rows.binary_search(&row).ok();
    let joined = |edge: &[u32; 2]| Some([corner(*row.get(&edge[0])?)?, corner(*row.get(&edge[1])?)?]);
    let forces =
        |row: &usize| Some((corner(*row)?, frames.iter().map(|frame| triple(&frame.force, *row)).collect::<Vec<_>>()));
    Some(Wireframe {
        name,
        places: rows.iter().map(|row| mesh.places[surface.points()[*row] as usize]).collect(),
        edges: edges.iter().filter_map(joined).collect(),
        displacements: equidistant
            .map(|frame| rows.iter().map(|row| triple(&frame.displacement, *row)).collect())
            .collect(),
        phases: frames.iter().map(|frame| frame.phase).collect(),
        forces: touching.iter().filter_map(forces).collect(),
    })
}

/// Whose nodes a picture shows.
#[derive(Clone, Copy)]
enum Known<'a> {
    Files(&'a FeModel),
    ReducedElsewhere(&'a PictureMesh),
}

impl<'a> Known<'a> {
    fn of(open: &'a OpenStructure) -> Option<Self> {
        let files = open.files.as_ref().map(|(model, _)| Self::Files(model));
        files.or_else(|| open.picture.as_ref().map(Self::ReducedElsewhere))
    }

    fn mesh(self) -> Option<&'a Mesh> {
        match self {
            Self::Files(model) => model.mesh.as_ref(),
            Self::ReducedElsewhere(picture) => Some(&picture.mesh),
        }
    }

    /// The displacement of a node along an axis, as one of the structure that was reduced.
    fn row_of(self, node: u64, component: Component) -> Option<usize> {
        match self {
            Self::Files(model) => model.row_of(node, component),
            Self::ReducedElsewhere(picture) => picture.row_of(node, component),
        }
    }

    fn depends_on_others(self, node: u64, component: Component) -> bool {
        match self {
            Self::Files(model) => model.is_held(node, component) == Some(false),
            Self::ReducedElsewhere(_) => false,
        }
    }
}

/// What makes the frames.
struct Motion<'a> {
    open: &'a OpenStructure,
    period: f64,
    /// Phase of each frame, rad, and whether it is one of the equidistant ones.
    phases: Vec<(f64, bool)>,
    instants: Instants,
    /// Displacements that were recovered, a column a frame, m.
    displacements: Mat<f64>,
    /// Numbers of the nodes of the surface.
    numbers: Vec<u64>,
    /// For each point of the surface, where each of its displacements is found.
    places: Vec<[Source; 3]>,
    ends: Vec<End>,
}

/// Where a displacement is found.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    /// In this row of the displacements that were recovered.
    Row(usize),
    /// It is held.
    Held,
    /// It depends on others in a way that is not known.
    Unknown,
}

/// An end of a contact.
struct End {
    /// The point of the surface.
    place: usize,
    /// The contact.
    contact: usize,
    /// −1 at the node, 1 at the one that it touches: the force there is so many times the normal.
    sign: f64,
    /// The area that belongs to it, m²; zero where the contacts cover no face.
    area: f64,
}

/// Values at the points of the surface at one phase.
struct Frame {
    /// Share of the period, and whether it is one of the equidistant frames.
    phase: f64,
    is_equidistant: bool,
    /// Number of the node.
    node: Vec<f64>,
    displacement: Vec<f64>,
    force: Vec<f64>,
    gap: Vec<f64>,
    /// Empty where no area is known.
    pressure: Vec<f64>,
    stress: Option<PointStress>,
}

impl Frame {
    fn fields(&self) -> Vec<PointField<'_>> {
        let mut fields = vec![
            PointField { name: "node", components: 1, values: &self.node },
            PointField { name: "displacement", components: 3, values: &self.displacement },
            PointField { name: "contact_force", components: 3, values: &self.force },
            PointField { name: "gap", components: 1, values: &self.gap },
        ];
        if !self.pressure.is_empty() {
            fields.push(PointField { name: "contact_pressure", components: 1, values: &self.pressure });
        }
        if let Some(stress) = &self.stress {
            fields.push(PointField { name: "stress", components: 6, values: &stress.components });
            fields.push(PointField { name: "von_mises", components: 1, values: &stress.mises });
            fields.push(PointField { name: "principal_stress", components: 1, values: &stress.principal });
        }
        fields
    }
}

impl<'a> Motion<'a> {
    fn new(
        open: &'a OpenStructure,
        known: Known<'_>,
        (mesh, skin): (&Mesh, &Skin),
        surface: &Surface,
        curve: &dyn Curve,
        point: usize,
    ) -> Result<Self, Failure> {
        let mut dofs = Vec::new();
        let mut source = |node: u64, component| match known.row_of(node, component) {
            Some(dof) => {
                dofs.push(dof);
                Source::Row(dofs.len() - 1)
            }
            None if known.depends_on_others(node, component) => Source::Unknown,
            None => Source::Held,
        };
        let numbers: Vec<u64> = surface.points().iter().map(|index| mesh.numbers[*index as usize]).collect();
        let axes = [Component::X, Component::Y, Component::Z];
        let places: Vec<[Source; 3]> = numbers.iter().map(|node| axes.map(|c| source(*node, c))).collect();
        let at: HashMap<u64, usize> = numbers.iter().enumerate().map(|(place, node)| (*node, place)).collect();
        let contacts = open.files.as_ref().map_or(&[][..], |(_, contacts)| contacts);
        let mut ends = Vec::new();
        for (contact, node_contact) in contacts.iter().enumerate() {
            let both = std::iter::once((node_contact.node, -1.0)).chain(node_contact.against.map(|node| (node, 1.0)));
            ends.extend(both.filter_map(|(node, sign)| Some(End { place: *at.get(&node)?, contact, sign, area: 0.0 })));
        }
        find_areas(&mut ends, contacts, surface, (mesh, skin));
        let (phases, contacts) = phases_of_frames(curve, open, point)?;
        let taus: Vec<f64> = phases.iter().map(|(tau, _)| *tau).collect();
        let instants = curve.instants_of(open, point, &taus, contacts)?;
        Ok(Self {
            displacements: instants.displacements(open, &dofs, &curve.load_shapes()),
            instants,
            phases,
            period: TAU / curve.branch().points[point].omega,
            open,
            numbers,
            places,
            ends,
        })
    }

    /// Numbers of the nodes with displacements that are not known.
    fn dependent(&self) -> Vec<u64> {
        let points = self.numbers.iter().zip(&self.places);
        points.filter(|(_, place)| place.contains(&Source::Unknown)).map(|(number, _)| *number).collect()
    }

    fn frame(&self, k: usize, stress: Option<(&Solids, &[u32])>) -> Frame {
        let forces: Vec<f64> = self.instants.contacts.iter().map(|history| history.force[k]).collect();
        let value = |source: Source| match source {
            Source::Row(row) => self.displacements[(row, k)],
            Source::Held => 0.0,
            Source::Unknown => f64::NAN,
        };
        let displacement: Vec<f64> = self.places.iter().flat_map(|place| place.map(value)).collect();
        let (mut force, mut gap) = (vec![0.0; displacement.len()], vec![f64::NAN; self.places.len()]);
        let mut pressure = vec![f64::NAN; if self.ends.iter().any(|end| end.area > 0.0) { gap.len() } else { 0 }];
        let contacts = self.open.files.as_ref().map_or(&[][..], |(_, contacts)| contacts);
        for &End { place, contact: i, sign, area } in &self.ends {
            let history = &self.instants.contacts[i];
            if area > 0.0 {
                // A node before two walls presses against both.
                pressure[place] = forces[i] / area + if pressure[place].is_nan() { 0.0 } else { pressure[place] };
            }
            (0..3).for_each(|axis| force[3 * place + axis] += sign * forces[i] * contacts[i].normal[axis]);
            let (_, toward) = self.open.reduced.direction_of()[i];
            let left = contacts[i].gap - toward * history.displacement[k];
            gap[place] = if gap[place].is_nan() { left } else { gap[place].min(left) };
        }
        let node = self.numbers.iter().map(|number| *number as f64).collect();
        let stress = stress.map(|(solids, points)| solids.at_points(points, &self.instants, k));
        let (tau, is_equidistant) = self.phases[k];
        Frame { phase: tau / TAU, is_equidistant, node, displacement, force, gap, pressure, stress }
    }
}

/// Phases of the frames (rad) with whether each is one of the equidistant ones, and the contacts there.
#[expect(clippy::type_complexity, reason = "phases with their contacts")]
fn phases_of_frames(
    curve: &dyn Curve,
    open: &OpenStructure,
    point: usize,
) -> Result<(Vec<(f64, bool)>, Vec<TimeHistory>), Failure> {
    let regular = curve.contacts_at(open, point, Grid::Equidistant(FRAMES))?;
    let exact = curve.contacts_at(open, point, Grid::Exact(INSTANTS))?;
    let period = exact.first().and_then(|history| history.time.last()).copied().unwrap_or(1.0);
    let at = |k: usize| exact.first().map_or(0.0, |history| TAU * history.time[k] / period);
    let even = |k: usize| TAU * k as f64 / FRAMES as f64;
    let is_new = |k: &usize| (0..=FRAMES).all(|j| (at(*k) - even(j)).abs() > SAME * TAU);
    let own = instants_of_contact(&exact).into_iter().filter(is_new).map(|k| (at(k), Some(k), k));
    let mut all: Vec<(f64, Option<usize>, usize)> = (0..FRAMES).map(|k| (even(k), None, k)).chain(own).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.dedup_by(|b, a| b.1.is_some() && b.0 - a.0 <= SAME * TAU);
    let picked = |(regular, exact): (&TimeHistory, &TimeHistory)| {
        let mut history = TimeHistory::empty("", regular.stop);
        for (_, own, k) in &all {
            let from = if own.is_some() { exact } else { regular };
            let motion = [from.displacement[*k], from.velocity[*k], from.acceleration[*k]];
            history.push(from.time[*k], motion, from.force[*k]);
        }
        history
    };
    let contacts = regular.iter().zip(&exact).map(picked).collect();
    Ok((all.iter().map(|(tau, own, _)| (*tau, own.is_none())).collect(), contacts))
}

/// Beginning, largest force and end of each interval of instants in which any contact is closed, of those with the
/// largest forces.
fn instants_of_contact(contacts: &[TimeHistory]) -> Vec<usize> {
    let count = contacts.first().map_or(0, |history| history.time.len());
    let forces: Vec<f64> = (0..count).map(|k| contacts.iter().map(|history| history.force[k]).sum()).collect();
    let largest = forces.iter().copied().fold(0.0, f64::max);
    let closed: Vec<usize> = (0..count).filter(|k| forces[*k] > FELT * largest).collect();
    let peak = |stretch: &&[usize]| stretch.iter().map(|k| forces[*k]).fold(0.0, f64::max);
    let mut stretches: Vec<&[usize]> = closed.chunk_by(|a, b| a + 1 == *b).collect();
    stretches.sort_by(|a, b| peak(b).total_cmp(&peak(a)));
    let of = |stretch: &[usize]| -> Vec<usize> {
        let [first, .., last] = stretch else { return stretch.to_vec() };
        let middle = stretch.iter().copied().max_by(|a, b| forces[*a].total_cmp(&forces[*b]));
        // Forces are zero at the instants of contact themselves, which are before and behind the interval.
        [first.saturating_sub(1), middle.unwrap_or(*first), (last + 1).min(count - 1)].to_vec()
    };
    stretches.into_iter().take(MOST_STRETCHES).flat_map(of).collect()
}

/// The areas of ends of contacts: those of one choice cover a face together, on either side.
fn find_areas(ends: &mut [End], contacts: &[NodeContact], surface: &Surface, (mesh, skin): (&Mesh, &Skin)) {
    let mut groups: HashMap<(usize, bool), Vec<usize>> = HashMap::new();
    for (k, end) in ends.iter().enumerate() {
        groups.entry((contacts[end.contact].origin, end.sign > 0.0)).or_default().push(k);
    }
    for group in groups.into_values() {
        let outward = |end: &End| contacts[end.contact].normal.map(|n| -end.sign * n);
        let nodes: Vec<(u32, [f64; 3])> =
            group.iter().map(|k| (surface.points()[ends[*k].place], outward(&ends[*k]))).collect();
        let areas = skin.tributary_areas(mesh, &nodes);
        group.into_iter().zip(areas).for_each(|(k, area)| ends[k].area = area);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact with these forces at equal steps of time.
    fn pushed(forces: &[f64]) -> TimeHistory {
        let mut history = TimeHistory::empty("", 1.0);
        forces.iter().enumerate().for_each(|(k, force)| history.push(k as f64, [0.0; 3], *force));
        history
    }

    #[test]
    fn contact_has_instants_where_it_begins_is_largest_and_ends() {
        // Both contacts are one interval where they overlap; the wrapped one begins with the period.
        let first = pushed(&[1.0, 0.5, 0.0, 0.0, 2.0, 5.0, 1.0, 0.0, 0.0, 0.0, 0.2, 0.0]);
        let second = pushed(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 6.0, 3.0, 0.0, 0.0, 0.0, 0.0]);
        let mut found = instants_of_contact(&[first, second]);
        found.sort_unstable();
        assert_eq!(found, [0, 0, 2, 3, 6, 8, 10]);
        assert!(instants_of_contact(&[pushed(&[0.0; 5])]).is_empty() && instants_of_contact(&[]).is_empty());
    }
}
