//! Largest stress of motions, of structures whose elements are known.

mod lines;
mod solids;

use nlmodes::branches::ComputedBranch;
use nlmodes::modal::{HarmonicCoefficients, PeakStress};
use nlmodes_scene::assemble::{OpenStructure, StaticState};
use nlmodes_scene::scene::Scene;
use num_complex::Complex64;

use super::Curve;
use super::space::FRAMES;
use crate::Failure;
use crate::physical::{coordinates_of_state, joined, parts, recorded};
use lines::Lines;
pub use solids::{PointStress, Solids};

/// Instants for each wave of the highest harmonic: between two of them a harmonic of amplitude one loses 0.08 at most.
const INSTANTS: usize = 8;

/// What recovers the stress of a structure from its displacements.
pub enum Stress {
    /// Rods and beams.
    Lines(Lines),
    /// Solids of a mesh.
    Solids(Box<Solids>),
}

impl Stress {
    /// Of the structure of a scene; `loads` are the shapes of [`Curve::load_shapes`]. None where the scene does not ask
    /// for stress, or what it needs is not known: the height of a section, a mesh of solids with their materials.
    ///
    /// # Errors
    /// [`Failure`] for elements that cannot be.
    pub fn of(scene: &Scene, open: Option<&OpenStructure>, loads: &[Vec<f64>]) -> Result<Option<Self>, Failure> {
        if !scene.files.stress {
            return Ok(None);
        }
        if scene.structure.matrices().is_none() {
            return Ok(Lines::of(scene)?.map(Self::Lines));
        }
        let Some(open) = open else { return Ok(None) };
        Ok(Solids::of(scene, open, loads)?.map(|solids| Self::Solids(Box::new(solids))))
    }

    /// Why stress is not recovered of a structure for which a scene asks for it, if only its size prevents it;
    /// `loads` is the number of load shapes.
    pub fn left_out(scene: &Scene, open: Option<&OpenStructure>, loads: usize) -> Option<String> {
        Solids::left_out(scene, open.filter(|_| scene.files.stress)?, loads)
    }

    /// That of solids.
    pub fn solids(&self) -> Option<&Solids> {
        match self {
            Self::Solids(solids) => Some(solids),
            Self::Lines(_) => None,
        }
    }

    /// The largest stress of each point of a curve; `moves` gives the displacements of degrees of freedom (m, those of
    /// static loads included) in a point of rods and beams.
    ///
    /// # Errors
    /// [`Failure`] if a point cannot be evaluated again.
    pub fn of_points(
        &self,
        curve: &dyn Curve,
        open: Option<&OpenStructure>,
        moves: impl Fn(usize, &[usize]) -> Option<HarmonicCoefficients>,
    ) -> Result<Vec<Option<PeakStress>>, Failure> {
        let points = curve.branch().points.iter().enumerate();
        match (self, open) {
            (Self::Lines(lines), _) => {
                let dofs = lines.dofs();
                Ok(points.map(|(k, _)| lines.largest(&dofs, &moves(k, &dofs)?)).collect())
            }
            (Self::Solids(solids), Some(open)) => {
                let of = |(k, point): (usize, &nlmodes::modal::ModalPoint)| {
                    let found = curve.instants(open, k, instants(point.coefficients.n_harmonics()))?;
                    Ok(solids.largest(&found))
                };
                points.map(of).collect()
            }
            (Self::Solids(_), None) => Ok(vec![None; curve.branch().points.len()]),
        }
    }
}

/// Equidistant instants of a period at which a motion of so many harmonics is looked at, those of frames among them.
fn instants(harmonics: usize) -> usize {
    FRAMES * (INSTANTS * harmonics).div_ceil(FRAMES).max(1)
}

/// Displacements of degrees of freedom of a rod, a beam or several of them in a point of a branch, after those of
/// points were recovered.
pub fn moves_of_branch(
    scene: &Scene,
    open: Option<&OpenStructure>,
    computed: &ComputedBranch,
    point: usize,
    dofs: &[usize],
) -> Option<HarmonicCoefficients> {
    let own = &computed.branch.points.get(point)?.coefficients;
    match open {
        None => chosen(own, dofs, |dof| computed.structure.recorded_index(dof)),
        Some(open) if scene.structure.straight().is_some() => {
            let known = recorded(&open.dofs, &open.modes).0;
            chosen(own, dofs, |dof| known.binary_search(&dof).ok())
        }
        // The reduced coordinates hold the modal share of the static displacements already.
        Some(open) => {
            let mut all = joined(&open.reduced.displacements(&open.modes, dofs, &parts(own)));
            let beyond = open.state.as_ref().map(|state| beyond_coordinates(open, state, dofs));
            for (k, by) in beyond.into_iter().flatten().enumerate() {
                all.of_mut(k)[0] += by;
            }
            Some(all)
        }
    }
}

/// What static loads move beyond what is recovered from their reduced coordinates, m.
fn beyond_coordinates(open: &OpenStructure, state: &StaticState, dofs: &[usize]) -> Vec<f64> {
    let known = open.reduced.displacements(&open.modes, dofs, &coordinates_of_state(open, state));
    dofs.iter().enumerate().map(|(k, dof)| state.displacement[*dof] - known[(k, 0)]).collect()
}

/// The series of these degrees of freedom; none where one of them is not recorded.
pub fn chosen(
    own: &HarmonicCoefficients,
    dofs: &[usize],
    place: impl Fn(usize) -> Option<usize>,
) -> Option<HarmonicCoefficients> {
    let mut all = HarmonicCoefficients::zeros(dofs.len(), own.n_harmonics());
    for (k, dof) in dofs.iter().enumerate() {
        let series: &[Complex64] = own.of(place(*dof)?);
        all.of_mut(k).copy_from_slice(series);
    }
    Some(all)
}
