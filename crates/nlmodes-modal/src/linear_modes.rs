use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::{HarmonicCoefficients, ModalError};

/// Singular values below this fraction of the largest are zero: the positions do not distinguish the shapes.
const RANK_TOLERANCE: f64 = 1e-10;

/// Mass-normalised linear modes at some coordinates, `Φ` of eq. (30), `Φᵀ M Φ = 1`.
///
/// A motion `q` at the coordinates has the modal coordinates `η = Φ⁺ q`, in the sense of least squares where there are
/// more coordinates than modes; then `qᴴ M q = ηᴴ η`, so a motion measured at a few positions can be mass-normalised
/// (eq. 22).
///
/// Shapes: `Φ` is coordinates × modes, unit 1/√kg; `η` has the unit m·√kg.
///
/// ```
/// use nlmodes_modal::LinearModes;
/// let modes = LinearModes::new(&[0.0, 1.0], &[1.0, 3.0], &[0.01, 0.01], &[vec![1.0, 1.0], vec![1.0, -1.0]])?;
/// let eta = modes.project(&[3.0.into(), 1.0.into()]);
/// assert!((eta[0].re - 2.0).abs() < 1e-14 && (eta[1].re - 1.0).abs() < 1e-14);
/// # Ok::<(), nlmodes_modal::ModalError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LinearModes {
    positions: Vec<f64>,
    omegas: Vec<f64>,
    damping_ratios: Vec<f64>,
    shapes: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl LinearModes {
    /// Modes at `positions` (m) with eigenfrequencies `omegas` (rad/s) and damping ratios; `shapes` has one row per
    /// position and one entry per mode (1/√kg).
    ///
    /// # Errors
    /// [`ModalError::ShapeTable`] if the table has rows of different lengths or another number of rows than positions,
    /// or more modes than frequencies or damping ratios; [`ModalError::NotFinite`]; [`ModalError::DependentShapes`] if
    /// the positions do not distinguish the modes, as always with fewer positions than modes.
    pub fn new(
        positions: &[f64],
        omegas: &[f64],
        damping_ratios: &[f64],
        shapes: &[Vec<f64>],
    ) -> Result<Self, ModalError> {
        let n_modes = shapes.first().map_or(0, Vec::len);
        let table = ModalError::ShapeTable {
            rows: shapes.len(),
            columns: n_modes,
            positions: positions.len(),
            modes: omegas.len().min(damping_ratios.len()),
        };
        let even = shapes.iter().all(|row| row.len() == n_modes);
        if !even || n_modes == 0 || shapes.len() != positions.len() || n_modes > omegas.len().min(damping_ratios.len())
        {
            return Err(table);
        }
        let numbers = positions.iter().chain(omegas).chain(damping_ratios).chain(shapes.iter().flatten());
        if !numbers.into_iter().all(|x| x.is_finite()) {
            return Err(ModalError::NotFinite { what: "linear modes" });
        }
        let shapes = DMatrix::from_fn(positions.len(), n_modes, |i, j| shapes[i][j]);
        let inverse = pseudo_inverse(&shapes)?;
        let (omegas, damping_ratios) = (omegas[..n_modes].to_vec(), damping_ratios[..n_modes].to_vec());
        Ok(Self { positions: positions.to_vec(), omegas, damping_ratios, shapes, inverse })
    }

    /// Number of coordinates.
    pub fn n_coordinates(&self) -> usize {
        self.shapes.nrows()
    }

    /// Number of modes.
    pub fn n_modes(&self) -> usize {
        self.shapes.ncols()
    }

    /// Positions of the coordinates, m.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Eigenfrequencies, rad/s.
    pub fn omegas(&self) -> &[f64] {
        &self.omegas
    }

    /// Damping ratios.
    pub fn damping_ratios(&self) -> &[f64] {
        &self.damping_ratios
    }

    /// Shape of mode `k` at coordinate `d`, 1/√kg.
    pub fn shape(&self, d: usize, k: usize) -> f64 {
        self.shapes[(d, k)]
    }

    /// The same modes at the coordinates `rows`, the first `n_modes` of them.
    ///
    /// # Errors
    /// [`ModalError::DependentShapes`] if these coordinates do not distinguish these modes.
    ///
    /// # Panics
    /// If there is no such row or mode.
    pub fn restricted(&self, rows: &[usize], n_modes: usize) -> Result<Self, ModalError> {
        let shapes = DMatrix::from_fn(rows.len(), n_modes, |i, j| self.shapes[(rows[i], j)]);
        Ok(Self {
            positions: rows.iter().map(|i| self.positions[*i]).collect(),
            omegas: self.omegas[..n_modes].to_vec(),
            damping_ratios: self.damping_ratios[..n_modes].to_vec(),
            inverse: pseudo_inverse(&shapes)?,
            shapes,
        })
    }

    /// Modal coordinates `η = Φ⁺ q` of one motion `q`, m·√kg.
    ///
    /// # Panics
    /// If the number of entries of `motion` is not the number of coordinates.
    pub fn project(&self, motion: &[Complex64]) -> Vec<Complex64> {
        assert_eq!(motion.len(), self.n_coordinates());
        (0..self.n_modes()).map(|k| self.coordinate(k, motion)).collect()
    }

    /// Modal coordinate `k` of one motion.
    fn coordinate(&self, k: usize, motion: &[Complex64]) -> Complex64 {
        motion.iter().enumerate().map(|(d, q)| q * self.inverse[(k, d)]).sum()
    }

    /// Motion `Φ η` of modal coordinates at the coordinates.
    ///
    /// # Panics
    /// If the number of entries of `modal` is not the number of modes.
    pub fn expand(&self, modal: &[Complex64]) -> Vec<Complex64> {
        assert_eq!(modal.len(), self.n_modes());
        let row = |d: usize| modal.iter().enumerate().map(move |(k, eta)| eta * self.shapes[(d, k)]);
        (0..self.n_coordinates()).map(|d| row(d).sum()).collect()
    }

    /// Modal coordinates of every harmonic: modes × (H + 1).
    ///
    /// # Panics
    /// If the motion has another number of coordinates.
    pub fn modal_coordinates(&self, motion: &HarmonicCoefficients) -> HarmonicCoefficients {
        let mut modal = HarmonicCoefficients::zeros(self.n_modes(), motion.n_harmonics());
        for n in 0..=motion.n_harmonics() {
            let q: Vec<Complex64> = (0..motion.n_coordinates()).map(|d| motion.of(d)[n]).collect();
            self.project(&q).into_iter().enumerate().for_each(|(k, eta)| modal.of_mut(k)[n] = eta);
        }
        modal
    }

    /// `qᴴ M q = ‖Φ⁺ q‖²` of one motion, kg·m².
    ///
    /// # Panics
    /// As [`Self::project`].
    pub fn mass_norm_squared(&self, motion: &[Complex64]) -> f64 {
        self.project(motion).iter().map(Complex64::norm_sqr).sum()
    }

    /// `qᴴ C q = Σ_k 2 ζ_k ω_k |η_k|²` of one motion with the damping of these modes, kg·m²/s. Allocates nothing.
    ///
    /// # Panics
    /// If `motion` has fewer entries than there are coordinates.
    pub fn damping_form(&self, motion: &[Complex64]) -> f64 {
        let of = |k: usize| 2.0 * self.damping_ratios[k] * self.omegas[k] * self.coordinate(k, motion).norm_sqr();
        (0..self.n_modes()).map(of).sum()
    }
}

fn pseudo_inverse(shapes: &DMatrix<f64>) -> Result<DMatrix<f64>, ModalError> {
    let (coordinates, modes) = shapes.shape();
    let dependent = |ratio| ModalError::DependentShapes { coordinates, modes, ratio };
    if coordinates < modes {
        return Err(dependent(0.0));
    }
    // The iteration limit is far above what finite matrices need, and prevents an infinite loop otherwise.
    let svd = shapes.clone().try_svd(true, true, f64::EPSILON, 1000).ok_or_else(|| dependent(0.0))?;
    let (largest, smallest) = (svd.singular_values.max(), svd.singular_values.min());
    if smallest.is_nan() || smallest <= RANK_TOLERANCE * largest {
        return Err(dependent(if largest > 0.0 { smallest / largest } else { 0.0 }));
    }
    svd.pseudo_inverse(0.0).map_err(|_| dependent(smallest / largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mass_norm_is_that_of_the_mass_matrix() {
        // M = diag(2, 0.5), Φ = M^{-1/2} times a rotation.
        [1.0, 1e8, 1e-8].into_iter().for_each(the_mass_norm_in);
    }

    fn the_mass_norm_in(unit: f64) {
        let (c, s) = (0.3_f64.cos(), 0.3_f64.sin());
        let m = [2.0 * unit, 0.5 * unit];
        let shapes = [vec![c / m[0].sqrt(), -s / m[0].sqrt()], vec![s / m[1].sqrt(), c / m[1].sqrt()]];
        let modes = LinearModes::new(&[0.1, 0.2], &[10.0, 20.0, 30.0], &[0.0, 0.0, 0.0], &shapes).unwrap();
        let q = [Complex64::new(0.3, -1.0), Complex64::new(2.0, 0.4)];
        let direct: f64 = q.iter().zip(m).map(|(q, m)| m * q.norm_sqr()).sum();
        assert!((modes.mass_norm_squared(&q) - direct).abs() < 1e-13 * direct);
        let back = modes.expand(&modes.project(&q));
        assert!(back.iter().zip(q).all(|(a, b)| (a - b).norm() < 1e-14));
    }

    #[test]
    fn damping_takes_what_each_mode_loses() {
        // Two modes with one coordinate each: 2 ζ ω of each, times the square of its coordinate.
        let modes =
            LinearModes::new(&[0.0, 1.0], &[10.0, 30.0], &[0.01, 0.002], &[vec![0.5, 0.0], vec![0.0, 2.0]]).unwrap();
        let form = modes.damping_form(&[Complex64::new(0.0, 1.0), Complex64::new(3.0, 4.0)]);
        assert!((form - (0.2 * 4.0 + 0.12 * 6.25)).abs() < 1e-14, "{form}");
    }

    #[test]
    fn shapes_are_those_given_and_so_are_those_at_some_of_the_coordinates() {
        let shapes = [vec![1.0, 2.0, 3.0], vec![4.0, 5.0, 6.5], vec![7.0, 8.5, 9.0]];
        let modes = LinearModes::new(&[0.1, 0.2, 0.3], &[10.0, 20.0, 30.0], &[0.01, 0.02, 0.03], &shapes).unwrap();
        let all = |of: &dyn Fn(usize, usize) -> bool| (0..3).all(|d| (0..3).all(|k| of(d, k)));
        assert!(all(&|d, k| modes.shape(d, k) == shapes[d][k]));
        let part = modes.restricted(&[2, 0], 2).unwrap();
        assert_eq!(
            (part.positions(), part.omegas(), part.damping_ratios()),
            (&[0.3, 0.1][..], &[10.0, 20.0][..], &[0.01, 0.02][..])
        );
        assert_eq!([part.shape(0, 0), part.shape(0, 1), part.shape(1, 0), part.shape(1, 1)], [7.0, 8.5, 1.0, 2.0]);
        // 3 of the first mode and −2 of the second, at those coordinates.
        let eta = part.project(&[(21.0 - 17.0).into(), (3.0 - 4.0).into()]);
        assert!((eta[0] - 3.0).norm() < 1e-13 && (eta[1] + 2.0).norm() < 1e-13, "{eta:?}");
        assert!(modes.restricted(&[1], 2).is_err());
    }

    #[test]
    fn more_positions_than_modes_are_a_least_squares_fit() {
        let shapes = [vec![1.0], vec![2.0], vec![2.0]];
        let modes = LinearModes::new(&[0.0, 1.0, 2.0], &[1.0], &[0.0], &shapes).unwrap();
        let eta = modes.project(&[1.0.into(), 2.0.into(), 2.9.into()]);
        assert!((eta[0].re - (1.0 + 4.0 + 5.8) / 9.0).abs() < 1e-14);
    }

    #[test]
    fn what_cannot_be_told_apart_is_refused() {
        let shapes = |b: f64| [vec![1.0, 2.0], vec![2.0, b]];
        assert!(LinearModes::new(&[0.0, 1.0], &[1.0, 2.0], &[0.0, 0.0], &shapes(4.0)).is_err());
        assert!(LinearModes::new(&[0.0, 1.0], &[1.0, 2.0], &[0.0, 0.0], &shapes(f64::NAN)).is_err());
        let fewer = LinearModes::new(&[0.0], &[1.0, 2.0], &[0.0, 0.0], &shapes(5.0)[..1]).unwrap_err();
        assert_eq!(fewer, ModalError::DependentShapes { coordinates: 1, modes: 2, ratio: 0.0 });
        // Two modes that differ by rounding, of light structures and of heavy ones, whose shapes are small.
        for unit in [1.0, 1e-6] {
            let nearly = [vec![unit, 0.0], vec![0.0, 1e-15 * unit]];
            let error = LinearModes::new(&[0.0, 1.0], &[1.0, 2.0], &[0.0, 0.0], &nearly).unwrap_err();
            let ModalError::DependentShapes { ratio, .. } = error else { panic!("{error}") };
            assert!((ratio / 1e-15 - 1.0).abs() < 1e-6, "{ratio:e}");
        }
        let still = LinearModes::new(&[0.0], &[1.0], &[0.0], &[vec![0.0]]).unwrap_err();
        assert_eq!(still, ModalError::DependentShapes { coordinates: 1, modes: 1, ratio: 0.0 });
        assert!(LinearModes::new(&[0.0, 1.0], &[1.0], &[0.0], &shapes(5.0)).is_err());
        assert!(LinearModes::new(&[], &[], &[], &[]).is_err());
    }
}
