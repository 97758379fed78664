use super::Figure;
use super::branch::corners;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, LegendEntry, Panel, Scale};
use crate::palette;
use crate::svg::Stroke;
use nlmodes_modal::{Event, ModalBranch, ModalPoint, Participation};

/// Modes whose shares a page shows.
pub const SHOWN_MODES: usize = 3;

/// Shares of linear modes in the kinetic energy over the modal amplitude, those with the largest ones: one panel per
/// mode, several branches in each.
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
    /// A figure of the `modes` modes with the largest shares; each branch with the participation at its points.
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
        let modes = strongest(self.branches.iter().flat_map(|(_, found)| found.iter()), self.modes);
        let panels = modes.into_iter().map(|mode| self.panel(mode)).collect::<Result<Vec<_>, _>>()?;
        let x = Axis { label: "modal amplitude in m √kg".into(), scale };
        let branches = self.branches.iter().enumerate();
        let legend = branches.map(|(index, (branch, _))| LegendEntry::line(stroke(index), &branch.label)).collect();
        Ok(Figure::from(Chart::new(self.title.clone(), x, panels, 180.0, legend)))
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

/// The `most` modes that have the largest share in the energy of any point, from 0, ascending.
pub(crate) fn strongest<'p>(points: impl Iterator<Item = &'p Participation>, most: usize) -> Vec<usize> {
    let mut largest: Vec<f64> = Vec::new();
    for point in points {
        largest.resize(largest.len().max(point.energy_shares.len()), 0.0);
        largest.iter_mut().zip(&point.energy_shares).for_each(|(most, share)| *most = most.max(*share));
    }
    let mut modes: Vec<usize> = (0..largest.len()).collect();
    modes.sort_by(|a, b| largest[*b].total_cmp(&largest[*a]));
    modes.truncate(most);
    modes.sort_unstable();
    modes
}

fn stroke(index: usize) -> Stroke {
    Stroke::solid(palette::curve(index), 2.0)
}

fn nothing() -> ReportError {
    ReportError::NothingToDraw { figure: "participation", reason: "no point has a finite amplitude and participation" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_modes_that_are_shown_have_the_largest_shares_at_any_point() {
        let point = |shares: &[f64]| Participation {
            factors: Vec::new(),
            quadrature: Vec::new(),
            harmonics: 1..=1,
            energy_shares: shares.to_vec(),
        };
        let points = [point(&[0.9, 0.02, 0.0, 0.01]), point(&[0.6, 0.03, 0.0, 0.3]), point(&[f64::NAN; 4])];
        assert_eq!(strongest(points.iter(), 2), [0, 3]);
        assert_eq!(strongest(points.iter(), 3), [0, 1, 3]);
        assert!(strongest([].iter(), 3).is_empty());
    }
}
