//! What is raised where there are no results: `nlmodes.SceneError` and `nlmodes.RunError`.

use std::panic::{AssertUnwindSafe, catch_unwind};

use nlmodes_run::RunError;
use nlmodes_scene::{Diagnostic, SceneError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

static SCENE_ERROR: PyOnceLock<Py<PyType>> = PyOnceLock::new();
static RUN_ERROR: PyOnceLock<Py<PyType>> = PyOnceLock::new();

/// Line and key of the place, what is wrong there, and what to do about it.
type Mistake = (Option<usize>, Option<String>, String, Vec<String>);

/// Everything that is wrong with a scene, as the command line says it.
pub fn refused(py: Python<'_>, error: &SceneError) -> PyErr {
    let document = error.document();
    let mistake = |one: &Diagnostic| -> Mistake {
        (document.line_of(one), document.key_of(one).map(str::to_owned), one.title.clone(), one.help.clone())
    };
    let mistakes: Vec<Mistake> = error.errors().map(mistake).collect();
    let text = error.text(false);
    let class = SCENE_ERROR.import(py, "nlmodes._errors", "SceneError");
    raised(class.and_then(|class| class.call1((text, mistakes))))
}

/// Why a run gives no results.
pub fn of_run(py: Python<'_>, error: &RunError) -> PyErr {
    match error {
        RunError::Scene(error) => refused(py, error),
        RunError::Foreign { .. } => {
            run_error(py, &format!("{error}\nout= takes another directory, force=True overwrites what is there"))
        }
        RunError::Link { .. } => run_error(py, &format!("{error}\nremove it, or choose another directory with out=")),
        RunError::Unwritable { directory, kept: true, .. } => {
            let place = directory.display();
            run_error(
                py,
                &format!("{error}\nwhat was found is in {place}; with resume=True the run goes on from there"),
            )
        }
        _ => run_error(py, &error.to_string()),
    }
}

/// `nlmodes.RunError` with this message.
pub fn run_error(py: Python<'_>, message: &str) -> PyErr {
    raised(RUN_ERROR.import(py, "nlmodes._errors", "RunError").and_then(|class| class.call1((message,))))
}

/// `nlmodes.SceneError` with this message, about no place in particular.
pub fn scene_error(py: Python<'_>, message: &str) -> PyErr {
    let class = SCENE_ERROR.import(py, "nlmodes._errors", "SceneError");
    raised(class.and_then(|class| class.call1((message,))))
}

fn raised(made: PyResult<Bound<'_, PyAny>>) -> PyErr {
    made.map_or_else(|error| error, PyErr::from_value)
}

/// Computes without holding the interpreter. A panic, which is a mistake of this program, becomes an error like any
/// other.
pub fn computed<T: Send>(py: Python<'_>, compute: impl FnOnce() -> T + Send) -> PyResult<T> {
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(compute)));
    done.map_err(|panic| {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
        run_error(py, &format!("a mistake of nlmodes itself, please report it: {text}"))
    })
}
