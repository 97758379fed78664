//! Courses of loads in time, as pieces of polynomials.

use std::f64::consts::{PI, TAU};

use nlmodes::timestep::{DEGREE, Signal, SignalPiece};

/// Radians of a cosine in a piece: about its middle the remainder of its Taylor polynomial is `0.25¹² / 12! = 1e-16`.
const PIECE: f64 = 0.5;

/// `amplitude cos(phase + ω t + ½ rate t²)` from `start` to `end`, with t counted from the start; zero elsewhere.
pub struct Cosine {
    /// Largest value.
    pub amplitude: f64,
    /// Phase at its start, rad.
    pub phase: f64,
    /// Angular frequency at its start, rad/s.
    pub omega: f64,
    /// By how much that grows, rad/s².
    pub rate: f64,
    /// Its start and end, s.
    pub start: f64,
    pub end: f64,
}

impl Cosine {
    /// Phase at its end.
    pub fn last_phase(&self) -> f64 {
        let t = self.end - self.start;
        self.phase + self.omega * t + 0.5 * self.rate * t * t
    }
}

impl Signal for Cosine {
    fn piece(&self, from: f64) -> SignalPiece {
        if from >= self.end {
            return SignalPiece::constant(0.0, f64::INFINITY);
        }
        if from < self.start {
            return SignalPiece::constant(0.0, self.start);
        }
        let t = from - self.start;
        let fastest = (self.omega + self.rate * t).abs().max((self.rate.abs() * PIECE).sqrt());
        let own = from + PIECE / fastest;
        let (until, continues) = if own < self.end { (own, true) } else { (self.end, false) };
        let half = 0.5 * (until - from);
        let middle = t + half;
        let phase = self.phase + middle * (self.omega + 0.5 * self.rate * middle);
        let (sin, cos) = phase.sin_cos();
        let mut taylor = taylor(self.omega + self.rate * middle, self.rate, [cos, sin]);
        taylor.iter_mut().for_each(|c| *c *= self.amplitude);
        shift(&mut taylor, -half);
        SignalPiece { coefficients: taylor, until, continues }
    }
}

/// Taylor coefficients of `cos φ`, of which cosine and sine are given, with `φ' = ω + rate t`: those of the derivatives
/// `cos' = −φ' sin` and `sin' = φ' cos`.
fn taylor(omega: f64, rate: f64, [cos, sin]: [f64; 2]) -> [f64; DEGREE + 1] {
    let (mut c, mut s) = ([0.0; DEGREE + 1], [0.0; DEGREE + 1]);
    (c[0], s[0]) = (cos, sin);
    for k in 0..DEGREE {
        let before = |of: &[f64; DEGREE + 1]| if k == 0 { 0.0 } else { of[k - 1] };
        let (of_c, of_s) = (omega * c[k] + rate * before(&c), omega * s[k] + rate * before(&s));
        (c[k + 1], s[k + 1]) = (-of_s / (k + 1) as f64, of_c / (k + 1) as f64);
    }
    c
}

/// The polynomial about another place, by repeated synthetic division.
fn shift(a: &mut [f64; DEGREE + 1], by: f64) {
    for level in 0..DEGREE {
        for j in (level..DEGREE).rev() {
            a[j] += by * a[j + 1];
        }
    }
}

/// Courses one after the other: each is zero outside of its own time.
pub struct Sequence(pub Vec<Cosine>);

impl Signal for Sequence {
    fn piece(&self, from: f64) -> SignalPiece {
        match self.0.iter().find(|part| from < part.end) {
            Some(part) => part.piece(from),
            None => SignalPiece::constant(0.0, f64::INFINITY),
        }
    }
}

/// A cosine whose frequency is linear in time, there and back if it is to come back.
pub fn chirp(amplitude: f64, [from_hz, to_hz]: [f64; 2], back: bool, [start, length]: [f64; 2]) -> Sequence {
    let one = if back { 0.5 * length } else { length };
    let rate = TAU * (to_hz - from_hz) / one;
    let up = Cosine { amplitude, phase: 0.0, omega: TAU * from_hz, rate, start, end: start + one };
    if !back {
        return Sequence(vec![up]);
    }
    let (phase, end) = (up.last_phase(), start + length);
    let down = Cosine { phase, omega: TAU * to_hz, rate: -rate, start: up.end, end, ..up };
    Sequence(vec![up, down])
}

/// Half a period of a sine.
pub fn half_sine(peak: f64, width: f64, start: f64) -> Cosine {
    Cosine { amplitude: peak, phase: -0.5 * PI, omega: PI / width, rate: 0.0, start, end: start + width }
}

/// Straight lines between rows of times (s, ascending) and values; zero before and behind.
pub struct Lines {
    /// Times, s.
    pub times: Vec<f64>,
    /// Values.
    pub values: Vec<f64>,
}

impl Signal for Lines {
    fn piece(&self, from: f64) -> SignalPiece {
        let next = self.times.partition_point(|t| *t <= from);
        let Some(&until) = self.times.get(next) else { return SignalPiece::constant(0.0, f64::INFINITY) };
        let Some(before) = next.checked_sub(1) else { return SignalPiece::constant(0.0, until) };
        let slope = (self.values[next] - self.values[before]) / (until - self.times[before]);
        let mut piece = SignalPiece::constant(self.values[before] + slope * (from - self.times[before]), until);
        piece.coefficients[1] = slope;
        piece
    }
}

/// Cubic pieces through equidistant values and rates; zero before and behind.
pub struct Cubics {
    /// The first instant and the distance of two, s.
    pub start: f64,
    pub interval: f64,
    /// Values, and rates per second.
    pub values: Vec<f64>,
    pub rates: Vec<f64>,
}

impl Signal for Cubics {
    fn piece(&self, from: f64) -> SignalPiece {
        if from < self.start {
            return SignalPiece::constant(0.0, self.start);
        }
        // An instant next to a knot is that knot.
        let k = ((from - self.start) / self.interval + 1e-9).floor() as usize;
        if k + 1 >= self.values.len() {
            return SignalPiece::constant(0.0, f64::INFINITY);
        }
        let (h, a, b) = (self.interval, self.values[k], self.values[k + 1]);
        let (p, q) = (self.rates[k] * h, self.rates[k + 1] * h);
        let mut piece = SignalPiece::constant(a, self.start + (k + 1) as f64 * h);
        let cubic = [self.rates[k], (3.0 * (b - a) - 2.0 * p - q) / (h * h), (2.0 * (a - b) + p + q) / (h * h * h)];
        piece.coefficients[1..4].copy_from_slice(&cubic);
        shift(&mut piece.coefficients, from - (self.start + k as f64 * h));
        piece
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Value at an instant, from the pieces up to there.
    fn at(signal: &dyn Signal, t: f64) -> f64 {
        let (mut from, mut piece) = (0.0, signal.piece(0.0));
        while piece.until <= t {
            from = piece.until;
            piece = signal.piece(from);
        }
        piece.coefficients.iter().rev().fold(0.0, |sum, c| sum * (t - from) + c)
    }

    #[test]
    fn pieces_of_cosines_and_chirps_are_those_of_the_closed_form() {
        let sine = Cosine { amplitude: 3.0, phase: 0.4, omega: 50.0, rate: 0.0, start: 0.1, end: f64::INFINITY };
        let there = chirp(2.0, [5.0, 20.0], true, [0.5, 4.0]);
        for k in 0..400 {
            let t = 0.0117 * f64::from(k);
            let expected = if t < 0.1 { 0.0 } else { 3.0 * (0.4 + 50.0 * (t - 0.1)).cos() };
            assert!((at(&sine, t) - expected).abs() < 1e-12, "{t}");
            // 5 to 20 Hz in two seconds, and back.
            let phase = |s: f64| TAU * (5.0 * s + 0.5 * 7.5 * s * s);
            let s = t - 0.5;
            let expected = match s {
                s if !(0.0..4.0).contains(&s) => 0.0,
                s if s < 2.0 => 2.0 * phase(s).cos(),
                s => 2.0 * (2.0 * phase(2.0) - phase(4.0 - s)).cos(),
            };
            assert!((at(&there, t) - expected).abs() < 1e-11, "{t}: {} {expected}", at(&there, t));
        }
    }

    #[test]
    fn pulses_lines_and_cubics_are_what_they_say() {
        let pulse = half_sine(7.0, 0.2, 0.3);
        for (t, expected) in [(0.2, 0.0), (0.35, 7.0 * (0.25 * PI).sin()), (0.4, 7.0), (0.55, 0.0)] {
            assert!((at(&pulse, t) - expected).abs() < 1e-13, "{t}");
        }
        let lines = Lines { times: vec![0.5, 1.0, 3.0], values: vec![1.0, 2.0, -2.0] };
        for (t, expected) in [(0.2, 0.0), (0.75, 1.5), (1.5, 1.0), (2.5, -1.0), (3.5, 0.0)] {
            assert!((at(&lines, t) - expected).abs() < 1e-14, "{t}");
        }
        // A cubic is itself.
        let cube = |t: f64| 1.0 + t - 2.0 * t * t + t * t * t;
        let knots = || (0..5).map(|k| 0.5 * f64::from(k));
        let rates = knots().map(|t| 1.0 - 4.0 * t + 3.0 * t * t).collect();
        let cubics = Cubics { start: 0.0, interval: 0.5, values: knots().map(cube).collect(), rates };
        for t in [0.0, 0.3, 0.5, 1.2, 1.99] {
            assert!((at(&cubics, t) - cube(t)).abs() < 1e-14, "{t}");
        }
        assert_eq!(at(&cubics, 2.3), 0.0);
    }
}
