//! Open modes with residual flexibility against full solutions, closed forms and the paper's partition.

use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes_linalg::{DenseLu, Mat, SparseCholesky, SparseMatrix, add_scaled, sparse_from_triplets};
use nlmodes_model::reduction::{ModeCount, OpenModes, ReductionError};
use nlmodes_model::{Drop, MasslessContactModel, Side, StructuralModel};

/// A steel rod with stops on both sides of its tip and one at its middle; lengths in units of `metre` metres, masses of
/// `kilogram` kilograms, seconds.
fn rod(elements: usize, start: Support, metre: f64, kilogram: f64) -> StructuralModel {
    let rod = Rod {
        material: Material::new(210e9 * metre / kilogram, 7800.0 * metre.powi(3) / kilogram).unwrap(),
        area: 1e-4 / metre.powi(2),
        mesh: Mesh::uniform(2.0 / metre, elements).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start,
        end: Support::Free,
    };
    let at = |x: f64, side, gap: f64| Stop::rigid(x / metre, Direction::Axial, side, gap / metre);
    rod.assemble(&[at(2.0, Side::Positive, 1e-4), at(1.0, Side::Negative, 2e-4), at(2.0, Side::Negative, 1e-4)])
        .unwrap()
}

fn beam(elements: usize) -> StructuralModel {
    let beam = Beam {
        material: Material::new(210e9, 7800.0).unwrap(),
        section: Section::rectangle(0.02, 0.005).unwrap(),
        mesh: Mesh::uniform(0.8, elements).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Pinned,
    };
    let at = |x| Stop::rigid(x, Direction::Transverse, Side::Positive, 1e-3);
    beam.assemble(&[at(0.2), at(0.4).on_spring(1e6), at(0.6)]).unwrap()
}

/// `W` of the model, dense.
fn directions(model: &StructuralModel) -> Mat<f64> {
    OpenModes::of_model(model, ModeCount::Lowest(6)).unwrap().directions().to_dense()
}

/// `Wᵀ H⁻¹ W` of a regular symmetric matrix, by elimination with exchanges.
fn flexibility(h: &SparseMatrix, w: &Mat<f64>) -> Mat<f64> {
    let lu = DenseLu::factor(&h.to_dense()).unwrap();
    let mut x = w.clone();
    for j in 0..w.ncols() {
        let mut column: Vec<f64> = x.col(j).iter().copied().collect();
        lu.solve_in_place(&mut column);
        (0..w.nrows()).for_each(|i| x[(i, j)] = column[i]);
    }
    w.transpose() * x
}

/// `Y (Ω² − ν²)⁻¹ Yᵀ + A`.
fn reduced(open: &OpenModes, nu_squared: f64) -> Mat<f64> {
    let y = open.contact_rows();
    Mat::from_fn(y.nrows(), y.nrows(), |i, j| {
        let modal = open.omega_squared().iter().enumerate().map(|(r, w2)| y[(i, r)] * y[(j, r)] / (w2 - nu_squared));
        modal.sum::<f64>() + open.flexibility()[(i, j)]
    })
}

fn distance(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    let size = b.col_iter().flat_map(|c| c.iter()).fold(0.0_f64, |l, v| l.max(v.abs()));
    let off = (0..a.ncols()).flat_map(|j| (0..a.nrows()).map(move |i| (i, j)));
    off.map(|(i, j)| (a[(i, j)] - b[(i, j)]).abs()).fold(0.0, f64::max) / size
}

#[test]
fn statics_of_contact_forces_are_exact_with_any_number_of_modes() {
    // In metres and kilograms, and in millimetres and tonnes.
    for model in [rod(40, Support::Clamped, 1.0, 1.0), rod(40, Support::Clamped, 1e-3, 1e3), beam(32)] {
        let expected = flexibility(model.stiffness(), &directions(&model));
        for m in [1, 2, 7, 25] {
            let open = OpenModes::of_model(&model, ModeCount::Lowest(m)).unwrap();
            assert_eq!((open.n_modes(), open.n_contacts()), (m, 3));
            let error = distance(&reduced(&open, 0.0), &expected);
            assert!(error < 1e-10, "{m} modes: {error:e}");
        }
    }
}

#[test]
fn open_frequencies_are_those_of_the_structure() {
    // Clamped-free rod of consistent linear elements: λ = 6 (c/h)² (1 − cos θ)/(2 + cos θ), θ = (2r − 1) π/(2
    // elements).
    let elements = 40;
    let open = OpenModes::of_model(&rod(elements, Support::Clamped, 1.0, 1.0), ModeCount::Lowest(9)).unwrap();
    let (c2, h) = (210e9 / 7800.0, 2.0 / elements as f64);
    for (r, found) in open.omega_squared().iter().enumerate() {
        let theta = (2 * r + 1) as f64 * std::f64::consts::PI / (2 * elements) as f64;
        let expected = 6.0 * c2 / (h * h) * (1.0 - theta.cos()) / (2.0 + theta.cos());
        assert!((found / expected - 1.0).abs() < 1e-10, "mode {r}");
    }
}

#[test]
fn the_error_in_motion_falls_with_the_third_power_of_the_number_of_modes() {
    let model = rod(600, Support::Clamped, 1.0, 1.0);
    let first = OpenModes::of_model(&model, ModeCount::Lowest(1)).unwrap().omega_squared()[0];
    let nu_squared = 2.0 * first;
    let h = add_scaled(model.stiffness(), -nu_squared, model.mass()).unwrap();
    let exact = flexibility(&h, &directions(&model));
    let errors = [6, 12, 24]
        .map(|m| distance(&reduced(&OpenModes::of_model(&model, ModeCount::Lowest(m)).unwrap(), nu_squared), &exact));
    // Σ_{r>m} ν²/ω_r⁴ ~ 1/m³: eight times smaller for each doubling.
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 3.0).abs() < 0.2, "{errors:?}");
    }
    assert!(errors[0] < 1e-3, "{errors:?}");
}

#[test]
fn without_the_mass_of_the_nodes_all_modes_leave_the_compliance_of_the_nodes() {
    for model in [rod(12, Support::Clamped, 1.0, 1.0), rod(12, Support::Clamped, 1e-3, 1e3), beam(16)] {
        let massless = MasslessContactModel::new(&model, &Drop).unwrap();
        let open = OpenModes::of_massless(&massless, ModeCount::Lowest(model.dofs().len())).unwrap();
        assert_eq!(open.n_modes(), massless.linear_dofs().len());
        let k_nn = DenseLu::factor(massless.k_nn()).unwrap();
        let w = massless.w();
        let expected = Mat::from_fn(w.ncols(), w.ncols(), |i, j| {
            let mut column: Vec<f64> = w.col(j).iter().copied().collect();
            k_nn.solve_in_place(&mut column);
            (0..w.nrows()).map(|d| w[(d, i)] * column[d]).sum()
        });
        let error = distance(open.flexibility(), &expected);
        assert!(error < 1e-9, "{error:e}");
    }
}

#[test]
fn all_modes_of_a_structure_with_mass_leave_nothing_over() {
    let model = rod(20, Support::Clamped, 1.0, 1.0);
    let open = OpenModes::of_model(&model, ModeCount::Lowest(20)).unwrap();
    let whole = flexibility(model.stiffness(), &directions(&model));
    assert!(distance(&reduced(&open, 0.0), &whole) < 1e-11);
    assert!((0..3).all(|i| open.flexibility()[(i, i)].abs() < 1e-12 * whole[(i, i)]));
}

#[test]
fn a_floating_structure_answers_like_all_its_modes() {
    for (metre, kilogram) in [(1.0, 1.0), (1e-3, 1e3)] {
        let model = rod(60, Support::Free, metre, kilogram);
        let all = OpenModes::of_model(&model, ModeCount::Lowest(61)).unwrap();
        for m in [2, 5, 12] {
            let open = OpenModes::of_model(&model, ModeCount::Lowest(m)).unwrap();
            let y = all.contact_rows();
            let expected =
                Mat::from_fn(3, 3, |i, j| (m..61).map(|r| y[(i, r)] * y[(j, r)] / all.omega_squared()[r]).sum());
            let error = distance(open.flexibility(), &expected);
            assert!(error < 1e-9, "{m} modes: {error:e}");
            assert!(open.omega_squared()[0] < 1e-9 * open.omega_squared()[1]);
        }
        let alone = OpenModes::of_model(&model, ModeCount::Lowest(1)).unwrap_err();
        assert_eq!(alone, ReductionError::OnlyRigidModes { retained: 1 });
    }
}

#[test]
fn loads_and_recovered_displacements_are_exact_in_statics() {
    let model = beam(32);
    let n = model.dofs().len();
    let open = OpenModes::of_model(&model, ModeCount::Lowest(4)).unwrap();
    let force: Vec<f64> = (0..n).map(|i| ((37 * i) % 11) as f64 - 4.0).collect();
    let lambda = [3.0, 40.0, 500.0];
    let load = open.load(&force).unwrap();
    let mut q = force.clone();
    for (i, l) in lambda.iter().enumerate() {
        (0..n).for_each(|d| q[d] += open.directions().to_dense()[(d, i)] * l);
    }
    SparseCholesky::factor(model.stiffness(), "stiffness").unwrap().solve_in_place(&mut q);
    let eta: Vec<f64> = (0..4)
        .map(|r| {
            let pressed: f64 = (0..3).map(|i| open.contact_rows()[(i, r)] * lambda[i]).sum();
            (pressed + load.modal[r]) / open.omega_squared()[r]
        })
        .collect();
    let rows = open.rows_of_dofs(&[0, 5, n - 1]).unwrap();
    for (row, dof) in [0, 5, n - 1].into_iter().enumerate() {
        let found = rows.value(row, &eta, &lambda) + load.residual[dof];
        assert!((found - q[dof]).abs() < 1e-9 * q[dof].abs(), "{dof}: {found} {}", q[dof]);
    }
    // The gaps are rows of their own: W as functionals.
    let gaps = open.rows(open.directions()).unwrap();
    for i in 0..3 {
        let expected: f64 = (0..n).map(|d| open.directions().to_dense()[(d, i)] * q[d]).sum();
        assert!((gaps.value(i, &eta, &lambda) + load.gaps[i] - expected).abs() < 1e-9 * expected.abs());
    }
}

#[test]
fn truncation_is_the_reduction_with_fewer_modes() {
    let model = beam(32);
    let open = OpenModes::of_model(&model, ModeCount::Lowest(12)).unwrap();
    let (fewer, again) = (open.truncated(6).unwrap(), OpenModes::of_model(&model, ModeCount::Lowest(6)).unwrap());
    assert_eq!((fewer.n_modes(), fewer.omega_squared().len()), (6, 6));
    assert!(distance(fewer.flexibility(), again.flexibility()) < 1e-9);
    let rows = [&fewer, &again].map(|open| open.rows_of_dofs(&[3, 8, 20]).unwrap());
    assert!(distance(&rows[0].forces, &rows[1].forces) < 1e-9);
    assert_eq!(open.truncated(0).unwrap_err(), ReductionError::NoMode { wanted: 0 });
}

#[test]
fn modes_are_counted_up_to_a_frequency() {
    let model = rod(200, Support::Clamped, 1.0, 1.0);
    let all = OpenModes::of_model(&model, ModeCount::Lowest(60)).unwrap();
    for count in [1, 15, 16, 17, 40] {
        let limit = 0.5 * (all.omega_squared()[count - 1].sqrt() + all.omega_squared()[count].sqrt());
        assert_eq!(OpenModes::of_model(&model, ModeCount::UpTo(limit)).unwrap().n_modes(), count);
    }
    let below_all = 0.1 * all.omega_squared()[0].sqrt();
    assert_eq!(OpenModes::of_model(&model, ModeCount::UpTo(below_all)).unwrap().n_modes(), 1);
    let refused = OpenModes::of_model(&model, ModeCount::UpTo(-1.0)).unwrap_err();
    assert_eq!(refused, ReductionError::FrequencyLimit { omega: -1.0 });
}

#[test]
fn improper_parts_are_refused() {
    let unit = |n: usize| sparse_from_triplets(n, n, &(0..n).map(|i| (i, i, 1.0)).collect::<Vec<_>>()).unwrap();
    let w = |value: f64| sparse_from_triplets(2, 1, &[(1, 0, value)]).unwrap();
    let new = |w, gaps: &[f64], compliance: &[f64], modes| {
        OpenModes::new(unit(2), unit(2), w, gaps.to_vec(), compliance.to_vec(), modes).map(|_| ()).unwrap_err()
    };
    let one = ModeCount::Lowest(1);
    let dimension = |what, expected, found| ReductionError::Dimension { what, expected, found };
    let wide = sparse_from_triplets(3, 1, &[]).unwrap();
    assert_eq!(new(wide, &[0.0], &[0.0], one), dimension("rows of the contact directions", 2, 3));
    assert_eq!(new(w(1.0), &[], &[0.0], one), dimension("gaps of the contacts", 1, 0));
    assert_eq!(new(w(1.0), &[0.0], &[0.0, 1.0], one), dimension("compliances of the stops", 1, 2));
    assert!(matches!(new(w(1.0), &[f64::NAN], &[0.0], one), ReductionError::NotFinite { index: 0, .. }));
    assert_eq!(new(w(1.0), &[0.0], &[-1.0], one), ReductionError::StopCompliance { contact: 0, value: -1.0 });
    assert_eq!(new(w(1.0), &[0.0], &[0.0], ModeCount::Lowest(0)), ReductionError::NoMode { wanted: 0 });
    let open = OpenModes::new(unit(2), unit(2), w(1.0), vec![0.0], vec![0.0], one).unwrap();
    assert_eq!(open.load(&[1.0]).unwrap_err(), dimension("entries of the load", 2, 1));
    assert_eq!(open.rows(&unit(3)).unwrap_err(), dimension("rows of the functionals", 2, 3));
    assert!(matches!(open.rows_of_dofs(&[7]).unwrap_err(), ReductionError::Linalg { .. }));
}
