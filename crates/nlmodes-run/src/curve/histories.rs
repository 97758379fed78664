//! Time histories of the contacts at the points that are named in figures (Fig. 9): of one curve, or of several
//! methods over each other.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::modal::TimeHistory;
use nlmodes::report::{FigureStyle, HistoryFigure, PointHistories};
use nlmodes_scene::scene::OutputFiles;

use super::{Curve, stops};
use crate::Failure;

/// Most curves over each other.
pub const MAX_CURVES: usize = 8;
/// Most stops with a figure of their own where several branches are compared.
const MAX_STOPS: usize = 4;
/// Instants of a period.
pub const SAMPLES: usize = 1000;

/// Motions of one or several branches with the same modal amplitude.
#[derive(Debug)]
pub struct Reference {
    /// `P1`, `P2`.
    pub name: String,
    /// The modal amplitude, m√kg.
    pub amplitude: f64,
    /// Point of the first branch next to it.
    pub point: usize,
    /// Title of its figures.
    pub title: String,
    /// A period of each branch that has such a point: all of its contacts.
    pub motions: Vec<Vec<TimeHistory>>,
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
            [only] if only.is_empty() => Vec::new(),
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

/// The reference points of one curve, with its motion there.
///
/// # Errors
/// If a point cannot be evaluated again.
pub fn own_references(curve: &dyn Curve) -> Result<Vec<Reference>, Failure> {
    let branch = curve.branch();
    let of = |(k, point): (usize, usize)| {
        let found = &branch.points[point];
        let mut motion = curve.histories(point, SAMPLES, &branch.label)?;
        if motion.len() > 1 {
            motion.iter_mut().zip(stops::names(curve)).for_each(|(history, name)| history.label = name);
        }
        let (number, hz) = (curve.first() + point, found.listed_omega() / TAU);
        let title = format!("P{} (point {number}, {hz:.4} Hz)", k + 1);
        let name = format!("P{}", k + 1);
        Ok(Reference { name, amplitude: found.modal_amplitude, point, title, motions: vec![motion] })
    };
    curve.references().into_iter().enumerate().map(of).collect()
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

/// What is reported of points that `output.histories` asks for and `what`, of so many points, does not have.
pub fn missing(files: &OutputFiles, what: &str, n_points: usize) -> impl Iterator<Item = String> {
    let points = files.histories.iter().filter(move |point| **point >= n_points);
    let said = format!("which the {what} of {n_points} points does not have");
    points.map(move |point| format!("output.histories asks for point {point}, {said}"))
}

/// Motions of the contacts at the points that figures and page show, if there are any: of the first curve those of
/// pictures too, of all their references; and at those that are asked for, by their numbers in the table of all curves.
///
/// # Errors
/// If a point cannot be evaluated again.
pub fn of_points(curves: &[&dyn Curve], files: &OutputFiles) -> Result<PointHistories, Failure> {
    let (mut wanted, mut first) = (Vec::new(), 0);
    for (number, curve) in curves.iter().enumerate() {
        let count = curve.branch().points.len();
        let own = files.histories.iter().filter_map(|point| point.checked_sub(first)).filter(|point| *point < count);
        let mut points: Vec<usize> = own.collect();
        if files.figures || files.page {
            points.extend(if number == 0 { curve.pictured() } else { Vec::new() });
            points.extend(curve.references());
        }
        points.sort_unstable();
        points.dedup();
        wanted.extend(points.into_iter().map(|point| (*curve, first, point)));
        first += count;
    }
    let all = |samples: usize| {
        let motion = |(curve, _, point): &(&dyn Curve, usize, usize)| curve.histories(*point, samples, "");
        let motions = wanted.iter().map(motion).collect::<Result<Vec<_>, _>>();
        let longest = |motions: &[Vec<TimeHistory>]| motions.iter().flatten().map(|h| h.time.len()).max();
        motions.map(|motions| (longest(&motions).unwrap_or(0), motions))
    };
    let (mut longest, mut motions) = all(SAMPLES)?;
    // Points with more changes of contact than there are instants have more of these: then all have.
    while motions.iter().flatten().any(|history| history.time.len() != longest) {
        (longest, motions) = all(longest - 1)?;
    }
    Ok(PointHistories { points: wanted.iter().map(|(_, first, point)| first + point).collect(), motions })
}
