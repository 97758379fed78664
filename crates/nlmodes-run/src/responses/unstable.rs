//! What the unstable motions of responses over the frequency become.

use nlmodes_scene::scene::{ResponseKind, Scene};
use nlmodes_scene::short;
use serde::Serialize;

use super::curves::ComputedResponse;
use super::levels::{Level, frequency};
use super::tables;
use super::viewed::viewed;
use crate::certificate::Looking;
use crate::chain;
use crate::model::Model;
use crate::motion::Motion;
use crate::settle::{Becomes, Forced, Row, settle_in_memory};

/// Unstable points of a curve one after the other, and what the motion of the middle one becomes.
#[derive(Debug, Serialize)]
pub struct Unstable {
    /// Lowest and highest frequency, Hz.
    frequency_hz: [f64; 2],
    /// Number of the point in the middle.
    point: usize,
    /// What it becomes; none where that is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    becomes: Option<Becomes>,
    /// Why not.
    #[serde(skip_serializing_if = "Option::is_none")]
    why_not: Option<String>,
}

impl Unstable {
    /// In words.
    pub fn text(&self) -> String {
        let [low, high] = self.frequency_hz;
        let range = if low == high { short(low) } else { format!("{} to {}", short(low), short(high)) };
        let becomes = match (&self.becomes, &self.why_not) {
            (Some(becomes), _) => format!("its motions become {}", becomes.short_text()),
            (_, Some(why)) => format!("what its motions become is not known: {why}"),
            _ => "what its motions become is not known".to_owned(),
        };
        format!("unstable from {range} Hz (point {}): {becomes}", self.point)
    }
}

/// Name of the check for who looks on.
const CHECK: &str = "what unstable motions become";

/// Follows the middle of each unstable segment of the levels, for as long as `look` lets it.
pub fn follow((scene, model): (&Scene, &Model), curves: &[ComputedResponse], levels: &mut [Level], look: Looking<'_>) {
    let rows: Vec<Row> = tables::rows(&viewed(scene, model, curves)).collect();
    let mut stretches: Vec<(usize, usize, [usize; 2])> = Vec::new();
    let mut first = 0;
    for (number, computed) in curves.iter().enumerate() {
        if computed.kind == ResponseKind::Frequency {
            stretches.extend(unstable(computed).into_iter().map(|ends| (number, first, ends)));
        }
        first += computed.branch.points.len();
    }
    let of = stretches.len();
    for (k, (number, first, [from, to])) in stretches.into_iter().enumerate() {
        let (computed, middle) = (&curves[number], usize::midpoint(from, to));
        let Some(level) = levels.iter_mut().find(|level| level.is_of(computed)) else { continue };
        let (point, points) = (first + middle, &computed.branch.points);
        if !look(CHECK, point, [k + 1, of]) {
            return;
        }
        let found = &points[middle];
        let at = Forced {
            point,
            level: computed.level.unwrap_or(0.0),
            omega: found.listed_omega(),
            subharmonic: scene.responses[computed.response].subharmonic,
        };
        let motion = Motion { omega: found.omega, coefficients: found.coefficients.clone() };
        let range = points[from..=to].iter().map(frequency);
        let frequency_hz = range.fold([f64::INFINITY, 0.0], |[low, high], hz| [low.min(hz), high.max(hz)]);
        let (becomes, why_not) = match settle_in_memory(model, at, &motion, &rows) {
            Ok(settled) => (Some(settled.becomes), None),
            Err(error) => (None, Some(chain(&error))),
        };
        level.unstable.push(Unstable { frequency_hz, point, becomes, why_not });
    }
}

/// First and last point of each stretch of unstable ones.
fn unstable(of: &ComputedResponse) -> Vec<[usize; 2]> {
    let is_unstable = |k: usize| of.branch.points[k].stability.and_then(|stability| stability.stable) == Some(false);
    let points: Vec<usize> = (0..of.branch.points.len()).filter(|k| is_unstable(*k)).collect();
    points.chunk_by(|a, b| a + 1 == *b).filter_map(|own| Some([*own.first()?, *own.last()?])).collect()
}
