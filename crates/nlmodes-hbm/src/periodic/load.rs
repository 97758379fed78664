use std::sync::Arc;

use num_complex::Complex64;

use super::operating_point::OperatingPoint;
use super::structure::ModalStructure;
use crate::HbmError;
use crate::error::agrees;

/// One harmonic of a periodic load, for a unit level: `Re(amplitude ω^power e^{inωt})`.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadTerm {
    /// Harmonic `n` of the base frequency ω of the motion.
    pub harmonic: usize,
    /// Power of ω by which the load grows: 0 for a force, 2 for a base that moves by a given amplitude, −2 for the
    /// displacement that belongs to a given acceleration.
    pub omega_power: i32,
    /// `Φᵀ f`, m, N/√kg.
    pub modal: Vec<Complex64>,
    /// What it adds to the gaps, and to the displacements of laws behind them, by itself, m: residual flexibility of a
    /// force, motion of a base past a fixed stop.
    pub gaps: Vec<Complex64>,
}

/// A periodic load: terms that a level multiplies, beside the steady force of the structure.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Load {
    terms: Vec<LoadTerm>,
    /// On each mode, N/√kg; empty for none.
    steady: Vec<f64>,
    /// Level of the terms and what opens the gaps, m, c, where the level of the motion is that of the opening.
    opening: Option<(f64, Vec<f64>)>,
    /// What a parameter of the structure does to each harmonic, where derivatives by the level represent those by it.
    varied: Option<Arc<Vec<VariedHarmonic>>>,
}

/// A parameter of a structure as a load of one harmonic: what it does to the modes (m, N/√kg) and to the gaps (c, m).
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct VariedHarmonic {
    pub modal: Vec<Complex64>,
    pub gaps: Vec<Complex64>,
}

/// A value with its derivatives with respect to ω, ξ and the level.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Varied {
    pub value: Complex64,
    pub by: [Complex64; 3],
}

impl Load {
    /// The terms of a load of `structure`.
    ///
    /// # Errors
    /// [`HbmError::Size`] or [`HbmError::NotFinite`].
    pub fn new(structure: &ModalStructure, terms: Vec<LoadTerm>) -> Result<Self, HbmError> {
        for term in &terms {
            agrees("modes of a load", structure.n_modes(), term.modal.len())?;
            agrees("contacts and laws of a load", structure.n_places(), term.gaps.len())?;
            if !term.modal.iter().chain(&term.gaps).all(|v| v.is_finite()) {
                return Err(HbmError::NotFinite { what: "a load" });
            }
        }
        Ok(Self { terms, steady: structure.steady_force().to_vec(), opening: None, varied: None })
    }

    /// No terms, and the steady force of `structure`.
    pub(crate) fn none(structure: &ModalStructure) -> Self {
        Self { terms: Vec::new(), steady: structure.steady_force().to_vec(), opening: None, varied: None }
    }

    /// The same load at a fixed level beside gaps that are opened by so much (c, m) times the level of the motion: with
    /// that as the parameter, gaps are closed while the load acts.
    ///
    /// # Errors
    /// [`HbmError::NotFinite`].
    pub(crate) fn beside_opening(mut self, level: f64, opening: Vec<f64>) -> Result<Self, HbmError> {
        if !opening.iter().chain([&level]).all(|v| v.is_finite()) {
            return Err(HbmError::NotFinite { what: "an opening of the gaps" });
        }
        self.opening = Some((level, opening));
        Ok(self)
    }

    /// The same load, of which derivatives by the level are those by a parameter of the structure.
    pub(crate) fn varied_by(&self, harmonics: Vec<VariedHarmonic>) -> Self {
        Self { varied: Some(Arc::new(harmonics)), ..self.clone() }
    }

    /// Whether derivatives by the level are those by a parameter of the structure.
    pub(crate) fn is_varied(&self) -> bool {
        self.varied.is_some()
    }

    /// The terms.
    pub fn terms(&self) -> &[LoadTerm] {
        &self.terms
    }

    /// Highest harmonic, zero for no load.
    pub fn highest_harmonic(&self) -> usize {
        self.terms.iter().map(|t| t.harmonic).max().unwrap_or(0)
    }

    /// Whether anything drives harmonic n.
    pub(crate) fn has_harmonic(&self, n: usize) -> bool {
        self.is_varied() || self.terms.iter().any(|t| t.harmonic == n) || (n == 0 && !self.steady.is_empty())
    }

    /// Modal load of mode k in harmonic n.
    pub(crate) fn modal(&self, n: usize, k: usize, at: OperatingPoint) -> Varied {
        let mut of = self.sum(n, at, |term| term.modal[k]);
        if n == 0 {
            of.value += self.steady.get(k).copied().unwrap_or(0.0);
        }
        self.vary_by(n, |varied| varied.modal[k], &mut of);
        of
    }

    /// What harmonic n adds to gap i, or to the displacement of a law behind the gaps.
    pub(crate) fn gap(&self, n: usize, i: usize, at: OperatingPoint) -> Varied {
        let mut of = self.sum(n, at, |term| term.gaps[i]);
        if let Some(opening) = self.opening.as_ref().filter(|_| n == 0).and_then(|(_, opening)| opening.get(i)) {
            of.value += opening * at.level;
            of.by[2] += opening;
        }
        self.vary_by(n, |varied| varied.gaps.get(i).copied().unwrap_or_default(), &mut of);
        of
    }

    /// Puts the derivative by a parameter of the structure in place of that by the level.
    fn vary_by(&self, n: usize, value: impl Fn(&VariedHarmonic) -> Complex64, of: &mut Varied) {
        if let Some(varied) = &self.varied {
            of.by[2] = varied.get(n).map_or(Complex64::default(), value);
        }
    }

    pub(crate) fn moves_gaps(&self) -> bool {
        self.is_varied()
            || self.opening.is_some()
            || self.terms.iter().any(|t| t.gaps.iter().any(|g| *g != Complex64::default()))
    }

    fn sum(&self, n: usize, at: OperatingPoint, amplitude: impl Fn(&LoadTerm) -> Complex64) -> Varied {
        let terms = self.terms.iter().filter(|t| t.harmonic == n);
        terms.fold(Varied::default(), |sum, term| sum.plus(self.vary(amplitude(term), term.omega_power, at)))
    }

    fn vary(&self, amplitude: Complex64, power: i32, at: OperatingPoint) -> Varied {
        match &self.opening {
            None => vary(amplitude, power, at),
            Some((level, _)) => {
                let mut of = vary(amplitude, power, OperatingPoint { level: *level, ..at });
                of.by[2] = Complex64::default();
                of
            }
        }
    }

    /// What the terms in harmonic n add to a response row.
    pub(crate) fn row(&self, n: usize, amplitudes: &[Complex64], at: OperatingPoint) -> Varied {
        let terms = self.terms.iter().zip(amplitudes).filter(|(t, _)| t.harmonic == n);
        terms.fold(Varied::default(), |sum, (term, a)| sum.plus(self.vary(*a, term.omega_power, at)))
    }
}

fn vary(amplitude: Complex64, power: i32, at: OperatingPoint) -> Varied {
    let per_level = amplitude * at.omega.powi(power);
    let d_omega = per_level * (at.level * f64::from(power) / at.omega);
    Varied { value: per_level * at.level, by: [d_omega, Complex64::default(), per_level] }
}

impl Varied {
    fn plus(self, other: Self) -> Self {
        let by = [0, 1, 2].map(|i| self.by[i] + other.by[i]);
        Self { value: self.value + other.value, by }
    }
}
