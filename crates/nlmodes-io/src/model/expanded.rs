//! Shells, beams, trusses, plane and axisymmetric elements, which CalculiX expands into solids: its table of labels
//! then has a node once for each node of the solid that comes of it.
//!
//! A node moves as the mean of the m nodes that come of it, and how these move against each other is within the
//! elements:
//!
//! ```text
//! p₁ = (q₁ + … + q_m)/m ,  p_k = q_k − q₁ for k ≥ 2 ;   q₁ = p₁ − Σ p_k/m ,  q_k = q₁ + p_k
//! ```
//!
//! A hinge, as of trusses and membranes, comes before the nodes that come of it and moves by itself, `q₁ = p₁`. A rigid
//! displacement moves p₁ alone in both. Frequencies are those of all rows.

use std::collections::{BTreeMap, HashMap};

use super::FeFiles;
use crate::error::{Place, Problem, ReadError, Result};
use crate::labels::{Component, DofLabel, LabelTable, found_again};
use crate::lower::Motion;
use crate::mesh::{Expanded, Mesh};

/// Labels of the new unknowns, and what the rows of the files are of them.
pub(super) struct Means {
    pub(super) labels: Vec<DofLabel>,
    pub(super) motion: Motion,
    /// Numbers of nodes that represent unknowns within elements, and the nodes from which they originate.
    pub(super) within: BTreeMap<u64, u64>,
    /// The next such number.
    next: u64,
}

/// What becomes of the rows of a label.
enum Role {
    /// The one row is the motion of the node.
    Own,
    /// Their mean is.
    Mean,
    /// The first row is.
    First,
    /// Some are eliminated: the rest does not determine the motion of the node.
    Within,
}

/// The unknowns of a table with nodes that were expanded; none of another one.
pub(super) fn means(files: &FeFiles, table: &LabelTable, mesh: Option<&Mesh>) -> Result<Option<Means>> {
    let expanded = mesh.map(|mesh| &mesh.expanded).filter(|expanded| !expanded.is_empty());
    let Some((expanded, mesh)) = expanded.zip(mesh) else {
        return table.repeated.map_or(Ok(None), |_| Err(refused(files, table, mesh)));
    };
    let mut rows: HashMap<DofLabel, Vec<usize>> = HashMap::new();
    for (row, label) in table.labels.iter().enumerate() {
        rows.entry(*label).or_default().push(row);
    }
    let highest = table.labels.iter().map(|label| label.node).chain(mesh.numbers.iter().copied()).max();
    let next = highest.unwrap_or(0) + 1;
    // Rows are in the order of CalculiX's own numbers: nodes of the deck come before those that come of them.
    let ascending = table.labels.windows(2).position(|two| two[0] >= two[1]).map_or(table.labels.len(), |k| k + 1);
    let n = table.labels.len();
    let motion = (0..n).map(|row| vec![(row, 1.0)]).collect();
    let mut means = Means { labels: table.labels.clone(), motion, within: BTreeMap::new(), next };
    for row in 0..n {
        let label = table.labels[row];
        let Some(same) = rows.remove(&label) else { continue };
        let knot = row < ascending && !mesh.holds(label);
        match role(expanded.get(&label.node).copied(), label.component, same.len(), knot) {
            Some(Role::Own) => {}
            Some(Role::Mean) => means.relate(&same, 1.0 / same.len() as f64),
            Some(Role::First) => means.relate(&same, 0.0),
            Some(Role::Within) => same.iter().for_each(|row| means.within(*row)),
            None => return Err(refused(files, table, Some(mesh))),
        }
    }
    Ok((!means.within.is_empty()).then_some(means))
}

/// `knot` says that the first row may be that of the node itself, on which those that come of it depend: hinges, and
/// where beams or shells meet at an angle or have an offset.
fn role(expanded: Option<Expanded>, component: Component, rows: usize, knot: bool) -> Option<Role> {
    match (expanded, rows) {
        (None, 1) => Some(Role::Own),
        (Some(Expanded::Copies(_)), 1) if knot => Some(Role::Own),
        (None, _) => None,
        (Some(Expanded::InPlane), 1) if component != Component::Z => Some(Role::Own),
        (Some(Expanded::Copies(copies)), _) if copies == rows => Some(Role::Mean),
        (Some(Expanded::Hinge(others)), _) if others + 1 == rows => Some(Role::First),
        // A bar that cannot turn about itself has one of its nodes depend on the others in one direction more.
        (Some(Expanded::Hinge(others)), 2..) if knot && rows <= others => Some(Role::First),
        _ => Some(Role::Within),
    }
}

impl Means {
    /// The first row becomes what a node moves by, the others how they move against it; `share` is that of each other
    /// row in the motion of the node.
    fn relate(&mut self, rows: &[usize], share: f64) {
        let Some((first, others)) = rows.split_first() else { return };
        let back = |own: Option<usize>| {
            let part = move |row: usize| f64::from(u8::from(own == Some(row))) - share;
            let terms = others.iter().map(move |row| (*row, part(*row)));
            std::iter::once((*first, 1.0)).chain(terms.filter(|(_, part)| *part != 0.0)).collect()
        };
        self.motion[*first] = back(None);
        for row in others {
            self.motion[*row] = back(Some(*row));
        }
        others.iter().for_each(|row| self.within(*row));
    }

    /// Names a row as an unknown within elements.
    fn within(&mut self, row: usize) {
        self.within.insert(self.next, self.labels[row].node);
        self.labels[row].node = self.next;
        self.next += 1;
    }
}

/// Duplicate labels without an explanation in the deck.
fn refused(files: &FeFiles, table: &LabelTable, mesh: Option<&Mesh>) -> ReadError {
    let path = files.dofs.as_deref().unwrap_or(&files.stiffness.path);
    let Some(repeated) = table.repeated else {
        let problem = Problem::Expected { expected: "each node and direction once".into(), found: "one twice".into() };
        return ReadError::whole(path, problem);
    };
    let why = match mesh {
        None => {
            "CalculiX repeats the nodes of shells, beams, trusses, plane and axisymmetric elements, which it expands \
             into solids: give the deck as `mesh`, which tells what they are"
        }
        Some(_) => {
            "CalculiX repeats only nodes of shells, beams, trusses, plane and axisymmetric elements, and the deck has \
             no such element there: are deck and table of one run?"
        }
    };
    let expected = format!("each node and direction once ({why})");
    let problem = Problem::Expected { expected, found: found_again(repeated.label, repeated.before) };
    ReadError::new(path, Place::Line(repeated.line), problem)
}
