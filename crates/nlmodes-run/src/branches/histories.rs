//! Time histories of the contacts at the points that are named in figures (Fig. 9): of one branch, or of several
//! methods over each other.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::branches::{BranchError, ComputedBranch, Histories, figure_points, reference_points};
use nlmodes::modal::TimeHistory;
use nlmodes::report::{FigureStyle, HistoryFigure, PointHistories};
use nlmodes_scene::scene::OutputFiles;

use super::stops;
use crate::Failure;

/// Most curves over each other.
const MAX_CURVES: usize = 8;
/// Most stops with a figure of their own where several branches are compared.
const MAX_STOPS: usize = 4;
/// Instants of a period.
const SAMPLES: usize = 1000;

/// Motions of one or several branches with the same modal amplitude.
#[derive(Debug)]
pub struct Reference {
    /// `P1`, `P2`.
    pub name: String,
    /// The modal amplitude, m√kg.
    pub amplitude: f64,
    /// Point of the first branch next to it.
    pub point: usize,
    /// What stands above its figures.
    title: String,
    /// A period of each branch that has such a point: all of its contacts.
    motions: Vec<Vec<TimeHistory>>,
}

/// Curves over each other, and what they are.
pub struct Curves<'r> {
    /// Name of the figure's file without its ending.
    pub file: String,
    /// The title.
    pub title: String,
    /// The curves.
    pub histories: Vec<&'r TimeHistory>,
    /// Number of the stop of each.
    pub stops: Vec<usize>,
}

impl Reference {
    /// The figures of this reference: of one branch its stops over each other, of several branches one for each stop
    /// that carries a force, the branches over each other.
    pub fn curves(&self) -> Vec<Curves<'_>> {
        match self.motions.as_slice() {
            [] => Vec::new(),
            [only] => {
                let shown = most_loaded(only, MAX_CURVES);
                let of = if shown.len() < only.len() {
                    format!(", the {} most loaded of {} stops", shown.len(), only.len())
                } else {
                    String::new()
                };
                let histories = shown.iter().map(|stop| &only[*stop]).collect();
                let (file, title) = (format!("history_{}", self.name), format!("{}{of}", self.title));
                vec![Curves { file, title, histories, stops: shown }]
            }
            several => {
                let stops = several.first().map_or(&[] as &[_], Vec::as_slice);
                let shown = most_loaded(stops, MAX_STOPS);
                let curves = |(place, stop): (usize, usize)| {
                    let ending = if place == 0 { String::new() } else { format!("_stop_{stop}") };
                    let named = if stops.len() > 1 { format!(", stop {stop}") } else { String::new() };
                    Curves {
                        file: format!("history_{}{ending}", self.name),
                        title: format!("{}{named}", self.title),
                        histories: several.iter().filter_map(|motion| motion.get(stop)).collect(),
                        stops: vec![stop; several.len()],
                    }
                };
                shown.into_iter().enumerate().map(curves).collect()
            }
        }
    }
}

/// The stops with the largest impulses, at most so many, ascending; one at least where there is any.
fn most_loaded(stops: &[TimeHistory], most: usize) -> Vec<usize> {
    let impulse = |history: &TimeHistory| {
        let steps = history.time.windows(2).zip(history.force.windows(2));
        steps.map(|(t, f)| 0.5 * (t[1] - t[0]) * (f[0] + f[1])).sum::<f64>()
    };
    let mut order: Vec<(usize, f64)> = stops.iter().map(impulse).enumerate().collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut chosen: Vec<usize> = order.into_iter().take(most).map(|(stop, _)| stop).collect();
    chosen.sort_unstable();
    chosen
}

/// The reference points of one branch, with its motion there.
///
/// # Errors
/// [`BranchError`] if a point cannot be evaluated again.
pub fn own_references(computed: &ComputedBranch) -> Result<Vec<Reference>, BranchError> {
    let mut histories = Histories::of(computed);
    let of = |(k, point): (usize, usize)| {
        let found = &computed.branch.points[point];
        let mut motion = histories.at(point, SAMPLES, &computed.branch.label)?;
        if motion.len() > 1 {
            motion.iter_mut().zip(stops::names(computed)).for_each(|(history, name)| history.label = name);
        }
        let title = format!("P{} (point {point}, {:.4} Hz)", k + 1, found.omega / TAU);
        let name = format!("P{}", k + 1);
        Ok(Reference { name, amplitude: found.modal_amplitude, point, title, motions: vec![motion] })
    };
    reference_points(&computed.branch).into_iter().enumerate().map(of).collect()
}

/// The reference points of the first branch, or the largest amplitude that all branches reach where these do not go as
/// far, with the motion of each branch there.
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
    for (number, point) in reference_points(&first.branch).into_iter().enumerate() {
        let amplitude = points[point].modal_amplitude.min(common);
        if found.iter().any(|reference| reference.amplitude == amplitude) {
            continue;
        }
        let mut motions = Vec::new();
        for branch in shown {
            let Some(solution) = branch.at_amplitude(amplitude, points[point].omega)? else { continue };
            let label = format!("{}: {:.4} Hz", branch.branch.label, solution.point.omega / TAU);
            let mut motion = Histories::of(branch).between(&solution, SAMPLES, &label)?;
            if motion.len() > 1 {
                let names = stops::names(branch).into_iter();
                motion.iter_mut().zip(names).for_each(|(history, name)| history.label = format!("{label}, {name}"));
            }
            motions.push(motion);
        }
        let off = |k: &usize| (points[*k].modal_amplitude - amplitude).abs();
        let near = if points[point].modal_amplitude == amplitude {
            Some(point)
        } else {
            (0..points.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
        };
        // Where a branch does not go as far as the point of the first one, it is another point, and has another name.
        let name = match amplitude < points[point].modal_amplitude {
            true => "common".to_owned(),
            false => format!("P{}", number + 1),
        };
        let size = stops::short(amplitude);
        let title = match amplitude < points[point].modal_amplitude {
            true => format!("largest modal amplitude of all branches, {size} m √kg"),
            false => format!("{name}: equal modal amplitude, {size} m √kg"),
        };
        found.push(Reference { name, amplitude, point: near.unwrap_or(point), title, motions });
    }
    Ok(found)
}

/// Writes the figures of displacement, velocity, acceleration and contact force of each reference.
///
/// # Errors
/// If one cannot be drawn or written.
pub fn write(directory: &Path, references: &[Reference], style: &FigureStyle) -> Result<(), Failure> {
    for curves in references.iter().flat_map(Reference::curves) {
        let figure = HistoryFigure::new(&curves.histories).at_stops(&curves.stops).title(&curves.title);
        figure.with_acceleration().render()?.styled(style).write(directory.join(format!("{}.svg", curves.file)))?;
    }
    Ok(())
}

/// Motions of the contacts at the points that figures and page show, if there are any, and at those that are asked for;
/// no more than the branch has.
///
/// # Errors
/// [`BranchError`] if a point cannot be evaluated again.
pub fn of_points(computed: &ComputedBranch, files: &OutputFiles) -> Result<PointHistories, BranchError> {
    let mut points = files.histories.clone();
    if files.figures || files.page {
        points.extend(figure_points(&computed.branch).into_iter().chain(reference_points(&computed.branch)));
    }
    points.retain(|point| *point < computed.branch.points.len());
    points.sort_unstable();
    points.dedup();
    let mut histories = Histories::of(computed);
    let mut all = |samples: usize| {
        let motions = points.iter().map(|point| histories.at(*point, samples, "")).collect::<Result<Vec<_>, _>>();
        let longest = |motions: &[Vec<TimeHistory>]| motions.iter().flatten().map(|h| h.time.len()).max();
        motions.map(|motions| (longest(&motions).unwrap_or(0), motions))
    };
    let (mut longest, mut motions) = all(SAMPLES)?;
    // Points with more changes of contact than there are instants have more of these: then all have.
    while motions.iter().flatten().any(|history| history.time.len() != longest) {
        (longest, motions) = all(longest - 1)?;
    }
    Ok(PointHistories { points, motions })
}
