use crate::corrector::{Correction, Corrector};
use crate::step::{Foot, reach};
use crate::{EventKind, ParametricSystem};

/// Tangent component below which a coordinate counts as standing still.
const SIGNIFICANT: f64 = 1e-9;

/// Distance below which events happen at one point.
const COINCIDENT: f64 = 1e-8;

/// How far ahead of a step the Jacobian may become singular, over the step, where it is looked whether it does so within.
const DIP_AHEAD: f64 = 1.5;

/// Regularity, over that at the ends of a step, below which it counts as vanishing within.
const DIP_DEPTH: f64 = 0.3;

/// Most changes of pattern looked for within a step.
const MOST_CHANGES: usize = 8;

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
    /// Folds of the coordinates `turned` and changes of the pattern, ascending; what coincides is one.
    pub fn all(&mut self, turned: &[(usize, EventKind)], crossing: Option<Located>) -> Vec<Located> {
        let mut found: Vec<Located> = crossing.into_iter().collect();
        for &(i, kind) in turned {
            let sense = -self.end.tangent[i].signum();
            found.extend(self.root(0.0, |c| sense * c.tangent[i]).map(|(s, point)| Located {
                s,
                kinds: vec![kind],
                point,
            }));
        }
        found.extend(self.pattern_changes());
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

    /// Where `det [J; tᵀ]` changes its sign.
    pub fn crossing(&mut self) -> Option<Located> {
        let sense = self.foot.orientation;
        let (s, point) = self.root(0.0, |c| sense * c.orientation)?;
        Some(Located { s, kinds: vec![EventKind::BranchPoint], point })
    }

    /// Where the Jacobian is closest to singular, if that is within the step and much closer than at both its ends; `before` is the
    /// regularity of an earlier point and its distance from the foot.
    ///
    /// Where curves meet in an even number of free directions beyond the tangent, `det [J; tᵀ]` vanishes without a change of sign.
    pub fn dip(&mut self, before: (f64, f64)) -> Option<Result<Located, &'static str>> {
        let (behind, distance) = before;
        let (here, there) = (self.foot.regularity, self.end.regularity);
        if here * (distance + DIP_AHEAD * self.h) > behind * DIP_AHEAD * self.h {
            return None;
        }
        let lost = "the point at which the Jacobian comes closest to singular could not be located";
        let Ok(middle) = reach(self.system, self.corrector, self.foot, self.h * here / (here + there)) else {
            return Some(Err(lost));
        };
        if middle.regularity > DIP_DEPTH * here.min(there) {
            return None;
        }
        Some(self.lowest_regularity().ok_or(lost))
    }

    /// The point of least regularity, by golden sections.
    fn lowest_regularity(&mut self) -> Option<Located> {
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (0.0, self.h);
        let mut at = |s: f64| reach(self.system, self.corrector, self.foot, s).ok();
        let (mut s, mut t) = (high - golden * (high - low), low + golden * (high - low));
        let (mut left, mut right) = (at(s)?, at(t)?);
        while high - low > COINCIDENT {
            if left.regularity < right.regularity {
                (high, t, right) = (t, s, left);
                s = high - golden * (high - low);
                left = at(s)?;
            } else {
                (low, s, left) = (s, t, right);
                t = low + golden * (high - low);
                right = at(t)?;
            }
        }
        let (s, point) = if left.regularity < right.regularity { (s, left) } else { (t, right) };
        Some(Located { s, kinds: vec![EventKind::BranchPoint], point })
    }

    /// Where the system passes from one smooth piece to another.
    pub fn pattern_changes(&mut self) -> Vec<Located> {
        let (mut from, mut s) = (self.foot.pattern, 0.0);
        let mut found = Vec::new();
        while from != self.end.pattern && found.len() < MOST_CHANGES {
            let Some((at, point)) = self.root(s, |c| if c.pattern == from { 1.0 } else { -1.0 }) else { break };
            let to = point.pattern;
            found.push(Located { s: at, kinds: vec![EventKind::PatternChange { from, to }], point });
            (from, s) = (to, at);
        }
        found
    }

    /// Where `test` turns negative beyond `start`, the point on its far side: secant steps, kept in the bracket by bisection.
    pub fn root(&mut self, start: f64, test: impl Fn(&Correction) -> f64) -> Option<(f64, Correction)> {
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
            let c = reach(self.system, self.corrector, self.foot, s).ok()?;
            let f = test(&c);
            if f > 1e-12 {
                (low, f_low) = (s, Some(f));
            } else {
                (high, f_high, best) = (s, if f.abs() <= 1e-12 { 0.0 } else { f }, c);
            }
        }
        Some((high, best))
    }
}
