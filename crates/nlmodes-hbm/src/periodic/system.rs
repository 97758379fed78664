use std::sync::Arc;

use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Boundary, Linearization, ParametricSystem};
use num_complex::Complex64;

use super::analyses::Coordinates;
use super::block::{Asked, HarmonicBlock, LinearResponse};
use super::closing_equations::{Functional, Motion};
use super::law::LawOperator;
use super::load::Load;
use super::operating_point::{Closing, Column, OperatingPoint};
use super::rows::{Assembly, add_weights, complex_harmonic, write_harmonic};
use super::structure::ModalStructure;
use crate::trigonometric::inner;
use crate::{ContactOperator, Grazing, HbmError, RealSeries, Switching, Symmetry};

/// Most harmonics that are accepted.
pub const MAX_HARMONICS: usize = 4096;

/// What numbers near one mean: lengths, frequencies and energies of the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Scales {
    /// Length, m: amplitude of the contact at grazing.
    pub length: f64,
    /// Angular frequency, rad/s: that of the linear mode.
    pub omega: f64,
    /// Averaged kinetic energy, J: that at grazing.
    pub energy: f64,
}

impl Scales {
    /// From a length (m), an angular frequency (rad/s) and an energy (J).
    pub fn new(length: f64, omega: f64, energy: f64) -> Self {
        Self { length, omega, energy }
    }
}

/// What distinguishes one periodic problem from another on the same structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PeriodicSettings {
    /// Highest harmonic `N_h`.
    pub harmonics: usize,
    /// How the instants of contact are treated.
    pub switching: Switching,
    /// Unknowns of the linear structure.
    pub coordinates: Coordinates,
}

impl Default for PeriodicSettings {
    fn default() -> Self {
        Self { harmonics: 10, switching: Switching::Exact, coordinates: Coordinates::Automatic }
    }
}

/// A periodic motion of a structure with one-sided contacts as a system for continuation: linear response, contact
/// operator, closing equations.
///
/// ```text
/// L_n x_n − G_n Pᵀ λ_n − load_n = 0 ,   n = 0 … N_h       the linear structure, harmonic by harmonic
/// λ_n = 𝓕_n(λ(y(τ))) ,   y = g₀ + P x + a                 the contact operator
/// closing equations                                     energy, phase, …, one for each unknown behind the coefficients
/// ```
///
/// `x` are the motions of the contacts (`P = I`) or modal coordinates (`P = Y`), [`Coordinates`]. Unknown vector:
/// coefficients of the coordinates in their unit, one coordinate after the other ([`RealSeries`]), then the unknowns of
/// the [`Closing`].
pub struct PeriodicSystem {
    pub(crate) structure: Arc<ModalStructure>,
    pub(crate) response: Box<dyn LinearResponse + Send>,
    pub(crate) operator: ContactOperator,
    pub(crate) load: Load,
    pub(crate) closing: Closing,
    pub(crate) scales: Scales,
    settings: PeriodicSettings,
    /// `P`, c × d, row-major.
    pub(super) gap_map: Vec<f64>,
    /// `Pᵀ S P` of each closed set that has been met, d × d.
    maps: Vec<Option<Vec<f64>>>,
    pub(crate) y: Vec<f64>,
    pub(crate) forces: Vec<f64>,
    /// The laws beside the stops, their reactions on the structure, N, and the derivatives of these with respect to ω.
    pub(super) laws: LawOperator,
    pub(super) reactions: [Vec<f64>; 2],
    /// What a parameter does to the reactions where the motion stays; else empty.
    pub(super) varied_reactions: Vec<f64>,
    pub(crate) blocks: Vec<HarmonicBlock>,
    pub(super) assembly: Assembly,
}

impl PeriodicSystem {
    pub(crate) fn assemble(
        structure: Arc<ModalStructure>,
        load: Load,
        closing: Closing,
        (settings, symmetry): (PeriodicSettings, Symmetry),
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let response = settings.coordinates.response(&structure, symmetry == Symmetry::Even);
        Self::assemble_with(response, structure, load, closing, (settings, symmetry), scales, solver)
    }

    /// As [`assemble`](Self::assemble), with a linear structure of its own, of which `structure` has contacts and laws.
    pub(crate) fn assemble_with(
        response: Box<dyn LinearResponse + Send>,
        structure: Arc<ModalStructure>,
        load: Load,
        closing: Closing,
        (settings, symmetry): (PeriodicSettings, Symmetry),
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let harmonics = settings.harmonics;
        if harmonics == 0 || harmonics > MAX_HARMONICS {
            return Err(HbmError::Harmonics { found: harmonics, most: MAX_HARMONICS });
        }
        if load.highest_harmonic() > harmonics {
            return Err(HbmError::LoadBeyond { load: load.highest_harmonic(), harmonics });
        }
        let series = RealSeries { symmetry, n_harmonics: harmonics };
        let (c, d) = (structure.n_contacts(), response.n_coordinates());
        let gap_map = (0..c).flat_map(|i| (0..d).map(move |j| (i, j))).map(|(i, j)| response.gap_row(i, j)).collect();
        if !(structure.laws().is_empty() || structure.damping().is_diagonal()) {
            return Err(HbmError::LawsBesideCoupledModes);
        }
        Ok(Self {
            operator: ContactOperator::new(structure.compliance(), series, settings.switching, solver)?,
            laws: LawOperator::new(structure.laws(), series, structure.law_samples)?,
            reactions: Default::default(),
            varied_reactions: Vec::new(),
            gap_map,
            maps: Vec::new(),
            y: vec![0.0; c * series.width()],
            forces: Vec::new(),
            blocks: vec![HarmonicBlock::default(); harmonics + 1],
            assembly: Assembly::new(d, series),
            structure,
            response,
            load,
            closing,
            scales,
            settings,
        })
    }

    /// The same problem with another number of harmonics, and with as many samples a period for each of them.
    ///
    /// # Errors
    /// As its own constructor.
    pub fn with_harmonics(&self, harmonics: usize, solver: &dyn LcpSolver) -> Result<Self, HbmError> {
        let own = self.settings;
        let switching = match own.switching {
            Switching::Exact => Switching::Exact,
            Switching::Sampled { samples } => {
                Switching::Sampled { samples: (samples * harmonics).div_ceil(own.harmonics) }
            }
        };
        let settings = PeriodicSettings { harmonics, switching, ..own };
        let parts = (self.structure.clone(), self.load.clone(), self.closing.anew());
        Self::assemble(parts.0, parts.1, parts.2, (settings, self.series().symmetry), self.scales, solver)
    }

    /// The structure.
    pub fn structure(&self) -> &ModalStructure {
        &self.structure
    }

    /// The settings.
    pub fn settings(&self) -> PeriodicSettings {
        self.settings
    }

    /// The load.
    pub fn load(&self) -> &Load {
        &self.load
    }

    /// Layout of the coefficients of one coordinate.
    pub fn series(&self) -> RealSeries {
        self.operator.series()
    }

    /// Number of coefficients, which are the first unknowns.
    pub fn n_coefficients(&self) -> usize {
        self.assembly.size()
    }

    /// What makes it square.
    pub fn closing(&self) -> &Closing {
        &self.closing
    }

    /// The scales of the unknowns.
    pub fn scales(&self) -> Scales {
        self.scales
    }

    /// Angular frequency at the unknowns `x` of a mode, rad/s.
    pub fn omega(&self, x: &[f64]) -> f64 {
        self.operating_point(x, 0.0).omega
    }

    /// Unknowns at the begin of the branch of a mode, where its parameter is zero, and the direction of growing
    /// amplitude.
    pub fn start(&self, grazing: &Grazing) -> (Vec<f64>, Vec<f64>) {
        (grazing.unknowns(self), grazing.direction(self))
    }

    /// Frequency, negative damping and level of the unknowns `x` at the parameter `p`.
    pub fn operating_point(&self, x: &[f64], p: f64) -> OperatingPoint {
        self.closing.at(&x[self.n_coefficients()..], p)
    }

    /// Unit of the coefficients.
    pub fn unit(&self) -> f64 {
        self.response.scale(self.scales.length)
    }

    /// The coefficients of a structure that rests where its modal coordinates are these, m, m √kg, and its contacts
    /// have these forces, c, N.
    pub fn coefficients_at_rest(&self, eta: &[f64], forces: &[f64]) -> Vec<f64> {
        let (width, unit) = (self.series().width(), self.unit());
        let mut x = vec![0.0; self.n_coefficients()];
        for (k, eta) in eta.iter().enumerate().filter(|(_, eta)| **eta != 0.0) {
            let shares = self.response.of_mode(k).into_iter().enumerate();
            shares.for_each(|(j, share)| x[j * width] += share * eta / unit);
        }
        for (l, law) in self.structure.laws().iter().enumerate() {
            let moved: f64 = law.contacts.iter().zip(forces).map(|(h, force)| h * force).sum();
            x[(self.response.first_law() + l) * width] += moved / unit;
        }
        x
    }

    /// Holds the phase of these unknowns from now on, where the phase is free.
    pub fn hold_phase(&mut self, x: &[f64]) {
        let (size, series) = (self.n_coefficients(), self.series());
        self.closing.equations.iter_mut().for_each(|e| e.accepted(&x[..size], series));
    }

    /// An unknown vector of a problem on the same structure with another number of harmonics as one of this problem.
    ///
    /// # Panics
    /// If `x` is shorter than the coefficients of `from`.
    pub fn resized(&self, x: &[f64], from: RealSeries) -> Vec<f64> {
        let (d, old) = (self.response.n_coordinates(), from.width());
        let coefficients = (0..d).flat_map(|k| from.resized(&x[k * old..(k + 1) * old], self.series()));
        coefficients.chain(x[d * old..].iter().copied()).collect()
    }

    /// Contact pattern, forces and the linear structure at the unknowns `x` and the parameter `p`.
    pub(crate) fn solve(&mut self, x: &[f64], p: f64) -> Result<OperatingPoint, HbmError> {
        let at = self.operating_point(x, p);
        if !(at.omega.is_finite() && at.omega > 0.0 && at.xi.is_finite() && at.level.is_finite()) {
            return Err(HbmError::OperatingPoint { omega: at.omega, xi: at.xi, level: at.level });
        }
        let series = self.series();
        let moved = self.load_gaps(at);
        self.form_gaps(x, &moved[3]);
        if self.operator.forget_sets(self.maps.iter().flatten().map(|map| map.len() * size_of::<f64>()).sum()) {
            self.maps.clear();
        }
        self.operator.solve(&self.y)?;
        self.forces = self.operator.apply(&self.y);
        let mut generalised = self.generalised(&self.forces);
        let unit = self.unit();
        let coefficients: Vec<f64> = x[..self.n_coefficients()].iter().map(|x| x * unit).collect();
        let first = self.response.first_law() * series.width();
        self.reactions = self.laws.solve(&coefficients[first..], at.omega);
        self.add_reactions(0, &mut generalised);
        let mut asked = Asked {
            energy: self.closing.equations.iter().any(|equation| equation.asks_for_energy()),
            by: self.closing.sources().map(|source| source.slope(p).is_some()),
        };
        asked.by[2] |= self.load.is_varied();
        for n in 0..=series.n_harmonics {
            let block = &mut self.blocks[n];
            for (to, from) in [(&mut block.x, &coefficients), (&mut block.force, &generalised)] {
                write_harmonic(series, from, n, to);
            }
            self.response.evaluate(n, at, &self.load, asked, block);
        }
        Ok(at)
    }

    /// Modal coordinates of harmonic `n` of the motion solved last.
    pub(crate) fn modal_coordinates(&self, n: usize, at: OperatingPoint) -> Vec<Complex64> {
        self.response.modal_motion(n, at, &self.load, &self.blocks[n], false).eta
    }

    /// Gaps without contact forces of the coefficients `x`; `moved` is what the load [adds](Self::load_gaps).
    pub(super) fn form_gaps(&mut self, x: &[f64], moved: &[f64]) {
        let mut gaps = std::mem::take(&mut self.y);
        match moved.len() == gaps.len() {
            true => gaps.copy_from_slice(moved),
            false => gaps.fill(0.0),
        }
        self.add_displacements(x, &mut gaps);
        let width = self.series().width();
        gaps.chunks_mut(width).zip(self.structure.gaps()).for_each(|(y, gap)| y[0] += gap);
        self.y = gaps;
    }

    /// Adds `P x` of the coefficients `x` to gaps, c × width, m.
    pub(super) fn add_displacements(&self, x: &[f64], gaps: &mut [f64]) {
        let (unit, d, width) = (self.unit(), self.response.n_coordinates(), self.series().width());
        for (i, gap) in gaps.chunks_mut(width).enumerate() {
            for j in (0..d).filter(|j| self.gap_map[i * d + j] != 0.0) {
                let factor = self.gap_map[i * d + j] * unit;
                gap.iter_mut().zip(&x[j * width..]).for_each(|(y, x)| *y += factor * x);
            }
        }
    }

    /// What the load adds to the gaps (c × width): derivatives with respect to ω, ξ and the level, and, last, the
    /// value; empty where it moves none.
    pub(super) fn load_gaps(&self, at: OperatingPoint) -> [Vec<f64>; 4] {
        let (series, c) = (self.series(), self.structure.n_contacts());
        if !self.load.moves_gaps() {
            return Default::default();
        }
        let mut moved = [0, 1, 2, 3].map(|_| vec![0.0; c * series.width()]);
        for n in 0..=series.n_harmonics {
            for i in 0..c {
                let gap = self.load.gap(n, i, at);
                for (to, z) in moved.iter_mut().zip([gap.by[0], gap.by[1], gap.by[2], gap.value]) {
                    series.put(z, n, &mut to[i * series.width()..(i + 1) * series.width()]);
                }
            }
        }
        moved
    }

    /// `Pᵀ λ`, d × width, from λ (c × width); of nothing nothing.
    pub(super) fn generalised(&self, forces: &[f64]) -> Vec<f64> {
        let (d, width) = (self.response.n_coordinates(), self.series().width());
        let mut out = vec![0.0; if forces.is_empty() { 0 } else { d * width }];
        for (i, force) in forces.chunks(width).enumerate() {
            for (j, out) in out.chunks_mut(width).enumerate().filter(|(j, _)| self.gap_map[i * d + j] != 0.0) {
                let factor = self.gap_map[i * d + j];
                out.iter_mut().zip(force).for_each(|(out, f)| *out += factor * f);
            }
        }
        out
    }

    /// Contact forces of harmonic `n`, and the reactions of laws behind them.
    pub(crate) fn forces_of_harmonic(&self, n: usize) -> Vec<Complex64> {
        let of = |real: &[f64]| complex_harmonic(self.series(), real, n);
        let mut forces = of(&self.forces);
        forces.resize(self.structure.n_contacts(), Complex64::default());
        forces.extend(of(&self.reactions[0]));
        forces
    }

    /// Adds the reactions of laws, or their derivatives, to generalised forces (d × width).
    fn add_reactions(&self, which: usize, generalised: &mut Vec<f64>) {
        if self.laws.len() == 0 {
            return;
        }
        generalised.resize(self.n_coefficients(), 0.0);
        let first = self.response.first_law() * self.series().width();
        generalised[first..].iter_mut().zip(&self.reactions[which]).for_each(|(to, from)| *to += from);
    }

    /// `Pᵀ (dλ/dy) P` over a period with the derivatives of laws, kept in the assembly.
    fn differentiate_forces(&mut self) {
        let d = self.response.n_coordinates();
        self.maps.resize(self.operator.sets.len(), None);
        self.assembly.clear_forces();
        for spectrum in &self.operator.spectra {
            let map = self.maps[spectrum.set].get_or_insert_with(|| {
                let (set, p) = (self.operator.sets.get(spectrum.set), &self.gap_map);
                let mut map = vec![0.0; d * d];
                for &i in &set.active {
                    // Row i of S P.
                    let mut pressed = vec![0.0; d];
                    for (j, s) in set.force_row(i) {
                        pressed.iter_mut().zip(&p[j * d..(j + 1) * d]).for_each(|(to, p)| *to += s * p);
                    }
                    for (k, row) in map.chunks_mut(d).enumerate().filter(|(k, _)| p[i * d + k] != 0.0) {
                        row.iter_mut().zip(&pressed).for_each(|(m, pressed)| *m += p[i * d + k] * pressed);
                    }
                }
                map
            });
            self.assembly.add_forces(map, spectrum.product(self.operator.series));
        }
        let first = self.response.first_law();
        for l in 0..self.laws.len() {
            let mut map = vec![0.0; d * d];
            map[(first + l) * (d + 1)] = 1.0;
            self.assembly.add_forces(&map, &self.laws.derivative(l));
        }
    }
}

impl PeriodicSystem {
    /// Columns of ω, ξ and the level in the Jacobian, with the slope of each; none of what is given.
    pub(super) fn scalar_columns(&self, p: f64) -> [Option<(usize, f64)>; 3] {
        let (size, dim) = (self.n_coefficients(), self.dim());
        let column = |column: Column| match column {
            Column::Unknown(index) => size + index,
            Column::Parameter => dim,
        };
        self.closing.sources().map(|source| source.slope(p).map(|(c, slope)| (column(c), slope)))
    }

    /// The motion solved last as closing equations see it.
    pub(super) fn with_motion<T>(&self, x: &[f64], at: OperatingPoint, p: f64, look: impl FnOnce(&Motion) -> T) -> T {
        look(&Motion {
            at,
            p,
            x: &x[..self.n_coefficients()],
            eta: &|n| self.modal_coordinates(n, at),
            kinetic_energy: self.blocks.iter().map(|block| block.kinetic.value).sum(),
            forces: &|n| self.forces_of_harmonic(n),
            load: &self.load,
        })
    }

    /// Derivatives of a closing equation through the motion: with respect to the coefficients, and to ω, ξ and the
    /// level; `forces_by` are those of the forces with respect to the latter through the gaps.
    pub(super) fn gradient(
        &mut self,
        functional: &Functional,
        at: OperatingPoint,
        forces_by: &[Vec<f64>; 3],
    ) -> (Vec<f64>, [f64; 3]) {
        let (series, d) = (self.series(), self.response.n_coordinates());
        let width = series.width();
        let (mut by_x, mut by_generalised) = (vec![0.0; d * width], vec![0.0; d * width]);
        let (mut by_force, mut by) = (vec![0.0; self.forces.len()], functional.by);
        for (n, weights) in &functional.eta {
            let (x, force) = self.response.pull(*n, at, &self.blocks[*n], weights);
            add_weights(series, *n, &x, 1.0, &mut by_x);
            add_weights(series, *n, &force, 1.0, &mut by_generalised);
            let motion = self.response.modal_motion(*n, at, &self.load, &self.blocks[*n], true);
            for (by, d_eta) in by.iter_mut().zip(&motion.d_eta) {
                *by += weights.iter().zip(d_eta).map(|(w, d)| (w * d).re).sum::<f64>();
            }
        }
        for (n, block) in self.blocks.iter().enumerate().filter(|_| functional.by_energy != 0.0) {
            add_weights(series, n, &block.kinetic.by_x, functional.by_energy, &mut by_x);
            add_weights(series, n, &block.kinetic.by_force, functional.by_energy, &mut by_generalised);
            by.iter_mut().zip(block.kinetic.by).for_each(|(by, of)| *by += functional.by_energy * of);
        }
        let (c, first) = (self.structure.n_contacts(), self.response.first_law() * width);
        for (n, weights) in &functional.forces {
            let (of_contacts, of_laws) = weights.split_at(c.min(weights.len()));
            add_weights(series, *n, of_contacts, 1.0, &mut by_force);
            add_weights(series, *n, of_laws, 1.0, &mut by_generalised[first..]);
        }
        for (i, by_force) in by_force.chunks_mut(width).enumerate() {
            for (j, from) in by_generalised.chunks(width).enumerate().filter(|(j, _)| self.gap_map[i * d + j] != 0.0) {
                let factor = self.gap_map[i * d + j];
                by_force.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
            }
        }
        by.iter_mut().zip(forces_by).for_each(|(by, change)| *by += inner(&by_force, change));
        let by_gap = self.operator.apply_transposed(&by_force);
        by_x.iter_mut().zip(self.generalised(&by_gap)).for_each(|(to, from)| *to += from);
        by[0] += inner(&by_generalised[first..], &self.reactions[1]);
        by[2] += inner(&by_generalised[first..], &self.varied_reactions);
        for l in 0..self.laws.len() {
            let (at, derivative) = (first + l * width, self.laws.derivative(l));
            for (weight, row) in by_generalised[at..at + width].iter().zip(derivative.chunks(width)) {
                by_x[at..at + width].iter_mut().zip(row).for_each(|(to, entry)| *to += weight * entry);
            }
        }
        (by_x, by)
    }
}

impl ParametricSystem for PeriodicSystem {
    type Error = HbmError;

    fn dim(&self) -> usize {
        self.n_coefficients() + self.closing.n_unknowns()
    }

    fn scaling(&self) -> Option<nlmodes_continuation::Scaling> {
        Some(nlmodes_continuation::Scaling::unit(self.dim()))
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), HbmError> {
        let (size, series) = (self.n_coefficients(), self.series());
        self.closing.equations.iter_mut().for_each(|e| e.approached(&x[..size], series));
        let at = self.solve(x, p)?;
        self.differentiate_forces();
        let (dim, unit) = (self.dim(), self.unit());
        // The columns behind those of the coefficients, of which not every entry is written below.
        (size..=dim).for_each(|j| out.jacobian.col_mut(j).fill(0.0));
        let slopes = self.scalar_columns(p);
        let moved = self.load_gaps(at);
        let forces_by = [0, 1, 2].map(|t| self.operator.apply(&moved[t]));
        let mut generalised_by = [0, 1, 2].map(|t| self.generalised(&forces_by[t]));
        self.add_reactions(1, &mut generalised_by[0]);
        for n in 0..self.blocks.len() {
            self.assembly.rows_of(n, &self.blocks[n], unit, out);
            for (t, slope) in slopes.iter().enumerate() {
                let Some((column, slope)) = slope else { continue };
                let force = complex_harmonic(series, &generalised_by[t], n);
                self.assembly.scalar_column(n, &self.blocks[n], t, &force, slope / unit, *column, &mut out.jacobian);
            }
        }
        let evaluate = |motion: &Motion| -> Result<Vec<Functional>, HbmError> {
            self.closing.equations.iter().map(|equation| equation.evaluate(motion)).collect()
        };
        let functionals = self.with_motion(x, at, p, evaluate)?;
        for (k, functional) in functionals.iter().enumerate() {
            out.residual[size + k] = functional.value;
            let (entries, by) = self.gradient(functional, at, &forces_by);
            for (j, entry) in entries.iter().enumerate() {
                out.jacobian[(size + k, j)] = entry * unit + functional.x.get(j).copied().unwrap_or(0.0);
            }
            for (by, slope) in by.iter().zip(&slopes) {
                if let Some((column, slope)) = slope {
                    out.jacobian[(size + k, *column)] += by * slope;
                }
            }
            out.jacobian[(size + k, dim)] += functional.by_parameter;
        }
        self.assembly.write(&mut out.jacobian);
        Ok(())
    }

    fn pattern(&self) -> u64 {
        self.operator.pattern()
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        self.piece_at(z)
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        self.boundary_between(from, to)
    }

    fn accepted(&mut self, x: &[f64], _p: f64) {
        self.hold_phase(x);
    }
}
