//! Structures that were reduced elsewhere.

use nlmodes_linalg::{Mat, Openness, SparseMatrix, symmetric_eigen};

use crate::reduction::open_modes::{all_finite, check_stops, same_size, separate_repeated};
use crate::reduction::residual::{Residual, add_share};
use crate::reduction::rest::felt_rows;
use crate::reduction::{OpenModes, ReductionError};

/// Digits in which numbers of other programs agree with each other: share of the static flexibility up to which
/// mirrored entries of a flexibility may differ, and up to which it may be negative beyond the modes.
const AGREED: f64 = 1e-5;

/// Free-interface modes and static flexibility that another program computed, of a structure that is known by n of its
/// displacements: l of contacts and of places where forces act, and behind them those that are looked at only.
#[derive(Debug, Clone)]
pub struct GivenModes {
    /// `ω_r²`, ascending, rad²/s²; zero for each rigid-body motion.
    pub omega_squared: Vec<f64>,
    /// Displacements in the mass-normalised modes, n × m, 1/√kg.
    pub rows: Mat<f64>,
    /// Static displacements under unit forces along the first l of them, n × l, m/N.
    pub flexibility: GivenFlexibility,
}

/// Static flexibility between the displacements by which a structure is known, n × l, m/N.
#[derive(Debug, Clone)]
pub enum GivenFlexibility {
    /// The whole one, `F = Lᵀ K⁻¹ L`.
    Static(Mat<f64>),
    /// What the modes leave of it, `F − Y Ω⁻² Yᵀ`; of a structure that floats that of loads in balance with the inertia
    /// forces of the modes.
    Residual(Mat<f64>),
}

impl OpenModes {
    /// The structure that was reduced elsewhere, before contacts with these directions (n × c, one column a contact,
    /// `g = g₀ + Wᵀ q` with the displacements `q` by which the structure is known). `gaps` (m) and `stop_compliance`
    /// (m/N, zero for rigid stops) have one entry a contact.
    ///
    /// ```
    /// use nlmodes_linalg::{Mat, sparse_from_triplets};
    /// use nlmodes_model::reduction::{GivenFlexibility, GivenModes, OpenModes};
    ///
    /// // The tip of a rod with EA = ρA = L = 1: the first of its modes, and the flexibility L/EA.
    /// let omega = std::f64::consts::FRAC_PI_2;
    /// let row = Mat::from_fn(1, 1, |_, _| 2.0_f64.sqrt());
    /// let flexibility = GivenFlexibility::Static(Mat::from_fn(1, 1, |_, _| 1.0));
    /// let rod = GivenModes { omega_squared: vec![omega * omega], rows: row, flexibility };
    /// let w = sparse_from_triplets(1, 1, &[(0, 0, -1.0)])?;
    /// let open = OpenModes::given(rod, w, vec![0.1], vec![0.0])?;
    /// assert!((open.flexibility()[(0, 0)] - (1.0 - 2.0 / (omega * omega))).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ReductionError::Dimension`], [`ReductionError::NotFinite`], [`ReductionError::StopCompliance`],
    /// [`ReductionError::NoMode`], [`ReductionError::OnlyRigidModes`], [`ReductionError::Descending`] for the modes;
    /// [`ReductionError::NotSymmetric`], [`ReductionError::NegativeFlexibility`], [`ReductionError::LessThanModes`],
    /// [`ReductionError::FloatingFlexibility`] for the flexibility; [`ReductionError::Linalg`] if the eigenvalues by
    /// which it is judged are not found.
    pub fn given(
        of: GivenModes,
        directions: SparseMatrix,
        gaps: Vec<f64>,
        stop_compliance: Vec<f64>,
    ) -> Result<Self, ReductionError> {
        let GivenModes { omega_squared, mut rows, flexibility } = of;
        same_size("modes of the rows", omega_squared.len(), rows.ncols())?;
        same_size("rows of the contact directions", rows.nrows(), directions.nrows())?;
        check_stops(&directions, &gaps, &stop_compliance)?;
        all_finite("entry of the contact directions", directions.val())?;
        let rigid = rigid_motions(&omega_squared)?;
        (0..rows.ncols()).try_for_each(|r| all_finite("entry of the rows", &column(&rows, r)))?;
        let shift = if rigid > 0 { omega_squared[rigid] } else { 0.0 };
        let loaded = flexibility.matrix().ncols();
        let modal = modal_flexibility(&omega_squared, &rows, loaded);
        let flexibility = residual(flexibility, &modal, rigid)?;
        separate_repeated(&omega_squared, &mut rows, &directions, shift)?;
        let mut openness = Openness::default();
        openness.strainless = rigid;
        let mut open = Self {
            contact_rows: felt_rows(&directions, &rows),
            flexibility: Mat::zeros(gaps.len(), gaps.len()),
            omega_squared,
            shapes: rows,
            residual_shapes: None,
            openness,
            hourglass_motions: 0,
            directions,
            residual: Residual::Given { flexibility, shift },
            steady_force: Vec::new(),
            gaps,
            stop_compliance,
        };
        open.press_contacts();
        Ok(open)
    }
}

/// How many modes are rigid-body motions, of modes that ascend.
fn rigid_motions(omega_squared: &[f64]) -> Result<usize, ReductionError> {
    all_finite("ω² of mode", omega_squared)?;
    let before = |r: usize| r.checked_sub(1).map_or(0.0, |r| omega_squared[r]);
    if let Some(r) = (0..omega_squared.len()).find(|&r| omega_squared[r] < before(r)) {
        return Err(ReductionError::Descending { mode: r + 1, omega_squared: omega_squared[r], before: before(r) });
    }
    match omega_squared.iter().take_while(|square| **square == 0.0).count() {
        _ if omega_squared.is_empty() => Err(ReductionError::NoMode { wanted: 1 }),
        rigid if rigid == omega_squared.len() => Err(ReductionError::OnlyRigidModes { retained: rigid }),
        rigid => Ok(rigid),
    }
}

impl GivenFlexibility {
    /// The numbers.
    pub fn matrix(&self) -> &Mat<f64> {
        match self {
            Self::Static(matrix) | Self::Residual(matrix) => matrix,
        }
    }
}

/// `Y Ω⁻² Y_lᵀ` of the elastic modes with displacements `rows` (n × m), under loads along the first `loaded` of these,
/// n × l, m/N.
pub fn modal_flexibility(omega_squared: &[f64], rows: &Mat<f64>, loaded: usize) -> Mat<f64> {
    let mut modal = Mat::zeros(rows.nrows(), loaded.min(rows.nrows()));
    let elastic = omega_squared.iter().enumerate().filter(|(_, square)| **square > 0.0);
    elastic.for_each(|(r, square)| add_share(&mut modal, (rows, r), 1.0 / square));
    modal
}

/// The residual flexibility, between displacements that can be loaded symmetric and not negative but for the last
/// digits of what it was computed from.
fn residual(given: GivenFlexibility, modal: &Mat<f64>, rigid: usize) -> Result<Mat<f64>, ReductionError> {
    let (given, is_static) = match given {
        GivenFlexibility::Static(_) if rigid > 0 => return Err(ReductionError::FloatingFlexibility),
        GivenFlexibility::Static(given) => (given, true),
        GivenFlexibility::Residual(given) => (given, false),
    };
    let n = modal.ncols();
    same_size("rows of the flexibility", modal.nrows(), given.nrows())?;
    same_size("columns of the flexibility", n, given.ncols())?;
    (0..n).try_for_each(|j| all_finite("entry of the flexibility", &column(&given, j)))?;
    let whole = |i: usize| if is_static { given[(i, i)].max(modal[(i, i)]) } else { given[(i, i)] + modal[(i, i)] };
    let size: Vec<f64> = (0..n).map(|i| whole(i).max(0.0).sqrt()).collect();
    let pairs = || (0..n).flat_map(|j| (0..j).map(move |i| (i, j)));
    let differ = |(i, j): &(usize, usize)| (given[(*i, *j)] - given[(*j, *i)]).abs() > AGREED * size[*i] * size[*j];
    if let Some((i, j)) = pairs().find(differ) {
        let (value, mirrored) = (given[(i, j)], given[(j, i)]);
        return Err(ReductionError::NotSymmetric { row: i + 1, column: j + 1, value, mirrored });
    }
    let share = |i: usize, j: usize| if is_static { modal[(i, j)] } else { 0.0 };
    let mean = |i: usize, j: usize| if i < n { 0.5 * (given[(i, j)] + given[(j, i)]) } else { given[(i, j)] };
    let residual = Mat::from_fn(modal.nrows(), n, |i, j| mean(i, j) - share(i, j));
    match most_negative(&residual, &size)? {
        None => Ok(residual),
        Some(row) if is_static => {
            let (flexibility, modal) = (given[(row, row)], modal[(row, row)]);
            Err(ReductionError::LessThanModes { row: row + 1, flexibility, modal })
        }
        Some(row) => Err(ReductionError::NegativeFlexibility { row: row + 1, flexibility: given[(row, row)] }),
    }
}

/// The displacement that a combination of forces moves most against them, where they move it against them at all; with
/// the square roots of the static flexibilities as scales.
fn most_negative(residual: &Mat<f64>, size: &[f64]) -> Result<Option<usize>, ReductionError> {
    let n = size.len();
    // A displacement that yields to nothing has no entries beside zeros.
    if let Some(rigid) = (0..n).find(|&i| size[i] == 0.0 && (0..n).any(|j| residual[(i, j)] != 0.0)) {
        return Ok(Some(rigid));
    }
    let scale = |i: usize| if size[i] > 0.0 { 1.0 / size[i] } else { 1.0 };
    let scaled = Mat::from_fn(n, n, |i, j| scale(i) * residual[(i, j)] * scale(j));
    let (values, vectors) = symmetric_eigen(&scaled).map_err(ReductionError::during("flexibility between the rows"))?;
    let lowest = (0..n).min_by(|a, b| values[*a].total_cmp(&values[*b]));
    let negative = lowest.filter(|&k| values[k] < -AGREED);
    Ok(negative.and_then(|k| (0..n).max_by(|a, b| vectors[(*a, k)].abs().total_cmp(&vectors[(*b, k)].abs()))))
}

fn column(of: &Mat<f64>, j: usize) -> Vec<f64> {
    of.col(j).iter().copied().collect()
}
