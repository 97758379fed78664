//! `summary.json`: what was asked, what was done and why it ended.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::time::Duration;

use nlmodes::branches::{BeyondAccuracy, ComputedBranch, ComputedTree};
use nlmodes::report::write_summary;
use nlmodes::timestep::UNIT_CIRCLE;
use serde::Serialize;

use super::About;
use super::sink::branch_directory;
use crate::Failure;
use crate::certificate::{Certificate, Number, NumberError, Place};
use crate::curve::summary::{AtRest, ContactAt, End, Reduction, Resonance, Stability, largest_residual, place};
use crate::linear::{LinearFrequencies, modal_model};
use nlmodes_scene::scene::{MethodKind, Scene};

#[derive(Serialize)]
struct Summary<'a> {
    program: &'static str,
    version: &'static str,
    scene: &'a Scene,
    /// What the structure is, where frequencies are imposed on its modes.
    #[serde(skip_serializing_if = "Option::is_none")]
    model: Option<String>,
    linear_frequencies_hz: &'a LinearFrequencies,
    grazing: GrazingPoint,
    method: MethodUsed,
    #[serde(skip_serializing_if = "Option::is_none")]
    reduction: Option<Reduction>,
    /// Of a structure from files: which nodes each contact joins.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    contacts: Vec<ContactAt>,
    /// Each contact under static loads, or where a stop presses.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    rest: Vec<AtRest>,
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy: Option<AccuracyUsed>,
    points: usize,
    /// The point whose period is in `motion.pvd`.
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<Place>,
    /// Why there is no stress, if only the size of the structure prevents it.
    #[serde(skip_serializing_if = "Option::is_none")]
    stress_left_out: Option<String>,
    events: Vec<EventAt>,
    internal_resonances: Vec<Resonance>,
    stability: Stability,
    end: End<'a>,
    largest_residual: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<BTreeMap<Number, &'a NumberError>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    certificate: Option<&'a Certificate>,
    evaluations: usize,
    refused_steps: usize,
    other_branches: Vec<OtherBranch<'a>>,
    arms_not_followed: usize,
    wall_time_s: f64,
}

#[derive(Serialize)]
struct GrazingPoint {
    frequency_hz: f64,
    energy_j: f64,
    contact: usize,
    contact_amplitude_m: f64,
}

/// The method in words, and what it came to.
#[derive(Serialize)]
pub struct MethodUsed {
    pub name: &'static str,
    equations: &'static str,
    held_modes: usize,
    held_modes_at_contacts: usize,
    recorded_coordinates: usize,
    degrees_of_freedom: usize,
    largest_unfolding: Option<f64>,
}

/// What was chosen for an accuracy, and by which estimate.
#[derive(Serialize)]
struct AccuracyUsed {
    asked: f64,
    /// Of all points.
    largest_error_estimate: f64,
    largest_error_estimate_of_held_modes: f64,
    reached: bool,
    points_beyond: usize,
    harmonics_min: usize,
    harmonics_max: usize,
    changes_of_harmonics: usize,
    held_modes: usize,
    held_modes_of: usize,
    not_reached: Vec<NotReached>,
}

/// Points in a row that do not reach the accuracy.
#[derive(Serialize)]
struct NotReached {
    points: [usize; 2],
    frequency_hz: [f64; 2],
    largest_error_estimate: f64,
}

impl From<&BeyondAccuracy> for NotReached {
    fn from(stretch: &BeyondAccuracy) -> Self {
        Self {
            points: stretch.points,
            frequency_hz: stretch.frequency.map(|omega| omega / TAU),
            largest_error_estimate: stretch.largest_estimate,
        }
    }
}

impl AccuracyUsed {
    fn new(scene: &Scene, computed: &ComputedBranch) -> Option<Self> {
        let (asked, reached) = (scene.method.accuracy?, computed.accuracy?);
        Some(Self {
            asked: asked.error,
            largest_error_estimate: reached.largest_estimate,
            largest_error_estimate_of_held_modes: reached.largest_held_modes_estimate,
            reached: reached.points_beyond == 0,
            points_beyond: reached.points_beyond,
            harmonics_min: reached.harmonics[0],
            harmonics_max: reached.harmonics[1],
            changes_of_harmonics: reached.changes,
            held_modes: computed.structure.n_held_modes(),
            held_modes_of: computed.structure.model().linear_dofs().len(),
            not_reached: computed.beyond_accuracy().iter().map(NotReached::from).collect(),
        })
    }
}

#[derive(Serialize)]
struct EventAt {
    point: usize,
    event: &'static str,
    frequency_hz: f64,
    energy_j: f64,
    energy_over_grazing: f64,
}

/// A branch that leaves another one at a branch point.
#[derive(Serialize)]
struct OtherBranch<'a> {
    directory: PathBuf,
    from_branch: Option<usize>,
    from_point: Option<usize>,
    points: usize,
    reason: String,
    message: String,
    complete: bool,
    largest_residual: f64,
    internal_resonances: Vec<Resonance>,
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<BTreeMap<Number, &'a NumberError>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    certificate: Option<&'a Certificate>,
}

impl<'a> OtherBranch<'a> {
    fn new(number: usize, computed: &ComputedBranch, certificate: Option<&'a Certificate>) -> Self {
        let (branch, origin) = (&computed.branch, computed.origin);
        Self {
            directory: branch_directory(Path::new(""), number),
            from_branch: origin.map(|o| o.branch),
            from_point: origin.map(|o| o.point),
            points: branch.points.len(),
            reason: branch.end.names(),
            message: branch.end.message.clone(),
            complete: branch.end.complete,
            largest_residual: largest_residual(&computed.branch.points),
            internal_resonances: Resonance::all(&computed.branch.points, 0),
            errors: certificate.map(Certificate::by_number),
            certificate,
        }
    }
}

/// Writes the summary.
pub fn write(
    directory: &Path,
    (scene, about): (&Scene, &About<'_>),
    (tree, certificates): (&ComputedTree, &[Certificate]),
    wall_time: Duration,
) -> Result<(), Failure> {
    let Some(computed) = tree.branches.first() else { return Ok(()) };
    let points = &computed.branch.points;
    let events = points.iter().enumerate().flat_map(|(i, point)| {
        point.events.iter().map(move |event| EventAt {
            point: i,
            event: event.name(),
            frequency_hz: point.omega / TAU,
            energy_j: point.kinetic_energy,
            energy_over_grazing: point.kinetic_energy / computed.grazing.energy,
        })
    });
    let others = tree.branches.iter().enumerate().skip(1);
    let others = others.map(|(k, b)| OtherBranch::new(k, b, certificates.get(k)));
    let summary = Summary {
        program: "nlmodes-cli",
        version: env!("CARGO_PKG_VERSION"),
        scene,
        model: scene.structure.straight().and_then(modal_model),
        linear_frequencies_hz: about.linear,
        grazing: GrazingPoint {
            frequency_hz: computed.grazing.omega / TAU,
            energy_j: computed.grazing.energy,
            contact: computed.grazing.contact,
            contact_amplitude_m: amplitude_at_contacts(computed),
        },
        method: method_used(scene, computed),
        reduction: about.open.map(|open| Reduction::new(scene, open, computed.grazing.contact)),
        contacts: ContactAt::all(about.open),
        rest: AtRest::all(about.state),
        accuracy: AccuracyUsed::new(scene, computed),
        points: points.len(),
        stress_left_out: about.stress_left_out.map(str::to_owned),
        motion: about.period.and_then(|period| place(points, 0, period.point)),
        events: events.collect(),
        internal_resonances: Resonance::all(&computed.branch.points, 0),
        stability: Stability::new(points, 0, Some(UNIT_CIRCLE)),
        end: End::from(&computed.branch.end),
        largest_residual: largest_residual(&computed.branch.points),
        errors: certificates.first().map(Certificate::by_number),
        certificate: certificates.first(),
        evaluations: computed.evaluations,
        refused_steps: computed.refused_steps,
        other_branches: others.collect(),
        arms_not_followed: tree.not_followed,
        wall_time_s: wall_time.as_secs_f64(),
    };
    Ok(write_summary(directory.join("summary.json"), &summary)?)
}

/// Largest displacement of a contact coordinate in the linear mode at grazing, m.
fn amplitude_at_contacts(computed: &ComputedBranch) -> f64 {
    computed.grazing.contact_amplitudes(&computed.structure).iter().fold(0.0, |largest, b| largest.max(b.abs()))
}

pub fn method_used(scene: &Scene, computed: &ComputedBranch) -> MethodUsed {
    MethodUsed {
        name: match scene.method.kind {
            MethodKind::MsHbm if scene.is_in_open_modes() => "mixed shooting-harmonic balance, free-interface modes",
            MethodKind::MsHbm => "mixed shooting-harmonic balance, massless contact nodes",
            MethodKind::Hbm => "harmonic balance, elastic stops, contact nodes in harmonics",
            MethodKind::Shooting => "exact shooting, linear motion between located contact instants",
        },
        equations: match computed.largest_unfolding {
            None if scene.method.kind == MethodKind::Shooting => {
                "rest at the beginning and after half a period (motions even in time); harmonics.npz has the \
                    coefficients of the exact motion"
            }
            None => "cosine coefficients only (motions even in time): square without a phase anchor",
            Some(_) => "full Fourier series with a phase anchor and an unfolding parameter",
        },
        held_modes: computed.structure.n_held_modes(),
        held_modes_at_contacts: computed.structure.n_coupled_modes(),
        recorded_coordinates: computed.structure.recorded_dofs().len(),
        degrees_of_freedom: computed.structure.model().dofs().len(),
        largest_unfolding: computed.largest_unfolding,
    }
}
