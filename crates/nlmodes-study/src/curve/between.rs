//! Values between the points of a branch.

use std::ops::Range;

use nlmodes::modal::Event;

use super::Curve;

/// Events at which a branch has a kink: no smooth curve passes through them.
const CORNERS: [Event; 5] = [Event::Kink, Event::BranchPoint, Event::ContactChange, Event::Grazing, Event::LiftOff];

/// A value between points, with the result of lower-order interpolation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Between {
    /// The value.
    pub value: f64,
    /// Estimate of its error: the difference from a chord or parabola.
    pub error: f64,
}

/// The value of `y` where `x` first has the value `target` along the branch; `None` if it never has.
///
/// Interpolation by a polynomial through six points, over the length of the chords, on one side of any kink; its error
/// is estimated by the difference from the cubic through four of them.
pub fn at_first(curve: &Curve, x: &[f64], y: &[f64], target: f64) -> Option<Between> {
    // Limits are reached only to rounding.
    let is_met = |value: &f64| (value - target).abs() <= 1e-12 * target.abs();
    let met = x.iter().position(is_met);
    let crossed = x.windows(2).position(|w| (w[0] < target) != (w[1] < target) && w[0].is_finite() && w[1].is_finite());
    match (met, crossed) {
        (Some(point), None) => Some(Between { value: y[point], error: 0.0 }),
        (Some(point), Some(before)) if point <= before + 1 => Some(Between { value: y[point], error: 0.0 }),
        (_, Some(before)) => interpolate(curve, x, y, target, before),
        (None, None) => None,
    }
}

/// The slope `dy/dx` of the same curve where `x` first has the value `target`; `None` if it never has, or `x` turns
/// there.
pub fn slope_at_first(curve: &Curve, x: &[f64], y: &[f64], target: f64) -> Option<f64> {
    let is_within = |w: &[f64]| (w[0] - target) * (w[1] - target) <= 0.0 && w[0] != w[1];
    let before = x.windows(2).position(is_within)?;
    let (from, to) = smooth_range(curve, before);
    let places = chords(&x[from..=to], &y[from..=to]);
    let (x, y, k) = (&x[from..=to], &y[from..=to], before - from);
    if x.iter().chain(y).chain(&places).any(|value| !value.is_finite()) || x.len() < 3 {
        return Some((y[k + 1] - y[k]) / (x[k + 1] - x[k]));
    }
    let s = root(|s| lagrange(&places, x, s) - target, places[k], places[k + 1]);
    let slope = lagrange_slope(&places, y, s) / lagrange_slope(&places, x, s);
    slope.is_finite().then_some(slope)
}

/// Points on either side of the largest one through which a polynomial is laid.
const AROUND: usize = 2;

/// The largest value of `y` along the branch: of the polynomial through the largest point and up to two on each side,
/// over the length of the chords, none beyond a corner; the error is what that adds, or its
/// difference from the parabola through three.
pub fn largest_between(curve: &Curve, x: &[f64], y: &[f64]) -> Option<Between> {
    let k = (0..y.len()).filter(|k| y[*k].is_finite()).max_by(|a, b| y[*a].total_cmp(&y[*b]))?;
    let is_corner = |point: usize| curve.events()[point].iter().any(|event| CORNERS.contains(event));
    let is_sound = |point: usize| x[point].is_finite() && y[point].is_finite();
    let reach = |step: isize| {
        let on_the_way = (1..=AROUND).map_while(|n| k.checked_add_signed(step * n as isize).filter(|j| *j < y.len()));
        let mut count = 0;
        for point in on_the_way.take_while(|point| is_sound(*point)) {
            count += 1;
            if is_corner(point) {
                break;
            }
        }
        count
    };
    let [below, above] = [reach(-1), reach(1)];
    if is_corner(k) || below == 0 || above == 0 {
        return Some(Between { value: y[k], error: 0.0 });
    }
    // Beside the spans of the whole branch: within a peak the values hardly differ, and would bend the length.
    let spans = [span(x), span(y)];
    let most = |below: usize, above: usize| {
        let (x, y) = (&x[k - below..=k + above], &y[k - below..=k + above]);
        let places = chords_of_spans(x, y, spans);
        let value = |s: f64| lagrange(&places, y, s);
        let (mut low, mut high) = (places[below - 1], places[below + 1]);
        for _ in 0..200 {
            let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            if value(a) < value(b) { low = a } else { high = b }
        }
        value(0.5 * (low + high)).max(y[below])
    };
    let (parabola, whole) = (most(1, 1), most(below, above));
    // Between few points of a sharp peak both polynomials err alike.
    let error = (whole - parabola).abs().max(whole - y[k]);
    Some(Between { value: whole, error })
}

fn interpolate(curve: &Curve, x: &[f64], y: &[f64], target: f64, before: usize) -> Option<Between> {
    let (from, to) = smooth_range(curve, before);
    let places = chords(&x[from..=to], &y[from..=to]);
    let (x, y, k) = (&x[from..=to], &y[from..=to], before - from);
    let chord = (target - x[k]) / (x[k + 1] - x[k]);
    let straight = y[k] + chord * (y[k + 1] - y[k]);
    if x.iter().chain(y).chain(&places).any(|value| !value.is_finite()) || x.len() < 3 {
        return Some(Between { value: straight, error: (y[k + 1] - y[k]).abs() });
    }
    let (low, high) = (places[k], places[k + 1]);
    let of = |points: Range<usize>| {
        let places = &places[points.clone()];
        let s = root(|s| lagrange(places, &x[points.clone()], s) - target, low, high);
        lagrange(places, &y[points], s)
    };
    let value = of(0..x.len());
    let lower = lower_order(&places, k);
    let error = if lower.len() > 2 { (value - of(lower)).abs() } else { (value - straight).abs() };
    Some(Between { value, error })
}

/// The points of a polynomial of lower order around the interval behind `k`: one fewer on either side, or where there
/// is none on one of them, without the farther end.
fn lower_order(places: &[f64], k: usize) -> Range<usize> {
    let last = places.len() - 1;
    let [before, after] = [k, last - (k + 1)];
    match (before, after) {
        (0, 0) => 0..last + 1,
        (0, _) => 0..last,
        (_, 0) => 1..last + 1,
        (1, 1) if places[last] - places[k + 1] < places[k] - places[0] => 1..last + 1,
        (1, 1) => 0..last,
        _ => 1..last,
    }
}

/// Most points on either side of an interval beside its ends.
const NEIGHBOURS: usize = 2;

/// First and last of up to six points around the interval after `before`, none beyond a kink.
fn smooth_range(curve: &Curve, before: usize) -> (usize, usize) {
    let is_corner = |point: usize| curve.events()[point].iter().any(|event| CORNERS.contains(event));
    let (mut from, mut to) = (before, before + 1);
    for _ in 0..NEIGHBOURS {
        from -= usize::from(from > 0 && !is_corner(from));
        to += usize::from(to + 1 < curve.len() && !is_corner(to));
    }
    (from, to)
}

/// Lengths along the chords from the first point, each coordinate relative to its span.
fn chords(x: &[f64], y: &[f64]) -> Vec<f64> {
    chords_of_spans(x, y, [span(x), span(y)])
}

/// Largest less smallest value that is a number; one where there is no such.
fn span(values: &[f64]) -> f64 {
    let finite = values.iter().filter(|v| v.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]);
    if high > low { high - low } else { 1.0 }
}

fn chords_of_spans(x: &[f64], y: &[f64], [of_x, of_y]: [f64; 2]) -> Vec<f64> {
    let mut places = vec![0.0];
    for (x, y) in x.windows(2).zip(y.windows(2)) {
        let step = ((x[1] - x[0]) / of_x).hypot((y[1] - y[0]) / of_y);
        places.push(places.last().copied().unwrap_or(0.0) + step);
    }
    places
}

/// The polynomial through the points at `s`.
fn lagrange(places: &[f64], values: &[f64], s: f64) -> f64 {
    let term = |(i, value): (usize, &f64)| {
        let others = places.iter().enumerate().filter(|(j, _)| *j != i);
        others.fold(*value, |product, (_, place)| product * (s - place) / (places[i] - place))
    };
    values.iter().enumerate().map(term).sum()
}

/// The slope of the polynomial through the points at `s`.
fn lagrange_slope(places: &[f64], values: &[f64], s: f64) -> f64 {
    let term = |(i, value): (usize, &f64)| {
        let others = || (0..places.len()).filter(|j| *j != i);
        let without = |j: usize| others().filter(|m| *m != j).map(|m| s - places[m]).product::<f64>();
        let below: f64 = others().map(|j| places[i] - places[j]).product();
        value * others().map(without).sum::<f64>() / below
    };
    values.iter().enumerate().map(term).sum()
}

/// A zero between two points with different signs, by bisection.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let rises = f(low) < f(high);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if (f(middle) < 0.0) == rises { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A smooth branch with a fold in x: x = 1 + t − t² / 2, y = sin t, the grid as fine as `n`.
    fn curve(n: usize, events: impl Fn(usize) -> &'static str) -> (Curve, Vec<f64>, Vec<f64>) {
        let mut text = String::from("point,energy_j,frequency_hz,event\n");
        for k in 0..=n {
            let t = 2.0 * k as f64 / n as f64;
            text += &format!("{k},{:?},{:?},{}\n", 1.0 + t - 0.5 * t * t, t.sin(), events(k));
        }
        let curve = Curve::from_csv(text.as_bytes(), 1.0).unwrap();
        let column = |name: &str| curve.column(name).unwrap().to_vec();
        let (x, y) = (column("energy_j"), column("frequency_hz"));
        (curve, x, y)
    }

    #[test]
    fn the_error_falls_with_the_sixth_power_of_the_distance_and_is_estimated() {
        // 1.3 = 1 + t − t²/2 first at t = 1 − √0.4.
        let exact = (1.0 - 0.4f64.sqrt()).sin();
        let errors: Vec<[f64; 2]> = [10, 20, 40, 80]
            .map(|n| {
                let (curve, x, y) = curve(n, |_| "");
                let found = at_first(&curve, &x, &y, 1.3).unwrap();
                [(found.value - exact).abs(), found.error]
            })
            .to_vec();
        assert!(errors.iter().all(|[error, estimate]| error <= estimate), "{errors:?}");
        assert!(errors[0][0] < 3e-4 && errors[3][0] < errors[0][0] / 1e5, "{errors:?}");
    }

    #[test]
    fn the_slope_is_that_of_the_curve() {
        // dy/dx = cos t/(1 − t) at t = 1 − √0.4.
        let exact = (1.0 - 0.4f64.sqrt()).cos() / 0.4f64.sqrt();
        let errors = [20, 40, 80].map(|n| {
            let (curve, x, y) = curve(n, |_| "");
            (slope_at_first(&curve, &x, &y, 1.3).unwrap() - exact).abs()
        });
        assert!(errors[0] < 1e-2 && errors[2] < errors[0] / 30.0, "{errors:?}");
        let (curve, x, y) = curve(80, |_| "");
        assert!(
            (slope_at_first(&curve, &x, &y, x[7]).unwrap() / ((7f64 / 40.0).cos() / (1.0 - 7.0 / 40.0)) - 1.0).abs()
                < 1e-4
        );
        assert_eq!(slope_at_first(&curve, &x, &y, 1.6), None);
    }

    #[test]
    fn values_at_points_are_those_of_the_points_and_none_is_invented() {
        let (curve, x, y) = curve(10, |_| "");
        assert_eq!(at_first(&curve, &x, &y, x[3]), Some(Between { value: y[3], error: 0.0 }));
        assert_eq!(at_first(&curve, &x, &y, x[0]).unwrap().value, y[0]);
        assert_eq!(at_first(&curve, &x, &y, 1.6), None);
        assert_eq!(at_first(&curve, &x, &y, 0.9), None);
    }

    #[test]
    fn a_peak_between_points_is_found_and_its_error_is_estimated() {
        // y = sin t has its peak 1 at t = π/2, between points of each of these grids.
        let errors: Vec<[f64; 2]> = [11, 23, 47]
            .map(|n| {
                let (curve, x, y) = curve(n, |_| "");
                let found = largest_between(&curve, &x, &y).unwrap();
                [(found.value - 1.0).abs(), found.error]
            })
            .to_vec();
        assert!(errors.iter().all(|[error, estimate]| error <= estimate), "{errors:?}");
        assert!(errors[0][0] < 1e-3 && errors[2][0] < 1e-6, "{errors:?}");
        // Not at an end, and not beside a corner.
        let (curve, x, y) = curve(10, |_| "kink");
        let highest = y.iter().copied().fold(0.0, f64::max);
        assert_eq!(largest_between(&curve, &x, &y).unwrap(), Between { value: highest, error: 0.0 });
    }

    #[test]
    fn no_curve_is_laid_through_a_corner() {
        let (smooth, x, y) = curve(10, |_| "");
        let (cornered, ..) = curve(10, |k| if k == 1 || k == 2 { "kink" } else { "" });
        let target = 0.5 * (x[1] + x[2]);
        let straight = 0.5 * (y[1] + y[2]);
        assert!((at_first(&cornered, &x, &y, target).unwrap().value - straight).abs() < 1e-14);
        assert!((at_first(&smooth, &x, &y, target).unwrap().value - straight).abs() > 1e-4);
    }
}
