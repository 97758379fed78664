//! Time histories of several methods at equal modal amplitude, over each other (Fig. 9).

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::modal::TimeHistory;
use nlmodes::report::HistoryFigure;
use nlmodes::study::{ComputedBranch, reference_points};

use super::figures::HISTORY_SAMPLES;
use crate::Failure;

/// Most branches over each other.
const MAX_CURVES: usize = 8;

/// Motions of several branches with the same modal amplitude.
#[derive(Debug)]
pub struct Reference {
    /// `P1`, `P2`.
    pub name: String,
    /// The modal amplitude, m√kg.
    pub amplitude: f64,
    /// Point of the first branch next to it.
    pub point: usize,
    /// A period of each branch that has such a point.
    pub histories: Vec<TimeHistory>,
}

impl Reference {
    /// What stands above the figure.
    pub fn title(&self) -> String {
        format!("{}: equal modal amplitude, {:.4e} m √kg", self.name, self.amplitude)
    }
}

/// The reference points of the first branch, or the largest amplitude that all branches reach where these do not go as far, with the motion of each
/// branch there.
///
/// # Errors
/// If a periodic problem cannot be evaluated.
pub fn references(all: &[&ComputedBranch]) -> Result<Vec<Reference>, Failure> {
    let Some(first) = all.first() else { return Ok(Vec::new()) };
    let shown = &all[..all.len().min(MAX_CURVES)];
    let highest = |branch: &ComputedBranch| branch.branch.points.iter().map(|p| p.modal_amplitude).fold(0.0, f64::max);
    let common = shown.iter().map(|branch| highest(branch)).fold(f64::INFINITY, f64::min);
    let points = &first.branch.points;
    let mut found: Vec<Reference> = Vec::new();
    for point in reference_points(&first.branch) {
        let amplitude = points[point].modal_amplitude.min(common);
        if found.iter().any(|reference| reference.amplitude == amplitude) {
            continue;
        }
        let mut histories = Vec::new();
        for branch in shown {
            let Some(solution) = branch.at_amplitude(amplitude, points[point].omega)? else { continue };
            let label = format!("{}: {:.4} Hz", branch.branch.label, solution.point.omega / TAU);
            histories.push(branch.time_history_of(&solution, 0, HISTORY_SAMPLES, &label)?);
        }
        let off = |k: &usize| (points[*k].modal_amplitude - amplitude).abs();
        let near = if points[point].modal_amplitude == amplitude {
            Some(point)
        } else {
            (0..points.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
        };
        found.push(Reference {
            name: format!("P{}", found.len() + 1),
            amplitude,
            point: near.unwrap_or(point),
            histories,
        });
    }
    Ok(found)
}

/// Writes a figure of displacement, velocity, acceleration and contact force for each reference.
///
/// # Errors
/// If one cannot be drawn or written.
pub fn write(directory: &Path, references: &[Reference]) -> Result<(), Failure> {
    for (k, reference) in references.iter().enumerate().filter(|(_, reference)| !reference.histories.is_empty()) {
        let histories: Vec<&TimeHistory> = reference.histories.iter().collect();
        let figure = HistoryFigure::new(&histories).title(reference.title()).with_acceleration().render()?;
        figure.write(directory.join(format!("history_P{}.svg", k + 1)))?;
    }
    Ok(())
}
