//! Natural frequencies of a clamped rod and a slender cantilever, compared with closed forms, over the number of
//! elements.
//!
//! `cargo run -p nlmodes-fem --example frequencies`

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, TAU};

use nlmodes_fem::{Beam, MassMatrix, Material, Mesh, Rod, Section, Support};
use nlmodes_model::linear_modes;

const YOUNG: f64 = 210e9; // Pa
const DENSITY: f64 = 7850.0; // kg/m³
const LENGTH: f64 = 2.0; // m
const HEIGHT: f64 = 2e-3; // m, a thousandth of the length: shear and rotatory inertia do not count

/// Relative errors of the first frequencies of rod and beam.
fn errors(elements: usize, mass_matrix: MassMatrix) -> Result<[f64; 2], Box<dyn Error>> {
    let material = Material::new(YOUNG, DENSITY)?;
    let mesh = Mesh::uniform(LENGTH, elements)?;
    let (start, end) = (Support::Clamped, Support::Free);
    let rod = Rod { material, area: 1e-4, mesh: mesh.clone(), mass_matrix, start, end }.assemble(&[])?;
    let section = Section::rectangle(0.05, HEIGHT)?;
    let beam = Beam { material, section, mesh, mass_matrix, start, end }.assemble(&[])?;
    let wave_speed = (YOUNG / DENSITY).sqrt();
    // cos β cosh β = −1
    let beta: f64 = 1.875_104_068_711_961;
    let exact = [FRAC_PI_2 * wave_speed / LENGTH, (beta / LENGTH).powi(2) * wave_speed * HEIGHT / 12_f64.sqrt()];
    // The first bending mode is below the axial modes.
    let found = [linear_modes(rod.mass(), rod.stiffness(), 1)?, linear_modes(beam.mass(), beam.stiffness(), 1)?];
    Ok([0, 1].map(|i| found[i].omega[0] / exact[i] - 1.0))
}

fn main() -> Result<(), Box<dyn Error>> {
    let hertz = (YOUNG / DENSITY).sqrt() / LENGTH * FRAC_PI_2 / TAU;
    println!("first mode of the rod: {hertz:.3} Hz\n\nelements  mass matrix   error of rod   error of beam");
    for mass_matrix in [MassMatrix::Consistent, MassMatrix::Lumped] {
        for elements in [4, 8, 16, 32] {
            let [rod, beam] = errors(elements, mass_matrix)?;
            println!("{elements:>8}  {:<11}  {rod:>+13.2e}  {beam:>+14.2e}", mass_matrix.name());
        }
    }
    Ok(())
}

#[test]
fn rods_converge_quadratically_from_above_or_from_below() -> Result<(), Box<dyn Error>> {
    for (mass_matrix, side) in [(MassMatrix::Consistent, 1.0), (MassMatrix::Lumped, -1.0)] {
        let (coarse, fine) = (errors(8, mass_matrix)?, errors(16, mass_matrix)?);
        // Second order, with the leading term ± (π / 4 n)² / 6 of the closed form of the discrete rod.
        let leading = side * (FRAC_PI_2 / 8.0).powi(2) / 24.0;
        assert!((coarse[0] / leading - 1.0).abs() < 0.02, "{:e} {leading:e}", coarse[0]);
        assert!(((coarse[0] / fine[0]).log2() - 2.0).abs() < 0.01);
        // The terms of the beam of order (height / length)² remain.
        assert!(fine[1].abs() < coarse[1].abs() && fine[1].abs() < 3e-3, "{coarse:?} {fine:?}");
    }
    Ok(())
}
