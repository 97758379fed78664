//! Damping of a scene, in its free-interface modes.

use nlmodes::linalg::{Mat, multiply_many};
use nlmodes::model::StructuralModel;
use nlmodes::response::Damping;
use nlmodes_scene::scene::{ModeDamping, Scene};

use super::Reduced;

/// Squared frequencies that differ by less, relative to them, are one: a mode may then be a mixture of those of several
/// structures.
const SAME: f64 = 1e-6;

/// The damping of the modes, without dashpots.
pub fn damping(scene: &Scene, parts: &Reduced) -> Damping {
    let of_scene = scene.damping.as_ref().map(|damping| &damping.modes);
    let bodies: Vec<_> = parts.bodies().collect();
    if bodies.is_empty() {
        return match of_scene {
            Some(ModeDamping::Rayleigh { mass, stiffness }) => Damping::Rayleigh { mass: *mass, stiffness: *stiffness },
            Some(ModeDamping::Ratios(ratios)) => Damping::Ratios(ratios.clone()),
            None => Damping::Ratios(vec![0.0]),
        };
    }
    let open = &parts.open;
    let omega: Vec<f64> = open.omega_squared().iter().map(|square| square.max(0.0).sqrt()).collect();
    let groups = groups(open.omega_squared());
    let mut all = Mat::zeros(omega.len(), omega.len());
    for ((first, model), structure) in bodies.into_iter().zip(scene.structure.bodies()) {
        let Some(own) = structure.damping.as_ref().or(of_scene) else { continue };
        let shares = shares(open.shapes(), first, model);
        let mut number = 0;
        for group in &groups {
            for (i, j) in group.clone().flat_map(|i| group.clone().map(move |j| (i, j))) {
                all[(i, j)] += constant(own, number, omega[i] * omega[j]) * shares[(i, j)];
            }
            // Of modes with one frequency each structure has as many as its shares of the kinetic energy add up to.
            number += group.clone().map(|i| shares[(i, i)]).sum::<f64>().round() as usize;
        }
    }
    Damping::Coupled(all)
}

/// `2 ζ_k ω`, or `mass + stiffness ω²`, 1/s, of the mode `number` (from 0) of a structure.
fn constant(damping: &ModeDamping, number: usize, omega_squared: f64) -> f64 {
    match damping {
        ModeDamping::Ratios(ratios) => {
            let ratio = ratios.get(number).or(ratios.last()).copied().unwrap_or(0.0);
            2.0 * ratio * omega_squared.sqrt()
        }
        ModeDamping::Rayleigh { mass, stiffness } => mass + stiffness * omega_squared,
    }
}

/// Modes with one frequency.
fn groups(omega_squared: &[f64]) -> Vec<std::ops::Range<usize>> {
    let size = omega_squared.last().copied().unwrap_or(0.0).abs();
    let mut groups: Vec<std::ops::Range<usize>> = Vec::new();
    for (k, square) in omega_squared.iter().enumerate() {
        let before = k.checked_sub(1).map(|before| omega_squared[before]);
        let is_same = before.is_some_and(|before| square - before <= SAME * square.abs() + f64::EPSILON * size);
        match groups.last_mut().filter(|_| is_same) {
            Some(group) => group.end = k + 1,
            None => groups.push(k..k + 1),
        }
    }
    groups
}

/// `Φ_sᵀ M_s Φ_s` (m × m) of the structure whose degrees of freedom begin at `first`: 1 on the diagonal for its own
/// modes, 0 for those of others.
fn shares(shapes: &Mat<f64>, first: usize, model: &StructuralModel) -> Mat<f64> {
    let own = shapes.subrows(first, model.dofs().len()).to_owned();
    own.transpose() * multiply_many(model.mass(), &own)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_frequencies_are_one_group_whatever_their_unit() {
        for unit in [1.0, 1e-8, 1e10] {
            let squares = [0.0, 1e-12, 2.0, 2.0 + 1e-9, 5.0, 7.0, 7.0].map(|square| unit * square);
            assert_eq!(groups(&squares), [0..1, 1..2, 2..4, 4..5, 5..7]);
            assert_eq!(groups(&[-1e-17 * unit, 1e-16 * unit, 9.0 * unit]), [0..2, 2..3]);
        }
    }
}
