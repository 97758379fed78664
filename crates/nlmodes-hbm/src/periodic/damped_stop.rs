//! Stops that dissipate: no law of contact but coordinates of the structure, without mass.

use nlmodes_contact::LcpMatrix;
use nlmodes_linalg::Mat;

use super::structure::ModalStructure;
use crate::HbmError;

/// A stop on a spring (N/m) with a damper (N s/m) beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampedStop {
    /// The contact.
    pub contact: usize,
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Constant of the damper, N s/m.
    pub damper: f64,
}

impl ModalStructure {
    /// The same structure with spring and damper beside each other behind some of its stops; what such a stop was
    /// before, rigid or elastic, does not count. While its contact is open it comes back to its place.
    ///
    /// # Errors
    /// [`HbmError::Size`] for a contact that does not exist or is given twice, [`HbmError::NotFinite`] for a spring or
    /// a damper that is not a positive number, or [`HbmError::Compliance`] where the contact has no flexibility of its
    /// own.
    pub fn with_damped_stops(&self, stops: &[DampedStop]) -> Result<Self, HbmError> {
        let (m, c, n) = (self.n_modes(), self.n_contacts(), stops.len());
        let mut structure = self.clone();
        for (j, stop) in stops.iter().enumerate() {
            let i = stop.contact;
            if i >= c || self.damped.contains(&i) || stops[..j].iter().any(|other| other.contact == i) {
                return Err(HbmError::Size { what: "contact of a stop that dissipates", expected: c, found: i });
            }
            if ![stop.stiffness, stop.damper].iter().all(|v| v.is_finite() && *v > 0.0) {
                return Err(HbmError::NotFinite { what: "spring and damper of a stop" });
            }
            structure.stop_compliance[i] = 0.0;
            structure.omega_squared.push(stop.stiffness);
            structure.inertia.push(0.0);
            if !structure.steady_force.is_empty() {
                structure.steady_force.push(0.0);
            }
            structure.damped.push(i);
        }
        structure.laws.iter_mut().for_each(|law| law.modes.resize(m + n, 0.0));
        let of = |i: usize| stops.iter().position(|stop| stop.contact == i);
        let row = |i: usize, k: usize| match k.checked_sub(m) {
            None => self.rows[(i, k)],
            Some(j) => f64::from(u8::from(of(i) == Some(j))),
        };
        structure.rows = Mat::from_fn(c, m + n, row);
        let a = self.compliance.a();
        let own = |i: usize, j: usize| if i == j && of(i).is_some() { self.stop_compliance[i] } else { 0.0 };
        let compliance = LcpMatrix::new(&Mat::from_fn(c, c, |i, j| a[(i, j)] - own(i, j)));
        structure.compliance = compliance.map_err(HbmError::Compliance)?;
        structure.damping = self.damping.with_own(&stops.iter().map(|stop| stop.damper).collect::<Vec<_>>());
        Ok(structure)
    }

    /// The coordinate of the stop of a contact, where it dissipates.
    pub fn damped_stop(&self, contact: usize) -> Option<usize> {
        self.damped.iter().position(|i| *i == contact).map(|j| self.n_moving() + j)
    }

    /// The contacts whose stops dissipate, in the order of their coordinates.
    pub(crate) fn damped(&self) -> &[usize] {
        &self.damped
    }

    /// Flexibility beyond the modes between two contacts and of their stops at rest, also of those that dissipate, m/N.
    pub(crate) fn static_compliance(&self, i: usize, j: usize) -> f64 {
        let own = self.damped_stop(i).filter(|_| i == j).map_or(0.0, |k| 1.0 / self.omega_squared[k]);
        self.compliance.a()[(i, j)] + own
    }
}
