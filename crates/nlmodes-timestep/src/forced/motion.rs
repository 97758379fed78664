use std::f64::consts::TAU;

use nlmodes_linalg::gauss_legendre;
use num_complex::Complex64;

use super::flow::Flow;
use super::trajectory::Piece;
use crate::first_root::Guard;
use crate::phase::dot;

/// A periodic motion under a load, exact to rounding.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ForcedMotion {
    /// Angular frequency of the load, rad/s.
    pub omega: f64,
    /// Number of load periods per period of the motion.
    pub periods: usize,
    /// The state at the beginning: modal coordinates, their rates, displacements of the dissipative stops.
    pub state: Vec<f64>,
    /// Relative difference of the state at the end of the period.
    pub residual: f64,
    /// Floquet multipliers over the period of the motion, in order of decreasing magnitude.
    pub multipliers: Vec<Complex64>,
    pub(super) pieces: Vec<Piece>,
}

/// Parts of a step, in each of which a rule of eight points is taken.
const PARTS: usize = 4;

impl ForcedMotion {
    /// Complex amplitude of modal coordinate k at `harmonic` times the frequency of the motion (that of the load over
    /// its periods), m √kg.
    pub fn modal_harmonic(&self, k: usize, harmonic: usize) -> Complex64 {
        let unit = |flow: &Flow| (0..flow.matrix.nrows()).map(|j| f64::from(u8::from(j == k))).collect::<Vec<f64>>();
        self.harmonic(|flow| unit(flow), harmonic)
    }

    /// Complex amplitude of a contact force, N.
    pub fn force_harmonic(&self, contact: usize, harmonic: usize) -> Complex64 {
        self.harmonic(|flow| flow.forces[contact].clone(), harmonic)
    }

    /// Complex amplitude of a gap without contact forces, m.
    pub fn free_gap_harmonic(&self, contact: usize, harmonic: usize) -> Complex64 {
        self.harmonic(|flow| flow.free[contact].clone(), harmonic)
    }

    /// Complex amplitude of an observed displacement, m.
    pub fn observed_harmonic(&self, number: usize, harmonic: usize) -> Complex64 {
        self.harmonic(|flow| flow.observed[number].row().to_vec(), harmonic)
    }

    /// Smallest and largest value of an observed displacement, m.
    pub fn observed_extremes(&self, number: usize) -> [f64; 2] {
        let most = |sign: f64| {
            let of = |piece: &Piece| {
                let row: Vec<f64> = piece.flow.observed[number].row().iter().map(|v| sign * v).collect();
                self.highest(piece, &row)
            };
            self.pieces.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
        };
        [-most(-1.0), most(1.0)]
    }

    /// Share of the period in which a contact is closed.
    pub fn closed_share(&self, contact: usize) -> f64 {
        let closed = self.pieces.iter().filter(|piece| piece.flow.closed[contact]);
        closed.map(|piece| piece.length).sum::<f64>() / self.period()
    }

    /// Number of times a contact closes in a period of the motion.
    pub fn touches(&self, contact: usize) -> usize {
        let closed = |piece: &Piece| piece.flow.closed[contact];
        let n = self.pieces.len();
        (0..n).filter(|&j| closed(&self.pieces[j]) && !closed(&self.pieces[(j + n - 1) % n])).count()
    }

    /// Largest contact force, N.
    pub fn peak_force(&self, contact: usize) -> f64 {
        let closed = self.pieces.iter().filter(|piece| piece.flow.closed[contact]);
        closed.map(|piece| self.highest(piece, &piece.flow.forces[contact])).fold(0.0, f64::max)
    }

    /// Smallest gap, m: zero for a rigid stop with contact.
    pub fn smallest_gap(&self, contact: usize) -> f64 {
        let falling = |piece: &Piece| -> Vec<f64> { piece.flow.gaps[contact].iter().map(|v| -v).collect() };
        -self.pieces.iter().map(|piece| self.highest(piece, &falling(piece))).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Free gap and contact force at an instant within the period (m, N).
    pub fn contact_at(&self, contact: usize, t: f64) -> [f64; 2] {
        let i = self.pieces.partition_point(|piece| piece.from <= t).saturating_sub(1);
        let piece = &self.pieces[i];
        let w = piece.flow.after(&piece.w, (t - piece.from).clamp(0.0, piece.length));
        [dot(&piece.flow.free[contact], &w), dot(&piece.flow.forces[contact], &w)]
    }

    /// The period of the motion, s.
    pub fn period(&self) -> f64 {
        TAU * self.periods as f64 / self.omega
    }

    fn highest(&self, piece: &Piece, row: &[f64]) -> f64 {
        let along = piece.flow.along(row).from(&piece.w);
        along.highest(piece.length / piece.flow.step)
    }

    /// `(2/T) ∫ r(t) e^{−i n ω t} dt` of a row, half of it for the mean.
    fn harmonic(&self, row: impl Fn(&Flow) -> Vec<f64>, harmonic: usize) -> Complex64 {
        let nu = harmonic as f64 * self.omega / self.periods as f64;
        let (mut sum, rule) = (Complex64::default(), gauss_legendre(8));
        for piece in &self.pieces {
            let along = piece.flow.along(&row(&piece.flow)).from(&piece.w);
            // Within a part neither the motion nor its harmonic turns by much.
            let parts = PARTS + (nu * piece.length).ceil() as usize;
            let half = 0.5 * piece.length / parts as f64;
            for (part, [node, weight]) in (0..parts).flat_map(|part| rule.iter().map(move |pair| (part, pair))) {
                let t = half * (2.0 * part as f64 + 1.0 + node);
                let value = along.evaluate(t / piece.flow.step)[0];
                sum += Complex64::cis(-nu * (piece.from + t)) * (half * weight * value);
            }
        }
        sum * (if harmonic == 0 { 1.0 } else { 2.0 } / self.period())
    }
}
