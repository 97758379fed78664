//! `nlmodes.contact`: complementarity problems of contact.

use std::sync::{Mutex, PoisonError};

use nlmodes::contact::conformance::Expected;
use nlmodes::contact::{LcpError, LcpMatrix, Mat, SeriesSolution, Start, solver_by_name};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors;

/// Forces, gaps, closed contacts, violation and iterations: samples × c, and samples.
type Solution<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<bool>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
);

/// Many contact problems with one matrix: that, its solver, and the last solution, from which the next one may start.
#[pyclass(frozen, module = "nlmodes._native")]
pub struct Series {
    c: usize,
    inner: Mutex<(nlmodes::contact::Series, SeriesSolution)>,
}

/// What makes a problem none, and what has no solution.
fn raise(py: Python<'_>, error: &LcpError) -> PyErr {
    match error {
        LcpError::NotSquare { .. } | LcpError::NotSymmetric { .. } | LcpError::NotPositiveSemidefinite { .. } => {
            PyValueError::new_err(format!("A: {error}"))
        }
        LcpError::NotFinite { .. } | LcpError::UnknownSolver { .. } | LcpError::TooManyContacts { .. } => {
            PyValueError::new_err(error.to_string())
        }
        _ => errors::run_error(py, &error.to_string()),
    }
}

/// A matrix of NumPy, c × c.
pub fn matrix(a: &PyReadonlyArray2<'_, f64>) -> Mat<f64> {
    let view = a.as_array();
    Mat::from_fn(view.nrows(), view.ncols(), |i, j| view[(i, j)])
}

#[pymethods]
impl Series {
    #[new]
    fn new(py: Python<'_>, a: PyReadonlyArray2<'_, f64>, solver: &str) -> PyResult<Self> {
        let a = matrix(&a);
        let made = errors::computed(py, || {
            let matrix = LcpMatrix::new(&a)?;
            nlmodes::contact::Series::new(&matrix, solver_by_name(solver)?.as_ref())
        })?;
        let series = made.map_err(|error| raise(py, &error))?;
        Ok(Self { c: a.nrows(), inner: Mutex::new((series, SeriesSolution::default())) })
    }

    /// Solves all samples of `b`, samples × c.
    fn solve<'py>(&self, py: Python<'py>, b: PyReadonlyArray2<'py, f64>, start: &str) -> PyResult<Solution<'py>> {
        let start = match start {
            "cold" => Start::Cold,
            "previous-sample" => Start::PreviousSample,
            "same-sample" => Start::SameSample,
            other => {
                let names = "cold, previous-sample or same-sample";
                return Err(PyValueError::new_err(format!("start is \"{other}\"; {names} was expected")));
            }
        };
        let (samples, c) = (b.shape()[0], self.c);
        let values: Vec<f64> = b.as_array().iter().copied().collect();
        let solved = errors::computed(py, || {
            let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
            let (series, solution) = &mut *inner;
            series.solve(&values, start, solution).map(|()| solution.clone())
        })?;
        let solution = solved.map_err(|error| raise(py, &error))?;
        let mut rows: (Vec<f64>, Vec<f64>, Vec<bool>) = Default::default();
        for k in 0..samples {
            rows.0.extend_from_slice(solution.lambda(k));
            rows.1.extend_from_slice(solution.gaps(k));
            rows.2.extend_from_slice(solution.closed(k));
        }
        let statistics = &solution.statistics()[..samples];
        let violation: Vec<f64> = statistics.iter().map(|s| s.violation).collect();
        let iterations: Vec<i64> = statistics.iter().map(|s| s.iterations as i64).collect();
        Ok((
            rows.0.into_pyarray(py).reshape([samples, c])?,
            rows.1.into_pyarray(py).reshape([samples, c])?,
            rows.2.into_pyarray(py).reshape([samples, c])?,
            violation.into_pyarray(py),
            iterations.into_pyarray(py),
        ))
    }

    /// `dλ/db` and `dg/db` (c × c) with these contacts closed.
    fn response<'py>(
        &self,
        py: Python<'py>,
        closed: PyReadonlyArray1<'py, bool>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let closed: Vec<bool> = closed.as_array().iter().copied().collect();
        let found = errors::computed(py, || {
            let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
            inner.0.response(&closed)
        })?;
        let response = found.map_err(|error| PyValueError::new_err(format!("closed: {error}")))?;
        Ok((array(py, &response.lambda)?, array(py, &response.gaps)?))
    }
}

/// A problem that every solver must pass: its name, `A`, `b`, and whether it has a solution.
type Case<'py> = (String, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, bool);

/// The suite that every contact solver passes, problems of at most so many contacts.
#[pyfunction]
pub fn conformance_cases(py: Python<'_>, at_most: usize) -> PyResult<Vec<Case<'_>>> {
    let cases = nlmodes::contact::conformance::cases(at_most).into_iter().map(|case| {
        let solvable = !matches!(case.expected, Expected::Infeasible);
        Ok((case.name, array(py, &case.a)?, case.b.into_pyarray(py), solvable))
    });
    cases.collect()
}

/// A matrix as an array of NumPy.
pub fn array<'py>(py: Python<'py>, a: &Mat<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values: Vec<f64> = (0..a.nrows()).flat_map(|i| (0..a.ncols()).map(move |j| a[(i, j)])).collect();
    values.into_pyarray(py).reshape([a.nrows(), a.ncols()])
}
