//! Other responses, measured or computed, laid over those of a scene, with the differences in numbers.

mod read;

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::modal::ModalPoint;
use nlmodes::report::columns::{ResponseDifferenceRow, Row};
use nlmodes::report::{LineKind, ReportError, write_rows};
use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::ResponseKind;

use super::curves::ComputedResponse;
use super::figures;
use crate::overlay::{by, percent};
use crate::{Event, Observer, RunError, refusal};

/// Relative difference that the digits of a table make of a frequency: the ends of a curve stay within it.
const TABLE_DIGITS: f64 = 1e-14;
/// Relative difference up to which two levels are one.
const SAME_LEVEL: f64 = 1e-6;

/// A curve, or measured points, that are laid over.
#[derive(Debug, Clone, PartialEq)]
pub struct LaidCurve {
    /// Its name in the legends.
    pub name: String,
    /// Points that nothing joins, or a curve of a computation.
    pub kind: LineKind,
    /// Its points.
    pub points: Vec<LaidPoint>,
}

/// What a table says of a point, NaN where it says nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaidPoint {
    /// Its row among those with a frequency.
    pub number: usize,
    /// Frequency of the load, Hz.
    pub frequency: f64,
    /// Level, in the unit of the load.
    pub level: f64,
    /// Fundamental of the first contact, m.
    pub fundamental: f64,
    /// Fundamental of the drive point, m.
    pub drive: f64,
    /// Lag of the drive point, degrees.
    pub lag: f64,
    /// Largest contact force, N.
    pub force: f64,
}

/// A point beside the curve of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beside {
    laid: LaidPoint,
    own: LaidPoint,
}

/// What is laid over the responses of a scene; of how many rows nothing is used, goes to the observer.
///
/// # Errors
/// [`RunError`] at the overlay that cannot be read.
pub fn read(file: &SceneFile, observer: &mut dyn Observer) -> Result<Vec<LaidCurve>, RunError> {
    let mut all = Vec::new();
    for (k, overlay) in file.scene.overlays.iter().enumerate() {
        let (found, unused) =
            read::curves(overlay).map_err(|error| refusal::at(file, &format!("overlay.{k}.path"), &error))?;
        unused.sentence(&overlay.path).iter().for_each(|text| observer.event(Event::Warning(text)));
        all.extend(found);
    }
    Ok(all)
}

/// Each point that lies within the curves over the frequency of this scene, beside the one that is nearest there.
pub fn beside(laid: &LaidCurve, curves: &[ComputedResponse]) -> Vec<Beside> {
    // Modes and phase resonances belong to no level.
    if !matches!(laid.kind, LineKind::Response | LineKind::Measured) {
        return Vec::new();
    }
    let forced: Vec<Vec<LaidPoint>> = curves
        .iter()
        .filter(|computed| computed.kind == ResponseKind::Frequency)
        .map(|computed| {
            let point = |(number, p): (usize, &ModalPoint)| LaidPoint {
                number,
                frequency: p.listed_omega() / TAU,
                level: figures::level(p),
                fundamental: p.fundamental.abs(),
                drive: figures::drive(p),
                lag: figures::lag(p),
                force: p.peak_contact_force,
            };
            computed.branch.points.iter().enumerate().map(point).collect()
        })
        .collect();
    laid.points.iter().filter_map(|point| nearest(point, &forced).map(|own| Beside { laid: *point, own })).collect()
}

/// The point at the same frequency whose amplitude is nearest, of the curves of its level where it has one.
fn nearest(point: &LaidPoint, curves: &[Vec<LaidPoint>]) -> Option<LaidPoint> {
    let amplitude = |p: &LaidPoint| if point.fundamental.is_finite() { p.fundamental } else { p.drive };
    let is_of_level = |curve: &&Vec<LaidPoint>| {
        let level = curve.first().map_or(f64::NAN, |first| first.level);
        point.level.is_nan() || (level - point.level).abs() <= SAME_LEVEL * point.level.abs()
    };
    let pairs = curves.iter().filter(is_of_level).flat_map(|curve| curve.windows(2));
    let crossings = pairs.filter_map(|pair| {
        let (a, b) = (pair[0], pair[1]);
        let digits = TABLE_DIGITS * point.frequency;
        let within =
            (a.frequency.min(b.frequency) - digits..=a.frequency.max(b.frequency) + digits).contains(&point.frequency);
        let share = if a.frequency == b.frequency {
            0.0
        } else {
            (point.frequency - a.frequency) / (b.frequency - a.frequency)
        };
        let at = |value: fn(&LaidPoint) -> f64| value(&a) + share * (value(&b) - value(&a));
        within.then(|| LaidPoint {
            frequency: point.frequency,
            fundamental: at(|p| p.fundamental),
            drive: at(|p| p.drive),
            lag: at(|p| p.lag),
            force: at(|p| p.force),
            ..a
        })
    });
    let off = |p: &LaidPoint| (amplitude(p) - amplitude(point)).abs();
    crossings.filter(|p| off(p).is_finite()).min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// What is to be said of points that have no counterpart; nothing where all have one, or where none can have one.
pub fn left_out(laid: &LaidCurve, found: &[Beside]) -> Option<String> {
    let (all, left) = (laid.points.len(), laid.points.len() - found.len());
    if left == 0 || !matches!(laid.kind, LineKind::Response | LineKind::Measured) {
        return None;
    }
    Some(format!(
        "overlay {}: {left} of its {all} points have no response of this scene at their frequency and level, or no amplitude; they are drawn and not compared",
        laid.name
    ))
}

/// Whether what is laid over moves more or less, in a sentence.
pub fn sentence(laid: &LaidCurve, found: &[Beside]) -> String {
    let name = &laid.name;
    let part = |what: &str, value: fn(&LaidPoint) -> f64| {
        let (range, points) = percent(found.iter().map(|beside| (value(&beside.laid), value(&beside.own))))?;
        Some(format!("{what} differs {}", by(range, points)))
    };
    let parts = [
        part("its fundamental at the first contact", |p| p.fundamental),
        part("its fundamental at the drive point", |p| p.drive),
        part("its largest contact force", |p| p.force),
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
pub fn write(directory: &Path, all: &[(LaidCurve, Vec<Beside>)]) -> Result<(), ReportError> {
    if all.is_empty() {
        return Ok(());
    }
    let row = |name: &str, Beside { laid, own }: &Beside| ResponseDifferenceRow {
        overlay: name.to_owned(),
        point: laid.number,
        frequency_hz: laid.frequency,
        level: laid.level,
        fundamental_m: laid.fundamental,
        curve_fundamental_m: own.fundamental,
        drive_fundamental_m: laid.drive,
        curve_drive_fundamental_m: own.drive,
        peak_contact_force_n: laid.force,
        curve_peak_contact_force_n: own.force,
    };
    let rows = all.iter().flat_map(|(laid, found)| found.iter().map(move |beside| row(&laid.name, beside)));
    write_rows(directory.join("response_overlay.csv"), &ResponseDifferenceRow::unknown(), rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_branch_of_the_same_level_counts() {
        for unit in [1.0, 1e-6] {
            let point = |frequency, level, amplitude: f64| LaidPoint {
                number: 0,
                frequency,
                level,
                fundamental: amplitude * unit,
                drive: f64::NAN,
                lag: f64::NAN,
                force: 0.0,
            };
            // A curve that bends over: 1 to 3 on the way up, back at 5; another level far above.
            let bent = vec![point(10.0, 4.0, 1.0), point(12.0, 4.0, 3.0), point(10.0, 4.0, 5.0)];
            let other = vec![point(10.0, 6.0, 1.6), point(12.0, 6.0, 1.6)];
            let all = [bent, other];
            let near = |level, amplitude| nearest(&point(11.0, level, amplitude), &all).map(|p| p.fundamental / unit);
            assert!((near(4.0, 1.5).unwrap() - 2.0).abs() < 1e-12);
            assert!((near(4.0, 3.9).unwrap() - 4.0).abs() < 1e-12);
            assert!((near(f64::NAN, 1.5).unwrap() - 1.6).abs() < 1e-12);
            assert_eq!((near(5.0, 1.5), nearest(&point(13.0, 4.0, 1.0), &all)), (None, None));
        }
    }
}
