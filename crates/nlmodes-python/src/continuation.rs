//! `nlmodes.continuation`: branches of `R(x, p) = 0` whose residual is a function of Python.

use std::error::Error;
use std::fmt;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use nlmodes::continuation::{
    AtBranchPoint, Bound as Window, Branch, Continuation, ContinuationError, EventKind, Linearization,
    ParametricSystem, Scaling, StepSettings, StopReason,
};
use numpy::{IntoPyArray, PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyArithmeticError, PyIndexError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;

/// Cubic root of the rounding of a double: the share of an unknown by which central differences step.
const DIFFERENCE: f64 = 6e-6;

/// The residual has no value here.
#[derive(Debug)]
struct NoValue(String);

impl fmt::Display for NoValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Error for NoValue {}

/// Residual and Jacobian as functions of Python.
struct PySystem<'py> {
    py: Python<'py>,
    f: Bound<'py, PyAny>,
    jacobian: Option<Bound<'py, PyAny>>,
    n: usize,
    scaling: Option<Scaling>,
    /// Raised by one of the functions, and not a sign that there is no residual.
    raised: Option<PyErr>,
}

impl PySystem<'_> {
    fn residual(&self, x: &[f64], p: f64, out: &mut [f64]) -> PyResult<()> {
        let found = self.f.call1((PyArray1::from_slice(self.py, x), p))?;
        let array: PyReadonlyArray1<'_, f64> = as_float(&found, "f(x, p)")?
            .extract()
            .map_err(|_| PyValueError::new_err(format!("f(x, p) is not an array of {} numbers", self.n)))?;
        if array.len() != self.n {
            return Err(PyValueError::new_err(format!("f(x, p) has {} entries, x has {}", array.len(), self.n)));
        }
        out.iter_mut().zip(array.as_array()).for_each(|(out, value)| *out = *value);
        Ok(())
    }

    fn jacobian(&self, x: &[f64], p: f64, out: &mut Linearization) -> PyResult<()> {
        let Some(jacobian) = &self.jacobian else { return self.differences(x, p, out) };
        let n = self.n;
        let found = jacobian.call1((PyArray1::from_slice(self.py, x), p))?;
        let wrong = |shape: &[usize]| {
            PyValueError::new_err(format!(
                "jac(x, p) has the shape {shape:?}; ({n}, {}) was expected: dR/dx and, last, dR/dp",
                n + 1
            ))
        };
        let array = as_float(&found, "jac(x, p)")?;
        let array: PyReadonlyArray2<'_, f64> = array.extract().map_err(|_| wrong(&[]))?;
        if array.shape() != [n, n + 1] {
            return Err(wrong(array.shape()));
        }
        let view = array.as_array();
        (0..n).for_each(|i| (0..=n).for_each(|j| out.jacobian[(i, j)] = view[(i, j)]));
        Ok(())
    }

    /// Central differences of the residual.
    fn differences(&self, x: &[f64], p: f64, out: &mut Linearization) -> PyResult<()> {
        let n = self.n;
        let mut z: Vec<f64> = x.iter().copied().chain([p]).collect();
        let largest = x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let (mut above, mut below) = (vec![0.0; n], vec![0.0; n]);
        for j in 0..=n {
            let own = self.scaling.as_ref().and_then(|s| s.unknowns.get(j)).copied();
            let size = own.unwrap_or(if j < n && largest > 0.0 { largest } else { 1.0 }).max(z[j].abs());
            let (at, h) = (z[j], DIFFERENCE * size);
            z[j] = at + h;
            self.residual(&z[..n], z[n], &mut above)?;
            z[j] = at - h;
            self.residual(&z[..n], z[n], &mut below)?;
            z[j] = at;
            (0..n).for_each(|i| out.jacobian[(i, j)] = (above[i] - below[i]) / (2.0 * h));
        }
        Ok(())
    }
}

impl ParametricSystem for PySystem<'_> {
    type Error = NoValue;

    fn dim(&self) -> usize {
        self.n
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), NoValue> {
        if self.raised.is_some() {
            return Err(NoValue("an error was raised".to_owned()));
        }
        let mut residual = vec![0.0; self.n];
        let done = self.py.check_signals().and_then(|()| self.residual(x, p, &mut residual));
        let done = done.and_then(|()| self.jacobian(x, p, out));
        out.residual = residual;
        done.map_err(|error| {
            let text = error.to_string();
            // What cannot be calculated here may be beside it; anything else is a mistake, or Ctrl-C.
            if !error.is_instance_of::<PyArithmeticError>(self.py) {
                self.raised = Some(error);
            }
            NoValue(text)
        })
    }

    fn scaling(&self) -> Option<Scaling> {
        self.scaling.clone()
    }
}

/// What a function gave, as doubles in memory.
fn as_float<'py>(found: &Bound<'py, PyAny>, what: &str) -> PyResult<Bound<'py, PyAny>> {
    let numpy = found.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (found,))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "f" | "i" | "u" | "b") {
        return Err(PyTypeError::new_err(format!(
            "{what} is of the type {}, not real numbers",
            array.getattr("dtype")?
        )));
    }
    numpy.call_method1("ascontiguousarray", (array, "float64"))
}

/// How a branch is followed.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Settings {
    bounds: Vec<(usize, f64, f64)>,
    watched: Vec<usize>,
    at_branch_point: String,
    max_points: usize,
    initial_step: f64,
    min_step: f64,
    max_step: f64,
    tolerance: f64,
    max_iterations: usize,
    scaling: Option<(Vec<f64>, Vec<f64>)>,
}

impl Settings {
    fn continuation(&self) -> PyResult<Continuation> {
        let at_branch_point = match self.at_branch_point.as_str() {
            "stay" => AtBranchPoint::Stay,
            "switch" => AtBranchPoint::Switch,
            other => {
                let text = format!("at_branch_point is \"{other}\"; \"stay\" or \"switch\" was expected");
                return Err(PyValueError::new_err(text));
            }
        };
        let step = StepSettings {
            initial: self.initial_step,
            min: self.min_step,
            max: self.max_step,
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            ..StepSettings::default()
        };
        let window = |&(coordinate, min, max): &(usize, f64, f64)| Window { coordinate, min, max };
        Ok(Continuation {
            step,
            bounds: self.bounds.iter().map(window).collect(),
            watched: self.watched.clone(),
            at_branch_point,
            max_points: self.max_points,
        })
    }
}

/// Follows the branch through `(x0, p0)`; what there is of it is in a dictionary.
#[pyfunction]
pub fn trace<'py>(
    py: Python<'py>,
    f: Bound<'py, PyAny>,
    jacobian: Option<Bound<'py, PyAny>>,
    x0: Vec<f64>,
    p0: f64,
    direction: Vec<f64>,
    settings: Settings,
) -> PyResult<Bound<'py, PyDict>> {
    let scaling = settings.scaling.clone().map(|(unknowns, equations)| Scaling { unknowns, equations });
    let mut system = PySystem { py, f, jacobian, n: x0.len(), scaling, raised: None };
    let continuation = settings.continuation()?;
    let all = |_: &nlmodes::continuation::BranchPoint| ControlFlow::Continue(());
    let followed = catch_unwind(AssertUnwindSafe(|| continuation.run(&mut system, &x0, p0, &direction, all)));
    if let Some(error) = system.raised.take() {
        return Err(error);
    }
    let panicked = |_| errors::run_error(py, "a mistake of nlmodes itself, please report it");
    match followed.map_err(panicked)? {
        Ok(branch) => dictionary(py, &branch, x0.len()),
        Err(error @ ContinuationError::Dimension { .. } | error @ ContinuationError::Setting { .. }) => {
            Err(PyValueError::new_err(error.to_string()))
        }
        Err(error @ ContinuationError::OutsideBound { .. }) => Err(PyIndexError::new_err(error.to_string())),
        Err(ContinuationError::System(source)) => {
            Err(errors::run_error(py, &format!("the functions have no value at the starting point: {source}")))
        }
        Err(error) => Err(errors::run_error(py, &error.to_string())),
    }
}

fn dictionary<'py>(py: Python<'py>, branch: &Branch, n: usize) -> PyResult<Bound<'py, PyDict>> {
    let points = &branch.points;
    let dict = PyDict::new(py);
    let table = |width: usize, row: fn(&nlmodes::continuation::BranchPoint) -> &[f64]| {
        let values: Vec<f64> = points.iter().flat_map(|q| row(q).iter().copied()).collect();
        values.into_pyarray(py).reshape([points.len(), width])
    };
    dict.set_item("x", table(n, |q| &q.x)?)?;
    dict.set_item("tangent", table(n + 1, |q| &q.tangent)?)?;
    dict.set_item("p", points.iter().map(|q| q.p).collect::<Vec<_>>().into_pyarray(py))?;
    dict.set_item("residual", points.iter().map(|q| q.residual).collect::<Vec<_>>().into_pyarray(py))?;
    let events: Vec<Vec<String>> = points.iter().map(|q| q.events.iter().map(name).collect()).collect();
    dict.set_item("events", events)?;
    let crossings: Vec<(usize, Vec<Vec<f64>>)> = branch
        .crossings
        .iter()
        .map(|crossing| (crossing.point, crossing.arms.iter().map(|arm| arm.start.z.clone()).collect()))
        .collect();
    dict.set_item("crossings", crossings)?;
    let (reason, text, complete) = end(&branch.stop);
    dict.set_item("end_reason", reason)?;
    dict.set_item("ended_because", text)?;
    dict.set_item("complete", complete)?;
    dict.set_item("evaluations", branch.evaluations)?;
    dict.set_item("refused_steps", branch.refused_steps)?;
    Ok(dict)
}

fn name(event: &EventKind) -> String {
    match event {
        EventKind::ParameterFold => "fold".to_owned(),
        EventKind::UnknownFold { index } => format!("fold-of-x{index}"),
        EventKind::BranchPoint => "branch-point".to_owned(),
        EventKind::PatternChange { .. } => "pattern-change".to_owned(),
        EventKind::Kink => "kink".to_owned(),
        other => format!("{other:?}"),
    }
}

fn end(stop: &StopReason) -> (&'static str, String, bool) {
    match stop {
        StopReason::Bound { coordinate, value } => ("bound", format!("coordinate {coordinate} reached {value}"), true),
        StopReason::Closed => ("closed", "the branch came back to where it began".to_owned(), true),
        StopReason::MaxPoints => ("max-points", "the limit of points was reached".to_owned(), false),
        StopReason::StepTooSmall { step, refusal } => {
            ("no-step", format!("no step, down to {step:.1e}, could be shown to stay on the branch: {refusal}"), false)
        }
        other => ("ended", format!("{other:?}"), false),
    }
}
