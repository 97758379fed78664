use std::sync::Arc;

use nlmodes_linalg::{DenseLu, Mat};

use super::super::ForcedStructure;
use super::super::flow::Flow;
use super::super::trajectory::Piece;
use super::{LawSeries, Monomials, S};
use crate::TimestepError;

/// Derivatives of the state over steps with laws of force.
///
/// ```text
/// δx⁺ = (Φ_xx + Φ_xc C U) δx ,   (1 + D_v G + D_v̇ Ġ) U = −(D_v B + D_v̇ Ḃ)
/// ```
///
/// `U` are the reactions at the nodes by the state, `C` the coefficients of their polynomials, `G` and `B` what
/// reactions and state move at the places of the laws, `D` the slopes of these there: the derivative of the step as it
/// is computed.
pub struct LawTransitions<'a> {
    structure: &'a ForcedStructure,
    /// The state, and the coefficients of the reactions, in `w`.
    entries: Vec<usize>,
    latest: Option<Latest>,
}

/// What steps of the same lengths with the same contacts have together.
struct Latest {
    flow: Arc<Flow>,
    law_step: f64,
    length: f64,
    /// Displacement and rate of each law at the nodes by each reaction, and by each entry of the state.
    by_reactions: Vec<Vec<[f64; 2]>>,
    by_state: Vec<Vec<[f64; 2]>>,
    /// The transition of the entries.
    over: Mat<f64>,
}

impl<'a> LawTransitions<'a> {
    pub fn new(structure: &'a ForcedStructure) -> Self {
        let reactions = structure.laws.iter().map(|at| structure.first_of_input(at.input));
        let entries = (0..structure.n_states()).chain(reactions.flat_map(|first| first..first + S)).collect();
        Self { structure, entries, latest: None }
    }

    /// The derivative over a piece.
    pub fn over(&mut self, piece: &Piece) -> Result<Mat<f64>, TimestepError> {
        let latest = match self.latest.take().filter(|latest| latest.fits(piece)) {
            Some(latest) => latest,
            None => self.prepared(piece)?,
        };
        let structure = self.structure;
        let (n, laws) = (structure.n_states(), &structure.laws);
        let (flow, h) = (&piece.flow, piece.law_step);
        // Slopes at the nodes of each law.
        let mut slopes = Vec::with_capacity(laws.len() * S);
        for (at, law) in laws.iter().zip(&flow.laws) {
            let places = law.values(|series| series.from(&piece.w), flow, h);
            slopes.extend(places.iter().take(S).map(|&[v, rate]| at.law.at(v, rate)));
        }
        let moved = |q: usize, by: &[f64; 2]| slopes[q][1] * by[0] + slopes[q][2] * by[1];
        let row = |q: usize| q / S * (S + 2) + q % S;
        let all = slopes.len();
        let jacobian =
            Mat::from_fn(all, all, |q, j| f64::from(u8::from(q == j)) + moved(q, &latest.by_reactions[row(q)][j]));
        let lu = DenseLu::factor(&jacobian).map_err(TimestepError::during("derivative of a step with laws"))?;
        let (monomials, scale) = (Monomials::new(), h * structure.rate());
        let mut over = Mat::from_fn(n, n, |i, j| latest.over[(i, j)]);
        for j in 0..n {
            let mut by: Vec<f64> = (0..all).map(|q| -moved(q, &latest.by_state[row(q)][j])).collect();
            lu.solve_in_place(&mut by);
            for (l, own) in by.chunks(S).enumerate() {
                let mut factor = 1.0;
                for (k, row) in monomials.0.iter().enumerate() {
                    let coefficient = factor * row.iter().zip(own).map(|(m, u)| m * u).sum::<f64>();
                    (0..n).for_each(|i| over[(i, j)] += latest.over[(i, n + l * S + k)] * coefficient);
                    factor /= scale;
                }
            }
        }
        self.latest = Some(latest);
        Ok(over)
    }

    fn prepared(&self, piece: &Piece) -> Result<Latest, TimestepError> {
        let (structure, flow, h) = (self.structure, &piece.flow, piece.law_step);
        let of_law = |law: &LawSeries| -> Vec<Vec<[f64; 2]>> {
            let by_entry = |j: usize| law.values(|series| series.column(j), flow, h);
            let columns: Vec<_> = (0..structure.n_states()).map(by_entry).collect();
            (0..S + 2).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
        };
        Ok(Latest {
            flow: Arc::clone(flow),
            law_step: h,
            length: piece.length,
            by_reactions: structure.law_moves(flow, h),
            by_state: flow.laws.iter().flat_map(of_law).collect(),
            over: flow.transition_of(&self.entries, piece.length)?,
        })
    }
}

impl Latest {
    fn fits(&self, piece: &Piece) -> bool {
        Arc::ptr_eq(&self.flow, &piece.flow) && self.law_step == piece.law_step && self.length == piece.length
    }
}
