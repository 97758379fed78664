//! `motion.pvd`: the motion of a structure from files, for ParaView.

use std::f64::consts::TAU;

use nlmodes::modal::TimeHistory;
use nlmodes::report::ReportError;
use nlmodes::study::{ComputedBranch, ComputedTree, figure_points};
use nlmodes_io::{Component, FeModel, Mesh, PointField, Surface};
use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::Scene;

use crate::Failure;

/// Frames of a period.
const FRAMES: usize = 24;
/// Samples of a period of each contact, a multiple of the frames.
const SAMPLES: usize = 10 * FRAMES;

/// Writes `motion.pvd` and a frame `motion_000.vtu` … for each phase of the last point whose motion is shown, where a mesh is known; not where neither
/// figures nor page are asked for.
///
/// Fields: displacement (m), contact force on the structure (N), gap (m, NaN where there is no contact).
///
/// # Errors
/// [`Failure`] if a point cannot be evaluated again or a file cannot be written.
pub fn write(scene: &Scene, open: Option<&OpenStructure>, tree: &ComputedTree) -> Result<(), Failure> {
    let (Some(open), Some(computed)) = (open, tree.branches.first()) else { return Ok(()) };
    if !(scene.files.figures || scene.files.page) {
        return Ok(());
    }
    let Some((model, contacts)) = &open.files else { return Ok(()) };
    let (Some(mesh), Some(&point)) = (&model.mesh, figure_points(&computed.branch).last()) else { return Ok(()) };
    let touching: Vec<usize> = contacts
        .iter()
        .flat_map(|c| std::iter::once(c.node).chain(c.against))
        .filter_map(|n| mesh.index_of(n))
        .collect();
    let surface = Surface::new(mesh, &touching);
    let motion = Motion::new(open, model, mesh, &surface, computed, point)?;
    let frames: Vec<Frame> = (0..FRAMES).map(|k| motion.frame(k)).collect();
    let shown = frames.iter().enumerate().map(|(k, frame)| (motion.period * k as f64 / FRAMES as f64, frame.fields()));
    let directory = &scene.output_directory;
    let failed = |source| ReportError::Io { path: directory.join("motion.pvd"), source };
    Ok(surface.write(directory, "motion", shown).map_err(failed)?)
}

/// What makes the frames.
struct Motion<'a> {
    open: &'a OpenStructure,
    computed: &'a ComputedBranch,
    point: usize,
    period: f64,
    histories: Vec<TimeHistory>,
    /// For each point of the surface, the row of each of its displacements among `rows`.
    places: Vec<[Option<usize>; 3]>,
    rows: nlmodes_reduction::ResponseRows,
    /// The point of the surface, sign and contact of each end of a contact.
    ends: Vec<(usize, f64, usize)>,
}

/// Values at the points of the surface at one phase.
struct Frame {
    displacement: Vec<f64>,
    force: Vec<f64>,
    gap: Vec<f64>,
}

impl Frame {
    fn fields(&self) -> Vec<PointField<'_>> {
        vec![
            PointField { name: "displacement", components: 3, values: &self.displacement },
            PointField { name: "contact_force", components: 3, values: &self.force },
            PointField { name: "gap", components: 1, values: &self.gap },
        ]
    }
}

impl<'a> Motion<'a> {
    fn new(
        open: &'a OpenStructure,
        model: &FeModel,
        mesh: &Mesh,
        surface: &Surface,
        computed: &'a ComputedBranch,
        point: usize,
    ) -> Result<Self, Failure> {
        let mut dofs = Vec::new();
        let mut row = |node: u64, component| {
            let dof = model.row_of(node, component)?;
            dofs.push(dof);
            Some(dofs.len() - 1)
        };
        let numbers: Vec<u64> = surface.points().iter().map(|index| mesh.numbers[*index as usize]).collect();
        let places: Vec<[Option<usize>; 3]> =
            numbers.iter().map(|node| [Component::X, Component::Y, Component::Z].map(|c| row(*node, c))).collect();
        let at: std::collections::HashMap<u64, usize> =
            numbers.iter().enumerate().map(|(place, node)| (*node, place)).collect();
        let contacts = open.files.as_ref().map_or(&[][..], |(_, contacts)| contacts);
        let mut ends = Vec::new();
        for (i, contact) in contacts.iter().enumerate() {
            let both = std::iter::once((contact.node, -1.0)).chain(contact.against.map(|node| (node, 1.0)));
            ends.extend(both.filter_map(|(node, sign)| Some((*at.get(&node)?, sign, i))));
        }
        let histories = (0..contacts.len()).map(|i| computed.time_history(point, i, SAMPLES, ""));
        Ok(Self {
            rows: open.modes.rows_of_dofs(&dofs)?,
            period: TAU / computed.branch.points[point].omega,
            histories: histories.collect::<Result<_, _>>()?,
            open,
            computed,
            point,
            places,
            ends,
        })
    }

    fn frame(&self, k: usize) -> Frame {
        let tau = TAU * k as f64 / FRAMES as f64;
        let forces: Vec<f64> = self.histories.iter().map(|history| history.force[k * (SAMPLES / FRAMES)]).collect();
        let coefficients = &self.computed.branch.points[self.point].coefficients;
        let eta: Vec<f64> = (0..self.open.modes.n_modes())
            .map(|r| {
                let harmonics = coefficients.of(r).iter().enumerate();
                harmonics.map(|(n, q)| q.re * (n as f64 * tau).cos() - q.im * (n as f64 * tau).sin()).sum()
            })
            .collect();
        let value = |row: &Option<usize>| row.map_or(0.0, |row| self.rows.value(row, &eta, &forces));
        let displacement: Vec<f64> = self.places.iter().flat_map(|rows| rows.each_ref().map(value)).collect();
        let (mut force, mut gap) = (vec![0.0; displacement.len()], vec![f64::NAN; self.places.len()]);
        let contacts = self.open.files.as_ref().map_or(&[][..], |(_, contacts)| contacts);
        for &(place, sign, i) in &self.ends {
            let history = &self.histories[i];
            (0..3).for_each(|axis| force[3 * place + axis] += sign * forces[i] * contacts[i].normal[axis]);
            let (_, toward) = self.open.reduced.direction_of()[i];
            let left = contacts[i].gap - toward * history.displacement[k * (SAMPLES / FRAMES)];
            gap[place] = if gap[place].is_nan() { left } else { gap[place].min(left) };
        }
        Frame { displacement, force, gap }
    }
}
