//! Histories of a motion, and its largest values.

use nlmodes::timestep::{Stretch, Touch};

/// Histories at the same distances in time, and what is larger in between.
pub struct Histories {
    /// Samples a second, Hz.
    pub rate: f64,
    samples: usize,
    /// Displacements (m) and velocities (m/s) of what is observed, and forces of the contacts (N).
    pub displacement: Vec<Vec<f64>>,
    pub velocity: Vec<Vec<f64>>,
    pub force: Vec<Vec<f64>>,
    /// Largest and smallest value of each displacement, m.
    pub extremes: Vec<[f64; 2]>,
    /// Largest force of each contact, N.
    pub peak_force: Vec<f64>,
    /// Time for which each contact is closed, s.
    pub closed: Vec<f64>,
    /// The touches, in the order in which they end.
    pub touches: Vec<Touch>,
    /// Contact changes.
    pub switches: usize,
}

impl Histories {
    /// Of so many displacements, which start at `moved` where nothing else moves them, and contacts.
    pub fn new(moved: &[f64], contacts: usize, duration: f64, rate: f64) -> Self {
        let samples = (duration * rate * (1.0 + 1e-12)).floor() as usize + 1;
        let empty = |n: usize| (0..n).map(|_| Vec::with_capacity(samples)).collect::<Vec<Vec<f64>>>();
        Self {
            rate,
            samples,
            displacement: empty(moved.len()),
            velocity: empty(moved.len()),
            force: empty(contacts),
            extremes: vec![[f64::NEG_INFINITY, f64::INFINITY]; moved.len()],
            peak_force: vec![0.0; contacts],
            closed: vec![0.0; contacts],
            touches: Vec::new(),
            switches: 0,
        }
    }

    /// Number of instants so far.
    pub fn len(&self) -> usize {
        self.displacement.first().or(self.force.first()).map_or(0, Vec::len)
    }

    /// Takes an interval, with what static loads move.
    pub fn take(&mut self, stretch: &Stretch<'_>, switched: bool, moved: &[f64]) {
        self.switches += usize::from(switched);
        for (j, extremes) in self.extremes.iter_mut().enumerate() {
            let [value, change] = stretch.observed_roughly(j);
            let (value, reach) = (value + moved[j], REACH * change.abs());
            if value + reach <= extremes[0] && value - reach >= extremes[1] {
                continue;
            }
            let [most, least] = stretch.observed(j).extremes().map(|v| v + moved[j]);
            *extremes = [extremes[0].max(most), extremes[1].min(least)];
        }
        for (i, peak) in self.peak_force.iter_mut().enumerate().filter(|(i, _)| stretch.is_closed(*i)) {
            self.closed[i] += stretch.length();
            let [value, change] = stretch.force_roughly(i);
            if value + REACH * change.abs() > *peak {
                *peak = peak.max(stretch.force(i).extremes()[0]);
            }
        }
        self.sample(stretch, moved);
    }

    fn sample(&mut self, stretch: &Stretch<'_>, moved: &[f64]) {
        let (first, end) = (self.len(), stretch.from() + stretch.length());
        let is_in = |k: &usize| *k < self.samples && *k as f64 / self.rate <= end * (1.0 + 1e-15);
        let times: Vec<f64> = (first..).take_while(is_in).map(|k| k as f64 / self.rate - stretch.from()).collect();
        if times.is_empty() {
            return;
        }
        for (j, (q, v)) in self.displacement.iter_mut().zip(&mut self.velocity).enumerate() {
            let along = stretch.observed(j);
            for t in &times {
                let [value, rate] = along.at(t.max(0.0));
                q.push(value + moved[j]);
                v.push(rate);
            }
        }
        for (i, force) in self.force.iter_mut().enumerate() {
            let along = stretch.is_closed(i).then(|| stretch.force(i));
            force.extend(times.iter().map(|t| along.as_ref().map_or(0.0, |along| along.at(t.max(0.0))[0].max(0.0))));
        }
    }

    /// The instants, s.
    pub fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let rate = self.rate;
        (0..self.len()).map(move |k| k as f64 / rate)
    }
}

/// Within an interval a value that is to be the largest lies no farther beyond that at its beginning than so many times
/// what the rate there moves it; otherwise that of the next interval does.
const REACH: f64 = 2.0;

/// Largest and smallest values in equal parts of a history, and the middle of each, s.
pub fn envelope(values: &[f64], rate: f64, windows: usize) -> Vec<[f64; 3]> {
    let n = values.len();
    let windows = windows.min(n).max(1);
    let part = |k: usize| {
        let (from, to) = (k * n / windows, ((k + 1) * n / windows).max(k * n / windows + 1).min(n));
        let most = |of: fn(f64, f64) -> f64, begin: f64| values[from..to].iter().fold(begin, |m, v| of(m, *v));
        [0.5 * (from + to - 1) as f64 / rate, most(f64::max, f64::NEG_INFINITY), most(f64::min, f64::INFINITY)]
    };
    if n == 0 { Vec::new() } else { (0..windows).map(part).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_envelope_has_each_value_in_one_of_its_parts() {
        let values: Vec<f64> = (0..10).map(f64::from).collect();
        let found = envelope(&values, 2.0, 4);
        assert_eq!(found, [[0.25, 1.0, 0.0], [1.5, 4.0, 2.0], [2.75, 6.0, 5.0], [4.0, 9.0, 7.0]]);
        assert_eq!(envelope(&values, 1.0, 20).len(), 10);
        assert!(envelope(&[], 1.0, 3).is_empty());
    }
}
