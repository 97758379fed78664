use nlmodes_linalg::Mat;
use num_complex::Complex64;

/// Viscous damping in open modes, `Ĉ = Φᵀ C Φ` (1/s): of the structure with its contacts open.
#[derive(Debug, Clone)]
pub enum ModalDamping {
    /// Uncoupled modes, `ĉ_k = 2 ζ_k ω_k`, m.
    Diagonal(Vec<f64>),
    /// Modes that damping couples, m × m, symmetric.
    Full(Mat<f64>),
}

impl ModalDamping {
    /// No damping of m modes.
    pub fn none(modes: usize) -> Self {
        Self::Diagonal(vec![0.0; modes])
    }

    /// Damping ratios `ζ_k` mode by mode; the last one goes on for all modes behind it, an empty list means no
    /// damping.
    pub fn ratios(omega_squared: &[f64], ratios: &[f64]) -> Self {
        let last = ratios.last().copied().unwrap_or(0.0);
        let ratio = |k: usize| ratios.get(k).copied().unwrap_or(last);
        Self::Diagonal(omega_squared.iter().enumerate().map(|(k, w)| 2.0 * ratio(k) * w.max(0.0).sqrt()).collect())
    }

    /// Rayleigh damping `C = mass M + stiffness K` with `mass` in 1/s and `stiffness` in s:
    /// `ĉ_k = mass + stiffness ω_k²`.
    pub fn rayleigh(omega_squared: &[f64], mass: f64, stiffness: f64) -> Self {
        Self::Diagonal(omega_squared.iter().map(|w| mass + stiffness * w).collect())
    }

    /// This damping and that of dashpots, each a row of the open modes (m, 1/√kg) and its constant (N s/m):
    /// `Ĉ + Σ d φ φᵀ`.
    #[must_use]
    pub fn with_dashpots(self, dashpots: &[(Vec<f64>, f64)]) -> Self {
        if dashpots.is_empty() {
            return self;
        }
        let m = self.n_modes();
        let dashpot = |i: usize, j: usize| dashpots.iter().map(|(row, d)| d * row[i] * row[j]).sum::<f64>();
        Self::Full(Mat::from_fn(m, m, |i, j| self.entry(i, j) + dashpot(i, j)))
    }

    /// This damping with further coordinates behind it, each with its own and coupled to none.
    #[must_use]
    pub(crate) fn with_own(&self, own: &[f64]) -> Self {
        let m = self.n_modes();
        match self {
            Self::Diagonal(c) => Self::Diagonal(c.iter().chain(own).copied().collect()),
            Self::Full(c) => Self::Full(Mat::from_fn(m + own.len(), m + own.len(), |i, j| match (i < m, j < m) {
                (true, true) => c[(i, j)],
                (false, false) if i == j => own[i - m],
                _ => 0.0,
            })),
        }
    }

    /// Number of modes m.
    pub fn n_modes(&self) -> usize {
        match self {
            Self::Diagonal(c) => c.len(),
            Self::Full(c) => c.nrows(),
        }
    }

    /// Entry `ĉ_ij`, 1/s.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        match self {
            Self::Diagonal(c) if i == j => c[i],
            Self::Diagonal(_) => 0.0,
            Self::Full(c) => c[(i, j)],
        }
    }

    /// Whether modes are uncoupled.
    pub fn is_diagonal(&self) -> bool {
        matches!(self, Self::Diagonal(_))
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        let m = self.n_modes();
        (0..m).all(|i| (0..m).all(|j| self.entry(i, j) == 0.0))
    }

    /// `tr Ĉ`, 1/s.
    pub fn trace(&self) -> f64 {
        (0..self.n_modes()).map(|k| self.entry(k, k)).sum()
    }

    /// `ηᴴ Ĉ η` of complex amplitudes.
    pub fn form(&self, eta: &[Complex64]) -> f64 {
        let row = |i: usize| -> Complex64 {
            match self {
                Self::Diagonal(c) => eta[i] * c[i],
                Self::Full(c) => (0..eta.len()).map(|j| eta[j] * c[(i, j)]).sum(),
            }
        };
        (0..eta.len()).map(|i| (eta[i].conj() * row(i)).re).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARES: [f64; 3] = [4.0, 9.0, 25.0];

    fn entries(damping: &ModalDamping) -> Vec<f64> {
        let m = damping.n_modes();
        (0..m).flat_map(|i| (0..m).map(move |j| (i, j))).map(|(i, j)| damping.entry(i, j)).collect()
    }

    #[test]
    fn ratios_and_rayleigh_damping_have_their_closed_form() {
        let ratios = ModalDamping::ratios(&SQUARES, &[0.1, 0.02]);
        let expected = [0.4, 0.0, 0.0, 0.0, 0.12, 0.0, 0.0, 0.0, 0.2];
        entries(&ratios).iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-15, "{a} {b}"));
        let rayleigh = ModalDamping::rayleigh(&SQUARES, 0.3, 0.01);
        let expected = [0.34, 0.0, 0.0, 0.0, 0.39, 0.0, 0.0, 0.0, 0.55];
        entries(&rayleigh).iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-15, "{a} {b}"));
        assert!(ratios.is_diagonal() && !ratios.is_none() && (ratios.trace() - 0.72).abs() < 1e-15);
        assert!(ModalDamping::none(3).is_none() && ModalDamping::ratios(&SQUARES, &[]).is_none());
        assert!(ModalDamping::ratios(&SQUARES, &[0.0, 0.0, 1e-9]).entry(2, 2) > 0.0);
    }

    #[test]
    fn dashpots_add_their_rows_and_couple_modes() {
        let dashpots = [(vec![1.0, -2.0, 0.5], 0.3), (vec![0.0, 1.0, 1.0], 0.1)];
        let damping = ModalDamping::rayleigh(&SQUARES, 0.2, 0.0).with_dashpots(&dashpots);
        let expected = [0.5, -0.6, 0.15, -0.6, 1.5, -0.2, 0.15, -0.2, 0.375];
        entries(&damping).iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-15, "{a} {b}"));
        assert!(!damping.is_diagonal() && (damping.trace() - 2.375).abs() < 1e-15);
        // ηᴴ Ĉ η is 0.2 |η|² and what each dashpot takes.
        let eta = [Complex64::new(0.3, -0.2), Complex64::new(-1.0, 0.4), Complex64::new(0.1, 2.0)];
        let along = |row: &[f64]| row.iter().zip(&eta).map(|(r, e)| e * *r).sum::<Complex64>().norm_sqr();
        let own: f64 = eta.iter().map(Complex64::norm_sqr).sum();
        let form = 0.2 * own + dashpots.iter().map(|(row, d)| d * along(row)).sum::<f64>();
        assert!((damping.form(&eta) - form).abs() < 1e-14, "{}", damping.form(&eta));
        assert!((ModalDamping::rayleigh(&SQUARES, 0.2, 0.0).form(&eta) - 0.2 * own).abs() < 1e-15);
        // Without dashpots modes stay uncoupled; further coordinates are coupled to none.
        assert!(ModalDamping::none(3).with_dashpots(&[]).is_diagonal());
        for (damping, first) in [(damping, 0.5), (ModalDamping::rayleigh(&SQUARES, 0.2, 0.0), 0.2)] {
            let longer = damping.with_own(&[7.0, 8.0]);
            assert_eq!((longer.n_modes(), longer.is_diagonal()), (5, damping.is_diagonal()));
            assert!((longer.entry(0, 0) - first).abs() < 1e-15 && longer.entry(0, 1) == damping.entry(0, 1));
            assert_eq!(
                [(3, 3), (4, 4), (3, 4), (0, 4), (3, 1)].map(|(i, j)| longer.entry(i, j)),
                [7.0, 8.0, 0.0, 0.0, 0.0]
            );
        }
    }
}
