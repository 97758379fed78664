//! Passages in words.

use std::path::Path;

use nlmodes_scene::number;

use super::{Abscissa, Curve, Passage, StopValues};

/// What is found at a value of the results in this directory, in words.
pub fn text(results: &Path, abscissa: Abscissa, value: f64, curves: &[Curve]) -> String {
    let here = quantity(abscissa, value);
    let mut text = String::new();
    let told: Vec<&Curve> = curves.iter().filter(|c| !c.passages.is_empty() || !c.left_out.is_empty()).collect();
    for (k, curve) in told.iter().enumerate() {
        let table = curve.table.strip_prefix(results).unwrap_or(&curve.table);
        let name = curve.name.as_ref().map(|name| format!(", {name}")).unwrap_or_default();
        let times = match curve.passages.len() {
            0 => "is left out".to_owned(),
            1 => "is passed once".to_owned(),
            n => format!("is passed {n} times, each with another motion"),
        };
        text += &format!("{}{name}: {here} {times}\n", table.display());
        for [from, to] in &curve.left_out {
            text += &format!(
                "\n  between points {from} and {to} a tongue was left out, and {here} lies in it: nothing is known there\n"
            );
        }
        curve.passages.iter().for_each(|passage| text += &of_passage(passage));
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
        let (low, high) = (quantity(abscissa, low), quantity(abscissa, high));
        return format!("{}: {here} is not passed; {points} points lie between {low} and {high}\n", results.display());
    }
    text + "Between points values are interpolated along the branch by cubic pieces that go beyond none of the two. Largest forces of short blows need not converge with\nharmonics, impulses do.\n"
}

fn quantity(abscissa: Abscissa, value: f64) -> String {
    let unit = match abscissa {
        Abscissa::FrequencyHz => "Hz",
        Abscissa::EnergyJ => "J",
    };
    format!("{} {unit}", short(value))
}

fn of_passage(passage: &Passage) -> String {
    let place = match passage.points {
        [a, b] if a == b => format!("point {a}"),
        [a, b] => format!("between points {a} and {b}"),
    };
    let mut what = vec![format!("{} Hz", short(passage.frequency_hz)), format!("{} J", short(passage.energy_j))];
    what.push(format!("modal amplitude {} m √kg", short(passage.modal_amplitude)));
    what.push(format!("largest displacement at stop 0 {} m", short(passage.peak_m)));
    what.extend(passage.level.map(|level| format!("level {}", short(level))));
    what.extend(match passage.stable {
        [Some(true), Some(true)] => Some("stable".to_owned()),
        [Some(false), Some(false)] => Some("unstable".to_owned()),
        [Some(_), Some(_)] => Some("the stability changes between them".to_owned()),
        _ => None,
    });
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
        return text + "  there is no contacts.csv beside the table: nothing is known of single stops\n";
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

/// Six significant digits.
fn short(x: f64) -> String {
    if x.is_nan() { "-".to_owned() } else { format!("{x:.5e}").parse().map_or_else(|_| x.to_string(), number) }
}
