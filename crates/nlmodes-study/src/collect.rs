//! The existing cases of a study, as a table.

mod band;
mod row;
mod table;

use serde::Serialize;
use serde_json::Value;

use crate::case::{Case, cases};
use crate::first_order::{FirstOrder, stored};
use crate::parallel;
use crate::statistics::{Sample, Statistics};
use crate::store::Store;
use crate::study::Study;
use crate::table::Table;
pub use band::{Band, Drawn};
pub use row::{Row, State};
pub use table::FIXED;

/// Maximum number of branches kept for the page.
const MOST_DRAWN: usize = 1500;

/// Number of cases in each state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counts {
    /// All.
    pub cases: usize,
    /// Complete branches.
    pub complete: usize,
    /// Branches that ended early.
    pub incomplete: usize,
    /// No branch: the scene of the case is rejected, or it cannot be computed.
    pub failed: usize,
    /// Not computed yet.
    pub missing: usize,
    /// Computed, but altered or damaged since.
    pub damaged: usize,
}

/// The existing cases of a study.
#[derive(Debug, Clone)]
pub struct Collected {
    /// One row per case, in the order of the design.
    pub table: Table,
    /// Number of cases in each state.
    pub counts: Counts,
    /// Scatter and sensitivity of each quantity.
    pub statistics: Vec<Statistics>,
    /// What gradients say, where the study asks for it.
    pub first_order: Option<FirstOrder>,
    /// Branches for the page: all, or the maximum number.
    pub drawn: Vec<Drawn>,
    /// Percentiles of the frequency over the energy.
    pub band: Band,
}

impl Collected {
    /// Reads the existing cases. Missing cases have a row with this state.
    pub fn new(study: &Study, threads: usize) -> Self {
        let cases = cases(study, threads);
        let store = Store::new(&study.directory);
        let rows = rows(study, &store, &cases, threads);
        let table = table::table(study, &cases, &rows);
        let mut counts = Counts { cases: rows.len(), ..Counts::default() };
        rows.iter().for_each(|row| counts.take(row.state));
        let statistics: Vec<Statistics> = study
            .quantities
            .iter()
            .enumerate()
            .map(|(k, quantity)| {
                let own = Statistics::new(study, &table, &cases, &quantity.name);
                if study.design.expansion { own.with_expansion(study, &samples(&cases, &rows, k)) } else { own }
            })
            .collect();
        // What is in the store already, nothing is written.
        let mut there = |values: &[f64]| Ok(stored(study, &store, values));
        let first_order = FirstOrder::of(study, &statistics, &mut there).unwrap_or_default();
        let drawn: Vec<Drawn> = rows.into_iter().flat_map(|row| row.drawn).collect();
        let band = Band::new(&drawn);
        Self { table, counts, statistics, first_order, drawn, band }
    }
}

impl Counts {
    fn take(&mut self, state: State) {
        *match state {
            State::Complete => &mut self.complete,
            State::Incomplete => &mut self.incomplete,
            State::Failed => &mut self.failed,
            State::Missing => &mut self.missing,
            State::Damaged => &mut self.damaged,
        } += 1;
    }
}

/// How many cases are in which state, without reading their branches.
pub fn status(study: &Study, threads: usize) -> Counts {
    let store = Store::new(&study.directory);
    let cases = cases(study, threads);
    let mut counts = Counts { cases: cases.len(), ..Counts::default() };
    cases.iter().for_each(|case| counts.take(row::state(&store, case).0));
    counts
}

/// The cases that have quantity k, with its derivatives; none where points have several methods.
fn samples(cases: &[Case], rows: &[Row], k: usize) -> Vec<Sample> {
    if cases.iter().any(|case| case.part > 0) {
        return Vec::new();
    }
    let of = |(case, row): (&Case, &Row)| {
        let [value, _] = row.values[k]?;
        let x = case.values.iter().map(Value::as_f64).collect::<Option<_>>()?;
        Some(Sample { x, value, slope: row.slopes[k].clone() })
    };
    cases.iter().zip(rows).filter_map(of).collect()
}

fn rows(study: &Study, store: &Store, cases: &[Case], threads: usize) -> Vec<Row> {
    let every = cases.len().div_ceil(MOST_DRAWN).max(1);
    parallel::each(cases.len(), threads, |k| Row::read(study, store, &cases[k], k.is_multiple_of(every)))
}
