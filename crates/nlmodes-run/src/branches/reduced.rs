//! Entries of `summary.json` for free-interface modes, for the contacts of a structure from files, and for the motion
//! shown.

use std::f64::consts::TAU;

use nlmodes::modal::ModalPoint;
use nlmodes_io::NodeContact;
use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::Scene;
use serde::Serialize;

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
    pub fn new(scene: &Scene, open: &OpenStructure, contact: usize) -> Self {
        Self {
            kind: "open-modes",
            modes: open.modes.n_modes(),
            highest_frequency_hz: open.highest_hz(),
            half_as_many_change_frequency_by: open.truncation_error(scene.method.mode, contact),
        }
    }
}

/// The point whose motion is shown.
#[derive(Serialize)]
pub struct MotionAt {
    point: usize,
    frequency_hz: f64,
    energy_j: f64,
}

impl MotionAt {
    pub fn new(point: usize, points: &[ModalPoint]) -> Option<Self> {
        let shown = points.get(point)?;
        Some(Self { point, frequency_hz: shown.omega / TAU, energy_j: shown.kinetic_energy })
    }
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
    pub fn all(contacts: &[NodeContact]) -> Vec<Self> {
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
