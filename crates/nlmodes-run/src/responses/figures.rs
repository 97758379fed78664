//! The figures of responses.

use std::f64::consts::TAU;

use nlmodes::report::{Figure, LineKind, Quantity, ReportError, ResponseFigure, ResponseLine};
use nlmodes::response::ResponsePoint;
use nlmodes_scene::scene::{ResponseKind, Scene};

use super::convert::Converter;
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
    let draw = Draw { scene, model, curves, laid, converter: Converter::new(model)? };
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
    model: &'a Model,
    curves: &'a [ComputedResponse],
    laid: &'a [LaidCurve],
    converter: Converter<'a>,
}

type Value<'v> = &'v dyn Fn(&ComputedResponse, &ResponsePoint) -> f64;

/// Abscissa and ordinate of what is laid over, where a figure has both.
type LaidValues = Option<[fn(&LaidPoint) -> f64; 2]>;

impl Draw<'_> {
    fn all(&self) -> Vec<(&'static str, &'static str, Result<Figure, ReportError>)> {
        let hertz: Value<'_> = &|_, p| p.omega / TAU;
        let amplitude: Value<'_> = &|c, p| {
            let subharmonic = self.scene.responses[c.response].subharmonic;
            self.converter.fundamental(p, c.is_forced(), subharmonic).abs()
        };
        let drive: Value<'_> = &|_, p| if p.drive.norm() > 0.0 { p.drive.norm() } else { f64::NAN };
        let force: Value<'_> = &|_, p| p.motion.contacts.iter().map(|c| c.peak_force).fold(0.0, f64::max);
        let lag: Value<'_> = &|_, p| if p.drive.norm() > 0.0 { p.lag().to_degrees() } else { f64::NAN };
        let level: Value<'_> = &|_, p| p.level;
        let needed: Value<'_> = &|c, p| match c.kind {
            ResponseKind::DampedMode => 2.0 * p.motion.dissipated_power / (p.motion.at.omega * p.drive.norm()),
            _ => p.level,
        };
        let over_level = |c: &ComputedResponse| c.kind == ResponseKind::Force;
        let over_frequency = |c: &ComputedResponse| !over_level(c);
        let of_window = |c: &ComputedResponse| matches!(c.kind, ResponseKind::Frequency | ResponseKind::PhaseResonance);
        let is_damped = |c: &ComputedResponse| c.kind == ResponseKind::DampedMode;
        let resonant = |c: &ComputedResponse| matches!(c.kind, ResponseKind::PhaseResonance | ResponseKind::DampedMode);
        let frequency = || Quantity::linear("frequency", "Hz");
        let fundamental = || Quantity::linear("fundamental of the first contact", "m");
        let unit = self.model.unit;
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
                    (hertz, force),
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
                    (&|_, p| p.motion.kinetic_energy, &|_, p| 100.0 * p.motion.damping_ratio()),
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
        (x, y): (Value<'_>, Value<'_>),
        laid: LaidValues,
        is_bounded: bool,
    ) -> Result<Figure, ReportError> {
        let shown = || self.curves.iter().filter(|c| is_shown(c) && !c.points().is_empty());
        let line = |c: &ComputedResponse| ResponseLine {
            name: c.name.clone(),
            kind: kind(c.kind),
            points: c.points().iter().map(|p| (x(c, p), y(c, p), p.stability.and_then(|s| s.stable))).collect(),
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
            for point in computed.curve.iter().flat_map(|curve| &curve.at_levels) {
                figure = figure.mark(x(computed, point), y(computed, point), "");
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
