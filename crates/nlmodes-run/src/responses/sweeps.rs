//! Slow sweeps in time beside the curves over the frequency.

use std::f64::consts::{PI, TAU};
use std::time::{Duration, Instant};

use nlmodes::hbm::ResponseRow;
use nlmodes::report::{LineKind, ResponseLine};
use nlmodes::timestep::{ForcedStructure, Signal, TimestepError, TransientSettings};
use nlmodes_scene::scene::{Response, ResponseKind};
use nlmodes_scene::{SceneFile, number};
use num_complex::Complex64;
use serde_json::{Value, json};

use crate::course::Cosine;
use crate::model::Model;
use crate::model::{push_laws, structure};
use crate::{Event, Observer, RunError, chain, refusal};

/// Bandwidths `2 ζ f` of the mode by which the frequency moves in the time `1/(2 ζ f)`, where the scene does not say.
const SLOW: f64 = 0.25;

/// The most of it over the frequency: by about so much a jump may be late.
const LATE: f64 = 0.004;

/// Instants of a turn of the load at which the motion is looked at.
const INSTANTS: usize = 16;

/// Most amplitudes in the figure.
const SHOWN: usize = 200;

/// Intervals after which the observer is asked whether to go on.
const ASKED: u32 = 4096;

/// A level that was swept.
#[derive(Debug)]
pub struct Sweep {
    /// Number of the response in the scene, from 0.
    pub response: usize,
    /// The level, in the unit of the load.
    pub level: f64,
    /// Whether the frequency grows.
    pub up: bool,
    /// Its length, s.
    duration: f64,
    /// Frequency of the load (Hz) and amplitude of the first contact at it (m), of each turn of the load.
    pub points: Vec<[f64; 2]>,
    wall_time: Duration,
}

impl Sweep {
    /// For `summary.json`.
    pub fn summary(&self) -> Value {
        let peak = self.points.iter().max_by(|a, b| a[1].total_cmp(&b[1]));
        json!({
            "response": self.response + 1,
            "level": self.level,
            "direction": if self.up { "up" } else { "down" },
            "duration_s": self.duration,
            "turns": self.points.len(),
            "peak": peak.map(|[hz, amplitude]| json!({ "frequency_hz": hz, "amplitude_m": amplitude })),
            "wall_time_s": self.wall_time.as_secs_f64(),
        })
    }

    /// For the figure.
    pub fn line(&self, unit: &str) -> ResponseLine {
        let apart = self.points.len().div_ceil(SHOWN).max(1);
        let points = self.points.iter().step_by(apart).map(|[hz, amplitude]| (*hz, *amplitude, None)).collect();
        ResponseLine { name: self.name(unit), kind: LineKind::Measured, points }
    }

    fn name(&self, unit: &str) -> String {
        format!("{} {unit}, swept {}", number(self.level), if self.up { "up" } else { "down" })
    }
}

/// The sweeps that the scene asks for.
///
/// # Errors
/// [`RunError`] at the response that it is about.
pub fn all(file: &SceneFile, model: &Model, observer: &mut dyn Observer) -> Result<Vec<Sweep>, RunError> {
    let wanted = file.scene.responses.iter().enumerate();
    let wanted: Vec<(usize, &Response, f64, bool)> = wanted
        .filter(|(_, response)| response.sweep && response.kind == ResponseKind::Frequency)
        .flat_map(|(i, response)| response.levels.iter().map(move |level| (i, response, *level)))
        .flat_map(|(i, response, level)| [true, false].map(|up| (i, response, level, up)))
        .collect();
    let of = wanted.len();
    let mut found = Vec::new();
    for (k, (i, response, level, up)) in wanted.into_iter().enumerate() {
        let at = |title: &str| -> RunError {
            let expected = "expected a response that can be swept in time";
            file.error_at(&format!("response.{i}.sweep"), title, expected, &[]).into()
        };
        let duration = duration(response, model).ok_or_else(|| at("without damping a sweep needs `sweep_s`"))?;
        let mut sweep = Sweep { response: i, level, up, duration, points: Vec::new(), wall_time: Duration::default() };
        observer.event(Event::Curve { number: k + 1, of, name: &sweep.name(model.unit) });
        let (began, mut driven) = (Instant::now(), Driven::new(file, model, &sweep, response)?);
        match driven.run(&mut sweep, observer) {
            Err(TimestepError::Ended) => return Ok(found),
            done => done.map_err(|error| at(&chain(&error)))?,
        }
        sweep.wall_time = began.elapsed();
        found.push(sweep);
    }
    Ok(found)
}

/// Length of a sweep, s: that of the scene, or by the bandwidth of the mode.
fn duration(response: &Response, model: &Model) -> Option<f64> {
    let [low, high] = response.frequency_hz[..] else { return None };
    let damping = model.response().structure().damping();
    let least = (0..model.open_modes().n_modes()).map(|k| damping.entry(k, k) / TAU).find(|width| *width > 0.0);
    response.sweep_s.or_else(|| least.map(|width| (high - low) / (width * (SLOW * width).min(LATE * low))))
}

/// A part of a complex amplitude, and the phase of its cosine, rad.
type Part = (OfAmplitude, f64);

/// Real or negative imaginary part of a complex amplitude.
type OfAmplitude = fn(&Complex64) -> f64;

/// The structure under a load whose frequency is swept.
struct Driven {
    structure: ForcedStructure,
    signals: Vec<Cosine>,
    /// Angular frequency at the beginning (rad/s) and its rate (rad/s²).
    omega: f64,
    rate: f64,
}

impl Driven {
    fn new(file: &SceneFile, model: &Model, sweep: &Sweep, response: &Response) -> Result<Self, RunError> {
        let [low, high] = response.frequency_hz[..] else { return Err(RunError::NoScene) };
        let [from, to] = if sweep.up { [low, high] } else { [high, low] };
        let (omega, rate) = (TAU * from, TAU * (to - from) / sweep.duration);
        let key = format!("response.{}.sweep", sweep.response);
        let mut structure = structure(file, model)?;
        let (m, c) = (structure.n_modes(), structure.n_contacts());
        let first = model.first_place();
        let rows =
            model.response().rows(std::slice::from_ref(&first)).map_err(|error| refusal::here(file, &key, &error))?;
        let Some(row) = rows.first() else { return Err(RunError::NoScene) };
        let mut signals = Vec::new();
        // Of each load its term, and which part of that it is.
        let mut inputs: Vec<(usize, OfAmplitude)> = Vec::new();
        for (number, term) in model.response().terms().iter().enumerate() {
            // Re(p e^{inφ}) = Re p cos nφ − Im p cos(nφ − π/2).
            let parts: [Part; 2] = [(|p| p.re, 0.0), (|p| -p.im, -0.5 * PI)];
            for (part, phase) in parts {
                let of = |values: &[Complex64]| values.iter().map(part).collect::<Vec<f64>>();
                let (modal, gaps) = (of(&term.modal[..m]), of(&term.gaps));
                if modal.iter().chain(&gaps).all(|v| *v == 0.0) {
                    continue;
                }
                structure.push_input(&modal, &gaps).map_err(|error| refusal::here(file, &key, &error))?;
                inputs.push((number, part));
                let n = term.harmonic as f64;
                let (start, end) = (0.0, f64::INFINITY);
                signals.push(Cosine { amplitude: sweep.level, phase, omega: n * omega, rate: n * rate, start, end });
            }
        }
        let moved =
            |row: &ResponseRow| inputs.iter().map(|(number, part)| part(&row.loads[*number])).collect::<Vec<f64>>();
        push_laws(file, model, &mut structure, &|_, row| moved(row))?;
        let by_inputs = [moved(row), row.contacts[c..].to_vec()].concat();
        structure
            .push_observed(&row.modes[..m], &row.contacts[..c], &by_inputs)
            .map_err(|error| refusal::here(file, &key, &error))?;
        Ok(Self { structure, signals, omega, rate })
    }

    /// Time at which the load has turned by an angle, s.
    fn time(&self, angle: f64) -> f64 {
        let root = (self.omega * self.omega + 2.0 * self.rate * angle).max(0.0).sqrt();
        2.0 * angle / (self.omega + root)
    }

    fn run(&mut self, sweep: &mut Sweep, observer: &dyn Observer) -> Result<(), TimestepError> {
        let signals: Vec<&dyn Signal> = self.signals.iter().map(|signal| signal as &dyn Signal).collect();
        let settings = TransientSettings { duration: sweep.duration, signals: &signals, blows: &[] };
        let turn = |k: usize| TAU * k as f64 / INSTANTS as f64;
        let (mut k, mut next, mut sum, mut count) = (0_usize, 0.0, Complex64::default(), 0_u32);
        let state = vec![0.0; self.structure.n_states()];
        let mut observe = |stretch: &nlmodes::timestep::Stretch<'_>, _: bool| {
            let end = stretch.from() + stretch.length();
            let along = (next <= end).then(|| stretch.observed(0));
            while let Some(along) = along.filter(|_| next <= end) {
                sum += Complex64::cis(-turn(k)) * along.at((next - stretch.from()).max(0.0))[0];
                k += 1;
                if k.is_multiple_of(INSTANTS) {
                    let hz = (self.omega + self.rate * next) / TAU;
                    sweep.points.push([hz, 2.0 * sum.norm() / INSTANTS as f64]);
                    sum = Complex64::default();
                }
                next = self.time(turn(k));
            }
            count = count.wrapping_add(1);
            !count.is_multiple_of(ASKED) || !observer.is_cancelled()
        };
        self.structure.transient(&state, &settings, &mut observe, &mut |_| {}).map(drop)
    }
}
