//! Other responses, measured or computed, laid over those of a scene, with the differences in numbers.

use std::path::Path;

use nlmodes::modal::ModalPoint;
use nlmodes::report::columns::{ResponseDifferenceRow, Row};
use nlmodes::report::{LineKind, ReportError, write_rows};
use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::ResponseKind;

use super::curves::ComputedResponse;
use super::figures;
use crate::overlay::{self, LaidCurve, by, percent};
use crate::{Observer, RunError};

/// Relative difference that the digits of a table make of a frequency: the ends of a curve stay within it.
const TABLE_DIGITS: f64 = 1e-14;
/// Relative difference up to which two levels are one; of a test, whose force is held to some per cent.
const SAME_LEVEL: f64 = 1e-6;
const SAME_FORCE: f64 = 0.05;

/// Fundamental of the first contact, that of the drive point, m, and largest contact force, N; NaN where it is unknown.
type Sizes = [f64; 3];

fn sizes(point: &ModalPoint) -> Sizes {
    [point.fundamental.abs(), figures::drive(point), point.peak_contact_force]
}

/// What is laid over the responses of a scene; of how many rows nothing is used, goes to the observer.
///
/// # Errors
/// [`RunError`] at the overlay that cannot be read.
pub fn read(file: &SceneFile, observer: &mut dyn Observer) -> Result<Vec<LaidCurve>, RunError> {
    Ok(overlay::read_all(file, &file.scene.overlays, observer, overlay::curves)?.concat())
}

/// Each point that lies within the curves over the frequency of this scene, beside the one that is nearest there; of a
/// test within its phase resonances, if the scene has these.
pub fn beside(laid: &LaidCurve, curves: &[ComputedResponse]) -> Vec<ResponseDifferenceRow> {
    // Modes and phase resonances belong to no level.
    if !matches!(laid.kind, LineKind::Response | LineKind::Measured) {
        return Vec::new();
    }
    let of_kind = |kind: ResponseKind| -> Vec<&[ModalPoint]> {
        let own = curves.iter().filter(|computed| computed.kind == kind);
        own.map(|computed| computed.branch.points.as_slice()).collect()
    };
    let resonances = if laid.is_test { of_kind(ResponseKind::PhaseResonance) } else { Vec::new() };
    // Along these the level changes from point to point.
    let (own, same) = match (resonances.is_empty(), laid.is_test) {
        (false, _) => (resonances, f64::INFINITY),
        (true, is_test) => (of_kind(ResponseKind::Frequency), if is_test { SAME_FORCE } else { SAME_LEVEL }),
    };
    let beside = |(k, point): (usize, &ModalPoint)| {
        let ([fundamental, drive, force], [own_fundamental, own_drive, own_force]) =
            (sizes(point), nearest(point, (&own, same))?);
        Some(ResponseDifferenceRow {
            overlay: laid.branch.label.clone(),
            point: laid.first + k,
            frequency_hz: figures::hertz(point),
            level: figures::level(point),
            fundamental_m: fundamental,
            curve_fundamental_m: own_fundamental,
            drive_fundamental_m: drive,
            curve_drive_fundamental_m: own_drive,
            peak_contact_force_n: force,
            curve_peak_contact_force_n: own_force,
        })
    };
    laid.branch.points.iter().enumerate().filter_map(beside).collect()
}

/// The motion at the same frequency whose amplitude is nearest, of the curves of its level where it has one, up to a
/// relative difference.
fn nearest(point: &ModalPoint, (curves, same): (&[&[ModalPoint]], f64)) -> Option<Sizes> {
    let (wanted, level, frequency) = (sizes(point), figures::level(point), figures::hertz(point));
    let amplitude = usize::from(!wanted[0].is_finite());
    let is_of_level = |curve: &&&[ModalPoint]| {
        let own = curve.first().map_or(f64::NAN, figures::level);
        level.is_nan() || same.is_infinite() || (own - level).abs() <= same * level.abs()
    };
    let pairs = curves.iter().filter(is_of_level).flat_map(|curve| curve.windows(2));
    let crossings = pairs.filter_map(|pair| {
        let [a, b] = [figures::hertz(&pair[0]), figures::hertz(&pair[1])];
        let digits = TABLE_DIGITS * frequency;
        let within = (a.min(b) - digits..=a.max(b) + digits).contains(&frequency);
        let share = if a == b { 0.0 } else { (frequency - a) / (b - a) };
        let ends = [sizes(&pair[0]), sizes(&pair[1])];
        within.then(|| [0, 1, 2].map(|k| ends[0][k] + share * (ends[1][k] - ends[0][k])))
    });
    let off = |found: &Sizes| (found[amplitude] - wanted[amplitude]).abs();
    crossings.filter(|found| off(found).is_finite()).min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// What is to be reported of points that have no counterpart; nothing where all have one, or where none can have one.
pub fn left_out(laid: &LaidCurve, found: &[ResponseDifferenceRow]) -> Option<String> {
    let (all, left) = (laid.branch.points.len(), laid.branch.points.len() - found.len());
    if left == 0 || !matches!(laid.kind, LineKind::Response | LineKind::Measured) {
        return None;
    }
    Some(format!(
        "overlay {}: {left} of its {all} points have no response of this scene at their frequency and level, or no \
            amplitude; they are drawn and not compared",
        laid.branch.label
    ))
}

/// Whether what is laid over moves more or less, in a sentence.
pub fn sentence(laid: &LaidCurve, found: &[ResponseDifferenceRow]) -> String {
    let name = &laid.branch.label;
    let part = |what: &str, of: fn(&ResponseDifferenceRow) -> (f64, f64)| {
        let (range, points) = percent(found.iter().map(of))?;
        Some(format!("{what} differs {}", by(range, points)))
    };
    let parts = [
        part("its fundamental at the first contact", |row| (row.fundamental_m, row.curve_fundamental_m)),
        part("its fundamental at the drive point", |row| (row.drive_fundamental_m, row.curve_drive_fundamental_m)),
        part("its largest contact force", |row| (row.peak_contact_force_n, row.curve_peak_contact_force_n)),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() {
        return format!("{name}: no point within the curves over the frequency");
    }
    format!("{name}: at equal frequency {}", parts.join("; "))
}

/// Writes `response_overlay.csv`.
///
/// # Errors
/// [`ReportError::Io`].
pub fn write(directory: &Path, all: &[(LaidCurve, Vec<ResponseDifferenceRow>)]) -> Result<(), ReportError> {
    if all.is_empty() {
        return Ok(());
    }
    let rows = all.iter().flat_map(|(_, found)| found).cloned();
    write_rows(directory.join("response_overlay.csv"), &ResponseDifferenceRow::unknown(), rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes::modal::Driven;
    use std::f64::consts::TAU;

    #[test]
    fn the_nearest_branch_of_the_same_level_counts() {
        for unit in [1.0, 1e-6] {
            let point = |frequency: f64, level: f64, amplitude: f64| {
                let driven = Driven {
                    omega: TAU * frequency,
                    level: Some(level),
                    force: None,
                    drive: None,
                    input_power: None,
                    dissipated_power: 0.0,
                    damping_ratio: None,
                    indicator: None,
                    mode_distance: None,
                };
                ModalPoint { fundamental: amplitude * unit, driven: Some(driven), ..ModalPoint::default() }
            };
            // A curve that bends over: 1 to 3 on the way up, back at 5; another level far above.
            let bent = vec![point(10.0, 4.0, 1.0), point(12.0, 4.0, 3.0), point(10.0, 4.0, 5.0)];
            let other = vec![point(10.0, 6.0, 1.6), point(12.0, 6.0, 1.6)];
            let all = [bent.as_slice(), other.as_slice()];
            // The force of a test is held to some per cent, and along phase resonances it changes.
            let of_test = |level, same| nearest(&point(11.0, level, 1.5), (&all, same)).map(|found| found[0] / unit);
            assert!((of_test(4.1, SAME_FORCE).unwrap() - 2.0).abs() < 1e-12);
            assert!(of_test(5.0, SAME_FORCE).is_none());
            assert!((of_test(5.0, f64::INFINITY).unwrap() - 1.6).abs() < 1e-12);
            let near = |level, amplitude| {
                nearest(&point(11.0, level, amplitude), (&all, SAME_LEVEL)).map(|found| found[0] / unit)
            };
            assert!((near(4.0, 1.5).unwrap() - 2.0).abs() < 1e-12);
            assert!((near(4.0, 3.9).unwrap() - 4.0).abs() < 1e-12);
            assert!((near(f64::NAN, 1.5).unwrap() - 1.6).abs() < 1e-12);
            assert_eq!((near(5.0, 1.5), nearest(&point(13.0, 4.0, 1.0), (&all, SAME_LEVEL))), (None, None));
        }
    }
}
