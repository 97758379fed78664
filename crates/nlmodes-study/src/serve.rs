//! Cases requested by another program: a line of JSON in, a line out.

use std::io::{self, BufRead, Write};
use std::sync::{Mutex, MutexGuard, PoisonError, mpsc};
use std::thread;

use serde_json::{Map, Value, json};

use crate::error::StudyError;
use crate::evaluate::Evaluator;
use crate::run::Settings;
use crate::study::Study;

/// Answers line by line until there are no more requests, or the answers are no longer read; with the number of
/// parallel cases in the settings, in order of completion.
///
/// A line is `{"id": …, "set": {"gap_m": 1e-3}}`, or the values alone; names are those of the study's variables, or
/// keys of `--set`. Its answer has `id`, `status`, `reason`, `quantities` and `case`.
///
/// # Errors
/// [`StudyError`] if a case cannot be written, since the next one could not either; earlier results remain.
pub fn serve(
    study: &Study,
    settings: Settings,
    lines: impl BufRead,
    out: &mut (impl Write + Send),
) -> Result<(), StudyError> {
    let evaluator = Evaluator::new(study.clone(), settings);
    let (sender, receiver) = mpsc::channel::<String>();
    let (receiver, out, failure) = (Mutex::new(receiver), Mutex::new(out), Mutex::new(None));
    thread::scope(|scope| {
        for _ in 0..settings.jobs() {
            scope.spawn(|| {
                while let Some(line) = next(&receiver) {
                    let (said, error) = match answer(&evaluator, &line) {
                        Ok(said) => (said, None),
                        Err(error) => (failed(&error.to_string()), Some(error)),
                    };
                    let is_read = write(&mut **held(&out), &said).is_ok();
                    if error.is_some() || !is_read {
                        held(&failure).get_or_insert(error);
                        return evaluator.end();
                    }
                }
            });
        }
        for line in lines.lines().map_while(Result::ok) {
            let is_over = held(&failure).is_some();
            if is_over || !line.trim().is_empty() && sender.send(line).is_err() {
                break;
            }
        }
        drop(sender);
    });
    match failure.into_inner().unwrap_or_else(PoisonError::into_inner).flatten() {
        Some(error) => Err(error),
        None => Ok(()),
    }
}

/// The next line, for the first free worker.
fn next(lines: &Mutex<mpsc::Receiver<String>>) -> Option<String> {
    held(lines).recv().ok()
}

/// The answer to a line.
fn answer(evaluator: &Evaluator, line: &str) -> Result<Value, StudyError> {
    let (id, set) = match serde_json::from_str::<Value>(line) {
        Ok(Value::Object(mut asked)) => match asked.remove("set") {
            Some(Value::Object(set)) => (asked.remove("id"), set),
            Some(_) => return Ok(failed("`set` is no object: expected {\"set\": {\"contact.0.gap_m\": 1e-3}}")),
            None => (asked.remove("id"), asked),
        },
        Ok(_) => return Ok(failed("expected an object: {\"set\": {\"contact.0.gap_m\": 1e-3}}")),
        Err(error) => return Ok(failed(&format!("the line is not JSON: {error}"))),
    };
    let mut said = Map::new();
    said.extend(id.map(|id| ("id".to_owned(), id)));
    match evaluator.evaluate(&set)? {
        None => said.extend([("status".to_owned(), Value::from("ended"))]),
        Some(answer) => {
            said.insert("status".into(), answer.status.into());
            said.insert("reason".into(), answer.reason.into());
            said.insert("quantities".into(), Value::Object(answer.quantities));
            said.insert("case".into(), answer.id.into());
        }
    }
    Ok(Value::Object(said))
}

fn failed(reason: &str) -> Value {
    json!({ "status": "failed", "reason": reason })
}

fn write(out: &mut impl Write, answer: &Value) -> io::Result<()> {
    writeln!(out, "{answer}")?;
    out.flush()
}

/// The contents, even if a thread panicked while holding the lock.
fn held<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
