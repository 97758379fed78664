use crate::{ContactInterval, ModalError, TimeHistory, contact_intervals};

/// Number of samples used for the velocity at the beginning or end of contact.
const VELOCITY_SAMPLES: usize = 4;

/// One impact: velocities normal to the stop before and after it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Impact {
    /// When the contact was closed.
    pub interval: ContactInterval,
    /// Speed toward the stop at the beginning of contact, m/s, positive.
    pub approach: f64,
    /// Speed away from the stop at the end of contact, m/s.
    pub departure: f64,
}

impl Impact {
    /// Coefficient of restitution `e_N = −γ⁺/γ⁻`, eq. (29), with `γ⁻` before and `γ⁺` after the impact.
    pub fn restitution(&self) -> f64 {
        self.departure / self.approach
    }
}

/// Coefficients of restitution of several impacts over their approach speed (Fig. 7 a).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Restitution {
    /// The impacts in the order of time.
    pub impacts: Vec<Impact>,
}

/// Mean and spread of the impacts in a range of approach speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RestitutionStatistics {
    /// Mean approach speed, m/s.
    pub approach: f64,
    /// Mean coefficient of restitution.
    pub mean: f64,
    /// Standard deviation of one impact; NaN with a single one.
    pub std: f64,
    /// Number of impacts.
    pub n_impacts: usize,
}

impl Restitution {
    /// The impacts of a time history, measured or computed. The stop is on the side given by the sign of
    /// [`TimeHistory::stop`], the positive one if it is zero.
    ///
    /// The velocity at an instant is that of a straight line through the four adjacent samples outside the contact: a
    /// velocity that changes within one sample is not smeared, and noise is halved. Impacts without approach are
    /// ignored.
    ///
    /// # Errors
    /// As [`contact_intervals`]; [`ModalError::NoContact`] also if there is no impact with approach.
    pub fn of(history: &TimeHistory) -> Result<Self, ModalError> {
        Self::with(history, VELOCITY_SAMPLES, 0)
    }

    /// The same before a stop that yields, where contacts last many samples: the velocity does not jump, so that at an
    /// instant it is that of a straight line through the two samples on either side of it.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn of_yielding(history: &TimeHistory) -> Result<Self, ModalError> {
        Self::with(history, VELOCITY_SAMPLES / 2, VELOCITY_SAMPLES / 2)
    }

    /// From so many samples outside and within the contact.
    fn with(history: &TimeHistory, outside: usize, within: usize) -> Result<Self, ModalError> {
        let side = if history.stop < 0.0 { -1.0 } else { 1.0 };
        let intervals = contact_intervals(history)?;
        let impact = |(i, interval): (usize, &ContactInterval)| {
            let from = i.checked_sub(1).map_or(0, |before| intervals[before].last + 1);
            let to = intervals.get(i + 1).map_or(history.time.len(), |after| after.first);
            let length = interval.last + 1 - interval.first;
            let before = from.max(interval.first.saturating_sub(outside))..interval.first + within.min(length);
            let after = interval.last + 1 - within.min(length)..to.min(interval.last + 1 + outside);
            let approach = side * line_at(history, before, interval.touching)?;
            let departure = -side * line_at(history, after, interval.leaving)?;
            (approach > 0.0).then_some(Impact { interval: *interval, approach, departure })
        };
        let impacts: Vec<Impact> = intervals.iter().enumerate().filter_map(impact).collect();
        if impacts.is_empty() {
            let peak = history.force.iter().copied().fold(0.0, f64::max);
            return Err(ModalError::NoContact {
                peak,
                threshold: crate::contact_interval::closed_force(&history.force),
            });
        }
        Ok(Self { impacts })
    }

    /// Mean and spread of all impacts.
    pub fn statistics(&self) -> RestitutionStatistics {
        statistics(&self.impacts)
    }

    /// Mean and spread in `n_bins` equal ranges of the approach speed; ranges without an impact are omitted.
    pub fn over_speed(&self, n_bins: usize) -> Vec<RestitutionStatistics> {
        let speeds = self.impacts.iter().map(|impact| impact.approach);
        let low = speeds.clone().fold(f64::INFINITY, f64::min);
        let width = (speeds.fold(0.0, f64::max) - low) / n_bins.max(1) as f64;
        let bin = |impact: &Impact| (((impact.approach - low) / width) as usize).min(n_bins - 1);
        let members = |k: usize| self.impacts.iter().filter(move |i| bin(i) == k).copied().collect::<Vec<_>>();
        (0..n_bins).map(members).filter(|members| !members.is_empty()).map(|members| statistics(&members)).collect()
    }
}

/// Value at `time` of the straight line that fits the velocities of the samples best; `None` without samples.
fn line_at(history: &TimeHistory, samples: std::ops::Range<usize>, time: f64) -> Option<f64> {
    let (t, v) = (&history.time[samples.clone()], &history.velocity[samples]);
    let n = t.len() as f64;
    if t.is_empty() {
        return None;
    }
    let (mean_t, mean_v) = (t.iter().sum::<f64>() / n, v.iter().sum::<f64>() / n);
    let square: f64 = t.iter().map(|t| (t - mean_t).powi(2)).sum();
    let product: f64 = t.iter().zip(v).map(|(t, v)| (t - mean_t) * (v - mean_v)).sum();
    let slope = if square > 0.0 { product / square } else { 0.0 };
    Some(mean_v + slope * (time - mean_t))
}

fn statistics(impacts: &[Impact]) -> RestitutionStatistics {
    let n = impacts.len() as f64;
    let mean = impacts.iter().map(Impact::restitution).sum::<f64>() / n;
    let squares: f64 = impacts.iter().map(|impact| (impact.restitution() - mean).powi(2)).sum();
    RestitutionStatistics {
        approach: impacts.iter().map(|impact| impact.approach).sum::<f64>() / n,
        mean,
        std: if impacts.len() > 1 { (squares / (n - 1.0)).sqrt() } else { f64::NAN },
        n_impacts: impacts.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::tests::Normal;

    /// A ball on a floor below it: parabolas between impacts of a short half-sine force, each losing speed by the
    /// factor `e`.
    fn bouncing(e: f64, noise: f64, side: f64) -> TimeHistory {
        let (g, mut v0, contact, dt) = (9.81, 2.0, 4e-3, 1e-4);
        let mut normal = Normal::new(3);
        let (mut time, mut x, mut v, mut f) = (vec![], vec![], vec![], vec![]);
        let mut start = 0.0137e-1;
        for _ in 0..12 {
            // Flight upward from the stop at x = 0, then contact.
            let flight = 2.0 * v0 / g;
            while (time.len() as f64) * dt < start + flight + contact {
                let s = time.len() as f64 * dt - start;
                let (height, speed, force) = if s < flight {
                    (v0 * s - 0.5 * g * s * s, v0 - g * s, 0.0)
                } else {
                    let phase = (s - flight) / contact;
                    let speed = -v0 + (1.0 + e) * v0 * 0.5 * (1.0 - (std::f64::consts::PI * phase).cos());
                    (0.0, speed, 50.0 * (std::f64::consts::PI * phase).sin())
                };
                time.push(time.len() as f64 * dt);
                x.push(-side * height);
                v.push(-side * speed + noise * normal.draw());
                f.push(force + 0.1 * normal.draw());
            }
            start += flight + contact;
            v0 *= e;
        }
        // The record ends during the last contact.
        let n = time.len() - 20;
        [&mut time, &mut x, &mut v, &mut f].into_iter().for_each(|series| series.truncate(n));
        let acceleration = vec![0.0; n];
        TimeHistory {
            label: String::new(),
            time,
            displacement: x,
            velocity: v,
            acceleration,
            force: f,
            stop: side * 1e-12,
            instants: vec![],
        }
    }

    #[test]
    fn a_bouncing_ball_has_its_coefficient_of_restitution() {
        for side in [1.0, -1.0] {
            let found = Restitution::of(&bouncing(0.8, 0.0, side)).unwrap();
            assert_eq!(found.impacts.len(), 11);
            for (k, impact) in found.impacts.iter().enumerate() {
                assert!((impact.approach - 2.0 * 0.8f64.powi(k as i32)).abs() < 2e-3, "{k}: {impact:?}");
                assert!((impact.restitution() - 0.8).abs() < 2e-3, "{k}: {impact:?}");
            }
        }
    }

    #[test]
    fn with_noise_it_is_found_within_the_spread_that_noise_gives() {
        let noise = 2e-3;
        let found = Restitution::of(&bouncing(0.9, noise, 1.0)).unwrap();
        let statistics = found.statistics();
        assert_eq!(statistics.n_impacts, 11);
        // A line through four samples continued by half a step has 1.05 times the noise of one; the slowest approach is
        // 0.7 m/s.
        let expected = noise / 0.7 * 2.0;
        assert!((statistics.mean - 0.9).abs() < expected, "{statistics:?}");
        assert!(statistics.std < expected && statistics.std > 0.1 * noise, "{statistics:?}");
        let bins = found.over_speed(3);
        assert_eq!(bins.iter().map(|bin| bin.n_impacts).sum::<usize>(), 11);
        assert!(bins.windows(2).all(|pair| pair[0].approach < pair[1].approach));
    }

    #[test]
    fn the_velocities_between_two_contacts_count_for_both() {
        // Three samples between the contacts; instants are half a sample outside, since the force does not rise inward.
        [(1.0, 1.0), (1e-4, 1.0), (1.0, 1e-6)].into_iter().for_each(velocities_between);
    }

    /// In units of time and speed.
    fn velocities_between((unit, speed): (f64, f64)) {
        let between = [-1.0, -1.0, 1.0];
        let mut history = TimeHistory::empty("", 1.0);
        for j in 0..40_usize {
            let closed = (10..14).contains(&j) || (17..21).contains(&j);
            let velocity = between.get(j.wrapping_sub(14)).copied().unwrap_or(if j < 14 { 2.0 } else { -3.0 });
            history.push(unit * j as f64, [0.0, speed * velocity, 0.0], if closed { 5.0 } else { 0.0 });
        }
        let found = Restitution::of(&history).unwrap();
        // The line through the three has its mean, −⅓, at 15 and the slope 1.
        for (impact, [approach, departure]) in found.impacts.iter().zip([[2.0, 11.0 / 6.0], [7.0 / 6.0, 3.0]]) {
            let near = |found: f64, expected: f64| (found / speed - expected).abs() < 1e-13;
            assert!(near(impact.approach, approach) && near(impact.departure, departure), "{impact:?}");
        }
        assert_eq!(found.impacts.len(), 2);
    }

    /// Velocities that are linear over four samples on either side of the contact, and anything farther away.
    #[test]
    fn four_samples_on_either_side_of_a_contact_tell_its_velocities() {
        let mut history = TimeHistory::empty("", 1.0);
        for j in 0..40_i32 {
            let velocity = match j {
                6..10 => 2.0 + 0.1 * f64::from(j - 10),
                14..18 => -1.5 + 0.2 * f64::from(j - 14),
                _ => f64::from(j % 3) * 10.0,
            };
            history.push(f64::from(j), [0.0, velocity, 0.0], if (10..14).contains(&j) { 5.0 } else { 0.0 });
        }
        let found = Restitution::of(&history).unwrap();
        // The force does not rise inward: the instants are half a sample outside, at 9.5 and 13.5.
        let impact = found.impacts[0];
        assert!((impact.approach - 1.95).abs() < 1e-13 && (impact.departure - 1.6).abs() < 1e-13, "{impact:?}");
    }

    #[test]
    fn impacts_are_counted_in_equal_ranges_of_their_speed() {
        let interval = ContactInterval { touching: 0.0, leaving: 1.0, first: 0, last: 1 };
        let at = |approach: f64, e: f64| Impact { interval, approach, departure: e * approach };
        for unit in [1.0, 1e-5] {
            let impacts = [(1.0, 0.9), (3.9, 0.5), (1.9, 0.7), (2.1, 0.6), (4.0, 0.4), (1.2, 0.8)];
            let found = Restitution { impacts: impacts.map(|(speed, e)| at(unit * speed, e)).to_vec() };
            // From 1 to 4 in thirds: three impacts, one and two.
            let bins = found.over_speed(3);
            assert_eq!(bins.iter().map(|bin| bin.n_impacts).collect::<Vec<_>>(), [3, 1, 2]);
            for (bin, (speed, mean)) in bins.iter().zip([(4.1 / 3.0, 0.8), (2.1, 0.6), (3.95, 0.45)]) {
                assert!((bin.approach / unit - speed).abs() < 1e-12 && (bin.mean - mean).abs() < 1e-12, "{bin:?}");
            }
            let apart = found.over_speed(40);
            assert_eq!(apart.iter().map(|bin| bin.n_impacts).sum::<usize>(), 6);
            assert!(apart.len() == 6, "ranges without impacts are left out: {}", apart.len());
        }
    }

    #[test]
    fn two_impacts_have_a_spread_and_one_has_none() {
        let interval = ContactInterval { touching: 0.0, leaving: 1.0, first: 0, last: 1 };
        let impacts = [1.6, 1.2].map(|departure| Impact { interval, approach: 2.0, departure });
        let both = statistics(&impacts);
        assert!((both.mean - 0.7).abs() < 1e-15 && (both.std - 0.02f64.sqrt()).abs() < 1e-15, "{both:?}");
        assert!(statistics(&impacts[..1]).std.is_nan());
    }

    #[test]
    fn contacts_that_are_not_approached_are_no_impacts_and_the_error_has_their_force() {
        let mut history = TimeHistory::empty("", 1.0);
        for j in 0..40 {
            history.push(f64::from(j), [0.0, -1.0, 0.0], if (10..20).contains(&j) { 1e-3 } else { 0.0 });
        }
        let error = Restitution::of(&history).unwrap_err();
        assert_eq!(error, ModalError::NoContact { peak: 1e-3, threshold: 2e-5 });
    }

    #[test]
    fn without_contact_there_is_none() {
        let mut history = bouncing(0.8, 0.0, 1.0);
        history.force.fill(0.0);
        assert_eq!(Restitution::of(&history).unwrap_err(), ModalError::NoContact { peak: 0.0, threshold: 0.0 });
        history.velocity.pop();
        assert!(matches!(Restitution::of(&history), Err(ModalError::HistoryLength { .. })));
    }
}
