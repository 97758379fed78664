//! `nlmodes.Study`: the cases of a study, and the table of what there is.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use nlmodes_scene::SceneError;
use nlmodes_scene::memory::Limit;
use nlmodes_study::{
    Collected, Counts, Evaluator, FitError, Settings, Shard, StudyError, StudyFile, StudyObserver, StudyOutcome,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde_json::{Map, Value};

use crate::errors;
use crate::looking::Looking;
use crate::scene::Source;

/// Time between two looks at Python while a case is computed.
const LOOK: Duration = Duration::from_millis(50);

/// A study that was read and checked.
#[pyclass(frozen, module = "nlmodes._native")]
pub struct Study {
    study: nlmodes_study::Study,
    /// What looks wrong with it.
    #[pyo3(get)]
    warnings: Vec<String>,
    evaluator: Mutex<Evaluator>,
}

fn evaluator(study: &nlmodes_study::Study) -> Evaluator {
    Evaluator::new(study.clone(), Settings::default())
}

fn read(source: &Source, scene: Option<&str>) -> Result<StudyFile, SceneError> {
    use nlmodes_study::Study;
    match (source, scene) {
        (Source::Text(name, text), Some(scene)) => Study::parse_with_scene(name, text, scene),
        (Source::Text(name, text), None) => Study::parse(name, text),
        (Source::File(path), _) => Study::load(path),
    }
}

#[pymethods]
impl Study {
    /// `scene` is the text of the scene, where that is in no file; `out` the directory, `scratch` one for studies that
    /// name none.
    #[new]
    fn new(
        py: Python<'_>,
        source: Source,
        scene: Option<String>,
        out: Option<PathBuf>,
        scratch: Option<PathBuf>,
    ) -> PyResult<Self> {
        let file = errors::computed(py, || read(&source, scene.as_deref()))?;
        let file = file.map_err(|refused| errors::refused(py, &refused))?;
        let warnings = file.warning_sentences();
        let names_directory = file.document.place("output.directory").is_some();
        let mut study = file.scene;
        if let Some(directory) = out.or(scratch.filter(|_| !names_directory)) {
            study.directory = directory;
        }
        Ok(Self { evaluator: Mutex::new(evaluator(&study)), warnings, study })
    }

    #[getter]
    fn directory(&self) -> PathBuf {
        self.study.directory.clone()
    }

    #[getter]
    fn title(&self) -> &str {
        &self.study.title
    }

    #[getter]
    fn variables(&self) -> Vec<&str> {
        self.study.variables.iter().map(|variable| variable.name.as_str()).collect()
    }

    #[getter]
    fn quantities(&self) -> Vec<&str> {
        self.study.quantities.iter().map(|quantity| quantity.name.as_str()).collect()
    }

    /// Names of all cases; those whose scene is refused have none.
    fn ids(&self, py: Python<'_>) -> PyResult<Vec<Option<String>>> {
        let cases = errors::computed(py, || nlmodes_study::case::cases(&self.study, jobs(None)))?;
        Ok(cases.into_iter().map(|case| case.id.ok()).collect())
    }

    /// Computes what is not there yet.
    #[expect(clippy::too_many_arguments, reason = "those of the method of Python")]
    fn run(
        &self,
        py: Python<'_>,
        jobs: Option<NonZeroUsize>,
        shard: &str,
        retry: bool,
        drawn: bool,
        memory_limit: Option<&str>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let wrong = |name: &'static str| move |reason: String| PyValueError::new_err(format!("{name}: {reason}"));
        let shard = shard.parse::<Shard>().map_err(wrong("shard"))?;
        let memory_limit = memory_limit.map(str::parse::<Limit>).transpose().map_err(wrong("memory_limit"))?;
        let settings = Settings { jobs, shard, retry, drawn, memory_limit };
        let mut onlooker = Onlooker(Looking::new(progress));
        let outcome = errors::computed(py, || nlmodes_study::run(&self.study, &settings, &mut onlooker))?;
        let Onlooker(looking) = onlooker;
        looking.look();
        if let Some(error) = looking.raised() {
            return Err(error);
        }
        outcome.map(drop).map_err(|error| raise(py, &error))
    }

    /// Table (as CSV), counts, and statistics (as JSON) of what there is; table, figures and page are written too if
    /// they are wanted.
    fn collect<'py>(
        &self,
        py: Python<'py>,
        written: bool,
    ) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyDict>, String)> {
        let made = errors::computed(py, || {
            let collected = Collected::new(&self.study, jobs(None));
            if written { collected.write(&self.study).map(|()| collected) } else { Ok(collected) }
        })?;
        let collected = made.map_err(|error| raise(py, &error))?;
        let statistics = serde_json::to_string(&collected.statistics).unwrap_or_default();
        Ok((PyBytes::new(py, &collected.table.to_csv()), counts(py, &collected.counts)?, statistics))
    }

    /// How many cases are in which state.
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = errors::computed(py, || nlmodes_study::status(&self.study, jobs(None)))?;
        counts(py, &found)
    }

    /// Fits the variables to the measured points and writes what was found: its `fit.json`, and `fit.csv` beside it.
    fn fit(&self, py: Python<'_>, memory_limit: Option<&str>) -> PyResult<(String, PathBuf)> {
        let wrong = |reason: String| PyValueError::new_err(format!("memory_limit: {reason}"));
        let memory_limit = memory_limit.map(str::parse::<Limit>).transpose().map_err(wrong)?;
        let settings = Settings { memory_limit, ..Settings::default() };
        let mut onlooker = Onlooker(Looking::new(None));
        let found = errors::computed(py, || nlmodes_study::fit(&self.study, &settings, &mut onlooker))?;
        let Onlooker(looking) = onlooker;
        looking.look();
        if let Some(error) = looking.raised() {
            return Err(error);
        }
        let found = found.map_err(|error| match &error {
            FitError::Study(error) => raise(py, error),
            FitError::NothingMeasured | FitError::Few { .. } | FitError::Start { .. } => {
                errors::scene_error(py, &nlmodes_run::chain(&error))
            }
            _ => errors::run_error(py, &nlmodes_run::chain(&error)),
        })?;
        found.write(&self.study).map_err(|error| raise(py, &error))?;
        Ok((serde_json::to_string(&found).unwrap_or_default(), self.study.directory.join("fit.csv")))
    }

    /// The case with these values, as an object of JSON: its answer, as one.
    fn evaluate(&self, py: Python<'_>, values: &str) -> PyResult<String> {
        let values: Map<String, Value> =
            serde_json::from_str(values).map_err(|error| PyValueError::new_err(format!("values: {error}")))?;
        let evaluator = self.known().clone();
        let looking = Looking::new(None);
        let answer = errors::computed(py, || {
            thread::scope(|scope| {
                let (sender, receiver) = mpsc::channel();
                let (evaluator, values) = (&evaluator, &values);
                // It is listened to until it has answered.
                scope.spawn(move || drop(sender.send(evaluator.evaluate(values))));
                loop {
                    match receiver.recv_timeout(LOOK) {
                        Ok(answer) => return Some(answer),
                        Err(RecvTimeoutError::Disconnected) => return None,
                        Err(RecvTimeoutError::Timeout) if looking.has_ended() => evaluator.end(),
                        Err(RecvTimeoutError::Timeout) => {}
                    }
                }
            })
        })?;
        if let Some(error) = looking.raised() {
            // It has ended for good; the next one begins anew.
            *self.known() = self::evaluator(&self.study);
            return Err(error);
        }
        match answer {
            Some(Ok(Some(answer))) => Ok(serde_json::to_string(&answer).unwrap_or_default()),
            Some(Err(error)) => Err(raise(py, &error)),
            _ => Err(errors::run_error(py, "the case was ended with another one of the same study")),
        }
    }
}

impl Study {
    fn known(&self) -> MutexGuard<'_, Evaluator> {
        self.evaluator.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Takes the progress of a study.
struct Onlooker(Arc<Looking>);

impl StudyObserver for Onlooker {
    fn progress(&mut self, progress: &StudyOutcome) {
        let mut text = Vec::new();
        text.extend(progress.rate().map(|rate| format!("{rate:.3} a second")));
        text.extend((progress.failed > 0).then(|| format!("{} failed", progress.failed)));
        text.extend((progress.incomplete > 0).then(|| format!("{} ended early", progress.incomplete)));
        self.0.tell(progress.there + progress.computed, text.join(", "));
    }

    fn is_cancelled(&self) -> bool {
        self.0.has_ended()
    }
}

fn jobs(wanted: Option<NonZeroUsize>) -> usize {
    Settings { jobs: wanted, ..Settings::default() }.jobs()
}

fn counts<'py>(py: Python<'py>, counts: &Counts) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, number) in [
        ("cases", counts.cases),
        ("complete", counts.complete),
        ("incomplete", counts.incomplete),
        ("failed", counts.failed),
        ("missing", counts.missing),
        ("damaged", counts.damaged),
    ] {
        dict.set_item(name, number)?;
    }
    Ok(dict)
}

fn raise(py: Python<'_>, error: &StudyError) -> PyErr {
    let text = nlmodes_run::chain(error);
    match error {
        StudyError::NoCase { .. } => errors::scene_error(py, &text),
        _ => errors::run_error(
            py,
            &format!("{text}\nwhat was computed until then stays; the same call goes on from there"),
        ),
    }
}
