//! Samples that a recorder lost, or has twice: the phase of all periods behind them is off by a whole number of
//! samples.

use crate::extraction::HarmonicFit;
use crate::extraction::measured::wrapped;

/// Periods of a block.
const PERIODS: f64 = 1.0;
/// Fewest blocks that tell a step from a drift.
const FEWEST: usize = 8;
/// Harmonics of a block.
const HARMONICS: usize = 12;
/// Standard errors that a step must have.
const SIGNIFICANT: f64 = 8.0;
/// Part of a sample by which a step may be off a whole number of them.
const WHOLE: f64 = 0.2;
/// Share of what a smooth drift leaves that a step may leave.
const EXPLAINS: f64 = 0.35;

/// A place where samples are lost.
#[derive(Debug, Clone, PartialEq)]
pub struct Loss {
    /// The samples among which they are lost, two blocks.
    pub place: std::ops::Range<usize>,
    /// How many, but for whole periods; negative where samples occur twice.
    pub samples: f64,
}

/// Finds a loss in a signal whose phase advances by about `step` (rad) from sample to sample.
pub fn find(signal: &[f64], step: f64) -> Option<Loss> {
    let first = of_periods(signal, step)?;
    // A loss spoils the frequency of the whole record, hardly that of most of its periods.
    let mut advances: Vec<f64> = first.phases.windows(2).map(|pair| pair[1] - pair[0]).collect();
    advances.sort_by(f64::total_cmp);
    let step = step + advances.get(advances.len() / 2)? / first.per_block as f64;
    let Periods { phases, per_block } = of_periods(signal, step)?;
    let (k, samples) = in_phases(&phases, step)?;
    let place = (k - usize::from(k > 0)) * per_block..((k + 2) * per_block).min(signal.len());
    Some(Loss { place, samples })
}

/// Phases of the fundamental, each against its course at a constant frequency.
struct Periods {
    phases: Vec<f64>,
    /// Samples from one to the next.
    per_block: usize,
}

fn of_periods(signal: &[f64], step: f64) -> Option<Periods> {
    let per_block = (PERIODS * std::f64::consts::TAU / step).round() as usize;
    let harmonics = HARMONICS.min((0.4 * std::f64::consts::TAU / step) as usize);
    let n = signal.len().checked_div(per_block)?;
    if n < FEWEST || harmonics == 0 {
        return None;
    }
    let fit = HarmonicFit::new(harmonics, step, per_block).ok()?;
    let blocks: Vec<&[f64]> = signal.chunks_exact(per_block).collect();
    let found = fit.coefficients(&blocks);
    let phases = unwrapped(found.iter().enumerate().map(|(k, q)| q[1].arg() - step * (k * per_block) as f64));
    Some(Periods { phases, per_block })
}

/// Phases without the jumps of full turns.
pub fn unwrapped(phases: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for phase in phases {
        let before = found.last().copied().unwrap_or(0.0);
        found.push(before + wrapped(phase - before));
    }
    found
}

/// The block within which the phase steps by a whole number of samples, and that number: samples that are lost, or,
/// below zero, occur twice; `step` is the advance of the phase (rad) from sample to sample.
pub fn in_phases(phases: &[f64], step: f64) -> Option<(usize, f64)> {
    let n = phases.len();
    if n < FEWEST {
        return None;
    }
    let (k, height, error, left) = (1..n - 1).filter_map(|k| Some((k, stepped(phases, k)?))).fold(
        (0, 0.0, 0.0, f64::INFINITY),
        |best, (k, (height, error, left))| if left < best.3 { (k, height, error, left) } else { best },
    );
    let samples = height / step;
    let is_whole = samples.abs() > 0.5 && (samples - samples.round()).abs() < WHOLE;
    let is_sure = height.abs() > SIGNIFICANT * error && left < EXPLAINS * smooth(phases);
    (is_whole && is_sure && k > 0).then(|| (k, samples.round()))
}

/// The best line with a step within block `k`, which itself is left out: height of the step, its standard error, root
/// mean square of what is left.
fn stepped(phases: &[f64], k: usize) -> Option<(f64, f64, f64)> {
    let rows: Vec<(Vec<f64>, f64)> = phases
        .iter()
        .enumerate()
        .filter(|(j, _)| *j != k)
        .map(|(j, phase)| (vec![1.0, j as f64, if j > k { 1.0 } else { 0.0 }], *phase))
        .collect();
    let (found, errors, left) = least_squares(&rows)?;
    Some((found[2], errors[2], left))
}

/// Root mean square of what a cubic leaves.
fn smooth(phases: &[f64]) -> f64 {
    let n = phases.len() as f64;
    let powers = |j: usize| (0..4).map(|p| (2.0 * j as f64 / n - 1.0).powi(p)).collect::<Vec<f64>>();
    let rows: Vec<(Vec<f64>, f64)> = phases.iter().enumerate().map(|(j, phase)| (powers(j), *phase)).collect();
    least_squares(&rows).map_or(0.0, |(_, _, left)| left)
}

/// Solution, standard errors, and the root mean square of what is left with the degrees of freedom.
pub fn least_squares(rows: &[(Vec<f64>, f64)]) -> Option<(Vec<f64>, Vec<f64>, f64)> {
    let m = rows.first()?.0.len();
    let matrix = nalgebra::DMatrix::from_fn(rows.len(), m, |i, j| rows[i].0[j]);
    let side = nalgebra::DVector::from_iterator(rows.len(), rows.iter().map(|row| row.1));
    let normal = (matrix.transpose() * &matrix).cholesky()?;
    let found = normal.solve(&(matrix.transpose() * &side));
    let freedom = rows.len().checked_sub(m).filter(|freedom| *freedom > 0)?;
    let left = ((side - &matrix * &found).norm_squared() / freedom as f64).sqrt();
    let inverse = normal.inverse();
    let errors = (0..m).map(|i| left * inverse[(i, i)].max(0.0).sqrt()).collect();
    Some((found.iter().copied().collect(), errors, left))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn signal(n: usize, rate: f64) -> Vec<f64> {
        let wave = |t: f64| (TAU * 41.3 * t).cos() + 0.3 * (2.0 * TAU * 41.3 * t + 1.0).cos();
        (0..n).map(|j| wave(j as f64 / rate) + 1e-4 * ((j * j) as f64 * 0.7).sin()).collect()
    }

    #[test]
    fn lost_and_doubled_samples_are_found_and_counted() {
        for rate in [5120.0, 20_480.0] {
            let step = TAU * 41.3 / rate;
            for (at, lost) in [(2000, 1), (6001, 1), (5000, 3)] {
                let mut record = signal(9000, rate);
                record.drain(at..at + lost);
                // The frequency is biased by the loss.
                let found = find(&record, step * (1.0 + 2e-4)).unwrap();
                assert_eq!(found.samples, lost as f64);
                assert!(found.place.contains(&at), "{found:?}");
            }
            let mut record = signal(9000, rate);
            record.insert(4000, record[3999]);
            assert_eq!(find(&record, step).unwrap().samples, -1.0);
            assert_eq!(find(&signal(9000, rate), step), None);
        }
    }

    #[test]
    fn a_frequency_that_drifts_or_jumps_is_no_loss() {
        let rate = 10_000.0;
        for jump in [false, true] {
            let phase = |t: f64| 41.3 * t + if jump { 0.05 * (t - 0.5).max(0.0) } else { 0.02 * t * t };
            let record: Vec<f64> = (0..10_000).map(|j| (TAU * phase(f64::from(j) / rate)).cos()).collect();
            assert_eq!(find(&record, TAU * 41.32 / rate), None, "{jump}");
        }
    }
}
