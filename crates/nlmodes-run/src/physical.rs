//! Displacements as they are written: of the degrees of freedom of rods and beams that are computed in free-interface
//! modes, and counted from the drawing, where the structure is without loads and contact.

use nlmodes::branches::ComputedBranch;
use nlmodes::hbm::MAX_RECORDED;
use nlmodes::linalg::{Mat, triplets};
use nlmodes::modal::{Coordinate, HarmonicCoefficients, ModalPoint, TimeHistory};
use nlmodes::model::Dof;
use nlmodes::model::reduction::OpenModes;
use nlmodes_scene::assemble::{OpenStructure, StaticState};
use nlmodes_scene::scene::Scene;
use num_complex::Complex64;

/// Gives the points of the branches of a rod or beam in free-interface modes the displacements of its degrees of
/// freedom in place of the reduced coordinates; of large structures those of evenly chosen ones and of the contacts.
/// Others keep their coordinates. All are counted from the drawing.
pub fn recover<'a>(
    scene: &Scene,
    (open, state): (Option<&OpenStructure>, Option<&StaticState>),
    all: impl IntoIterator<Item = &'a mut ComputedBranch>,
) {
    for computed in all {
        let displaced = open.filter(|_| scene.structure.straight().is_some());
        displaced.into_iter().for_each(|open| recover_branch(open, computed));
        let Some(state) = state else { continue };
        let moved = match (displaced, open) {
            (Some(open), _) => of_dofs(state, &recorded(&open.dofs, &open.modes).0),
            (None, Some(_)) => written_displacement(scene, open, state),
            (None, None) => {
                let recorded = |dof: &usize| computed.structure.recorded_index(*dof).is_some();
                of_dofs(state, &(0..state.displacement.len()).filter(recorded).collect::<Vec<_>>())
            }
        };
        let branch = &mut computed.branch;
        let first = computed.structure.model().contacts().first();
        let toward = first.map_or(0.0, |contact| contact.side.sign() * state.toward(0));
        branch.stop = branch.stop.map(|stop| stop + toward);
        for point in &mut branch.points {
            count_from_drawing(state, point);
            moved.iter().enumerate().for_each(|(d, by)| point.coefficients.of_mut(d)[0] += by);
        }
    }
}

/// Counts the displacement of the first contact of a point from the drawing, and its energy from that at rest.
pub fn count_from_drawing(state: &StaticState, point: &mut ModalPoint) {
    point.peak += state.toward(0);
    point.total_energy -= state.energy;
}

/// The displacements of these degrees of freedom under the static loads, m.
pub fn of_dofs(state: &StaticState, dofs: &[usize]) -> Vec<f64> {
    dofs.iter().map(|dof| state.displacement[*dof]).collect()
}

/// The displacements under the static loads in the coordinates that files have where all of these are written: of the
/// degrees of freedom of rods and beams, and of others in free-interface modes the reduced ones.
pub fn written_displacement(scene: &Scene, open: Option<&OpenStructure>, state: &StaticState) -> Vec<f64> {
    match open.filter(|_| scene.structure.straight().is_none()) {
        Some(open) => coordinates_of_state(open, state).col(0).iter().copied().collect(),
        None => state.displacement.clone(),
    }
}

/// Counts the motion of a contact, along a coordinate that grows `toward` its stop where that is one, from the drawing.
pub fn count_history_from_drawing(state: Option<&StaticState>, contact: usize, toward: f64, of: &mut TimeHistory) {
    let by = state.map_or(0.0, |state| toward * state.toward(contact));
    of.stop += by;
    of.displacement.iter_mut().for_each(|q| *q += by);
}

fn recover_branch(open: &OpenStructure, computed: &mut ComputedBranch) {
    let (dofs, coordinates) = recorded(&open.dofs, &open.modes);
    let branch = &mut computed.branch;
    branch.points.iter_mut().for_each(|point| recover_point(open, &dofs, point));
    branch.coordinates.clone_from(&coordinates);
    let first = computed.structure.model().contacts().first();
    let own = first.map(|contact| computed.structure.model().dofs()[contact.dof]);
    branch.contact_coordinate = own.and_then(|own| {
        branch.coordinates.iter().position(|c| c.kind == own.kind.name() && c.position == own.position)
    });
}

/// All degrees of freedom, or evenly chosen ones and those of the contacts; and what they are.
pub fn recorded(dofs: &[Dof], open: &OpenModes) -> (Vec<usize>, Vec<Coordinate>) {
    let n = dofs.len();
    let mut chosen: Vec<usize> = if n <= MAX_RECORDED {
        (0..n).collect()
    } else {
        let even = (0..MAX_RECORDED / 2).map(|j| 2 * j * n / MAX_RECORDED);
        even.chain(triplets(open.directions()).map(|(dof, _, _)| dof)).collect()
    };
    chosen.sort_unstable();
    chosen.dedup();
    let coordinate =
        |dof: &usize| Coordinate { position: dofs[*dof].position, kind: dofs[*dof].kind.name().to_owned() };
    let coordinates = chosen.iter().map(coordinate).collect();
    (chosen, coordinates)
}

/// The point with the displacements of these degrees of freedom.
fn recover_point(open: &OpenStructure, dofs: &[usize], point: &mut ModalPoint) {
    let q = open.reduced.displacements(&open.modes, dofs, &parts(&point.coefficients));
    point.coefficients = joined(&q);
}

/// The reduced coordinates of the displacement under static loads, as one column.
pub fn coordinates_of_state(open: &OpenStructure, state: &StaticState) -> Mat<f64> {
    let opening = &state.opening[..open.modes.n_contacts()];
    let [eta, gaps] = [&state.modal[..], opening].map(|of| Mat::from_fn(of.len(), 1, |i, _| of[i]));
    open.reduced.joined(&eta, &gaps)
}

/// The reduced coordinates of the displacements of all degrees of freedom, harmonic by harmonic; none where their mass
/// is not known.
pub fn reduced(open: &OpenStructure, coefficients: &HarmonicCoefficients) -> Option<HarmonicCoefficients> {
    open.reduced.coordinates(&open.modes, &parts(coefficients)).map(|x| joined(&x))
}

/// The reduced coordinates of displacements; none where their mass is not known.
pub fn reduced_state(open: &OpenStructure, q: &[f64]) -> Option<Vec<f64>> {
    let x = open.reduced.coordinates(&open.modes, &Mat::from_fn(q.len(), 1, |i, _| q[i]))?;
    Some((0..x.nrows()).map(|i| x[(i, 0)]).collect())
}

/// The displacements of all degrees of freedom of reduced coordinates.
pub fn displacements(open: &OpenStructure, x: &[f64]) -> Vec<f64> {
    let dofs: Vec<usize> = (0..open.dofs.len()).collect();
    let q = open.reduced.displacements(&open.modes, &dofs, &Mat::from_fn(x.len(), 1, |i, _| x[i]));
    (0..q.nrows()).map(|i| q[(i, 0)]).collect()
}

/// Real and imaginary parts, harmonic by harmonic: a column each.
pub fn parts(coefficients: &HarmonicCoefficients) -> Mat<f64> {
    let width = coefficients.n_harmonics() + 1;
    Mat::from_fn(coefficients.n_coordinates(), 2 * width, |d, k| {
        let q = coefficients.of(d)[k / 2];
        if k % 2 == 0 { q.re } else { q.im }
    })
}

/// Harmonics of real and imaginary parts, a column each.
pub fn joined(parts: &Mat<f64>) -> HarmonicCoefficients {
    let mut all = HarmonicCoefficients::zeros(parts.nrows(), parts.ncols() / 2 - 1);
    for d in 0..parts.nrows() {
        let harmonics = all.of_mut(d).iter_mut().enumerate();
        harmonics.for_each(|(n, value)| *value = Complex64::new(parts[(d, 2 * n)], parts[(d, 2 * n + 1)]));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes::linalg::multiply_many;
    use nlmodes_scene::assemble::{Structures, element_model};
    use nlmodes_scene::scene::SceneStructure;

    /// A beam before two stops, one on either side.
    fn scene() -> Scene {
        let text = "[structure]\nkind = \"beam\"\nlength_m = 0.6\nelements = 12\nstart = \"clamped\"\n\
            material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0, poissons_ratio = 0.3 }\n\
            section = { width_m = 0.012, height_m = 0.02 }\n\
            [[contact]]\nat_m = 0.6\ndirection = \"transverse\"\nside = \"positive\"\ngap_m = 1e-3\n\
            [[contact]]\nat_m = 0.3\ndirection = \"transverse\"\nside = \"negative\"\ngap_m = 1e-3\n\
            [method]\nharmonics = 2\n[reduction]\nmodes = 6\n[continuation]\nmax_energy_ratio = 2.0\n";
        let mut files =
            nlmodes_scene::parse_each_method("beam.toml", text, &[]).map_err(|refused| refused.text(false)).unwrap();
        files.swap_remove(0).scene
    }

    /// Coordinates of the contacts are displacements along the axis, whatever the side of the stop; the strain energy
    /// of the structure is that of the reduced one; and the way back leads to the same coordinates.
    #[test]
    fn displacements_of_a_beam_follow_from_its_reduced_coordinates_and_lead_back() {
        let scene = scene();
        let open = OpenStructure::of(&scene, &Structures::default()).unwrap();
        let n = open.reduced.model().dofs().len();
        let x: Vec<f64> = (0..n).map(|i| ((i * i + 3) % 7) as f64 - 2.5).collect();
        let q = displacements(&open, &x);
        let back = reduced_state(&open, &q).unwrap();
        assert!(back.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-9), "{back:?} {x:?}");
        let SceneStructure::Straight(structure) = &scene.structure else { panic!("a beam") };
        let full = element_model(structure, &scene.contacts).unwrap();
        for contact in open.reduced.model().contacts() {
            let (coordinate, at) = (contact.normal.entries()[0].0, open.reduced.model().dofs());
            let at = at[coordinate];
            let same = |dof: &nlmodes::model::Dof| (dof.kind, dof.position) == (at.kind, at.position);
            let dof = full.dofs().iter().position(same).unwrap();
            assert!((q[dof] - x[coordinate]).abs() < 1e-9, "{at:?}: {} {}", q[dof], x[coordinate]);
        }
        let energy = |k: &nlmodes::linalg::SparseMatrix, x: &[f64]| -> f64 {
            let column = Mat::from_fn(x.len(), 1, |i, _| x[i]);
            let force = multiply_many(k, &column);
            x.iter().enumerate().map(|(i, x)| x * force[(i, 0)]).sum()
        };
        let [own, whole] = [energy(open.reduced.model().stiffness(), &x), energy(full.stiffness(), &q)];
        assert!((own / whole - 1.0).abs() < 1e-8, "{own:e} {whole:e}");
    }
}
