//! Further cases of a study from its store.

use serde_json::Value;

use super::Further;
use crate::case::{Resolved, overrides, resolve_differentiated};
use crate::curve::Curve;
use crate::store::{Status, Store};
use crate::study::Study;

/// What the store has of the case with these values.
pub fn stored(study: &Study, store: &Store, values: &[f64]) -> Further {
    match resolved(study, values) {
        Ok(case) => read(store, &case.id),
        Err(reason) => Further::Failed(reason),
    }
}

/// The scene of a case, of which there is one.
///
/// # Errors
/// Why there is none, in words.
pub fn resolved(study: &Study, values: &[f64]) -> Result<Resolved, String> {
    let keys = study.variables.iter().zip(values);
    let point: Vec<Vec<Value>> = keys.map(|(one, value)| vec![Value::from(*value); one.keys.len()]).collect();
    let parts = resolve_differentiated(study, overrides(study, &point)).map_err(|refused| refused.sentence())?;
    let one = <[Resolved; 1]>::try_from(parts);
    one.map(|[resolved]| resolved).map_err(|_| "the scene has several methods or numbers of harmonics".to_owned())
}

/// A case of the store.
pub fn read(store: &Store, id: &str) -> Further {
    let Some(record) = store.record(id) else { return Further::Missing };
    if record.status == Status::Failed {
        return Further::Failed(record.reason);
    }
    match Curve::read(&store.case(id)) {
        Ok(curve) => Further::Found { id: id.to_owned(), curve: Box::new(curve) },
        Err(error) => Further::Failed(error.to_string()),
    }
}
