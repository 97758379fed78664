//! Derivatives of a structure and its load by entries of stiffness and mass.

use nlmodes_hbm::{ChangedParts, LoadTerm, ResponseRow, StructureChange};
use nlmodes_linalg::{LinalgError, Mat, Triplet, sparse_from_triplets, triplets};
use nlmodes_model::reduction::{MatrixDirection, OpenChange, ReductionError};
use num_complex::Complex64;

use crate::response::model::{ForceAt, Weights};
use crate::response::{ResponseError, ResponseModel, ResponseSettings};

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

impl ResponseModel {
    /// What these changes of stiffness and mass do to the structure and its load, exactly; `watched` is the
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
        settings: &ResponseSettings,
    ) -> Result<Vec<StructureChange>, ResponseError> {
        if directions.is_empty() {
            return Ok(Vec::new());
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
        if damping.slope(0, 1.0).is_none() {
            return refused("damping that couples modes");
        }
        let mut places = Places { all: Vec::new(), contacts: open.n_contacts() };
        let laws = (0..self.structure().laws().len()).filter_map(|law| self.law_weights(law));
        let laws: Vec<usize> = laws.map(|weights| places.number(weights)).collect();
        let forces: Vec<usize> = self.forces().iter().map(|force| places.number(&force.weights)).collect();
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
        let (prepared, load) = (open.derivative(&columns)?, self.load_if_any(settings)?);
        let rows_of = |place: usize| self.shape_at(places.all[place - places.contacts]);
        let dashpots: Vec<(usize, f64, Vec<f64>)> =
            dashpots.into_iter().map(|(place, damping)| (place, damping, rows_of(place))).collect();
        let one = |direction: &MatrixDirection| {
            let change = prepared.along(direction)?;
            let parts = ChangedParts {
                damping: self.damping_along(&change, &dashpots),
                terms: self.terms_along(&change, (&forces, &laws), settings),
                laws: laws.iter().map(|place| self.row_along(&change, *place, (&forces, &laws))).collect(),
                drive: drive.map(|place| self.row_along(&change, place, (&forces, &laws))),
                watched: watched.map(|place| self.row_along(&change, place, (&forces, &laws))),
                stiffness: self.with_stops(&change.stiffness),
                rows: Mat::from_fn(open.n_contacts(), self.structure().n_modes(), |i, k| {
                    if k < open.n_modes() { change.rows[(i, k)] } else { 0.0 }
                }),
                compliance: change.flexibility.submatrix(0, 0, places.contacts, places.contacts).to_owned(),
            };
            Ok(StructureChange::of_parts(self.structure(), &load, parts)?)
        };
        directions.iter().map(one).collect()
    }

    /// With zeros for the stops that dissipate, behind the modes.
    fn with_stops(&self, modal: &Mat<f64>) -> Mat<f64> {
        let (m, all) = (modal.nrows(), self.structure().n_modes());
        Mat::from_fn(all, all, |i, j| if i.max(j) < m { modal[(i, j)] } else { 0.0 })
    }

    /// Of `Ĉ`, a function of the modal stiffness, and of dashpots.
    fn damping_along(&self, change: &OpenChange, dashpots: &[(usize, f64, Vec<f64>)]) -> Mat<f64> {
        let (open, (damping, _)) = (self.open_modes(), self.damping());
        let (m, squares) = (open.n_modes(), self.structure().omega_squared());
        let own = damping.modal(squares);
        let of = |k: usize, j: usize| {
            let apart = squares[k] - squares[j];
            let slope = match apart.abs() > SAME * squares[k].max(squares[j]) {
                true => (own.entry(k, k) - own.entry(j, j)) / apart,
                false => damping.slope(k, squares[k]).unwrap_or(0.0),
            };
            let of_dashpot = |(place, value, row): &(usize, f64, Vec<f64>)| {
                value * (change.rows[(*place, k)] * row[j] + row[k] * change.rows[(*place, j)])
            };
            slope * change.stiffness[(k, j)] + dashpots.iter().map(of_dashpot).sum::<f64>()
        };
        self.with_stops(&Mat::from_fn(m, m, of))
    }

    fn terms_along(
        &self,
        change: &OpenChange,
        (forces, laws): (&[usize], &[usize]),
        settings: &ResponseSettings,
    ) -> Vec<LoadTerm> {
        let (m, c) = (self.open_modes().n_modes(), self.open_modes().n_contacts());
        let of = |(force, &place): (&ForceAt, &usize)| {
            let amplitude = amplitude(force);
            LoadTerm {
                harmonic: settings.subharmonic * force.harmonic,
                omega_power: 0,
                modal: self.padded((0..m).map(|k| amplitude * change.rows[(place, k)]).collect()),
                gaps: (0..c).chain(laws.iter().copied()).map(|i| amplitude * change.flexibility[(i, place)]).collect(),
            }
        };
        self.forces().iter().zip(forces).map(of).collect()
    }

    fn row_along(&self, change: &OpenChange, place: usize, (forces, laws): (&[usize], &[usize])) -> ResponseRow {
        let (m, c) = (self.open_modes().n_modes(), self.open_modes().n_contacts());
        let of_force = |(force, &at): (&ForceAt, &usize)| amplitude(force) * change.flexibility[(place, at)];
        ResponseRow {
            modes: self.padded((0..m).map(|k| change.rows[(place, k)]).collect()),
            contacts: (0..c).chain(laws.iter().copied()).map(|i| change.flexibility[(place, i)]).collect(),
            loads: self.forces().iter().zip(forces).map(of_force).collect(),
        }
    }
}

fn amplitude(force: &ForceAt) -> Complex64 {
    Complex64::cis(force.phase) * force.amplitude
}
