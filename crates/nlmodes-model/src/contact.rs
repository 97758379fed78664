use nlmodes_linalg::max_norm;

use crate::{DofIndex, ModelError, SparseDirection};

/// The side of a stop, in the positive direction of the degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// Contact at a positive displacement: `g = g₀ − q`.
    Positive,
    /// Contact at a negative displacement: `g = g₀ + q`.
    Negative,
}

impl Side {
    /// +1 or −1: the direction from the structure to the stop.
    pub fn sign(self) -> f64 {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }
}

/// Deformation of a stop under load: its compliance times the force.
///
/// ```text
/// 0 ≤ λ ⊥ g + c λ ≥ 0 ,   c = 0 (rigid, eq. (5)) or 1/k_c (elastic, eq. (3))
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ContactLaw {
    /// A hard stop, eq. (5): nothing penetrates.
    #[default]
    Rigid,
    /// A stop on a massless spring, eq. (3): `λ = k_c max(−g, 0)`.
    Elastic {
        /// Contact stiffness `k_c`, N/m, positive.
        stiffness: f64,
    },
}

impl ContactLaw {
    /// `1/k_c`, m/N; zero for a rigid stop.
    pub fn compliance(self) -> f64 {
        match self {
            Self::Rigid => 0.0,
            Self::Elastic { stiffness } => 1.0 / stiffness,
        }
    }
}

/// A one-sided contact, eqs. (3), (5): `g = g₀ + wᵀ q ≥ 0` with a sparse direction `w`, and the force `w λ`, `λ ≥ 0`.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// `w`: change of the gap with the degrees of freedom.
    pub normal: SparseDirection,
    /// Clearance at rest `g₀`, m; zero touches, negative presses.
    pub gap: f64,
    /// Rigid, or with a contact stiffness.
    pub law: ContactLaw,
    /// Compliance of the stop that the stiffness of the model contains, in series with the contact node, m/N; `law` has
    /// the rest. Zero but for nodes that would have no flexibility of their own.
    pub lent: f64,
}

impl Contact {
    /// A rigid contact in any direction.
    pub fn new(normal: SparseDirection, gap: f64) -> Self {
        Self { normal, gap, law: ContactLaw::Rigid, lent: 0.0 }
    }

    /// A rigid stop at the degree of freedom `dof`: `w = −1` on the positive side, `+1` on the negative one.
    pub fn stop(dof: usize, side: Side, gap: f64) -> Self {
        Self::new(SparseDirection::single(dof, -side.sign()), gap)
    }

    /// [`Contact::stop`].
    pub fn rigid(dof: usize, side: Side, gap: f64) -> Self {
        Self::stop(dof, side, gap)
    }

    /// A stop at `dof` with the contact stiffness `stiffness`, N/m.
    pub fn elastic(dof: usize, side: Side, gap: f64, stiffness: f64) -> Self {
        Self::stop(dof, side, gap).on_spring(stiffness)
    }

    /// A node and a rigid wall. `normal` points from the node to the wall and may have any length: `w = −n` at the free
    /// displacements of the node.
    ///
    /// # Errors
    /// [`ModelError::NormalLength`]; [`ModelError::NodeCannotMove`] if the node cannot move along the normal.
    pub fn point(dofs: &DofIndex, node: usize, normal: [f64; 3], gap: f64) -> Result<Self, ModelError> {
        let entries = along(dofs, node, unit(normal)?, -1.0);
        SparseDirection::new(entries).map(|w| Self::new(w, gap)).map_err(|_| ModelError::NodeCannotMove { node })
    }

    /// Contact of two nodes. `normal` points from `a` to `b` and may have any length: `w = +n` at `b` and `−n` at `a`,
    /// so that the gap is their distance.
    ///
    /// # Errors
    /// As [`Contact::point`], with node `a`; also if both are one node.
    pub fn pair(dofs: &DofIndex, a: usize, b: usize, normal: [f64; 3], gap: f64) -> Result<Self, ModelError> {
        let n = unit(normal)?;
        let entries = along(dofs, a, n, -1.0).chain(along(dofs, b, n, 1.0));
        SparseDirection::new(entries).map(|w| Self::new(w, gap)).map_err(|_| ModelError::NodeCannotMove { node: a })
    }

    /// The same contact with the contact stiffness `stiffness`, N/m.
    pub fn on_spring(self, stiffness: f64) -> Self {
        Self { law: ContactLaw::Elastic { stiffness }, ..self }
    }

    /// The contact as one at a single degree of freedom, if it is one: `w` has one entry, +1 or −1.
    pub fn single_dof(&self) -> Option<DofContact> {
        let side = match self.normal.entries() {
            [(_, w)] if *w == -1.0 => Side::Positive,
            [(_, w)] if *w == 1.0 => Side::Negative,
            _ => return None,
        };
        Some(DofContact { dof: self.normal.entries()[0].0, side, gap: self.gap, law: self.law, lent: self.lent })
    }
}

/// A contact at one degree of freedom, as required for the partition into massless contact nodes and the rest: `g = g₀
/// + w q`, `w = −side`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DofContact {
    /// Index of the degree of freedom.
    pub dof: usize,
    /// Side of the stop.
    pub side: Side,
    /// Clearance at rest `g₀`, m; zero touches, negative presses.
    pub gap: f64,
    /// Rigid, or with a contact stiffness.
    pub law: ContactLaw,
    /// Compliance of the stop that the stiffness of the model contains, as in [`Contact::lent`], m/N.
    pub lent: f64,
}

impl DofContact {
    /// Compliance of the whole stop, m/N: with it, and not with that of `law`, a gap `g` and a force `λ` tell how far
    /// the structure has moved, `q = c λ − g` toward the stop.
    pub fn stop_compliance(&self) -> f64 {
        self.law.compliance() + self.lent
    }

    /// Entry of `W` for this contact, eq. (2): +1 or −1.
    pub fn direction(&self) -> f64 {
        -self.side.sign()
    }
}

impl From<DofContact> for Contact {
    fn from(of: DofContact) -> Self {
        Self { law: of.law, lent: of.lent, ..Self::stop(of.dof, of.side, of.gap) }
    }
}

/// Coefficients `sign n` at the displacements of a node.
fn along(dofs: &DofIndex, node: usize, n: [f64; 3], sign: f64) -> impl Iterator<Item = (usize, f64)> {
    (0..3).filter_map(move |axis| Some((dofs.translation(node, axis)?, sign * n[axis])))
}

/// The unit normal.
fn unit(normal: [f64; 3]) -> Result<[f64; 3], ModelError> {
    // By the largest component first, so that squares neither overflow nor vanish.
    let largest = max_norm(normal);
    if !(largest > 0.0 && normal.iter().all(|v| v.is_finite())) {
        return Err(ModelError::NormalLength { normal });
    }
    let scaled = normal.map(|v| v / largest);
    let length = scaled.iter().map(|v| v * v).sum::<f64>().sqrt();
    Ok(scaled.map(|v| v / length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dof, DofKind};

    /// Nodes 5 and 9 in space, the latter fixed along Y.
    fn index() -> DofIndex {
        let dof = |node, kind| Dof { node, position: 0.0, kind };
        use DofKind::{RX, X, Y, Z};
        DofIndex::new(&[dof(5, X), dof(5, Y), dof(5, Z), dof(5, RX), dof(9, X), dof(9, Z)])
    }

    #[test]
    fn gaps_close_where_the_normal_points() {
        let wall = Contact::point(&index(), 5, [0.0, 3.0, 4.0], 0.1).unwrap();
        assert_eq!(wall.normal.entries(), [(1, -0.6), (2, -0.8)]);
        // One unit along the normal closes the gap by one.
        let q = [0.0, 0.6, 0.8, 0.0, 0.0, 0.0];
        assert!((wall.gap + wall.normal.dot(&q) + 0.9).abs() < 1e-15);
        let pair = Contact::pair(&index(), 5, 9, [0.0, 0.0, -2.0], 0.1).unwrap();
        assert_eq!(pair.normal.entries(), [(2, 1.0), (5, -1.0)]);
        // A common translation does not change the gap; the supports fix some of the second node.
        assert_eq!(pair.normal.dot(&[1.0; 6]), 0.0);
        let slanted = Contact::pair(&index(), 5, 9, [0.0, 3.0, 4.0], 0.1).unwrap();
        assert_eq!(slanted.normal.entries(), [(1, -0.6), (2, -0.8), (5, 0.8)]);
    }

    #[test]
    fn contacts_that_nothing_can_close_are_refused() {
        let refused = |contact: Result<Contact, ModelError>| contact.unwrap_err();
        assert_eq!(refused(Contact::point(&index(), 9, [0.0, 1.0, 0.0], 0.0)), ModelError::NodeCannotMove { node: 9 });
        assert_eq!(refused(Contact::point(&index(), 7, [0.0, 1.0, 0.0], 0.0)), ModelError::NodeCannotMove { node: 7 });
        assert_eq!(refused(Contact::pair(&index(), 5, 5, [1.0; 3], 0.0)), ModelError::NodeCannotMove { node: 5 });
        let normal = [0.0; 3];
        assert_eq!(refused(Contact::point(&index(), 5, normal, 0.0)), ModelError::NormalLength { normal });
        assert!(Contact::point(&index(), 5, [1e-200, 0.0, 1e-200], 0.0).is_ok());
    }

    #[test]
    fn a_stop_is_a_contact_at_one_degree_of_freedom_and_back() {
        for side in [Side::Positive, Side::Negative] {
            let stop = Contact::elastic(3, side, 0.2, 5.0);
            let single = stop.single_dof().unwrap();
            let law = ContactLaw::Elastic { stiffness: 5.0 };
            assert_eq!(single, DofContact { dof: 3, side, gap: 0.2, law, lent: 0.0 });
            assert_eq!(Contact::from(single), stop);
            assert_eq!(stop.normal.dot(&[0.0, 0.0, 0.0, 1.0]), -side.sign());
        }
        let along_x = Contact::point(&index(), 5, [7.0, 0.0, 0.0], 0.0).unwrap();
        assert_eq!(along_x.single_dof().map(|c| (c.dof, c.side)), Some((0, Side::Positive)));
        assert_eq!(Contact::pair(&index(), 5, 9, [0.0, 0.0, 1.0], 0.0).unwrap().single_dof(), None);
        // An inclined wall and a sliding node: not a stop of unit direction.
        assert_eq!(Contact::point(&index(), 9, [0.0, 0.6, 0.8], 0.0).unwrap().single_dof(), None);
    }
}
