//! Matrices that are known to few digits, or that do not feel some motions.

use nlmodes_linalg::{Digits, SparseMatrix, lowest_modes, sparse_from_triplets, triplets};
use nlmodes_model::reduction::{ModeCount, OpenModes, ReducedStructure, ReductionError};

/// `n` masses between uneven springs in a row, of which the first hangs on one to the ground or not; in `digits`.
fn chain(n: usize, unit: f64, held: bool, digits: usize) -> (SparseMatrix, SparseMatrix) {
    let spring = |i: usize| unit * (1.0 + 0.4 * (1.3 * i as f64).sin());
    let mut k = vec![(0, 0, if held { spring(n) } else { 0.0 })];
    for i in 1..n {
        let s = spring(i);
        k.extend([(i - 1, i - 1, s), (i, i, s), (i - 1, i, -s), (i, i - 1, -s)]);
    }
    let m: Vec<_> = (0..n).map(|i| (i, i, 1.0 + 0.2 * (i % 5) as f64)).collect();
    (cut(&sparse_from_triplets(n, n, &k).unwrap(), digits), sparse_from_triplets(n, n, &m).unwrap())
}

fn cut(a: &SparseMatrix, digits: usize) -> SparseMatrix {
    let entries: Vec<_> =
        triplets(a).map(|(i, j, v)| (i, j, format!("{v:.*e}", digits - 1).parse().unwrap())).collect();
    sparse_from_triplets(a.nrows(), a.ncols(), &entries).unwrap()
}

/// A chain that floats, in any last digits: its motion is among the modes with ω² = 0, the flexibility is that of what
/// is beside it, and both are near those of all digits.
#[test]
fn a_floating_structure_of_few_digits_has_the_flexibility_of_all() {
    let n = 30;
    for (unit, digits) in [(1.0, 7), (2.1e8, 9), (3e-4, 12)] {
        let w = sparse_from_triplets(n, 2, &[(0, 0, 1.0), (n - 1, 0, -1.0), (7, 1, 1.0)]).unwrap();
        let open = |digits: usize, known: Option<[Digits; 2]>| {
            let (k, m) = chain(n, unit, false, digits);
            OpenModes::known_to(
                m,
                k,
                w.clone(),
                vec![0.1; 2],
                vec![0.0; 2],
                ModeCount::Lowest(6),
                known.map(Into::into),
            )
            .unwrap()
        };
        let rough = open(digits, Some([Digits::Decimal(digits as u32), Digits::DOUBLE]));
        let exact = open(17, Some([Digits::DOUBLE; 2]));
        for open in [&rough, &exact] {
            assert_eq!((open.openness().strainless, open.omega_squared()[0]), (1, 0.0));
            assert_eq!(open.rigid_motions(), Ok((1, 0)));
        }
        let scale = exact.flexibility()[(0, 0)];
        let off = (0..4).map(|k| (k / 2, k % 2)).map(|at| (rough.flexibility()[at] - exact.flexibility()[at]).abs());
        assert!(off.fold(0.0, f64::max) < 1e2 * 10f64.powi(-(digits as i32)) * scale, "{unit} {digits}");
        ReducedStructure::new(&rough, &[(0, 0.0), (7, 0.0)]).unwrap();
    }
}

/// A motion that strains nothing and moves no contact is left at rest by a frequency far below all others.
#[test]
fn an_unfelt_motion_gets_a_frequency_far_below_all_others() {
    let n = 20;
    let (k, m) = chain(n, 1.0, false, 17);
    let w = sparse_from_triplets(n, 1, &[(0, 0, 1.0), (n - 1, 0, -1.0)]).unwrap();
    let open =
        OpenModes::known_to(m, k, w, vec![0.1], vec![0.0], ModeCount::Lowest(6), Some([Digits::DOUBLE; 2].into()))
            .unwrap();
    assert_eq!(open.rigid_motions(), Ok((1, 1)));
    let reduced = ReducedStructure::new(&open, &[(0, 0.0)]).unwrap();
    let modes = lowest_modes(reduced.model().stiffness(), reduced.model().mass(), 3).unwrap();
    assert!((modes.eigenvalues[0] / (1e-6 * open.omega_squared()[1]) - 1.0).abs() < 1e-6, "{:?}", modes.eigenvalues);
    assert!((modes.eigenvalues[1] / open.omega_squared()[1] - 1.0).abs() < 1e-9);
}

/// The first mass on two rows, of which it is the weighted mean: what moves these against each other has neither
/// stiffness nor mass.
#[test]
fn motions_with_neither_stiffness_nor_mass_are_left_out_or_named() {
    let n = 25;
    for unit in [1.0, 2.1e11] {
        let narrow = chain(n, unit, true, 17);
        let part = |i: usize| if i == 0 { vec![(0, 0.3), (1, 0.7)] } else { vec![(i + 1, 1.0)] };
        let wide = |a: &SparseMatrix| {
            let pairs = |(i, j, v): (usize, usize, f64)| {
                let row = move |(p, a): (usize, f64)| part(j).into_iter().map(move |(q, b)| (p, q, v * a * b));
                part(i).into_iter().flat_map(row).collect::<Vec<_>>()
            };
            cut(&sparse_from_triplets(n + 1, n + 1, &triplets(a).flat_map(pairs).collect::<Vec<_>>()).unwrap(), 14)
        };
        let open = |entries: &[(usize, usize, f64)]| {
            let w = sparse_from_triplets(n + 1, 1, entries).unwrap();
            let digits = Some([Digits::Decimal(14); 2].into());
            OpenModes::known_to(wide(&narrow.1), wide(&narrow.0), w, vec![0.1], vec![0.0], ModeCount::Lowest(5), digits)
        };
        let w = sparse_from_triplets(n, 1, &[(0, 0, 1.0)]).unwrap();
        let (m, k) = (narrow.1.clone(), narrow.0.clone());
        let expected = OpenModes::new(m, k, w, vec![0.1], vec![0.0], ModeCount::Lowest(5)).unwrap();
        let found = open(&[(0, 0, 0.3), (1, 0, 0.7)]).unwrap();
        assert_eq!(found.hourglass_motions(), 1);
        for (a, b) in found.omega_squared().iter().zip(expected.omega_squared()) {
            assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
        }
        let (a, b) = (found.flexibility()[(0, 0)], expected.flexibility()[(0, 0)]);
        assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
        // What is shown of it has nothing of the motion (0.7, −0.3) that is left out, by the weights 0.09 and 0.49.
        let [a, b] = [0, 1].map(|i| found.shapes().row(i));
        assert!((0..5).all(|r| (0.09 * 0.7 * a[r] - 0.49 * 0.3 * b[r]).abs() < 1e-6 * b[r].abs()));
        assert_eq!(open(&[(0, 0, 1.0)]).unwrap_err(), ReductionError::Hourglass { contact: 0, motions: 1 });
    }
}
