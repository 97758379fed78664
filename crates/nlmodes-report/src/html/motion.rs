//! Motions for the script: as many points as fit into a page of reasonable size, as integers.

use super::HtmlReport;
use super::knots::knots;
use super::packed::{Packed, PackedRows, scale};
use crate::StopLine;
use crate::stations::{self, Station};
use nlmodes_modal::{Event, ModalBranch, ModalPoint, TimeHistory};
use num_complex::Complex64;
use serde::Serialize;
use std::collections::BTreeSet;

/// Approximate limit for the motions of all branches, bytes.
const BUDGET: usize = 1_500_000;
/// Bytes of displacement and force of a contact, about.
const CONTACT_BYTES: usize = 800;
/// Minimum and maximum number of points of a branch whose motion is on the page, in addition to its ends and named
/// points.
const POINTS: (usize, usize) = (12, 300);
const MAX_STATIONS: usize = 41;
/// Tolerance of displacement and force of a contact relative to the largest value.
const CONTACT_TOLERANCE: f64 = 4e-3;

/// Whether a motion can be drawn over the position of its stations: contacts of a structure in space are not along an
/// axis.
pub(super) fn is_along_an_axis(branch: &ModalBranch, stations: &[Station]) -> bool {
    stations.len() > 1 && stations::kind(branch) != "contact"
}

/// Cosine coefficients of all stations, and those of the sines, if any.
type PackedMotion = (PackedRows, Option<PackedRows>);

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct MotionData {
    word: &'static str,
    is_axial: bool,
    /// Positions of the stations, m.
    x: Vec<f64>,
    /// Stations that are clamped.
    held: Vec<usize>,
    stops: Vec<StopData>,
    /// The points with motion, ascending.
    points: Vec<usize>,
    frames: Vec<Frame>,
}

#[derive(Serialize)]
struct StopData {
    number: usize,
    station: usize,
    at: f64,
    side: i32,
}

#[derive(Serialize)]
struct Frame {
    motion: PackedMotion,
    contacts: Vec<Option<Contact>>,
}

#[derive(Serialize)]
struct Contact {
    /// Ten-thousandths of the period, ascending, both ends among them.
    phase: Packed,
    displacement: Packed,
    force: Packed,
}

impl MotionData {
    /// None if there is no motion.
    pub fn new(report: &HtmlReport<'_>, index: usize, stops: &[StopLine]) -> Option<Self> {
        let branch = report.branches[index];
        let (stations, stops) = shown(report, branch, stops);
        if !is_along_an_axis(branch, &stations) {
            return None;
        }
        let points = chosen_points(report, index, stations.len(), stops.len());
        let frame = |point: &usize| {
            let histories = report.contact_motion.and_then(|motion| motion(index, *point)).unwrap_or_default();
            let contact = |(number, ..): &(usize, StopLine, usize)| histories.get(*number).and_then(contact);
            let motion = packed_motion(&branch.points[*point], &stations);
            Frame { motion, contacts: stops.iter().map(contact).collect() }
        };
        let at = |(number, stop, station): &(usize, StopLine, usize)| StopData {
            number: *number,
            station: *station,
            at: stop.position,
            side: if stop.positive { 1 } else { -1 },
        };
        let kind = stations::kind(branch);
        Some(Self {
            word: stations::word(kind),
            is_axial: stations::motion_of(kind) == "axial",
            x: stations.iter().map(|(position, _)| *position).collect(),
            held: (0..stations.len()).filter(|d| stations[*d].1.is_none()).collect(),
            stops: stops.iter().map(at).collect(),
            frames: points.iter().map(frame).collect(),
            points,
        })
    }
}

/// The stations, and the stops that limit their kind of motion: their number, themselves and their station.
pub(super) fn shown(
    report: &HtmlReport<'_>,
    branch: &ModalBranch,
    stops: &[StopLine],
) -> (Vec<Station>, Vec<(usize, StopLine, usize)>) {
    let kind = stations::kind(branch);
    let coordinate = |stop: &StopLine| branch.coordinates.get(stop.coordinate).filter(|c| c.kind == kind);
    let kept: Vec<f64> = stops.iter().filter_map(|stop| Some(coordinate(stop)?.position)).collect();
    let stations = stations::thinned(stations::stations(branch, kind, &report.clamped), MAX_STATIONS, &kept);
    let station = |stop: &StopLine| {
        let position = coordinate(stop).filter(|_| stop.position.is_finite())?.position;
        stations.iter().position(|(at, _)| *at == position)
    };
    let stops = stops.iter().enumerate().filter_map(|(number, stop)| Some((number, *stop, station(stop)?))).collect();
    (stations, stops)
}

/// The points whose motion is on the page: the ends and named points, then those with an event, then others at even
/// steps, up to the limit. Contact changes alone do not count: with many stops nearly every point has one.
fn chosen_points(report: &HtmlReport<'_>, index: usize, n_stations: usize, n_stops: usize) -> Vec<usize> {
    let branch = report.branches[index];
    let (points, n) = (&branch.points, branch.points.len());
    let n_harmonics = points.iter().map(|point| point.coefficients.n_harmonics()).max().unwrap_or(0);
    let contacts = if report.contact_motion.is_some() { n_stops } else { 0 };
    // Four letters for each three bytes, with sines.
    let bytes = 5 * n_stations * (n_harmonics + 1) + CONTACT_BYTES * contacts;
    let most = (BUDGET / report.branches.len().max(1) / bytes.max(1)).clamp(POINTS.0, POINTS.1);
    let named = |point: usize| report.marks.iter().any(|(branch, marked, _)| (*branch, *marked) == (index, point));
    let tells = |point: usize| points[point].events.iter().any(|event| *event != Event::ContactChange);
    let finite: Vec<usize> = (0..n).filter(|i| is_finite(&points[*i], branch.coordinates.len())).collect();
    let mut chosen: BTreeSet<usize> = finite.iter().copied().filter(|i| *i == 0 || i + 1 == n || named(*i)).collect();
    let told: Vec<usize> = finite.iter().copied().filter(|i| tells(*i)).collect();
    chosen.extend(evenly(&told, most));
    chosen.extend(evenly(&finite, most.saturating_sub(chosen.len())));
    chosen.into_iter().collect()
}

/// At most this many of them, at even steps.
fn evenly(all: &[usize], most: usize) -> impl Iterator<Item = usize> {
    let stride = all.len().div_ceil(most.max(1)).max(1);
    let none = if most == 0 { 0 } else { all.len() };
    all[..none].iter().copied().step_by(stride)
}

fn is_finite(point: &ModalPoint, n_coordinates: usize) -> bool {
    let coefficients = &point.coefficients;
    let complete = coefficients.n_coordinates() == n_coordinates;
    complete && (0..n_coordinates).all(|d| coefficients.of(d).iter().all(|q| q.is_finite()))
}

fn packed_motion(point: &ModalPoint, stations: &[Station]) -> PackedMotion {
    let row = |station: &Station| station.1.map_or(&[] as &[Complex64], |d| point.coefficients.of(d));
    let scale = scale(stations.iter().flat_map(row).flat_map(|q| [q.re, q.im]));
    let packed = |part: fn(&Complex64) -> f64| {
        let rows: Vec<Vec<f64>> = stations.iter().map(|station| row(station).iter().map(part).collect()).collect();
        PackedRows::new(&rows, scale)
    };
    let imaginary = packed(|q| q.im);
    let is_even = imaginary.is_zero();
    (packed(|q| q.re), (!is_even).then_some(imaginary))
}

fn contact(history: &TimeHistory) -> Option<Contact> {
    let (time, displacement, force) = (&history.time, &history.displacement, &history.force);
    let [first, .., last] = time[..] else { return None };
    if time.len() != displacement.len() || time.len() != force.len() {
        return None;
    }
    let chosen = knots(time, &[displacement, force], CONTACT_TOLERANCE);
    let pick = |values: &[f64]| chosen.iter().map(|k| values[*k]).collect::<Vec<f64>>();
    let phases: Vec<f64> = chosen.iter().map(|k| (time[*k] - first) / (last - first)).collect();
    Some(Contact {
        phase: Packed::new(&phases),
        displacement: Packed::new(&pick(displacement)),
        force: Packed::new(&pick(force)),
    })
}
