//! The files of a motion in time.

use std::time::Duration;

use nlmodes::report::columns::{Row, TouchRow};
use nlmodes::report::{
    DataTable, LineKind, Quantity, ResponseFigure, ResponseLine, TransientHistories, hertz, write_rows, write_summary,
    write_transient,
};
use nlmodes::timestep::Touch;
use nlmodes_scene::{number, short};
use serde_json::{Value, json};

use super::Begun;
use super::histories::{Histories, envelope};
use super::spectrum::spectrum;
use crate::Failure;
use crate::curve::figures::{Named, drawn, write_all};
use crate::curve::page::{self, Content};
use crate::style::style_of;

/// Writes all of them; `times` are those of the integration and of all until then.
pub fn write(
    begun: &Begun<'_>,
    histories: &Histories,
    ended: Option<&str>,
    times: [Duration; 2],
) -> Result<(), Failure> {
    let (directory, scene) = (&begun.scene.output_directory, begun.scene);
    let made = made(begun, histories);
    write_transient(directory.join("transient.npz"), &made)?;
    write_rows(directory.join("touches.csv"), &TouchRow::unknown(), histories.touches.iter().map(row))?;
    let summary = summary(begun, histories, ended, times);
    write_summary(directory.join("summary.json"), &summary)?;
    if !(scene.files.figures || scene.files.page) {
        return Ok(());
    }
    let figures = figures(begun, &made)?;
    if scene.files.figures {
        write_all(directory, &figures, &style_of(&scene.files))?;
    }
    if !scene.files.page {
        return Ok(());
    }
    let page = Content {
        title: &scene.title,
        lines: lines(begun, histories),
        warnings: begun.model.warnings.iter().cloned().chain(ended.map(str::to_owned)).collect(),
        tables: vec![largest(begun, histories), contacts(histories)],
        figures,
        documents: vec![("Scene as read, in SI units".to_owned(), serde_json::to_value(scene)?)],
        ..Content::default()
    };
    page::write(directory, &[], page, |report| report)
}

fn made(begun: &Begun<'_>, histories: &Histories) -> TransientHistories {
    let (rate, windows) = (histories.rate, begun.transient.envelope_windows);
    let n = histories.len();
    TransientHistories {
        time: histories.times().collect(),
        places: begun.prepared.observed.iter().map(|of| of.name.clone()).collect(),
        displacement: histories.displacement.clone(),
        velocity: histories.velocity.clone(),
        force: histories.force.clone(),
        envelope: histories.displacement.iter().map(|values| envelope(values, rate, windows)).collect(),
        frequency: (0..=n / 2).map(|k| k as f64 * rate / n as f64).collect(),
        spectrum: histories.displacement.iter().map(|values| spectrum(values)).collect(),
    }
}

fn row(touch: &Touch) -> TouchRow {
    TouchRow {
        contact: touch.contact,
        instant_s: touch.instant,
        duration_s: touch.duration,
        impulse_ns: touch.impulse,
        approach_velocity_m_s: touch.approach,
    }
}

/// What is reported of a motion.
pub fn lines(begun: &Begun<'_>, histories: &Histories) -> Vec<String> {
    let (modes, rate) = (begun.prepared.structure.n_modes(), number(rounded(histories.rate)));
    let touches = match histories.touches.len() {
        0 => "no contact is touched".to_owned(),
        1 => "1 touch".to_owned(),
        n => format!("{n} touches"),
    };
    let duration = number(begun.transient.duration);
    let mut lines = vec![format!("{duration} s of motion in {modes} modes, {rate} samples a second; {touches}")];
    lines.extend(
        begun
            .prepared
            .observed
            .iter()
            .zip(&histories.extremes)
            .map(|(of, [most, least])| format!("{}: from {} to {} m", of.name, short(*least), short(*most))),
    );
    let peaks = histories.peak_force.iter().enumerate().filter(|(_, peak)| **peak > 0.0);
    lines.extend(peaks.map(|(i, peak)| format!("contact {i}: up to {} N", short(*peak))));
    lines
}

fn rounded(rate: f64) -> f64 {
    (rate * 1e3).round() / 1e3
}

fn summary(begun: &Begun<'_>, histories: &Histories, ended: Option<&str>, times: [Duration; 2]) -> Value {
    let open = begun.model.open_modes().omega_squared();
    let frequencies: Vec<f64> = open.iter().map(|w| hertz(w.max(0.0).sqrt())).collect();
    let places = begun.prepared.observed.iter().zip(&histories.extremes);
    let places: Vec<Value> =
        places.map(|(of, [most, least])| json!({ "place": of.name, "largest_m": most, "smallest_m": least })).collect();
    let contacts: Vec<Value> = (0..histories.peak_force.len()).map(|i| contact(begun, histories, i)).collect();
    json!({
        "program": "nlmodes-cli",
        "version": env!("CARGO_PKG_VERSION"),
        "scene": begun.scene,
        "open_frequencies_hz": frequencies,
        "sample_rate_hz": histories.rate,
        "samples": histories.len(),
        "places": places,
        "contacts": contacts,
        "touches": histories.touches.len(),
        "contact_changes": histories.switches,
        "complete": ended.is_none(),
        "ended": ended,
        "integration_time_s": times[0].as_secs_f64(),
        "wall_time_s": times[1].as_secs_f64(),
    })
}

fn contact(begun: &Begun<'_>, histories: &Histories, i: usize) -> Value {
    let own = || histories.touches.iter().filter(|touch| touch.contact == i);
    json!({
        "contact": i,
        "touches": own().count(),
        "contact_fraction": histories.closed[i] / begun.transient.duration,
        "impulse_ns": own().fold(0.0, |sum, touch| sum + touch.impulse),
        "peak_force_n": histories.peak_force[i],
        "approach_velocity_m_s": own().map(|touch| touch.approach).fold(0.0, f64::max),
    })
}

fn largest(begun: &Begun<'_>, histories: &Histories) -> DataTable {
    let mut table = DataTable::new("Largest displacements", &["place", "smallest, m", "largest, m"]);
    for (of, [most, least]) in begun.prepared.observed.iter().zip(&histories.extremes) {
        table.rows.push(vec![of.name.clone(), format!("{least:.6e}"), format!("{most:.6e}")]);
    }
    table
}

fn contacts(histories: &Histories) -> DataTable {
    let head = ["contact", "touches", "largest force, N", "largest impulse of a touch, N s", "fastest approach, m/s"];
    let mut table = DataTable::new("Contacts", &head);
    for (i, peak) in histories.peak_force.iter().enumerate() {
        let own = || histories.touches.iter().filter(|touch| touch.contact == i);
        let most = |of: fn(&Touch) -> f64| own().map(of).fold(0.0, f64::max);
        table.rows.push(vec![
            i.to_string(),
            own().count().to_string(),
            format!("{peak:.6e}"),
            format!("{:.6e}", most(|touch| touch.impulse)),
            format!("{:.6e}", most(|touch| touch.approach)),
        ]);
    }
    table
}

/// Most amplitudes of a spectrum that the figure shows: the strongest of neighbours.
const SHOWN: usize = 1000;

/// Lowest amplitude of the figure of spectra, over the largest.
const FAINT: f64 = 1e-6;

fn figures(begun: &Begun<'_>, made: &TransientHistories) -> Result<Vec<Named>, Failure> {
    let line = |name: &str, points: Vec<(f64, f64)>| ResponseLine {
        name: name.to_owned(),
        kind: LineKind::Response,
        points: points.into_iter().map(|(x, y)| (x, y, None)).collect(),
    };
    let side = |part: usize| {
        let of = |(name, windows): (&String, &Vec<[f64; 3]>)| {
            line(name, windows.iter().map(|window| (window[0], window[part])).collect())
        };
        made.places.iter().zip(&made.envelope).map(of).collect::<Vec<_>>()
    };
    let envelopes: Vec<ResponseLine> = side(1).into_iter().chain(side(2)).collect();
    let [time, size] = [Quantity::linear("time", "s"), Quantity::linear("displacement", "m")];
    let title = "Envelope of the motion";
    let envelope = drawn(ResponseFigure::new(&envelopes, time, size).title(title).render())?;
    let largest = made.spectrum.iter().flatten().fold(0.0_f64, |most, v| most.max(*v));
    let shown = spectrum_end(begun, made);
    let of = |(name, values): (&String, &Vec<f64>)| {
        let points = made.frequency.iter().zip(values).skip(1).take_while(|(hz, _)| **hz <= shown);
        let points: Vec<(f64, f64)> = points.map(|(hz, value)| (*hz, value.max(FAINT * largest))).collect();
        let strongest = |part: &[(f64, f64)]| part.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
        line(name, points.chunks(points.len().div_ceil(SHOWN).max(1)).filter_map(strongest).collect())
    };
    let spectra: Vec<ResponseLine> = made.places.iter().zip(&made.spectrum).map(of).collect();
    let axes = [Quantity::linear("frequency", "Hz"), Quantity::logarithmic("amplitude in m", "")];
    let [x, y] = axes;
    let spectrum = drawn(ResponseFigure::new(&spectra, x, y).title("Spectrum of the motion").render())?;
    let all = [("envelope.svg", title, envelope), ("spectrum.svg", "Spectrum of the motion", spectrum)];
    Ok(all.into_iter().filter_map(|(file, title, figure)| Some(Named::new(file, title, figure?))).collect())
}

/// Highest frequency of the figure: eight times that of the loads or the lowest mode, as sampled.
fn spectrum_end(begun: &Begun<'_>, made: &TransientHistories) -> f64 {
    let lowest = begun.model.open_modes().omega_squared().iter().find(|w| **w > 0.0).map_or(0.0, |w| hertz(w.sqrt()));
    let own = 8.0 * begun.prepared.highest_hz.max(lowest);
    made.frequency.last().copied().unwrap_or(0.0).min(own.max(f64::MIN_POSITIVE))
}
