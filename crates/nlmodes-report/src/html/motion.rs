//! Motions for the script: as many points as fit into a page of sensible size, in whole numbers.

use super::HtmlReport;
use super::knots::knots;
use super::number::rounded;
use crate::StopLine;
use crate::stations::{self, Station};
use nlmodes_modal::{ModalBranch, ModalPoint, TimeHistory};
use num_complex::Complex64;
use serde::Serialize;

/// Bytes that the motions of all branches may take.
const BUDGET: usize = 1_500_000;
/// Fewest and most points of a branch whose motion the page holds, beside those with an event or a name.
const POINTS: (usize, usize) = (12, 300);
const MAX_STATIONS: usize = 41;
/// By how much of its largest value displacement and force of a contact may be missed.
const CONTACT_TOLERANCE: f64 = 2e-3;
/// Largest whole number in which a motion is expressed: a ten-thousandth of a pixel is not seen, a thousandth is not either.
const FULL_SCALE: f64 = 9999.0;

/// A factor and the whole numbers that it turns into SI units.
type Packed = (f64, Vec<Option<i32>>);

/// Factor, real parts, imaginary parts unless all are zero: stations × harmonics.
type PackedMotion = (f64, Vec<Vec<i32>>, Option<Vec<Vec<i32>>>);

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
    /// The points whose motion is here, ascending.
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
    phase: Vec<i32>,
    displacement: Packed,
    force: Packed,
}

impl MotionData {
    /// None where there is nothing to move.
    pub fn new(report: &HtmlReport<'_>, index: usize, stops: &[StopLine]) -> Option<Self> {
        let branch = report.branches[index];
        let (stations, stops) = shown(report, branch, stops);
        // Contacts of a reduced structure are not strung along an axis.
        if stations.len() < 2 || stations::kind(branch) == "contact" {
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
            word: word(kind),
            is_axial: kind == "axial",
            x: stations.iter().map(|(position, _)| *position).collect(),
            held: (0..stations.len()).filter(|d| stations[*d].1.is_none()).collect(),
            stops: stops.iter().map(at).collect(),
            frames: points.iter().map(frame).collect(),
            points,
        })
    }
}

/// What the displacement of a kind of coordinates is called.
pub(super) fn word(kind: &str) -> &'static str {
    match kind {
        "axial" => "axial displacement",
        "deflection" => "deflection",
        "rotation" => "rotation",
        _ => "displacement",
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

/// The points whose motion the page holds: all of them, or some at even steps and those with an event or a name.
fn chosen_points(report: &HtmlReport<'_>, index: usize, n_stations: usize, n_stops: usize) -> Vec<usize> {
    let points = &report.branches[index].points;
    let (n, n_harmonics) =
        (points.len(), points.iter().map(|point| point.coefficients.n_harmonics()).max().unwrap_or(0));
    let contacts = if report.contact_motion.is_some() { n_stops } else { 0 };
    let bytes = 10 * n_stations * (n_harmonics + 1) + 1000 * contacts;
    let most = (BUDGET / report.branches.len().max(1) / bytes.max(1)).clamp(POINTS.0, POINTS.1);
    let stride = n.div_ceil(most).max(1);
    let named = |point: usize| report.marks.iter().any(|(branch, marked, _)| (*branch, *marked) == (index, point));
    let is_shown = |i: &usize| i.is_multiple_of(stride) || i + 1 == n || !points[*i].events.is_empty() || named(*i);
    (0..n).filter(is_shown).filter(|i| is_finite(&points[*i], report.branches[index].coordinates.len())).collect()
}

fn is_finite(point: &ModalPoint, n_coordinates: usize) -> bool {
    let coefficients = &point.coefficients;
    let complete = coefficients.n_coordinates() == n_coordinates;
    complete && (0..n_coordinates).all(|d| coefficients.of(d).iter().all(|q| q.is_finite()))
}

fn packed_motion(point: &ModalPoint, stations: &[Station]) -> PackedMotion {
    let row = |station: &Station| station.1.map_or(&[] as &[Complex64], |d| point.coefficients.of(d));
    let parts = || stations.iter().flat_map(row).flat_map(|q| [q.re, q.im]);
    let scale = scale(parts());
    let packed = |part: fn(&Complex64) -> f64| -> Vec<Vec<i32>> {
        stations
            .iter()
            .map(|station| row(station).iter().map(|q| whole(part(q), scale)).collect())
            .map(trimmed)
            .collect()
    };
    let imaginary = packed(|q| q.im);
    let is_even = imaginary.iter().all(Vec::is_empty);
    (scale, packed(|q| q.re), (!is_even).then_some(imaginary))
}

/// Without the zeros at its end.
fn trimmed(mut row: Vec<i32>) -> Vec<i32> {
    row.truncate(row.iter().rposition(|value| *value != 0).map_or(0, |last| last + 1));
    row
}

fn contact(history: &TimeHistory) -> Option<Contact> {
    let (time, displacement, force) = (&history.time, &history.displacement, &history.force);
    let [first, .., last] = time[..] else { return None };
    if time.len() != displacement.len() || time.len() != force.len() {
        return None;
    }
    let chosen = knots(time, &[displacement, force], CONTACT_TOLERANCE);
    let pick = |values: &[f64]| chosen.iter().map(|k| values[*k]).collect::<Vec<f64>>();
    let phase = |time: f64| ((time - first) / (last - first) * 1e4).round() as i32;
    Some(Contact {
        phase: pick(time).into_iter().map(phase).collect(),
        displacement: packed(&pick(displacement)),
        force: packed(&pick(force)),
    })
}

fn packed(values: &[f64]) -> Packed {
    let scale = scale(values.iter().copied());
    let value = |value: &f64| value.is_finite().then(|| whole(*value, scale));
    (scale, values.iter().map(value).collect())
}

/// The factor with which the largest of the values becomes [`FULL_SCALE`].
fn scale(values: impl Iterator<Item = f64>) -> f64 {
    let largest = values.filter(|value| value.is_finite()).fold(0.0, |m: f64, value| m.max(value.abs()));
    if largest > 0.0 { rounded(largest / FULL_SCALE, 8) } else { 1.0 }
}

fn whole(value: f64, scale: f64) -> i32 {
    // Within ±10000 by the choice of the scale.
    (value / scale).round() as i32
}
