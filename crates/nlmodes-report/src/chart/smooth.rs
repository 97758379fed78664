//! Curves between computed points: cubic pieces without overshoot.

use nlmodes_modal::monotone_slopes;

/// The two inner control points of the cubic Bézier piece from each point to the next, in the plane of the picture.
///
/// Both coordinates are interpolated over the length of the chords by cubic Hermite polynomials with the slopes of
/// Steffen (1990): between two points neither coordinate leaves the interval of its values there, so nothing is shown
/// that was not computed. At `corners` (indices of points) the slopes on either side are independent.
pub(super) fn controls(points: &[(f64, f64)], corners: &[usize]) -> Vec<[(f64, f64); 2]> {
    let mut found = Vec::with_capacity(points.len().saturating_sub(1));
    let mut start = 0;
    let ends = corners.iter().copied().filter(|corner| (1..points.len().max(1) - 1).contains(corner));
    for end in ends.chain([points.len().saturating_sub(1)]) {
        if end > start {
            found.extend(pieces(&points[start..=end]));
            start = end;
        }
    }
    found
}

fn pieces(points: &[(f64, f64)]) -> Vec<[(f64, f64); 2]> {
    let chords: Vec<f64> = points.windows(2).map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1).max(1e-9)).collect();
    let x = monotone_slopes(&points.iter().map(|p| p.0).collect::<Vec<_>>(), &chords);
    let y = monotone_slopes(&points.iter().map(|p| p.1).collect::<Vec<_>>(), &chords);
    let piece = |(k, chord): (usize, &f64)| {
        let ((x0, y0), (x1, y1), third) = (points[k], points[k + 1], chord / 3.0);
        [(x0 + third * x[k], y0 + third * y[k]), (x1 - third * x[k + 1], y1 - third * y[k + 1])]
    };
    chords.iter().enumerate().map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn at(points: &[(f64, f64)], controls: &[[(f64, f64); 2]], k: usize, t: f64) -> (f64, f64) {
        let (a, [b, c], d) = (points[k], controls[k], points[k + 1]);
        let s = 1.0 - t;
        let sum = |f: fn(&(f64, f64)) -> f64| {
            s * s * s * f(&a) + 3.0 * s * s * t * f(&b) + 3.0 * s * t * t * f(&c) + t * t * t * f(&d)
        };
        (sum(|p| p.0), sum(|p| p.1))
    }

    /// Largest relative distance of a circular arc from `n` chords.
    fn off_the_arc(n: usize, smooth: bool) -> f64 {
        let on = |k: usize| 0.05 + 0.2 * TAU * k as f64 / n as f64;
        let points: Vec<_> = (0..=n).map(|k| (on(k).cos(), on(k).sin())).collect();
        let curve = controls(&points, &[]);
        let straight: Vec<_> = points
            .windows(2)
            .map(|p| [1.0, 2.0].map(|t| (p[0].0 + t / 3.0 * (p[1].0 - p[0].0), p[0].1 + t / 3.0 * (p[1].1 - p[0].1))))
            .collect();
        let used = if smooth { &curve } else { &straight };
        let distance = |(k, j): (usize, u32)| {
            let (x, y) = at(&points, used, k, f64::from(j) / 8.0);
            (x.hypot(y) - 1.0).abs()
        };
        (0..n).flat_map(|k| (1..8).map(move |j| (k, j))).map(distance).fold(0.0, f64::max)
    }

    #[test]
    fn an_arc_is_met_at_the_third_order_and_far_better_than_by_chords() {
        let (coarse, fine) = (off_the_arc(12, true), off_the_arc(24, true));
        assert!(coarse / fine > 6.0, "{coarse} {fine}");
        assert!(off_the_arc(12, false) > 5.0 * coarse, "{coarse}");
    }

    #[test]
    fn nothing_is_shown_beyond_the_points() {
        for values in [[0.0, 0.0, 1.0, 1.0, 0.0, 0.0], [0.0, 1.0, 1.1, 9.0, 9.0, 9.1], [3.0, -2.0, 5.0, 5.0, 4.9, 7.0]]
        {
            for width in [1e-6, 1.0, 1e3] {
                let points: Vec<_> = values.iter().enumerate().map(|(k, v)| (width * k as f64, *v)).collect();
                let curve = controls(&points, &[]);
                for (k, j) in (0..5).flat_map(|k| (0..=16).map(move |j| (k, j))) {
                    let (x, y) = at(&points, &curve, k, f64::from(j) / 16.0);
                    let within = |v: f64, a: f64, b: f64| v >= a.min(b) - 1e-9 && v <= a.max(b) + 1e-9;
                    assert!(within(x, points[k].0, points[k + 1].0) && within(y, points[k].1, points[k + 1].1));
                }
            }
        }
    }

    #[test]
    fn a_corner_stays_one() {
        let points: Vec<_> = (-3..=3).map(|k| (f64::from(k), f64::from(k).abs())).collect();
        let curve = controls(&points, &[3]);
        // Straight on both sides: each control point is on its chord.
        for (k, [a, b]) in curve.iter().enumerate() {
            for (x, y) in [a, b] {
                assert!((x.abs() - y).abs() < 1e-12, "{k}: {x} {y}");
            }
        }
        assert_eq!(curve.len(), 6);
    }

    #[test]
    fn short_curves_and_equal_points_have_a_piece_each() {
        assert!(controls(&[], &[]).is_empty());
        assert!(controls(&[(1.0, 2.0)], &[0]).is_empty());
        assert_eq!(controls(&[(0.0, 0.0), (3.0, 3.0)], &[0, 1]), [[(1.0, 1.0), (2.0, 2.0)]]);
        assert!(controls(&[(1.0, 1.0); 4], &[1]).iter().flatten().all(|p| *p == (1.0, 1.0)));
    }
}
