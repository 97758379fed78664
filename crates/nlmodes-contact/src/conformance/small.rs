//! Small explicit problems, each for one way to fail.

use super::{
    Case,
    Expected::{self, Infeasible, Solution},
};

fn gaps(gaps: &[f64]) -> Expected {
    Expected::Gaps { gaps: gaps.to_vec(), tolerance: 1e-9 }
}

pub(super) fn cases() -> Vec<Case> {
    let mut all = single();
    all.extend(redundant());
    all.extend(contradictory());
    // Plain Newton from all contacts open visits {}, {1, 2}, {0, 1} and returns to {}.
    let cycle: [&[f64]; 3] = [&[3.0, -2.0, -2.0], &[-2.0, 2.0, 3.0], &[-2.0, 3.0, 6.0]];
    all.push(Case::new("newton cycle of three", &cycle, &[5.0, -3.0, -1.0], Solution));
    // It visits {}, {0}, {0, 1, 2} and {2}.
    let cycle: [&[f64]; 3] = [&[8.0, -6.0, -4.0], &[-6.0, 7.0, 6.0], &[-4.0, 6.0, 6.0]];
    all.push(Case::new("newton cycle of four", &cycle, &[-7.0, 5.0, 1.0], Solution));
    all.extend([4, 8, 12, 20].map(exponential));
    all.extend([4, 8].map(hilbert));
    all
}

fn single() -> Vec<Case> {
    let one = |name: &str, b: f64, gap: f64| Case::new(name, &[&[2.0]], &[b], gaps(&[gap]));
    vec![
        one("one, open", 1.0, 1.0),
        one("one, closed", -1.0, 0.0),
        one("one, grazing", 0.0, 0.0),
        Case::new("one, stiff", &[&[1e-13]], &[-1e-6], Expected::Gaps { gaps: vec![0.0], tolerance: 1e-15 }),
        Case::new("one, rigid and open", &[&[0.0]], &[1e-6], Solution),
        Case::new("one, rigid and closed", &[&[0.0]], &[-1e-6], Infeasible),
        Case::new("two, b at 1e-12 of grazing", &[&[2.0, 1.0], &[1.0, 2.0]], &[-1.0, -0.5 - 1e-12], Solution),
        Case::new("two, b at 1e-12 above grazing", &[&[2.0, 1.0], &[1.0, 2.0]], &[-1.0, -0.5 + 1e-12], Solution),
        Case::new("two, both at grazing", &[&[2.0, 1.0], &[1.0, 2.0]], &[-1e-12, 1.0], Solution),
    ]
}

fn redundant() -> Vec<Case> {
    let table: [&[f64]; 4] =
        [&[3.0, 1.0, -1.0, 1.0], &[1.0, 3.0, 1.0, -1.0], &[-1.0, 1.0, 3.0, 1.0], &[1.0, -1.0, 1.0, 3.0]];
    let repeated: [&[f64]; 3] = [&[1.0, 1.0, 0.5], &[1.0, 1.0, 0.5], &[0.5, 0.5, 1.0]];
    let pinch: [&[f64]; 2] = [&[1.0, -1.0], &[-1.0, 1.0]];
    vec![
        Case::new("table on four legs", &table, &[-1.0; 4], gaps(&[0.0; 4])),
        Case::new("table on four legs, one short", &table, &[-1.0, -1.0, -1.0, -0.5], Solution),
        Case::new("repeated contact", &repeated, &[-1.0, -1.0, -1.0], gaps(&[0.0; 3])),
        Case::new("repeated contact, one further off", &repeated, &[-1.0, -2.0, 3.0], gaps(&[1.0, 0.0, 4.0])),
        Case::new("pinch with clearance", &pinch, &[-1.0, 1.5], gaps(&[0.0, 0.5])),
        Case::new("pinch without clearance", &pinch, &[-0.3, 0.3], gaps(&[0.0, 0.0])),
        Case::new("pinch without clearance, rounded", &pinch, &[-0.3, 0.1 + 0.2 - 1e-16], gaps(&[0.0, 0.0])),
        Case::new("one rigid among others", &[&[0.0, 0.0], &[0.0, 1.0]], &[1.0, -1.0], gaps(&[1.0, 0.0])),
    ]
}

fn contradictory() -> Vec<Case> {
    let pinch: [&[f64]; 2] = [&[1.0, -1.0], &[-1.0, 1.0]];
    let three: [&[f64]; 3] = [&[1.0, -0.5, -0.5], &[-0.5, 1.0, -0.5], &[-0.5, -0.5, 1.0]];
    vec![
        Case::new("pinch with interference", &pinch, &[-1.0, 0.5], Infeasible),
        Case::new("pinch of three", &three, &[-1.0, 0.3, 0.3], Infeasible),
        Case::new("one rigid among others, closed", &[&[0.0, 0.0], &[0.0, 1.0]], &[-1.0, -1.0], Infeasible),
    ]
}

/// Fathi's symmetric form of Murty's example, `L Lᵀ` with ones on the diagonal of `L` and twos below: pivoting by least
/// index takes `2^c − 1` steps.
fn exponential(c: usize) -> Case {
    let l = |i: usize, j: usize| match i.cmp(&j) {
        std::cmp::Ordering::Less => 0.0,
        std::cmp::Ordering::Equal => 1.0,
        std::cmp::Ordering::Greater => 2.0,
    };
    let entry = |i: usize, j: usize| (0..c).map(|k| l(i, k) * l(j, k)).sum();
    let a = nlmodes_linalg::Mat::from_fn(c, c, entry);
    let (mut lambda, mut gaps) = (vec![0.0; c], vec![1.0; c]);
    (lambda[0], gaps[0]) = (1.0, 0.0);
    Case::with_solution(format!("exponential, {c}"), a, &lambda, &gaps)
}

fn hilbert(c: usize) -> Case {
    let a = nlmodes_linalg::Mat::from_fn(c, c, |i, j| 1.0 / (i + j + 1) as f64);
    let half = |odd: usize| (0..c).map(|i| ((i + odd) % 2) as f64).collect::<Vec<_>>();
    Case::with_solution(format!("hilbert, {c}"), a, &half(1), &half(0))
}
