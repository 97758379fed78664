//! Problems of strings and stops with known solutions, at all sizes.

use nlmodes_linalg::Mat;

use super::Case;

const SIZES: [usize; 5] = [2, 10, 50, 200, 1000];

pub(super) fn cases(at_most: usize) -> Vec<Case> {
    let mut all: Vec<Case> = [10, 50, 200].into_iter().filter(|n| *n <= at_most).map(obstacle).collect();
    for c in SIZES.into_iter().filter(|c| *c <= at_most) {
        all.extend([all_open(c), all_closed(c), row_of_stops(c), stiff(c)]);
    }
    all
}

/// Compliance of a long string on springs at equally spaced points, m/N.
fn compliance(c: usize) -> Mat<f64> {
    Mat::from_fn(c, c, |i, j| (-0.2 * i.abs_diff(j) as f64).exp())
}

fn all_open(c: usize) -> Case {
    Case::with_solution(format!("all open, {c}"), compliance(c), &vec![0.0; c], &vec![1.0; c])
}

fn all_closed(c: usize) -> Case {
    let forces: Vec<f64> = (0..c).map(|i| 1.5 + (i as f64).sin()).collect();
    Case::with_solution(format!("all closed, {c}"), compliance(c), &forces, &vec![0.0; c])
}

/// Groups of closed and of open contacts, and single contacts at which gap and force both vanish.
fn row_of_stops(c: usize) -> Case {
    let wave = |i: usize| (0.9 * i as f64).sin();
    let part = |sign: f64, i: usize| if i.is_multiple_of(5) { 0.0 } else { (sign * wave(i)).max(0.0) };
    let forces: Vec<f64> = (0..c).map(|i| part(1.0, i)).collect();
    let gaps: Vec<f64> = (0..c).map(|i| part(-1.0, i)).collect();
    Case::with_solution(format!("row of stops, {c}"), compliance(c), &forces, &gaps)
}

/// The same with 1e13 N/m and micrometres, every third contact in very different units.
fn stiff(c: usize) -> Case {
    let unit = |i: usize| if i.is_multiple_of(3) { 1e-3 } else { 1e-6 } * 3.16e-7f64;
    row_of_stops(c).in_units(format!("units far apart, {c}"), unit)
}

/// A string of `n` elements pressed onto a flat obstacle by a uniform load: the middle three quarters are in contact,
/// with a parabola on either side. Lumped loads make the nodal values exact.
fn obstacle(n: usize) -> Case {
    let c = n - 1;
    let h = 1.0 / n as f64;
    let reach = (n / 8).max(1) as f64 * h;
    let at = |i: usize| (i + 1) as f64 * h;
    let depth = |i: usize| (reach - at(i).min(1.0 - at(i))) / h;
    let green = Mat::from_fn(c, c, |i, j| at(i.min(j)) * (1.0 - at(i.max(j))));
    let force = |i: usize| match depth(i).round() {
        d if d < 0.0 => h,
        0.0 => 0.5 * h,
        _ => 0.0,
    };
    let gap = |i: usize| if depth(i) > 0.5 { 0.5 * (depth(i) * h).powi(2) } else { 0.0 };
    let (forces, gaps): (Vec<f64>, Vec<f64>) = (0..c).map(|i| (force(i), gap(i))).unzip();
    Case::with_solution(format!("obstacle, {n}"), green, &forces, &gaps)
}
