//! Changes of the smooth piece within a step.

use super::{ELSEWHERE, Located, MOST_CORRECTIONS, Mark, Root, Search};
use crate::corrector::Correction;
use crate::{EventKind, ParametricSystem};

/// Most changes of pattern looked for within a step.
const MOST_CHANGES: usize = 8;

/// Shares of a step at which it is looked whether the pattern is another one there.
const WITHIN: [f64; 3] = [0.25, 0.5, 0.75];

/// How often a step is halved to see about where the pattern changes.
const HALVINGS: usize = 6;

impl<S: ParametricSystem> Search<'_, S> {
    /// Where the system passes from one smooth piece to another; beyond the most that are distinguished, the last one
    /// represents the rest.
    pub fn pattern_changes(&mut self) -> Vec<Located> {
        let mut found = Vec::new();
        for pair in self.witnesses().windows(2) {
            self.changes_between(pair[0].clone(), &pair[1], &mut found);
        }
        found
    }

    fn changes_between(&mut self, mut low: Mark, high: &Mark, found: &mut Vec<Located>) {
        while low.at.pattern != high.at.pattern {
            let from = low.at.pattern;
            if found.len() >= MOST_CHANGES {
                let kinds = vec![EventKind::PatternChange { from, to: high.at.pattern }];
                found.push(Located { s: high.s, kinds, point: high.at.clone() });
                break;
            }
            let (located, beyond) = self.first_change(low, high.clone());
            found.push(located);
            low = beyond;
        }
    }

    /// Both ends of the step and, where the system tells at little expense that the pattern changes more than once in
    /// between, a point on each piece.
    fn witnesses(&mut self) -> Vec<Mark> {
        let [low, high] = self.whole();
        let pieces = self.pieces_between(&low, &high);
        let mut marks = vec![low.clone()];
        if pieces.windows(2).filter(|pair| pair[0].1 != pair[1].1).count() > 1 {
            for (s, piece) in pieces[1..pieces.len() - 1].iter().copied() {
                if marks.last().is_some_and(|last| last.at.pattern != piece) {
                    marks.extend(self.reach(&low, &high, s));
                }
            }
        }
        marks.push(high);
        marks
    }

    /// The pieces at a few points of the curve through two points, as far as the system tells, with those of both.
    fn pieces_between(&mut self, low: &Mark, high: &Mark) -> Vec<(f64, u64)> {
        let mut pieces = vec![(low.s, low.at.pattern)];
        if let Some(curve) = self.curve(low, high) {
            let places = WITHIN.map(|share| low.s + share * (high.s - low.s));
            pieces.extend(places.into_iter().filter_map(|s| Some((s, self.system.pattern_at(&curve.at(s))?))));
        }
        pieces.push((high.s, high.at.pattern));
        pieces
    }

    /// A change of the pattern between two points, and a point beyond it from which the next one is looked for.
    ///
    /// Two points are brought together until the system knows the boundary between their pieces, whose function then
    /// tells the place.
    fn first_change(&mut self, mut low: Mark, mut high: Mark) -> (Located, Mark) {
        let from = low.at.pattern;
        let change = |s: f64, point: Correction, to: u64| {
            let kinds = vec![EventKind::PatternChange { from, to }];
            Located { s, kinds, point: Correction { pattern: to, ..point } }
        };
        for _ in 0..MOST_CORRECTIONS {
            let root = self.on_boundary(&low, &high);
            if high.s - low.s <= self.located() {
                break;
            }
            // Nothing else happens before.
            if let Some(root) = root.as_ref().filter(|root| self.is_one_piece(&low, root)) {
                return (change(root.s, root.point.clone(), high.at.pattern), high);
            }
            let s = root.as_ref().map_or(high.s, |root| root.s);
            let on_curve = if root.is_none() { self.beyond_change(&low, &high) } else { None };
            let others = ELSEWHERE.map(|share| low.s + share * (s - low.s));
            let middle = on_curve.into_iter().chain(others).find_map(|s| self.reach(&low, &high, s));
            match (middle, root) {
                (Some(middle), Some(root)) if middle.at.pattern == from => {
                    return (change(root.s, root.point, high.at.pattern), high);
                }
                (Some(middle), _) if middle.at.pattern == from => low = middle,
                (Some(middle), _) => high = middle,
                (None, _) => break,
            }
        }
        (change(high.s, high.at.clone(), high.at.pattern), high)
    }

    /// A place a little beyond the first change of the piece on the curve through two points, as the system tells at
    /// little expense.
    fn beyond_change(&mut self, low: &Mark, high: &Mark) -> Option<f64> {
        let curve = self.curve(low, high)?;
        let (mut before, mut beyond) = (low.s, high.s);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (before + beyond);
            let same = self.system.pattern_at(&curve.at(middle))? == low.at.pattern;
            if same { before = middle } else { beyond = middle }
        }
        (beyond < high.s).then_some(beyond)
    }

    /// Whether the branch lies on one piece as far as this root, as the system tells at little expense.
    fn is_one_piece(&mut self, low: &Mark, root: &Root) -> bool {
        let end = Mark { s: root.s, at: root.point.clone() };
        let pieces = self.pieces_between(low, &end);
        pieces.len() > 2 && pieces.iter().rev().skip(1).all(|(_, piece)| *piece == low.at.pattern)
    }

    /// The point between two at which the branch passes the boundary of their pieces, where the system knows that.
    fn on_boundary(&mut self, low: &Mark, high: &Mark) -> Option<Root> {
        let boundary = self.system.boundary(&low.at.z, &high.at.z)?;
        let value = |c: &Correction| boundary.value(&c.z);
        if value(&low.at) <= 0.0 || value(&high.at) >= 0.0 {
            return None;
        }
        let root = self.find(&ELSEWHERE, [low.clone(), high.clone()], &value);
        root.settled.then_some(root)
    }
}
