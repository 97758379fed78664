use super::*;
use nalgebra::{RowVector4, SVector};

const LENGTHS: [f64; 4] = [0.01, 0.1, 1.0, 30.0];

fn steel() -> Material {
    Material::new(181.36e9, 7730.0).unwrap()
}

fn section() -> Section {
    Section::rectangle(0.012, 0.020).unwrap()
}

fn element(length: f64, mass_matrix: MassMatrix) -> ElementMatrices<6> {
    timoshenko_element(&steel(), &section(), length, mass_matrix)
}

/// Translation along, translation across, rotation about the first node.
fn rigid_motions(l: f64) -> [SVector<f64, 6>; 3] {
    [[1.0, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 1.0, 0.0, l, 1.0]].map(SVector::from)
}

#[test]
fn rigid_motions_need_no_force() {
    for l in LENGTHS {
        let k = element(l, MassMatrix::Consistent).stiffness;
        for motion in rigid_motions(l) {
            let (force, scale) = (k * motion, k.abs() * motion.abs());
            assert!((0..6).all(|i| force[i].abs() <= 1e-14 * scale[i]), "{force}");
        }
    }
}

#[test]
fn matrices_are_symmetric() {
    for kind in [MassMatrix::Consistent, MassMatrix::Lumped] {
        let ElementMatrices { stiffness, mass } = element(0.3, kind);
        assert_eq!((stiffness, mass), (stiffness.transpose(), mass.transpose()));
    }
}

#[test]
fn rigid_motions_carry_the_inertia_of_the_element() {
    let (rho_a, rho_i) = (steel().density() * section().area(), steel().density() * section().second_moment());
    for l in LENGTHS {
        let [along, across, rotation] = rigid_motions(l);
        let m = element(l, MassMatrix::Consistent).mass;
        let product = |a: SVector<f64, 6>, b: SVector<f64, 6>| a.dot(&(m * b));
        for (found, expected) in [
            (product(along, along), rho_a * l),
            (product(across, across), rho_a * l),
            (product(across, rotation), rho_a * l * l / 2.0),
            (product(rotation, rotation), rho_a * l.powi(3) / 3.0 + rho_i * l),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-12, "l = {l}: {found} {expected}");
        }
    }
}

#[test]
fn lumped_mass_is_diagonal_and_has_the_totals() {
    for l in LENGTHS {
        let m = element(l, MassMatrix::Lumped).mass;
        assert_eq!(m, SMatrix::from_diagonal(&m.diagonal()));
        let (rho_a, rho_i) = (steel().density() * section().area(), steel().density() * section().second_moment());
        for (i, total) in [(0, rho_a * l), (1, rho_a * l), (2, rho_i * l)] {
            assert!(((m[(i, i)] + m[(i + 3, i + 3)]) / total - 1.0).abs() < 1e-14);
        }
    }
}

/// Shape functions of deflection and rotation at `x = ξ l`.
fn shapes(xi: f64, l: f64, phi: f64) -> (RowVector4<f64>, RowVector4<f64>) {
    let (x2, x3) = (xi * xi, xi * xi * xi);
    let deflection = RowVector4::new(
        2.0 * x3 - 3.0 * x2 - phi * xi + 1.0 + phi,
        l * (x3 - (2.0 + phi / 2.0) * x2 + (1.0 + phi / 2.0) * xi),
        -2.0 * x3 + 3.0 * x2 + phi * xi,
        l * (x3 - (1.0 - phi / 2.0) * x2 - phi / 2.0 * xi),
    );
    let rotation = RowVector4::new(
        6.0 * (x2 - xi) / l,
        3.0 * x2 - (4.0 + phi) * xi + 1.0 + phi,
        -6.0 * (x2 - xi) / l,
        3.0 * x2 - (2.0 - phi) * xi,
    );
    (deflection / (1.0 + phi), rotation / (1.0 + phi))
}

/// `∫ f dx` over the element by the four-point Gauss rule, exact up to the seventh power.
fn integral(l: f64, f: impl Fn(f64) -> Matrix4<f64>) -> Matrix4<f64> {
    let root = (6.0_f64 / 5.0).sqrt();
    let points = [(3.0 - 2.0 * root) / 7.0, (3.0 + 2.0 * root) / 7.0].map(f64::sqrt);
    let weights = [18.0 + 30.0_f64.sqrt(), 18.0 - 30.0_f64.sqrt()].map(|w| w / 36.0);
    let mut sum = Matrix4::zeros();
    for (x, w) in points.iter().zip(weights) {
        sum += (f((1.0 - x) / 2.0) + f((1.0 + x) / 2.0)) * (w * l / 2.0);
    }
    sum
}

#[test]
fn consistent_mass_and_stiffness_are_the_integrals_of_the_shape_functions() {
    for (l, phi) in [(0.5, 0.0), (2.0, 0.3), (1.0, 7.0)] {
        let translation = integral(l, |xi| shapes(xi, l, phi).0.transpose() * shapes(xi, l, phi).0);
        let rotary = integral(l, |xi| shapes(xi, l, phi).1.transpose() * shapes(xi, l, phi).1);
        assert!((translation - translation_mass(1.0, l, phi)).norm() < 1e-13 * translation.norm());
        assert!((rotary - rotary_mass(1.0, l, phi)).norm() < 1e-13 * rotary.norm());
        // φ is quadratic and w cubic, so that these differences are exact.
        let d = |f: &dyn Fn(f64) -> RowVector4<f64>, xi: f64| {
            (8.0 * (f(xi + 0.1) - f(xi - 0.1)) - (f(xi + 0.2) - f(xi - 0.2))) / (1.2 * l)
        };
        let curvature = |xi| d(&|x| shapes(x, l, phi).1, xi);
        let shear = |xi| d(&|x| shapes(x, l, phi).0, xi) - shapes(xi, l, phi).1;
        let bending = integral(l, |xi| curvature(xi).transpose() * curvature(xi));
        let shearing = integral(l, |xi| shear(xi).transpose() * shear(xi));
        // κGA = 12 EI / Φ l²
        let k = if phi > 0.0 { bending + shearing * (12.0 / (phi * l * l)) } else { bending };
        assert!((k - bending_stiffness(1.0, l, phi)).norm() < 1e-11 * k.norm());
    }
}

#[test]
fn shear_parameter_of_the_rectangle() {
    // 12 EI / κGA l² = 2 (1 + ν) / κ · (h / l)²
    let expected = 2.0 * 1.3 / (5.0 / 6.0) * (0.020_f64 / 0.1).powi(2);
    assert!((shear_parameter(&steel(), &section(), 0.1) / expected - 1.0).abs() < 1e-14);
}
