//! The figures of a run.

use std::path::Path;

use nlmodes::branches::{ComputedBranch, figure_points};
use nlmodes::modal::{ModalBranch, Participation};
use nlmodes::report::{
    Abscissa, BranchFigure, ContactFigure, MotionFigure, ParticipationFigure, ReportError, write_participation,
};

use super::histories::{self, Reference};

use super::overlaid::Overlaid;
use super::sink::branch_directory;
use super::stops;
use crate::Failure;
use crate::style::style_of;
use nlmodes_scene::scene::Scene;

/// Linear modes whose participation is written.
pub const LINEAR_MODES: usize = 6;
/// Of these, how many are shown.
pub const SHOWN_MODES: usize = 2;

/// Writes frequency over energy and over modal amplitude; of the first branch the motion of up to four points, and the
/// time histories of `references`.
pub fn write(
    directory: &Path,
    scene: &Scene,
    all: &[ComputedBranch],
    found: &[Vec<Participation>],
    (references, laid): (&[Reference], &Overlaid),
) -> Result<(), Failure> {
    let Some(computed) = all.first() else { return Ok(()) };
    let (branch, style) = (&computed.branch, style_of(&scene.files));
    let branches: Vec<&ModalBranch> = all.iter().map(|computed| &computed.branch).collect();
    let motions = figure_points(branch);
    let shown: Vec<&ModalBranch> = branches.iter().copied().chain(laid.branches()).collect();
    let scattered = laid.scattered(branches.len());
    let mut energy = BranchFigure::new(Abscissa::Energy, &shown).title(&scene.title).scattered(&scattered);
    for (k, point) in motions.iter().enumerate() {
        energy = energy.mark(0, *point, (k + 1).to_string());
    }
    energy.render()?.styled(&style).write(directory.join("frequency_energy.svg"))?;
    let mut amplitude = BranchFigure::new(Abscissa::ModalAmplitude, &shown).title(&scene.title).scattered(&scattered);
    for reference in references {
        amplitude = amplitude.mark(0, reference.point, &reference.name);
    }
    amplitude.render()?.styled(&style).write(directory.join("frequency_amplitude.svg"))?;
    let contacts = ContactFigure::new(branch, &stops::names(computed)).title(&scene.title);
    contacts.render()?.styled(&style).write(directory.join("contacts.svg"))?;
    participation(directory, scene, &branches, &found.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
    let (clamped, stops) = (held_ends(scene, computed), stops::lines(computed));
    // A structure in free-interface modes has modal coordinates, which have no position.
    for (k, point) in motions.iter().enumerate().filter(|_| !scene.is_in_open_modes()) {
        let figure = match MotionFigure::new(branch, *point).clamped_at(&clamped).stops(&stops).render() {
            // One unknown has no shape.
            Err(ReportError::TooFewPositions { .. }) => break,
            figure => figure?,
        };
        figure.styled(&style).write(directory.join(format!("motion_{}.svg", k + 1)))?;
    }
    histories::write(directory, references, &style)
}

/// Writes the participation of the lowest linear modes as tables.
pub fn write_participations(
    directory: &Path,
    all: &[ComputedBranch],
    found: &[Vec<Participation>],
) -> Result<(), Failure> {
    for (number, (computed, found)) in all.iter().zip(found).enumerate() {
        write_participation(branch_directory(directory, number).join("participation.csv"), &computed.branch, found)?;
    }
    Ok(())
}

/// The figure of the participation of the lowest linear modes.
pub fn participation(
    directory: &Path,
    scene: &Scene,
    branches: &[&ModalBranch],
    found: &[&[Participation]],
) -> Result<(), Failure> {
    let pairs: Vec<(&ModalBranch, &[Participation])> = branches.iter().copied().zip(found.iter().copied()).collect();
    let modes = found.first().and_then(|p| p.first()).map_or(0, |p| p.energy_shares.len()).min(SHOWN_MODES);
    let figure = ParticipationFigure::new(&pairs, modes).title(&scene.title).render()?;
    Ok(figure.styled(&style_of(&scene.files)).write(directory.join("participation.svg"))?)
}

/// Ends of the structure that are fixed in the direction of the first contact.
pub fn held_ends(scene: &Scene, computed: &ComputedBranch) -> Vec<f64> {
    let coordinates = &computed.branch.coordinates;
    let Some(contact) = computed.branch.contact_coordinate.map(|i| &coordinates[i]) else { return Vec::new() };
    let Some(length) = scene.structure.straight().map(|structure| structure.length) else { return Vec::new() };
    let moves = |at: f64| coordinates.iter().any(|c| c.kind == contact.kind && (c.position - at).abs() < 1e-9 * length);
    [0.0, length].into_iter().filter(|at| !moves(*at)).collect()
}
