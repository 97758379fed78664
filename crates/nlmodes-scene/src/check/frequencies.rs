//! Linear frequencies of a uniform rod or slender beam in closed form, to see whether a frequency of the scene can be
//! meant.

use std::f64::consts::{PI, TAU};

use crate::scene::holds;
use crate::scene::{Direction, Section, Structure, StructureKind, Support};

/// Roots `βL` of a family are computed up to this number, more than anyone requests by hand.
const MOST: usize = 200;

/// The frequency of mode `number`, Hz, 0 for a rigid-body motion; `None` if there is no closed form.
pub fn estimate(structure: &Structure, number: usize) -> Option<f64> {
    if !structure.is_uniform() {
        return None;
    }
    let supports = [structure.start, structure.end];
    let speed = (structure.youngs_modulus / structure.density).sqrt();
    let mut all = axial(structure.kind(), supports, speed / structure.length);
    if let Section::Beam { area, second_moment, .. } = structure.section {
        let radius = (second_moment / area).sqrt();
        let bending = deflections(supports).map(|root| root * root * speed * radius / (TAU * structure.length.powi(2)));
        all.extend(bending);
    }
    all.sort_by(f64::total_cmp);
    all.get(number.checked_sub(1)?).copied().filter(|hz| number <= MOST && hz.is_finite())
}

/// `f = n c/2L` between equal ends, `(2n − 1) c/4L` between a fixed and a free one.
fn axial(kind: StructureKind, supports: [Support; 2], speed_over_length: f64) -> Vec<f64> {
    let held = supports.map(|support| holds(kind, support, Direction::Axial));
    let root = |n: usize| match held {
        [true, true] => n as f64,
        [false, false] => n as f64 - 1.0,
        _ => n as f64 - 0.5,
    };
    (1..=MOST).map(|n| root(n) * speed_over_length / 2.0).collect()
}

/// Roots `βL` of the Euler-Bernoulli beam. Beyond the first they are multiples of π/4 to four parts in a thousand.
fn deflections(supports: [Support; 2]) -> impl Iterator<Item = f64> {
    use Support::{Clamped, Free, Pinned, Sliding};
    let (rigid, first, offset) = match supports {
        [Clamped, Clamped] => (0, 4.7300, 0.5),
        [Free, Free] => (2, 4.7300, 0.5),
        [Clamped, Free] | [Free, Clamped] => (0, 1.8751, -0.5),
        [Clamped, Pinned] | [Pinned, Clamped] => (0, 3.9266, 0.25),
        [Free, Pinned] | [Pinned, Free] => (1, 3.9266, 0.25),
        [Clamped, Sliding] | [Sliding, Clamped] => (0, 2.3650, -0.25),
        [Free, Sliding] | [Sliding, Free] => (1, 2.3650, -0.25),
        [Pinned, Pinned] => (0, PI, 0.0),
        [Sliding, Sliding] => (1, PI, 0.0),
        [Pinned, Sliding] | [Sliding, Pinned] => (0, PI / 2.0, -0.5),
    };
    let elastic = (1..=MOST).map(move |n| if n == 1 { first } else { (n as f64 + offset) * PI });
    std::iter::repeat_n(0.0, rigid).chain(elastic)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse;

    #[test]
    fn rod_and_beam_of_the_paper() {
        let rod = parse("rod.toml", include_str!("../../../../configs/rod.toml"), &[])
            .unwrap()
            .scene
            .structure
            .straight()
            .unwrap()
            .clone();
        let first = (210e9_f64 / 9000.0).sqrt() / 80.0;
        assert!((estimate(&rod, 1).unwrap() / first - 1.0).abs() < 1e-12);
        assert!((estimate(&rod, 3).unwrap() / first - 5.0).abs() < 1e-9);
        let beam = parse("beam.toml", include_str!("../../../../configs/beam.toml"), &[])
            .unwrap()
            .scene
            .structure
            .straight()
            .unwrap()
            .clone();
        // 40.10 Hz by finite elements with shear; 250.1 Hz is the second frequency of the ideal beam.
        for (mode, hz) in [(1, 40.1), (2, 250.1)] {
            let found = estimate(&beam, mode).unwrap();
            assert!((found / hz - 1.0).abs() < 0.02, "mode {mode}: {found}");
        }
    }

    #[test]
    fn roots_solve_their_equations() {
        let equation = |supports: [Support; 2], x: f64| match supports {
            [Support::Clamped, Support::Free] => x.cos() * x.cosh() + 1.0,
            [Support::Clamped, Support::Clamped] | [Support::Free, Support::Free] => x.cos() * x.cosh() - 1.0,
            [Support::Clamped, Support::Pinned] => x.tan() - x.tanh(),
            [Support::Free, Support::Sliding] => x.tan() + x.tanh(),
            _ => x.sin(),
        };
        let pairs = [
            [Support::Clamped, Support::Free],
            [Support::Clamped, Support::Clamped],
            [Support::Clamped, Support::Pinned],
            [Support::Free, Support::Sliding],
            [Support::Pinned, Support::Pinned],
        ];
        for supports in pairs {
            for root in deflections(supports).filter(|root| *root > 0.0).take(3) {
                let [below, above] = [0.995, 1.005].map(|factor| equation(supports, factor * root));
                assert!(below * above < 0.0, "{supports:?} {root}");
            }
        }
    }
}
