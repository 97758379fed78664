//! What a sweep over the frequency meets at each level: stable stretches, jumps, the peak.

use nlmodes::modal::{Event, ModalPoint};
use nlmodes::report::hertz;
use nlmodes_scene::scene::ResponseKind;
use serde::Serialize;

use super::curves::ComputedResponse;

/// The responses at one level, over all curves over the frequency that have it.
#[derive(Debug, Serialize)]
pub struct Level {
    /// Number of the response in the scene, from 1.
    response: usize,
    /// The level, in the unit of the load.
    level: f64,
    /// Lowest and highest frequency of each stable stretch, Hz, in the order of the curves.
    stable: Vec<[f64; 2]>,
    /// Where a sweep leaves a stable stretch at a fold, in the order of the frequencies.
    jumps: Vec<Jump>,
    /// The largest amplitude.
    peak: Option<Peak>,
}

/// A jump from a fold to another stable motion.
#[derive(Debug, Serialize)]
struct Jump {
    frequency_hz: f64,
    /// Direction of the sweep.
    direction: Direction,
    amplitude_m: Amplitudes,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Direction {
    Up,
    Down,
}

/// Amplitudes of the fundamental of the first contact, or spring, m.
#[derive(Debug, Serialize)]
struct Amplitudes {
    before: f64,
    /// That of the other stable motion at this frequency; none where there are several, or none was found.
    after: Option<f64>,
}

/// The point with the largest amplitude.
#[derive(Debug, Serialize)]
struct Peak {
    frequency_hz: f64,
    amplitude_m: f64,
    peak_contact_force_n: f64,
    stable: Option<bool>,
}

/// Consecutive stable points of a curve, with a fold at an end where there is one.
struct Stretch<'a> {
    points: &'a [ModalPoint],
    folds: [Option<&'a ModalPoint>; 2],
}

/// Points behind a stable one among which the fold that ends its stretch stands.
const NEAR: usize = 2;

/// The levels of all curves over the frequency; none where stability was not computed.
pub fn all(curves: &[ComputedResponse]) -> Vec<Level> {
    let over_frequency = || curves.iter().filter(|computed| computed.kind == ResponseKind::Frequency);
    let mut keys: Vec<(usize, f64)> = Vec::new();
    for key in over_frequency().filter_map(|computed| Some((computed.response, computed.level?))) {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let of = |(response, level): (usize, f64)| {
        let own = over_frequency().filter(|c| (c.response, c.level) == (response, Some(level)));
        let points: Vec<&[ModalPoint]> = own.map(|computed| computed.branch.points.as_slice()).collect();
        Level::of(response + 1, level, &points)
    };
    keys.into_iter().map(of).collect()
}

impl Level {
    fn of(response: usize, level: f64, curves: &[&[ModalPoint]]) -> Self {
        let stretches: Vec<Stretch<'_>> = curves.iter().flat_map(|points| Stretch::all(points)).collect();
        let stable = stretches.iter().map(Stretch::range).collect();
        let found: Vec<Jump> = stretches.iter().flat_map(|from| from.jumps(&stretches)).collect();
        // A fold with stable motions on both sides, as at a kink, is passed without a jump.
        let is_passed = |jump: &Jump| found.iter().filter(|other| other.frequency_hz == jump.frequency_hz).count() > 1;
        let passed: Vec<bool> = found.iter().map(is_passed).collect();
        let kept = found.into_iter().zip(passed).filter(|(_, passed)| !passed);
        let mut jumps: Vec<Jump> = kept.map(|(jump, _)| jump).collect();
        jumps.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        let largest = curves.iter().flat_map(|points| points.iter()).max_by(|a, b| size(a).total_cmp(&size(b)));
        let peak = largest.map(|point| Peak {
            frequency_hz: frequency(point),
            amplitude_m: size(point),
            peak_contact_force_n: point.peak_contact_force,
            stable: point.stability.and_then(|stability| stability.stable),
        });
        Self { response, level, stable, jumps, peak }
    }
}

impl<'a> Stretch<'a> {
    fn all(points: &'a [ModalPoint]) -> Vec<Self> {
        let is_stable = |point: &ModalPoint| point.stability.is_some_and(|stability| stability.stable == Some(true));
        let is_fold = |point: &&ModalPoint| point.events.contains(&Event::Fold);
        let (mut found, mut from) = (Vec::new(), 0);
        while from < points.len() {
            if !is_stable(&points[from]) {
                from += 1;
                continue;
            }
            let to = points[from..].iter().position(|point| !is_stable(point)).map_or(points.len(), |k| from + k);
            let before = points[from.saturating_sub(NEAR)..=from].iter().rev().find(is_fold);
            let behind = points[to - 1..(to + NEAR).min(points.len())].iter().find(is_fold);
            found.push(Self { points: &points[from..to], folds: [before, behind] });
            from = to;
        }
        found
    }

    /// Lowest and highest frequency, Hz.
    fn range(&self) -> [f64; 2] {
        let all = self.points.iter().chain(self.folds.into_iter().flatten()).map(frequency);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], hz| [low.min(hz), high.max(hz)])
    }

    /// The jumps from its ends.
    fn jumps(&self, all: &[Stretch<'_>]) -> Vec<Jump> {
        let inner = [self.points.first(), self.points.last()];
        let ends = self.folds.into_iter().zip(inner).filter_map(|(fold, inner)| Some((fold?, inner?)));
        let jump = |(fold, inner): (&ModalPoint, &ModalPoint)| {
            let at = frequency(fold);
            let middle = 0.5 * (self.range()[0] + self.range()[1]);
            let toward = if frequency(inner) == at { middle } else { frequency(inner) };
            let others = all.iter().filter(|other| !std::ptr::eq(*other, self));
            let after: Vec<f64> = others.filter_map(|other| other.amplitude(at)).collect();
            let after = if let [only] = after[..] { Some(only) } else { None };
            let direction = if at >= toward { Direction::Up } else { Direction::Down };
            Jump { frequency_hz: at, direction, amplitude_m: Amplitudes { before: size(fold), after } }
        };
        ends.map(jump).collect()
    }

    /// Amplitude at a frequency, between two of its points, Hz and m.
    fn amplitude(&self, hz: f64) -> Option<f64> {
        self.points.windows(2).find_map(|pair| {
            let [a, b] = [&pair[0], &pair[1]].map(|point| (frequency(point), size(point)));
            let is_between = (a.0 - hz) * (b.0 - hz) <= 0.0 && a.0 != b.0;
            is_between.then(|| a.1 + (hz - a.0) / (b.0 - a.0) * (b.1 - a.1))
        })
    }
}

fn frequency(point: &ModalPoint) -> f64 {
    hertz(point.listed_omega())
}

fn size(point: &ModalPoint) -> f64 {
    point.fundamental.abs()
}
