//! Where a curve passes a value, and its quantities there.

use std::f64::consts::TAU;

use nlmodes::modal::{ContactPeriod, Event, cubic, monotone_slopes};

use super::read::Row;
use super::{Abscissa, Passage, StopValues};

/// Relative difference from the value up to which a point lies there.
const AT: f64 = 1e-9;

/// Bisections of a step, which leave of it less than rounding.
const HALVINGS: usize = 60;

/// What is below this share of the largest value of a curve, or of what the energy of the motion would give, is
/// rounding.
const ROUNDING: f64 = 1e-12;

/// All passages through a value in the order of the curve, and the pairs of points between which something was left out
/// and the value lies.
pub(super) fn passages(rows: &[Row], abscissa: Abscissa, value: f64) -> (Vec<Passage>, Vec<[usize; 2]>) {
    let at = |k: usize| (rows[k].value(abscissa) - value).abs() <= AT * value;
    let side = |k: usize| rows[k].value(abscissa) > value;
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    for k in 0..rows.len() {
        if at(k) {
            if k == 0 || !at(k - 1) {
                found.push(passage(rows, [k, k], |quantity| quantity(&rows[k])));
            }
        } else if k > 0 && !at(k - 1) && side(k - 1) != side(k) {
            if rows[k].own.event.contains(&Event::Resumed) {
                left_out.push([rows[k - 1].own.point, rows[k].own.point]);
                continue;
            }
            let step = Step::new(rows, k - 1);
            let t = step.where_it_is(abscissa, value);
            found.push(passage(rows, [k - 1, k], |quantity| step.at(quantity, t)));
        }
    }
    (found, left_out)
}

/// The values of a row, each evaluated by `at`; what is rounding of the largest ones is zero.
fn passage(rows: &[Row], points: [usize; 2], at: impl Fn(&dyn Fn(&Row) -> f64) -> f64) -> Passage {
    let [before, after] = points.map(|k| &rows[k]);
    let events = |row: &Row| Event::names(&row.own.event);
    let stop = |contact: usize| {
        let of = |quantity: fn(&ContactPeriod) -> f64| {
            let largest =
                rows.iter().flat_map(|row| &row.contacts).map(|stop| quantity(stop).abs()).fold(0.0, f64::max);
            clean(at(&|row: &Row| row.contacts.get(contact).map_or(f64::NAN, quantity)), largest)
        };
        StopValues {
            contact,
            contact_fraction: of(|stop| stop.closed_share),
            impulse_ns: of(|stop| stop.impulse),
            mean_force_n: of(|stop| stop.mean_force),
            peak_force_n: of(|stop| stop.peak_force),
            approach_velocity_m_s: of(|stop| stop.approach_velocity),
            touches: [before, after].map(|row| row.contacts.get(contact).map_or(0, |stop| stop.touches)),
        }
    };
    let [frequency, energy] = [at(&|row| row.own.frequency_hz), at(&|row| row.own.energy_j)];
    let largest = rows.iter().map(|row| row.own.modal_amplitude.abs()).fold(0.0, f64::max);
    // That of a motion in the fundamental alone, by its averaged kinetic energy (ω a)²/4.
    let of_energy = 2.0 * energy.max(0.0).sqrt() / (TAU * frequency);
    Passage {
        points: [before.own.point, after.own.point],
        frequency_hz: frequency,
        energy_j: energy,
        modal_amplitude: clean(at(&|row| row.own.modal_amplitude), largest.max(of_energy)),
        peak_m: at(&|row| row.own.peak_m),
        level: before.response.level.map(|_| at(&|row| row.response.level.unwrap_or(f64::NAN))),
        level_unit: before.response.level_unit(),
        stable: [before.own.stable, after.own.stable],
        events: [events(before), events(after)],
        contacts: (0..before.contacts.len().min(after.contacts.len())).map(stop).collect(),
    }
}

/// A value, zero where it is rounding of the largest one.
fn clean(value: f64, largest: f64) -> f64 {
    if value.abs() <= ROUNDING * largest { 0.0 } else { value }
}

/// The step from a point of a curve to the next one, with one neighbour on either side unless the curve has a corner or
/// a gap there.
struct Step<'r> {
    rows: &'r [Row],
    /// Which of these rows the step begins at.
    first: usize,
    /// Lengths of the steps between them in the plane of the logarithms of frequency and energy, each over what it
    /// spans there.
    lengths: Vec<f64>,
}

impl<'r> Step<'r> {
    fn new(rows: &'r [Row], k: usize) -> Self {
        let corner = |row: &Row| row.own.event.iter().any(|event| event.is_corner());
        let goes_on = |row: &Row| !corner(row) && !row.own.event.contains(&Event::Resumed);
        let from = if k > 0 && goes_on(&rows[k]) { k - 1 } else { k };
        let resumes = |row: Option<&Row>| row.is_none_or(|row| row.own.event.contains(&Event::Resumed));
        let to = if corner(&rows[k + 1]) || resumes(rows.get(k + 2)) { k + 1 } else { k + 2 };
        let rows = &rows[from..=to];
        let span = |of: fn(&Row) -> f64| {
            let all =
                rows.iter().map(of).fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), x| (low.min(x), high.max(x)));
            let span = (all.1 / all.0).ln();
            if span.is_finite() && span > 0.0 { span } else { 1.0 }
        };
        let spans = (span(|row| row.own.frequency_hz), span(|row| row.own.energy_j));
        let lengths = rows.windows(2).map(|pair| {
            let log = |a: f64, b: f64| Some((b / a).ln()).filter(|x| x.is_finite()).unwrap_or(0.0);
            let x = log(pair[0].own.frequency_hz, pair[1].own.frequency_hz) / spans.0;
            x.hypot(log(pair[0].own.energy_j, pair[1].own.energy_j) / spans.1).max(1e-12)
        });
        Self { rows, first: k - from, lengths: lengths.collect() }
    }

    /// A quantity at a share of the step.
    fn at(&self, quantity: &dyn Fn(&Row) -> f64, t: f64) -> f64 {
        let values: Vec<f64> = self.rows.iter().map(quantity).collect();
        let slopes = monotone_slopes(&values, &self.lengths);
        let k = self.first;
        cubic([values[k], values[k + 1]], [slopes[k], slopes[k + 1]], self.lengths[k], t)
    }

    /// The share of the step at which a quantity, which is monotone along it, has this value.
    fn where_it_is(&self, abscissa: Abscissa, value: f64) -> f64 {
        let of = |row: &Row| row.value(abscissa);
        let rises = of(&self.rows[self.first + 1]) > of(&self.rows[self.first]);
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if (self.at(&of, middle) < value) == rises { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}
