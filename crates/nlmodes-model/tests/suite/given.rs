//! Modes and flexibility of another program against the reduction of the matrices.

use nlmodes_linalg::{Mat, SparseMatrix, sparse_from_triplets};
use nlmodes_model::reduction::{GivenFlexibility, GivenModes, ModeCount, OpenModes, ReductionError};

/// A chain of 12 unit masses on unit springs; the first one is held or not.
fn chain(held: bool) -> (SparseMatrix, SparseMatrix) {
    let n = 12;
    let diagonal = |i: usize| if i + 1 == n || i == 0 && !held { 1.0 } else { 2.0 };
    let entries = (0..n).flat_map(|i| {
        let next = (i + 1 < n).then_some([(i, i + 1, -1.0), (i + 1, i, -1.0)]);
        next.into_iter().flatten().chain([(i, i, diagonal(i))])
    });
    let k = sparse_from_triplets(n, n, &entries.collect::<Vec<_>>()).unwrap();
    (k, sparse_from_triplets(n, n, &(0..n).map(|i| (i, i, 1.0)).collect::<Vec<_>>()).unwrap())
}

/// The chain before stops at masses 11 and 4, as matrices.
fn solved(held: bool, modes: usize) -> OpenModes {
    let (k, m) = chain(held);
    let w = sparse_from_triplets(12, 2, &[(11, 0, -1.0), (4, 1, 1.0)]).unwrap();
    OpenModes::known_to(m, k, w, vec![0.1, 0.2], vec![0.0, 0.0], ModeCount::Lowest(modes), None).unwrap()
}

/// What another program would say of masses 11, 4 and 7: all from the modes of the matrices, all of them.
fn numbers(held: bool, modes: usize) -> (Vec<f64>, Mat<f64>, Mat<f64>) {
    let (all, places) = (solved(held, 12), [11, 4, 7]);
    let shape = |i: usize, r: usize| all.shapes()[(places[i], r)];
    let square = |r: usize| if all.omega_squared()[r] < 1e-9 { 0.0 } else { all.omega_squared()[r] };
    let residual = Mat::from_fn(3, 3, |i, j| (modes..12).map(|r| shape(i, r) * shape(j, r) / square(r)).sum());
    ((0..modes).map(square).collect(), Mat::from_fn(3, modes, shape), residual)
}

fn given(numbers: (Vec<f64>, Mat<f64>, GivenFlexibility)) -> Result<OpenModes, ReductionError> {
    let (omega_squared, rows, flexibility) = numbers;
    let w = sparse_from_triplets(3, 2, &[(0, 0, -1.0), (1, 1, 1.0)]).unwrap();
    OpenModes::given(GivenModes { omega_squared, rows, flexibility }, w, vec![0.1, 0.2], vec![0.0, 0.0])
}

fn whole(omega_squared: &[f64], rows: &Mat<f64>, residual: &Mat<f64>) -> Mat<f64> {
    let modal =
        |i: usize, j: usize| omega_squared.iter().enumerate().map(move |(r, w)| rows[(i, r)] * rows[(j, r)] / w);
    Mat::from_fn(3, 3, |i, j| residual[(i, j)] + modal(i, j).sum::<f64>())
}

fn same(a: &Mat<f64>, b: &Mat<f64>) -> bool {
    (a.nrows(), a.ncols()) == (b.nrows(), b.ncols())
        && (0..a.ncols()).all(|j| (0..a.nrows()).all(|i| (a[(i, j)] - b[(i, j)]).abs() < 1e-12))
}

#[test]
fn both_flexibilities_are_that_of_the_matrices_and_so_is_what_joins_it() {
    let (omega_squared, rows, residual) = numbers(true, 6);
    let full = GivenFlexibility::Static(whole(&omega_squared, &rows, &residual));
    for flexibility in [full, GivenFlexibility::Residual(residual)] {
        let open = given((omega_squared.clone(), rows.clone(), flexibility)).unwrap();
        for (open, expected) in [(open.truncated(4).unwrap(), solved(true, 4)), (open, solved(true, 6))] {
            assert!(same(open.flexibility(), expected.flexibility()));
            // Signs of shapes are free.
            let strength = |of: &OpenModes| Mat::from_fn(2, of.n_modes(), |i, r| of.contact_rows()[(i, r)].abs());
            assert!(same(&strength(&open), &strength(&expected)));
            // A force on mass 7, the third row.
            let (mut on_row, mut on_mass) = ([0.0; 3], [0.0; 12]);
            (on_row[2], on_mass[7]) = (1.5, 1.5);
            let [row, mass] = [open.load(&on_row).unwrap(), expected.load(&on_mass).unwrap()];
            assert!(row.gaps.iter().zip(&mass.gaps).all(|(a, b)| (a - b).abs() < 1e-12));
            assert!((row.residual[2] - mass.residual[7]).abs() < 1e-12);
            assert!((row.residual[2] - 1.5 * open.residual_flexibility(2)).abs() < 1e-15);
            assert!(!open.floats() && !open.has_all_modes() && open.modal_coordinates(&Mat::zeros(3, 1)).is_none());
        }
    }
}

#[test]
fn what_floats_has_its_rigid_motions_and_the_flexibility_of_balanced_loads() {
    let (omega_squared, rows, residual) = numbers(false, 6);
    assert_eq!(omega_squared[0], 0.0);
    let open = given((omega_squared.clone(), rows.clone(), GivenFlexibility::Residual(residual.clone()))).unwrap();
    let expected = solved(false, 6);
    assert!(same(open.flexibility(), expected.flexibility()));
    assert!(open.floats() && open.rigid_motions().unwrap() == (1, 0) && open.openness().strainless == 1);
    let refused = given((omega_squared, rows, GivenFlexibility::Static(residual))).unwrap_err();
    assert_eq!(refused, ReductionError::FloatingFlexibility);
}

#[test]
fn numbers_that_make_no_structure_are_refused() {
    let (omega_squared, rows, residual) = numbers(true, 6);
    let full = whole(&omega_squared, &rows, &residual);
    let of = |omega_squared: &[f64], flexibility| given((omega_squared.to_vec(), rows.clone(), flexibility));
    // What the modes leave in place of the whole.
    let less = of(&omega_squared, GivenFlexibility::Static(residual.clone())).unwrap_err();
    assert!(matches!(less, ReductionError::LessThanModes { .. }), "{less}");
    let mut skew = full.clone();
    skew[(0, 2)] *= 1.0 + 1e-3;
    let skew = of(&omega_squared, GivenFlexibility::Static(skew)).unwrap_err();
    assert!(matches!(skew, ReductionError::NotSymmetric { row: 1, column: 3, .. }), "{skew}");
    let mut negative = residual.clone();
    negative[(1, 1)] *= -1.0;
    let negative = of(&omega_squared, GivenFlexibility::Residual(negative)).unwrap_err();
    assert!(matches!(negative, ReductionError::NegativeFlexibility { row: 2, .. }), "{negative}");
    let mut unknown = full.clone();
    unknown[(2, 1)] = f64::NAN;
    let unknown = of(&omega_squared, GivenFlexibility::Static(unknown)).unwrap_err();
    assert!(matches!(unknown, ReductionError::NotFinite { .. }), "{unknown}");
    let mut order = omega_squared.clone();
    order.swap(2, 3);
    let order = of(&order, GivenFlexibility::Residual(residual.clone())).unwrap_err();
    assert!(matches!(order, ReductionError::Descending { mode: 4, .. }), "{order}");
    let short = of(&omega_squared[..5], GivenFlexibility::Residual(residual.clone())).unwrap_err();
    assert!(matches!(short, ReductionError::Dimension { expected: 5, found: 6, .. }), "{short}");
    let rigid = of(&[0.0; 6], GivenFlexibility::Residual(residual)).unwrap_err();
    assert_eq!(rigid, ReductionError::OnlyRigidModes { retained: 6 });
    // The last digits of another program are not held against it.
    let mut rounded = full.clone();
    rounded[(0, 1)] *= 1.0 + 1e-6;
    assert!(of(&omega_squared, GivenFlexibility::Static(rounded)).is_ok());
}
