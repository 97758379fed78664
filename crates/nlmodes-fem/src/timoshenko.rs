use nalgebra::{Matrix4, SMatrix};
use nlmodes_model::{DofKind, StructuralModel};

use crate::assembly::{Layout, assemble};
use crate::rod::with_added_mass as rod_with_added_mass;
use crate::step::{check_steps, step_of};
use crate::{ElementMatrices, FemError, MassMatrix, Material, Mesh, Section, Step, Stop, Support};

/// A straight Timoshenko beam with deflection in one plane and axial displacement.
///
/// ```text
/// ρA ẅ = (κGA (w′ − φ))′ ,   ρI φ̈ = (EI φ′)′ + κGA (w′ − φ) ,   ρA ü = (EA u′)′
/// ```
///
/// Three degrees of freedom per node: axial displacement `u`, deflection `w`, rotation `φ`, in this order.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    /// Material.
    pub material: Material,
    /// Cross section.
    pub section: Section,
    /// Nodes.
    pub mesh: Mesh,
    /// Consistent or lumped.
    pub mass_matrix: MassMatrix,
    /// Support at `x = 0`.
    pub start: Support,
    /// Support at `x = L`.
    pub end: Support,
}

impl Beam {
    /// Mass and stiffness of the free degrees of freedom with the stops as contacts.
    ///
    /// # Errors
    /// [`FemError::NotANode`], [`FemError::HeldDof`], [`FemError::NothingMoves`] (one element clamped at both ends),
    /// [`FemError::Overflow`], [`FemError::Model`] (a gap that is not finite).
    pub fn assemble(&self, stops: &[Stop]) -> Result<StructuralModel, FemError> {
        self.assemble_stepped(&[], stops)
    }

    /// The same with the material, section and added mass of each step; beyond the last step they are those of the
    /// beam.
    ///
    /// # Errors
    /// As [`Beam::assemble`]; [`FemError::AddedMass`], [`FemError::Step`].
    pub fn assemble_stepped(&self, steps: &[Step<Section>], stops: &[Stop]) -> Result<StructuralModel, FemError> {
        check_steps(steps, &self.mesh)?;
        let layout = Layout {
            mesh: &self.mesh,
            kinds: &[DofKind::Axial, DofKind::Deflection, DofKind::Rotation],
            supports: [self.start, self.end],
            holds: Support::holds_of_beam,
        };
        assemble(&layout, stops, |element, length| match step_of(steps, element) {
            Some(step) => with_added_mass(&step.material, &step.section, step.added_mass, length, self.mass_matrix),
            None => timoshenko_element(&self.material, &self.section, length, self.mass_matrix),
        })
    }
}

/// Two-node Timoshenko element of length `l` with the degrees of freedom `u_1, w_1, φ_1, u_2, w_2, φ_2`.
///
/// The deflection is cubic and the rotation quadratic such that both equations of static equilibrium hold inside the
/// element. Thus the stiffness is exact for nodal loads, and there is no locking: with `Φ = 12 EI / κGA l²`, which
/// vanishes for slender elements,
///
/// ```text
///            EI       |  12     6l         −12    6l         |
/// K = -------------   |  6l    (4+Φ)l²     −6l   (2−Φ)l²     |   in w_1, φ_1, w_2, φ_2 .
///      l³ (1 + Φ)     | −12    −6l          12   −6l         |
///                     |  6l    (2−Φ)l²     −6l   (4+Φ)l²     |
/// ```
///
/// The consistent mass `∫ ρA N_wᵀ N_w + ρI N_φᵀ N_φ dx` comes from the same functions; the lumped one has `ρAl/2` for
/// `u` and `w` and the rotary inertia `ρIl/2` for `φ` at either node. The axial part is [`crate::rod_element`].
///
/// J. S. Przemieniecki, *Theory of Matrix Structural Analysis*, 1968; Z. Friedman, J. B. Kosmatka, *An improved
/// two-node Timoshenko beam finite element*, Computers & Structures 47 (1993) 473-481.
pub fn timoshenko_element(
    material: &Material,
    section: &Section,
    length: f64,
    mass_matrix: MassMatrix,
) -> ElementMatrices<6> {
    with_added_mass(material, section, 0.0, length, mass_matrix)
}

/// [`timoshenko_element`] with `ρA + μ` in place of `ρA`; the rotary inertia is that of the section.
fn with_added_mass(
    material: &Material,
    section: &Section,
    added_mass: f64,
    length: f64,
    mass_matrix: MassMatrix,
) -> ElementMatrices<6> {
    let phi = shear_parameter(material, section, length);
    let (area, inertia) = (section.area(), section.second_moment());
    let (rho_a, rho_i) = (material.density() * area + added_mass, material.density() * inertia);
    let bending = bending_stiffness(material.youngs_modulus() * inertia, length, phi);
    let inertia = match mass_matrix {
        MassMatrix::Consistent => translation_mass(rho_a, length, phi) + rotary_mass(rho_i, length, phi),
        MassMatrix::Lumped => {
            let (m, j) = (rho_a * length / 2.0, rho_i * length / 2.0);
            Matrix4::from_diagonal(&[m, j, m, j].into())
        }
    };
    let axial = rod_with_added_mass(material, area, added_mass, length, mass_matrix);
    ElementMatrices { stiffness: combine(&axial.stiffness, &bending), mass: combine(&axial.mass, &inertia) }
}

/// `Φ = 12 EI / κGA l²`: ratio of the shear flexibility to the bending flexibility of an element.
pub(crate) fn shear_parameter(material: &Material, section: &Section, length: f64) -> f64 {
    let bending = 12.0 * material.youngs_modulus() * section.second_moment();
    bending / (section.shear_factor() * material.shear_modulus() * section.area() * length.powi(2))
}

fn bending_stiffness(ei: f64, l: f64, phi: f64) -> Matrix4<f64> {
    let (near, far) = ((4.0 + phi) * l * l, (2.0 - phi) * l * l);
    #[rustfmt::skip]
    let pattern = Matrix4::new(
         12.0,    6.0 * l, -12.0,    6.0 * l,
        6.0 * l,  near,    -6.0 * l, far,
        -12.0,   -6.0 * l,  12.0,   -6.0 * l,
        6.0 * l,  far,     -6.0 * l, near,
    );
    pattern * (ei / (l.powi(3) * (1.0 + phi)))
}

/// `∫ ρA N_wᵀ N_w dx`.
fn translation_mass(rho_a: f64, l: f64, phi: f64) -> Matrix4<f64> {
    // Polynomials in Φ with the coefficients of Φ², Φ, 1.
    let poly = |a: f64, b: f64, c: f64| (a * phi + b) * phi + c;
    let (a, b) = (poly(70.0, 147.0, 78.0), poly(35.0, 77.0, 44.0) * l / 4.0);
    let (c, d) = (poly(35.0, 63.0, 27.0), poly(35.0, 63.0, 26.0) * l / 4.0);
    let (e, f) = (poly(7.0, 14.0, 8.0) * l * l / 4.0, poly(7.0, 14.0, 6.0) * l * l / 4.0);
    #[rustfmt::skip]
    let pattern = Matrix4::new(
         a,  b,  c, -d,
         b,  e,  d, -f,
         c,  d,  a, -b,
        -d, -f, -b,  e,
    );
    pattern * (rho_a * l / (210.0 * (1.0 + phi).powi(2)))
}

/// `∫ ρI N_φᵀ N_φ dx`.
fn rotary_mass(rho_i: f64, l: f64, phi: f64) -> Matrix4<f64> {
    let slope = (3.0 - 15.0 * phi) * l;
    let near = ((10.0 * phi + 5.0) * phi + 4.0) * l * l;
    let far = ((5.0 * phi - 5.0) * phi - 1.0) * l * l;
    #[rustfmt::skip]
    let pattern = Matrix4::new(
         36.0,   slope, -36.0,   slope,
         slope,  near,  -slope,  far,
        -36.0,  -slope,  36.0,  -slope,
         slope,  far,   -slope,  near,
    );
    pattern * (rho_i / (30.0 * l * (1.0 + phi).powi(2)))
}

/// Axial and bending parts in the order `u_1, w_1, φ_1, u_2, w_2, φ_2`.
fn combine(axial: &SMatrix<f64, 2, 2>, bending: &Matrix4<f64>) -> SMatrix<f64, 6, 6> {
    SMatrix::from_fn(|i, j| match (i % 3, j % 3) {
        (0, 0) => axial[(i / 3, j / 3)],
        (0, _) | (_, 0) => 0.0,
        (p, q) => bending[(2 * (i / 3) + p - 1, 2 * (j / 3) + q - 1)],
    })
}

#[cfg(test)]
mod tests;
