//! Matrices as their files have them, where other unknowns have taken the place of theirs.

use std::collections::BTreeMap;
use std::sync::Arc;

use nlmodes_linalg::{LinalgError, Origin, Written, sparse_from_triplets};

use super::FeModel;
use crate::labels::DofLabel;
use crate::lower::{LowerTriangle, Motion};
use crate::units::UnitSystem;

/// `K₀` and `M₀` of the files and the motion `T` of their rows: `K = Tᵀ K₀ T`, `M = Tᵀ M₀ T`.
#[derive(Debug, Clone)]
pub(super) struct AsWritten {
    stiffness: LowerTriangle,
    mass: LowerTriangle,
    motion: Motion,
}

impl FeModel {
    /// How far stiffness and mass are known: the digits of the files, in the matrices that they hold.
    ///
    /// # Errors
    /// [`LinalgError`] if there is no memory for them.
    pub fn written(&self) -> Result<Written, LinalgError> {
        let Some(own) = &self.as_written else { return Ok(self.digits.into()) };
        let rows = own.motion.iter().enumerate();
        let entries: Vec<_> =
            rows.flat_map(|(row, terms)| terms.iter().map(move |(of, part)| (row, *of, *part))).collect();
        let motion = sparse_from_triplets(own.motion.len(), self.labels.len(), &entries)?;
        let origin = Origin { stiffness: own.stiffness.symmetric()?, mass: own.mass.symmetric()?, motion };
        Ok(Written { digits: self.digits, origin: Some(Arc::new(origin)) })
    }

    /// Takes other unknowns, of which `motion` makes the present ones.
    pub(super) fn take_unknowns(&mut self, motion: &Motion) {
        let own = match self.as_written.take() {
            Some(own) => AsWritten { motion: joined(&own.motion, motion), ..own },
            None => AsWritten { stiffness: self.stiffness.clone(), mass: self.mass.clone(), motion: motion.clone() },
        };
        self.as_written = Some(own);
        self.stiffness = self.stiffness.congruent(motion);
        self.mass = self.mass.congruent(motion);
    }

    /// Keeps the rows with a place `to`, `order` of them.
    pub(super) fn keep_rows(&mut self, to: &[Option<usize>], order: usize) {
        self.stiffness = self.stiffness.placed(to, order);
        self.mass = self.mass.placed(to, order);
        for terms in self.as_written.iter_mut().flat_map(|own| &mut own.motion) {
            *terms = terms.iter().filter_map(|(row, part)| Some((to[*row]?, *part))).collect();
        }
    }
}

impl AsWritten {
    /// From the units of the files, whose rows these are, into those of SI. Other unknowns are of the same kind.
    pub(super) fn scale(&mut self, labels: &[DofLabel], units: &UnitSystem) {
        let component = |row: usize| labels[row].component;
        self.stiffness.scale(|i, j| units.stiffness(component(i), component(j)));
        self.mass.scale(|i, j| units.mass(component(i), component(j)));
    }
}

/// The motion of the first rows in the last unknowns.
fn joined(first: &Motion, then: &Motion) -> Motion {
    let of = |terms: &Vec<(usize, f64)>| {
        let mut sums = BTreeMap::new();
        for (row, part) in terms {
            then[*row].iter().for_each(|(of, share)| *sums.entry(*of).or_insert(0.0) += part * share);
        }
        sums.into_iter().collect()
    };
    first.iter().map(of).collect()
}
