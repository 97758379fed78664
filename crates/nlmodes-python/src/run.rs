//! Runs of scenes, and what is kept of them in memory.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use nlmodes::branches::ComputedBranch;
use nlmodes_run::{Over, RunError, RunOutcome, chain};
use nlmodes_scene::AnyScene;
use numpy::IntoPyArray;
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;
use crate::law::{Given, Laws};
use crate::looking::{Looking, Onlooker};
use crate::scene::{Source, warnings};

/// What came out of a run: where its files are, and what can be looked at more closely.
#[pyclass(frozen, module = "nlmodes._native")]
pub struct Outcome {
    /// Directory of the files.
    #[pyo3(get)]
    directory: PathBuf,
    /// `structure`, `responses`, `records` or `virtual-test`.
    #[pyo3(get)]
    kind: &'static str,
    /// What the scene and the run warned of.
    #[pyo3(get)]
    warnings: Vec<String>,
    /// Why files are missing, or the run is not complete.
    #[pyo3(get)]
    wrong: Vec<String>,
    /// Seconds from the beginning of each part to its last file.
    #[pyo3(get)]
    wall_time_s: f64,
    run: Option<Mutex<RunOutcome>>,
}

/// What is left of a run of any kind.
struct Done {
    kind: &'static str,
    wrong: Vec<String>,
    run: Option<RunOutcome>,
}

/// Computes what a scene describes and writes its files: into `out`, or `scratch` where the scene names no directory.
/// `laws` are those of its springs that are functions.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "those of the function of Python")]
pub fn run(
    py: Python<'_>,
    source: Source,
    overrides: Vec<String>,
    out: Option<PathBuf>,
    scratch: Option<PathBuf>,
    over: &str,
    memory_limit: Option<&str>,
    progress: Option<Py<PyAny>>,
    laws: Given,
) -> PyResult<Outcome> {
    let over = match over {
        "same" => Over::Same,
        "resume" => Over::Resumed,
        "force" => Over::Anything,
        other => return Err(PyValueError::new_err(format!("over is \"{other}\"; same, resume or force was expected"))),
    };
    let mut scene = source.scene(py, &overrides, memory_limit)?;
    let names_directory = scene.document().is_some_and(|document| document.place("output.directory").is_some());
    if let Some(out) = out.or(scratch.filter(|_| !names_directory)) {
        scene.set_output_directory(&out);
    }
    let laws = Laws::new(laws);
    if let AnyScene::Structure(files) = &mut scene {
        files.iter_mut().for_each(|file| file.functions.clone_from(&laws.by_name));
    }
    let directory = scene.output_directory().map_or_else(PathBuf::new, Path::to_path_buf);
    let mut onlooker = Onlooker { looking: Looking::new(progress), warnings: warnings(&scene) };
    let done = errors::computed(py, || compute(scene, over, &mut onlooker))?;
    // A signal of the last milliseconds is not lost either.
    onlooker.looking.look();
    if let Some(error) = onlooker.looking.raised() {
        return Err(error);
    }
    if let Some(error) = laws.raised() {
        return Err(error);
    }
    let done = done.map_err(|error| errors::of_run(py, &error))?;
    let time = |run: &RunOutcome| run.parts.iter().map(|part| part.wall_time.as_secs_f64()).sum();
    Ok(Outcome {
        directory,
        kind: done.kind,
        warnings: onlooker.warnings,
        wrong: done.wrong,
        wall_time_s: done.run.as_ref().map_or(f64::NAN, time),
        run: done.run.map(Mutex::new),
    })
}

fn compute(scene: AnyScene, over: Over, onlooker: &mut Onlooker) -> Result<Done, RunError> {
    match scene {
        AnyScene::Structure(files) if files.iter().any(|file| file.scene.transient.is_some()) => {
            let file = nlmodes_run::responses::one_method(&files)?;
            let outcome = nlmodes_run::transient::run(file, over, onlooker)?;
            let failure = outcome.failure.iter().map(|failure| chain(failure.as_ref()));
            Ok(Done { kind: "transient", wrong: outcome.ended.iter().cloned().chain(failure).collect(), run: None })
        }
        AnyScene::Structure(files) if files.iter().any(|file| !file.scene.responses.is_empty()) => {
            let file = nlmodes_run::responses::one_method(&files)?;
            let outcome = nlmodes_run::responses::run(file, over, onlooker)?;
            let mut wrong: Vec<String> = outcome.failure.iter().map(|failure| chain(failure.as_ref())).collect();
            if outcome.not_begun > 0 {
                wrong.push("the curves that were not begun are missing".to_owned());
            }
            Ok(Done { kind: "responses", wrong, run: None })
        }
        AnyScene::Structure(files) => {
            let run = nlmodes_run::run(files, over, onlooker)?;
            let parts = run.parts.iter().filter_map(|part| part.failure.as_ref());
            let wrong = parts.chain(&run.failure).map(|failure| chain(failure.as_ref())).collect();
            Ok(Done { kind: "structure", wrong, run: Some(run) })
        }
        AnyScene::Records(file) => {
            let outcomes = nlmodes_run::records::extract(&file, over, onlooker)?;
            let wrong = outcomes.iter().filter_map(|outcome| {
                let error = outcome.result.as_ref().err()?;
                Some(format!("{}: {error}", outcome.record))
            });
            Ok(Done { kind: "records", wrong: wrong.collect(), run: None })
        }
        AnyScene::Test(file) => {
            let outcome = nlmodes_run::virtual_test::run(&file, over, onlooker)?;
            Ok(Done { kind: "virtual-test", wrong: outcome.wrong, run: None })
        }
    }
}

#[pymethods]
impl Outcome {
    /// Motion and force of a contact over one period of a point, exact at the contact.
    fn history<'py>(
        &self,
        py: Python<'py>,
        part: usize,
        branch: usize,
        point: usize,
        contact: usize,
        samples: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        let found = errors::computed(py, || {
            let run = self.run.as_ref().ok_or("this run has no branches")?;
            let run = run.lock().unwrap_or_else(PoisonError::into_inner);
            let part = run.parts.get(part).ok_or("this branch is not in memory")?;
            let computed = part.tree.branches.get(branch).ok_or("this branch is not in memory: run its part alone")?;
            in_range(computed, point, contact).map_err(|text| Failed::Range(text))?;
            computed.time_history(point, contact, samples, "").map_err(|error| Failed::Text(error.to_string()))
        })?;
        let history = found.map_err(|error: Failed| match error {
            Failed::Range(text) => PyIndexError::new_err(text),
            Failed::Text(text) => errors::run_error(py, &text),
        })?;
        let dict = PyDict::new(py);
        dict.set_item("time_s", history.time.into_pyarray(py))?;
        dict.set_item("displacement_m", history.displacement.into_pyarray(py))?;
        dict.set_item("velocity_m_s", history.velocity.into_pyarray(py))?;
        dict.set_item("acceleration_m_s2", history.acceleration.into_pyarray(py))?;
        dict.set_item("force_n", history.force.into_pyarray(py))?;
        dict.set_item("stop_m", history.stop)?;
        let instants: Vec<(f64, bool)> = history.instants.iter().map(|i| (i.time, i.touching)).collect();
        dict.set_item("instants", instants)?;
        Ok(dict)
    }
}

/// Why there is no history.
enum Failed {
    Range(String),
    Text(String),
}

impl From<&str> for Failed {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

fn in_range(computed: &ComputedBranch, point: usize, contact: usize) -> Result<(), String> {
    let (points, contacts) = (computed.branch.points.len(), computed.structure.model().contacts().len());
    if point >= points {
        return Err(format!("point {point}: the branch has {points}"));
    }
    if contact >= contacts {
        return Err(format!("contact {contact}: the structure has {contacts}"));
    }
    Ok(())
}
