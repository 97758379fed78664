//! The state with which a motion begins.

use std::path::Path;

use nlmodes::linalg::Mat;
use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::TransientStart;
use num_complex::Complex64;

use crate::responses::Model;
use crate::settle::{Motion, scene_of};
use crate::{RunError, chain};

/// Modal coordinates, their rates, and displacements of the dissipative stops at the beginning.
///
/// # Errors
/// [`RunError`] at `transient.from`.
pub fn state(file: &SceneFile, from: &TransientStart, model: &Model) -> Result<Vec<f64>, RunError> {
    let open = model.open_modes();
    let still = |mut eta: Vec<f64>| {
        let m = eta.len();
        eta.resize(2 * m + model.stop_dampers.len(), 0.0);
        eta
    };
    let eta = match from {
        TransientStart::Point { results, point } => return on_motion(file, results, *point, model),
        // The drawing, as seen from the place under static loads.
        TransientStart::Rest => model.state.as_ref().map(|state| state.modal.iter().map(|eta| -eta).collect()),
        TransientStart::Static => model.state.as_ref().map(|state| state.rest.eta.clone()),
    };
    Ok(still(eta.unwrap_or_else(|| vec![0.0; open.n_modes()])))
}

fn on_motion(file: &SceneFile, results: &Path, point: usize, model: &Model) -> Result<Vec<f64>, RunError> {
    let failed = |title: &str| -> RunError {
        let expected = "expected results of this structure, and a point of their branch.csv";
        file.error_at("transient.from", title, expected, &[]).into()
    };
    let told = |error: &dyn std::fmt::Display| failed(&format!("{}: {error}", results.display()));
    let scene = scene_of(results).map_err(|error| told(&chain(&error)))?;
    if scene.structure != file.scene.structure {
        return Err(told(&"these are results of another structure"));
    }
    let motion = Motion::read(results, point).map_err(|error| told(&chain(&error)))?;
    state_of(&motion, model).map_err(|why| told(&why))
}

/// The state at the beginning of a period of a motion of the degrees of freedom.
///
/// # Errors
/// Why there is none, in words.
pub fn state_of(motion: &Motion, model: &Model) -> Result<Vec<f64>, String> {
    let (n, open) = (motion.coefficients.n_coordinates(), model.open_modes());
    if n != open.n_dofs() || model.recorded.len() != n {
        return Err(format!(
            "harmonics.npz has the motion of {n} of {} degrees of freedom: the state in the modes is not known from these",
            open.n_dofs()
        ));
    }
    let at = |d: usize, order: i32| -> f64 {
        let of = motion.coefficients.of(d).iter().enumerate();
        of.map(|(n, q)| (Complex64::new(0.0, n as f64 * motion.omega).powi(order) * q).re).sum()
    };
    let moved = |d: usize| model.moved.get(d).copied().unwrap_or(0.0);
    let q = Mat::from_fn(n, 2, |d, j| if j == 0 { at(d, 0) - moved(d) } else { at(d, 1) });
    let eta = open.modal_coordinates(&q).ok_or("the mass of its displacements is not known")?;
    let gaps = open.gaps();
    // Where a dissipative stop stands is known while it is touched.
    let stops = model.stop_dampers.iter().map(|&(contact, _)| {
        let toward: f64 = model.contacts[contact].iter().map(|&(dof, w)| q[(dof, 0)] * w).sum();
        (toward - gaps[contact]).max(0.0)
    });
    Ok((0..2).flat_map(|j| eta.col(j).iter().copied().collect::<Vec<f64>>()).chain(stops).collect())
}
