//! Differences in words, and as a table of the page.

use nlmodes::modal::{ModalBranch, ModalPoint};
use nlmodes::report::DataTable;

use super::stops::ROUNDING;
use super::{Difference, Equal, Laid};

/// Most rows of the table on the page.
const SHOWN: usize = 20;
/// Largest difference in per cent, of either sign, that is called agreement.
const AGREES: f64 = 0.1;
/// Minimum number of points for a median.
const FEW: usize = 5;
/// Differences in per cent that are none.
const NOTHING: f64 = 1e-5;

/// Median, least and largest of the relative differences in per cent, and the number of pairs; none without a pair of
/// values. The median is not affected by a few points on steep parts of a curve.
pub fn percent(pairs: impl Iterator<Item = (f64, f64)>) -> Option<([f64; 3], usize)> {
    let all = percentages(pairs);
    Some((range(&all)?, all.len()))
}

/// Median, least and largest of these sorted ones.
fn range(sorted: &[f64]) -> Option<[f64; 3]> {
    Some([median(sorted)?, *sorted.first()?, *sorted.last()?])
}

/// All of them, from the least to the largest.
fn percentages(pairs: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    let mut all: Vec<f64> = pairs.map(|(value, own)| relative(value, own)).filter(|p| p.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// The value in the middle of these sorted ones, or half-way between the two there.
pub(super) fn median(sorted: &[f64]) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    Some(0.5 * (sorted[last / 2] + sorted[last.div_ceil(2)]))
}

/// Differences in words: their median and range, or the range alone where there are few points.
pub fn by([median, least, most]: [f64; 3], points: usize) -> String {
    let [median, least, most] = [median, least, most].map(signed);
    match points {
        1 => format!("by {median} % at 1 point"),
        n if least == most => format!("by {median} % at {n} points"),
        n if n < FEW => format!("by {least} to {most} % at {n} points"),
        n => format!("by {median} % in the median of {n} points ({least} to {most} %)"),
    }
}

/// What to do if no motions can be paired.
pub(super) fn nothing_to_compare(apart: usize) -> &'static str {
    if apart == 0 {
        return "nothing to compare";
    }
    "nothing to compare, since one of the two follows an internal resonance there"
}

/// In per cent; no number where there is nothing to divide by.
pub(super) fn relative(value: f64, own: f64) -> f64 {
    if own == 0.0 { f64::NAN } else { 100.0 * (value / own - 1.0) }
}

/// `−1.00`, to three digits with its sign; rounding errors are zero.
pub(super) fn signed(percent: f64) -> String {
    if percent.abs() < NOTHING {
        return "0".to_owned();
    }
    // Of the rounded number: 9.9996 is 10.0.
    let whole = nlmodes_scene::rounded(percent.abs(), 3).log10().floor().clamp(-5.0, 2.0) as i32;
    format!("{percent:+.0$}", (2 - whole) as usize).replace('-', "−")
}

/// By how much the impulse differs, and the largest force, which need not converge, at points that touch a stop in
/// both; nothing where neither is known.
fn of_forces(found: &[&Difference]) -> String {
    let text = |name: &str, note: &str, of: fn(&Difference) -> (f64, f64)| {
        let pairs = || found.iter().map(|difference| of(difference));
        let least = ROUNDING * pairs().map(|(value, own)| value.max(own)).filter(|x| x.is_finite()).fold(0.0, f64::max);
        percent(pairs().filter(|(value, own)| value.min(*own) > least)).map_or_else(String::new, |(range, n)| {
            let of = if n == found.len() { "" } else { ", those that touch a stop in both" };
            format!("; {name} {}{of}{note}", by(range, n))
        })
    };
    let note = ", which of short blows need not converge with harmonics";
    text("its impulse a period", "", |d| (d.impulse, d.own_impulse))
        + &text("its largest force", note, |d| (d.force, d.own_force))
}

/// Points at whose amplitude there are several motions, and which are in no mean.
fn left_out(count: usize, what: &str) -> String {
    match count {
        0 => String::new(),
        n => {
            let points = if n == 1 { "1 point is".to_owned() } else { format!("{n} points are") };
            format!(
                "; {points} left out, where one of the two has several motions of that {what} (internal resonances, \
                    folds): the nearest may be on another half-branch"
            )
        }
    }
}

/// Softer or stiffer than the branch, by what most of these differences of frequencies in per cent are; where not all
/// are, how many are what.
fn verdict(percent: &[f64], own: &str) -> String {
    let count = |is: fn(f64) -> bool| percent.iter().filter(|p| is(**p)).count();
    let (soft, stiff) = (count(|p| p <= -AGREES), count(|p| p >= AGREES));
    let agree = (percent.len() - soft - stiff, format!("in agreement to {AGREES} % with"), "in agreement");
    let mut counts = [(soft, "softer than".to_owned(), "softer"), (stiff, "stiffer than".to_owned(), "stiffer"), agree];
    counts.sort_by_key(|(count, ..)| std::cmp::Reverse(*count));
    let [(most, first, _), others @ ..] = counts;
    if most == percent.len() {
        return format!("{first} {own}");
    }
    let others = others.into_iter().filter(|(count, ..)| *count > 0);
    let others: Vec<String> = others.map(|(count, _, word)| format!("{word} at {count}")).collect();
    format!("{first} {own} at {most} of {} points, {}", percent.len(), others.join(", "))
}

/// Whether the overlay is softer or stiffer than the branch, in a sentence; based on the points whose corresponding
/// motion of the branch is known.
pub fn sentence(laid: &Laid, found: &[Difference], branch: &ModalBranch) -> String {
    let (name, own) = (&laid.branch.label, branch);
    let own = if own.label.is_empty() { "this branch" } else { &own.label };
    let Some(first) = found.first() else { return format!("{name}: {}", apart(&laid.branch, branch)) };
    let what = first.equal.name();
    let clear: Vec<&Difference> = found.iter().filter(|difference| difference.is_clear()).collect();
    let others = left_out(found.len() - clear.len(), what);
    let off = percentages(clear.iter().map(|difference| (difference.frequency, difference.own_frequency)));
    let Some(range) = range(&off) else {
        let apart = found.len() - clear.len();
        return format!("{name} and {own}: {}{others}", nothing_to_compare(apart));
    };
    format!(
        "{name}: {}; its frequency at equal {what} differs {}{}{}{others}",
        verdict(&off, own),
        by(range, clear.len()),
        matched(&clear),
        of_forces(&clear)
    )
}

/// That no point meets a motion of the branch, and the amplitudes of both, or the energies where there are none.
fn apart(laid: &ModalBranch, own: &ModalBranch) -> String {
    let sizes = |branch: &ModalBranch, of: fn(&ModalPoint) -> f64| {
        let all = || branch.points.iter().map(of).filter(|size| size.is_finite());
        let ends = all().reduce(f64::min).zip(all().reduce(f64::max));
        ends.map(|(least, most)| format!("{least:.3e} to {most:.3e}"))
    };
    let both = |of| Some((sizes(laid, of)?, sizes(own, of)?));
    let name = if own.label.is_empty() { "this branch" } else { &own.label };
    let said = both(|point| point.modal_amplitude).map(|(its, here)| ("modal amplitudes", its, here, "m√kg"));
    match said.or_else(|| both(|point| point.kinetic_energy).map(|(its, here)| ("energies", its, here, "J"))) {
        Some((what, its, here, unit)) => {
            format!("no point to compare with {name}: its {what} are {its} {unit}, those of {name} {here} {unit}")
        }
        None => format!("no point to compare with {name}"),
    }
}

/// Points of a test that have several motions of the branch to choose from.
fn matched(clear: &[&Difference]) -> String {
    match clear.iter().filter(|difference| difference.is_matched).count() {
        0 => String::new(),
        n => format!(", of which {n} with the one of several motions that fits the other points"),
    }
}

/// By how much impulse and largest force differ at equal frequency, in a sentence; nothing where they are not known.
pub fn sentence_at_equal_frequency(laid: &Laid, found: &[Difference], own: &str) -> Option<String> {
    let own = if own.is_empty() { "this branch" } else { own };
    let clear: Vec<&Difference> = found.iter().filter(|difference| difference.is_clear()).collect();
    let (said, others) = (of_forces(&clear), left_out(found.len() - clear.len(), Equal::Frequency.name()));
    let said = said.strip_prefix("; ")?;
    Some(format!("{} against {own} at equal frequency: differs in {said}{others}", laid.branch.label))
}

/// The differences as a table of the page: evenly chosen rows.
pub fn table(laid: &Laid, found: &[Difference]) -> DataTable {
    let title = format!("{} against this branch", laid.branch.label);
    let head = [
        "point",
        "amplitude, m√kg",
        "energy, J",
        "frequency, Hz",
        "this branch, Hz",
        "frequency off by, %",
        "impulse, N s",
        "this branch, N s",
        "impulse off by, %",
        "force, N",
        "this branch, N",
        "force off by, %",
    ];
    let mut table = DataTable::new(title, &head);
    let n = found.len();
    let shown =
        if n <= SHOWN { (0..n).collect() } else { (0..SHOWN).map(|k| k * (n - 1) / (SHOWN - 1)).collect::<Vec<_>>() };
    let text = |value: f64| if value.is_finite() { format!("{value:.5}") } else { "–".to_owned() };
    let short = |value: f64| if value.is_finite() { format!("{value:.4e}") } else { "–".to_owned() };
    let off = |difference: &Difference, value: f64, own: f64| match relative(value, own) {
        // The nearest of several may be on another half-branch.
        _ if !difference.is_clear() => format!("one of {}", difference.motions),
        percent if percent.is_finite() => signed(percent),
        _ => "–".to_owned(),
    };
    for difference in shown.into_iter().map(|k| &found[k]) {
        table.rows.push(vec![
            difference.point.to_string(),
            short(difference.amplitude),
            short(difference.energy),
            text(difference.frequency),
            text(difference.own_frequency),
            off(difference, difference.frequency, difference.own_frequency),
            short(difference.impulse),
            short(difference.own_impulse),
            off(difference, difference.impulse, difference.own_impulse),
            short(difference.force),
            short(difference.own_force),
            off(difference, difference.force, difference.own_force),
        ]);
    }
    without_unknown(&mut table);
    table
}

/// Removes amplitude, energy, impulse or force if no row of the overlay has it.
fn without_unknown(table: &mut DataTable) {
    let known = |column: usize| table.rows.iter().any(|row| row[column] != "–");
    let unknown = [1..2, 2..3, 6..9, 9..12].into_iter().filter(|group| !known(group.start)).flatten();
    for column in unknown.collect::<Vec<_>>().into_iter().rev() {
        table.head.remove(column);
        table.rows.iter_mut().for_each(|row| _ = row.remove(column));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_points_decide_and_the_others_are_counted() {
        let said = |percent: &[f64]| verdict(percent, "this branch");
        assert_eq!(said(&[-19.4, -3.0, -0.7]), "softer than this branch");
        assert_eq!(said(&[0.3, 3.0]), "stiffer than this branch");
        assert_eq!(said(&[-0.02, 0.01]), "in agreement to 0.1 % with this branch");
        let eight = [-3.2, -3.1, -3.0, -3.0, -2.9, -2.9, -2.8, 0.4];
        assert_eq!(said(&eight), "softer than this branch at 7 of 8 points, stiffer at 1");
        assert_eq!(said(&[-0.7, 0.0, 0.05]), "in agreement to 0.1 % with this branch at 2 of 3 points, softer at 1");
        assert_eq!(
            said(&[-1.0, 0.0, 1.0, 2.0]),
            "stiffer than this branch at 2 of 4 points, softer at 1, in agreement at 1"
        );
    }

    #[test]
    fn few_points_have_a_range_only_and_internal_resonances_are_named_where_nothing_is_compared() {
        assert_eq!(by([1.0, 1.0, 1.0], 1), "by +1.00 % at 1 point");
        assert_eq!(by([1.0, 1.0, 1.0], 3), "by +1.00 % at 3 points");
        assert_eq!(by([1.0, -2.0, 3.5], 4), "by −2.00 to +3.50 % at 4 points");
        assert_eq!(by([1.0, -2.0, 3.5], 5), "by +1.00 % in the median of 5 points (−2.00 to +3.50 %)");
        assert_eq!(nothing_to_compare(0), "nothing to compare");
        // Which of the two, and whether it was asked to skip internal resonances, is not known here: no advice.
        assert!(nothing_to_compare(3).ends_with("one of the two follows an internal resonance there"));
    }

    #[test]
    fn the_median_lies_in_the_middle_or_half_way_between_two() {
        assert_eq!(median(&[]), None);
        assert_eq!([median(&[3.0]), median(&[1.0, 4.0]), median(&[1.0, 2.0, 90.0])], [Some(3.0), Some(2.5), Some(2.0)]);
        let (range, count) = percent([(2.0, 1.0), (1.5, 1.0), (1.0, 0.0), (9.0, 1.0)].into_iter()).unwrap();
        assert_eq!((range, count), ([100.0, 50.0, 800.0], 3));
    }

    #[test]
    fn differences_are_said_to_three_digits() {
        let said = [-1.0, 0.0, 1843.869, 12.345, -0.0192, 130.8, 1e-7, 9.999_999].map(signed);
        assert_eq!(said, ["−1.00", "0", "+1844", "+12.3", "−0.0192", "+131", "0", "+10.0"]);
    }
}
