//! By how much the impulse of each stop differs.

use nlmodes::report::DataTable;

use super::said::{by, nothing_to_compare, percent, relative, signed};
use super::{Difference, Equal, Laid};

/// Impulses below this fraction of the largest one of their stop are ignored, since percentages of small values are
/// meaningless.
const FLOOR: f64 = 1e-2;
/// Share of the largest one below which an impulse is rounding: the stop is not touched.
pub(super) const ROUNDING: f64 = 1e-9;

/// The impulse of a stop against that of the branch, over all points at which it can be compared.
#[derive(Debug, Clone, PartialEq)]
pub struct StopChange {
    /// Number of the stop, from 0.
    pub stop: usize,
    /// What the motions have in common that are compared.
    pub equal: Equal,
    /// Median, least and largest relative difference in per cent; none where no point can be compared.
    pub percent: Option<[f64; 3]>,
    /// The point whose difference has the largest magnitude.
    pub largest_at: Option<usize>,
    /// Points that are compared: the stop has an impulse in both.
    pub points: usize,
    /// Points at which it has one in one of both only.
    pub alone: usize,
    /// Points at which one of both has several motions, so that it is not known which belong to each other.
    pub apart: usize,
}

/// The change of each stop; none where impulses are not known.
pub fn changes(found: &[Difference]) -> Vec<StopChange> {
    let stops = found.iter().map(|difference| difference.stops.len()).max().unwrap_or(0);
    (0..stops).filter_map(|stop| change(found, stop)).collect()
}

fn change(found: &[Difference], stop: usize) -> Option<StopChange> {
    let of = |difference: &Difference| difference.stops.get(stop).copied();
    let largest = found.iter().filter_map(of).flatten().filter(|impulse| impulse.is_finite()).fold(0.0, f64::max);
    let counts = |[a, b]: &[f64; 2]| a.max(*b) > FLOOR * largest;
    let known = || found.iter().filter_map(|d| Some((d, of(d)?))).filter(|(_, pair)| counts(pair));
    let (clear, apart): (Vec<_>, Vec<_>) = known().partition(|(difference, _)| difference.is_clear());
    let (both, alone): (Vec<_>, Vec<_>) = clear.into_iter().partition(|(_, [a, b])| a.min(*b) > ROUNDING * largest);
    let size = |[a, b]: &[f64; 2]| relative(*a, *b).abs();
    let at = both.iter().max_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)));
    Some(StopChange {
        stop,
        equal: found.first()?.equal,
        percent: percent(both.iter().map(|(_, [a, b])| (*a, *b))).map(|found| found.0),
        largest_at: at.map(|(difference, _)| difference.point),
        points: both.len(),
        alone: alone.len(),
        apart: apart.len(),
    })
}

impl StopChange {
    /// Whether the stop has an impulse anywhere.
    fn is_touched(&self) -> bool {
        self.points + self.alone + self.apart > 0
    }

    /// Why this many points are not compared; empty if all are.
    fn left_out(&self) -> String {
        let several = format!("{} where there are several motions of that {}", self.apart, self.equal.name());
        let alone = format!("{} where it is touched in one of both only", self.alone);
        let said = [(self.apart, several), (self.alone, alone)].into_iter().filter(|(count, _)| *count > 0);
        said.map(|(_, text)| text).collect::<Vec<_>>().join(", ")
    }

    /// In a sentence, without the name of the stop.
    fn sentence(&self) -> String {
        let (name, left_out) = (self.equal.name(), self.left_out());
        let others = if left_out.is_empty() { left_out } else { format!("; left out: {left_out}") };
        match self.percent {
            Some(range) => format!("at equal {name} {}{others}", by(range, self.points)),
            None => format!("at equal {name} {}{others}", nothing_to_compare(self.apart)),
        }
    }
}

/// A line for each stop, with its differences in all comparisons; nothing where impulses are not known.
pub fn lines(all: &[Vec<StopChange>], names: &[String]) -> Vec<String> {
    let line = |(number, name): (usize, &String)| {
        let own: Vec<&StopChange> = all.iter().flatten().filter(|change| change.stop == number).collect();
        if !own.is_empty() && !own.iter().any(|change| change.is_touched()) {
            return Some(format!("impulse of {name}: not touched"));
        }
        let said: Vec<String> = own.into_iter().map(StopChange::sentence).collect();
        (!said.is_empty()).then(|| format!("impulse of {name}: {}", said.join("; ")))
    };
    names.iter().enumerate().filter_map(line).collect()
}

/// The same as a table of the page, of the stops that are touched.
pub fn stops_table(laid: &Laid, all: &[Vec<StopChange>], (names, own): (&[String], &str)) -> DataTable {
    let own = if own.is_empty() { "this branch" } else { own };
    let title = format!(
        "Impulse of each stop, by how much it differs: {} against {own}; left out are points with several motions, and \
            those at which one of both touches it alone",
        laid.branch.label
    );
    let head =
        ["stop", "at equal", "median, %", "least, %", "largest, %", "points", "most at point", "several", "one alone"];
    let mut table = DataTable::new(title, &head);
    for (number, name) in names.iter().enumerate() {
        for change in all.iter().flatten().filter(|change| change.stop == number && change.is_touched()) {
            let cells = match change.percent {
                Some(range) => range.map(signed),
                None => [(); 3].map(|()| "–".to_owned()),
            };
            let at = change.largest_at.map_or_else(|| "–".to_owned(), |point| point.to_string());
            let row = [name.clone(), change.equal.name().to_owned()].into_iter().chain(cells);
            let points = change.points.to_string();
            let left_out = [change.apart, change.alone].map(|count| count.to_string());
            table.rows.push(row.chain([points, at]).chain(left_out).collect());
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points with these impulses at each stop, in both; the partner of the last may be on another half-branch.
    fn found(stops: &[&[[f64; 2]]]) -> Vec<Difference> {
        let last = stops.len() - 1;
        let of = |(point, stops): (usize, &&[[f64; 2]])| Difference {
            point,
            equal: Equal::Frequency,
            amplitude: f64::NAN,
            energy: f64::NAN,
            frequency: 10.0,
            own_frequency: 10.0,
            impulse: stops.iter().map(|pair| pair[0]).sum(),
            own_impulse: stops.iter().map(|pair| pair[1]).sum(),
            force: f64::NAN,
            own_force: f64::NAN,
            stops: stops.to_vec(),
            motions: if point == last { 2 } else { 1 },
            is_matched: false,
        };
        stops.iter().enumerate().map(of).collect()
    }

    #[test]
    fn only_points_at_which_a_stop_pushes_in_both_are_in_its_median_in_any_unit() {
        for unit in [1.0, 1e-6] {
            let pair = |a: f64, b: f64| [a * unit, b * unit];
            // The first stop grows by a tenth and a fifth, the second is touched at one point by one and at one by
            // both.
            let points = found(&[
                &[pair(0.0, 0.0), pair(0.0, 0.0)],
                &[pair(1.1, 1.0), pair(0.0, 0.0)],
                &[pair(2.4, 2.0), pair(0.3, 0.0)],
                &[pair(1e-3, 2e-3), pair(0.9, 1.0)],
                &[pair(9.0, 3.0), pair(5.0, 1.0)],
            ]);
            let all = changes(&points);
            assert_eq!(all.len(), 2);
            let [median, least, most] = all[0].percent.unwrap();
            assert!((median - 15.0).abs() < 1e-9 && (least - 10.0).abs() < 1e-9 && (most - 20.0).abs() < 1e-9);
            assert_eq!((all[0].points, all[0].alone, all[0].apart, all[0].largest_at), (2, 0, 1, Some(2)));
            assert!((all[1].percent.unwrap()[0] + 10.0).abs() < 1e-9);
            assert_eq!((all[1].points, all[1].alone, all[1].apart, all[1].largest_at), (1, 1, 1, Some(3)));
            let said = lines(&[all], &["stop 0 at 1 m".to_owned(), "stop 1 at 2 m".to_owned()]);
            assert_eq!(
                said[0],
                "impulse of stop 0 at 1 m: at equal frequency by +10.0 to +20.0 % at 2 points; \
                 left out: 1 where there are several motions of that frequency"
            );
            // A stop without contact is reported as such.
            let silent = changes(&found(&[&[pair(0.0, 0.0)], &[pair(0.0, 0.0)]]));
            assert_eq!(lines(&[silent], &["stop 0".to_owned()]), ["impulse of stop 0: not touched"]);
            assert!(said[1].contains(" % at 1 point; left out: ") && said[1].contains("1 where it is touched in one"));
        }
    }
}
