//! The same elimination in another sequence: every subtree of the elimination tree is contiguous.

/// `order` of the vertices of a graph, rearranged so that the vertices on which a vertex depends are directly before
/// it. Fill and work are unchanged; columns that can be eliminated together become adjacent, and independent parts
/// become contiguous.
pub(super) fn postordered(order: &[usize], starts: &[i32], neighbours: &[i32]) -> Vec<usize> {
    let parents = parents(order, starts, neighbours);
    let (mut first_child, mut next_sibling) = (vec![NONE; order.len()], vec![NONE; order.len()]);
    for k in (0..order.len()).rev().filter(|&k| parents[k] != NONE) {
        next_sibling[k] = std::mem::replace(&mut first_child[parents[k]], k);
    }
    let mut sequence = Vec::with_capacity(order.len());
    for root in (0..order.len()).filter(|&k| parents[k] == NONE) {
        let mut at = root;
        loop {
            // Down to a leaf, and up again as long as there are no siblings left.
            while first_child[at] != NONE {
                at = std::mem::replace(&mut first_child[at], NONE);
            }
            sequence.push(order[at]);
            if at == root {
                break;
            }
            at = if next_sibling[at] == NONE { parents[at] } else { next_sibling[at] };
        }
    }
    sequence
}

const NONE: usize = usize::MAX;

/// The elimination tree: for each step, the first later one that it changes.
fn parents(order: &[usize], starts: &[i32], neighbours: &[i32]) -> Vec<usize> {
    let mut step = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &v)| step[v] = k);
    let (mut parents, mut ancestors) = (vec![NONE; order.len()], vec![NONE; order.len()]);
    for (k, &v) in order.iter().enumerate() {
        for &w in &neighbours[starts[v] as usize..starts[v + 1] as usize] {
            let mut at = step[w as usize];
            // The path from an earlier step to its current root, with path compression.
            while at < k {
                let next = std::mem::replace(&mut ancestors[at], k);
                if next == NONE {
                    parents[at] = k;
                }
                at = next;
            }
        }
    }
    parents
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subtrees_are_in_one_piece_and_come_before_what_they_change() {
        // A path of seven, eliminated alternately from both ends, the middle last: two chains.
        let neighbours = [1, 0, 2, 1, 3, 2, 4, 3, 5, 4, 6, 5];
        let starts = [0, 1, 3, 5, 7, 9, 11, 12];
        let sequence = postordered(&[0, 6, 1, 5, 2, 4, 3], &starts, &neighbours);
        assert_eq!(sequence, [0, 1, 2, 6, 5, 4, 3]);
        // It is already in that sequence, and two independent parts are unchanged.
        assert_eq!(postordered(&sequence, &starts, &neighbours), sequence);
        assert_eq!(postordered(&[1, 0], &[0, 0, 0], &[]), [1, 0]);
    }
}
