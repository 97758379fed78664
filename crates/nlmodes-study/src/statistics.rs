//! Scatter and sensitivity of a quantity.

mod expansion;
mod independent;
mod ranks;
mod sobol;
mod spread;

use expansion::expansion;
pub use expansion::{Expansion, Polynomials, Sample};
use independent::independence;
pub use ranks::{Correlation, rank_correlation};
pub use sobol::{SobolIndex, sobol_indices};
pub use spread::{Spread, quantile};

use serde::Serialize;

use crate::case::Case;
use crate::study::Study;
use crate::table::{Table, error_column};

/// Scatter and sensitivity of a quantity, for the cases that have it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statistics {
    /// Its name.
    pub quantity: String,
    /// Number of cases that do not have it.
    pub without: usize,
    /// Mean, standard deviation, quantiles; `None` if no case has it.
    pub spread: Option<Spread>,
    /// Whether its whole spread is below the error of the computation: it depends on none of the variables there.
    pub does_not_vary: bool,
    /// Variables over whose range it changes by less than a thousandth of its spread.
    pub does_not_depend_on: Vec<String>,
    /// Rank correlation with each numerical variable.
    pub rank_correlations: Vec<Sensitivity<Correlation>>,
    /// What the Sobol' indices are from, where not from blocks of the design.
    pub expansion: Option<Expansion>,
    /// Sobol' indices of each variable, if the design has the points or the gradients for them.
    pub sobol_indices: Vec<Sensitivity<SobolIndex>>,
    /// Blocks of the design that are excluded from the indices, because a case in them does not have the quantity.
    pub blocks_left_out: usize,
}

/// A measure of the influence of a variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivity<T> {
    /// The variable.
    pub variable: String,
    /// The measure.
    #[serde(flatten)]
    pub measure: T,
}

impl Statistics {
    /// Statistics of a column of the table.
    pub fn new(study: &Study, table: &Table, cases: &[Case], quantity: &str) -> Self {
        let all = table.column(quantity).and_then(crate::table::Cells::numbers).unwrap_or_default();
        let first: Vec<bool> = cases.iter().map(|case| case.part == 0).collect();
        // The additional points of the design for Sobol' indices are not independent.
        let block = study.variables.len() + 2;
        let independent = |k: usize| !study.design.sobol_indices || cases[k].point % block < 2;
        let own: Vec<Option<f64>> = (0..all.len()).map(|k| all[k].filter(|_| independent(k))).collect();
        let there: Vec<f64> = own.iter().flatten().copied().collect();
        let mut statistics = Self {
            quantity: quantity.to_owned(),
            without: all.iter().filter(|cell| cell.is_none()).count(),
            spread: Spread::new(&there),
            does_not_vary: false,
            does_not_depend_on: Vec::new(),
            rank_correlations: Vec::new(),
            expansion: None,
            sobol_indices: Vec::new(),
            blocks_left_out: 0,
        };
        for variable in &study.variables {
            let Some(x) = table.column(&variable.name).and_then(crate::table::Cells::numbers) else { continue };
            let pairs: Vec<[f64; 2]> = x.iter().zip(&own).filter_map(|(x, y)| Some([(*x)?, (*y)?])).collect();
            if let Some(measure) = rank_correlation(&pairs) {
                statistics.rank_correlations.push(Sensitivity { variable: variable.name.clone(), measure });
            }
        }
        statistics.judge_independence(study, table, &own);
        let one_part = first.iter().all(|first| *first);
        if study.design.sobol_indices && one_part {
            let (found, left_out) = sobol_indices(&all, study.variables.len(), study.design.seed);
            statistics.sobol_indices = named(study, found);
            statistics.blocks_left_out = left_out;
        }
        statistics
    }

    /// The same with the Sobol' indices of an expansion that is fitted to cases and their gradients.
    pub fn with_expansion(mut self, study: &Study, cases: &[Sample]) -> Self {
        let bases = study.variables.iter().map(|variable| Polynomials::of(variable, &study.design).ok());
        let found = bases.collect::<Option<Vec<_>>>().and_then(|bases| expansion(&bases, cases));
        let Some((own, indices)) = found.filter(|_| !self.does_not_vary) else { return self };
        self.sobol_indices = named(study, indices);
        self.expansion = Some(own);
        self
    }

    /// Says on which variables the quantity does not depend.
    fn judge_independence(&mut self, study: &Study, table: &Table, own: &[Option<f64>]) {
        let numbers = |name: &str| table.column(name).and_then(crate::table::Cells::numbers);
        let named: Vec<(&str, Vec<Option<f64>>)> =
            study.variables.iter().filter_map(|v| Some((v.name.as_str(), numbers(&v.name)?))).collect();
        let errors = numbers(&error_column(&self.quantity)).unwrap_or_default();
        let is_whole =
            |k: &usize| own[*k].is_some() && named.iter().all(|(_, x)| x.get(*k).copied().flatten().is_some());
        let rows: Vec<usize> = (0..own.len()).filter(is_whole).collect();
        let of = |cells: &[Option<f64>]| -> Vec<f64> {
            rows.iter().map(|&k| cells.get(k).copied().flatten().unwrap_or(0.0)).collect()
        };
        let x: Vec<Vec<f64>> = named.iter().map(|(_, cells)| of(cells)).collect();
        let found = independence(&x, &of(own), &of(&errors));
        self.does_not_vary = found.of_all;
        self.does_not_depend_on = found.of.iter().map(|v| named[*v].0.to_owned()).collect();
    }
}

/// A measure of each variable.
fn named<T>(study: &Study, measures: Vec<T>) -> Vec<Sensitivity<T>> {
    let all = study.variables.iter().zip(measures);
    all.map(|(variable, measure)| Sensitivity { variable: variable.name.clone(), measure }).collect()
}
