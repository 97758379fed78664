use super::archive::{write_archive, write_array, write_numbers, write_texts};
use crate::ReportError;
use crate::columns::Column;
use nlmodes_modal::{ModalBranch, ModalPoint};
use num_complex::Complex64;
use std::path::Path;

/// Arrays of `harmonics.npz`.
pub const HARMONIC_ARRAYS: [Column; 4] = [
    Column::new("omega", "P, rad/s", "nonlinear modal frequency"),
    Column::new(
        "coefficients",
        "P × D × (H + 1), m or rad",
        "complex coefficients q_n, amplitudes not root mean squares; zero where a point has fewer harmonics",
    ),
    Column::new("dof_position_m", "D, m", "position of each degree of freedom along the axis"),
    Column::new(
        "dof_kind",
        "D",
        "`axial`, `deflection` or `rotation`; in responses of several structures with its number, as `axial-2`; \
            `modal` and `contact` of structures from files, in their responses `x` to `rz`, and `row` of those that \
            were reduced elsewhere, in their order",
    ),
];

/// Writes the motions of a branch as a NumPy archive, which `numpy.load` reads without `allow_pickle`.
///
/// Its arrays are those of `columns::FILES`: float64, complex128 and Unicode text.
///
/// # Errors
/// [`ReportError::CoefficientShape`] if a point does not have the coordinates of the branch, [`ReportError::Io`] if the
/// file cannot be written.
pub fn write_harmonics(path: impl AsRef<Path>, branch: &ModalBranch) -> Result<(), ReportError> {
    let width = common_width(branch)?;
    write_archive(path.as_ref(), |archive| {
        let omega: Vec<f64> = branch.points.iter().map(|point| point.omega).collect();
        write_numbers(archive, "omega", &omega)?;
        let shape = [branch.points.len(), branch.coordinates.len(), width];
        write_array(archive, "coefficients", &shape, all_coefficients(branch, width))?;
        let positions: Vec<f64> = branch.coordinates.iter().map(|coordinate| coordinate.position).collect();
        write_numbers(archive, "dof_position_m", &positions)?;
        let kinds: Vec<&str> = branch.coordinates.iter().map(|coordinate| coordinate.kind.as_str()).collect();
        write_texts(archive, "dof_kind", &kinds)
    })
}

/// Largest number of harmonics + 1 of a point; 1 for a branch without points.
pub(super) fn common_width(branch: &ModalBranch) -> Result<usize, ReportError> {
    let width = branch.points.iter().map(|point| point.coefficients.n_harmonics() + 1).max().unwrap_or(1);
    let expected = (branch.coordinates.len(), width);
    for (index, point) in branch.points.iter().enumerate() {
        let found = (point.coefficients.n_coordinates(), point.coefficients.n_harmonics() + 1);
        if found.0 != expected.0 {
            return Err(ReportError::CoefficientShape { point: index, found, expected });
        }
    }
    Ok(width)
}

/// The coefficients of all points, one after the other, each with `width` harmonics.
pub(super) fn all_coefficients(branch: &ModalBranch, width: usize) -> impl Iterator<Item = Complex64> {
    let of = move |point: &'_ ModalPoint, d: usize| {
        let own = point.coefficients.of(d).to_vec();
        own.into_iter().chain(std::iter::repeat(Complex64::default())).take(width)
    };
    branch.points.iter().flat_map(move |point| (0..branch.coordinates.len()).flat_map(move |d| of(point, d)))
}
