//! The figures of responses.

use std::f64::consts::TAU;

use nlmodes::modal::{ModalBranch, ModalPoint};
use nlmodes::report::{Figure, LineKind, Quantity, ReportError, ResponseFigure, ResponseLine};
use nlmodes_scene::scene::{ResponseKind, Scene};

use super::curves::ComputedResponse;
use super::sweeps::Sweep;
use crate::Failure;
use crate::curve;
use crate::curve::figures::Named;
use crate::model::Model;
use crate::overlay::LaidCurve;

/// The figures that have something to show, the first one being what the run is about.
pub fn all(
    scene: &Scene,
    model: &Model,
    (curves, laid): (&[ComputedResponse], &[LaidCurve]),
    sweeps: &[Sweep],
) -> Result<Vec<Named>, Failure> {
    let mut found = Vec::new();
    for drawn in drawn(model.unit, !model.contacts.is_empty()) {
        let (file, title) = (drawn.file, drawn.title);
        let swept = if file == "responses.svg" { sweeps } else { &[] };
        let figure = drawn.figure(&scene.title, (curves, laid), (swept, model.unit))?;
        found.extend(figure.map(|figure| Named::new(file, title, figure)));
    }
    Ok(found)
}

/// A quantity of a point, NaN where it has none.
type Value = fn(&ModalPoint) -> f64;

/// Frequency of the load, or of a free motion, Hz.
pub fn hertz(point: &ModalPoint) -> f64 {
    point.listed_omega() / TAU
}

/// Amplitude of the drive point, m.
pub fn drive(point: &ModalPoint) -> f64 {
    point.driven.and_then(|driven| driven.drive).map_or(f64::NAN, |drive| drive.norm())
}

/// By how much the drive point lags the load, degrees.
pub fn lag(point: &ModalPoint) -> f64 {
    point.driven.and_then(|driven| driven.lag_deg()).unwrap_or(f64::NAN)
}

/// Level of the load, in its unit.
pub fn level(point: &ModalPoint) -> f64 {
    point.driven.and_then(|driven| driven.level).unwrap_or(f64::NAN)
}

/// Level, or force, that holds the motion.
fn needed(point: &ModalPoint) -> f64 {
    point.driven.and_then(|driven| driven.level.or(driven.force)).unwrap_or(f64::NAN)
}

/// Damping ratio of a damped mode, %.
fn damping_percent(point: &ModalPoint) -> f64 {
    100.0 * point.driven.and_then(|driven| driven.damping_ratio).unwrap_or(f64::NAN)
}

/// A figure, and what it shows.
struct Drawn {
    file: &'static str,
    title: &'static str,
    shown: fn(ResponseKind) -> bool,
    axes: [Quantity; 2],
    values: [Value; 2],
    /// What is laid over it.
    laid: fn(&LaidCurve) -> bool,
    /// Whether modes and phase resonances end where they leave what the responses span.
    is_bounded: bool,
}

/// The amplitude that curves show: that of the first stop or, without one, of the first spring with a law of force.
const OF_CONTACT: &str = "fundamental of the first contact";
const OF_SPRING: &str = "fundamental of the first spring";

/// Name of the amplitude that the curves of a model show.
pub fn observed(model: &Model) -> &'static str {
    if model.contacts.is_empty() { OF_SPRING } else { OF_CONTACT }
}

/// All figures over the curves of a scene, with the unit of its levels; without stops amplitudes are those of the first
/// spring with a law of force.
fn drawn(unit: &str, has_stops: bool) -> [Drawn; 7] {
    let over_frequency: fn(ResponseKind) -> bool = |kind| kind != ResponseKind::Force;
    let amplitude: Value = |point| point.fundamental.abs();
    let frequency = || Quantity::linear("frequency", "Hz");
    let titled = |stop: &'static str, spring: &'static str| if has_stops { stop } else { spring };
    let fundamental = || Quantity::linear(titled(OF_CONTACT, OF_SPRING), "m");
    [
        Drawn {
            file: "responses.svg",
            title: titled(
                "Amplitude of the first contact over frequency",
                "Amplitude of the first spring over frequency",
            ),
            shown: over_frequency,
            axes: [frequency(), fundamental()],
            values: [hertz, amplitude],
            laid: |_| true,
            is_bounded: true,
        },
        Drawn {
            file: "force_response.svg",
            title: titled(
                "Amplitude of the first contact over the level",
                "Amplitude of the first spring over the level",
            ),
            shown: |kind| kind == ResponseKind::Force,
            axes: [Quantity::linear("level", unit), fundamental()],
            values: [level, amplitude],
            laid: |_| false,
            is_bounded: false,
        },
        Drawn {
            file: "drive.svg",
            title: "Amplitude of the drive point over frequency",
            shown: over_frequency,
            axes: [frequency(), Quantity::linear("fundamental of the drive point", "m")],
            values: [hertz, drive],
            laid: |_| true,
            is_bounded: true,
        },
        Drawn {
            file: "phase.svg",
            title: "Lag of the drive point over frequency",
            shown: |kind| matches!(kind, ResponseKind::Frequency | ResponseKind::PhaseResonance),
            axes: [frequency(), Quantity::linear("lag of the drive point", "degrees")],
            values: [hertz, lag],
            laid: |curve| curve.has_lag,
            is_bounded: false,
        },
        Drawn {
            file: "contact_force.svg",
            title: "Largest force at a stop over frequency",
            shown: over_frequency,
            axes: [frequency(), Quantity::linear("largest contact force", "N")],
            values: [hertz, |point| point.peak_contact_force],
            laid: |_| true,
            is_bounded: false,
        },
        Drawn {
            file: "damping_ratio.svg",
            title: "Damping ratio of the damped mode over energy",
            shown: |kind| kind == ResponseKind::DampedMode,
            axes: [Quantity::logarithmic("averaged kinetic energy", "J"), Quantity::linear("damping ratio in %", "")],
            values: [|point| point.kinetic_energy, damping_percent],
            laid: |_| false,
            is_bounded: false,
        },
        Drawn {
            file: "force_needed.svg",
            title: "Level that holds a resonance, over its frequency",
            shown: |kind| matches!(kind, ResponseKind::PhaseResonance | ResponseKind::DampedMode),
            axes: [frequency(), Quantity::linear("level needed", unit)],
            values: [hertz, needed],
            laid: |_| false,
            is_bounded: false,
        },
    ]
}

impl Drawn {
    fn figure(
        self,
        title: &str,
        (curves, laid): (&[ComputedResponse], &[LaidCurve]),
        (swept, unit): (&[Sweep], &str),
    ) -> Result<Option<Figure>, ReportError> {
        let [x, y] = self.values;
        let shown = || curves.iter().filter(|c| (self.shown)(c.kind) && !c.branch.points.is_empty());
        let line = |branch: &ModalBranch, kind: LineKind, is_judged: bool| ResponseLine {
            name: branch.label.clone(),
            kind,
            points: branch
                .points
                .iter()
                .map(|p| (x(p), y(p), p.stability.filter(|_| is_judged).and_then(|s| s.stable)))
                .collect(),
        };
        let mut lines: Vec<ResponseLine> = shown().map(|c| line(&c.branch, kind(c.kind), true)).collect();
        if self.is_bounded {
            within_responses(&mut lines);
        }
        if !lines.is_empty() {
            let laid =
                laid.iter().filter(|curve| (self.laid)(curve)).map(|curve| line(&curve.branch, curve.kind, false));
            lines.extend(laid.filter(|line| line.points.iter().any(|p| p.0.is_finite() && p.1.is_finite())));
        }
        lines.extend(swept.iter().map(|sweep| sweep.line(unit)));
        let [abscissa, ordinate] = self.axes;
        let mut figure = ResponseFigure::new(&lines, abscissa, ordinate).title(title);
        for computed in shown().filter(|c| c.kind == ResponseKind::PhaseResonance) {
            for point in &computed.at_levels {
                figure = figure.mark(x(point), y(point), "");
            }
        }
        curve::figures::drawn(figure.render())
    }
}

/// How curves of this kind are drawn.
pub fn kind(kind: ResponseKind) -> LineKind {
    match kind {
        ResponseKind::Frequency | ResponseKind::Force => LineKind::Response,
        ResponseKind::PhaseResonance => LineKind::Resonance,
        ResponseKind::DampedMode => LineKind::DampedMode,
        ResponseKind::Mode | ResponseKind::Appropriation => LineKind::Mode,
    }
}

/// How far modes and phase resonance are drawn beyond the responses.
const BEYOND: f64 = 1.15;

/// Cuts modes and phase resonance where they leave what the responses span: these are what is looked at.
fn within_responses(lines: &mut [ResponseLine]) {
    let responses = lines.iter().filter(|l| l.kind == LineKind::Response).flat_map(|l| &l.points);
    let (mut low, mut high, mut most) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for (x, y, _) in responses.filter(|p| p.0.is_finite() && p.1.is_finite()) {
        (low, high, most) = (low.min(*x), high.max(*x), most.max(*y));
    }
    if low >= high {
        return;
    }
    for line in lines.iter_mut().filter(|l| l.kind != LineKind::Response) {
        for (x, y, _) in &mut line.points {
            if !(low..=high).contains(x) || *y > BEYOND * most {
                *y = f64::NAN;
            }
        }
    }
}
