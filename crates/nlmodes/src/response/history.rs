//! What the contacts do over one period, instant by instant.

use std::f64::consts::TAU;
use std::sync::Arc;

use nlmodes_contact::{LcpMatrix, LcpWorkspace, solver_by_name};
use nlmodes_hbm::{ForceLaw, HbmError, PeriodicMotion, PlacedLaw, touch_spans};
use nlmodes_linalg::Mat;
use nlmodes_modal::ClosedSpan;
use num_complex::Complex64;

use crate::response::{ResponseError, ResponseModel};

/// The contacts of a motion over a period: which are closed when.
#[derive(Debug)]
pub struct ContactPattern<'a> {
    model: &'a ResponseModel,
    omega: f64,
    /// Gaps without contact forces, harmonic by harmonic of each contact.
    y: Vec<Vec<Complex64>>,
    /// Of each contact whose stop dissipates, the displacement of the stop, harmonic by harmonic.
    stops: Vec<Option<Vec<Complex64>>>,
    /// Stops with a law of force, which are reported after the contacts.
    laws: Vec<LawStop>,
    /// Ends in phase (rad) of the segments with constant closed set, in order from 0 to 2π, and `dλ/dy` there.
    stretches: Vec<([f64; 2], Mat<f64>)>,
}

/// A stop with a law of force, and the displacement toward it, harmonic by harmonic, m.
#[derive(Debug)]
struct LawStop {
    law: Arc<dyn ForceLaw>,
    displacement: Vec<Complex64>,
}

/// Displacement toward its stop from rest (m) with two derivatives by time, and force (N).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Displacement, velocity, acceleration.
    pub motion: [f64; 3],
    /// Contact force, nonnegative to rounding.
    pub force: f64,
}

/// Samples of a period between which closed sets are compared, for each harmonic and at least.
const SAMPLES: usize = 24;
const FEWEST: usize = 512;

/// Halvings that find an instant to rounding.
const HALVINGS: usize = 50;

impl ResponseModel {
    /// When which contacts are closed over a period of the motion; `subharmonic` periods of the load are one of the
    /// motion.
    ///
    /// # Errors
    /// [`ResponseError::Problem`] where a contact problem has no solution.
    pub fn contact_pattern(
        &self,
        motion: &PeriodicMotion,
        subharmonic: usize,
    ) -> Result<ContactPattern<'_>, ResponseError> {
        let matrix = self.structure().compliance();
        let mut workspace = solver_by_name("active-set").and_then(|s| s.workspace(matrix)).map_err(failed)?;
        let y = self.gap_harmonics(motion, subharmonic);
        let structure = self.structure();
        let stop = |i: usize| {
            let j = structure.damped_stop(i)? - structure.n_moving();
            motion.stops.iter().map(|stops| stops.get(j).copied()).collect::<Option<Vec<Complex64>>>()
        };
        let stops = (0..structure.n_contacts()).map(stop).collect();
        let laws = self.law_stops(motion, subharmonic)?;
        let mut pattern = ContactPattern { model: self, omega: motion.at.omega, y, stops, laws, stretches: Vec::new() };
        let samples = (SAMPLES * motion.eta.len()).max(FEWEST);
        let mut begin = 0.0;
        let mut before = pattern.closed(0.0, workspace.as_mut())?;
        for j in 1..=samples {
            let tau = TAU * j as f64 / samples as f64;
            let after = pattern.closed(tau, workspace.as_mut())?;
            if after == before {
                continue;
            }
            let (mut low, mut high) = (TAU * (j - 1) as f64 / samples as f64, tau);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if pattern.closed(middle, workspace.as_mut())? == before { low = middle } else { high = middle }
            }
            pattern.stretches.push(([begin, high], sensitivity(matrix, &before)?));
            (begin, before) = (high, after);
        }
        pattern.stretches.push(([begin, TAU], sensitivity(matrix, &before)?));
        pattern.divide();
        Ok(pattern)
    }

    /// The stops with a law of force in a motion.
    fn law_stops(&self, motion: &PeriodicMotion, subharmonic: usize) -> Result<Vec<LawStop>, ResponseError> {
        let is_stop = |(_, placed): &(usize, &PlacedLaw)| placed.law.stop_gap().is_some();
        let all = self.structure().laws().iter().enumerate().filter(is_stop);
        let (laws, weights): (Vec<_>, Vec<_>) =
            all.filter_map(|(l, placed)| Some((placed.law.clone(), self.law_weights(l)?.clone()))).unzip();
        let rows = self.rows(&weights)?;
        let of = |(law, row)| LawStop { law, displacement: self.displacement(row, motion, subharmonic) };
        Ok(laws.into_iter().zip(&rows).map(of).collect())
    }

    fn gap_harmonics(&self, motion: &PeriodicMotion, subharmonic: usize) -> Vec<Vec<Complex64>> {
        let structure = self.structure();
        let omega = motion.at.omega * subharmonic as f64;
        let gap = |i: usize| {
            let of = |eta: &Vec<Complex64>| eta.iter().enumerate().map(|(k, eta)| eta * structure.rows()[(i, k)]).sum();
            let mut y: Vec<Complex64> = (0..motion.eta.len()).map(|n| of(&motion.coordinates(n))).collect();
            y[0] += structure.gaps()[i];
            for (y, reactions) in y.iter_mut().zip(&motion.reactions) {
                *y += reactions.iter().zip(structure.laws()).map(|(f, law)| f * law.contacts[i]).sum::<Complex64>();
            }
            for term in self.terms() {
                if let Some(y) = y.get_mut(term.harmonic * subharmonic) {
                    *y += term.gaps[i] * (motion.at.level * omega.powi(term.omega_power));
                }
            }
            y
        };
        (0..structure.n_contacts()).map(gap).collect()
    }
}

impl ContactPattern<'_> {
    /// Divides the segments where a stop with a law of force begins or ends to act.
    fn divide(&mut self) {
        let spans = self.laws.iter().flat_map(|stop| touch_spans(stop.law.as_ref(), &stop.displacement, self.omega));
        let mut ends: Vec<f64> = spans.filter(|[a, b]| b - a < TAU).flatten().map(|tau| tau.rem_euclid(TAU)).collect();
        ends.sort_by(f64::total_cmp);
        let mut divided = Vec::with_capacity(self.stretches.len() + ends.len());
        for ([from, to], s) in self.stretches.drain(..) {
            let within = ends.iter().copied().filter(|tau| *tau > from && *tau < to);
            let all: Vec<f64> = [from].into_iter().chain(within).chain([to]).collect();
            divided.extend(all.windows(2).map(|pair| ([pair[0], pair[1]], s.clone())));
        }
        self.stretches = divided;
    }

    /// Ends in phase (rad) of the segments with unchanged closed contacts, in order from 0 to 2π.
    pub fn stretches(&self) -> Vec<[f64; 2]> {
        self.stretches.iter().map(|(ends, _)| *ends).collect()
    }

    /// The contacts at a phase (rad) in a segment, whose formulas also hold at its ends.
    ///
    /// # Panics
    /// If there is no such segment.
    pub fn state(&self, tau: f64, stretch: usize) -> Vec<ContactState> {
        let (structure, s) = (self.model.structure(), &self.stretches[stretch].1);
        let (a, c) = (structure.compliance().a(), structure.n_contacts());
        let y = [0, 1, 2].map(|order| self.values(tau, order));
        let force = y.each_ref().map(|y| (0..c).map(|i| (0..c).map(|j| s[(i, j)] * y[j]).sum()).collect::<Vec<f64>>());
        let of = |i: usize| {
            let own = structure.stop_compliance()[i];
            let yielded = [0, 1, 2].map(|order| self.stop_values(i, tau, order));
            let motion = [0, 1, 2].map(|order| {
                let gap: f64 = y[order][i] + (0..c).map(|j| a[(i, j)] * force[order][j]).sum::<f64>();
                own * force[order][i] + yielded[order] - gap
            });
            ContactState { motion: [structure.gaps()[i] + motion[0], motion[1], motion[2]], force: force[0][i] }
        };
        let of_law = |stop: &LawStop| {
            let motion = [0, 1, 2].map(|order| self.value(&stop.displacement, tau, order));
            ContactState { motion, force: stop.law.at(motion[0], motion[1]).force }
        };
        (0..c).map(of).chain(self.laws.iter().map(of_law)).collect()
    }

    /// The spans of a period in which each contact is closed, with its force: a series for each contact pattern; none
    /// of a stop with a law of force, which has no such series.
    pub fn closed_spans(&self) -> Vec<Vec<ClosedSpan>> {
        let c = self.y.len();
        let force = |s: &Mat<f64>, i: usize| {
            let mut force = vec![Complex64::default(); self.y.first().map_or(0, Vec::len)];
            for (j, y) in self.y.iter().enumerate().filter(|(j, _)| s[(i, *j)] != 0.0) {
                force.iter_mut().zip(y).for_each(|(force, y)| *force += y * s[(i, j)]);
            }
            force
        };
        let is_closed = |s: &Mat<f64>, i: usize| (0..c).any(|j| s[(i, j)] != 0.0);
        let of = |i: usize| {
            let closed = self.stretches.iter().filter(|(_, s)| is_closed(s, i));
            closed.map(|([from, to], s)| ClosedSpan { from: *from, to: *to, force: force(s, i) }).collect()
        };
        (0..c).map(of).chain(self.laws.iter().map(|_| Vec::new())).collect()
    }

    /// Gaps without contact forces at a phase, or their derivatives by time.
    fn values(&self, tau: f64, order: i32) -> Vec<f64> {
        self.y.iter().map(|y| self.value(y, tau, order)).collect()
    }

    /// By how much the stop of a contact has yielded where it dissipates, or its derivatives by time.
    fn stop_values(&self, contact: usize, tau: f64, order: i32) -> f64 {
        self.stops[contact].as_ref().map_or(0.0, |stop| self.value(stop, tau, order))
    }

    fn value(&self, z: &[Complex64], tau: f64, order: i32) -> f64 {
        let one = |(n, z): (usize, &Complex64)| {
            let nu = Complex64::new(0.0, n as f64 * self.omega);
            (nu.powi(order) * z * Complex64::cis(n as f64 * tau)).re
        };
        z.iter().enumerate().map(one).sum()
    }

    fn closed(&self, tau: f64, workspace: &mut dyn LcpWorkspace) -> Result<Vec<bool>, ResponseError> {
        let b = self.values(tau, 0);
        let (mut closed, mut lambda) = (vec![false; b.len()], vec![0.0; b.len()]);
        workspace.solve(&b, &mut closed, &mut lambda).map_err(failed)?;
        Ok(closed)
    }
}

/// `dλ/dy` with these contacts closed.
fn sensitivity(matrix: &LcpMatrix, closed: &[bool]) -> Result<Mat<f64>, ResponseError> {
    if closed.contains(&true) {
        return matrix.sensitivity(closed).map_err(failed);
    }
    Ok(Mat::zeros(closed.len(), closed.len()))
}

fn failed(error: nlmodes_contact::LcpError) -> ResponseError {
    ResponseError::Problem(HbmError::Compliance(error))
}
