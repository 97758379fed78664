//! `nlmodes.check`, `nlmodes.linear_frequencies`, `nlmodes.schema`: what is known before anything is computed.

use nlmodes_run::{RunError, chain};
use nlmodes_scene::AnyScene;
use nlmodes_scene::assemble::Assembly;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;
use crate::looking::{Looking, Onlooker};
use crate::scene::{Source, warnings};

/// Whether a run would begin; what looks wrong.
#[pyfunction]
pub fn check(py: Python<'_>, source: Source, overrides: Vec<String>) -> PyResult<Vec<String>> {
    let scene = source.scene(py, &overrides, None)?;
    let mut onlooker = Onlooker { looking: Looking::new(None), warnings: warnings(&scene) };
    let checked = errors::computed(py, || match &scene {
        AnyScene::Structure(files) => {
            files.iter().try_for_each(|file| nlmodes_run::check(file, &mut onlooker).map(drop))
        }
        AnyScene::Records(file) => nlmodes_run::check_records(file, &mut onlooker).map(drop),
        AnyScene::Test(file) => nlmodes_run::check_test(file, &mut onlooker).map(drop),
    })?;
    checked.map_err(|error| errors::of_run(py, &error))?;
    Ok(onlooker.warnings)
}

/// The lowest linear frequencies of the structure of a scene, Hz.
#[pyfunction]
pub fn linear_frequencies(py: Python<'_>, source: Source, overrides: Vec<String>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    let AnyScene::Structure(files) = source.scene(py, &overrides, None)? else {
        return Err(errors::run_error(py, "this scene has no structure whose modes could be computed"));
    };
    let Some(file) = files.into_iter().next() else { return Ok(dict) };
    let found = errors::computed(py, || -> Result<_, RunError> {
        let file = nlmodes_run::updating::updated(file)?;
        let failed = |text: String| -> RunError { file.error_at("structure", &text, "", &[]).into() };
        let assembly = Assembly::of(&file.scene).map_err(|error| failed(chain(&error)))?;
        nlmodes_run::linear::linear_frequencies(&file.scene, &assembly).map_err(|error| failed(chain(&error)))
    })?;
    let found = found.map_err(|error| errors::of_run(py, &error))?;
    dict.set_item("mass_kept", found.mass_kept)?;
    dict.set_item("mass_redistributed", found.mass_redistributed)?;
    dict.set_item("contacts_held", found.contacts_held)?;
    dict.set_item("about_rest", found.about_rest)?;
    Ok(dict)
}

/// What every file of results, its columns and arrays mean, as text.
#[pyfunction]
pub fn columns() -> String {
    nlmodes::report::columns::text()
}

/// The JSON schema of a scene, as text.
#[pyfunction]
pub fn schema() -> String {
    nlmodes_scene::whole_schema().to_string()
}
