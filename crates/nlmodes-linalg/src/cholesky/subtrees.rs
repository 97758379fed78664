//! Parts of an elimination that do not depend on each other.

use std::ops::Range;

use super::panels::Panels;

/// A part with more than this fraction of the factor is divided further.
const LARGEST: f64 = 0.15;
/// Parts with less than this fraction are not worth a task.
const SMALLEST: f64 = 0.01;
/// Factors with fewer numbers are not divided and use one thread: 32 megabytes, as for solids with some 10⁴ unknowns.
const UNDIVIDED: usize = 1 << 22;

/// Subtrees of the elimination tree, and everything above them: the top. They depend on the pattern alone, not on the
/// number of threads.
#[derive(Debug, Clone, Default)]
pub(super) struct Subtrees {
    /// In ascending order.
    pub parts: Vec<Subtree>,
    /// The panels of the top, ascending.
    pub top: Vec<usize>,
    /// The index of each row among the rows of the top; meaningless for other rows.
    place_in_top: Vec<u32>,
    /// Columns of the top, in runs, ascending.
    pub columns_of_top: Vec<Range<usize>>,
    /// Number of rows of the top.
    pub rows_of_top: usize,
}

/// A subtree: beyond its own columns it changes only the rows of its last node.
#[derive(Debug, Clone)]
pub(super) struct Subtree {
    pub panels: Range<usize>,
    pub columns: Range<usize>,
    /// Its last node.
    pub root: usize,
    /// Numbers in its panels.
    pub numbers: usize,
}

impl Subtrees {
    pub fn place_in_top(&self, row: usize) -> usize {
        self.place_in_top[row] as usize
    }

    pub fn of(panels: &Panels) -> Self {
        let tree = Tree::of(panels);
        let total: usize = panels.numbers();
        let mut parts: Vec<Subtree> = if total < UNDIVIDED {
            Vec::new()
        } else {
            tree.divided(total).into_iter().map(|node| tree.subtree(panels, node)).collect()
        };
        parts.sort_by_key(|part| part.columns.start);
        Self::beside(parts, panels)
    }

    /// With the top that remains beside these parts.
    fn beside(parts: Vec<Subtree>, panels: &Panels) -> Self {
        let (mut top, mut columns_of_top, mut place_in_top) = (Vec::new(), Vec::new(), vec![0; panels.nrows()]);
        let (mut panel, mut column, mut rows_of_top) = (0, 0, 0);
        let end = (panels.len()..panels.len(), panels.nrows()..panels.nrows());
        for part in parts.iter().map(|part| (part.panels.clone(), part.columns.clone())).chain([end]) {
            top.extend(panel..part.0.start);
            let places = &mut place_in_top[column..part.1.start];
            (rows_of_top..).zip(places).for_each(|(at, place)| *place = at as u32);
            rows_of_top += part.1.start - column;
            if column < part.1.start {
                columns_of_top.push(column..part.1.start);
            }
            (panel, column) = (part.0.end, part.1.end);
        }
        Self { parts, top, place_in_top, columns_of_top, rows_of_top }
    }
}

/// The elimination tree of the nodes.
struct Tree {
    children: Vec<Vec<usize>>,
    roots: Vec<usize>,
    /// Numbers in the panels of each node and of all below it.
    numbers: Vec<usize>,
    /// The first node of each subtree.
    first: Vec<usize>,
    /// Whether the nodes of a subtree are contiguous.
    whole: Vec<bool>,
}

impl Tree {
    fn of(panels: &Panels) -> Self {
        let count = panels.n_nodes();
        let numbers = |node: usize| panels.of_node(node).map(|p| panels.height(p) * panels.panel(p).width()).sum();
        let mut tree = Self {
            children: vec![Vec::new(); count],
            roots: Vec::new(),
            numbers: (0..count).map(numbers).collect(),
            first: (0..count).collect(),
            whole: vec![true; count],
        };
        let mut size = vec![1; count];
        for node in 0..count {
            tree.whole[node] = node + 1 - tree.first[node] == size[node];
            match panels.rows_of_node(node).first() {
                Some(&row) => {
                    let parent = panels.panel(panels.of_column(row as usize)).node;
                    tree.children[parent].push(node);
                    tree.numbers[parent] += tree.numbers[node];
                    tree.first[parent] = tree.first[parent].min(tree.first[node]);
                    size[parent] += size[node];
                }
                None => tree.roots.push(node),
            }
        }
        tree
    }

    /// The nodes below which subtrees are neither too large nor too small.
    fn divided(&self, total: usize) -> Vec<usize> {
        let share = |node: usize| self.numbers[node] as f64 / total as f64;
        let (mut waiting, mut found) = (self.roots.clone(), Vec::new());
        while let Some(node) = waiting.pop() {
            if share(node) > LARGEST || !self.whole[node] {
                waiting.extend(self.children[node].iter().filter(|&&child| share(child) >= SMALLEST));
            } else if share(node) >= SMALLEST {
                found.push(node);
            }
        }
        found
    }

    fn subtree(&self, panels: &Panels, root: usize) -> Subtree {
        let (first, last) = (panels.of_node(self.first[root]), panels.of_node(root));
        let columns = panels.columns_of_node(self.first[root]).start..panels.columns_of_node(root).end;
        Subtree { panels: first.start..last.end, columns, root, numbers: self.numbers[root] }
    }
}
