//! Scenes from files and texts, and dictionaries as TOML.

use std::path::PathBuf;

use nlmodes_scene::{AnyScene, Diagnostic, SceneError, load_any, memory, parse_any};
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use toml::Value;

use crate::errors;

/// Deepest nesting of a dictionary: a scene needs four.
const DEEPEST: usize = 20;

/// Where a scene comes from.
#[derive(FromPyObject)]
pub enum Source {
    /// Name for messages, and text.
    #[pyo3(annotation = "tuple[str, str]")]
    Text(String, String),
    /// A file.
    #[pyo3(transparent)]
    File(PathBuf),
}

impl Source {
    fn read(&self, overrides: &[String]) -> Result<AnyScene, SceneError> {
        match self {
            Self::Text(name, text) => parse_any(name, text, overrides),
            Self::File(path) => load_any(path, overrides),
        }
    }

    /// The checked scene, whose computation fits into memory.
    pub fn scene(&self, py: Python<'_>, overrides: &[String], limit: Option<&str>) -> PyResult<AnyScene> {
        let wrong = |reason| PyValueError::new_err(format!("memory_limit: {reason}"));
        let limit = limit.map(str::parse).transpose().map_err(wrong)?;
        let read = errors::computed(py, || self.read(overrides))?;
        let mut scene = read.map_err(|refused| errors::refused(py, &refused))?;
        let admitted = memory::admit_any(&mut scene, limit);
        admitted.map_err(|error| errors::of_run(py, &error.into()))?;
        Ok(scene)
    }
}

/// What looks wrong with a scene, but does not prevent a computation; each thing once, without its place.
pub fn warnings(scene: &AnyScene) -> Vec<String> {
    scene.warnings().iter().map(Diagnostic::sentence).collect()
}

/// A dictionary as the text of a scene.
#[pyfunction]
pub fn toml_of(scene: &Bound<'_, PyDict>) -> PyResult<String> {
    let table = match value(scene.as_any(), "scene", 0)? {
        Value::Table(table) => table,
        _ => return Err(PyTypeError::new_err("scene is not a dictionary")),
    };
    toml::to_string_pretty(&table).map_err(|error| PyValueError::new_err(format!("scene: {error}")))
}

/// A key and its value as `--set` of the command line takes them.
#[pyfunction]
pub fn override_of(key: &str, given: &Bound<'_, PyAny>) -> PyResult<String> {
    Ok(format!("{key}={}", value(given, key, 0)?))
}

fn value(given: &Bound<'_, PyAny>, key: &str, depth: usize) -> PyResult<Value> {
    if depth > DEEPEST {
        return Err(PyValueError::new_err(format!("{key} is nested too deeply")));
    }
    if let Ok(flag) = given.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if given.is_instance_of::<PyInt>() {
        let number = given.extract::<i64>();
        return number
            .map(Value::Integer)
            .map_err(|_| PyOverflowError::new_err(format!("{key} is too large: {given}")));
    }
    if let Ok(number) = given.cast::<PyFloat>() {
        return Ok(Value::Float(number.value()));
    }
    if let Ok(text) = given.cast::<PyString>() {
        return Ok(Value::String(text.to_cow()?.into_owned()));
    }
    if let Ok(table) = given.cast::<PyDict>() {
        return table_of(table, key, depth);
    }
    // NumPy's scalars and arrays, and paths.
    if let Ok(plain) = given.call_method0("tolist") {
        return value(&plain, key, depth + 1);
    }
    if let Ok(path) = given.call_method0("__fspath__") {
        return value(&path, key, depth + 1);
    }
    let items = given.try_iter().map_err(|_| unfit(given, key))?;
    let item = |(i, item): (usize, PyResult<Bound<'_, PyAny>>)| value(&item?, &format!("{key}.{i}"), depth + 1);
    Ok(Value::Array(items.enumerate().map(item).collect::<PyResult<_>>()?))
}

fn table_of(table: &Bound<'_, PyDict>, key: &str, depth: usize) -> PyResult<Value> {
    let mut made = toml::Table::new();
    for (name, item) in table.iter() {
        let name =
            name.cast::<PyString>().map_err(|_| PyTypeError::new_err(format!("{key}: {name} is no name of a key")))?;
        let name = name.to_cow()?.into_owned();
        // What is None is not given.
        if !item.is_none() {
            let own = if depth == 0 { name.clone() } else { format!("{key}.{name}") };
            made.insert(name, value(&item, &own, depth + 1)?);
        }
    }
    Ok(Value::Table(made))
}

fn unfit(given: &Bound<'_, PyAny>, key: &str) -> PyErr {
    let kind = given.get_type().name().map_or_else(|_| "object".to_owned(), |name| name.to_string());
    PyTypeError::new_err(format!("{key} is a {kind}; a number, a text, a flag, a list or a dictionary was expected"))
}
