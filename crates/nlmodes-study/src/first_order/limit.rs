//! How much of the tolerances keeps a quantity to its limit.

use std::collections::BTreeMap;

use serde::Serialize;

use super::corner::{Corner, ends};
use super::{Cases, Further, Slope, Within};
use crate::error::StudyError;
use crate::study::{Limit, Quantity};

/// How much of the tolerances keeps a quantity to its limit: the share of the way from the means to the worst corner at
/// which it meets it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Kept {
    /// The limit.
    pub limit: f64,
    /// `at most` or `at least`.
    pub which: &'static str,
    /// The share by first order; zero where the means are beyond the limit, none where nothing changes it.
    pub first_order: Option<f64>,
    /// The share as computed, at most one: the whole box; none where it is not.
    pub share: Option<f64>,
    /// The quantity at that share of the way, as computed.
    pub computed: Option<f64>,
    /// The tolerances with that share of their widths: lowest and highest value of each variable.
    pub within: BTreeMap<String, [f64; 2]>,
    /// Why the share is not computed, or what it does not tell; else empty.
    pub reason: String,
}

/// Most cases on the way to the corner.
const MOST: usize = 8;
/// How near to its limit a quantity is that meets it, over what it differs from that at the means.
const NEAR: f64 = 1e-3;

/// How much of the tolerances keeps the quantity to its limit; none where it has none.
pub fn kept(
    within: &Within<'_>,
    (quantity, slope): (&Quantity, &Slope),
    corners: &[Corner],
    cases: &mut Cases<'_>,
) -> Result<Option<Kept>, StudyError> {
    let Some(limit) = quantity.limit else { return Ok(None) };
    let grows = matches!(limit, Limit::AtMost(_));
    let end = ends(within, slope, grows);
    let (room, way) = (limit.value() - slope.value, within.predicted(slope, &end) - slope.value);
    let mut kept = Kept {
        limit: limit.value(),
        which: limit.words(),
        first_order: (way != 0.0).then(|| (room / way).max(0.0)),
        share: None,
        computed: None,
        within: BTreeMap::new(),
        reason: String::new(),
    };
    if !limit.holds(slope.value) {
        (kept.share, kept.computed) = (Some(0.0), Some(slope.value));
        return Ok(Some(kept));
    }
    let corner = corners.iter().find(|corner| (corner.which == "largest") == grows);
    let Some(there) = corner.and_then(|corner| corner.computed) else {
        kept.reason = corner.map_or_else(String::new, |corner| corner.reason.clone());
        return Ok(Some(kept));
    };
    if limit.holds(there) {
        (kept.share, kept.computed) = (Some(1.0), Some(there));
        if let Some(names) = corner.map(|corner| corner.turns_over.join(", ")).filter(|names| !names.is_empty()) {
            kept.reason = format!("within them it is more extreme, as {names} changes, which was not computed");
        }
    } else {
        within.search(quantity, (slope.value, there, &end), cases, &mut kept)?;
    }
    kept.within = kept.share.map(|share| within.narrowed(share)).unwrap_or_default();
    Ok(Some(kept))
}

impl Within<'_> {
    /// The tolerances with a share of their widths.
    fn narrowed(&self, share: f64) -> BTreeMap<String, [f64; 2]> {
        let each = self.study.variables.iter().zip(&self.tolerances);
        each.map(|(variable, t)| (variable.name.clone(), t.ends.map(|end| t.mean + share * (end - t.mean)))).collect()
    }

    /// Where the quantity meets its limit between the means, which keep to it, and the corner, which does not: by
    /// chords, of which the end that stays counts half (the Illinois method). The share is that of the last case that
    /// keeps to the limit.
    fn search(
        &self,
        quantity: &Quantity,
        (mean, corner, end): (f64, f64, &[f64]),
        cases: &mut Cases<'_>,
        kept: &mut Kept,
    ) -> Result<(), StudyError> {
        let Some(limit) = quantity.limit else { return Ok(()) };
        let beyond = |value: f64| value - limit.value();
        let (mut low, mut high) = ((0.0, beyond(mean)), (1.0, beyond(corner)));
        (kept.share, kept.computed) = (Some(0.0), Some(mean));
        let near = NEAR * beyond(mean).abs();
        let mut last = None;
        for _ in 0..MOST {
            let share = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
            let at: Vec<f64> = end.iter().zip(&self.tolerances).map(|(x, t)| t.mean + share * (x - t.mean)).collect();
            let value = match cases(&at)? {
                Further::Found { curve, .. } => self.value(quantity, &curve),
                Further::Missing => {
                    kept.reason = "not computed yet".to_owned();
                    return Ok(());
                }
                Further::Failed(reason) => {
                    kept.reason = reason;
                    return Ok(());
                }
            };
            let Some(value) = value else {
                kept.reason = "on the way to the corner the quantity is not there".to_owned();
                return Ok(());
            };
            let holds = limit.holds(value);
            if holds {
                (kept.share, kept.computed) = (Some(share), Some(value));
                low = (share, beyond(value));
            } else {
                high = (share, beyond(value));
            }
            if holds && beyond(value).abs() <= near {
                return Ok(());
            }
            match (last, holds) {
                (Some(true), true) => high.1 *= 0.5,
                (Some(false), false) => low.1 *= 0.5,
                _ => {}
            }
            last = Some(holds);
        }
        Ok(())
    }
}
