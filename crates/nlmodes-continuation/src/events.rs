//! Where within a step something happens: roots of test functions along the branch.

mod changes;

use crate::corrector::{Correction, Corrector, Hyperplane, Surface};
use crate::predictor::Hermite;
use crate::roots::bracketed_root;
use crate::step::{BasePoint, reach};
use crate::vectors::distance;
use crate::{EventKind, ParametricSystem};

/// Tangent component below which a coordinate counts as standing still.
const SIGNIFICANT: f64 = 1e-9;

/// Distance below which events happen at one point.
const COINCIDENT: f64 = 1e-8;

/// Shares of the bracket of a root that are tried where the branch is not found at the first.
const ELSEWHERE: [f64; 3] = [0.5, 0.25, 0.75];

/// Distance, over that of the points between which the branch is interpolated, by which it may be off that.
const OFF_CURVE: f64 = 0.3;

/// Width of the bracket of a root, over the step or over the second where that is shorter, and most corrections.
const LOCATED: (f64, f64) = (1e-10, 1e-3);
const MOST_CORRECTIONS: usize = 60;

/// Share of a step within which the Jacobian becomes singular evenly.
const EVENLY: f64 = 1e-4;

/// Value of a test function, over that at the ends of the bracket, that is zero but for rounding.
const ZERO: f64 = 1e-13;

/// An event within a step, at the distance `s` along the base point's tangent.
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

/// A step, of length `h` along the tangent of `base point`, within which events are located.
pub(crate) struct Search<'a, S> {
    pub system: &'a mut S,
    pub corrector: &'a mut Corrector,
    pub base: &'a BasePoint,
    pub end: &'a Correction,
    pub h: f64,
}

/// A point of the branch within a step, at the distance `s` along the base point's tangent.
#[derive(Debug, Clone)]
struct Mark {
    s: f64,
    at: Correction,
}

impl<S: ParametricSystem> Search<'_, S> {
    /// Folds of the coordinates `turned` and the others that are known, ascending; what coincides is one.
    pub fn all(&mut self, turned: &[(usize, EventKind)], others: impl Iterator<Item = Located>) -> Vec<Located> {
        let mut found = Vec::new();
        for &(i, kind) in turned {
            let sense = -self.end.tangent[i].signum();
            let Root { s, point, .. } = self.root(|c| sense * c.tangent[i]);
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
    ///
    /// The nearer points are to a branch point, the less they are known. So where the Jacobian becomes singular evenly,
    /// the last segment is interpolated.
    pub fn crossing(&mut self) -> Option<Located> {
        let kinds = vec![EventKind::BranchPoint];
        let [mut low, mut high] = self.whole();
        let largest = low.at.regularity.max(high.at.regularity);
        while high.s - low.s > self.located() {
            let width = high.s - low.s;
            let [before, behind] = [&low, &high].map(|mark| mark.at.regularity);
            if width <= EVENLY * self.h && before.max(behind) <= 100.0 * EVENLY * largest {
                let s = low.s + width * before / (before + behind);
                return self.interpolated(&low, &high, s).map(|point| Located { s, kinds, point });
            }
            let middle = self.reach(&low, &high, low.s + 0.5 * width)?;
            if middle.at.orientation * self.base.orientation > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(Located { s: high.s, kinds, point: high.at })
    }

    /// The point at the distance `s` of the curve through two points.
    fn interpolated(&mut self, low: &Mark, high: &Mark, s: f64) -> Option<Correction> {
        let curve = self.curve(low, high)?;
        let (z, tangent) = (curve.at(s), curve.tangent(s));
        let residual = self.corrector.evaluate(self.system, &z).ok()?;
        Some(Correction { z, tangent, residual, regularity: 0.0, ..high.at.clone() })
    }

    /// Where `test`, a smooth function of point and tangent that is negative at the end, turns so. Where a point of
    /// the branch is not found, others in the bracket are tried; if none is, the nearest one known on the far side
    /// is used as the root.
    pub fn root(&mut self, test: impl Fn(&Correction) -> f64) -> Root {
        self.find(&ELSEWHERE, self.whole(), &test)
    }

    /// Both ends of the step.
    fn whole(&self) -> [Mark; 2] {
        let BasePoint { z, tangent, orientation, pattern, regularity, .. } = self.base.clone();
        let base = Correction { z, tangent, orientation, residual: 0.0, iterations: 0, pattern, regularity };
        [Mark { s: 0.0, at: base }, Mark { s: self.h, at: self.end.clone() }]
    }

    /// Width to which the bracket of a root is brought.
    fn located(&self) -> f64 {
        LOCATED.0 * self.h.max(LOCATED.1)
    }

    /// The root of a smooth function in a bracket. It is followed along the curve through both ends, at no expense, and
    /// the branch is corrected at its root there, until that stays where it is. Where the bracket hardly becomes
    /// narrower, since all these points lie on one side, the next is as far beyond the root as that has moved; where
    /// that does not help either, the bracket is halved.
    fn find(&mut self, elsewhere: &[f64], [mut low, mut high]: [Mark; 2], test: &dyn Fn(&Correction) -> f64) -> Root {
        let width = self.located();
        let (mut f_low, mut f_high) = (test(&low.at).max(f64::MIN_POSITIVE), test(&high.at));
        let zero = ZERO * f_low.max(f_high.abs());
        let mut known = (high.clone(), f_high);
        let mut idle = 0;
        for _ in 0..MOST_CORRECTIONS {
            let before = high.s - low.s;
            // Where the bracket does not narrow as it should, points are not known well enough for more.
            let rests = idle > 0 && before <= self.corrector.resolution;
            if before <= width || rests || known.1.abs() <= zero {
                break;
            }
            let (middle, root) = (0.5 * (low.s + high.s), self.root_between((&low, f_low), (&high, f_high), test));
            let moved = root - known.0.s;
            let s = match idle % 3 {
                1 if moved > 0.0 => (root + moved).min(middle.max(root)),
                1 => (root + moved).max(middle.min(root)),
                2 => middle,
                _ => root,
            };
            if moved.abs() <= width {
                break;
            }
            let others = elsewhere.iter().map(|share| low.s + share * before);
            let Some(mark) = std::iter::once(s).chain(others).find_map(|s| self.reach(&low, &high, s)) else {
                return Root { s: high.s, point: high.at, settled: false };
            };
            let f = test(&mark.at);
            known = (mark.clone(), f);
            if f > 0.0 {
                (low, f_low) = (mark, f);
            } else {
                (high, f_high) = (mark, f);
            }
            idle = if high.s - low.s > 0.5 * before { idle + 1 } else { 0 };
        }
        let Mark { s, at: point } = known.0;
        Root { s, point, settled: true }
    }

    /// Where the curve through two points has the root of a function.
    fn root_between(&self, low: (&Mark, f64), high: (&Mark, f64), test: &dyn Fn(&Correction) -> f64) -> f64 {
        let Some(curve) = self.curve(low.0, high.0) else { return 0.5 * (low.0.s + high.0.s) };
        let mut on_curve = high.0.at.clone();
        let value = |s: f64| {
            (on_curve.z, on_curve.tangent) = (curve.at(s), curve.tangent(s));
            test(&on_curve)
        };
        let width = 0.1 * self.located();
        bracketed_root(value, (low.0.s, low.1), (high.0.s, high.1), width).clamp(low.0.s + width, high.0.s)
    }

    fn curve<'m>(&self, low: &'m Mark, high: &'m Mark) -> Option<Hermite<'m>> {
        let of = |mark: &'m Mark| (mark.s, mark.at.z.as_slice(), mark.at.tangent.as_slice());
        Hermite::new(&self.base.tangent, of(low), of(high))
    }

    /// The branch at the distance `s`: from the curve through both points, or else from the base point.
    fn reach(&mut self, low: &Mark, high: &Mark, s: f64) -> Option<Mark> {
        let guess = self.curve(low, high).map(|curve| curve.at(s));
        let found = guess.and_then(|guess| {
            let plane = Hyperplane::through(&guess, &self.base.tangent);
            let found = self.corrector.correct(self.system, &guess, &Surface::Plane(plane)).ok()?;
            (distance(&found.z, &guess) <= OFF_CURVE * distance(&low.at.z, &high.at.z)).then_some(found)
        });
        found.map(|at| Mark { s, at }).or_else(|| self.reach_from_foot(s))
    }

    fn reach_from_foot(&mut self, s: f64) -> Option<Mark> {
        let at = reach(self.system, self.corrector, self.base, s).ok()?;
        Some(Mark { s, at })
    }
}

/// Where a test function changes its sign within a step.
pub(crate) struct Root {
    /// Distance along the tangent of the base point.
    pub s: f64,
    /// The point there, on the far side.
    pub point: Correction,
    /// Whether no point that was looked for on the way is missing; else this is the nearest one that is known.
    pub settled: bool,
}
