//! State and results of one case.

use super::Drawn;
use crate::case::Case;
use crate::curve::{Curve, Picked, pick};
use crate::first_order::slope;
use crate::store::{CaseRecord, Status, Store, branch_sha256};
use crate::study::Study;

/// State of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Its branch is complete.
    Complete,
    /// Its branch ended early.
    Incomplete,
    /// It has no branch; the reason is given.
    Failed,
    /// It is not computed yet.
    Missing,
    /// It was computed, but altered or damaged since.
    Damaged,
}

impl State {
    /// Its name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Complete => Status::Complete.name(),
            Self::Incomplete => Status::Incomplete.name(),
            Self::Failed => Status::Failed.name(),
            Self::Missing => "missing",
            Self::Damaged => "damaged",
        }
    }
}

impl From<Status> for State {
    fn from(status: Status) -> Self {
        match status {
            Status::Complete => Self::Complete,
            Status::Incomplete => Self::Incomplete,
            Status::Failed => Self::Failed,
        }
    }
}

/// The row of a case.
#[derive(Debug, Clone)]
pub struct Row {
    pub state: State,
    /// Why it has no branch, why the branch ended early, or which quantity is missing; otherwise empty.
    pub reason: String,
    /// Value and estimated error of each quantity.
    pub values: Vec<Option<[f64; 2]>>,
    /// Derivatives of each by the variables, where the cases are differentiated and it has them.
    pub slopes: Vec<Option<Vec<f64>>>,
    pub points: Option<usize>,
    /// Its curves as drawn; none where they are not.
    pub drawn: Vec<Drawn>,
}

/// State of a case, with its record or the reason why there is none.
pub fn state(store: &Store, case: &Case) -> (State, Result<CaseRecord, String>) {
    match &case.id {
        Err(reason) => (State::Failed, Err(reason.to_string())),
        Ok(id) => match store.record(id) {
            Some(record) => (record.status.into(), Ok(record)),
            None => (State::Missing, Err("not computed yet".to_owned())),
        },
    }
}

impl Row {
    /// Reads the results of a case, with its curve if it is to be drawn.
    pub fn read(study: &Study, store: &Store, case: &Case, drawn: bool) -> Self {
        let (state, record) = state(store, case);
        let empty = |state, reason| Self {
            state,
            reason,
            values: vec![None; study.quantities.len()],
            slopes: vec![None; study.quantities.len()],
            points: None,
            drawn: Vec::new(),
        };
        let (record, id) = match (record, &case.id) {
            (Ok(record), Ok(id)) if record.status != Status::Failed => (record, id),
            (Ok(record), _) => return empty(state, record.reason),
            (Err(reason), _) => return empty(state, reason),
        };
        let directory = store.case(id);
        if branch_sha256(&directory) != record.branch_sha256 {
            let reason = format!("branch.csv is not what was computed; remove {} and run again", directory.display());
            return empty(State::Damaged, reason);
        }
        match Curve::read(&directory) {
            Ok(curve) => Self::of_curve(study, case, state, &record, &curve, drawn),
            Err(error) => empty(State::Damaged, error.to_string()),
        }
    }

    fn of_curve(study: &Study, case: &Case, state: State, record: &CaseRecord, curve: &Curve, drawn: bool) -> Self {
        let mut reasons = Vec::new();
        if state == State::Incomplete {
            reasons.push(record.reason.clone());
        }
        let values = study.quantities.iter().map(|quantity| match pick(curve, quantity) {
            Picked::Value { value, error } => Some([value, error]),
            Picked::Missing(reason) => {
                reasons.push(reason);
                None
            }
        });
        let values = values.collect();
        let is_differentiated = study.design.is_differentiated();
        let slope = |quantity| is_differentiated.then(|| slope(study, quantity, curve).ok()).flatten();
        let slopes = study.quantities.iter().map(slope).collect();
        let drawn = if drawn { Drawn::of(case.number, curve) } else { Vec::new() };
        Self { state, reason: reasons.join(" | "), values, slopes, points: Some(curve.len()), drawn }
    }
}
