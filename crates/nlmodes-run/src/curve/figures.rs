//! Figures that all curves have.

use std::path::Path;

use nlmodes::modal::{ModalBranch, Participation};
use nlmodes::report::{
    Abscissa, BranchFigure, ContactFigure, Figure, FigureStyle, MotionFigure, ParticipationFigure, ReportError,
    SHOWN_MODES,
};
use nlmodes_scene::scene::Scene;

use super::histories::Reference;
use super::{Curve, gradients, stops};
use crate::Failure;
use crate::style::style_of;

/// Writes what the contacts of the curve number `pictured` do over frequency, the participation of linear modes in all,
/// and pictures of the motion of that curve: `contacts.svg`, `participation.svg`, `motion_1.svg` …; `title` is above
/// what is of that curve.
pub fn write(
    directory: &Path,
    scene: &Scene,
    (curves, pictured): (&[&dyn Curve], usize),
    title: &str,
) -> Result<(), Failure> {
    let Some(curve) = curves.get(pictured).copied() else { return Ok(()) };
    let (branch, style) = (curve.branch(), style_of(&scene.files));
    if let Some(contacts) = drawn(ContactFigure::new(branch, &stops::names(curve)).title(title).render())? {
        contacts.styled(&style).write(directory.join("contacts.svg"))?;
    }
    participation(directory, scene, curves)?;
    for (k, (_, figure)) in gradients::figures(branch).into_iter().enumerate() {
        figure.styled(&style).write(directory.join(format!("gradients_{}.svg", k + 1)))?;
    }
    let (held, stops) = (stops::held_ends(scene, branch), curve.stops());
    for (k, point) in curve.pictured().iter().enumerate().filter(|_| stops::are_along_an_axis(branch)) {
        let figure = match MotionFigure::new(branch, *point).clamped_at(&held).stops(&stops).render() {
            // One unknown has no shape.
            Err(ReportError::TooFewPositions { .. }) => break,
            figure => figure?,
        };
        figure.styled(&style).write(directory.join(format!("motion_{}.svg", k + 1)))?;
    }
    Ok(())
}

/// Writes the participation of the lowest linear modes, `participation.svg`.
pub fn participation(directory: &Path, scene: &Scene, curves: &[&dyn Curve]) -> Result<(), Failure> {
    let pairs: Vec<(&ModalBranch, &[Participation])> =
        curves.iter().map(|curve| (curve.branch(), curve.participation())).collect();
    let first = pairs.iter().find_map(|(_, found)| found.first());
    let modes = first.map_or(0, |found| found.energy_shares.len()).min(SHOWN_MODES);
    if let Some(figure) = drawn(ParticipationFigure::new(&pairs, modes).title(&scene.title).render())? {
        figure.styled(&style_of(&scene.files)).write(directory.join("participation.svg"))?;
    }
    Ok(())
}

/// A figure with the name of its file and its title on the page.
pub struct Named {
    /// Name of the file.
    pub file: String,
    /// Title on the page.
    pub title: String,
    /// The figure.
    pub figure: Figure,
}

impl Named {
    /// A figure with these names.
    pub fn new(file: impl Into<String>, title: impl Into<String>, figure: Figure) -> Self {
        Self { file: file.into(), title: title.into(), figure }
    }
}

/// Writes them in this style.
///
/// # Errors
/// [`ReportError::Io`].
pub fn write_all(directory: &Path, figures: &[Named], style: &FigureStyle) -> Result<(), ReportError> {
    figures.iter().try_for_each(|own| own.figure.styled(style).write(directory.join(&own.file)))
}

/// A figure; none where there is nothing to draw.
pub fn drawn(figure: Result<Figure, ReportError>) -> Result<Option<Figure>, ReportError> {
    match figure {
        Err(ReportError::NothingToDraw { .. }) => Ok(None),
        figure => figure.map(Some),
    }
}

/// Writes frequency over energy, with the points of pictures of the first branch, and over modal amplitude, with its
/// references: `frequency_energy.svg`, `frequency_amplitude.svg`.
pub fn frequencies(
    directory: &Path,
    scene: &Scene,
    (shown, scattered): (&[&ModalBranch], &[usize]),
    pictured: &[usize],
    references: &[Reference],
) -> Result<(), Failure> {
    let style = style_of(&scene.files);
    let figure = |abscissa| BranchFigure::new(abscissa, shown).title(&scene.title).scattered(scattered);
    let pictured = pictured.iter().enumerate();
    let energy = pictured.fold(figure(Abscissa::Energy), |f, (k, point)| f.mark(0, *point, (k + 1).to_string()));
    energy.render()?.styled(&style).write(directory.join("frequency_energy.svg"))?;
    let mut amplitude = figure(Abscissa::ModalAmplitude);
    for reference in references {
        amplitude = amplitude.mark(0, reference.point, &reference.name);
    }
    Ok(amplitude.render()?.styled(&style).write(directory.join("frequency_amplitude.svg"))?)
}
