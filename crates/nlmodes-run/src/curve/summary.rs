//! Entries of `summary.json` that all curves have.

use nlmodes::modal::{BranchEnd, ModalPoint, Tongue, tongues};
use nlmodes_io::NodeContact;
use nlmodes_scene::assemble::{OpenStructure, StaticState};
use nlmodes_scene::scene::Scene;
use serde::Serialize;

use crate::certificate::Place;

/// The reduction to free-interface modes.
#[derive(Serialize)]
pub struct Reduction {
    kind: &'static str,
    modes: usize,
    highest_frequency_hz: f64,
    /// By how much half as many modes change the frequency of the scene's mode with its first contact closed; none
    /// where they do not reach it.
    half_as_many_change_frequency_by: Option<f64>,
}

impl Reduction {
    /// With the mode of the scene and one of its contacts closed.
    pub fn new(scene: &Scene, open: &OpenStructure, contact: usize) -> Self {
        Self {
            kind: "open-modes",
            modes: open.modes.n_modes(),
            highest_frequency_hz: open.highest_hz(),
            half_as_many_change_frequency_by: open.truncation_error(scene.method.mode, contact),
        }
    }
}

/// The place of a point of a curve whose first one has this number.
pub fn place(points: &[ModalPoint], first: usize, point: usize) -> Option<Place> {
    points.get(point).map(|found| Place::of(first + point, found))
}

/// An internal-resonance branch: where it begins, has its tip and ends.
#[derive(Serialize)]
pub struct Resonance {
    name: String,
    harmonic: usize,
    mode: usize,
    skipped: bool,
    start: Option<Place>,
    tip: Option<Place>,
    end: Option<Place>,
    energy_j: [f64; 2],
}

impl Resonance {
    /// The internal-resonance branches of a curve whose first point has the number `first` in the table.
    pub fn all(points: &[ModalPoint], first: usize) -> Vec<Self> {
        let at = |point: usize| place(points, first, point);
        let of = |tongue: Tongue| Self {
            name: tongue.resonance.to_string(),
            harmonic: tongue.resonance.harmonic,
            mode: tongue.resonance.mode,
            skipped: tongue.skipped,
            start: at(tongue.start),
            tip: (!tongue.skipped).then(|| at(tongue.tip)).flatten(),
            end: tongue.end.and_then(at),
            energy_j: tongue.energy,
        };
        tongues(points).into_iter().map(of).collect()
    }
}

/// Floquet multipliers of the points of a curve.
#[derive(Serialize)]
pub struct Stability {
    stable_points: usize,
    unstable_points: usize,
    unknown_points: usize,
    /// Distance from the unit circle up to which a multiplier counts as lying on it, where it is the same everywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    largest_multiplier: Option<f64>,
    /// First and last point of each segment without stability.
    unstable: Vec<[usize; 2]>,
}

impl Stability {
    /// Of a curve whose first point has the number `first` in the table.
    pub fn new(points: &[ModalPoint], first: usize, tolerance: Option<f64>) -> Self {
        let count = |wanted| points.iter().filter(|p| p.stability.and_then(|s| s.stable) == wanted).count();
        let [stable_points, unstable_points, unknown_points] = [Some(true), Some(false), None].map(count);
        let mut unstable: Vec<[usize; 2]> = Vec::new();
        for (i, _) in (first..).zip(points).filter(|(_, p)| p.stability.is_some_and(|s| s.is_unstable())) {
            match unstable.last_mut().filter(|stretch| stretch[1] + 1 == i) {
                Some(stretch) => stretch[1] = i,
                None => unstable.push([i, i]),
            }
        }
        Self {
            stable_points,
            unstable_points,
            unknown_points,
            tolerance,
            largest_multiplier: points.iter().filter_map(|p| p.stability?.known_magnitude()).reduce(f64::max),
            unstable,
        }
    }
}

/// Why a curve has no further points.
#[derive(Serialize)]
pub struct End<'a> {
    reason: String,
    message: &'a str,
    complete: bool,
}

impl<'a> From<&'a BranchEnd> for End<'a> {
    fn from(end: &'a BranchEnd) -> Self {
        Self { reason: end.names(), message: &end.message, complete: end.complete }
    }
}

/// Largest scaled residual of these points.
pub fn largest_residual<'p>(points: impl IntoIterator<Item = &'p ModalPoint>) -> f64 {
    points.into_iter().fold(0.0, |m, p| p.residual.max(m))
}

/// A contact, by its nodes.
#[derive(Serialize)]
pub struct ContactAt {
    /// Its number in `contacts.csv`.
    contact: usize,
    node: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    against: Option<u64>,
    normal: [f64; 3],
    gap_m: f64,
}

impl ContactAt {
    /// The contacts of a structure from files; none of others.
    pub fn all(open: Option<&OpenStructure>) -> Vec<Self> {
        let contacts = open.and_then(|open| open.files.as_ref()).map_or(&[][..], |(_, found)| found);
        let of = |(contact, c): (usize, &NodeContact)| Self {
            contact,
            node: c.node,
            against: c.against,
            normal: c.normal,
            gap_m: c.gap,
        };
        contacts.iter().enumerate().map(of).collect()
    }
}

/// A contact of a structure under static loads, or that its stops press.
#[derive(Serialize)]
pub struct AtRest {
    /// Its number in `contacts.csv`.
    contact: usize,
    /// Its gap under the loads while all contacts are open; negative where the stop is in the way.
    free_gap_m: f64,
    /// Its clearance at rest, zero where it is closed; unknown of a structure that floats.
    #[serde(skip_serializing_if = "Option::is_none")]
    clearance_m: Option<f64>,
    /// Whether it is closed at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    closed: Option<bool>,
    /// Its force at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    force_n: Option<f64>,
}

impl AtRest {
    /// All contacts; none without static loads and stops that press.
    pub fn all(state: Option<&StaticState>) -> Vec<Self> {
        let Some(state) = state else { return Vec::new() };
        let of = |(contact, &free_gap_m): (usize, &f64)| {
            let rest = &state.rest;
            Self {
                contact,
                free_gap_m,
                clearance_m: rest.gaps.get(contact).copied(),
                closed: rest.closed.get(contact).copied(),
                force_n: rest.forces.get(contact).copied(),
            }
        };
        state.free_gaps.iter().enumerate().map(of).collect()
    }
}
