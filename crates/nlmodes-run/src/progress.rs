//! How far a branch is, in numbers and in words.

use std::f64::consts::TAU;
use std::time::Instant;

use nlmodes::modal::{Event, ModalPoint};
use nlmodes_scene::scene::{Scene, Start};
use nlmodes_scene::{counted, number};

/// How far the branches of a scene are, as an observer hears of their points.
#[derive(Debug, Clone)]
pub struct Progress {
    began: Instant,
    points: usize,
    repeated: usize,
    /// Frequency, Hz, and energy of the last point.
    last: Option<[f64; 2]>,
    event: String,
    limits: Limits,
}

impl Progress {
    /// The branches of this scene begin.
    pub fn new(scene: &Scene) -> Self {
        let (began, limits) = (Instant::now(), Limits::new(scene));
        Self { began, points: 0, repeated: 0, last: None, event: String::new(), limits }
    }

    /// Another point was found, or is repeated from an earlier run.
    pub fn point(&mut self, point: &ModalPoint, is_new: bool) {
        self.points += 1;
        self.repeated += usize::from(!is_new);
        if let Some(event) = point.events.last() {
            self.event = format!(", last event: {event}");
        }
        let here = [point.omega / TAU, point.kinetic_energy];
        self.last = Some(here);
        if self.limits.first.is_none() && point.has_event(Event::LiftOff) {
            self.limits.reference = Event::LiftOff;
        }
        self.limits.first.get_or_insert(here);
    }

    /// So many points are there: some were withdrawn, or the branch goes the other way from its start, which is found
    /// once more.
    pub fn set_points(&mut self, points: usize) {
        self.points = points;
    }

    /// Points that were taken over from an earlier run.
    pub fn repeated(&self) -> usize {
        self.repeated
    }

    /// When the branches began.
    pub fn began(&self) -> Instant {
        self.began
    }

    /// Share of the way to the limit that is nearest; nothing before the first point.
    pub fn share(&self) -> Option<f64> {
        self.limits.way(self.last?, self.points).map(|(share, _)| share)
    }

    /// The last point, the way to the nearest limit and the time, in a line.
    pub fn line(&self) -> String {
        let time = self.began.elapsed().as_secs_f64();
        let Some([frequency, energy]) = self.last else { return format!("no points, {time:.0} s") };
        let way = self.limits.way([frequency, energy], self.points);
        let way = way.map_or_else(String::new, |(share, to)| format!(", {:.0} % of the way to {to}", 100.0 * share));
        let (points, event) = (self.points, &self.event);
        format!("{}, {frequency:.4} Hz, {energy:.4e} J{way}{event}, {time:.0} s", counted(points, "point"))
    }

    /// The last point, of this branch, with all that its row of the table begins with.
    pub fn in_full(&self, branch: usize, point: &ModalPoint) -> String {
        let branch = if branch == 0 { String::new() } else { format!("branch {branch}, ") };
        let (number, frequency) = (self.points.saturating_sub(1), point.omega / TAU);
        let events = if point.events.is_empty() { String::new() } else { format!(", {}", Event::names(&point.events)) };
        let (energy, residual) = (point.kinetic_energy, point.residual);
        format!("{branch}point {number}: {frequency:.6} Hz, {energy:.6e} J, residual {residual:.1e}{events}")
    }
}

/// A check of the certificate at one of its points.
#[derive(Debug, Clone)]
pub struct CheckProgress {
    check: &'static str,
    point: usize,
    /// Of so many, from 1.
    number: usize,
    of: usize,
    /// When the first of them was looked at.
    began: Instant,
}

impl CheckProgress {
    /// The check looks at a point, its number among so many; `before` is what was looked at before that.
    pub fn new(check: &'static str, point: usize, [number, of]: [usize; 2], before: Option<&Self>) -> Self {
        let began = before.filter(|known| known.check == check).map_or_else(Instant::now, |known| known.began);
        Self { check, point, number, of, began }
    }

    /// What is done, since `time` seconds, and how long it may take by the points before.
    pub fn line(&self, time: f64) -> String {
        let Self { check, point, number, of, began } = self;
        let done = number - 1;
        let each = began.elapsed().as_secs_f64() / done.max(1) as f64;
        let left = match done {
            0 => String::new(),
            _ => format!(", this check some {:.0} s more", (each * (of - done) as f64).max(1.0)),
        };
        format!("certificate: {check}, point {point} ({number} of {of}), {time:.0} s{left}")
    }
}

/// Where a branch ends at the latest.
#[derive(Debug, Clone)]
struct Limits {
    energy_ratio: Option<f64>,
    window: Option<[f64; 2]>,
    points: usize,
    start: Start,
    /// Frequency, Hz, and energy of the first point.
    first: Option<[f64; 2]>,
    /// What the energy counts from: grazing, or the lift-off of a stop that presses.
    reference: Event,
}

impl Limits {
    fn new(scene: &Scene) -> Self {
        let continuation = &scene.continuation;
        Self {
            energy_ratio: Some(scene.max_energy_ratio(continuation.frequency_hz.is_some())),
            window: continuation.frequency_hz,
            points: continuation.max_points,
            start: continuation.start(),
            first: None,
            reference: Event::Grazing,
        }
    }

    /// Share of the way to the limit that is nearest, and that limit. A branch that turns back goes some of it again.
    fn way(&self, [here_hz, here_energy]: [f64; 2], points: usize) -> Option<(f64, String)> {
        let [hz, energy] = self.first?;
        let grazing = match self.start {
            Start::Grazing => Some(energy),
            Start::Energy { ratio, .. } => Some(energy / ratio),
            Start::Frequency { .. } => None,
        };
        let of_energy = self.energy_ratio.zip(grazing).map(|(ratio, grazing)| {
            let share = (here_energy / energy).ln() / (ratio * grazing / energy).ln();
            (share, format!("{} {} energies", number(ratio), self.reference))
        });
        let of_frequency = self.window.into_iter().flatten().map(|end| {
            let share = (here_hz - hz) / (end - hz);
            (share, format!("{} Hz", number(end)))
        });
        let of_points = (points as f64 / self.points as f64, format!("{} points", self.points));
        // The later one counts where two are equal.
        let all = std::iter::once(of_points).chain(of_frequency).chain(of_energy);
        let all = all.filter(|(share, _)| share.is_finite());
        let (share, limit) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((share.clamp(0.0, 1.0) + 0.0, limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_check_says_how_long_it_may_take_by_the_points_before() {
        let line = |number, seconds, time| {
            let began = Instant::now().checked_sub(Duration::from_secs(seconds)).unwrap();
            CheckProgress { check: "harmonics", point: 7, number, of: 5, began }.line(time)
        };
        assert_eq!(line(1, 3, 9.0), "certificate: harmonics, point 7 (1 of 5), 9 s");
        // Two points took 10 s, three are left.
        assert_eq!(line(3, 10, 19.0), "certificate: harmonics, point 7 (3 of 5), 19 s, this check some 15 s more");
    }

    /// A branch that begins where a stop that presses is left counts in energies of that.
    #[test]
    fn the_way_counts_in_energies_of_what_begins_the_branch() {
        for (event, word) in [(Event::Grazing, "grazing"), (Event::LiftOff, "lift-off")] {
            let limits = Limits {
                energy_ratio: Some(100.0),
                window: None,
                points: 1000,
                start: Start::Grazing,
                first: None,
                reference: Event::Grazing,
            };
            let mut progress =
                Progress { began: Instant::now(), points: 0, repeated: 0, last: None, event: String::new(), limits };
            for energy in [1.0, 10.0] {
                let events = if energy == 1.0 { vec![event] } else { Vec::new() };
                progress
                    .point(&ModalPoint { omega: TAU, kinetic_energy: energy, events, ..ModalPoint::default() }, true);
            }
            let line = progress.line();
            assert!(line.contains(&format!("50 % of the way to 100 {word} energies")), "{line}");
        }
    }
}
