//! Data for the script of the page.

use super::HtmlReport;
use super::history::HistoryData;
use super::motion::MotionData;
use super::number::rounded;
use super::packed::Column;
use super::wire::WireData;
use crate::StopLine;
use crate::figure::EventSymbols;
use crate::palette;
use nlmodes_modal::{ContactPeriod, Event, ModalBranch, ModalPoint, tongues};
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Data {
    branches: Vec<BranchData>,
    /// Branch, point, name.
    marks: Vec<(usize, usize, String)>,
    event_symbols: Vec<EventSymbol>,
    histories: Vec<HistoryData>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wire: Option<WireData>,
    colors: Colors,
    /// Linear modes whose shares in the energy are drawn, from 0.
    strongest_modes: Vec<usize>,
    /// Names, with units, of the quantities that this page adds.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    quantities: Vec<String>,
    /// Abscissa and ordinate of the main figure.
    #[serde(skip_serializing_if = "Option::is_none")]
    main_axes: Option<[String; 2]>,
}

#[derive(Serialize)]
struct EventSymbol {
    name: String,
    shape: &'static str,
    fill: &'static str,
    /// Drawing order; the highest is on top.
    layer: usize,
    /// Its meaning; empty if unknown.
    meaning: &'static str,
}

#[derive(Serialize)]
struct Colors {
    /// Colours of the branches, repeated after the last.
    branches: Vec<&'static str>,
    touching: &'static str,
    leaving: &'static str,
    /// Colours of the stops, repeated after the last.
    stops: Vec<&'static str>,
}

/// Quantities of a stop at each point.
#[derive(Serialize)]
struct StopColumns {
    /// Share of the period.
    closed: Column,
    /// N·s per period.
    impulse: Column,
    /// Largest, N.
    force: Column,
}

impl StopColumns {
    fn new(points: &[ModalPoint], stop: usize) -> Self {
        let column =
            |value: fn(&ContactPeriod) -> f64| Column::new(points.iter().map(|p| value(&p.contacts[stop])).collect());
        Self { closed: column(|c| c.closed_share), impulse: column(|c| c.impulse), force: column(|c| c.peak_force) }
    }
}

/// Columns over the points; a value that is not finite is null.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct BranchData {
    label: String,
    /// Number of its first point in a table of all branches.
    first: usize,
    color: &'static str,
    /// Whether its points are measured and not connected.
    scattered: bool,
    /// Hz.
    frequency: Vec<f64>,
    energy: Vec<f64>,
    total_energy: Column,
    amplitude: Vec<f64>,
    peak: Column,
    contact_fraction: Column,
    contact_intervals: Vec<usize>,
    force: Column,
    /// Quantities of each stop, if there are several or one with an impulse.
    stops: Vec<StopColumns>,
    residual: Column,
    /// Share of each harmonic in the averaged kinetic energy.
    shares: (usize, Column),
    events: BTreeMap<usize, Vec<&'static str>>,
    resonance: BTreeMap<usize, String>,
    /// Points that are unstable, and the magnitude of the largest Floquet multiplier of each point, if known.
    unstable: Vec<usize>,
    multiplier: BTreeMap<usize, f64>,
    /// Points that are not connected to the previous one.
    resumed: Vec<usize>,
    /// Point at the end of the branch at which the linear mode ends.
    grazing: Option<usize>,
    /// Point and name of each internal-resonance branch.
    tongues: Vec<(usize, String)>,
    /// Share of each linear mode in the kinetic energy; none if unknown.
    participation: Vec<Column>,
    /// Quantities added by the page.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    extra: Vec<Column>,
    motion: Option<MotionData>,
}

impl Data {
    pub fn new(report: &HtmlReport<'_>) -> Self {
        let mut symbols = EventSymbols::default();
        for event in report.branches.iter().flat_map(|branch| &branch.points).flat_map(|point| &point.events) {
            symbols.of(*event);
        }
        let symbol = |(event, shape, fill): (Event, crate::chart::Shape, _)| EventSymbol {
            name: event.name().into(),
            layer: EventSymbols::layer(event),
            meaning: EventSymbols::meaning(event),
            shape: shape.name(),
            fill,
        };
        Self {
            branches: (0..report.branches.len()).map(|index| BranchData::new(report, index)).collect(),
            marks: report.marks.clone(),
            event_symbols: symbols.all().map(symbol).collect(),
            histories: report
                .histories
                .iter()
                .filter_map(|(name, all, look)| HistoryData::of_all(name, all, look))
                .collect(),
            wire: report.wireframe.as_ref().map(super::wire::Wireframe::data),
            colors: Colors {
                branches: palette::CURVES.to_vec(),
                touching: palette::TOUCHING,
                leaving: palette::LEAVING,
                stops: palette::STOPS.to_vec(),
            },
            strongest_modes: report.strongest_modes(),
            quantities: report.quantities.iter().map(|(label, _)| label.clone()).collect(),
            main_axes: report.main_figure.as_ref().map(|main| main.axes.clone()),
        }
    }

    /// As JSON that can be embedded in a `script` element: no `<`, `>` or `&`.
    pub fn json(&self) -> String {
        // Maps with integer keys, vectors and numbers always have a JSON form.
        let text = serde_json::to_string(self).unwrap_or_else(|_| "null".into());
        text.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
    }
}

impl BranchData {
    fn new(report: &HtmlReport<'_>, index: usize) -> Self {
        let branch = report.branches[index];
        let points = &branch.points;
        let column = |digits: usize, value: &dyn Fn(&ModalPoint) -> f64| {
            points.iter().map(|point| rounded(value(point), digits)).collect::<Vec<f64>>()
        };
        let short = |value: &dyn Fn(&ModalPoint) -> f64| Column::new(points.iter().map(value).collect());
        let with_events = points.iter().enumerate().filter(|(_, point)| !point.events.is_empty());
        let resonant = points.iter().enumerate().filter_map(|(i, point)| Some((i, point.resonance?.to_string())));
        let resumed = points.iter().enumerate().filter(|(_, point)| point.has_event(Event::Resumed));
        let tongues = tongues(points).into_iter();
        let n_stops = points.iter().map(|point| point.contacts.len()).min().unwrap_or(0);
        let judged = || {
            points
                .iter()
                .enumerate()
                .filter_map(|(i, point)| Some((i, point.stability.filter(|s| s.stable.is_some())?)))
        };
        Self {
            label: branch.label.clone(),
            first: report.first_points.get(index).copied().unwrap_or(0),
            color: report.color(index),
            scattered: report.scattered.contains(&index),
            // Tips of internal-resonance branches are narrow: ten digits.
            frequency: column(10, &|point| point.omega / TAU),
            energy: column(10, &|point| point.kinetic_energy),
            amplitude: column(10, &|point| point.modal_amplitude),
            total_energy: short(&|point| point.total_energy),
            peak: short(&|point| point.peak),
            contact_fraction: short(&|point| point.contact_fraction),
            contact_intervals: points.iter().map(|point| point.contact_intervals).collect(),
            force: short(&|point| point.peak_contact_force),
            stops: (0..n_stops).map(|stop| StopColumns::new(points, stop)).collect(),
            residual: short(&|point| point.residual),
            shares: shares(points),
            events: with_events
                .map(|(i, point)| (i, point.events.iter().map(|event| event.name()).collect()))
                .collect(),
            resonance: resonant.collect(),
            unstable: judged().filter(|(_, s)| s.is_unstable()).map(|(i, _)| i).collect(),
            multiplier: judged().map(|(i, s)| (i, rounded(s.magnitude(), 7))).collect(),
            resumed: resumed.map(|(i, _)| i).collect(),
            grazing: grazing(branch),
            tongues: tongues.map(|t| (if t.skipped { t.start } else { t.tip }, t.resonance.to_string())).collect(),
            participation: participation(report, index),
            extra: report.quantities.iter().map(|(_, all)| Column::new(all[index].clone())).collect(),
            motion: MotionData::new(report, index, &stops(report, branch)),
        }
    }
}

/// The stops of the report at the coordinates of this branch, or the first one of the branch.
pub(super) fn stops(report: &HtmlReport<'_>, branch: &ModalBranch) -> Vec<StopLine> {
    if !report.stops.is_empty() {
        // Another method may have its coordinates in another order.
        let main = report.branches.first().map_or(&[] as &[_], |first| first.coordinates.as_slice());
        let place = |stop: &StopLine| {
            let wanted = main.get(stop.coordinate)?;
            let is_same = branch.coordinates.get(stop.coordinate) == Some(wanted);
            if is_same { Some(stop.coordinate) } else { branch.coordinates.iter().position(|c| c == wanted) }
        };
        // A stop that the branch lacks keeps its index.
        let moved = |stop: &StopLine| StopLine { coordinate: place(stop).unwrap_or(usize::MAX), ..*stop };
        return report.stops.iter().map(moved).collect();
    }
    StopLine::first_of(branch).into_iter().collect()
}

fn participation(report: &HtmlReport<'_>, index: usize) -> Vec<Column> {
    let of = |mode: usize| Column::new(report.participation[index].iter().map(|p| p.energy_shares[mode]).collect());
    (0..report.participating_modes()).map(of).collect()
}

/// Number of harmonics with the mean, and the share of each in the energy, point by point; zeros where a point has
/// fewer.
fn shares(points: &[ModalPoint]) -> (usize, Column) {
    let width = points.iter().map(|point| point.harmonic_energy.len()).max().unwrap_or(0);
    let of = |point: &ModalPoint| {
        let whole: f64 = point.harmonic_energy.iter().sum();
        let share = |n: usize| point.harmonic_energy.get(n).map_or(0.0, |energy| energy / whole);
        (0..width).map(share).collect::<Vec<f64>>()
    };
    (width, Column::new(points.iter().flat_map(of).collect()))
}

/// The grazing point with which a branch begins or ends.
fn grazing(branch: &ModalBranch) -> Option<usize> {
    let last = branch.points.len().checked_sub(1)?;
    [0, last].into_iter().find(|index| branch.points[*index].leaves_linear_mode())
}
