use crate::ModelError;

/// A linear combination of few degrees of freedom: a column `w` of `W`, `g = g₀ + wᵀ q`.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseDirection {
    /// Degrees of freedom, ascending, with their coefficients, none of them zero.
    entries: Vec<(usize, f64)>,
}

impl SparseDirection {
    /// The direction with the coefficients `(dof, w)`, in any order; those of one degree of freedom are added.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`]; [`ModelError::EmptyDirection`] if only zeros remain.
    pub fn new(entries: impl IntoIterator<Item = (usize, f64)>) -> Result<Self, ModelError> {
        let mut all: Vec<(usize, f64)> = entries.into_iter().collect();
        if let Some(&(index, value)) = all.iter().find(|(_, w)| !w.is_finite()) {
            return Err(ModelError::NotFinite { what: "direction of a contact at degree of freedom", index, value });
        }
        all.sort_by_key(|(dof, _)| *dof);
        all.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            kept.1 += if same { later.1 } else { 0.0 };
            same
        });
        all.retain(|(_, w)| *w != 0.0);
        if all.is_empty() { Err(ModelError::EmptyDirection) } else { Ok(Self { entries: all }) }
    }

    /// One degree of freedom with a coefficient that is not zero.
    pub(crate) fn single(dof: usize, w: f64) -> Self {
        Self { entries: vec![(dof, w)] }
    }

    /// `(dof, w)`, ascending.
    pub fn entries(&self) -> &[(usize, f64)] {
        &self.entries
    }

    /// `wᵀ q`.
    ///
    /// # Panics
    /// If `q` is too short.
    pub fn dot(&self, q: &[f64]) -> f64 {
        self.entries.iter().map(|&(dof, w)| w * q[dof]).sum()
    }

    /// Adds the force `w λ` to `force`.
    ///
    /// # Panics
    /// If `force` is too short.
    pub fn scatter(&self, lambda: f64, force: &mut [f64]) {
        self.entries.iter().for_each(|&(dof, w)| force[dof] += w * lambda);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_is_its_own_transpose() {
        let w = SparseDirection::new([(4, 0.6), (1, -0.5), (4, 0.2), (2, 0.0)]).unwrap();
        assert_eq!(w.entries(), [(1, -0.5), (4, 0.8)]);
        let q = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(w.dot(&q), 3.0);
        // λ (wᵀ q) = (w λ)ᵀ q.
        let mut force = [0.0; 5];
        w.scatter(2.0, &mut force);
        assert_eq!(force.iter().zip(q).map(|(f, q)| f * q).sum::<f64>(), 6.0);
    }

    #[test]
    fn directions_that_are_none_are_refused() {
        assert_eq!(SparseDirection::new([(1, 0.5), (1, -0.5)]).unwrap_err(), ModelError::EmptyDirection);
        assert!(matches!(SparseDirection::new([(3, f64::NAN)]).unwrap_err(), ModelError::NotFinite { index: 3, .. }));
    }
}
