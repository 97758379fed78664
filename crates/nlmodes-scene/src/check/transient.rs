//! A motion in time: what must hold between its values.

use std::path::Path;

use super::response::Places;
use crate::raw::{RawAnalysis, RawStart, RawTransient, RawTransientLoad, StartWord};
use crate::rule::number;
use crate::scene::{Course, LoadOn, Transient, TransientLoad, TransientStart};
use crate::{Diagnostic, Diagnostics};

/// Envelope of a motion where the scene does not say.
const WINDOWS: u32 = 500;

/// The motion, if it is sound; paths count from `base`.
pub fn check(
    raw: &RawAnalysis,
    base: &Path,
    places: &Places<'_>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Transient> {
    let written = raw.transient.as_ref()?;
    alone(raw, diagnostics);
    has_damping(raw, written, places, diagnostics);
    let loads = written.load.as_deref().unwrap_or_default();
    let sound: Vec<TransientLoad> = loads
        .iter()
        .enumerate()
        .filter_map(|(i, load)| self::load(i, load, written.duration_s, base, places, diagnostics))
        .collect();
    let observed = written.place.as_deref().unwrap_or_default().iter().enumerate();
    let observed = observed.filter_map(|(i, place)| places.place(place, &keys("place", i), diagnostics)).collect();
    let from = match &written.from {
        RawStart::Word(StartWord::Rest) => TransientStart::Rest,
        RawStart::Word(StartWord::Static) => TransientStart::Static,
        RawStart::Point { results, point } => TransientStart::Point { results: base.join(results), point: *point },
    };
    if sound.is_empty() && loads.is_empty() && written.from == RawStart::default() && !presses(raw, diagnostics) {
        let diagnostic = Diagnostic::error("nothing moves: a motion from rest without a load");
        let label = "expected [[transient.load]], or `from` with a point of results";
        diagnostics.put("transient", diagnostic, label);
        return None;
    }
    Some(Transient {
        duration: written.duration_s,
        from,
        sample_rate: written.sample_rate_hz,
        envelope_windows: written.envelope_windows.unwrap_or(WINDOWS) as usize,
        loads: sound,
        places: observed,
    })
}

fn keys(table: &str, i: usize) -> [String; 5] {
    ["at_m", "node", "direction", "structure", "row"].map(|key| format!("transient.{table}.{i}.{key}"))
}

/// Whether static loads or a stop that presses move the structure.
fn presses(raw: &RawAnalysis, diagnostics: &Diagnostics<'_>) -> bool {
    let loads = raw.gravity.is_some() || raw.thermal.is_some() || raw.static_displacement.is_some();
    let gap = |i: usize| diagnostics.written(&format!("contact.{i}.gap_m")).starts_with('-');
    let stops = (0..).take_while(|i| diagnostics.has(&format!("contact.{i}"))).any(gap);
    loads || stops || raw.static_force.as_ref().is_some_and(|forces| !forces.is_empty())
}

/// Tables that say what else is computed, or what cannot be.
fn alone(raw: &RawAnalysis, diagnostics: &mut Diagnostics<'_>) {
    if raw.response.as_ref().is_some_and(|responses| !responses.is_empty()) {
        let diagnostic = Diagnostic::error("the scene asks for both a motion in time and responses");
        let help = "one scene for each: `from = { results = …, point = … }` begins on a response, and \
            [response] sweep = true sweeps along it";
        diagnostics.put("transient", diagnostic.help(help), "expected [transient] or [response]");
    }
    let unused = [
        ("force", raw.force.as_ref().is_some_and(|forces| !forces.is_empty())),
        ("base_motion", raw.base_motion.is_some()),
    ];
    for (key, _) in unused.into_iter().filter(|(_, there)| *there) {
        let diagnostic = Diagnostic::error(format!("`{key}` is a load for responses"));
        diagnostics.put(key, diagnostic, "expected [[transient.load]] for a motion in time");
    }
}

/// A motion under loads that go on needs damping.
fn has_damping(raw: &RawAnalysis, written: &RawTransient, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) {
    let goes_on = |load: &RawTransientLoad| load.sine.is_some() || load.chirp.is_some() || load.noise.is_some();
    if raw.damping.is_some() || places.are_damped() || !written.load.iter().flatten().any(goes_on) {
        return;
    }
    let diagnostic = Diagnostic::warning("a motion under a lasting load, without [damping]");
    let help = "[damping] with ratio = 0.01 damps all modes with 1 %";
    diagnostics.put("transient", diagnostic.help(help), "nothing bounds it at a resonance");
}

fn load(
    i: usize,
    raw: &RawTransientLoad,
    duration: f64,
    base: &Path,
    places: &Places<'_>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<TransientLoad> {
    let path = |key: &str| format!("transient.load.{i}.{key}");
    if raw.start_s >= duration {
        let diagnostic = Diagnostic::error(format!("`{}` is after the end of the motion", path("start_s")));
        diagnostics.put(&path("start_s"), diagnostic, format!("expected less than {} s", number(duration)));
        return None;
    }
    let on = on(i, raw, places, diagnostics);
    let is_base = raw.base.is_some();
    let course = course(raw, (is_base, duration), base, &path, diagnostics);
    Some(TransientLoad { on: on?, start: raw.start_s, course: course? })
}

/// Where a load acts.
fn on(i: usize, raw: &RawTransientLoad, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> Option<LoadOn> {
    let path = |key: &str| format!("transient.load.{i}.{key}");
    if raw.base.is_none() {
        return places.place(&raw.place, &keys("load", i), diagnostics).map(LoadOn::Force);
    }
    let place = &raw.place;
    let given = [("at_m", place.at_m.is_some()), ("node", place.node.is_some()), ("row", place.row.is_some())];
    if let Some((key, _)) = given.into_iter().find(|(_, there)| *there) {
        let diagnostic = Diagnostic::error(format!("`{}` beside `base`: the whole structure is shaken", path(key)));
        diagnostics.put(&path(key), diagnostic, "expected a place or `base`");
        return None;
    }
    if matches!(places, Places::Rows) {
        let diagnostic = Diagnostic::error("the base of a structure that was reduced elsewhere cannot move");
        let help = "its mass is not known, and with it what a moving base pushes";
        diagnostics.put(&path("base"), diagnostic.help(help), "expected `row`");
        return None;
    }
    places.base_direction(&path("direction"), place.direction.as_ref(), diagnostics).map(LoadOn::Base)
}

/// The one course that is given.
fn course(
    raw: &RawTransientLoad,
    (is_base, duration): (bool, f64),
    base: &Path,
    path: &dyn Fn(&str) -> String,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Course> {
    let given: Vec<&str> = [
        ("sine", raw.sine.is_some()),
        ("chirp", raw.chirp.is_some()),
        ("table", raw.table.is_some()),
        ("noise", raw.noise.is_some()),
        ("half_sine", raw.half_sine.is_some()),
        ("impact", raw.impact.is_some()),
    ]
    .into_iter()
    .filter_map(|(key, there)| there.then_some(key))
    .collect();
    if given.is_empty() {
        let whole = path("");
        let whole = whole.trim_end_matches('.');
        let diagnostic = Diagnostic::error(format!("`{whole}` has no time history"));
        let expected = "expected one of `sine`, `chirp`, `table`, `noise`, `half_sine` and `impact` in this table";
        diagnostics.put(whole, diagnostic, expected);
        return None;
    }
    if let [first, second, ..] = given[..] {
        let diagnostic = Diagnostic::error(format!("a load with two time histories, `{first}` and `{second}`"));
        diagnostics.put(&path(second), diagnostic.help("two loads at one place add"), "expected one of them");
        return None;
    }
    let mut size = |key: &str, of_force: Option<f64>, of_base: Option<f64>| -> Option<f64> {
        let name = |unit: &str| path(&format!("{key}_{unit}"));
        let (own, other) = if is_base { (of_base, of_force) } else { (of_force, of_base) };
        let (expected, wrong) = if is_base { ("m_s2", "n") } else { ("n", "m_s2") };
        if other.is_some() {
            let title = format!("`{}` is of {}", name(wrong), if is_base { "a force" } else { "a shaken base" });
            let short = format!("{}_{expected}", key.rsplit('.').next().unwrap_or(key));
            diagnostics.put(&name(wrong), Diagnostic::error(title), format!("expected `{short}` in its place"));
            return None;
        }
        if own == Some(0.0) {
            let diagnostic = Diagnostic::error(format!("`{}` is zero: this load does nothing", name(expected)));
            diagnostics.put(&name(expected), diagnostic, "expected another number");
            return None;
        }
        own
    };
    if let Some(sine) = &raw.sine {
        let amplitude = size("sine.amplitude", sine.amplitude_n, sine.amplitude_m_s2)?;
        return Some(Course::Sine { amplitude, frequency_hz: sine.frequency_hz, phase_deg: sine.phase_deg });
    }
    if let Some(chirp) = &raw.chirp {
        let amplitude = size("chirp.amplitude", chirp.amplitude_n, chirp.amplitude_m_s2)?;
        let length = chirp.length_s.unwrap_or(duration - raw.start_s);
        let (from_hz, to_hz, back) = (chirp.from_hz, chirp.to_hz, chirp.back);
        return Some(Course::Chirp { amplitude, from_hz, to_hz, back, length });
    }
    if let Some(noise) = &raw.noise {
        let rms = size("noise.rms", noise.rms_n, noise.rms_m_s2)?;
        if noise.band_hz[0] >= noise.band_hz[1] {
            let diagnostic = Diagnostic::error(format!("`{}` is an empty band", path("noise.band_hz")));
            let expected = "expected the lowest and the highest frequency, as band_hz = [10.0, 200.0]";
            diagnostics.put(&path("noise.band_hz"), diagnostic, expected);
            return None;
        }
        return Some(Course::Noise { rms, band_hz: noise.band_hz, seed: noise.seed });
    }
    if let Some(pulse) = &raw.half_sine {
        let peak = size("half_sine.peak", pulse.peak_n, pulse.peak_m_s2)?;
        return Some(Course::HalfSine { peak, width: pulse.width_s });
    }
    if let Some(impact) = &raw.impact {
        if is_base {
            let diagnostic = Diagnostic::error(format!("`{}` is for a force", path("impact")));
            diagnostics.put(&path("impact"), diagnostic, "expected `half_sine` with `peak_m_s2` for a shaken base");
            return None;
        }
        let impulse = size("impact.impulse", Some(impact.impulse_ns), None)?;
        return Some(Course::Impact { impulse });
    }
    raw.table.as_ref().map(|file| Course::Table(base.join(file)))
}
