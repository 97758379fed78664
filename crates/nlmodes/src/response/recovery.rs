//! Displacements of a motion at requested positions, and the work of its load.

use nlmodes_hbm::{LoadTerm, PeriodicMotion, ResponseRow};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_model::reduction::ReductionError;
use num_complex::Complex64;

use crate::response::model::Weights;
use crate::response::{ResponseError, ResponseModel};

/// Power of the forces of a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForcePower {
    /// Mean power, W.
    pub active: f64,
    /// Apparent power, product of the effective values of forces and velocities, W.
    pub apparent: f64,
}

impl ForcePower {
    /// Power-based mode indicator function, active over apparent power; 1 where the forces appropriate a mode in all
    /// harmonics, NaN at rest.
    pub fn indicator(&self) -> f64 {
        self.active / self.apparent
    }
}

impl ResponseModel {
    /// Displacements `Σ weight q_dof`, with what the load moves statically.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`], or what the reduction reports.
    pub fn rows(&self, functionals: &[Weights]) -> Result<Vec<ResponseRow>, ResponseError> {
        functionals.iter().try_for_each(|weights| self.check_weights(weights))?;
        let column = |(j, weights): (usize, &Weights)| weights.iter().map(move |&(dof, w)| (dof, j, w)).collect();
        let entries: Vec<(usize, usize, f64)> = functionals.iter().enumerate().flat_map::<Vec<_>, _>(column).collect();
        let open = self.open_modes();
        let failed = |source| ReductionError::Linalg { what: "rows of displacements", source };
        let matrix = sparse_from_triplets(open.n_dofs(), functionals.len(), &entries).map_err(failed)?;
        let rows = open.rows(&matrix)?;
        let row = |(j, weights): (usize, &Weights)| ResponseRow {
            modes: self.padded((0..open.n_modes()).map(|k| rows.modes[(j, k)]).collect()),
            contacts: (0..open.n_contacts()).map(|i| rows.forces[(j, i)]).chain(self.moved_by_laws(weights)).collect(),
            loads: self.residuals().map(|r| weights.iter().map(|&(dof, w)| r[dof] * w).sum()).collect(),
        };
        Ok(functionals.iter().enumerate().map(row).collect())
    }

    /// Rows of single degrees of freedom.
    ///
    /// # Errors
    /// As [`rows`](Self::rows).
    pub fn rows_of_dofs(&self, dofs: &[usize]) -> Result<Vec<ResponseRow>, ResponseError> {
        self.rows(&dofs.iter().map(|&dof| vec![(dof, 1.0)]).collect::<Vec<_>>())
    }

    /// Complex amplitudes of a displacement, harmonic by harmonic of the motion, m, with the static share of the load;
    /// `subharmonic` periods of the load are one of the motion.
    pub fn displacement(&self, row: &ResponseRow, motion: &PeriodicMotion, subharmonic: usize) -> Vec<Complex64> {
        let mut q = motion.displacement(row);
        self.add_load(row.loads.iter().copied(), motion, subharmonic, &mut q);
        q
    }

    /// What each term of the load moves beyond the modes at its level one, m: of each term the share that goes with the
    /// cosine of its harmonic, and that which goes with the negative sine.
    pub fn load_shapes(&self) -> Vec<Vec<f64>> {
        let parts = |residual: &[Complex64]| -> [Vec<f64>; 2] {
            [residual.iter().map(|q| q.re).collect(), residual.iter().map(|q| q.im).collect()]
        };
        self.residuals().flat_map(parts).collect()
    }

    /// Coordinates of these shapes at a phase (rad) of a motion.
    pub fn load_coordinates(&self, motion: &PeriodicMotion, subharmonic: usize, phase: f64) -> Vec<f64> {
        let omega = motion.at.omega * subharmonic as f64;
        let of = |term: &LoadTerm| {
            let (level, angle) = (motion.at.level * omega.powi(term.omega_power), term.harmonic * subharmonic);
            [level * (angle as f64 * phase).cos(), -level * (angle as f64 * phase).sin()]
        };
        self.terms().iter().flat_map(of).collect()
    }

    /// Adds to `q` what each term of the load moves at its level one.
    fn add_load(
        &self,
        shares: impl Iterator<Item = Complex64>,
        motion: &PeriodicMotion,
        subharmonic: usize,
        q: &mut [Complex64],
    ) {
        let omega = motion.at.omega * subharmonic as f64;
        for (term, share) in self.terms().iter().zip(shares) {
            if let Some(q) = q.get_mut(term.harmonic * subharmonic) {
                *q += share * (motion.at.level * omega.powi(term.omega_power));
            }
        }
    }

    /// Complex amplitudes of the drive point in a free motion, harmonic by harmonic, m; none without a drive point.
    ///
    /// # Errors
    /// As [`rows`](Self::rows).
    pub fn drive_harmonics(&self, motion: &PeriodicMotion) -> Result<Vec<Complex64>, ResponseError> {
        let Some(weights) = self.drive_weights() else { return Ok(Vec::new()) };
        let rows = self.rows(std::slice::from_ref(weights))?;
        Ok(rows.first().map_or_else(Vec::new, |row| motion.displacement(row)))
    }

    /// Powers of the forces that were pushed; `None` where there are none, as with a base that shakes.
    ///
    /// # Errors
    /// As [`rows`](Self::rows).
    pub fn force_power(
        &self,
        motion: &PeriodicMotion,
        subharmonic: usize,
    ) -> Result<Option<ForcePower>, ResponseError> {
        let forces = self.forces();
        if forces.is_empty() || motion.at.level == 0.0 {
            return Ok(None);
        }
        let mut places: Vec<Weights> = Vec::new();
        for force in forces {
            if !places.contains(&force.weights) {
                places.push(force.weights.clone());
            }
        }
        let rows = self.rows(&places)?;
        let (mut active, mut squares) = (0.0, [0.0, 0.0]);
        for (place, row) in places.iter().zip(&rows) {
            let q = self.displacement(row, motion, subharmonic);
            let velocity = |n: usize| Complex64::new(0.0, n as f64 * motion.at.omega) * q[n];
            squares[1] += (1..q.len()).map(|n| 0.5 * velocity(n).norm_sqr()).sum::<f64>();
            let mut harmonics = vec![Complex64::default(); q.len()];
            for force in forces.iter().filter(|f| f.weights == *place) {
                if let Some(f) = harmonics.get_mut(force.harmonic * subharmonic) {
                    *f += Complex64::from_polar(force.amplitude * motion.at.level, force.phase);
                }
            }
            squares[0] += harmonics.iter().map(|f| 0.5 * f.norm_sqr()).sum::<f64>();
            active += harmonics.iter().enumerate().map(|(n, f)| 0.5 * (f * velocity(n).conj()).re).sum::<f64>();
        }
        Ok(Some(ForcePower { active, apparent: (squares[0] * squares[1]).sqrt() }))
    }
}
