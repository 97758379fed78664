use crate::unit::superscript;

/// A thin space, used on both sides of a multiplication sign.
const THIN: char = '\u{2009}';

/// A mark on an axis; without a label between the labelled ones.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub value: f64,
    pub label: Option<String>,
}

/// Multiples of 1, 2 or 5 times a power of ten, about `target` of them, with sufficient decimals to distinguish them.
pub(crate) fn linear_ticks(low: f64, high: f64, target: usize) -> Vec<Tick> {
    let Some(step) = nice_step(low, high, target) else { return Vec::new() };
    let size = low.abs().max(high.abs());
    let label = |value: f64| if (1e-4..1e6).contains(&size) { fixed(value, step) } else { power(value, step, size) };
    multiples(low, high, step).map(|value| Tick { value, label: Some(label(value)) }).collect()
}

/// Decades if there are several, otherwise 1, 2, 5 times a power of ten, otherwise as on a linear axis.
pub(crate) fn logarithmic_ticks(low: f64, high: f64, target: usize) -> Vec<Tick> {
    let decades = (high / low).log10();
    if !decades.is_finite() || decades <= 0.0 {
        return Vec::new();
    }
    let every = (decades / target.max(1) as f64).ceil() as i32;
    let sets: [&[u32]; 3] = [&[1], &[1, 2, 5], &[1, 2, 3, 4, 6, 8]];
    let labelled = |set: &&[u32]| powers(low, high).filter(|(m, n)| set.contains(m) && n % every == 0).count() >= 3;
    match sets.into_iter().find(labelled) {
        Some(set) => powers(low, high).map(|(m, n)| power_tick(m, n, set, every, (low, high))).collect(),
        None => linear_ticks(low, high, target),
    }
}

/// All `m · 10ⁿ` within the ends, `m` from 1 to 9.
fn powers(low: f64, high: f64) -> impl Iterator<Item = (u32, i32)> {
    let exponents = low.log10().floor() as i32..=high.log10().floor() as i32;
    exponents
        .flat_map(|n| (1..=9).map(move |m| (m, n)))
        .filter(move |(m, n)| (low..=high).contains(&(f64::from(*m) * 10f64.powi(*n))))
}

fn power_tick(m: u32, n: i32, set: &[u32], every: i32, (low, high): (f64, f64)) -> Tick {
    let value = f64::from(m) * 10f64.powi(n);
    let label = match m {
        _ if low >= 0.999e-3 && high < 1e5 => fixed(value, 10f64.powi(n)),
        1 => format!("10{}", superscript(n)),
        _ => format!("{m}{THIN}×{THIN}10{}", superscript(n)),
    };
    Tick { value, label: (set.contains(&m) && n % every == 0).then_some(label) }
}

/// A number with three digits: `4.97`, `1.24×10⁹`.
pub(crate) fn scientific(value: f64) -> String {
    let size = value.abs();
    let step = 10f64.powf(size.log10().floor() - 2.0);
    match size {
        _ if value == 0.0 || !value.is_finite() => value.to_string(),
        0.01..1e4 => fixed(value, step),
        _ => power(value, step, size),
    }
}

fn nice_step(low: f64, high: f64, target: usize) -> Option<f64> {
    let rough = (high - low) / target.max(1) as f64;
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * decade).into_iter().find(|step| *step >= 0.999 * rough)?;
    // A step below floating-point resolution would repeat the same tick.
    (step.is_normal() && step > 4.0 * f64::EPSILON * low.abs().max(high.abs())).then_some(step)
}

fn multiples(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let tolerance = 1e-9;
    let (first, last) = ((low / step - tolerance).ceil(), (high / step + tolerance).floor());
    (0..=(last - first) as usize).map(move |k| (first + k as f64) * step)
}

/// With as many decimals as `step` has.
fn fixed(value: f64, step: f64) -> String {
    let decimals = (-(step * 1.000_001).log10().floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        text.trim_start_matches('-').into()
    } else {
        text.replace('-', "−")
    }
}

/// As a multiple of the power of ten of `size`.
fn power(value: f64, step: f64, size: f64) -> String {
    let exponent = size.log10().floor();
    let scale = 10f64.powf(exponent);
    if value == 0.0 {
        "0".into()
    } else {
        format!("{}{THIN}×{THIN}10{}", fixed(value / scale, step / scale), superscript(exponent as i32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().filter_map(|tick| tick.label.as_deref()).collect()
    }

    #[test]
    fn narrow_frequency_range_is_labelled_in_full() {
        let ticks = linear_ticks(60.7863, 60.7869, 4);
        assert_eq!(labels(&ticks), ["60.7864", "60.7866", "60.7868"]);
    }

    #[test]
    fn zero_has_no_sign_and_negative_numbers_a_minus() {
        assert_eq!(labels(&linear_ticks(-0.31, 0.3, 4)), ["−0.2", "0.0", "0.2"]);
    }

    #[test]
    fn several_decades_are_labelled_as_powers() {
        assert_eq!(labels(&logarithmic_ticks(3e6, 2e9, 6)), ["10⁷", "10⁸", "10⁹"]);
    }

    #[test]
    fn less_than_a_decade_is_labelled_between() {
        assert_eq!(labels(&logarithmic_ticks(8e8, 6e9, 6)), ["10⁹", "2\u{2009}×\u{2009}10⁹", "5\u{2009}×\u{2009}10⁹"]);
        assert_eq!(labels(&logarithmic_ticks(0.15, 2.5, 6)), ["0.2", "0.5", "1", "2"]);
        assert!(labels(&logarithmic_ticks(8.1e8, 8.6e8, 5)).len() >= 3);
    }

    #[test]
    fn forty_decades_do_not_crowd_the_axis() {
        assert!(labels(&logarithmic_ticks(1e-30, 1e10, 8)).len() <= 9);
    }

    #[test]
    fn range_beyond_the_doubles_has_no_ticks() {
        assert!(linear_ticks(1.0, 1.0, 5).is_empty());
        assert!(linear_ticks(1.0, 1.0 + f64::EPSILON, 5).is_empty());
        assert!(linear_ticks(f64::NAN, 1.0, 5).is_empty());
        assert!(logarithmic_ticks(0.0, 1.0, 5).is_empty());
    }

    #[test]
    fn three_digits_are_enough_for_a_title() {
        assert_eq!(scientific(8.150_553e8), "8.15\u{2009}×\u{2009}10⁸");
        assert_eq!(scientific(2.076), "2.08");
        assert_eq!(scientific(0.0), "0");
        assert_eq!(scientific(f64::NAN), "NaN");
    }
}
