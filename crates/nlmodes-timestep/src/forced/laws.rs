//! Springs, dampers and stops with a law of force in motions in time.
//!
//! Their reactions are loads of the exact propagator, over each step the polynomial that fulfils the law at the nodes
//! of Gauss: a collocation method whose linear part is exact (Hochbruck, Ostermann 2005), of order `2 s` with `s`
//! nodes. Rigid and linear stops keep their exact instants beside it, and no damping is added.

mod transition;

use std::fmt::Debug;
use std::sync::{Arc, LazyLock};

use nlmodes_linalg::{DenseLu, Mat, gauss_legendre};

use super::ForcedStructure;
use super::flow::Flow;
use super::input::{DEGREE, Observed};
use super::linear::LinearFlow;
use super::series::{FlowSeries, ORDER, Polynomial, terms_within};
use super::trajectory::Running;
use crate::TimestepError;
use crate::error::{fits, positive};
use crate::first_root::first_negative;

pub(super) use transition::LawTransitions;

/// A force `F(v, v̇)` that resists the displacement `v` of a place.
pub trait TimeLaw: Send + Sync + Debug {
    /// Force (N) and its derivatives by displacement (N/m) and velocity (N s/m).
    fn at(&self, v: f64, rate: f64) -> [f64; 3];

    /// Clearance of a law that is a stop, m: it pushes, and not before `v` is greater. `None` of any other law.
    fn stop_gap(&self) -> Option<f64> {
        None
    }
}

/// How motions with laws are integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawSettings {
    /// Largest change of the state by what a law is short of its force at the ends of a step, over the largest state so
    /// far. What the steps leave over is less, for their order is higher. Default 1e-9.
    pub tolerance: f64,
    /// Length of all steps in place of that, s; steps end at contact instants all the same. Default none.
    pub step: Option<f64>,
}

impl Default for LawSettings {
    fn default() -> Self {
        Self { tolerance: 1e-9, step: None }
    }
}

/// A law at its place.
#[derive(Debug, Clone)]
pub(super) struct LawAt {
    pub law: Arc<dyn TimeLaw>,
    /// Its reaction among the inputs.
    pub input: usize,
    /// The displacement that it resists.
    pub place: Observed,
}

/// A law along a step: the displacement of its place, and the rate that it feels where that is not the slope.
#[derive(Debug)]
pub(super) struct LawSeries {
    pub place: FlowSeries,
    rate: Option<FlowSeries>,
    /// What unit reactions at the nodes move, at the nodes and both ends of a step of length h: coefficients of the
    /// powers of h over the longest step, of the displacement and of h times the rate.
    by_reactions: Vec<Vec<[f64; 2]>>,
}

impl LawSeries {
    /// Displacement and rate at the nodes and both ends of a step of length `h`, of what `of` takes.
    fn values(&self, of: impl Fn(&FlowSeries) -> Polynomial, flow: &Flow, h: f64) -> Vec<[f64; 2]> {
        let (place, rate) = (of(&self.place), self.rate.as_ref().map(of));
        let terms = terms_within(h / flow.step);
        let at = |tau: &f64| {
            let tau = tau * h / flow.step;
            let [value, slope] = place.up_to(terms, tau);
            [value, rate.map_or(slope / flow.step, |rate| rate.up_to(terms, tau)[0])]
        };
        NODES.iter().chain(&[0.0, 1.0]).map(at).collect()
    }

    /// Displacement and rate at the nodes and both ends of a step of length `h` by unit reactions at the nodes of all
    /// laws.
    fn moved(&self, flow: &Flow, h: f64, reactions: usize) -> Vec<Vec<[f64; 2]>> {
        let x = h / flow.step;
        let mut sums = vec![[0.0; 2]; (S + 2) * reactions];
        for row in self.by_reactions[..=terms_within(x)].iter().rev() {
            sums.iter_mut().zip(row).for_each(|(sum, c)| *sum = [sum[0] * x + c[0], sum[1] * x + c[1]]);
        }
        sums.iter_mut().for_each(|[_, rate]| *rate /= h);
        sums.chunks(reactions).map(<[_]>::to_vec).collect()
    }
}

impl ForcedStructure {
    /// A law along a step of this flow, from the row of its place.
    pub(super) fn law_series(&self, law: usize, place: &[f64], flow: &LinearFlow) -> LawSeries {
        // The force of a stop bends as it closes: by what it moves beyond the modes a damper would jump there.
        let beside_stops = self.n_contacts() > 0 || self.law_stops().any(|(other, _)| other != law);
        let rate = beside_stops.then(|| {
            let (m, mut row) = (self.n_modes(), vec![0.0; place.len()]);
            let modes = self.laws[law].place.modes.iter();
            row[m..2 * m].iter_mut().zip(modes).for_each(|(row, mode)| *row = self.rate() * mode);
            flow.along(&row)
        });
        let place = flow.along(place);
        let by_reactions = self.by_reactions((&place, rate.as_ref()), flow.step);
        LawSeries { place, rate, by_reactions }
    }

    /// [`LawSeries::by_reactions`]: a reaction is a polynomial along the step, whose coefficient of `t^k` moves a place
    /// with powers of the time from k on.
    fn by_reactions(&self, (place, rate): (&FlowSeries, Option<&FlowSeries>), step: f64) -> Vec<Vec<[f64; 2]>> {
        let (all, monomials) = (self.laws.len() * S, Monomials::new());
        let mut by = vec![vec![[0.0; 2]; (S + 2) * all]; ORDER + 1];
        let powers = self.laws.iter().enumerate().flat_map(|(l, at)| (0..S).map(move |k| (l, k, at.input)));
        for (l, k, input) in powers {
            let entry = self.first_of_input(input) + k;
            let (moved, scale) = (place.column(entry), (self.rate() * step).powi(-(k as i32)));
            let of_rate = rate.map(|rate| rate.column(entry));
            for (i, tau) in NODES.iter().copied().chain([0.0, 1.0]).enumerate() {
                let slope = |p: usize| match (&of_rate, p.checked_sub(1)) {
                    (_, None) => 0.0,
                    (Some(rate), Some(before)) => rate.a[before] * step * tau.powi(before as i32),
                    (None, Some(before)) => p as f64 * moved.a[p] * tau.powi(before as i32),
                };
                for (p, to) in (k..=ORDER).zip(&mut by) {
                    let [value, slope] = [moved.a[p] * tau.powi(p as i32), slope(p)].map(|of| scale * of);
                    for (to, share) in to[i * all + l * S..].iter_mut().zip(monomials.0[k]) {
                        *to = [to[0] + share * value, to[1] + share * slope];
                    }
                }
            }
        }
        by
    }

    /// Adds a law of force: modes at its place (m, 1/√kg), the flexibility beyond them between contacts and its place
    /// (c, m/N), and how far a unit of each input, of each law before it and of its own reaction move its place beyond
    /// the modes (m, m/N). Loads are added before laws. Beside stops a law of the velocity feels that of the modes.
    ///
    /// # Errors
    /// [`TimestepError::Dimension`], [`TimestepError::NotFinite`].
    pub fn push_law(
        &mut self,
        law: Arc<dyn TimeLaw>,
        modes: &[f64],
        contacts: &[f64],
        moved: &[f64],
    ) -> Result<(), TimestepError> {
        fits("loads that move the place of a law", self.inputs.len() + 1, moved)?;
        self.push_input(modes, contacts)?;
        let input = self.inputs.len() - 1;
        // What this law does to the others is what they do to it.
        self.laws.iter_mut().for_each(|other| other.place.inputs[input] = moved[other.input]);
        let (modes, contacts, inputs) = (modes.to_vec(), contacts.to_vec(), moved.to_vec());
        self.laws.push(LawAt { law, input, place: Observed { modes, contacts, inputs, loads: Vec::new() } });
        Ok(())
    }

    /// Says how motions with laws are integrated.
    ///
    /// # Errors
    /// [`TimestepError::NotPositive`].
    pub fn set_law_settings(&mut self, settings: LawSettings) -> Result<(), TimestepError> {
        positive("tolerance of laws", settings.tolerance)?;
        positive("step of laws (s)", settings.step.unwrap_or(1.0))?;
        self.law_settings = settings;
        Ok(())
    }

    /// Number of laws that are stops, which touches tell behind the contacts.
    pub fn n_law_stops(&self) -> usize {
        self.law_stops().count()
    }

    /// Numbers of the laws that are stops, and their clearances, m.
    pub(super) fn law_stops(&self) -> impl Iterator<Item = (usize, f64)> {
        self.laws.iter().enumerate().filter_map(|(l, at)| Some((l, at.law.stop_gap()?)))
    }

    /// What reactions of the laws move in a step of length `h`.
    fn law_moves(&self, flow: &Flow, h: f64) -> Vec<Vec<[f64; 2]>> {
        flow.laws.iter().flat_map(|law| law.moved(flow, h, self.laws.len() * S)).collect()
    }

    /// Force of a law along a step, from the coefficients of its reaction in `w`.
    pub(super) fn law_force(&self, law: usize, flow: &Flow, w: &[f64]) -> Polynomial {
        let first = self.first_of_input(self.laws[law].input);
        let (mut a, mut factor) = ([0.0; ORDER + 1], -1.0);
        for (a, c) in a.iter_mut().zip(&w[first..=first + DEGREE]) {
            *a = factor * c;
            factor *= self.rate() * flow.step;
        }
        Polynomial { a, size: 0.0 }
    }
}

/// Nodes of a step: the roots of Legendre's polynomial of degree six on (0, 1).
static NODES: LazyLock<[f64; S]> = LazyLock::new(|| {
    let rule = gauss_legendre(S);
    std::array::from_fn(|k| 0.5 * (1.0 + rule[k][0]))
});
const S: usize = 6;

/// Newton steps for the reactions of a step, halvings of such a step, and change of the reactions at which they end.
const ITERATIONS: usize = 30;
const HALVINGS: usize = 12;
const CONVERGED: f64 = 1e-14;

/// Share of a force up to which it is rounding.
const ROUNDING: f64 = 1e-13;

/// Share of the step that the error allows, and bounds of how it changes.
const CAUTION: f64 = 0.9;
const CHANGES: [f64; 2] = [0.2, 2.0];

/// Shortest step over that of the propagator.
const SHORTEST: f64 = 1e-10;

/// Trials for the end of a step at the instant of a touch, and distance, over the step, at which it is found.
const TRIALS: usize = 20;
const AT_INSTANT: f64 = 1e-11;

/// The laws of a motion on its way.
pub(super) struct LawSteps<'a> {
    structure: &'a ForcedStructure,
    /// Length of the next step, s.
    step: f64,
    /// Largest entry of a state so far.
    largest: f64,
    /// Which laws that are stops act, in their order.
    pub acting: Arc<Vec<bool>>,
    /// The stop that begins or ends to act at the end of the present step, and that end, s.
    switch: Option<(usize, f64)>,
    /// Whether one began or ended to act at its beginning.
    has_switched: bool,
}

/// Reactions along a step.
struct Solved {
    /// At the nodes, law after law.
    reactions: Vec<f64>,
    /// What the laws are short of their forces at the ends of the step, the largest, N by the modes at their places.
    defect: f64,
}

impl<'a> LawSteps<'a> {
    pub fn new(structure: &'a ForcedStructure) -> Self {
        let acting = Arc::new(vec![false; structure.n_law_stops()]);
        Self { structure, step: f64::INFINITY, largest: 0.0, acting, switch: None, has_switched: false }
    }

    /// Begins a motion: which stops act.
    pub fn begin(&mut self, running: &Running) {
        let acts = |(l, gap): (usize, f64)| running.flow.laws[l].place.value_and_slope(&running.w)[0] > gap;
        let acting = Arc::new(self.structure.law_stops().map(acts).collect());
        // The steps of the motion before are the first guess for those of this one.
        *self = Self { acting, step: self.step, ..Self::new(self.structure) };
    }

    /// Puts the reactions of a step into `w`; its end, not beyond `until`.
    ///
    /// # Errors
    /// [`TimestepError::LawStep`] where there is none however short the step.
    pub fn go(&mut self, running: &mut Running, until: f64) -> Result<f64, TimestepError> {
        let flow = Arc::clone(&running.flow);
        let states = self.structure.n_states();
        self.largest = running.w[..states].iter().fold(self.largest, |most, v| most.max(v.abs()));
        let settings = self.structure.law_settings;
        let left = until - running.t;
        if left <= SHORTEST * flow.step {
            return Ok(until);
        }
        let most = settings.step.unwrap_or(self.step).min(flow.step);
        let mut h = most.min(left);
        if self.largest == 0.0 {
            // From rest the state at the end of the step.
            let end = flow.after(&running.w, h);
            self.largest = end[..states].iter().fold(0.0, |most, v| most.max(v.abs()));
        }
        // A rest that is much shorter than the others makes the next one no shorter.
        let mut is_cut = h < most;
        let mut trials = 0;
        loop {
            if h < SHORTEST * flow.step && h < left {
                return Err(TimestepError::LawStep { time: running.t, step: h });
            }
            let Some(solved) = self.solve(&flow, &running.w, h) else {
                (h, is_cut) = (0.5 * h, false);
                continue;
            };
            let error = solved.defect * h / (self.structure.rate() * self.largest);
            let allowed = match error > 0.0 && settings.step.is_none() {
                true => CAUTION * (settings.tolerance / error).powf(1.0 / (S as f64 + 1.0)),
                false => CHANGES[1],
            };
            if error > settings.tolerance && settings.step.is_none() {
                (h, is_cut) = (h * allowed.max(CHANGES[0]), false);
                continue;
            }
            self.write(&solved.reactions, h, &mut running.w);
            let switch = self.first_switch(&flow, &running.w, h);
            self.switch = None;
            if let Some((stop, instant)) = switch {
                let is_found = (instant - h).abs() <= AT_INSTANT * h || trials >= TRIALS;
                if is_found || instant <= SHORTEST * flow.step {
                    if instant <= SHORTEST * flow.step {
                        // It switches now: the step begins anew on the other side.
                        self.toggle(stop);
                        self.has_switched = true;
                        trials += 1;
                        if trials <= TRIALS {
                            continue;
                        }
                    }
                    self.switch = Some((stop, running.t + h));
                } else {
                    (h, is_cut, trials) = (instant, true, trials + 1);
                    continue;
                }
            }
            if !is_cut || allowed < 1.0 {
                self.step = h * allowed.clamp(CHANGES[0], CHANGES[1]);
            }
            running.look_ahead();
            return Ok(running.t + h);
        }
    }

    /// Takes that a piece has ended at an instant; whether a stop begins or ends to act there.
    pub fn end(&mut self, t: f64) -> bool {
        let has_switched = std::mem::take(&mut self.has_switched);
        match self.switch.take() {
            Some((stop, end)) if t >= end - AT_INSTANT * end.abs() => {
                self.toggle(stop);
                true
            }
            _ => has_switched,
        }
    }

    fn toggle(&mut self, stop: usize) {
        let acting = Arc::make_mut(&mut self.acting);
        acting[stop] = !acting[stop];
    }

    /// The first stop that begins or ends to act within a step, a little beyond its end, and when after its beginning.
    fn first_switch(&self, flow: &Flow, w: &[f64], h: f64) -> Option<(usize, f64)> {
        let guard = |(stop, (l, gap)): (usize, (usize, f64))| {
            let mut guard = flow.laws[l].place.from(w);
            guard.a[0] -= gap;
            if !self.acting[stop] {
                guard.a.iter_mut().for_each(|a| *a = -*a);
            }
            // A guard is zero to rounding after its instant.
            guard.a[0] += (-guard.a[0]).max(0.0);
            guard
        };
        let guards: Vec<_> = self.structure.law_stops().enumerate().map(guard).collect();
        let end = (1.0 + AT_INSTANT) * h / flow.step;
        first_negative(&guards, end).map(|(when, stop)| (stop, when * flow.step))
    }

    /// The reactions at the nodes of a step of length `h` by Newton's method; `None` where they are not found.
    fn solve(&self, flow: &Flow, w: &[f64], h: f64) -> Option<Solved> {
        let laws = &self.structure.laws;
        let n = laws.len() * S;
        let mut free = w.to_vec();
        laws.iter().for_each(|at| {
            let first = self.structure.first_of_input(at.input);
            free[first..=first + DEGREE].fill(0.0);
        });
        let by = self.structure.law_moves(flow, h);
        let from_state = |law: &LawSeries| law.values(|series| series.from(&free), flow, h);
        let base: Vec<[f64; 2]> = flow.laws.iter().flat_map(from_state).collect();
        let place = |row: usize, u: &[f64]| {
            let sum = |d: usize| base[row][d] + by[row].iter().zip(u).map(|(by, u)| by[d] * u).sum::<f64>();
            [sum(0), sum(1)]
        };
        let forces = |u: &[f64]| -> Vec<[f64; 3]> {
            let at = |q: usize| {
                let [v, rate] = place(q / S * (S + 2) + q % S, u);
                laws[q / S].law.at(v, rate)
            };
            (0..n).map(at).collect()
        };
        let residual = |u: &[f64], f: &[[f64; 3]]| -> Vec<f64> { u.iter().zip(f).map(|(u, f)| u + f[0]).collect() };
        let size = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
        let mut u = self.guess(w, h);
        let mut at = forces(&u);
        let mut off = residual(&u, &at);
        let mut found = false;
        for _ in 0..ITERATIONS {
            let jacobian = Mat::from_fn(n, n, |q, j| {
                let [v, rate] = by[q / S * (S + 2) + q % S][j];
                f64::from(u8::from(q == j)) + at[q][1] * v + at[q][2] * rate
            });
            let mut step = off.clone();
            DenseLu::factor(&jacobian).ok()?.solve_in_place(&mut step);
            let (before, mut share) = (size(&off), 1.0);
            for k in 0..=HALVINGS {
                let next: Vec<f64> = u.iter().zip(&step).map(|(u, s)| u - share * s).collect();
                let next_at = forces(&next);
                let next_off = residual(&next, &next_at);
                if size(&next_off) <= before || k == HALVINGS {
                    (u, at, off) = (next, next_at, next_off);
                    break;
                }
                share *= 0.5;
            }
            let largest = u.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
            let moved = step.iter().fold(0.0_f64, |most, s| most.max((share * s).abs()));
            if !moved.is_finite() {
                return None;
            }
            if moved <= CONVERGED * largest.max(f64::MIN_POSITIVE) || moved == 0.0 {
                found = true;
                break;
            }
            // At rounding nothing changes any more.
            if share == 1.0 && size(&off) <= (1e2 * CONVERGED * largest).powi(2) {
                found = true;
                break;
            }
        }
        if !found {
            return None;
        }
        let (mut defect, monomials) = (0.0_f64, Monomials::new());
        for (l, at) in laws.iter().enumerate() {
            let strength = at.place.modes.iter().map(|r| r * r).sum::<f64>().sqrt();
            for (i, tau) in [(S, 0.0_f64), (S + 1, 1.0)] {
                let [v, rate] = place(l * (S + 2) + i, &u);
                let own = &u[l * S..(l + 1) * S];
                let reaction: f64 =
                    (0..S).map(|k| tau.powi(k as i32) * (0..S).map(|j| monomials.0[k][j] * own[j]).sum::<f64>()).sum();
                let force = at.law.at(v, rate)[0];
                // Forces in balance at rest are so up to rounding.
                let rounding = ROUNDING * (reaction.abs() + force.abs());
                defect = defect.max(strength * ((reaction + force).abs() - rounding).max(0.0));
            }
        }
        Some(Solved { reactions: u, defect })
    }

    /// Reactions at the nodes by the polynomials of the step before.
    fn guess(&self, w: &[f64], h: f64) -> Vec<f64> {
        let value = |first: usize, tau: f64| {
            let x = tau * h * self.structure.rate();
            w[first..=first + DEGREE].iter().rev().fold(0.0, |sum, c| sum * x + c)
        };
        let laws = self.structure.laws.iter().map(|at| self.structure.first_of_input(at.input));
        laws.flat_map(|first| NODES.map(|tau| value(first, tau))).collect()
    }

    /// The polynomials through the reactions at the nodes as coefficients of the inputs.
    fn write(&self, reactions: &[f64], h: f64, w: &mut [f64]) {
        let (monomials, scale) = (Monomials::new(), h * self.structure.rate());
        for (at, own) in self.structure.laws.iter().zip(reactions.chunks(S)) {
            let first = self.structure.first_of_input(at.input);
            w[first..=first + DEGREE].fill(0.0);
            let mut factor = 1.0;
            for (k, row) in monomials.0.iter().enumerate() {
                w[first + k] = factor * row.iter().zip(own).map(|(m, u)| m * u).sum::<f64>();
                factor /= scale;
            }
        }
    }
}

/// Coefficients of the polynomials of Lagrange at the nodes: row k has those of `τ^k`.
struct Monomials([[f64; S]; S]);

impl Monomials {
    fn new() -> Self {
        let mut all = [[0.0; S]; S];
        for j in 0..S {
            let mut polynomial = [0.0; S];
            polynomial[0] = 1.0;
            let others = NODES.iter().enumerate().filter(|(i, _)| *i != j).map(|(_, node)| node);
            for (degree, node) in others.enumerate() {
                let divisor = NODES[j] - node;
                for k in (0..=degree).rev() {
                    polynomial[k + 1] += polynomial[k] / divisor;
                    polynomial[k] *= -node / divisor;
                }
            }
            polynomial.iter().enumerate().for_each(|(k, p)| all[k][j] = *p);
        }
        Self(all)
    }
}
