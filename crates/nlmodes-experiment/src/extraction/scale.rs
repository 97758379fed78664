//! Channels of a wrong scale, a wrong sign or in the wrong place, told by what the others have in common.

use num_complex::Complex64;

use crate::extraction::Finding;
use crate::extraction::consensus::{Common, Consensus};
use crate::records::{Channel, Quantity};

/// Deviations that are reported, over what both sides may be off.
const SIGNIFICANT: f64 = 4.0;
/// Factors within which scales agree.
const SAME_SCALE: f64 = 1.25;
/// Phase from which on a channel counts as reversed, degrees.
const REVERSED_DEG: f64 = 135.0;
/// Relative error up to which a factor is one.
const KNOWN: f64 = 0.5;
/// Logarithm within which a factor is that of a unit.
const LIKE_A_UNIT: f64 = 0.15;

/// The unit in which the numbers of a channel would have to be for its values to be off by `factor`; `spread` is the
/// logarithm by which the factor itself may be off.
pub fn likely_unit(channel: &Channel, factor: f64, spread: f64) -> Option<&'static str> {
    let declared = channel.quantity.factor(&channel.unit)?;
    let off = |of: f64| (factor.abs() * of / declared).ln().abs();
    let others = channel.quantity.units().iter().filter(|(_, of)| *of != declared);
    let (unit, of) = others.min_by(|a, b| off(a.1).total_cmp(&off(b.1)))?;
    (off(*of) < LIKE_A_UNIT.max(3.0 * spread).min(0.5)).then_some(*unit)
}

/// What explains that the responses do not fit.
#[derive(Debug)]
struct Cause {
    /// Rows that are off together.
    rows: Vec<usize>,
    /// Their values over the expected ones.
    ratio: Complex64,
    /// Relative standard error of the ratio.
    error: f64,
    /// What is left without these rows.
    misfit: f64,
}

/// Judges the responses.
#[derive(Debug)]
pub struct Scales<'a> {
    pub consensus: Consensus<'a>,
    pub channels: &'a [Channel],
}

impl Scales<'_> {
    /// Reports the one cause for which responses do not fit together: a channel, all of one quantity or place, two
    /// exchanged ones.
    pub fn report(&self, findings: &mut Vec<Finding>) {
        let n = self.consensus.rows.len();
        let deviates: Vec<f64> = (0..n).map(|i| self.off(i).map_or(0.0, |(deviate, _)| deviate)).collect();
        let Some(worst) = (0..n).max_by(|a, b| deviates[*a].total_cmp(&deviates[*b])) else { return };
        if deviates[worst] <= SIGNIFICANT {
            return;
        }
        let single: Vec<Cause> = (0..n).filter_map(|i| self.cause(vec![i])).collect();
        let causes =
            if single.is_empty() { self.groups().into_iter().filter_map(|g| self.cause(g)).collect() } else { single };
        // Two exchanged channels are each off by a factor too, but hardly by that of a unit.
        let is_slip = causes.iter().any(|cause| self.unit(cause).is_some() || is_reversed(cause.ratio));
        if let Some(exchanged) = (!is_slip).then(|| self.exchanged()).flatten() {
            findings.push(exchanged);
        } else if causes.is_empty() {
            findings.extend(self.unexplained(worst));
        } else {
            self.told(causes, findings);
        }
    }

    /// How far a row is off, and what the others expect of it.
    fn off(&self, row: usize) -> Option<(f64, Common)> {
        let common = self.consensus.common(&self.without(&[row]))?;
        Some((self.consensus.deviate(row, &common), common))
    }

    fn without(&self, rows: &[usize]) -> Vec<usize> {
        (0..self.consensus.rows.len()).filter(|i| !rows.contains(i)).collect()
    }

    /// Whether so many rows fit together.
    fn fits(misfit: f64, rows: usize) -> bool {
        misfit < SIGNIFICANT.powi(2) + rows as f64
    }

    /// These rows as the cause: all others fit, and these are off by a common factor.
    fn cause(&self, rows: Vec<usize>) -> Option<Cause> {
        let others = self.without(&rows);
        let common = self.consensus.common(&others)?;
        if others.is_empty() || !Self::fits(common.misfit, others.len()) {
            return None;
        }
        let ratio = |i: &usize| self.consensus.rows[*i].value / common.expected[*i].0;
        let first = ratio(rows.first()?);
        let alike = |i: &usize| {
            let relative = ratio(i) / first;
            self.consensus.deviate(*i, &common) > SIGNIFICANT
                && relative.norm().ln().abs() < SAME_SCALE.ln()
                && relative.arg().abs() < 1.0
        };
        let error = |i: &usize| common.expected[*i].1 / common.expected[*i].0.norm();
        let n = rows.len() as f64;
        rows.iter().all(alike).then(|| Cause {
            ratio: rows.iter().map(ratio).sum::<Complex64>() / n,
            error: rows.iter().map(error).fold(0.0, f64::max),
            misfit: common.misfit,
            rows,
        })
    }

    /// Rows of one quantity, and of one place.
    fn groups(&self) -> Vec<Vec<usize>> {
        let rows = &self.consensus.rows;
        let quantity = |i: usize| self.channels[rows[i].channel].quantity;
        let of_quantity = |q: Quantity| (0..rows.len()).filter(|i| quantity(*i) == q).collect::<Vec<_>>();
        let of_place = |p: usize| (0..rows.len()).filter(|i| rows[*i].place == p).collect::<Vec<_>>();
        let quantities = [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration].map(of_quantity);
        let places = (0..=rows.iter().map(|row| row.place).max().unwrap_or(0)).map(of_place);
        quantities.into_iter().chain(places).filter(|group| group.len() > 1 && group.len() < rows.len()).collect()
    }

    /// Two channels of one quantity that fit in each other's place.
    fn exchanged(&self) -> Option<Finding> {
        let rows = &self.consensus.rows;
        let all: Vec<usize> = (0..rows.len()).collect();
        let mut best: Option<(f64, [usize; 2])> = None;
        for (i, a) in rows.iter().enumerate() {
            for (j, b) in rows.iter().enumerate().skip(i + 1) {
                if self.channels[a.channel].quantity != self.channels[b.channel].quantity || a.place == b.place {
                    continue;
                }
                let mut swapped = rows.clone();
                (swapped[i].value, swapped[j].value) = (b.value, a.value);
                let swapped = Consensus { rows: swapped, ..self.consensus };
                let misfit = swapped.common(&all).map_or(f64::INFINITY, |common| common.misfit);
                if Self::fits(misfit, rows.len()) && best.is_none_or(|(least, _)| misfit < least) {
                    best = Some((misfit, [i, j]));
                }
            }
        }
        best.map(|(_, pair)| Finding::ExchangedChannels { channels: pair.map(|i| self.name(i)) })
    }

    fn unexplained(&self, worst: usize) -> Option<Finding> {
        let (_, common) = self.off(worst)?;
        let ratio = self.consensus.rows[worst].value / common.expected[worst].0;
        Some(Finding::ShapeDisagrees {
            channel: self.name(worst),
            factor: ratio.norm(),
            degrees: ratio.arg().to_degrees(),
            against: self.against(),
        })
    }

    /// Tells the cause that is most like a slip: a factor between units or a reversed sign, then what leaves least; and
    /// what else it may be.
    fn told(&self, mut causes: Vec<Cause>, findings: &mut Vec<Finding>) {
        let plain = |cause: &Cause| !(self.unit(cause).is_some() || is_reversed(cause.ratio));
        causes.sort_by(|a, b| plain(a).cmp(&plain(b)).then(a.misfit.total_cmp(&b.misfit)));
        let Some((cause, others)) = causes.split_first() else { return };
        // The others are then as they should be, so that they are off by the inverse if this one is not.
        let alternatives: Vec<String> = others.iter().map(|other| self.alternative(other)).collect();
        for row in &cause.rows {
            let channel = self.name(*row);
            let factor = if cause.ratio.re < 0.0 { -cause.ratio.norm() } else { cause.ratio.norm() };
            let (against, alternatives) = (self.against(), alternatives.clone());
            let late = findings
                .iter()
                .any(|finding| matches!(finding, Finding::Skew { channel: known, .. } if *known == channel));
            let twin = self.has_twin(*row);
            let mut alternatives = alternatives;
            if twin {
                alternatives.push("another direction of one sensor".into());
            }
            if factor.abs().ln().abs() > SAME_SCALE.ln() && cause.error < KNOWN {
                findings.push(Finding::WrongScale {
                    channel,
                    factor,
                    uncertainty: factor.abs() * cause.error,
                    against,
                    declared: self.channels[self.consensus.rows[*row].channel].unit.clone(),
                    likely: if twin { None } else { self.unit(cause) },
                    alternatives,
                });
            } else if is_reversed(cause.ratio) {
                findings.push(Finding::ReversedChannel { channel, against, alternatives });
            } else if !late {
                let (factor, degrees) = (cause.ratio.norm(), cause.ratio.arg().to_degrees());
                findings.push(Finding::ShapeDisagrees { channel, factor, degrees, against });
            }
        }
    }

    /// Whether another channel of the same quantity is at the same place: of a triaxial sensor, perhaps.
    fn has_twin(&self, row: usize) -> bool {
        let rows = &self.consensus.rows;
        let quantity = |i: usize| self.channels[rows[i].channel].quantity;
        (0..rows.len()).any(|i| i != row && rows[i].place == rows[row].place && quantity(i) == quantity(row))
    }

    fn unit(&self, cause: &Cause) -> Option<&'static str> {
        let row = &self.consensus.rows[*cause.rows.first()?];
        likely_unit(&self.channels[row.channel], cause.ratio.norm(), cause.error)
    }

    fn alternative(&self, cause: &Cause) -> String {
        let names: Vec<String> = cause.rows.iter().map(|i| format!("\"{}\"", self.name(*i))).collect();
        let names = names.join(", ");
        if is_reversed(cause.ratio) {
            format!("{names}, reversed")
        } else {
            format!("{names}, by a factor of {:.4}", cause.ratio.norm())
        }
    }

    fn name(&self, row: usize) -> String {
        self.channels[self.consensus.rows[row].channel].name.clone()
    }

    fn against(&self) -> String {
        if self.consensus.modes.is_some() {
            "the other channels and the linear modes".into()
        } else {
            "the other channels".into()
        }
    }
}

fn is_reversed(ratio: Complex64) -> bool {
    ratio.norm().ln().abs() < SAME_SCALE.ln() && ratio.arg().abs().to_degrees() > REVERSED_DEG
}
