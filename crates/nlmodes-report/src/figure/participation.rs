use super::Figure;
use super::branch::corners;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, Key, LegendEntry, Panel, Scale};
use crate::palette;
use crate::svg::Stroke;
use nlmodes_modal::{Event, ModalBranch, ModalPoint, Participation};

/// Shares of the lowest linear modes in the kinetic energy over the modal amplitude: one panel per mode from 0 to 1,
/// several branches in each.
///
/// The participation factors of eq. (30) are normalised by the fundamental at a contact and become unbounded where that
/// vanishes, as at the tip of an internal-resonance branch; the shares in the energy do not.
#[derive(Debug, Clone)]
pub struct ParticipationFigure<'a> {
    branches: &'a [(&'a ModalBranch, &'a [Participation])],
    modes: usize,
    title: String,
}

impl<'a> ParticipationFigure<'a> {
    /// A figure of the first `modes` modes; each branch with the participation at its points.
    pub fn new(branches: &'a [(&'a ModalBranch, &'a [Participation])], modes: usize) -> Self {
        Self { branches, modes, title: String::new() }
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::SeriesLength`] if a branch has not as many participations as points,
    /// [`ReportError::NothingToDraw`] if there is no finite value.
    pub fn render(&self) -> Result<Figure, ReportError> {
        for (branch, participation) in self.branches {
            let (found, expected) = (participation.len(), branch.points.len());
            if found != expected {
                let label = branch.label.clone();
                return Err(ReportError::SeriesLength { label, series: "participation", found, expected });
            }
        }
        let amplitudes = self.branches.iter().flat_map(|(branch, _)| &branch.points).map(|p| p.modal_amplitude);
        let scale = Scale::linear(amplitudes, 0.04).ok_or_else(nothing)?;
        let panels = (0..self.modes).map(|mode| self.panel(mode)).collect::<Result<Vec<_>, _>>()?;
        let x = Axis { label: "modal amplitude in m √kg".into(), scale };
        let entry = |(index, (branch, _)): (usize, &(&ModalBranch, &[Participation]))| LegendEntry {
            key: Key::Line(stroke(index)),
            name: branch.label.clone(),
        };
        let legend = self.branches.iter().enumerate().map(entry).collect();
        let (title, panel_height) = (self.title.clone(), 180.0);
        Ok(Figure::from(Chart { title, x, panels, panel_height, legend, note: None, inset: None }))
    }

    fn panel(&self, mode: usize) -> Result<Panel, ReportError> {
        let share = |p: &Participation| p.energy_shares.get(mode).copied().unwrap_or(f64::NAN);
        let values = self.branches.iter().flat_map(|(_, participation)| participation.iter().map(share));
        let scale = Scale::linear(values, 0.08).ok_or_else(nothing)?;
        let mut curves = Vec::new();
        for (index, (branch, participation)) in self.branches.iter().enumerate() {
            let pairs: Vec<(&ModalPoint, &Participation)> = branch.points.iter().zip(*participation).collect();
            let resumed = |_: &(&ModalPoint, &Participation), next: &(&ModalPoint, &Participation)| {
                !next.0.has_event(Event::Resumed)
            };
            curves.extend(pairs.chunk_by(resumed).map(|piece| {
                let points = piece.iter().map(|(point, p)| (point.modal_amplitude, share(p))).collect();
                let corners = corners(piece.iter().map(|(point, _)| *point));
                Curve::new("participation", points, stroke(index)).smooth(corners)
            }));
        }
        let y = Axis { label: format!("energy share, mode {}", mode + 1), scale };
        Ok(Panel { y, curves, symbols: Vec::new(), verticals: Vec::new() })
    }
}

fn stroke(index: usize) -> Stroke {
    Stroke::solid(palette::curve(index), 2.0)
}

fn nothing() -> ReportError {
    ReportError::NothingToDraw { figure: "participation", reason: "no point has a finite amplitude and participation" }
}
