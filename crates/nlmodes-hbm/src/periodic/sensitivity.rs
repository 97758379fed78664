//! What a parameter of the structure or its load does to the equations, for curves over it.

use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_linalg::Mat;

use super::change::StructureChange;
use super::closing_equations::{Functional, Motion};
use super::rows::complex_harmonic;
use super::system::PeriodicSystem;
use super::weights::StructureWeights;
use crate::HbmError;

/// A parameter at a motion: `∂R/∂p`, and what it does to the gaps where the unknowns stay, c × width.
struct Parameter {
    column: Vec<f64>,
    gaps: Vec<f64>,
}

/// The smallest gap of a contact over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct Opening {
    /// Its value, m; negative where it would close.
    pub value: f64,
    /// Its derivatives by the unknowns and the parameter of the curve, n + 1.
    pub by: Vec<f64>,
    /// That by a parameter of the structure or its load.
    pub by_parameter: f64,
}

impl PeriodicSystem {
    /// Residual and Jacobian at `(x, p)`, as [`linearize`](ParametricSystem::linearize), and `∂R/∂q` (n) by a parameter
    /// q of the structure or its load.
    ///
    /// # Errors
    /// [`HbmError`] where the contact problem has no solution.
    pub fn linearize_over(
        &mut self,
        x: &[f64],
        p: f64,
        change: &StructureChange,
        out: &mut Linearization,
    ) -> Result<Vec<f64>, HbmError> {
        self.response.take_any_phase();
        self.linearize(x, p, out)?;
        Ok(self.parameter(x, p, change)?.column)
    }

    /// The smallest gap of a contact that is open over the whole period, with its derivatives; none where it closes.
    ///
    /// # Errors
    /// [`HbmError`] where the contact problem has no solution.
    pub fn opening(
        &mut self,
        contact: usize,
        (x, p): (&[f64], f64),
        change: &StructureChange,
    ) -> Result<Option<Opening>, HbmError> {
        self.response.take_any_phase();
        let at = self.solve(x, p)?;
        let parameter = self.parameter(x, p, change)?;
        let Some(closest) = self.operator.closest(contact) else { return Ok(None) };
        let guard = |set: usize, dy: &dyn Fn(usize) -> f64| -> f64 {
            self.operator.sets.get(set).guard_row(contact).map(|(j, g)| g * dy(j)).sum()
        };
        let (unit, d, basis) = (self.unit(), self.response.n_coordinates(), self.basis(0, closest.phase));
        let (width, c) = (basis.len(), self.structure.n_contacts());
        let mut by = vec![0.0; self.dim() + 1];
        for (k, by) in by[..d * width].iter_mut().enumerate() {
            let moved = |contact: usize| self.gap_map[contact * d + k / width] * unit * basis[k % width];
            *by = closest.change(|set| guard(set, &moved));
        }
        let moved = self.load_gaps(at);
        for (by_scalar, slope) in moved[..3].iter().zip(self.scalar_columns(p)) {
            let Some((column, slope)) = slope.filter(|_| !by_scalar.is_empty()) else { continue };
            let there = self.at_instant(by_scalar, closest.phase);
            by[column] += slope * closest.change(|set| guard(set, &|j| there[j]));
        }
        let own = self.at_instant(&parameter.gaps, closest.phase);
        let a = self.structure.compliance().a();
        let opened = |set: usize| {
            let all = self.forces_at(set, closest.phase);
            let set = self.operator.sets.get(set);
            let yields = |j: usize| set.active.iter().map(|&l| change.compliance()[(j, l)] * all[l]).sum::<f64>();
            let dy: Vec<f64> = (0..c).map(|j| own[j] + yields(j)).collect();
            let pressed = |j: usize| a[(contact, j)] * set.force(j, &dy) + change.compliance()[(contact, j)] * all[j];
            own[contact] + (0..c).map(pressed).sum::<f64>()
        };
        Ok(Some(Opening { value: -closest.value, by, by_parameter: closest.change(opened) }))
    }

    /// `∂R/∂p` of the motion that was evaluated last: the derivative by the level of the same equations under a load
    /// that stands for the parameter.
    fn parameter(&mut self, x: &[f64], p: f64, change: &StructureChange) -> Result<Parameter, HbmError> {
        let at = self.operating_point(x, p);
        let harmonics = 0..self.blocks.len();
        let motion: Vec<_> = harmonics.map(|n| (self.modal_coordinates(n, at), self.forces_of_harmonic(n))).collect();
        let plain = self.load.clone();
        self.load = plain.varied_by(change.as_load((&self.structure, &plain), at, &motion));
        let found = self.parameter_under_load(x, p, change);
        self.load = plain;
        found
    }

    fn parameter_under_load(&mut self, x: &[f64], p: f64, change: &StructureChange) -> Result<Parameter, HbmError> {
        let at = self.solve(x, p)?;
        let (size, unit, series) = (self.n_coefficients(), self.unit(), self.series());
        let [by_omega, by_xi, gaps, _] = self.load_gaps(at);
        let yielded = self.operator.forces_by_compliance(change.compliance(), &self.y);
        let forces: Vec<f64> = self.operator.apply(&gaps).iter().zip(&yielded).map(|(a, b)| a + b).collect();
        let forces_by = [self.operator.apply(&by_omega), self.operator.apply(&by_xi), forces];
        let mut generalised = self.generalised(&forces_by[2]);
        generalised.resize(self.n_coefficients(), 0.0);
        let laws = change.laws.iter().enumerate();
        self.varied_reactions = laws.flat_map(|(l, law)| self.laws.changed(l, |v, rate| law.force(v, rate))).collect();
        let first = self.response.first_law() * series.width();
        add_to(&mut generalised[first..], &self.varied_reactions);
        let mut columns = Mat::zeros(self.dim(), 1);
        for n in 0..self.blocks.len() {
            let force = complex_harmonic(series, &generalised, n);
            self.assembly.scalar_column(n, &self.blocks[n], 2, &force, 1.0 / unit, 0, &mut columns);
        }
        let mut column: Vec<f64> = columns.col(0).iter().copied().collect();
        let own = |motion: &Motion| -> Result<Vec<Functional>, HbmError> {
            let mut all = Vec::new();
            for equation in &self.closing.equations {
                let mut weights = StructureWeights::none(&self.structure, &self.load);
                equation.weigh_structure(motion, 1.0, &mut weights);
                weights.fold();
                all.push(Functional { by: [0.0, 0.0, weights.along(change)], ..equation.evaluate(motion)? });
            }
            Ok(all)
        };
        for (k, functional) in self.with_motion(x, at, p, own)?.iter().enumerate() {
            column[size + k] = self.gradient(functional, at, &forces_by).1[2];
        }
        self.varied_reactions.clear();
        Ok(Parameter { column, gaps })
    }
}

fn add_to(to: &mut [f64], from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
}
