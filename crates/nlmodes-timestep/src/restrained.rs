use nlmodes_linalg::{
    Mat, SparseCholesky, SparseMatrix, bilinear, column, multiply, select, sparse_from_triplets, triplets,
};
use nlmodes_model::{ContactCoordinates, ContactLaw, LinearModes, MasslessContactModel, linear_modes};

use crate::TimestepError;
use crate::dynamics::STRAINLESS;
use crate::phase::dot;

/// The structure with the closed contacts of a phase.
pub(crate) struct Restrained<'m> {
    model: &'m MasslessContactModel,
    free: Vec<usize>,
    /// Fixed degrees of freedom and their values.
    held: Vec<(usize, f64)>,
    /// Springs of closed elastic stops: degree of freedom, stiffness, unstretched position.
    springs: Vec<(usize, f64, f64)>,
    mass: SparseMatrix,
    stiffness: SparseMatrix,
    massless: Vec<usize>,
}

impl<'m> Restrained<'m> {
    pub fn new(model: &'m MasslessContactModel, closed: &[bool]) -> Result<Self, TimestepError> {
        let failed = TimestepError::during("structure with closed contacts");
        let (mut held, mut springs) = (Vec::new(), Vec::new());
        for contact in model.contacts().iter().zip(closed).filter(|(_, closed)| **closed).map(|(contact, _)| contact) {
            let place = contact.side.sign() * contact.gap;
            match contact.law {
                ContactLaw::Rigid => held.push((contact.dof, place)),
                ContactLaw::Elastic { stiffness } => springs.push((contact.dof, stiffness, place)),
            }
        }
        let n = model.dofs().len();
        let free: Vec<usize> = (0..n).filter(|i| held.iter().all(|(dof, _)| dof != i)).collect();
        let grounded = springs.iter().map(|&(dof, k, _)| (dof, dof, k));
        let entries: Vec<_> = triplets(model.stiffness()).chain(grounded).collect();
        let stiffness = sparse_from_triplets(n, n, &entries).map_err(&failed)?;
        let massless = match model.contact_coordinates() {
            ContactCoordinates::Nodes => model.contact_dofs().to_vec(),
            ContactCoordinates::SpringTips => Vec::new(),
        };
        let mass = select(model.mass(), &free, &free).map_err(&failed)?;
        let massless = massless.into_iter().filter(|dof| free.contains(dof)).collect();
        Ok(Self { model, free, held, springs, mass, stiffness, massless })
    }

    pub fn modes(&self) -> Result<LinearModes, TimestepError> {
        let stiffness = self.free_stiffness()?;
        Ok(linear_modes(&self.mass, &stiffness, self.free.len())?)
    }

    fn free_stiffness(&self) -> Result<SparseMatrix, TimestepError> {
        select(&self.stiffness, &self.free, &self.free).map_err(TimestepError::during("structure with closed contacts"))
    }

    /// Static equilibrium of all degrees of freedom.
    ///
    /// If a rigid motion remains, fixed degrees of freedom and springs do no work on it, since they do not move in it;
    /// what a steady force does is [`push`](Self::push).
    pub fn equilibrium(&self, modes: &LinearModes) -> Result<Vec<f64>, TimestepError> {
        let n = self.model.dofs().len();
        let mut q = vec![0.0; n];
        self.held.iter().for_each(|&(dof, place)| q[dof] = place);
        let mut load = multiply(&self.stiffness, &q);
        load.iter_mut().for_each(|f| *f = -*f);
        self.springs.iter().for_each(|&(dof, k, place)| load[dof] += k * place);
        self.steady().iter().enumerate().for_each(|(dof, force)| load[dof] += force);
        let mut x: Vec<f64> = self.free.iter().map(|&i| load[i]).collect();
        if x.iter().all(|f| *f == 0.0) {
            return Ok(q);
        }
        let is_held = self.push(modes).iter().all(|push| *push == 0.0);
        match SparseCholesky::factor(&self.free_stiffness()?, "stiffness with closed contacts") {
            Ok(factor) if is_held => factor.solve_in_place(&mut x),
            _ => x = self.modal_equilibrium(modes, &x)?,
        }
        self.free.iter().zip(&x).for_each(|(&dof, x)| q[dof] = *x);
        Ok(q)
    }

    /// The equilibrium without rigid motion, from the elastic modes and the massless degrees of freedom.
    fn modal_equilibrium(&self, modes: &LinearModes, load: &[f64]) -> Result<Vec<f64>, TimestepError> {
        let mut x = vec![0.0; load.len()];
        for k in (0..modes.omega.len()).filter(|k| is_elastic(modes, *k)) {
            let shape = column(&modes.shapes, k);
            let coordinate = dot(shape, load) / (modes.omega[k] * modes.omega[k]);
            x.iter_mut().zip(shape).for_each(|(x, s)| *x += coordinate * s);
        }
        if !self.massless.is_empty() {
            let failed = TimestepError::during("statics of massless nodes");
            let block = select(&self.stiffness, &self.massless, &self.massless).map_err(&failed)?;
            let places: Vec<usize> = self.massless.iter().filter_map(|dof| self.free.binary_search(dof).ok()).collect();
            let mut own: Vec<f64> = places.iter().map(|&i| load[i]).collect();
            SparseCholesky::factor(&block, "stiffness of the massless nodes")
                .map_err(&failed)?
                .solve_in_place(&mut own);
            places.iter().zip(&own).for_each(|(&i, own)| x[i] += own);
        }
        Ok(x)
    }

    fn steady(&self) -> &[f64] {
        self.model.steady_force().map_or(&[], |steady| &steady.force)
    }

    /// Steady force on each motion without strain, `φᵀ f`; zero for elastic modes, empty without such a force.
    pub fn push(&self, modes: &LinearModes) -> Vec<f64> {
        let steady = self.steady();
        if steady.is_empty() {
            return Vec::new();
        }
        let on = |k: usize| -> f64 {
            let shape = column(&modes.shapes, k);
            self.free.iter().zip(shape).map(|(&dof, s)| steady[dof] * s).sum()
        };
        (0..modes.omega.len()).map(|k| if is_elastic(modes, k) { 0.0 } else { on(k) }).collect()
    }

    /// Zero rows for fixed degrees of freedom.
    pub fn on_all(&self, shapes: &Mat<f64>) -> Mat<f64> {
        let mut all = Mat::zeros(self.model.dofs().len(), shapes.ncols());
        for k in 0..shapes.ncols() {
            self.free.iter().enumerate().for_each(|(i, &dof)| all[(dof, k)] = shapes[(i, k)]);
        }
        all
    }

    /// Strain energy of the structure and of the closed stops' springs, with the energy of a steady force.
    pub fn strain(&self, q: &[f64]) -> f64 {
        let springs: f64 = self.springs.iter().map(|&(dof, k, place)| k * (q[dof] - place).powi(2)).sum();
        0.5 * (bilinear(q, self.model.stiffness(), q) + springs) - dot(self.steady(), q)
    }
}

/// Whether a mode strains anything.
pub(crate) fn is_elastic(modes: &LinearModes, k: usize) -> bool {
    modes.omega.last().is_some_and(|highest| modes.omega[k] > STRAINLESS * highest)
}
