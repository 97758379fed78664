//! The compiled part of the Python package `nlmodes`: what computes. Arrays come in checked by `nlmodes._arguments`,
//! and go out as arrays of NumPy; results of runs are read from their files by `nlmodes._result`.
//!
//! | item | what |
//! | --- | --- |
//! | `run` | a scene of any kind: structure, records, virtual test |
//! | `check`, `linear_frequencies`, `schema`, `columns` | what is known before that |
//! | `command` | the command line |
//! | `verify` | one period of the full structure from a computed point |
//! | `follow` | a fold, a first touch or a mode over a parameter |
//! | `Series` | contact problems |
//! | `trace` | branches of `R(x, p) = 0` with functions of Python |
//! | `Study` | many cases of a scene, and the table of what there is |
//! | `extract` | modal points of records in memory |
//!
//! Whatever computes does so without the interpreter, and looks at it twenty times a second for signals. A panic
//! becomes an error.

mod check;
mod command;
mod contact;
mod continuation;
mod errors;
mod experiment;
mod follow;
mod law;
mod looking;
mod run;
mod scene;
mod study;
mod verify;

/// The compiled part of nlmodes.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::check::{check, columns, linear_frequencies, schema};
    #[pymodule_export]
    use crate::command::command;
    #[pymodule_export]
    use crate::contact::{Series, conformance_cases};
    #[pymodule_export]
    use crate::continuation::trace;
    #[pymodule_export]
    use crate::experiment::extract;
    #[pymodule_export]
    use crate::follow::follow;
    #[pymodule_export]
    use crate::run::{Outcome, run};
    #[pymodule_export]
    use crate::scene::{override_of, toml_of};
    #[pymodule_export]
    use crate::study::Study;
    #[pymodule_export]
    use crate::verify::verify;

    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::PyModuleMethods;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
