use std::ops::Deref;

use nlmodes_linalg::{DenseLu, Mat, eigenvalues};

use super::laws::LawSeries;
use super::linear::{LinearFlow, TURN};
use super::series::FlowSeries;
use super::{DEGREE, ForcedStructure, Observed};
use crate::TimestepError;

/// The structure as long as one set of contacts is closed: `ẇ = 𝒜 w` for the state extended by a one, the oscillators
/// of the periodic load and the Taylor coefficients of all others, so that loads and gaps are included and resonance
/// needs no special treatment.
#[derive(Debug)]
pub(super) struct Flow {
    pub closed: Vec<bool>,
    linear: LinearFlow,
    /// Guards, which must not become negative, m: the gap of an open contact, the force of a closed one times its own
    /// compliance.
    pub guards: Vec<Vec<f64>>,
    /// Those along a step.
    pub watched: Vec<FlowSeries>,
    /// Contact forces (N), gaps without them and with them (m).
    pub forces: Vec<Vec<f64>>,
    pub free: Vec<Vec<f64>>,
    pub gaps: Vec<Vec<f64>>,
    /// Forces and observed displacements along a step.
    pub forces_along: Vec<FlowSeries>,
    pub observed: Vec<FlowSeries>,
    /// Displacements of the laws along a step.
    pub laws: Vec<LawSeries>,
}

impl ForcedStructure {
    /// Length of `w`.
    pub(super) fn n_augmented(&self) -> usize {
        self.n_states() + 1 + 2 * self.loads.len() + (DEGREE + 1) * self.inputs.len()
    }

    /// Where the Taylor coefficients of an input begin in `w`.
    pub(super) fn first_of_input(&self, input: usize) -> usize {
        self.n_states() + 1 + 2 * self.loads.len() + (DEGREE + 1) * input
    }

    /// `w` of a state (rates in their unit) at an instant; inputs are zero.
    pub(super) fn augmented(&self, state: &[f64], omega: f64, t: f64) -> Vec<f64> {
        let mut w: Vec<f64> = state.iter().copied().chain([1.0]).collect();
        w.resize(self.n_augmented(), 0.0);
        self.turn_oscillators(&mut w, omega, t);
        w
    }

    /// Sets the oscillators of the load to an instant.
    pub(super) fn turn_oscillators(&self, w: &mut [f64], omega: f64, t: f64) {
        let first = self.n_states() + 1;
        for (load, at) in self.loads.iter().zip(w[first..].chunks_exact_mut(2)) {
            let (sin, cos) = (load.harmonic as f64 * omega * t).sin_cos();
            (at[0], at[1]) = (cos, sin);
        }
    }

    /// Gaps without contact forces as rows acting on `w`.
    pub(super) fn free_gaps(&self, level: f64) -> Vec<Vec<f64>> {
        let (m, s) = (self.n_modes(), self.n_states());
        let row = |i: usize| {
            let mut row = vec![0.0; self.n_augmented()];
            (0..m).for_each(|k| row[k] = self.rows[(i, k)]);
            for (j, _) in self.dampers.iter().enumerate().filter(|(_, damper)| damper.0 == i) {
                row[2 * m + j] = 1.0;
            }
            row[s] = self.gaps[i];
            for (j, load) in self.loads.iter().enumerate() {
                (row[s + 1 + 2 * j], row[s + 2 + 2 * j]) = (level * load.gaps[i].re, -level * load.gaps[i].im);
            }
            for (j, input) in self.inputs.iter().enumerate() {
                row[self.first_of_input(j)] = input.gaps[i];
            }
            row
        };
        (0..self.n_contacts()).map(row).collect()
    }

    /// `𝒜` with all contacts open.
    fn open_matrix(&self, omega: f64, level: f64) -> Mat<f64> {
        let (m, s, rate) = (self.n_modes(), self.n_states(), self.rate());
        let mut a = Mat::zeros(self.n_augmented(), self.n_augmented());
        for k in 0..m {
            a[(k, m + k)] = rate;
            a[(m + k, k)] = -self.omega_squared[k] / rate;
            (0..m).for_each(|l| a[(m + k, m + l)] = -self.damping[(k, l)]);
            a[(m + k, s)] = self.steady.get(k).map_or(0.0, |force| force / rate);
        }
        for (j, (_, stiffness, damper)) in self.dampers.iter().enumerate() {
            a[(2 * m + j, 2 * m + j)] = -stiffness / damper;
        }
        for (j, load) in self.loads.iter().enumerate() {
            let (cos, sin, nu) = (s + 1 + 2 * j, s + 2 + 2 * j, load.harmonic as f64 * omega);
            (a[(cos, sin)], a[(sin, cos)]) = (-nu, nu);
            for (k, p) in load.modal.iter().enumerate() {
                (a[(m + k, cos)], a[(m + k, sin)]) = (level * p.re / rate, -level * p.im / rate);
            }
        }
        for (j, input) in self.inputs.iter().enumerate() {
            let first = self.first_of_input(j);
            // u = Σ c_i (rate t)^i about the present instant: the derivative of c_i is (i + 1) rate c_{i+1}.
            (0..DEGREE).for_each(|i| a[(first + i, first + i + 1)] = (i + 1) as f64 * rate);
            input.modal.iter().enumerate().for_each(|(k, p)| a[(m + k, first)] = p / rate);
        }
        a
    }

    /// The flow with these contacts closed.
    pub(super) fn flow(&self, closed: &[bool], omega: f64, level: f64) -> Result<Flow, TimestepError> {
        let (m, s, n) = (self.n_modes(), self.n_states(), self.n_augmented());
        let (free, mut matrix) = (self.free_gaps(level), self.open_matrix(omega, level));
        let forces = self.forces(closed, &free)?;
        let a = self.compliance.a();
        for (i, force) in forces.iter().enumerate().filter(|(i, _)| closed[*i]) {
            for k in 0..m {
                let by = self.rows[(i, k)] / self.rate();
                (0..n).for_each(|j| matrix[(m + k, j)] += by * force[j]);
            }
            for (d, damper) in self.dampers.iter().enumerate().filter(|(_, damper)| damper.0 == i) {
                (0..n).for_each(|j| matrix[(2 * m + d, j)] += force[j] / damper.2);
            }
        }
        let pressed =
            |i: usize, j: usize| free[i][j] + (0..closed.len()).map(|l| a[(i, l)] * forces[l][j]).sum::<f64>();
        let gaps: Vec<Vec<f64>> = (0..closed.len()).map(|i| (0..n).map(|j| pressed(i, j)).collect()).collect();
        let guard = |i: usize| match closed[i] {
            true => forces[i].iter().map(|f| f * a[(i, i)]).collect(),
            false => gaps[i].clone(),
        };
        let own = Mat::from_fn(s, s, |i, j| matrix[(i, j)]);
        let found =
            eigenvalues(&own).map_err(TimestepError::during("rates of a structure with some contacts closed"))?;
        let loads = self.loads.iter().map(|load| load.harmonic as f64 * omega);
        let fastest = found.iter().map(|z| z.norm()).chain(loads).fold(omega, f64::max);
        let step = TURN / fastest;
        let linear = LinearFlow::new(matrix, step)
            .map_err(TimestepError::during("exponential of a structure with some contacts closed"))?;
        let guards: Vec<Vec<f64>> = (0..closed.len()).map(guard).collect();
        let along = |rows: &[Vec<f64>]| rows.iter().map(|row| linear.along(row)).collect();
        let observed: Vec<Vec<f64>> = self.observed.iter().map(|of| self.observed_row(of, &forces, level)).collect();
        let places: Vec<Vec<f64>> = self.laws.iter().map(|at| self.observed_row(&at.place, &forces, level)).collect();
        let (watched, forces_along, observed) = (along(&guards), along(&forces), along(&observed));
        let laws = places.iter().enumerate().map(|(l, place)| self.law_series(l, place, &linear));
        let (closed, laws) = (closed.to_vec(), laws.collect());
        Ok(Flow { closed, linear, guards, watched, forces, free, gaps, forces_along, observed, laws })
    }

    /// An observed displacement as a row acting on `w`.
    fn observed_row(&self, of: &Observed, forces: &[Vec<f64>], level: f64) -> Vec<f64> {
        let mut row = vec![0.0; self.n_augmented()];
        row[..self.n_modes()].copy_from_slice(&of.modes);
        for (weight, force) in of.contacts.iter().zip(forces) {
            row.iter_mut().zip(force).for_each(|(row, force)| *row += weight * force);
        }
        of.inputs.iter().enumerate().for_each(|(j, moved)| row[self.first_of_input(j)] += moved);
        let oscillators = self.n_states() + 1;
        for (j, moved) in of.loads.iter().enumerate() {
            row[oscillators + 2 * j] += level * moved.re;
            row[oscillators + 2 * j + 1] -= level * moved.im;
        }
        row
    }

    /// Contact forces as rows acting on `w`: `λ_S = −A_SS⁻¹ y_S`, zero for open contacts.
    fn forces(&self, closed: &[bool], free: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, TimestepError> {
        let set: Vec<usize> = (0..closed.len()).filter(|&i| closed[i]).collect();
        let (a, n) = (self.compliance.a(), self.n_augmented());
        let mut forces = vec![vec![0.0; n]; closed.len()];
        if set.is_empty() {
            return Ok(forces);
        }
        let own = Mat::from_fn(set.len(), set.len(), |i, j| a[(set[i], set[j])]);
        let lu = DenseLu::factor(&own).map_err(TimestepError::during("flexibility of the closed contacts"))?;
        for j in 0..n {
            let mut column: Vec<f64> = set.iter().map(|&i| -free[i][j]).collect();
            lu.solve_in_place(&mut column);
            set.iter().zip(column).for_each(|(&i, f)| forces[i][j] = f);
        }
        Ok(forces)
    }
}

impl Deref for Flow {
    type Target = LinearFlow;

    fn deref(&self) -> &LinearFlow {
        &self.linear
    }
}

impl Flow {
    /// The transition of entries of `w` which only these entries drive over a time within a step.
    pub fn transition_of(&self, entries: &[usize], t: f64) -> Result<Mat<f64>, TimestepError> {
        let failed = TimestepError::during("exponential of a structure with some contacts closed");
        self.linear.transition_of(entries, t).map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::{dot, product};
    use num_complex::Complex64;

    /// A mode of 2 rad/s with two contacts, each stop with a spring and a damper, under loads of two harmonics; the
    /// phases of the load in the gaps too.
    fn structure() -> ForcedStructure {
        let rows = Mat::from_fn(2, 1, |i, _| [1.5, -0.5][i]);
        let compliance = Mat::from_fn(2, 2, |i, j| if i == j { [0.2, 0.4][i] } else { 0.1 });
        let mut structure = ForcedStructure::new(&[4.0], &Mat::zeros(1, 1), &rows, &compliance, &[0.3, 0.7]).unwrap();
        structure.push_damped_stop(0, 3.0, 2.0).unwrap();
        structure.push_damped_stop(1, 5.0, 0.5).unwrap();
        structure.push_load(1, &[Complex64::default()], &[Complex64::new(0.02, 0.01), Complex64::default()]).unwrap();
        structure.push_load(3, &[Complex64::default()], &[Complex64::default(), Complex64::new(0.0, -0.03)]).unwrap();
        structure
    }

    const STATE: [f64; 4] = [0.8, -0.3, 0.05, -0.02];

    #[test]
    fn an_open_structure_swings_and_its_stops_come_back_each_at_its_own_rate() {
        let (structure, omega, begin) = (structure(), 1.3, 0.4);
        let flow = structure.flow(&[false, false], omega, 1.0).unwrap();
        let w = structure.augmented(&STATE, omega, begin);
        for t in [0.0, 0.3 * flow.step, flow.step] {
            // Rates are in units of the highest frequency.
            let (sin, cos) = (2.0 * t).sin_cos();
            let oscillators = [1.0, 3.0].map(|n| (n * omega * (begin + t)).sin_cos());
            let expected = [
                0.8 * cos - 0.3 * sin,
                -0.3 * cos - 0.8 * sin,
                0.05 * (-1.5 * t).exp(),
                -0.02 * (-10.0 * t).exp(),
                1.0,
                oscillators[0].1,
                oscillators[0].0,
                oscillators[1].1,
                oscillators[1].0,
            ];
            let found = flow.after(&w, t);
            assert_eq!(found.len(), expected.len());
            found.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-13, "{t}: {found:?}"));
            let transition = flow.transition_of(&[0, 1, 2, 3], t).unwrap();
            for j in 0..4 {
                let unit: Vec<f64> = (0..w.len()).map(|i| f64::from(u8::from(i == j))).collect();
                let column = flow.after(&unit, t);
                (0..4).for_each(|i| assert!((transition[(i, j)] - column[i]).abs() < 1e-13));
            }
        }
    }

    #[test]
    fn gaps_and_forces_of_every_closed_set_are_those_of_its_linear_equations() {
        let (structure, omega, t, level) = (structure(), 1.3, 0.4, 0.9);
        let w = structure.augmented(&STATE, omega, t);
        let moved = [
            Complex64::new(0.02, 0.01) * Complex64::cis(omega * t),
            Complex64::new(0.0, -0.03) * Complex64::cis(3.0 * omega * t),
        ];
        let y = [0.3 + 1.5 * 0.8 + 0.05 + level * moved[0].re, 0.7 - 0.5 * 0.8 - 0.02 + level * moved[1].re];
        for closed in [[false, false], [true, false], [false, true], [true, true]] {
            let flow = structure.flow(&closed, omega, level).unwrap();
            let forces = match closed {
                [false, false] => [0.0, 0.0],
                [true, false] => [-y[0] / 0.2, 0.0],
                [false, true] => [0.0, -y[1] / 0.4],
                // The inverse of [0.2, 0.1; 0.1, 0.4] is [0.4, −0.1; −0.1, 0.2]/0.07.
                [true, true] => [(-0.4 * y[0] + 0.1 * y[1]) / 0.07, (0.1 * y[0] - 0.2 * y[1]) / 0.07],
            };
            let gaps = [y[0] + 0.2 * forces[0] + 0.1 * forces[1], y[1] + 0.1 * forces[0] + 0.4 * forces[1]];
            for i in 0..2 {
                let near =
                    |row: &[f64], expected: f64| assert!((dot(row, &w) - expected).abs() < 1e-12, "{closed:?} {i}");
                near(&flow.forces[i], forces[i]);
                near(&flow.free[i], y[i]);
                near(&flow.gaps[i], gaps[i]);
                near(&flow.guards[i], if closed[i] { [0.2, 0.4][i] * forces[i] } else { gaps[i] });
            }
            // ẇ: the mode is driven by Yᵀ λ, the dampers by their own forces.
            let rate = product(&flow.matrix, &w);
            let push = 1.5 * forces[0] - 0.5 * forces[1];
            let expected =
                [-0.6, (push - 4.0 * 0.8) / 2.0, (forces[0] - 3.0 * 0.05) / 2.0, (forces[1] + 5.0 * 0.02) / 0.5];
            rate.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{closed:?}: {a} {b}"));
        }
    }
}
