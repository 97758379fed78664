//! Residual and Jacobian row by row: connectivity, energy, phase.

use nlmodes_continuation::Linearization;
use nlmodes_linalg::{Mat, add_product};

use super::{MixedShooting, subtract};
use crate::energy::inner;
use crate::{HbmError, Symmetry};

/// Squared angular frequency of a harmonic and its derivative with respect to ω.
#[derive(Clone, Copy)]
pub(super) struct Nu {
    pub squared: f64,
    pub d_omega: f64,
}

pub(super) struct EnergyTotals {
    pub value: f64,
    pub d_b: Vec<f64>,
    pub d_omega: f64,
}

impl MixedShooting<'_> {
    /// Rows of eq. (14) for real coefficient `m`, with the unfolding term; `plane` is that of its harmonic.
    pub(super) fn connectivity_rows(&mut self, m: usize, nu: Nu, unfolding: f64, out: &mut Linearization) {
        let (n, width) = (self.structure.n_contact_dofs(), self.sweep.series.width());
        let (size, scale) = (n * width, 1.0 / self.scales.length);
        let rotated = self.sweep.series.turned(m);
        let plane = &self.plane;
        (0..n).for_each(|d| self.rows[(d * width + m) * size..][..size].fill(0.0));
        let (from, to) = (&self.dkept_db[m * size..], &mut self.rows[m * size..]);
        add_product(1.0, &plane.b, from, to, [n, n, size], width * size);
        for d in 0..n {
            let row = d * width + m;
            let (mut value, mut slope, mut turn) = (0.0, 0.0, 0.0);
            let entries = &mut self.rows[row * size..(row + 1) * size];
            for e in 0..n {
                let (b, q, kept) = (self.b[e * width + m], self.q[e * width + m], self.kept[e * width + m]);
                // A b − B q = (A − B) b + B (b − q)
                value += plane.d[d * n + e] * b + plane.b[d * n + e] * kept;
                slope += plane.da[d * n + e] * b - plane.db[d * n + e] * q;
                entries[e * width + m] += plane.d[d * n + e];
                if let Some((other, factor)) = rotated {
                    let rotate = plane.b[d * n + e] * factor;
                    turn += rotate * self.b[e * width + other];
                    slope += unfolding * plane.db[d * n + e] * factor * self.b[e * width + other];
                    entries[e * width + other] += unfolding * rotate;
                }
            }
            if m == 0 {
                value -= self.structure.statics.lift.get(d).copied().unwrap_or(0.0);
            }
            if let Some(opening) = &self.opening {
                let moved = (0..n).map(|e| plane.b[d * n + e] * opening.dq[e * width + m]).sum::<f64>();
                out.jacobian[(row, out.residual.len())] = -moved * scale;
            }
            out.residual[row] = (value + unfolding * turn) * scale;
            out.sizes[row] = self.plane.size_of_row(d, nu.squared);
            out.jacobian[(row, size)] = slope * nu.d_omega * self.scales.omega * scale;
            if self.settings.symmetry == Symmetry::None {
                out.jacobian[(row, size + 1)] = turn * scale;
            }
        }
    }

    pub(super) fn energy_row(
        &mut self,
        omega: f64,
        p: f64,
        gradient_q: &[f64],
        totals: &EnergyTotals,
        out: &mut Linearization,
    ) -> Result<(), HbmError> {
        let size = self.b.len();
        let energy = totals.value;
        if !(energy.is_finite() && energy > 0.0) {
            return Err(HbmError::Motion { omega, energy });
        }
        let row = size;
        out.residual[row] = (energy / self.scales.energy).ln() - p;
        let entries = &mut self.rows[size * size..];
        entries.copy_from_slice(&totals.d_b);
        for (i, weight) in gradient_q.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            entries[i] += weight;
            subtract(entries, *weight, &self.dkept_db[i * size..(i + 1) * size]);
        }
        let unit = self.scales.length / energy;
        entries.iter_mut().for_each(|r| *r *= unit);
        out.jacobian[(row, size)] = totals.d_omega * self.scales.omega / energy;
        out.jacobian[(row, out.residual.len())] =
            self.opening.as_ref().map_or(-1.0, |opening| inner(gradient_q, &opening.dq) / energy);
        Ok(())
    }

    /// Writes the rows made so far, and zeros below them.
    pub(super) fn put_rows(&self, jacobian: &mut Mat<f64>) {
        let size = self.b.len();
        for j in 0..size {
            let column = jacobian.col_mut(j).try_as_col_major_mut().expect("columns of a Mat are contiguous");
            let (made, below) = column.as_slice_mut().split_at_mut(size + 1);
            made.iter_mut().zip(self.rows[j..].iter().step_by(size)).for_each(|(to, from)| *to = *from);
            below.fill(0.0);
        }
    }

    /// Anchors the phase of the motion `x`; one that stands still has none.
    pub(super) fn hold_phase(&mut self, x: &[f64]) {
        if self.settings.symmetry == Symmetry::Even {
            return;
        }
        let width = self.sweep.series.width();
        let turned = |i: usize| {
            let (d, m) = (i / width, i % width);
            self.sweep.series.turned(m).map_or(0.0, |(other, factor)| factor * x[d * width + other])
        };
        let anchor: Vec<f64> = (0..self.b.len()).map(turned).collect();
        let length = inner(&anchor, &anchor).sqrt();
        if length > 0.0 {
            self.anchor = anchor.into_iter().map(|a| a / length).collect();
        }
    }

    pub(super) fn anchor_row(&self, x: &[f64], out: &mut Linearization) {
        let row = self.b.len() + 1;
        out.residual[row] = inner(&self.anchor, x);
        self.anchor.iter().enumerate().for_each(|(j, a)| out.jacobian[(row, j)] = *a);
    }
}
