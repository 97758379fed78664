//! Storage of a factor with dense blocks.

use std::ops::Range;

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use super::subtrees::Subtrees;

/// Maximum number of columns of a panel. The part above the diagonal of a panel is stored too: wider panels waste more
/// memory, narrower ones make products slower.
pub(super) const WIDEST: usize = 128;

/// The columns of the factor in panels with the same rows below them. Columns that can be eliminated together form a
/// node; a wide node has several panels, each with the rows from its own diagonal on.
#[derive(Debug, Clone)]
pub(super) struct Panels {
    panels: Vec<Panel>,
    /// The first panel of each node, and one past the last panel.
    first_of_node: Vec<usize>,
    /// Rows of the nodes beyond their columns: those of node `s` are `rows[row_starts[s]..row_starts[s + 1]]`.
    rows: Vec<u32>,
    row_starts: Vec<usize>,
    /// The panel of each column.
    of_column: Vec<u32>,
    /// The nodes before its own that change a panel, ascending: those of panel `p` are
    /// `changed_by[starts[p]..starts[p + 1]]`.
    changed_by: Vec<u32>,
    starts: Vec<usize>,
    tallest: usize,
    pub subtrees: Subtrees,
}

/// Columns `first..end` of node `node`, whose columns end at `node_end`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Panel {
    pub node: usize,
    pub first: usize,
    pub end: usize,
    pub node_end: usize,
}

impl Panel {
    pub fn width(&self) -> usize {
        self.end - self.first
    }
}

impl Panels {
    pub fn new(nodes: &SymbolicSupernodalCholesky<usize>) -> Self {
        let (panels, first_of_node) = divide(nodes);
        let mut of_column = vec![0; nodes.nrows()];
        for (p, panel) in (0..).zip(&panels) {
            of_column[panel.first..panel.end].fill(p);
        }
        let (mut rows, mut row_starts) = (Vec::with_capacity(nodes.row_idx().len()), vec![0]);
        for node in 0..nodes.n_supernodes() {
            rows.extend(nodes.supernode(node).pattern().iter().map(|&row| row as u32));
            row_starts.push(rows.len());
        }
        let mut own = Self {
            panels,
            first_of_node,
            rows,
            row_starts,
            of_column,
            changed_by: Vec::new(),
            starts: Vec::new(),
            tallest: 0,
            subtrees: Subtrees::default(),
        };
        (own.changed_by, own.starts) = own.changes();
        own.tallest = (0..own.len()).map(|p| own.height(p) - own.panel(p).width()).max().unwrap_or(0);
        own.subtrees = Subtrees::of(&own);
        own
    }

    pub fn nrows(&self) -> usize {
        self.of_column.len()
    }

    /// Number of panels.
    pub fn len(&self) -> usize {
        self.panels.len()
    }

    pub fn n_nodes(&self) -> usize {
        self.first_of_node.len() - 1
    }

    pub fn panel(&self, p: usize) -> Panel {
        self.panels[p]
    }

    pub fn of_column(&self, column: usize) -> usize {
        self.of_column[column] as usize
    }

    pub fn of_node(&self, node: usize) -> Range<usize> {
        self.first_of_node[node]..self.first_of_node[node + 1]
    }

    /// Rows of a node beyond its columns, ascending.
    pub fn rows_of_node(&self, node: usize) -> &[u32] {
        &self.rows[self.row_starts[node]..self.row_starts[node + 1]]
    }

    pub fn columns_of_node(&self, node: usize) -> Range<usize> {
        let panel = self.panels[self.first_of_node[node]];
        panel.first..panel.node_end
    }

    /// Rows of a panel beyond its columns, ascending: the other columns of its node, and the rows of that.
    pub fn rows(&self, p: usize) -> impl Iterator<Item = usize> + '_ {
        let panel = self.panels[p];
        (panel.end..panel.node_end).chain(self.rows_of_node(panel.node).iter().map(|&row| row as usize))
    }

    /// The same in two parts: those before row `end`, and the others, which belong to the rows of the node.
    pub fn rows_before(&self, p: usize, end: usize) -> (impl Iterator<Item = usize> + Clone + '_, &[u32]) {
        let panel = self.panels[p];
        let rows = self.rows_of_node(panel.node);
        let (here, elsewhere) = rows.split_at(rows.partition_point(|&row| (row as usize) < end));
        ((panel.end..panel.node_end).chain(here.iter().map(|&row| row as usize)), elsewhere)
    }

    /// Largest number of rows of a panel beyond its columns.
    pub fn tallest(&self) -> usize {
        self.tallest
    }

    /// Number of rows of a panel, including those of its diagonal block.
    pub fn height(&self, p: usize) -> usize {
        let panel = self.panels[p];
        panel.node_end - panel.first + self.rows_of_node(panel.node).len()
    }

    /// The nodes before its own that change panel `p`, ascending.
    pub fn changed_by(&self, p: usize) -> &[u32] {
        &self.changed_by[self.starts[p]..self.starts[p + 1]]
    }

    /// The nodes that change each panel, in one list, and the start of each panel in it.
    fn changes(&self) -> (Vec<u32>, Vec<usize>) {
        let changed = |node: usize| {
            let mut last = None;
            self.rows_of_node(node).iter().filter_map(move |&row| {
                let p = self.of_column(row as usize);
                (last.replace(p) != Some(p)).then_some(p)
            })
        };
        let mut starts = vec![0; self.len() + 1];
        (0..self.n_nodes()).flat_map(changed).for_each(|p| starts[p + 1] += 1);
        (0..self.len()).for_each(|p| starts[p + 1] += starts[p]);
        let (mut next, mut list) = (starts.clone(), vec![0; starts[self.len()]]);
        for (number, node) in (0..).zip(0..self.n_nodes()) {
            for p in changed(node) {
                list[next[p]] = number;
                next[p] += 1;
            }
        }
        (list, starts)
    }

    /// Numbers in all panels.
    pub fn numbers(&self) -> usize {
        (0..self.len()).map(|p| self.height(p) * self.panels[p].width()).sum()
    }

    /// Rows in each column of each panel: its diagonal and the part below.
    pub fn rows_of_columns(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).flat_map(move |p| (0..self.panels[p].width()).map(move |k| self.height(p) - k))
    }
}

/// The panels of all nodes, and the first panel of each.
fn divide(nodes: &SymbolicSupernodalCholesky<usize>) -> (Vec<Panel>, Vec<usize>) {
    let (mut panels, mut first_of_node) = (Vec::new(), vec![0]);
    for (node, (&begin, &node_end)) in nodes.supernode_begin().iter().zip(nodes.supernode_end()).enumerate() {
        let count = (node_end - begin).div_ceil(WIDEST).max(1);
        // All of equal width, in steps of eight.
        let width = (node_end - begin).div_ceil(count).next_multiple_of(8);
        for first in (begin..node_end).step_by(width) {
            panels.push(Panel { node, first, end: node_end.min(first + width), node_end });
        }
        first_of_node.push(panels.len());
    }
    (panels, first_of_node)
}
