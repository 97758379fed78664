//! Fill-reducing orderings of the unknowns.

use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

use feral_metis::{CscPattern, metis_order};

use crate::SparseMatrix;
use postorder::postordered;

mod postorder;

/// Below this size minimum degree is as good, and faster.
const SMALLEST: usize = 5_000;
/// Rods and beams have fewer entries per row; minimum degree eliminates them without fill, nested dissection does not.
const SPARSEST: usize = 16;

/// An order of elimination by nested dissection, `order[k]` being the column eliminated at step `k`; `None` if minimum
/// degree is the better choice: small matrices, and those of structures in one dimension.
pub(crate) fn nested_dissection(a: &SparseMatrix) -> Option<Vec<usize>> {
    let n = a.nrows();
    (n >= SMALLEST && a.compute_nnz() >= SPARSEST * n).then(|| dissect(a)).flatten()
}

/// Dissection of the graph of the nodes: columns with the same pattern, such as the degrees of freedom of one node, are
/// one vertex.
fn dissect(a: &SparseMatrix) -> Option<Vec<usize>> {
    let (vertex, members) = vertices(a);
    let (starts, neighbours) = graph(a, &vertex, &members)?;
    let pattern = CscPattern::new(members.len(), &starts, &neighbours)?;
    let order = metis_order(&pattern).ok()?;
    let order: Vec<usize> = order.iter().filter_map(|&v| usize::try_from(v).ok()).collect();
    let order = (order.len() == members.len()).then(|| postordered(&order, &starts, &neighbours))?;
    let expanded: Vec<usize> = order.iter().filter_map(|&v| members.get(v)).flatten().copied().collect();
    (expanded.len() == a.ncols()).then_some(expanded)
}

/// The vertex of each column, and the columns of each vertex.
fn vertices(a: &SparseMatrix) -> (Vec<usize>, Vec<Vec<usize>>) {
    let rows = |j: usize| a.symbolic().row_idx_of_col_raw(j);
    let mut by_hash: HashMap<u64, Vec<usize>> = HashMap::new();
    let (mut vertex, mut members) = (Vec::with_capacity(a.ncols()), Vec::<Vec<usize>>::new());
    for j in 0..a.ncols() {
        let mut hasher = DefaultHasher::new();
        rows(j).hash(&mut hasher);
        let same = by_hash.entry(hasher.finish()).or_default();
        match same.iter().find(|&&v| rows(members[v][0]) == rows(j)) {
            Some(&v) => {
                members[v].push(j);
                vertex.push(v);
            }
            None => {
                same.push(members.len());
                vertex.push(members.len());
                members.push(vec![j]);
            }
        }
    }
    (vertex, members)
}

/// Neighbours of each vertex, ascending, in compressed form; `None` if the graph is too large for the ordering's
/// indices.
fn graph(a: &SparseMatrix, vertex: &[usize], members: &[Vec<usize>]) -> Option<(Vec<i32>, Vec<i32>)> {
    let mut lists: Vec<Vec<i32>> = vec![Vec::new(); members.len()];
    for (v, columns) in members.iter().enumerate() {
        let own = i32::try_from(v).ok()?;
        // In both directions, so that the graph is also correct if only one triangle is stored.
        for w in a.symbolic().row_idx_of_col_raw(columns[0]).iter().map(|&i| vertex[i]).filter(|&w| w != v) {
            lists[v].push(i32::try_from(w).ok()?);
            lists[w].push(own);
        }
        // Entries from earlier columns occur repeatedly.
        if lists[v].len() > 4096 {
            lists[v].sort_unstable();
            lists[v].dedup();
        }
    }
    let (mut starts, mut neighbours) = (vec![0], Vec::new());
    for mut list in lists {
        list.sort_unstable();
        list.dedup();
        neighbours.extend(list);
        starts.push(i32::try_from(neighbours.len()).ok()?);
    }
    Some((starts, neighbours))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse_from_triplets;

    /// `size`³ nodes with three unknowns each, coupled to all nodes around.
    fn cube(size: usize) -> SparseMatrix {
        let at = |x: usize, y: usize, z: usize| (x * size + y) * size + z;
        let near = |x: usize| x.saturating_sub(1)..(x + 2).min(size);
        let mut entries = Vec::new();
        for (x, y, z) in (0..size.pow(3)).map(|i| (i / size / size, i / size % size, i % size)) {
            for (u, v, w) in near(x).flat_map(|u| near(y).flat_map(move |v| near(z).map(move |w| (u, v, w)))) {
                let (i, j) = (at(x, y, z), at(u, v, w));
                entries.extend(
                    (0..9).map(|k| (3 * i + k / 3, 3 * j + k % 3, if i == j && k % 4 == 0 { 100.0 } else { -0.5 })),
                );
            }
        }
        sparse_from_triplets(3 * size.pow(3), 3 * size.pow(3), &entries).unwrap()
    }

    #[test]
    fn the_unknowns_of_a_node_are_one_vertex_and_stay_together() {
        let a = cube(6);
        let (vertex, members) = vertices(&a);
        assert_eq!(members.len(), 216);
        assert!((0..216).all(|i| vertex[3 * i] == vertex[3 * i + 1] && vertex[3 * i] == vertex[3 * i + 2]));
        let order = dissect(&a).unwrap();
        let mut seen = vec![false; a.ncols()];
        order.iter().for_each(|&j| seen[j] = true);
        assert!(seen.iter().all(|s| *s) && order.len() == seen.len());
        assert!(order.chunks(3).all(|node| node.iter().all(|j| j / 3 == node[0] / 3)));
        assert_eq!(dissect(&a), Some(order));
    }

    #[test]
    fn chains_and_small_matrices_are_left_to_minimum_degree() {
        assert_eq!(nested_dissection(&cube(6)), None);
        let n = 20_000;
        let entries: Vec<_> =
            (0..n).flat_map(|i| [(i, i, 2.0), (i, (i + 1) % n, -1.0), ((i + 1) % n, i, -1.0)]).collect();
        assert_eq!(nested_dissection(&sparse_from_triplets(n, n, &entries).unwrap()), None);
        assert!(nested_dissection(&cube(12)).is_some());
    }

    #[test]
    fn dissection_leaves_less_fill_than_minimum_degree_on_a_cube() {
        let a = cube(16);
        let dissected = crate::CholeskyPlan::new(&a, "cube").unwrap();
        let minimum = crate::CholeskyPlan::by_minimum_degree(&a, "cube").unwrap();
        assert!(dissected.flops() < 0.9 * minimum.flops(), "{:e} {:e}", dissected.flops(), minimum.flops());
        // Both factors solve the same system.
        let b: Vec<f64> = (0..a.nrows()).map(|i| ((7 * i) % 11) as f64 - 5.0).collect();
        let [mut x, mut y] = [b.clone(), b];
        dissected.factor(&a, "cube").unwrap().solve_in_place(&mut x);
        minimum.factor(&a, "cube").unwrap().solve_in_place(&mut y);
        let size = crate::max_norm(y.iter().copied());
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-12 * size));
    }
}
