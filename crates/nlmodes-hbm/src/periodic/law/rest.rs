use std::sync::Arc;

use nlmodes_linalg::{DenseLu, Mat, max_norm};

use super::{ForceLaw, LawForce};
use crate::HbmError;
use crate::periodic::structure::ModalStructure;

/// Newton steps to the place at rest, halvings of one, and force out of balance over the largest at which they end.
const STEPS: usize = 200;
const HALVINGS: usize = 40;
const BALANCED: f64 = 1e-13;

/// Where a law rests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawAtRest {
    /// Displacement of its place, m.
    pub place: f64,
    /// Its force there, N.
    pub force: f64,
}

/// Where the laws of a structure rest whose places static loads move by `moved` (m, one for each law) where no law acts
/// and its contacts are open: `v + H F(v) = v_s` with the static flexibility `H` between the places of the laws.
///
/// # Errors
/// [`HbmError::Size`], [`HbmError::LawsAtRest`] where no such place is found, or the structure floats without its laws.
pub fn laws_at_rest(structure: &ModalStructure, moved: &[f64]) -> Result<Vec<LawAtRest>, HbmError> {
    let laws = structure.laws();
    let n = laws.len();
    if moved.len() != n {
        return Err(HbmError::Size {
            what: "displacements of laws under static loads",
            expected: n,
            found: moved.len(),
        });
    }
    let squares = &structure.omega_squared()[..structure.n_moving()];
    let mut flexibility = Mat::from_fn(n, n, |i, j| laws[i].laws[j]);
    for (r, square) in squares.iter().enumerate() {
        let pushed = laws.iter().any(|law| law.modes[r] != 0.0);
        if *square <= 0.0 && pushed {
            return Err(HbmError::LawsAtRest);
        }
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|_| pushed) {
            flexibility[(i, j)] += laws[i].modes[r] * laws[j].modes[r] / square;
        }
    }
    let forces = |v: &[f64]| -> Vec<LawForce> { laws.iter().zip(v).map(|(law, v)| law.law.at(*v, 0.0)).collect() };
    let missing = |v: &[f64], f: &[LawForce]| -> Vec<f64> {
        let by_laws = |i: usize| f.iter().enumerate().map(|(j, f)| flexibility[(i, j)] * f.force).sum::<f64>();
        (0..n).map(|i| v[i] + by_laws(i) - moved[i]).collect()
    };
    let mut v = moved.to_vec();
    let mut f = forces(&v);
    let mut off = missing(&v, &f);
    for _ in 0..STEPS {
        let by_laws = |i: usize, j: usize| flexibility[(i, j)] * f[j].stiffness;
        let jacobian = Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) + by_laws(i, j));
        let mut step = off.clone();
        DenseLu::factor(&jacobian).map_err(|_| HbmError::LawsAtRest)?.solve_in_place(&mut step);
        let (size, mut share) = (max_norm(off.iter().copied()), 1.0);
        for k in 0..=HALVINGS {
            let next: Vec<f64> = v.iter().zip(&step).map(|(v, s)| v - share * s).collect();
            let next_f = forces(&next);
            let next_off = missing(&next, &next_f);
            if max_norm(next_off.iter().copied()) < size || k == HALVINGS {
                (v, f, off) = (next, next_f, next_off);
                break;
            }
            share *= 0.5;
        }
        let largest = max_norm(v.iter().chain(moved).copied());
        if max_norm(off.iter().copied()) <= BALANCED * largest {
            return Ok(v.into_iter().zip(f).map(|(place, f)| LawAtRest { place, force: f.force }).collect());
        }
    }
    Err(HbmError::LawsAtRest)
}

/// The forces that act for a law whose motions count from its place at rest: `F(v₀ + v) − F(v₀)`, of a stop the stop
/// with what is left of its clearance, and a force that holds it back where it presses.
pub fn about_rest_of_law(law: &Arc<dyn ForceLaw>, at: LawAtRest) -> Vec<Arc<dyn ForceLaw>> {
    match law.stop_moved(at.place) {
        Some(stop) if at.force == 0.0 => vec![stop],
        Some(stop) => vec![stop, Arc::new(Constant { force: -at.force, stored: law.potential(at.place) })],
        None => vec![Arc::new(About { law: law.clone(), at })],
    }
}

/// A law about a place.
#[derive(Debug)]
struct About {
    law: Arc<dyn ForceLaw>,
    at: LawAtRest,
}

impl ForceLaw for About {
    fn at(&self, v: f64, rate: f64) -> LawForce {
        let found = self.law.at(self.at.place + v, rate);
        LawForce { force: found.force - self.at.force, ..found }
    }

    fn potential(&self, v: f64) -> f64 {
        let LawAtRest { place, force } = self.at;
        self.law.potential(place + v) - self.law.potential(place) - force * v
    }

    fn degree(&self) -> Option<usize> {
        self.law.degree()
    }

    fn dissipates(&self) -> bool {
        self.law.dissipates()
    }

    fn without_dissipation(&self) -> Option<Arc<dyn ForceLaw>> {
        Some(Arc::new(Self { law: self.law.without_dissipation()?, at: self.at }))
    }
}

/// A force that nothing changes, N, and the energy that it takes to hold a stop with, J.
#[derive(Debug)]
struct Constant {
    force: f64,
    stored: f64,
}

impl ForceLaw for Constant {
    fn at(&self, _: f64, _: f64) -> LawForce {
        LawForce { force: self.force, ..LawForce::default() }
    }

    fn potential(&self, v: f64) -> f64 {
        self.force * v - self.stored
    }

    fn degree(&self) -> Option<usize> {
        Some(1)
    }
}
