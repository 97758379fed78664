//! What a sweep over the frequency meets at each level: stable segments, jumps, losses of stability, the peak.

use nlmodes::modal::{Event, ModalPoint};
use nlmodes::report::{DataTable, hertz};
use nlmodes_scene::scene::ResponseKind;
use nlmodes_scene::{short, significant};
use serde::Serialize;

use super::curves::ComputedResponse;
use super::sweeps::Sweep;
use super::unstable::Unstable;
use crate::certificate::share;

/// The responses at one level, over all curves over the frequency that have it.
#[derive(Debug, Serialize)]
pub struct Level {
    /// Number of the response in the scene, from 1.
    response: usize,
    /// The level, in the unit of the load.
    level: f64,
    /// Share of the points of which stability is known.
    stability_known: f64,
    /// Lowest and highest frequency of each stable segment, Hz, in the order of the curves.
    stable: Vec<[f64; 2]>,
    /// Where a sweep leaves a stable segment at a fold, in the order of the frequencies.
    jumps: Vec<Jump>,
    /// Where a sweep leaves a stable segment without a fold, in the order of the frequencies.
    losses: Vec<Loss>,
    /// Folds with points on both sides of which no stability is known, Hz: a sweep may jump there.
    folds_hz: Vec<f64>,
    /// The largest amplitude; where there is none, the largest contact force.
    peak: Option<Peak>,
    /// The largest contact force; none where nothing touches.
    largest_force: Option<LargestForce>,
    /// Whether there is a stop to be touched.
    #[serde(skip)]
    has_stops: bool,
    /// What unstable motions become, in the order of the curves: of `run --certify`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) unstable: Vec<Unstable>,
}

/// A jump from a fold to another stable motion.
#[derive(Debug, Serialize)]
struct Jump {
    frequency_hz: f64,
    /// Change of the frequency of the fold with twice as many harmonics, relative; none where that was not computed.
    frequency_error: Option<f64>,
    /// Direction of the sweep.
    direction: Direction,
    amplitude_m: Amplitudes,
    /// Where a sweep in time passes halfway to the other motion, Hz.
    #[serde(skip_serializing_if = "Option::is_none")]
    swept_frequency_hz: Option<f64>,
}

/// Where the periodic motion of a segment loses its stability without a fold.
#[derive(Debug, Serialize)]
struct Loss {
    /// That of the event, or of the last stable point.
    frequency_hz: f64,
    /// That of the first unstable point; none where the event is located.
    #[serde(skip_serializing_if = "Option::is_none")]
    before_hz: Option<f64>,
    /// Direction of the sweep.
    direction: Direction,
    /// What happens there, by the name of the event; none where nothing else was found.
    event: Option<&'static str>,
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
    /// How many other stable motions were found at this frequency.
    #[serde(skip)]
    others: usize,
}

/// The point with the largest amplitude.
#[derive(Debug, Serialize)]
struct Peak {
    frequency_hz: f64,
    amplitude_m: f64,
    /// Change of the amplitude with twice as many harmonics, relative; none where that was not computed.
    amplitude_error: Option<f64>,
    peak_contact_force_n: f64,
    stable: Option<bool>,
}

/// The point with the largest contact force.
#[derive(Debug, Serialize)]
struct LargestForce {
    frequency_hz: f64,
    force_n: f64,
    /// Change of the force with twice as many harmonics, relative; none where that was not computed.
    force_error: Option<f64>,
    stable: Option<bool>,
}

/// Stable points of a curve one after the other, with the fold or the loss of stability at each end.
struct Segment<'a> {
    of: &'a ComputedResponse,
    /// First and last point.
    ends: [usize; 2],
    folds: [Option<usize>; 2],
    /// Beyond each end without a fold the event by which stability is lost, and the first unstable point.
    lost: [Option<Lost>; 2],
}

/// How stability is lost beyond an end of a segment.
#[derive(Clone, Copy)]
struct Lost {
    /// The located point of the event, if there is one.
    event: Option<usize>,
    /// The first unstable point.
    unstable: usize,
}

/// Points beyond a stable one within which the fold that ends its segment is looked for at least, and points of unknown
/// stability that end no segment.
const NEAR: usize = 2;

/// Share of the points with known stability below which stable segments and jumps may be missing.
const MOST: f64 = 0.95;

/// Shortest segment that counts, over its frequency.
const SHORTEST: f64 = 1e-6;

/// Levels of all curves over the frequency; none where stability was not computed.
pub fn all(curves: &[ComputedResponse], sweeps: &[Sweep]) -> Vec<Level> {
    let over_frequency = || curves.iter().filter(|computed| computed.kind == ResponseKind::Frequency);
    let mut keys: Vec<(usize, f64)> = Vec::new();
    for key in over_frequency().filter_map(|computed| Some((computed.response, computed.level?))) {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let of = |(response, level): (usize, f64)| {
        let own = over_frequency().filter(|c| (c.response, c.level) == (response, Some(level)));
        let mut found = Level::of(response + 1, level, &own.collect::<Vec<_>>());
        let own = |up: bool| sweeps.iter().find(|s| (s.response, s.level, s.up) == (response, level, up));
        for jump in &mut found.jumps {
            jump.swept_frequency_hz = own(jump.direction == Direction::Up).and_then(|sweep| jump.in_sweep(sweep));
        }
        found
    };
    keys.into_iter().map(of).collect()
}

/// The levels as a table of the page; `unit` is that of the load.
pub fn table(levels: &[Level], unit: &str) -> DataTable {
    let level = format!("level, {unit}");
    let head =
        [level.as_str(), "largest amplitude", "at, Hz", "largest contact force", "at, Hz", "stable, Hz", "a sweep"];
    let mut table = DataTable::new("Levels: peaks, stable ranges, jumps", &head);
    for level in levels {
        let none = || "–".to_owned();
        let of = |what: &dyn Fn(&Peak) -> String| level.peak.as_ref().map_or_else(none, what);
        let force = |what: &dyn Fn(&LargestForce) -> String| level.largest_force.as_ref().map_or_else(none, what);
        let sweep: Vec<String> = level.sweep();
        table.rows.push(vec![
            short(level.level),
            of(&|peak| format!("{}{}", length(peak.amplitude_m), within(peak.amplitude_error))),
            of(&|peak| short(peak.frequency_hz)),
            force(&LargestForce::text),
            force(&|largest| short(largest.frequency_hz)),
            level.stable_text(),
            if sweep.is_empty() { "–".to_owned() } else { sweep.join("; ") },
        ]);
    }
    table
}

/// `a, b and c`.
fn and(all: &[String]) -> String {
    match all.split_last() {
        None => String::new(),
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}

/// A length in the unit in which it is read: `1.2 mm`.
fn length(metres: f64) -> String {
    let (factor, unit) = match metres.abs() {
        size if size < 1e-4 => (1e6, "µm"),
        size if size < 1.0 => (1e3, "mm"),
        _ => (1.0, "m"),
    };
    format!("{} {unit}", significant(factor * metres, 4))
}

/// Smallest change that is more than rounding.
const ROUNDING: f64 = 1e-9;

/// ` ± 3 %`, or nothing where the error was not looked for or is no more than rounding; what is not a number is not
/// known.
fn within(error: Option<f64>) -> String {
    match error {
        Some(error) if error.is_nan() => " (error not known)".to_owned(),
        Some(error) if error > ROUNDING => format!(" ± {}", share(error)),
        _ => String::new(),
    }
}

impl Jump {
    /// Where a sweep, from the frequency of the jump on, is first halfway to the other motion, Hz.
    fn in_sweep(&self, sweep: &Sweep) -> Option<f64> {
        let Amplitudes { before, after, .. } = self.amplitude_m;
        let middle = 0.5 * (before + after?);
        let is_behind = |hz: f64| if sweep.up { hz >= self.frequency_hz } else { hz <= self.frequency_hz };
        let is_over = |amplitude: f64| if before > middle { amplitude < middle } else { amplitude > middle };
        // It may jump somewhat before, where noise would make it.
        let first = sweep.points.iter().position(|[hz, _]| is_behind(*hz))?;
        let onto = sweep.points[..first].iter().rposition(|[_, a]| !is_over(*a)).map_or(first, |k| k + 1);
        sweep.points[onto.min(first)..].iter().find(|[_, a]| is_over(*a)).map(|[hz, _]| *hz)
    }
}

impl LargestForce {
    /// `5.12 N ± 0.1 %`.
    fn text(&self) -> String {
        format!("{} N{}", significant(self.force_n, 4), within(self.force_error))
    }
}

impl Level {
    fn of(response: usize, level: f64, curves: &[&ComputedResponse]) -> Self {
        let mut segments: Vec<Segment<'_>> = curves.iter().flat_map(|computed| Segment::all(computed)).collect();
        // Next to a fold at which a contact grazes, one may be that no sweep stays on.
        segments.retain(|segment| {
            let [low, high] = segment.range();
            high - low > SHORTEST * high
        });
        let stable = segments.iter().map(Segment::range).collect();
        let found: Vec<Jump> = segments.iter().flat_map(|from| from.jumps(&segments)).collect();
        // A fold with stable motions on both sides, as at a kink, is passed without a jump.
        let is_passed = |jump: &Jump| found.iter().filter(|other| other.frequency_hz == jump.frequency_hz).count() > 1;
        let passed: Vec<bool> = found.iter().map(is_passed).collect();
        let kept = found.into_iter().zip(passed).filter(|(_, passed)| !passed);
        let mut jumps: Vec<Jump> = kept.map(|(jump, _)| jump).collect();
        jumps.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        let mut losses: Vec<Loss> = segments.iter().flat_map(Segment::losses).collect();
        losses.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        let force: fn(&ModalPoint) -> f64 = |point| point.peak_contact_force;
        let largest = |quantity: fn(&ModalPoint) -> f64| {
            let each = curves.iter().flat_map(|of| of.branch.points.iter().enumerate().map(move |point| (*of, point)));
            each.max_by(|(_, (_, a)), (_, (_, b))| {
                quantity(a).total_cmp(&quantity(b)).then_with(|| force(a).total_cmp(&force(b)))
            })
        };
        let is_stable = |point: &ModalPoint| point.stability.and_then(|stability| stability.stable);
        let (mut known, mut points) = (0_u32, 0_u32);
        for point in curves.iter().flat_map(|of| &of.branch.points) {
            known += u32::from(is_stable(point).is_some());
            points += 1;
        }
        let stability_known = f64::from(known) / f64::from(points.max(1));
        let mut folds_hz: Vec<f64> = curves.iter().flat_map(|of| unknown_folds(&of.branch.points)).collect();
        folds_hz.sort_by(f64::total_cmp);
        let largest_force = largest(force).filter(|(_, (_, point))| point.peak_contact_force > 0.0);
        let largest_force = largest_force.map(|(of, (k, point))| LargestForce {
            frequency_hz: frequency(point),
            force_n: point.peak_contact_force,
            force_error: change(of, k, force),
            stable: is_stable(point),
        });
        let peak = largest(size).map(|(of, (k, point))| Peak {
            frequency_hz: frequency(point),
            amplitude_m: size(point),
            amplitude_error: change(of, k, size),
            peak_contact_force_n: point.peak_contact_force,
            stable: is_stable(point),
        });
        let has_stops = curves.iter().flat_map(|of| &of.branch.points).any(|point| !point.contacts.is_empty());
        let unstable = Vec::new();
        Self {
            response,
            level,
            stability_known,
            stable,
            jumps,
            losses,
            folds_hz,
            peak,
            largest_force,
            has_stops,
            unstable,
        }
    }

    /// Whether a curve is one of this level.
    pub(super) fn is_of(&self, computed: &ComputedResponse) -> bool {
        (self.response, Some(self.level)) == (computed.response + 1, computed.level)
    }

    /// The level in some lines: its peak, the stable ranges, and what a sweep meets. `unit` is that of the load.
    pub fn text(&self, unit: &str) -> String {
        format!("{} {unit}: {}", short(self.level), self.lines().join("\n    "))
    }

    /// Peak, force, jumps and losses of stability alone, in one line.
    pub fn in_a_line(&self, unit: &str) -> String {
        let of = |stable: Option<bool>| if stable == Some(false) { ", unstable" } else { "" };
        let peak = self.moving().map(|peak| {
            let (amplitude, at) = (length(peak.amplitude_m), short(peak.frequency_hz));
            format!("up to {amplitude} at {at} Hz{}", of(peak.stable))
        });
        let force =
            |largest: &LargestForce| format!("up to {} N{}", significant(largest.force_n, 4), of(largest.stable));
        let force = self.largest_force.as_ref().map(force);
        let listed = |what: &str, all: &mut dyn Iterator<Item = (Direction, f64)>| {
            let all: Vec<String> = all.map(|(direction, hz)| format!("{direction} at {} Hz", short(hz))).collect();
            (!all.is_empty()).then(|| format!("{what} {}", all.join(", ")))
        };
        let jumps = listed("jumps", &mut self.jumps.iter().map(|jump| (jump.direction, jump.frequency_hz)));
        let losses = listed("loses stability", &mut self.losses.iter().map(|loss| (loss.direction, loss.frequency_hz)));
        let known = self.is_partly_known().then(|| format!("stability known at {}", share(self.stability_known)));
        let parts: Vec<String> = [peak, force, jumps, losses, known].into_iter().flatten().collect();
        format!("{} {unit}: {}", short(self.level), parts.join("; "))
    }

    /// Whether stability is known, but at so few points that stable segments and jumps may be missing.
    fn is_partly_known(&self) -> bool {
        !self.stable.is_empty() && self.stability_known < MOST
    }

    /// The largest amplitude; none where the first contact stays at rest.
    fn moving(&self) -> Option<&Peak> {
        self.peak.as_ref().filter(|peak| peak.amplitude_m > 0.0)
    }

    fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let place = |hz: f64, stable: Option<bool>| {
            format!("at {} Hz{}", short(hz), if stable == Some(false) { ", unstable" } else { "" })
        };
        let peak = self.moving().map_or_else(
            || "the first contact is at rest".to_owned(),
            |peak| {
                let (amplitude, error) = (length(peak.amplitude_m), within(peak.amplitude_error));
                format!("largest amplitude {amplitude}{error} {}", place(peak.frequency_hz, peak.stable))
            },
        );
        let force = match &self.largest_force {
            Some(largest) => {
                let at = place(largest.frequency_hz, largest.stable);
                format!("; largest contact force {} {at}", largest.text())
            }
            None if self.has_stops => "; no stop is touched".to_owned(),
            None => String::new(),
        };
        lines.push(peak + &force);
        if !self.stable.is_empty() {
            lines.push(format!("stable from {}", self.stable_text()));
            if self.is_partly_known() {
                let (known, key) = (share(self.stability_known), "output.stability_budget_s");
                lines.push(format!(
                    "stability is known at {known} of the points only: elsewhere no jump is seen ({key})"
                ));
            }
        }
        lines.extend(self.sweep());
        if !self.folds_hz.is_empty() {
            let folds = if self.folds_hz.len() == 1 { "fold" } else { "folds" };
            let at: Vec<String> = self.folds_hz.iter().map(|hz| short(*hz)).collect();
            lines.push(format!("{folds} at {} Hz, stability not known: a sweep may jump there", and(&at)));
        }
        lines
    }

    /// `39 to 41.2 and 43.5 to 50 Hz`.
    fn stable_text(&self) -> String {
        let each: Vec<String> = self.stable.iter().map(|[a, b]| format!("{} to {}", short(*a), short(*b))).collect();
        if each.is_empty() { "–".to_owned() } else { format!("{} Hz", and(&each)) }
    }

    /// What a sweep meets.
    fn sweep(&self) -> Vec<String> {
        let jump = |jump: &Jump| {
            let after = match jump.amplitude_m {
                Amplitudes { after: Some(after), .. } => format!(" to {}", length(after)),
                Amplitudes { others: 0, .. } => "; no other stable motion is known there".to_owned(),
                Amplitudes { others, .. } => format!("; {others} other stable motions are known there"),
            };
            let (at, error) = (short(jump.frequency_hz), within(jump.frequency_error));
            format!(
                "a sweep {} jumps at {at} Hz{error} from {}{after}",
                jump.direction,
                length(jump.amplitude_m.before)
            )
        };
        let loss = |loss: &Loss| {
            let event = loss.event.map_or_else(String::new, |event| format!(" ({event})"));
            let at = match loss.before_hz {
                None => format!("at {} Hz", short(loss.frequency_hz)),
                Some(before) => format!("between {} and {} Hz", short(loss.frequency_hz), short(before)),
            };
            format!("a sweep {} loses its stability {at}{event}", loss.direction)
        };
        let unstable = self.unstable.iter().map(Unstable::text);
        self.jumps.iter().map(jump).chain(self.losses.iter().map(loss)).chain(unstable).collect()
    }
}

impl std::fmt::Display for Direction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == Self::Up { "up" } else { "down" })
    }
}

impl<'a> Segment<'a> {
    fn all(of: &'a ComputedResponse) -> Vec<Self> {
        let points = &of.branch.points;
        let known = |k: usize| points[k].stability.and_then(|stability| stability.stable);
        let is_fold = |k: &usize| points[*k].events.contains(&Event::Fold);
        let (mut found, mut from) = (Vec::new(), 0);
        while from < points.len() {
            if known(from) != Some(true) {
                from += 1;
                continue;
            }
            // A few points of unknown stability between stable ones end nothing.
            let mut to = from;
            while let Some(next) = (to + 1..points.len().min(to + 2 + NEAR)).find(|&k| known(k).is_some())
                && known(next) == Some(true)
            {
                to = next;
            }
            let below = beyond(points, from, (0..from).rev());
            let above = beyond(points, to, to + 1..points.len());
            let folds = [&below, &above].map(|beyond| beyond.iter().copied().find(is_fold));
            let lost = [&below, &above].map(|beyond| {
                let unstable = beyond.iter().position(|k| known(*k) == Some(false))?;
                let event = beyond[..=unstable].iter().copied().find(|k| points[*k].events.iter().any(is_loss));
                Some(Lost { event, unstable: beyond[unstable] })
            });
            // The fold of a motion with few harmonics may lie a little before the loss of stability of the exact one.
            let inside = [(from..=to).take(NEAR + 1).find(is_fold), (from..=to).rev().take(NEAR + 1).find(is_fold)];
            let folds = [0, 1].map(|end| folds[end].or(inside[end].filter(|_| lost[end].is_some())));
            let lost = [0, 1].map(|end| lost[end].filter(|_| folds[end].is_none()));
            found.push(Self { of, ends: [from, to], folds, lost });
            from = to + 1;
        }
        found
    }

    fn points(&self) -> &'a [ModalPoint] {
        &self.of.branch.points[self.ends[0]..=self.ends[1]]
    }

    fn at(&self, k: usize) -> &'a ModalPoint {
        &self.of.branch.points[k]
    }

    /// Lowest and highest frequency, Hz.
    fn range(&self) -> [f64; 2] {
        let events = self.lost.into_iter().flatten().filter_map(|lost| lost.event);
        let ends = self.folds.into_iter().flatten().chain(events).map(|k| self.at(k));
        let all = self.points().iter().chain(ends).map(frequency);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], hz| [low.min(hz), high.max(hz)])
    }

    /// Direction of a sweep that comes from within to this frequency, Hz, at one of its ends, 0 or 1.
    fn direction(&self, at: f64, end: usize) -> Direction {
        let [low, high] = self.range();
        let inward: Box<dyn Iterator<Item = &ModalPoint>> = match end {
            0 => Box::new(self.points().iter()),
            _ => Box::new(self.points().iter().rev()),
        };
        // Beside a kink a fold may be only rounding apart from the points next to it.
        let apart = inward.map(frequency).find(|hz| (hz - at).abs() > SHORTEST * at);
        if at >= apart.unwrap_or(0.5 * (low + high)) { Direction::Up } else { Direction::Down }
    }

    /// The jumps from its ends.
    fn jumps(&self, all: &[Segment<'_>]) -> Vec<Jump> {
        let jump = |(end, fold): (usize, usize)| {
            let (of, at) = (self.at(fold), frequency(self.at(fold)));
            let others = all.iter().filter(|other| !std::ptr::eq(*other, self));
            let after: Vec<f64> = others.filter_map(|other| other.amplitude(at)).collect();
            let (others, after) = (after.len(), if let [only] = after[..] { Some(only) } else { None });
            Jump {
                frequency_hz: at,
                frequency_error: change(self.of, fold, frequency),
                direction: self.direction(at, end),
                amplitude_m: Amplitudes { before: size(of), after, others },
                swept_frequency_hz: None,
            }
        };
        self.folds.into_iter().enumerate().filter_map(|(end, fold)| Some((end, fold?))).map(jump).collect()
    }

    /// The losses of stability at its ends.
    fn losses(&self) -> Vec<Loss> {
        let loss = |(end, Lost { event, unstable }): (usize, Lost)| {
            let last = self.ends[end];
            let between = if end == 0 { unstable..=last } else { last..=unstable };
            let events = between.flat_map(|k| &self.at(k).events);
            let name = events.filter(|event| named(event)).max_by_key(|event| is_loss(event));
            let at = frequency(self.at(event.unwrap_or(last)));
            Loss {
                frequency_hz: at,
                before_hz: event.is_none().then(|| frequency(self.at(unstable))),
                direction: self.direction(frequency(self.at(event.unwrap_or(unstable))), end),
                event: name.map(|event| event.name()),
            }
        };
        self.lost.into_iter().enumerate().filter_map(|(end, lost)| Some((end, lost?))).map(loss).collect()
    }

    /// Amplitude at a frequency, between two of its points, Hz and m.
    fn amplitude(&self, hz: f64) -> Option<f64> {
        self.points().windows(2).find_map(|pair| {
            let [a, b] = [&pair[0], &pair[1]].map(|point| (frequency(point), size(point)));
            let is_between = (a.0 - hz) * (b.0 - hz) <= 0.0 && a.0 != b.0;
            is_between.then(|| a.1 + (hz - a.0) / (b.0 - a.0) * (b.1 - a.1))
        })
    }
}

/// The points beyond an end of a segment among which what ends it is looked for, the end itself first: some next to it,
/// and those whose largest multiplier is too close to the unit circle to decide, as beside a fold, up to the first that
/// is decided.
fn beyond(points: &[ModalPoint], end: usize, outward: impl Iterator<Item = usize>) -> Vec<usize> {
    let is_uncertain = |k: usize| points[k].stability.is_some_and(|stability| stability.stable.is_none());
    let (mut found, mut is_decided) = (vec![end], false);
    for k in outward {
        found.push(k);
        is_decided |= !is_uncertain(k);
        if found.len() > NEAR && is_decided {
            break;
        }
    }
    found
}

/// Frequencies of the folds of a curve with points on both sides of which no stability is known, Hz.
fn unknown_folds(points: &[ModalPoint]) -> impl Iterator<Item = f64> + '_ {
    let is_known = |k: usize| points[k].stability.is_some_and(|stability| stability.stable.is_some());
    let folds = (0..points.len()).filter(|k| points[*k].events.contains(&Event::Fold));
    let unknown = folds.filter(move |&k| !(k.saturating_sub(NEAR)..points.len().min(k + NEAR + 1)).any(is_known));
    unknown.map(|k| frequency(&points[k]))
}

/// Whether an event tells why stability is lost.
fn named(event: &Event) -> bool {
    is_loss(event) || matches!(event, Event::Grazing | Event::LiftOff | Event::Kink | Event::ContactChange)
}

fn is_loss(event: &Event) -> bool {
    matches!(event, Event::PeriodDoubling | Event::NeimarkSacker)
}

/// Relative change of a quantity of a point with twice as many harmonics; NaN where no motion with so many was found
/// next to it, none where none was looked for.
fn change(of: &ComputedResponse, point: usize, quantity: fn(&ModalPoint) -> f64) -> Option<f64> {
    let (_, finer) = of.finer.iter().find(|(k, _)| *k == point)?;
    let after = finer.as_ref().map_or(f64::NAN, quantity);
    Some((after / quantity(&of.branch.points[point]) - 1.0).abs())
}

pub(super) fn frequency(point: &ModalPoint) -> f64 {
    hertz(point.listed_omega())
}

pub(super) fn size(point: &ModalPoint) -> f64 {
    point.fundamental.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes::modal::{BranchEnd, ModalBranch, Stability};
    use std::f64::consts::TAU;
    use std::time::Duration;

    /// A point with this frequency (Hz), stability and event.
    fn point(hz: f64, stable: Option<bool>, event: Option<Event>) -> ModalPoint {
        let stability = stable.map(|stable| Stability::conservative(stable, [if stable { 0.5 } else { 2.0 }, 0.0]));
        let (omega, events) = (TAU * hz, event.into_iter().collect());
        ModalPoint { omega, fundamental: 5e-4, stability, events, ..ModalPoint::default() }
    }

    fn level(points: Vec<ModalPoint>, finer: Vec<(usize, Option<ModalPoint>)>) -> Level {
        let computed = ComputedResponse {
            response: 0,
            kind: ResponseKind::Frequency,
            level: Some(1.0),
            is_detached: false,
            branch: ModalBranch::of_points("1 N", points, BranchEnd::given("as given")),
            participation: Vec::new(),
            at_levels: Vec::new(),
            finer,
            motions: None,
            appropriations: Vec::new(),
            wall_time: Duration::ZERO,
        };
        Level::of(1, 1.0, &[&computed])
    }

    /// A stable segment from 17.4 Hz up is left by a sweep down, whichever side of a kink beside its fold rounding puts
    /// that.
    #[test]
    fn a_fold_beside_a_kink_is_left_in_the_direction_of_its_segment() {
        for apart in [-8e-10, 8e-10] {
            let found = level(
                vec![
                    point(17.6, Some(false), None),
                    point(17.41, Some(false), None),
                    point(17.4 + apart, None, Some(Event::Fold)),
                    point(17.4, Some(true), Some(Event::Kink)),
                    point(17.5, Some(true), None),
                    point(18.0, Some(true), None),
                    point(26.0, Some(true), None),
                ],
                Vec::new(),
            );
            let [jump] = &found.jumps[..] else { panic!("{found:?}") };
            assert_eq!((jump.direction, jump.frequency_hz), (Direction::Down, 17.4 + apart));
            assert_eq!(found.folds_hz, [] as [f64; 0]);
        }
    }

    #[test]
    fn folds_are_listed_where_nothing_is_known_of_stability_and_errors_where_no_finer_motion_was_found() {
        let points = [18.0, 20.0, 21.0, 20.5, 18.3, 18.5, 19.0].map(|hz| {
            let is_fold = [21.0, 18.3].contains(&hz);
            point(hz, None, is_fold.then_some(Event::Fold))
        });
        let found = level(points.to_vec(), Vec::new());
        assert!(found.jumps.is_empty() && found.stable.is_empty(), "{found:?}");
        let text = found.text("N");
        assert!(text.contains("folds at 18.3 and 21 Hz, stability not known: a sweep may jump there"), "{text}");
        assert!(!text.contains("error"), "{text}");
        let largest = points.len() - 1;
        let found = level(points.to_vec(), vec![(largest, None)]);
        assert!(found.text("N").contains("largest amplitude 0.5 mm (error not known) at 19 Hz"), "{found:?}");
    }
}
