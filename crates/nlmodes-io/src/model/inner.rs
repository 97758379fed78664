//! Nodes that are none: unknowns within elements, which some programs write as displacements of nodes of their own.

use super::FeModel;

/// Displacements of all other nodes act on a node with at least this fraction of its own stiffness. On unknowns within
/// an element they act only through distortion, on a node next to a support with about half.
const ANSWERS: f64 = 0.2;

impl FeModel {
    /// Nodes that do not answer a rigid displacement of all others, ascending:
    ///
    /// ```text
    /// −Σ_j K_ij < 0.2 K_ii ,   summed over the three directions, j of other nodes
    /// ```
    ///
    /// At nodes of a mesh the left side is `K_ii`, less what supports take. Unknowns within elements, as those of
    /// CalculiX's C3D8I, have zero: the strain that they add vanishes where all else moves as one. So has a mass on
    /// springs to the ground alone.
    pub fn nodes_without_answer(&self) -> Vec<u64> {
        let nodes = self.nodes();
        let axes: Vec<Option<usize>> = self.labels.iter().map(|label| label.component.translation()).collect();
        let of_row = |row: usize| nodes.binary_search(&self.labels[row].node).ok();
        let at: Vec<Option<usize>> = (0..self.n_dofs()).map(of_row).collect();
        let (mut own, mut answer) = (vec![0.0; nodes.len()], vec![0.0; nodes.len()]);
        for (i, j, value) in self.stiffness.entries().filter(|(i, j, _)| axes[*i].is_some() && axes[*i] == axes[*j]) {
            if let (Some(one), Some(other)) = (at[i], at[j]) {
                match i == j {
                    true => own[one] += value,
                    false => [one, other].into_iter().for_each(|node| answer[node] -= value),
                }
            }
        }
        let silent =
            |k: &usize| self.within.contains_key(&nodes[*k]) || (own[*k] > 0.0 && answer[*k] < ANSWERS * own[*k]);
        (0..nodes.len()).filter(silent).map(|k| nodes[k]).collect()
    }
}
