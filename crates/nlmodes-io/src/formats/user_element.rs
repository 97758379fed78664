//! `*USER ELEMENT` with `*MATRIX, TYPE=STIFFNESS` and `TYPE=MASS`: what Abaqus writes with `*SUBSTRUCTURE MATRIX
//! OUTPUT`. Each matrix is a triangle column by column, from the top to the diagonal; its nodes are in comments below
//! `** ELEMENT NODES` or in the lines of `*ELEMENT`, their directions below `*USER ELEMENT`.

use std::path::Path;

use super::MatrixData;
use super::labelled::{LabelledBuilder, label};
use crate::build::{Pass, Triangles};
use crate::error::{Place, Problem, ReadError, Result};
use crate::keyword::Keyword;
use crate::labels::DofLabel;
use crate::text::{Lines, commas, unsigned};

/// What the lines that come belong to.
#[derive(Clone, Copy, PartialEq)]
enum Block {
    /// Directions of the nodes, below `*USER ELEMENT`.
    Directions,
    /// Numbers of an element and of its nodes.
    Element,
    /// Entries of the matrix that is wanted.
    Wanted,
    /// Anything else.
    Other,
}

/// A user element, as far as it has been read.
#[derive(Default)]
struct Element {
    count: Option<u64>,
    /// From which place in the list of nodes on which directions are active.
    directions: Vec<(u64, Vec<u64>)>,
    in_comments: Vec<u64>,
    in_lines: Vec<u64>,
    names: Vec<String>,
    values: Vec<f64>,
}

/// Whether a file begins with the keyword of a user element.
pub(super) fn is_one(path: &Path) -> Result<bool> {
    let mut lines = Lines::open(path)?;
    while lines.advance()? {
        let line = lines.line().trim_ascii();
        if !line.is_empty() && !line.starts_with(b"**") {
            return Ok(line.starts_with(b"*") && Keyword::parse(line).name == "USER ELEMENT");
        }
    }
    Ok(false)
}

/// Reads the matrix of this type, or the only one.
pub(super) fn read(path: &Path, name: Option<&str>) -> Result<MatrixData> {
    let wanted = name.map(str::to_uppercase);
    let mut lines = Lines::open(path)?;
    let mut element = Element::default();
    let (mut block, mut named) = (Block::Other, false);
    while lines.advance_whole()? {
        let line = lines.line().trim_ascii();
        if line.starts_with(b"**") {
            named = element.comment(line, named);
        } else if line.starts_with(b"*") {
            block = element.begin(&lines, wanted.as_deref())?;
        } else if !line.is_empty() {
            element.data(&lines, block)?;
        }
    }
    element.check_name(path, wanted)?;
    element.matrix(path)
}

impl Element {
    /// Nodes below a comment with `ELEMENT NODES`; whether more may follow.
    fn comment(&mut self, line: &[u8], named: bool) -> bool {
        let text = line.trim_ascii_start().strip_prefix(b"**").unwrap_or_default().trim_ascii();
        if text.to_ascii_uppercase().starts_with(b"ELEMENT NODES") {
            return true;
        }
        let numbers: Option<Vec<u64>> = commas(text).map(unsigned).collect();
        match numbers.filter(|numbers| named && !numbers.is_empty()) {
            Some(numbers) => self.in_comments.extend(numbers),
            None => return false,
        }
        true
    }

    fn begin(&mut self, lines: &Lines, wanted: Option<&str>) -> Result<Block> {
        let keyword = Keyword::parse(lines.line().trim_ascii());
        match keyword.name.as_str() {
            "USER ELEMENT" if self.count.is_some() => {
                Err(lines.expected("one *USER ELEMENT in a file, of which it is the second", lines.line()))
            }
            "USER ELEMENT" if keyword.has("UNSYMM") => Err(lines.error(Problem::Refused {
                found: "a user element with UNSYMM".into(),
                expected: "symmetric matrices",
                reason: "mass and stiffness are symmetric; without UNSYMM Abaqus writes their triangle",
            })),
            "USER ELEMENT" => {
                let count = keyword.option("NODES").and_then(|count| unsigned(count.trim().as_bytes()));
                self.count = Some(count.ok_or_else(|| lines.expected("NODES=… with *USER ELEMENT", lines.line()))?);
                Ok(Block::Directions)
            }
            "ELEMENT" => Ok(Block::Element),
            "MATRIX" => {
                let name = keyword.option("TYPE").unwrap_or_default();
                let is_wanted = wanted.is_none_or(|wanted| wanted == name);
                if self.names.contains(&name) {
                    return Err(lines.expected(format!("one *MATRIX, TYPE={name} in a file"), lines.line()));
                }
                self.names.push(name);
                Ok(if is_wanted { Block::Wanted } else { Block::Other })
            }
            _ => Ok(Block::Other),
        }
    }

    fn data(&mut self, lines: &Lines, block: Block) -> Result<()> {
        match block {
            Block::Other => Ok(()),
            Block::Wanted => {
                for field in commas(lines.line()) {
                    self.values.push(lines.real(field, "value")?);
                }
                Ok(())
            }
            Block::Element => {
                for field in commas(lines.line()) {
                    self.in_lines.push(lines.unsigned(field, "number of the element or of a node")?);
                }
                Ok(())
            }
            Block::Directions => {
                let numbers: Vec<u64> =
                    commas(lines.line()).map(|field| lines.unsigned(field, "direction")).collect::<Result<_>>()?;
                // The first line counts from the first node on, each other one from the place that it begins with.
                match numbers.split_first() {
                    Some((place, rest)) if !self.directions.is_empty() => self.directions.push((*place, rest.to_vec())),
                    _ => self.directions.push((1, numbers)),
                }
                Ok(())
            }
        }
    }

    fn check_name(&self, path: &Path, wanted: Option<String>) -> Result<()> {
        let problem = match (wanted, self.names.as_slice()) {
            (Some(name), known) if !known.contains(&name) => {
                Problem::Missing { what: "matrix of type", name, known: known.to_vec() }
            }
            (None, []) => Problem::Ended { expected: "*MATRIX, TYPE=STIFFNESS or TYPE=MASS".into() },
            (None, [first, _, ..]) => {
                let file = path.file_name().map_or("model.mtx".into(), |name| name.to_string_lossy());
                let example = format!("{file}#{first}");
                Problem::Ambiguous { what: "matrices", known: self.names.clone(), example }
            }
            _ => return Ok(()),
        };
        Err(ReadError::whole(path, problem))
    }

    /// Nodes and directions of the rows.
    fn labels(&self, path: &Path) -> Result<Vec<DofLabel>> {
        let nodes = if self.in_lines.is_empty() { &self.in_comments[..] } else { &self.in_lines[1..] };
        let count = self.count.unwrap_or(0);
        if nodes.len() as u64 != count {
            let what = "nodes of the user element, below `** ELEMENT NODES` or in the lines of *ELEMENT".to_owned();
            return Err(ReadError::whole(path, Problem::Size { what, expected: count, found: nodes.len() as u64 }));
        }
        let mut labels = Vec::new();
        for (place, node) in (1..).zip(nodes) {
            let active = self.directions.iter().rfind(|(from, _)| *from <= place);
            for direction in active.map_or(&[][..], |(_, directions)| directions) {
                labels.push(label(*node, *direction, false).filter(|label| label.node > 0).ok_or_else(|| {
                    let expected =
                        "nodes of the mesh and directions from 1 to 6 (other fields have no contacts)".into();
                    let found = format!("direction {direction} of node {node}");
                    ReadError::whole(path, Problem::Expected { expected, found })
                })?);
            }
        }
        Ok(labels)
    }

    fn matrix(self, path: &Path) -> Result<MatrixData> {
        let labels = self.labels(path)?;
        let (n, found) = (labels.len() as u64, self.values.len() as u64);
        if found != n * (n + 1) / 2 || n == 0 {
            let what = format!("number of values in the triangle of a matrix of {n} rows");
            return Err(ReadError::whole(path, Problem::Size { what, expected: n * (n + 1) / 2, found }));
        }
        let mut builder = LabelledBuilder::new(Triangles::One, None);
        let columns = (0..labels.len()).flat_map(|column| (0..=column).map(move |row| (row, column)));
        for ((row, column), value) in columns.zip(self.values) {
            let pushed = builder.push(labels[row], labels[column], value);
            pushed.map_err(|problem| ReadError::whole(path, problem))?;
        }
        match builder.finish() {
            Pass::Read(matrix) => Ok(matrix),
            Pass::Faulty(fault) => {
                let name = |k: usize| labels.get(k).map_or_else(String::new, ToString::to_string);
                Err(ReadError::new(path, Place::File, fault.problem(name)))
            }
        }
    }
}
