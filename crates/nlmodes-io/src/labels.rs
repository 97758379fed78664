//! Which node and direction a row of the matrices belongs to.

mod calculix;
mod entries;
mod mapping;
mod table;
mod values;

use std::collections::HashMap;
use std::fmt;
use std::path::Path;

use crate::Address;
use crate::error::{Problem, ReadError, Result};
pub use entries::{ParameterEntry, read_parameter_entries};
pub use values::read_nodal_values;

/// What a degree of freedom of a node measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Component {
    /// Displacement along x.
    X,
    /// Displacement along y.
    Y,
    /// Displacement along z.
    Z,
    /// Rotation about x.
    RX,
    /// Rotation about y.
    RY,
    /// Rotation about z.
    RZ,
    /// A generalised coordinate of a reduced model, which no place belongs to.
    Modal,
}

impl Component {
    /// The components with a direction, in the order of their numbers from 1.
    pub const DIRECTED: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::RX, Self::RY, Self::RZ];

    /// The component of this number, 1 to 6.
    pub fn from_number(number: u64) -> Option<Self> {
        Self::DIRECTED.get(usize::try_from(number.checked_sub(1)?).ok()?).copied()
    }

    /// The component of this name: `1` to `6`, `ux` … `uz`, `rotx` … `rotz`, in small or capital letters.
    pub fn from_name(name: &str) -> Option<Self> {
        let lower = name.to_lowercase();
        let at = |names: [&str; 6]| names.iter().position(|n| *n == lower);
        let at = at(["1", "2", "3", "4", "5", "6"]).or_else(|| at(["ux", "uy", "uz", "rotx", "roty", "rotz"]))?;
        Some(Self::DIRECTED[at])
    }

    /// Name as in tables: `ux` … `rotz`, `modal`.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "ux",
            Self::Y => "uy",
            Self::Z => "uz",
            Self::RX => "rotx",
            Self::RY => "roty",
            Self::RZ => "rotz",
            Self::Modal => "modal",
        }
    }

    /// Axis of a displacement, 0 to 2.
    pub fn translation(self) -> Option<usize> {
        [Self::X, Self::Y, Self::Z].iter().position(|c| *c == self)
    }

    /// Axis of a rotation, 0 to 2.
    pub fn rotation(self) -> Option<usize> {
        [Self::RX, Self::RY, Self::RZ].iter().position(|c| *c == self)
    }
}

/// Node and direction of a degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct DofLabel {
    /// Number of the node in the files.
    pub node: u64,
    /// What is measured there.
    pub component: Component,
}

impl fmt::Display for DofLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of node {}", self.component.name(), self.node)
    }
}

/// Labels of all rows, and places where the file gives them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LabelTable {
    /// One for each row of the matrices, in their order.
    pub labels: Vec<DofLabel>,
    /// Places of nodes, in the file's unit of length.
    pub positions: HashMap<u64, [f64; 3]>,
    /// The first label that comes a second time: CalculiX repeats those of nodes that it expands into several ones.
    pub repeated: Option<RepeatedLabel>,
}

/// A label that comes a second time in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RepeatedLabel {
    /// The label.
    pub label: DofLabel,
    /// Its line, from 1.
    pub line: u64,
    /// The line in which it came first.
    pub before: u64,
}

impl LabelTable {
    /// Reads a table of labels: `.dof` of CalculiX (a line `node.direction` for each row), `.mapping` of Ansys
    /// (equation, node, name of the direction), anything else as comma-separated `row,node,component[,x,y,z]`.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn read(path: &Path) -> Result<Self> {
        let address = Address { path: path.to_owned(), name: None };
        match address.ending().as_str() {
            "dof" => calculix::read(path),
            "mapping" => mapping::read(path),
            "csv" | "txt" => table::read(path),
            _ => Err(ReadError::whole(
                path,
                Problem::Expected {
                    expected: "a table of degrees of freedom that ends in .dof, .mapping or .csv".into(),
                    found: format!("`.{}`", address.ending()),
                },
            )),
        }
    }
}

/// Labels in the order in which they come, each at most once.
#[derive(Default)]
pub(crate) struct Distinct {
    labels: Vec<DofLabel>,
    lines: HashMap<DofLabel, u64>,
}

impl Distinct {
    /// The line in which the same label came before.
    pub(crate) fn push(&mut self, label: DofLabel, line: u64) -> Option<u64> {
        if let Some(before) = self.lines.insert(label, line) {
            return Some(before);
        }
        self.labels.push(label);
        None
    }

    pub(crate) fn finish(self) -> Vec<DofLabel> {
        self.labels
    }
}

/// The message for a label that was there before.
pub(crate) fn repeated(label: DofLabel, line: u64) -> Problem {
    Problem::Expected { expected: "each node and direction once".into(), found: found_again(label, line) }
}

pub(crate) fn found_again(label: DofLabel, line: u64) -> String {
    format!("{label} a second time, after line {line}")
}
