//! Passages in words.

use std::path::Path;

use nlmodes_scene::number;

use super::{Abscissa, Curve, Passage, StopValues};

/// What is found at a value of the results in this directory, in words.
pub fn text(results: &Path, abscissa: Abscissa, value: f64, curves: &[Curve]) -> String {
    let here = format!("{} {}", exact(value), unit(abscissa));
    let mut text = String::new();
    let told: Vec<&Curve> = curves.iter().filter(|c| !c.passages.is_empty() || !c.left_out.is_empty()).collect();
    for (k, curve) in told.iter().enumerate() {
        let below = curve.table.strip_prefix(results).ok().filter(|path| !path.as_os_str().is_empty());
        let table = below.unwrap_or(&curve.table);
        let name = curve.name.as_ref().map(|name| format!(", {name}")).unwrap_or_default();
        let times = match curve.passages.len() {
            0 => "is left out".to_owned(),
            1 => "is passed once".to_owned(),
            n => format!("is passed {n} times, each with another motion"),
        };
        text += &format!("{}{name}: {here} {times}\n", table.display());
        for [from, to] in &curve.left_out {
            text += &format!(
                "\n  between points {from} and {to} an internal-resonance branch was left out, and {here} lies in it: \
                nothing is known there\n"
            );
        }
        let digits = Digits::of(&curve.passages);
        curve.passages.iter().for_each(|passage| text += &of_passage(passage, &digits, curve.has_contacts));
        let is_last_of_table = told.get(k + 1).is_none_or(|next| next.table != curve.table);
        if is_last_of_table && !curve.verdict.is_empty() {
            text += &format!("\n  Certificate: {}\n", curve.verdict);
        }
        text += "\n";
    }
    if text.is_empty() {
        let range = curves.iter().map(|curve| curve.range);
        let [low, high] = range.fold([f64::INFINITY, 0.0], |[a, b], [c, d]| [a.min(c), b.max(d)]);
        let points: usize = curves.iter().map(|curve| curve.points).sum();
        let (digits, unit) = (apart(&[low, value, high]), unit(abscissa));
        let (low, high) = (rounded(low, digits), rounded(high, digits));
        let lie = match (points, low == high) {
            (1, _) => format!("its only point lies at {low} {unit}"),
            (_, true) => format!("all {points} points lie at {low} {unit}"),
            _ => format!("{points} points lie between {low} {unit} and {high} {unit}"),
        };
        return format!("{}: {here} is not passed; {lie}\n", results.display());
    }
    text + "Between points values are interpolated along the branch by cubic pieces that go beyond none of the two. \
        Largest forces of short blows need not converge with\nharmonics, impulses do.\n"
}

fn unit(abscissa: Abscissa) -> &'static str {
    match abscissa {
        Abscissa::FrequencyHz => "Hz",
        Abscissa::EnergyJ => "J",
    }
}

/// Significant digits of the values of passages, enough to distinguish different values.
struct Digits {
    frequency: usize,
    energy: usize,
    amplitude: usize,
    peak: usize,
}

impl Digits {
    fn of(passages: &[Passage]) -> Self {
        let of = |value: fn(&Passage) -> f64| apart(&passages.iter().map(value).collect::<Vec<_>>());
        Self {
            frequency: of(|passage| passage.frequency_hz),
            energy: of(|passage| passage.energy_j),
            amplitude: of(|passage| passage.modal_amplitude),
            peak: of(|passage| passage.peak_m),
        }
    }
}

fn of_passage(passage: &Passage, digits: &Digits, has_contacts: bool) -> String {
    let place = match passage.points {
        [a, b] if a == b => format!("point {a}"),
        [a, b] => format!("between points {a} and {b}"),
    };
    let mut what = vec![
        format!("{} Hz", rounded(passage.frequency_hz, digits.frequency)),
        format!("{} J", rounded(passage.energy_j, digits.energy)),
    ];
    what.push(match passage.modal_amplitude {
        0.0 => "modal amplitude 0: the fundamental takes no part".to_owned(),
        amplitude => format!("modal amplitude {} m √kg", rounded(amplitude, digits.amplitude)),
    });
    what.push(format!("largest displacement toward stop 0: {} m", rounded(passage.peak_m, digits.peak)));
    let of_level =
        |level| format!("level {} {}", short(level), passage.level_unit.unwrap_or("in the unit of its load"));
    what.extend(passage.level.map(of_level));
    what.push(
        match passage.stable {
            [Some(true), Some(true)] => "stable",
            [Some(false), Some(false)] => "unstable",
            [Some(_), Some(_)] => "the stability changes between them",
            [None, None] => "its stability was not found out",
            [None, Some(_)] | [Some(_), None] => "its stability was found out at one of the points only",
        }
        .to_owned(),
    );
    let mut text = format!("\n  {place}: {}\n", what.join(", "));
    let names = ["event", "events"];
    let events: Vec<String> = std::iter::zip(passage.points, &passage.events)
        .take(if passage.points[0] == passage.points[1] { 1 } else { 2 })
        .filter(|(_, events)| !events.is_empty())
        .map(|(point, events)| format!("{} at point {point}: {events}", names[usize::from(events.contains(' '))]))
        .collect();
    if !events.is_empty() {
        text += &format!("  {}\n", events.join("; "));
    }
    if passage.contacts.is_empty() {
        let why = match has_contacts {
            true => "contacts.csv beside the table has no rows of these points, it is cut or of another run",
            false => "there is no contacts.csv beside the table",
        };
        return text + &format!("  {why}: nothing is known of single stops\n");
    }
    let head = ["stop", "share", "impulse, N s", "mean force, N", "largest force, N", "touches", "approach, m/s"];
    text += &format!(
        "    {:>4}{:>12}{:>14}{:>15}{:>18}{:>9}{:>15}\n",
        head[0], head[1], head[2], head[3], head[4], head[5], head[6]
    );
    passage.contacts.iter().for_each(|stop| text += &of_stop(stop));
    text + &largest(&passage.contacts)
}

fn of_stop(stop: &StopValues) -> String {
    let touches = match stop.touches {
        [a, b] if a == b => a.to_string(),
        [a, b] => format!("{a} or {b}"),
    };
    let [share, impulse, mean, peak, approach] =
        [stop.contact_fraction, stop.impulse_ns, stop.mean_force_n, stop.peak_force_n, stop.approach_velocity_m_s]
            .map(short);
    format!("    {:>4}{share:>12}{impulse:>14}{mean:>15}{peak:>18}{touches:>9}{approach:>15}\n", stop.contact)
}

/// Which of several stops carries most.
fn largest(stops: &[StopValues]) -> String {
    let most = |of: fn(&StopValues) -> f64| {
        stops.iter().max_by(|a, b| of(a).total_cmp(&of(b))).filter(|stop| of(stop) > 0.0).map(|stop| stop.contact)
    };
    match (most(|stop| stop.impulse_ns), most(|stop| stop.peak_force_n)) {
        _ if stops.len() < 2 => String::new(),
        (None, _) | (_, None) => "  no stop is touched\n".to_owned(),
        (Some(a), Some(b)) if a == b => format!("  stop {a} has the largest impulse and the largest force\n"),
        (Some(a), Some(b)) => format!("  stop {a} has the largest impulse, stop {b} the largest force\n"),
    }
}

/// Significant digits of a number alone.
const FEWEST: usize = 6;
/// Maximum number of significant digits; further ones are rounding.
const MOST: usize = 12;

/// The least number of significant digits, [`FEWEST`] to [`MOST`], by which no two different values look alike.
fn apart(values: &[f64]) -> usize {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let look_alike = |digits: usize| {
        sorted.windows(2).any(|pair| {
            let are_one = rounded(pair[0], MOST) == rounded(pair[1], MOST);
            !are_one && rounded(pair[0], digits) == rounded(pair[1], digits)
        })
    };
    (FEWEST..MOST).find(|digits| !look_alike(*digits)).unwrap_or(MOST)
}

/// A number with this many significant digits, or fewer if the last ones are zero.
fn rounded(x: f64, digits: usize) -> String {
    if x.is_nan() {
        "-".to_owned()
    } else {
        format!("{x:.0$e}", digits - 1).parse().map_or_else(|_| x.to_string(), exact)
    }
}

/// A number in as many digits as it has.
fn exact(x: f64) -> String {
    let text = number(x);
    if text.parse() == Ok(x) { text } else { format!("{x:?}") }
}

/// A number with [`FEWEST`] significant digits.
fn short(x: f64) -> String {
    rounded(x, FEWEST)
}
