//! Derivatives by entries of stiffness and mass, against differences of structures reduced anew.

use nlmodes_linalg::{Mat, SparseMatrix, Triplet, sparse_from_triplets, triplets};
use nlmodes_model::reduction::{MatrixDirection, ModeCount, OpenModes, OpenWeights, ReductionError};

/// A chain of masses between springs that are all different, the first one fixed or not.
fn chain(n: usize, held: bool) -> (SparseMatrix, SparseMatrix) {
    let spring = |i: usize| 1.0 + 0.3 * ((i * i) as f64).sin();
    let mut k = vec![(0, 0, if held { spring(0) } else { 0.0 })];
    for i in 1..n {
        let s = spring(i);
        k.extend([(i, i, s), (i - 1, i - 1, s), (i, i - 1, -s), (i - 1, i, -s)]);
    }
    let m: Vec<Triplet> = (0..n).map(|i| (i, i, if i == 5 { 0.0 } else { 1.0 + 0.2 * (i as f64).cos() })).collect();
    (sparse_from_triplets(n, n, &k).unwrap(), sparse_from_triplets(n, n, &m).unwrap())
}

fn places(n: usize) -> SparseMatrix {
    sparse_from_triplets(n, 3, &[(n - 1, 0, -1.0), (4, 1, 1.0), (2, 1, -1.0), (5, 2, 1.0)]).unwrap()
}

/// `A + h dA` with both halves of the entries.
fn moved(a: &SparseMatrix, entries: &[Triplet], h: f64) -> SparseMatrix {
    let both = |&(i, j, v): &Triplet| if i == j { vec![(i, j, h * v)] } else { vec![(i, j, h * v), (j, i, h * v)] };
    let all: Vec<Triplet> = triplets(a).chain(entries.iter().flat_map(both)).collect();
    sparse_from_triplets(a.nrows(), a.ncols(), &all).unwrap()
}

/// What the places see at a squared frequency: `Y (Ω² − ν²)⁻¹ Yᵀ` and `A`.
fn seen(open: &OpenModes, square: f64) -> [Mat<f64>; 2] {
    let (y, p) = (open.contact_rows(), open.n_contacts());
    let answer = |i: usize, j: usize| {
        let of = |(r, w): (usize, &f64)| y[(i, r)] * y[(j, r)] / (w - square);
        open.omega_squared().iter().enumerate().map(of).sum::<f64>()
    };
    [Mat::from_fn(p, p, answer), open.flexibility().clone()]
}

#[test]
fn derivatives_by_entries_of_stiffness_and_mass_are_differences_of_reductions() {
    let n = 14;
    for held in [true, false] {
        let (k0, m0) = chain(n, held);
        let reduced = |k: SparseMatrix, m: SparseMatrix| {
            OpenModes::new(m, k, places(n), vec![0.1; 3], vec![0.0; 3], ModeCount::Lowest(5)).unwrap()
        };
        let open = reduced(k0.clone(), m0.clone());
        let directions = [
            MatrixDirection { stiffness: vec![(7, 7, 1.0), (8, 8, 1.0), (8, 7, -1.0)], mass: vec![] },
            MatrixDirection { stiffness: vec![], mass: vec![(3, 3, 1.0)] },
            MatrixDirection { stiffness: vec![(5, 5, 0.5), (6, 6, 0.5), (6, 5, -0.5)], mass: vec![(9, 8, 0.3)] },
        ];
        let along = open.along(&places(n), &directions).unwrap();
        let square = 0.37;
        // `d(Y D Yᵀ) = dY D Yᵀ + Y D dYᵀ − Y D dΩ² D Yᵀ`: weights of an entry of it, and of one of `A`.
        let (y, p) = (open.contact_rows(), 3);
        let scaled = Mat::from_fn(p, 5, |i, r| y[(i, r)] / (open.omega_squared()[r] - square));
        let none =
            || OpenWeights { stiffness: Mat::zeros(5, 5), rows: Mat::zeros(p, 5), flexibility: Mat::zeros(p, p) };
        let of_modes = |i: usize, j: usize| {
            let mut weights = none();
            for r in 0..5 {
                weights.rows[(i, r)] += scaled[(j, r)];
                weights.rows[(j, r)] += scaled[(i, r)];
                (0..5).for_each(|s| weights.stiffness[(r, s)] = -scaled[(i, r)] * scaled[(j, s)]);
            }
            along.times(&weights)
        };
        let of_flexibility = |i: usize, j: usize| {
            let mut weights = none();
            weights.flexibility[(i, j)] = 1.0;
            along.times(&weights)
        };
        for (k, direction) in directions.iter().enumerate() {
            let at =
                |h: f64| seen(&reduced(moved(&k0, &direction.stiffness, h), moved(&m0, &direction.mass, h)), square);
            let h = 1e-3;
            let [a, b, c, d] = [h, -h, 2.0 * h, -2.0 * h].map(at);
            for what in 0..2 {
                let of = |i: usize, j: usize| {
                    (8.0 * (a[what][(i, j)] - b[what][(i, j)]) - (c[what][(i, j)] - d[what][(i, j)])) / (12.0 * h)
                };
                let size = (0..9).map(|e| of(e / 3, e % 3).abs()).fold(1e-3, f64::max);
                for (i, j) in (0..9).map(|e| (e / 3, e % 3)) {
                    let found = if what == 0 { of_modes(i, j)[k] } else { of_flexibility(i, j)[k] };
                    let off = (found - of(i, j)).abs() / size;
                    assert!(off < 2e-9, "{held} {what} {i} {j}: {found} by difference {}", of(i, j));
                }
            }
        }
    }
}

#[test]
fn entries_that_are_not_there_and_modes_cut_apart_are_refused() {
    let (k, m) = chain(14, true);
    let open = OpenModes::new(m, k, places(14), vec![0.1; 3], vec![0.0; 3], ModeCount::Lowest(5)).unwrap();
    let outside = MatrixDirection { stiffness: vec![(14, 0, 1.0)], mass: vec![] };
    let error = open.along(&places(14), &[outside]).unwrap_err();
    assert!(matches!(error, ReductionError::Dimension { expected: 14, found: 15, .. }), "{error}");
    // Two equal masses on equal springs, of which one mode is retained.
    let unit = |v: f64| sparse_from_triplets(3, 3, &[(0, 0, v), (1, 1, v), (2, 2, 4.0 * v)]).unwrap();
    let ones = sparse_from_triplets(3, 3, &[(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0)]).unwrap();
    let w = sparse_from_triplets(3, 2, &[(0, 0, 1.0), (1, 1, 1.0)]).unwrap();
    let open = OpenModes::new(ones, unit(1.0), w.clone(), vec![0.1; 2], vec![0.0; 2], ModeCount::Lowest(1)).unwrap();
    let error = open.along(&w, &[MatrixDirection::default()]).unwrap_err();
    assert!(matches!(error, ReductionError::CutBetweenModes { mode: 1, retained: 1 }), "{error}");
}
