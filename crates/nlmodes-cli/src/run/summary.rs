//! `summary.json`: what was asked, what was done and why it ended.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;
use std::time::Duration;

use nlmodes::model::StructuralModel;
use nlmodes::report::write_summary;
use nlmodes::study::ComputedBranch;
use serde::Serialize;

use crate::config::scene::{MethodKind, Scene};
use crate::modes::{LinearFrequencies, linear_frequencies};

#[derive(Serialize)]
struct Summary<'a> {
    program: &'static str,
    version: &'static str,
    scene: &'a Scene,
    linear_frequencies_hz: LinearFrequencies,
    grazing: GrazingPoint,
    method: MethodUsed,
    points: usize,
    events: Vec<EventAt<'a>>,
    end: End<'a>,
    largest_residual: f64,
    evaluations: usize,
    refused_steps: usize,
    wall_time_s: f64,
}

#[derive(Serialize)]
struct GrazingPoint {
    frequency_hz: f64,
    energy_j: f64,
    contact: usize,
    contact_amplitude_m: f64,
}

#[derive(Serialize)]
struct MethodUsed {
    name: &'static str,
    equations: &'static str,
    held_modes: usize,
    held_modes_at_contacts: usize,
    largest_unfolding: Option<f64>,
}

#[derive(Serialize)]
struct EventAt<'a> {
    point: usize,
    event: &'a str,
    frequency_hz: f64,
    energy_j: f64,
    energy_over_grazing: f64,
}

#[derive(Serialize)]
struct End<'a> {
    reason: &'a str,
    message: &'a str,
    complete: bool,
}

/// Writes the summary.
pub fn write(
    directory: &Path,
    scene: &Scene,
    model: &StructuralModel,
    computed: &ComputedBranch,
    wall_time: Duration,
) -> Result<(), Box<dyn Error>> {
    let points = &computed.branch.points;
    let events = points.iter().enumerate().flat_map(|(i, point)| {
        point.events.iter().map(move |event| EventAt {
            point: i,
            event,
            frequency_hz: point.omega / TAU,
            energy_j: point.kinetic_energy,
            energy_over_grazing: point.kinetic_energy / computed.grazing.energy,
        })
    });
    let end = &computed.branch.end;
    let summary = Summary {
        program: "nlmodes-cli",
        version: env!("CARGO_PKG_VERSION"),
        scene,
        linear_frequencies_hz: linear_frequencies(scene, model)?,
        grazing: GrazingPoint {
            frequency_hz: computed.grazing.omega / TAU,
            energy_j: computed.grazing.energy,
            contact: computed.grazing.contact,
            contact_amplitude_m: computed.grazing.scales().length,
        },
        method: method_used(scene, computed),
        points: points.len(),
        events: events.collect(),
        end: End { reason: &end.reason, message: &end.message, complete: end.complete },
        largest_residual: points.iter().fold(0.0, |m, p| p.residual.max(m)),
        evaluations: computed.evaluations,
        refused_steps: computed.refused_steps,
        wall_time_s: wall_time.as_secs_f64(),
    };
    Ok(write_summary(directory.join("summary.json"), &summary)?)
}

fn method_used(scene: &Scene, computed: &ComputedBranch) -> MethodUsed {
    MethodUsed {
        name: match scene.method.kind {
            MethodKind::MsHbm => "mixed shooting-harmonic balance, massless contact nodes",
            MethodKind::Hbm => "harmonic balance, elastic stops, contact nodes in harmonics",
        },
        equations: match computed.largest_unfolding {
            None => "cosine coefficients only (motions even in time): square without a phase anchor",
            Some(_) => "full Fourier series with a phase anchor and an unfolding parameter",
        },
        held_modes: computed.structure.n_held_modes(),
        held_modes_at_contacts: computed.structure.modes().len(),
        largest_unfolding: computed.largest_unfolding,
    }
}

/// Removes summary and coefficients of an earlier run, which would not belong to the points of this one.
pub fn remove(directory: &Path) {
    ["summary.json", "harmonics.npz"].iter().for_each(|name| drop(std::fs::remove_file(directory.join(name))));
}
