//! Virtual tests, and data of modes.

use super::{meant, stop, structure};
use crate::check::frequencies::estimate;
use crate::rule::{number, significant};
use crate::scene::TestScene;
use crate::{Diagnostic, Diagnostics};

/// With this much damping a structure has no modes worth the name.
const DAMPED: f64 = 0.1;
/// Amplitudes of the voltage of a shaker's amplifier are below this, V.
const HIGH_VOLTAGE: f64 = 200.0;

pub fn warn(scene: &TestScene, diagnostics: &mut Diagnostics<'_>) {
    structure(&scene.structure, diagnostics);
    damping("virtual_test.damping_ratios", &scene.damping_ratios, diagnostics);
    if let Some(own) = &scene.stop {
        stop::gap("virtual_test.stop.gap_m", own.gap, &scene.structure, diagnostics);
        stop::pressed("virtual_test.stop.gap_m", own.gap, diagnostics);
    }
    frequencies(scene, diagnostics);
    sampling(scene, diagnostics);
    lag(scene.control.lag_deg, diagnostics);
    levels(scene, diagnostics);
}

/// Damping ratios that look like per cent, where they are not written in per cent; `path` is that of the list, or of a
/// single value.
pub fn damping(path: &str, ratios: &[f64], diagnostics: &mut Diagnostics<'_>) {
    if diagnostics.as_written(path) != path {
        return;
    }
    let Some((i, ratio)) = ratios.iter().enumerate().find(|(_, ratio)| **ratio >= DAMPED) else { return };
    let diagnostic = Diagnostic::warning(format!("`{path}` has {} % of critical damping", number(100.0 * ratio)));
    let diagnostic = diagnostic.help(meant(*ratio, "%", 1e-2)).help("a damping ratio is a fraction: 0.01 means 1 %");
    diagnostics.put(&format!("{path}.{i}"), diagnostic, format!("a damping ratio of {}", number(*ratio)));
}

/// Measured frequencies that the structure cannot have.
fn frequencies(scene: &TestScene, diagnostics: &mut Diagnostics<'_>) {
    let (Some(given), Some(own)) = (&scene.frequencies_hz, estimate(&scene.structure, 1)) else { return };
    let Some(first) = given.first().filter(|_| own > 0.0) else { return };
    if (0.2..=5.0).contains(&(first / own)) {
        return;
    }
    let path = "virtual_test.frequencies_hz.0";
    let diagnostic =
        Diagnostic::warning("the first of `virtual_test.frequencies_hz` is far from that of the structure");
    let own = significant(own, 2);
    let label = format!("{} Hz; the structure has some {own} Hz", number(*first));
    let help = "frequencies are in Hz, not in rad/s or kHz; are material and lengths of the structure in SI units?";
    diagnostics.put(path, diagnostic.help(help), label);
}

fn sampling(scene: &TestScene, diagnostics: &mut Diagnostics<'_>) {
    let path = "virtual_test.sample_rate_hz";
    let first = scene.frequencies_hz.as_ref().and_then(|given| given.first().copied());
    let Some(first) = first.or_else(|| estimate(&scene.structure, 1)).filter(|hz| *hz > 0.0) else { return };
    if scene.sample_rate < 20.0 * first {
        let diagnostic = Diagnostic::warning(format!("`{path}` gives few samples a period")).help(meant(
            scene.sample_rate,
            "kHz",
            1e3,
        ));
        let samples = significant(scene.sample_rate / first, 2);
        diagnostics.put(path, diagnostic, format!("{samples} samples a period of {} Hz", number(first)));
    }
}

fn lag(degrees: f64, diagnostics: &mut Diagnostics<'_>) {
    let path = "virtual_test.loop.lag_deg";
    if degrees < 10.0 {
        let diagnostic = Diagnostic::warning(format!("`{path}` is far from phase resonance, which is at 90 degrees"))
            .help(format!(
                "if {} rad is meant, write {}",
                number(degrees),
                number((10.0 * degrees.to_degrees()).round() / 10.0)
            ));
        diagnostics.put(path, diagnostic, format!("{} degrees", number(degrees)));
    }
}

fn levels(scene: &TestScene, diagnostics: &mut Diagnostics<'_>) {
    let path = "virtual_test.schedule.levels_v";
    let mut levels = scene.schedule.levels().enumerate();
    let Some((i, level)) = levels.find(|(_, level)| *level > HIGH_VOLTAGE).filter(|_| diagnostics.has(path)) else {
        return;
    };
    let diagnostic = Diagnostic::warning(format!("`{path}` has a level of {} V", number(level)));
    diagnostics.put(&format!("{path}.{i}"), diagnostic.help(meant(level, "mV", 1e-3)), "more than a shaker takes");
}
