//! The time that channels have in common which begin at different instants.

use crate::records::{Channel, Column, RecordError, Remark, SampleRate};

/// Largest error of a difference of starts, over the sampling interval, with which channels can be put side by side.
const SURE: f64 = 0.1;

/// When the first sample of a column was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Time, s.
    pub at: f64,
    /// Largest error that the digits leave with which it was written, s.
    pub rounding: f64,
}

/// Cuts columns that begin at different instants to the time that all of them have. What is less than a sampling
/// interval becomes a delay of the channel. Columns without a start, and those that all begin at once, stay.
///
/// # Errors
/// [`RecordError::StartsUncertain`] if the starts have too few digits, [`RecordError::NoCommonTime`].
pub fn cut(picked: &mut [(Channel, Column)], rate: SampleRate, remarks: &mut Vec<Remark>) -> Result<(), RecordError> {
    let starts: Option<Vec<Start>> = picked.iter().map(|(_, column)| column.start).collect();
    let Some(starts) = starts.filter(|starts| starts.iter().any(|start| start.at != starts[0].at)) else {
        return Ok(());
    };
    let by_start = |a: &usize, b: &usize| starts[*a].at.total_cmp(&starts[*b].at);
    let (Some(first), Some(last)) = ((0..starts.len()).min_by(by_start), (0..starts.len()).max_by(by_start)) else {
        return Ok(());
    };
    let named = |i: usize| (picked[i].0.name.clone(), starts[i].at);
    let ((channel, start), (first, first_start)) = (named(last), named(first));
    let mut shifts = Vec::with_capacity(starts.len());
    for own in &starts {
        shifts.push(shift(*own, starts[last], rate.hz).ok_or_else(|| RecordError::StartsUncertain {
            channel: channel.clone(),
            start,
            first: first.clone(),
            first_start,
            rounding: own.rounding + starts[last].rounding,
        })?);
    }
    let left = |(i, (whole, _)): (usize, &(usize, f64))| picked[i].1.values.len().saturating_sub(*whole);
    let samples = shifts.iter().enumerate().map(left).min().unwrap_or(0);
    if samples < 2 {
        return Err(RecordError::NoCommonTime { channel, start, first, first_start });
    }
    // Most channels are sampled at once: what they have in common is no delay.
    let common = median(shifts.iter().map(|(_, part)| *part).collect());
    for ((channel, column), (whole, part)) in picked.iter_mut().zip(&shifts) {
        column.values.drain(..*whole);
        column.values.truncate(samples);
        // A sample that was taken later than its neighbours shows what they show later: it is early.
        channel.delay -= part - common;
    }
    if shifts.iter().any(|(whole, _)| *whole > 0) {
        remarks.push(Remark::StartsDiffer { channel, start, first, first_start, samples });
    }
    Ok(())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Whole samples to leave out so that a column begins with the last one, and by how much (s) its first sample is then
/// later; `None` if that is not known well enough.
fn shift(own: Start, last: Start, rate: f64) -> Option<(usize, f64)> {
    let rounding = (own.rounding + last.rounding) * rate;
    let samples = (last.at - own.at) * rate;
    if samples != 0.0 && rounding > SURE {
        return None;
    }
    let whole = samples.round();
    let part = whole - samples;
    // Of the digits alone there is no delay.
    let part = if part.abs() <= rounding + 1e-6 { 0.0 } else { part / rate };
    (0.0..1e12).contains(&whole).then_some((whole as usize, part))
}
