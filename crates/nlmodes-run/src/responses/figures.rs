//! The figures of responses.

use std::f64::consts::TAU;

use nlmodes::modal::ModalPoint;
use nlmodes::report::{Figure, LineKind, Quantity, ReportError, ResponseFigure, ResponseLine};
use nlmodes_scene::scene::{ResponseKind, Scene};

use super::curves::ComputedResponse;
use super::model::Model;
use super::overlaid::{LaidCurve, LaidPoint};
use crate::Failure;

/// Name of the file, title, and the figure.
pub type Named = (&'static str, &'static str, Figure);

/// The figures that have something to show, the first one being what the run is about.
pub fn all(
    scene: &Scene,
    model: &Model,
    (curves, laid): (&[ComputedResponse], &[LaidCurve]),
) -> Result<Vec<Named>, Failure> {
    let draw = Draw { scene, unit: model.unit, curves, laid };
    let mut drawn = Vec::new();
    for (name, title, figure) in draw.all() {
        match figure {
            Ok(figure) => drawn.push((name, title, figure)),
            Err(ReportError::NothingToDraw { .. }) => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(drawn)
}

struct Draw<'a> {
    scene: &'a Scene,
    unit: &'static str,
    curves: &'a [ComputedResponse],
    laid: &'a [LaidCurve],
}

/// A quantity of a point, NaN where it has none.
type Value = fn(&ModalPoint) -> f64;

/// Abscissa and ordinate of what is laid over, where a figure has both.
type LaidValues = Option<[fn(&LaidPoint) -> f64; 2]>;

/// Frequency of the load, or of a free motion, Hz.
fn hertz(point: &ModalPoint) -> f64 {
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

impl Draw<'_> {
    fn all(&self) -> Vec<(&'static str, &'static str, Result<Figure, ReportError>)> {
        let amplitude: Value = |point| point.fundamental.abs();
        let over_level = |c: &ComputedResponse| c.kind == ResponseKind::Force;
        let over_frequency = |c: &ComputedResponse| !over_level(c);
        let of_window = |c: &ComputedResponse| matches!(c.kind, ResponseKind::Frequency | ResponseKind::PhaseResonance);
        let is_damped = |c: &ComputedResponse| c.kind == ResponseKind::DampedMode;
        let resonant = |c: &ComputedResponse| matches!(c.kind, ResponseKind::PhaseResonance | ResponseKind::DampedMode);
        let frequency = || Quantity::linear("frequency", "Hz");
        let fundamental = || Quantity::linear("fundamental of the first contact", "m");
        let unit = self.unit;
        let of_laid = |y: fn(&LaidPoint) -> f64| -> LaidValues { Some([|p: &LaidPoint| p.frequency, y]) };
        vec![
            (
                "responses.svg",
                "Amplitude of the first contact over frequency",
                self.figure(
                    &over_frequency,
                    [frequency(), fundamental()],
                    (hertz, amplitude),
                    of_laid(|p| p.fundamental),
                    true,
                ),
            ),
            (
                "force_response.svg",
                "Amplitude of the first contact over the level",
                self.figure(
                    &over_level,
                    [Quantity::linear("level", unit), fundamental()],
                    (level, amplitude),
                    None,
                    false,
                ),
            ),
            (
                "drive.svg",
                "Amplitude of the drive point over frequency",
                self.figure(
                    &over_frequency,
                    [frequency(), Quantity::linear("fundamental of the drive point", "m")],
                    (hertz, drive),
                    of_laid(|p| p.drive),
                    true,
                ),
            ),
            (
                "phase.svg",
                "Lag of the drive point over frequency",
                self.figure(
                    &of_window,
                    [frequency(), Quantity::linear("lag of the drive point", "degrees")],
                    (hertz, lag),
                    of_laid(|p| p.lag),
                    false,
                ),
            ),
            (
                "contact_force.svg",
                "Largest force at a stop over frequency",
                self.figure(
                    &over_frequency,
                    [frequency(), Quantity::linear("largest contact force", "N")],
                    (hertz, |point| point.peak_contact_force),
                    of_laid(|p| p.force),
                    false,
                ),
            ),
            (
                "damping_ratio.svg",
                "Damping ratio of the damped mode over energy",
                self.figure(
                    &is_damped,
                    [Quantity::logarithmic("averaged kinetic energy", "J"), Quantity::linear("damping ratio in %", "")],
                    (|point| point.kinetic_energy, damping_percent),
                    None,
                    false,
                ),
            ),
            (
                "force_needed.svg",
                "Level that holds a resonance, over its frequency",
                self.figure(
                    &resonant,
                    [frequency(), Quantity::linear("level needed", unit)],
                    (hertz, needed),
                    None,
                    false,
                ),
            ),
        ]
    }

    fn figure(
        &self,
        is_shown: &dyn Fn(&ComputedResponse) -> bool,
        [abscissa, ordinate]: [Quantity; 2],
        (x, y): (Value, Value),
        laid: LaidValues,
        is_bounded: bool,
    ) -> Result<Figure, ReportError> {
        let shown = || self.curves.iter().filter(|c| is_shown(c) && !c.branch.points.is_empty());
        let line = |c: &ComputedResponse| ResponseLine {
            name: c.branch.label.clone(),
            kind: kind(c.kind),
            points: c.branch.points.iter().map(|p| (x(p), y(p), p.stability.and_then(|s| s.stable))).collect(),
        };
        let mut lines: Vec<ResponseLine> = shown().map(line).collect();
        if is_bounded {
            within_responses(&mut lines);
        }
        if let (Some([x, y]), false) = (laid, lines.is_empty()) {
            let laid = self.laid.iter().map(|curve| ResponseLine {
                name: curve.name.clone(),
                kind: curve.kind,
                points: curve.points.iter().map(|p| (x(p), y(p), None)).collect(),
            });
            lines.extend(laid.filter(|line| line.points.iter().any(|p| p.0.is_finite() && p.1.is_finite())));
        }
        let mut figure = ResponseFigure::new(&lines, abscissa, ordinate).title(&self.scene.title);
        for computed in shown().filter(|c| c.kind == ResponseKind::PhaseResonance) {
            for point in &computed.at_levels {
                figure = figure.mark(x(point), y(point), "");
            }
        }
        figure.render()
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
