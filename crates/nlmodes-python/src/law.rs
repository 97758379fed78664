//! Laws of force that are functions of Python.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use nlmodes::hbm::{ForceLaw, LawForce};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Evaluations at which the slope is compared with differences of the force.
const COMPARED: usize = 256;

/// Step of these differences over the argument, and the difference over the slope, or over the secant from rest, that
/// counts as a mistake: the error of central differences is far below.
const STEP: f64 = 1e-5;
const APART: f64 = 1e-3;

/// Abscissae and weights of Gauss' formula on [0, 1], by which the potential is integrated in each of [`PIECES`].
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
const PIECES: usize = 16;

/// A force and its slope by the displacement or the velocity, as functions of Python.
pub struct PythonLaw {
    force: Py<PyAny>,
    slope: Py<PyAny>,
    of_velocity: bool,
    compared: AtomicUsize,
    raised: Arc<Mutex<Option<PyErr>>>,
}

impl fmt::Debug for PythonLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PythonLaw").field("of_velocity", &self.of_velocity).finish_non_exhaustive()
    }
}

/// Laws as they come from Python: name, force, slope, whether they are of the velocity.
pub type Given = Vec<(String, Py<PyAny>, Py<PyAny>, bool)>;

/// Laws of a run, and what their functions raise.
pub struct Laws {
    /// By their names in the scene.
    pub by_name: BTreeMap<String, Arc<dyn ForceLaw>>,
    raised: Arc<Mutex<Option<PyErr>>>,
}

impl Laws {
    pub fn new(given: Given) -> Self {
        let raised = Arc::new(Mutex::new(None));
        let law = |(name, force, slope, of_velocity)| {
            let compared = AtomicUsize::new(0);
            let law = PythonLaw { force, slope, of_velocity, compared, raised: raised.clone() };
            (name, Arc::new(law) as Arc<dyn ForceLaw>)
        };
        Self { by_name: given.into_iter().map(law).collect(), raised: raised.clone() }
    }

    /// What a function raised first, if any did.
    pub fn raised(&self) -> Option<PyErr> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl PythonLaw {
    fn value(&self, py: Python<'_>, of: &Py<PyAny>, at: f64) -> PyResult<f64> {
        of.call1(py, (at,))?.extract::<f64>(py)
    }

    fn evaluate(&self, py: Python<'_>, at: f64) -> PyResult<[f64; 2]> {
        let found = [self.value(py, &self.force, at)?, self.value(py, &self.slope, at)?];
        let named = [("force", found[0]), ("slope", found[1])];
        if let Some((name, value)) = named.into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(PyValueError::new_err(format!("{name}({at:e}) is {value}; a finite number was expected")));
        }
        if self.compared.fetch_add(1, Ordering::Relaxed) < COMPARED {
            self.compare(py, at, found)?;
        }
        Ok(found)
    }

    /// The slope against differences of the force; next to a corner, where the two sides differ, it may be either.
    fn compare(&self, py: Python<'_>, at: f64, [force, slope]: [f64; 2]) -> PyResult<()> {
        if at == 0.0 {
            return match force == 0.0 {
                true => Ok(()),
                false => Err(PyValueError::new_err(format!("force(0) is {force:e}; a law has no force at rest"))),
            };
        }
        let h = STEP * at.abs();
        let [low, high] = [self.value(py, &self.force, at - h)?, self.value(py, &self.force, at + h)?];
        let sides = [(force - low) / h, (high - force) / h];
        let rounding = 1e-14 * force.abs().max(low.abs()).max(high.abs()) / h;
        let allowed = APART * slope.abs().max((force / at).abs()) + rounding + (sides[1] - sides[0]).abs();
        let central = 0.5 * (sides[0] + sides[1]);
        if (central - slope).abs() > allowed {
            return Err(PyValueError::new_err(format!(
                "slope({at:e}) is {slope:e}, but differences of force give {central:e}"
            )));
        }
        Ok(())
    }
}

impl ForceLaw for PythonLaw {
    fn at(&self, v: f64, rate: f64) -> LawForce {
        let at = if self.of_velocity { rate } else { v };
        let found = Python::attach(|py| self.evaluate(py, at));
        let [force, slope] = found.unwrap_or_else(|error| {
            self.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            [f64::NAN; 2]
        });
        let (stiffness, damping) = if self.of_velocity { (0.0, slope) } else { (slope, 0.0) };
        LawForce { force, stiffness, damping }
    }

    fn potential(&self, v: f64) -> f64 {
        if self.of_velocity {
            return 0.0;
        }
        let width = v / PIECES as f64;
        let piece = |k: usize| -> f64 {
            GAUSS.iter().map(|(x, weight)| weight * self.at((k as f64 + x) * width, 0.0).force).sum()
        };
        width * (0..PIECES).map(piece).sum::<f64>()
    }

    fn dissipates(&self) -> bool {
        self.of_velocity
    }
}
