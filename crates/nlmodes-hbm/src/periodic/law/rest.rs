use std::sync::Arc;

use nlmodes_contact::{LcpMatrix, solver_by_name};
use nlmodes_linalg::{DenseLu, Mat, max_norm};

use super::{ForceLaw, LawForce};
use crate::HbmError;
use crate::error::agrees;
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
    /// Displacement of its place from which motions count, m: without the forces of contacts that press at rest.
    pub origin: f64,
}

/// Where the laws of a structure rest whose places static loads move by `moved` (m, one for each law) where no law acts
/// and its contacts are open: with the static flexibility `H` between contacts and laws,
///
/// ```text
/// v + H_vv F(v) − H_vg λ = v_s ,   0 ≤ λ ⊥ g − H_gv F(v) + H_gg λ ≥ 0
/// ```
///
/// # Errors
/// [`HbmError::Size`], [`HbmError::LawsAtRest`] where no such place is found, or the structure floats without its laws;
/// [`HbmError::Compliance`].
pub fn laws_at_rest(structure: &ModalStructure, moved: &[f64]) -> Result<Vec<LawAtRest>, HbmError> {
    let laws = structure.laws();
    let (n, c) = (laws.len(), structure.n_contacts());
    agrees("displacements of laws under static loads", n, moved.len())?;
    let flexibility = static_flexibility(structure)?;
    let contacts = LcpMatrix::new(&flexibility.submatrix(0, 0, c, c).to_owned()).map_err(HbmError::Compliance)?;
    let mut workspace =
        solver_by_name("active-set").and_then(|s| s.workspace(&contacts)).map_err(HbmError::Compliance)?;
    let at_places = |v: &[f64]| -> Vec<LawForce> { laws.iter().zip(v).map(|(law, v)| law.law.at(*v, 0.0)).collect() };
    let by_laws = |i: usize, f: &[LawForce]| -> f64 {
        f.iter().enumerate().map(|(j, f)| flexibility[(i, c + j)] * f.force).sum()
    };
    let mut state = |v: Vec<f64>| -> Result<Trial, HbmError> {
        let forces = at_places(&v);
        let opened = |i: usize| -> f64 { structure.gaps()[i] - by_laws(i, &forces) };
        let (mut closed, mut pressing) = (vec![false; c], vec![0.0; c]);
        let opened: Vec<f64> = (0..c).map(opened).collect();
        workspace.solve(&opened, &mut closed, &mut pressing).map_err(HbmError::Compliance)?;
        let pushed = |l: usize| pressing.iter().enumerate().map(|(i, p)| flexibility[(c + l, i)] * p).sum::<f64>();
        let pushed: Vec<f64> = (0..n).map(pushed).collect();
        let off = (0..n).map(|l| v[l] + by_laws(c + l, &forces) - pushed[l] - moved[l]).collect();
        Ok(Trial { v, forces, closed, pushed, off })
    };
    let mut at = state(moved.to_vec())?;
    for _ in 0..STEPS {
        let size = max_norm(at.off.iter().copied());
        if size <= BALANCED * max_norm(at.v.iter().chain(moved).copied()) {
            let of = |l: usize| {
                let (place, force) = (at.v[l], at.forces[l].force);
                LawAtRest { place, force, origin: place - at.pushed[l] }
            };
            return Ok((0..n).map(of).collect());
        }
        let held = contacts.sensitivity(&at.closed).map_err(HbmError::Compliance)?;
        // Closed contacts give way to the laws by what holds them.
        let own = |l: usize, k: usize| {
            let by_contacts = (0..c).flat_map(|i| (0..c).map(move |j| (i, j)));
            let held = by_contacts.map(|(i, j)| flexibility[(c + l, i)] * held[(i, j)] * flexibility[(j, c + k)]);
            flexibility[(c + l, c + k)] + held.sum::<f64>()
        };
        let jacobian = Mat::from_fn(n, n, |l, k| f64::from(u8::from(l == k)) + own(l, k) * at.forces[k].stiffness);
        let mut step = at.off.clone();
        DenseLu::factor(&jacobian).map_err(|_| HbmError::LawsAtRest)?.solve_in_place(&mut step);
        let mut share = 1.0;
        for k in 0..=HALVINGS {
            let next = state(at.v.iter().zip(&step).map(|(v, s)| v - share * s).collect())?;
            if max_norm(next.off.iter().copied()) < size || k == HALVINGS {
                at = next;
                break;
            }
            share *= 0.5;
        }
    }
    Err(HbmError::LawsAtRest)
}

/// Laws on their way to the place at rest.
struct Trial {
    /// Displacements of their places, m.
    v: Vec<f64>,
    forces: Vec<LawForce>,
    /// The contacts that press.
    closed: Vec<bool>,
    /// What these move at the places, m.
    pushed: Vec<f64>,
    /// What is missing in the displacements, m.
    off: Vec<f64>,
}

/// Static flexibility between contacts, and laws behind them, with the stops of the contacts, m/N.
///
/// # Errors
/// [`HbmError::LawsAtRest`] where laws or contacts that press move a structure that floats.
fn static_flexibility(structure: &ModalStructure) -> Result<Mat<f64>, HbmError> {
    let (laws, c) = (structure.laws(), structure.n_contacts());
    let row = |p: usize, r: usize| p.checked_sub(c).map_or_else(|| structure.rows()[(p, r)], |l| laws[l].modes[r]);
    let mut flexibility =
        Mat::from_fn(c + laws.len(), c + laws.len(), |p, q| match (p.checked_sub(c), q.checked_sub(c)) {
            (None, None) => structure.compliance().a()[(p, q)],
            (None, Some(l)) => laws[l].contacts[p],
            (Some(l), None) => laws[l].contacts[q],
            (Some(l), Some(other)) => laws[l].laws[other],
        });
    let presses = structure.gaps().iter().any(|gap| *gap < 0.0);
    for (r, square) in structure.omega_squared()[..structure.n_moving()].iter().enumerate() {
        let moves = |p: usize| row(p, r) != 0.0;
        let floats = *square <= 0.0;
        if floats && ((c..c + laws.len()).any(moves) || (presses && (0..c).any(moves))) {
            return Err(HbmError::LawsAtRest);
        }
        let places = if floats { 0 } else { c + laws.len() };
        for (p, q) in (0..places).flat_map(|p| (0..places).map(move |q| (p, q))) {
            flexibility[(p, q)] += row(p, r) * row(q, r) / square;
        }
    }
    Ok(flexibility)
}

/// The forces that act for a law whose motions count from its origin: `F(v₀ + v)` less its force at rest, of a stop the
/// stop with what is left of its clearance, and a force that holds it back where it presses.
pub fn about_rest_of_law(law: &Arc<dyn ForceLaw>, at: LawAtRest) -> Vec<Arc<dyn ForceLaw>> {
    match law.stop_moved(at.origin) {
        Some(stop) if at.force == 0.0 => vec![stop],
        Some(stop) => {
            let stored = law.potential(at.place) + at.force * (at.origin - at.place);
            vec![stop, Arc::new(Constant { force: -at.force, stored })]
        }
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
        let found = self.law.at(self.at.origin + v, rate);
        LawForce { force: found.force - self.at.force, ..found }
    }

    fn potential(&self, v: f64) -> f64 {
        let LawAtRest { place, force, origin } = self.at;
        self.law.potential(origin + v) - self.law.potential(place) - force * (origin + v - place)
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
