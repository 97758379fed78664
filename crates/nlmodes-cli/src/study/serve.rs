//! `nlmodes-cli study serve`: a line of JSON for each case that is wanted, a line for each that is there.

use std::io::{self, BufRead, Write};
use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;

use clap::Args;
use nlmodes_study::{Evaluator, Settings};
use serde_json::{Map, Value, json};

use super::Place;
use super::run::refused;
use crate::Status;

/// What stands on the command line.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    place: Place,
    /// Cases at a time [default: as many as the machine has cores]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
}

/// Answers until there are no more lines.
pub fn serve(arguments: &Arguments) -> Status {
    arguments.place.with(|study| {
        let settings = Settings { jobs: arguments.jobs, ..Settings::default() };
        let evaluator = Evaluator::new(study.clone(), settings);
        let (sender, receiver) = mpsc::channel::<String>();
        let lines = Mutex::new(receiver);
        let status = Mutex::new(Status::Done);
        thread::scope(|scope| {
            for _ in 0..settings.jobs() {
                scope.spawn(|| answer_all(&evaluator, &lines, &status));
            }
            for line in io::stdin().lock().lines().map_while(Result::ok) {
                if !line.trim().is_empty() && sender.send(line).is_err() {
                    break;
                }
            }
            drop(sender);
        });
        status.into_inner().unwrap_or_else(PoisonError::into_inner)
    })
}

/// Takes one line after the other and prints its answer, in the order in which they are done.
fn answer_all(evaluator: &Evaluator, lines: &Mutex<mpsc::Receiver<String>>, status: &Mutex<Status>) {
    loop {
        let line = lines.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok(line) = line else { return };
        match answer(evaluator, &line) {
            Ok(answer) if said(&answer) => {}
            Ok(_) => return evaluator.end(),
            Err(error) => {
                *status.lock().unwrap_or_else(PoisonError::into_inner) = refused(&error);
                said(&json!({ "status": "failed", "reason": error.to_string() }));
                return evaluator.end();
            }
        }
    }
}

/// The answer to a line: `{"id": …, "set": {"gap_m": 1e-3}}`, or the values alone.
fn answer(evaluator: &Evaluator, line: &str) -> Result<Value, nlmodes_study::StudyError> {
    let wrong = |reason: String| json!({ "status": "failed", "reason": reason });
    let (id, set) = match serde_json::from_str::<Value>(line) {
        Ok(Value::Object(mut asked)) => match asked.remove("set") {
            Some(Value::Object(set)) => (asked.remove("id"), set),
            Some(_) => return Ok(wrong("`set` is no object: expected {\"set\": {\"contact.0.gap_m\": 1e-3}}".into())),
            None => (asked.remove("id"), asked),
        },
        Ok(_) => return Ok(wrong("expected an object: {\"set\": {\"contact.0.gap_m\": 1e-3}}".into())),
        Err(error) => return Ok(wrong(format!("the line is not JSON: {error}"))),
    };
    let answer = evaluator.evaluate(&set)?;
    let mut said = Map::new();
    said.extend(id.map(|id| ("id".to_owned(), id)));
    match answer {
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

/// Whether somebody read the line.
fn said(answer: &Value) -> bool {
    let mut out = io::stdout().lock();
    writeln!(out, "{answer}").and_then(|()| out.flush()).is_ok()
}
