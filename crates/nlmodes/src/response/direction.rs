//! Derivatives of a structure and its load by entries of stiffness and mass.

use std::sync::Arc;

use nlmodes_hbm::{ManyChanges, PartWeights};
use nlmodes_linalg::{LinalgError, Mat, Triplet, sparse_from_triplets, triplets};
use nlmodes_model::reduction::{MatrixDirection, OpenDirections, OpenWeights, ReductionError};
use num_complex::Complex64;

use crate::response::model::Weights;
use crate::response::{ResponseError, ResponseModel};

/// Places of a structure, columns after those of its contacts.
struct Places<'a> {
    all: Vec<&'a Weights>,
    contacts: usize,
}

impl<'a> Places<'a> {
    /// The number of a place.
    fn number(&mut self, of: &'a Weights) -> usize {
        let known = self.all.iter().position(|own| *own == of);
        self.contacts
            + known.unwrap_or_else(|| {
                self.all.push(of);
                self.all.len() - 1
            })
    }
}

/// Share of `ω²` up to which modes have one frequency.
const SAME: f64 = 1e-9;

/// Directions in which stiffness and mass of a structure change, with what of its load and its places depends on them.
#[derive(Debug)]
struct DirectionsOfResponse {
    open: OpenDirections,
    contacts: usize,
    /// Derivatives of `Ĉ` by the modal stiffness, entry by entry, m × m.
    slopes: Mat<f64>,
    /// Place, damping and row of each dashpot.
    dashpots: Vec<(usize, f64, Vec<f64>)>,
    /// Place and complex amplitude of each force.
    forces: Vec<(usize, Complex64)>,
    /// Places of laws, of the drive point and of the displacement whose amplitude is followed.
    laws: Vec<usize>,
    drive: Option<usize>,
    watched: Option<usize>,
}

impl ResponseModel {
    /// These changes of stiffness and mass as parameters of the structure and its load, exactly; `watched` is the
    /// displacement whose amplitude is followed. One solution for each retained mode and place, whatever the number of
    /// directions.
    ///
    /// # Errors
    /// [`ResponseError::DirectionBeside`] what is differentiated in other ways, or what the reduction has against a
    /// direction.
    pub fn changes_along(
        &self,
        directions: &[MatrixDirection],
        watched: Option<&Weights>,
    ) -> Result<Option<Arc<dyn ManyChanges>>, ResponseError> {
        if directions.is_empty() {
            return Ok(None);
        }
        let refused = |what| Err(ResponseError::DirectionBeside { what });
        if self.forces().len() != self.terms().len() {
            return refused("a base that moves");
        }
        if !self.structure().steady_force().is_empty() {
            return refused("a static load on a structure that floats");
        }
        let mut stops = self.structure().law_stops().filter_map(|placed| placed.law.stop_gap());
        if stops.any(|gap| gap < 0.0) {
            return refused("a stop with a law of force that presses at rest");
        }
        let (open, (damping, dashpots)) = (self.open_modes(), self.damping());
        let squares = &self.structure().omega_squared()[..open.n_modes()];
        let Some(slopes) = squares.iter().enumerate().map(|(k, w)| damping.slope(k, *w)).collect::<Option<Vec<f64>>>()
        else {
            return refused("damping that couples modes");
        };
        let mut places = Places { all: Vec::new(), contacts: open.n_contacts() };
        let laws = (0..self.structure().laws().len()).filter_map(|law| self.law_weights(law));
        let laws: Vec<usize> = laws.map(|weights| places.number(weights)).collect();
        let forces = self.forces().iter();
        let forces =
            forces.map(|own| (places.number(&own.weights), Complex64::cis(own.phase) * own.amplitude)).collect();
        let dashpots: Vec<(usize, f64)> = dashpots.iter().map(|one| (places.number(&one.at), one.damping)).collect();
        let drive = self.drive_weights().map(|weights| places.number(weights));
        let watched = watched.map(|weights| places.number(weights));
        let behind = places.all.iter().enumerate();
        let entries: Vec<Triplet> = triplets(open.directions())
            .chain(behind.flat_map(|(k, of)| of.iter().map(move |&(dof, w)| (dof, open.n_contacts() + k, w))))
            .collect();
        let failed = |source: LinalgError| ReductionError::Linalg { what: "places of a gradient", source };
        let columns = sparse_from_triplets(open.n_dofs(), places.contacts + places.all.len(), &entries);
        let columns = columns.map_err(failed)?;
        let rows_of = |place: usize| self.shape_at(places.all[place - places.contacts]);
        let own = damping.modal(self.structure().omega_squared());
        let slope = |k: usize, j: usize| {
            let apart = squares[k] - squares[j];
            match apart.abs() > SAME * squares[k].max(squares[j]) {
                true => (own.entry(k, k) - own.entry(j, j)) / apart,
                false => slopes[k],
            }
        };
        Ok(Some(Arc::new(DirectionsOfResponse {
            open: open.along(&columns, directions)?,
            contacts: open.n_contacts(),
            slopes: Mat::from_fn(open.n_modes(), open.n_modes(), slope),
            dashpots: dashpots.into_iter().map(|(place, damping)| (place, damping, rows_of(place))).collect(),
            forces,
            laws,
            drive,
            watched,
        })))
    }
}

impl ManyChanges for DirectionsOfResponse {
    fn times(&self, weights: &PartWeights<'_>) -> Vec<f64> {
        let (m, c, p) = (self.slopes.nrows(), self.contacts, self.open.n_places());
        let damping = |k: usize, j: usize| weights.damping[(k, j)];
        let mut to = OpenWeights {
            stiffness: Mat::from_fn(m, m, |k, j| weights.stiffness[(k, j)] + self.slopes[(k, j)] * damping(k, j)),
            rows: Mat::zeros(p, m),
            flexibility: Mat::zeros(p, p),
        };
        // What moves gaps and laws, in the order of the rows of a load.
        let moved: Vec<usize> = (0..c).chain(self.laws.iter().copied()).collect();
        for k in 0..m {
            for (place, value, row) in &self.dashpots {
                let of_pairs = (0..m).map(|j| (damping(k, j) + damping(j, k)) * row[j]).sum::<f64>();
                to.rows[(*place, k)] += value * of_pairs;
            }
            (0..c).for_each(|i| to.rows[(i, k)] += weights.rows[(i, k)]);
        }
        for (i, j) in (0..c).flat_map(|i| (0..c).map(move |j| (i, j))) {
            to.flexibility[(i, j)] += weights.compliance[(i, j)];
        }
        for ((place, amplitude), term) in self.forces.iter().zip(weights.terms) {
            (0..m).for_each(|k| to.rows[(*place, k)] += (term.modal[k] * amplitude).re);
            for (i, gap) in moved.iter().zip(&term.gaps) {
                to.flexibility[(*i, *place)] += (gap * amplitude).re;
            }
        }
        for (place, [modes, contacts, laws]) in self.laws.iter().zip(weights.laws()) {
            self.add_row(*place, &moved, modes, contacts.iter().chain(laws), &mut to);
        }
        for (place, row) in [(self.drive, weights.drive), (self.watched, weights.watched)] {
            let (Some(place), Some(row)) = (place, row) else { continue };
            self.add_row(place, &moved, &row.modes, row.contacts.iter(), &mut to);
            for ((at, amplitude), weight) in self.forces.iter().zip(&row.loads) {
                to.flexibility[(place, *at)] += (weight * amplitude).re;
            }
        }
        self.open.times(&to)
    }
}

impl DirectionsOfResponse {
    /// Adds the weights of how the modes and what moves the gaps move a place.
    fn add_row<'a>(
        &self,
        place: usize,
        moved: &[usize],
        modes: &[f64],
        others: impl Iterator<Item = &'a f64>,
        to: &mut OpenWeights,
    ) {
        (0..self.slopes.nrows()).for_each(|k| to.rows[(place, k)] += modes[k]);
        moved.iter().zip(others).for_each(|(i, weight)| to.flexibility[(place, *i)] += weight);
    }
}
