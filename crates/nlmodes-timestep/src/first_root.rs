//! The first instant at which one of several smooth functions becomes negative: none is missed.

use crate::bracket::falls_below_zero;

/// A smooth function of time that a polynomial of second degree approximates within bounds.
pub(crate) trait Guard {
    /// What all functions that are watched together share in one cell.
    type Shared: Default;

    /// What is computed once for all cells.
    type Bounds;

    /// What the bounds in each cell follow from; none for a function that is not finite.
    fn bounds(&self) -> Option<Self::Bounds>;

    /// What is shared in the cell of half-width `r` about `middle`.
    fn share(&self, middle: f64, r: f64, shared: &mut Self::Shared);

    /// The function in the cell of `shared`.
    fn approximate(&self, bounds: &Self::Bounds, shared: &Self::Shared) -> Approximation;

    /// The function, its first and second derivative.
    fn evaluate(&self, t: f64) -> [f64; 3];

    /// Scale of its rounding errors.
    fn size(&self) -> f64;
}

/// A function within a cell.
pub(crate) struct Approximation {
    /// Value, slope and curvature of a polynomial of second degree in the middle of the cell.
    pub polynomial: [f64; 3],
    /// Bounds of the differences of the function, its slope and its curvature from those of the polynomial.
    pub differences: [f64; 3],
}

impl Approximation {
    /// A Taylor polynomial of a function whose third derivative is bounded by `third` in a cell of half-width `r`.
    pub fn taylor(polynomial: [f64; 3], third: f64, r: f64) -> Self {
        Self { polynomial, differences: [third * r * r * r / 6.0, 0.5 * third * r * r, third * r] }
    }
}

/// Information on the sign of a guard within a cell.
enum Cell {
    /// Never negative.
    Quiet,
    /// First negative just beyond this instant.
    Leaves(f64),
    /// Not yet decided.
    Unclear,
}

/// Smallest `t` in `[0, end]` at which one of these guards, none of them negative at 0, becomes negative, and the index
/// of that guard.
///
/// A cell has no root if the polynomial of a guard exceeds the bound of its difference from it; if the guard is proven
/// to be monotone or of one curvature in it, its ends or its extremum decide; otherwise it is halved. Thus no pair of
/// roots is missed, however close, and grazing is decided by the value at the extremum. Values above minus a few
/// rounding errors of its size also count as no root: a guard may be zero all the time.
///
/// The guards go through the cells together, in the order of time: what they share is computed once a cell, and no cell
/// behind the first root is examined.
pub(crate) fn first_negative<G: Guard>(guards: &[G], end: f64) -> Option<(f64, usize)> {
    let bounds: Vec<Option<G::Bounds>> = guards.iter().map(G::bounds).collect();
    let noises: Vec<f64> = guards.iter().map(|f| 4.0 * f64::EPSILON * f.size()).collect();
    let bounded: Vec<usize> = (0..guards.len()).filter(|&i| bounds[i].is_some() && noises[i].is_finite()).collect();
    let resolution = 2.0 * f64::EPSILON * end;
    let (mut cells, mut shared) = (vec![(0.0, end, bounded)], G::Shared::default());
    let mut first: Option<(f64, usize)> = None;
    while let Some((from, to, undecided)) = cells.pop() {
        if first.is_some_and(|(t, _)| t <= from) {
            break;
        }
        let middle = 0.5 * (from + to);
        let mut halved = Vec::new();
        if let Some(&i) = undecided.first() {
            guards[i].share(middle, 0.5 * (to - from), &mut shared);
        }
        for i in undecided {
            let (f, Some(bounds)) = (&guards[i], &bounds[i]) else { continue };
            let leaves = match judge(f, (from, to), f.approximate(bounds, &shared), noises[i]) {
                Cell::Quiet => None,
                Cell::Leaves(t) => Some(t),
                Cell::Unclear if to - from <= resolution => (f.evaluate(to)[0] < -noises[i]).then_some(to),
                Cell::Unclear => {
                    halved.push(i);
                    None
                }
            };
            if let Some(t) = leaves
                && first.is_none_or(|(earliest, _)| t < earliest)
            {
                first = Some((t, i));
            }
        }
        if !halved.is_empty() {
            cells.extend([(middle, to, halved.clone()), (from, middle, halved)]);
        }
    }
    first
}

/// Information on the guard `f` in a cell, with its rounding errors `noise`.
fn judge(f: &impl Guard, (from, to): (f64, f64), within: Approximation, noise: f64) -> Cell {
    let r = 0.5 * (to - from);
    let Approximation { polynomial: [value, slope, curvature], differences: [of_value, of_slope, of_curvature] } =
        within;
    if lowest(value, slope, curvature, r) + noise >= of_value {
        return Cell::Quiet;
    }
    let at_end = || if f.evaluate(to)[0] < 0.0 { Cell::Leaves(root(f, 0, from, to)) } else { Cell::Quiet };
    if slope.abs() > curvature.abs() * r + of_slope {
        return if slope > 0.0 { Cell::Quiet } else { at_end() };
    }
    if curvature > of_curvature {
        let lowest = lowest_of_convex(f, from, to);
        return if f.evaluate(lowest)[0] < 0.0 { Cell::Leaves(root(f, 0, from, lowest)) } else { Cell::Quiet };
    }
    if -curvature > of_curvature {
        return at_end();
    }
    Cell::Unclear
}

/// Where a convex function is lowest between `from` and `to`.
pub(crate) fn lowest_of_convex(f: &impl Guard, from: f64, to: f64) -> f64 {
    match (f.evaluate(from)[1] < 0.0, f.evaluate(to)[1] > 0.0) {
        (false, _) => from,
        (true, false) => to,
        (true, true) => root(f, 1, from, to),
    }
}

/// Where the derivative of the given order changes sign between `from` and `to`: f decreases through zero, f' increases
/// through it.
pub(crate) fn root(f: &impl Guard, order: usize, from: f64, to: f64) -> f64 {
    let sign = if order == 0 { 1.0 } else { -1.0 };
    let value_and_slope = |t: f64| {
        let at = f.evaluate(t);
        [sign * at[order], sign * at[order + 1]]
    };
    falls_below_zero(value_and_slope, from, to)
}

/// Smallest value of `value + slope s + ½ curvature s²` for `|s| ≤ r`.
fn lowest(value: f64, slope: f64, curvature: f64, r: f64) -> f64 {
    let at_ends = value - slope.abs() * r + 0.5 * curvature * r * r;
    if curvature > 0.0 && slope.abs() < curvature * r { value - 0.5 * slope * slope / curvature } else { at_ends }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_lowest_at_its_vertex_or_at_an_end() {
        assert_eq!(lowest(1.0, 0.5, 4.0, 1.0), 1.0 - 0.5 * 0.25 / 4.0);
        assert_eq!(lowest(1.0, 0.5, 0.2, 1.0), 1.0 - 0.5 + 0.1);
        assert_eq!(lowest(1.0, -0.5, -0.2, 1.0), 1.0 - 0.5 - 0.1);
    }
}
