use crate::corrector::{Correction, Corrector};
use crate::step::{Foot, reach};
use crate::{EventKind, ParametricSystem};

/// Tangent component below which a coordinate counts as standing still.
const SIGNIFICANT: f64 = 1e-9;

/// Distance below which events happen at one point.
const COINCIDENT: f64 = 1e-8;

/// Most changes of pattern looked for within a step.
const MOST_CHANGES: usize = 8;

/// Shares of the bracket of a root that are tried where the branch is not found at the first.
const ELSEWHERE: [f64; 3] = [0.5, 0.25, 0.75];

/// An event within a step, at the distance `s` along the foot's tangent.
#[derive(Debug, Clone)]
pub(crate) struct Located {
    pub s: f64,
    pub kinds: Vec<EventKind>,
    pub point: Correction,
}

/// The coordinates whose turning points are events, and the sense in which each moved last.
#[derive(Debug)]
pub(crate) struct FoldWatch {
    coordinates: Vec<(usize, EventKind, f64)>,
}

impl FoldWatch {
    /// For the parameter, coordinate n, and the watched unknowns.
    pub fn new(n: usize, watched: &[usize]) -> Self {
        let unknowns = watched.iter().map(|&index| (index, EventKind::UnknownFold { index }, 0.0));
        Self { coordinates: std::iter::once((n, EventKind::ParameterFold, 0.0)).chain(unknowns).collect() }
    }

    /// The sense in which each moved last.
    pub fn senses(&self) -> Vec<f64> {
        self.coordinates.iter().map(|(_, _, sense)| *sense).collect()
    }

    /// As if each had moved in these senses.
    pub fn set_senses(&mut self, senses: &[f64]) {
        self.coordinates.iter_mut().zip(senses).for_each(|((_, _, sense), now)| *sense = *now);
    }

    /// Takes note of a tangent and returns the coordinates that turned since the last.
    pub fn update(&mut self, tangent: &[f64]) -> Vec<(usize, EventKind)> {
        let mut turned = Vec::new();
        for (i, kind, sense) in &mut self.coordinates {
            if tangent[*i].abs() > SIGNIFICANT {
                let now = tangent[*i].signum();
                if *sense * now < 0.0 {
                    turned.push((*i, *kind));
                }
                *sense = now;
            }
        }
        turned
    }
}

/// A step, of length `h` along the tangent of `foot`, within which events are located.
pub(crate) struct Search<'a, S> {
    pub system: &'a mut S,
    pub corrector: &'a mut Corrector,
    pub foot: &'a Foot,
    pub end: &'a Correction,
    pub h: f64,
}

impl<S: ParametricSystem> Search<'_, S> {
    /// Folds of the coordinates `turned` and the others that are known, ascending; what coincides is one.
    pub fn all(&mut self, turned: &[(usize, EventKind)], others: impl Iterator<Item = Located>) -> Vec<Located> {
        let mut found = Vec::new();
        for &(i, kind) in turned {
            let sense = -self.end.tangent[i].signum();
            let Root { s, point, .. } = self.root(0.0, |c| sense * c.tangent[i]);
            found.push(Located { s, kinds: vec![kind], point });
        }
        found.extend(others);
        found.sort_by(|a, b| a.s.total_cmp(&b.s));
        found.dedup_by(|later, kept| {
            let same = later.s - kept.s <= COINCIDENT;
            if same {
                kept.kinds.append(&mut later.kinds);
            }
            same
        });
        found
    }

    /// Where `det [J; tᵀ]` changes its sign; `None` if it is not known where within the step.
    pub fn crossing(&mut self) -> Option<Located> {
        let sense = self.foot.orientation;
        let Root { s, point, .. } = self.certain_root(|c| sense * c.orientation)?;
        Some(Located { s, kinds: vec![EventKind::BranchPoint], point })
    }

    /// Where the system passes from one smooth piece to another; beyond the most that are told apart, the last one stands for the rest.
    pub fn pattern_changes(&mut self) -> Vec<Located> {
        let (mut from, mut s) = (self.foot.pattern, 0.0);
        let mut found = Vec::new();
        while from != self.end.pattern {
            if found.len() == MOST_CHANGES {
                let kinds = vec![EventKind::PatternChange { from, to: self.end.pattern }];
                found.push(Located { s: self.h, kinds, point: self.end.clone() });
                break;
            }
            let Root { s: at, point, .. } = self.root(s, |c| if c.pattern == from { 1.0 } else { -1.0 });
            let to = point.pattern;
            found.push(Located { s: at, kinds: vec![EventKind::PatternChange { from, to }], point });
            (from, s) = (to, at);
        }
        found
    }

    /// Where `test`, which is negative at the end, turns so beyond `start`: secant steps, kept in the bracket by bisection. Where a point of
    /// the branch is not found, others in the bracket are tried; if none is, the nearest one known on the far side stands for the root.
    pub fn root(&mut self, start: f64, test: impl Fn(&Correction) -> f64) -> Root {
        self.root_trying(&ELSEWHERE, start, test)
    }

    /// The same where a point that is not found casts doubt on the step: `None` then.
    pub fn certain_root(&mut self, test: impl Fn(&Correction) -> f64) -> Option<Root> {
        Some(self.root_trying(&[], 0.0, test)).filter(|root| root.settled)
    }

    fn root_trying(&mut self, elsewhere: &[f64], start: f64, test: impl Fn(&Correction) -> f64) -> Root {
        let mut settled = true;
        let mut best = self.end.clone();
        let (mut low, mut f_low): (f64, Option<f64>) = (start, None);
        let (mut high, mut f_high) = (self.h, test(self.end));
        for k in 0..60 {
            if high - low <= 1e-10 * self.h.max(1e-3) || f_high == 0.0 {
                break;
            }
            let s = match f_low {
                Some(f_low) if k % 3 != 2 => (low + (high - low) * f_low / (f_low - f_high)).clamp(low, high),
                _ => 0.5 * (low + high),
            };
            let others = elsewhere.iter().map(|share| low + share * (high - low));
            let mut tried = std::iter::once(s).chain(others);
            let reached = tried.find_map(|s| Some((s, reach(self.system, self.corrector, self.foot, s).ok()?)));
            let Some((s, c)) = reached else {
                settled = false;
                break;
            };
            let f = test(&c);
            if f > 1e-12 {
                (low, f_low) = (s, Some(f));
            } else {
                (high, f_high, best) = (s, if f.abs() <= 1e-12 { 0.0 } else { f }, c);
            }
        }
        Root { s: high, point: best, settled }
    }
}

/// Where a test function changes its sign within a step.
pub(crate) struct Root {
    /// Distance along the tangent of the foot.
    pub s: f64,
    /// The point there, on the far side.
    pub point: Correction,
    /// Whether no point that was looked for on the way is missing; else this is the nearest one that is known.
    pub settled: bool,
}
