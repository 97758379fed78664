//! A point of a run that is on disk.

use std::fs;
use std::path::{Path, PathBuf};

use nlmodes::branches::{BranchError, ComputedBranch};
use nlmodes::modal::HarmonicCoefficients;
use nlmodes::model::{Dof, MasslessContactModel};
use nlmodes::timestep::{MAX_DOFS, TimestepError};
use serde::Deserialize;

use super::error::VerifyError;
use crate::files::STARTS;
use crate::lcp::Archive;
use crate::physical;
use nlmodes_scene::assemble::{Assembly, OpenStructure, StaticState, contact_model};
use nlmodes_scene::scene::{MethodKind, Scene, Structure, Symmetry};

const SUMMARY: &str = "summary.json";
/// The scene of results.
///
/// # Errors
/// [`VerifyError`] if there are none.
pub(crate) fn scene_of(directory: &Path) -> Result<Scene, VerifyError> {
    read_summary(directory)?.scene.ok_or_else(|| no_scene(directory))
}

fn no_scene(directory: &Path) -> VerifyError {
    VerifyError::NotASummary { path: directory.join(SUMMARY), source: serde::de::Error::missing_field("scene") }
}

pub(crate) const HARMONICS: &str = "harmonics.npz";

/// A periodic motion with its structure.
pub struct Point {
    /// Its number in the branch.
    pub number: usize,
    /// The scene's title.
    pub title: String,
    /// The structure that moves.
    pub model: MasslessContactModel,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Fourier coefficients of the displacements, m.
    pub coefficients: HarmonicCoefficients,
    /// Displacements at the beginning of an exact motion, where the velocity is zero.
    pub start: Option<Vec<f64>>,
    symmetry: Symmetry,
}

/// What is read of a summary.
#[derive(Deserialize)]
struct Summary {
    /// Missing where there are several branches, which have a summary each.
    scene: Option<Scene>,
    /// Of a run with several methods or numbers of harmonics.
    #[serde(default)]
    branches: Vec<Branch>,
}

#[derive(Deserialize)]
struct Branch {
    directory: PathBuf,
}

impl Point {
    /// Reads `summary.json`, that of the directory above for a folder `branch_1` …, and `harmonics.npz`.
    ///
    /// # Errors
    /// [`VerifyError`] if they are not there, or not those of a run.
    pub fn read(directory: &Path, number: usize) -> Result<Self, VerifyError> {
        let summary = read_summary(directory)?;
        let path = directory.join(HARMONICS);
        if !path.is_file() && !summary.branches.is_empty() {
            let folders = summary.branches.into_iter().map(|branch| branch.directory).collect();
            return Err(VerifyError::SeveralBranches { folders });
        }
        let Some(scene) = summary.scene else {
            return Err(no_scene(directory));
        };
        if !scene.responses.is_empty() {
            return Err(VerifyError::Responses);
        }
        if !path.is_file() {
            return Err(VerifyError::Missing { name: HARMONICS });
        }
        let found = scene.structure.straight().filter(|_| !scene.is_in_open_modes()).map_or(0, Structure::free_dofs);
        if found > MAX_DOFS {
            return Err(TimestepError::TooLarge { found, most: MAX_DOFS }.into());
        }
        let (model, open, state) = model(&scene)?;
        let displaced = open.as_ref().filter(|_| scene.structure.straight().is_some());
        let dofs = displaced.map_or(model.dofs(), |open| &open.dofs);
        let (omega, mut coefficients) = read_point(&path, number, dofs)?;
        if scene.method.accuracy.is_none() && coefficients.n_harmonics() != scene.method.harmonics {
            let (found, expected) = (coefficients.n_harmonics().to_string(), scene.method.harmonics.to_string());
            return Err(VerifyError::Foreign { what: "number of harmonics", found, expected });
        }
        let mut start = match scene.method.kind {
            MethodKind::Shooting => read_start(&directory.join(STARTS), number, dofs.len())?,
            MethodKind::MsHbm | MethodKind::Hbm => None,
        };
        // Files count displacements from the drawing, the equations from the place under static loads.
        if let Some(state) = &state {
            let moved = physical::written_displacement(&scene, open.as_ref(), state);
            moved.iter().enumerate().for_each(|(d, by)| coefficients.of_mut(d)[0] -= by);
            start.iter_mut().for_each(|start| start.iter_mut().zip(&moved).for_each(|(q, by)| *q -= by));
        }
        if let Some(open) = displaced {
            let unknown = || VerifyError::Structure { reason: "the mass of its displacements is not known".to_owned() };
            coefficients = physical::reduced(open, &coefficients).ok_or_else(unknown)?;
            let reduced = start.map(|start| physical::reduced_state(open, &start).ok_or_else(unknown));
            start = reduced.transpose()?;
        }
        Ok(Self { number, title: scene.title, model, omega, coefficients, start, symmetry: scene.method.symmetry })
    }

    /// A point of a branch that is still in memory.
    ///
    /// # Errors
    /// [`BranchError`] if an exact motion cannot be evaluated again.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn of_branch(scene: &Scene, computed: &ComputedBranch, number: usize) -> Result<Self, BranchError> {
        let point = &computed.branch.points[number];
        let exact = computed.exact()?;
        let start = exact.map(|mut problem| problem.first_displacement(&computed.unknowns[number])).transpose()?;
        Ok(Self {
            number,
            title: scene.title.clone(),
            model: computed.structure.model().clone(),
            omega: point.omega,
            coefficients: point.coefficients.clone(),
            start,
            symmetry: scene.method.symmetry,
        })
    }

    /// Whether the velocity is zero at the beginning of the period.
    pub fn is_even(&self) -> bool {
        self.symmetry == Symmetry::Even
    }
}

fn read_summary(directory: &Path) -> Result<Summary, VerifyError> {
    if !directory.is_dir() {
        return Err(if directory.is_file() { VerifyError::File } else { VerifyError::NoDirectory });
    }
    let own = directory.join(SUMMARY);
    let above = directory.join("..").join(SUMMARY);
    let branch = directory.file_name().is_some_and(|name| name.to_string_lossy().starts_with("branch_"));
    let path = if !own.is_file() && branch { above } else { own };
    if !path.is_file() {
        return Err(VerifyError::Missing { name: SUMMARY });
    }
    let text = fs::read_to_string(&path).map_err(|source| VerifyError::Read { path: path.clone(), source })?;
    serde_json::from_str(&text).map_err(|source| VerifyError::NotASummary { path, source })
}

/// The model that the method works on, the free-interface modes in which it is, if it is, and its static state.
fn model(scene: &Scene) -> Result<(MasslessContactModel, Option<OpenStructure>, Option<StaticState>), VerifyError> {
    let Assembly { model, open, state } = Assembly::of(scene).map_err(|error| VerifyError::structure(&error))?;
    let model = contact_model(scene, &model).map_err(|error| VerifyError::structure(&error))?;
    Ok((model, open, state))
}

/// Displacements at the beginning of one point; `None` without the file, the motion then starts from its coefficients.
fn read_start(path: &Path, number: usize, n: usize) -> Result<Option<Vec<f64>>, VerifyError> {
    if !path.is_file() {
        return Ok(None);
    }
    let found = Archive::open(path)?.array("displacement")?;
    let row = match found.shape.as_slice() {
        &[points, coordinates] if coordinates == n && number < points => &found.values[number * n..(number + 1) * n],
        shape => {
            let (found, expected) = (format!("{shape:?}"), format!("points × {n}"));
            return Err(VerifyError::Foreign { what: "shape of `displacement` in starts.npz", found, expected });
        }
    };
    if row.iter().any(|q| !q.is_finite()) {
        let (found, expected) = ("not finite".into(), "a motion".into());
        return Err(VerifyError::Foreign { what: "displacements of starts.npz", found, expected });
    }
    Ok(Some(row.to_vec()))
}

/// Frequency and coefficients of one point of the archive.
fn read_point(path: &Path, number: usize, dofs: &[Dof]) -> Result<(f64, HarmonicCoefficients), VerifyError> {
    let (omega, coefficients, positions) = read_motion(path, number)?;
    let foreign = |what, found: String, expected: String| Err(VerifyError::Foreign { what, found, expected });
    let n = dofs.len();
    if coefficients.n_coordinates() != n {
        return foreign("degrees of freedom", coefficients.n_coordinates().to_string(), n.to_string());
    }
    let length = dofs.iter().fold(0.0_f64, |m, d| m.max(d.position.abs()));
    let near = |(found, dof): (&f64, &Dof)| (found - dof.position).abs() <= 1e-9 * length;
    if positions.len() != n || !positions.iter().zip(dofs).all(near) {
        return foreign("degrees of freedom", "at other places".into(), "those of the scene".into());
    }
    Ok((omega, coefficients))
}

/// Frequency (rad/s) and coefficients of one point of the archive, and the positions of its degrees of freedom (m).
///
/// # Errors
/// [`VerifyError`] if it has no such point.
pub(crate) fn read_motion(path: &Path, number: usize) -> Result<(f64, HarmonicCoefficients, Vec<f64>), VerifyError> {
    let mut archive = Archive::open(path)?;
    let names = archive.names();
    for name in ["omega", "coefficients", "dof_position_m"] {
        if !names.iter().any(|known| known == name) {
            return Err(VerifyError::NoArray { name });
        }
    }
    let (omega, positions) = (archive.array("omega")?, archive.array("dof_position_m")?);
    let (shape, values) = archive.complex("coefficients")?;
    let foreign = |what, found: String, expected: String| Err(VerifyError::Foreign { what, found, expected });
    let &[points, n, width] = shape.as_slice() else {
        return foreign("dimensions of `coefficients`", shape.len().to_string(), "3".into());
    };
    if omega.shape != [points] {
        return foreign("points of `omega`", omega.values.len().to_string(), points.to_string());
    }
    if width == 0 {
        return foreign("harmonics of `coefficients`", "none".into(), "those of a motion".into());
    }
    if number >= points {
        return Err(VerifyError::NoSuchPoint { point: number, points });
    }
    let mut coefficients = HarmonicCoefficients::zeros(n, width - 1);
    for d in 0..n {
        let from = (number * n + d) * width;
        coefficients.of_mut(d).copy_from_slice(&values[from..from + width]);
    }
    let omega = omega.values[number];
    let finite = |d: usize| coefficients.of(d).iter().all(|q| q.is_finite());
    if !(omega.is_finite() && omega > 0.0 && (0..n).all(finite)) {
        return foreign("numbers of the point", "not finite".into(), "a motion".into());
    }
    Ok((omega, coefficients, positions.values))
}
