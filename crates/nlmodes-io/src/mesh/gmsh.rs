//! `.msh` of Gmsh as text, versions 4.1 and 2.2.

mod types;
mod version2;
mod version4;

use std::collections::HashMap;
use std::path::Path;

use self::types::{ElementType, element_type};
use super::{Element, Mesh};
use crate::error::{Place, Problem, ReadError, Result};
use crate::text::Lines;

pub(super) fn read(path: &Path) -> Result<Mesh> {
    let mut file =
        File { lines: Lines::open(path)?, mesh: Mesh::default(), names: HashMap::new(), mentions: Vec::new() };
    let version = file.format()?;
    let mut groups = HashMap::new();
    while file.section()? {
        let name = file.lines.line().trim_ascii().to_vec();
        match (name.as_slice(), version) {
            (b"$PhysicalNames", _) => file.physical_names()?,
            (b"$Entities", Version::Four) => groups = version4::entities(&mut file)?,
            (b"$Nodes", Version::Four) => version4::nodes(&mut file)?,
            (b"$Nodes", Version::Two) => version2::nodes(&mut file)?,
            (b"$Elements", Version::Four) => version4::elements(&mut file, &groups)?,
            (b"$Elements", Version::Two) => version2::elements(&mut file)?,
            _ => {
                file.pass_over(&name)?;
                continue;
            }
        }
        file.end(&name)?;
    }
    file.finish()
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    Two,
    Four,
}

/// A physical group: its dimension and number.
type Group = (u64, i64);

struct File {
    lines: Lines,
    mesh: Mesh,
    names: HashMap<Group, String>,
    /// Numbers of an element's nodes, and the line.
    mentions: Vec<(Element, Vec<u64>, u64)>,
}

impl File {
    fn format(&mut self) -> Result<Version> {
        self.lines.need("$MeshFormat")?;
        if self.lines.line().trim_ascii() != b"$MeshFormat" {
            return Err(self.lines.expected("$MeshFormat", self.lines.line()));
        }
        self.lines.need("the version")?;
        let mut fields = self.lines.fields();
        let version = match fields.word() {
            b"4.1" => Version::Four,
            b"2.2" | b"2.1" | b"2" => Version::Two,
            other => return Err(self.lines.expected("version 4.1 or 2.2", other)),
        };
        if fields.word() != b"0" {
            return Err(self.lines.error(Problem::Refused {
                found: "a binary file".into(),
                expected: "a file of text",
                reason: "write it with `Mesh.Binary = 0`",
            }));
        }
        self.end(b"$MeshFormat")?;
        Ok(version)
    }

    /// Goes on to the beginning of the next section.
    fn section(&mut self) -> Result<bool> {
        while self.lines.advance()? {
            let line = self.lines.line().trim_ascii();
            if line.starts_with(b"$") {
                return Ok(true);
            }
            if !line.is_empty() {
                return Err(self.lines.expected("a section, which begins with $", line));
            }
        }
        Ok(false)
    }

    fn end(&mut self, section: &[u8]) -> Result<()> {
        let end = format!("$End{}", String::from_utf8_lossy(&section[1..]));
        // The last line of a file may have no end.
        if !self.lines.advance()? {
            return Err(self.lines.ended(&end));
        }
        if self.lines.line().trim_ascii() == end.as_bytes() {
            Ok(())
        } else {
            Err(self.lines.expected(end, self.lines.line()))
        }
    }

    fn pass_over(&mut self, section: &[u8]) -> Result<()> {
        let end = format!("$End{}", String::from_utf8_lossy(&section[1..]));
        loop {
            if !self.lines.advance()? {
                return Err(self.lines.ended(&end));
            }
            if self.lines.line().trim_ascii() == end.as_bytes() {
                return Ok(());
            }
        }
    }

    /// The whole numbers of the next line.
    fn numbers(&mut self, what: &str) -> Result<Vec<i64>> {
        self.lines.need(what)?;
        let number = |field| {
            crate::text::signed(field).ok_or_else(|| self.lines.expected(format!("a whole number in {what}"), field))
        };
        self.lines.fields().map(number).collect()
    }

    /// `dimension number "name"`.
    fn physical_names(&mut self) -> Result<()> {
        let count = self.numbers("the number of physical groups")?;
        for _ in 0..count.first().copied().unwrap_or(0) {
            self.lines.need("a physical group")?;
            let line = String::from_utf8_lossy(self.lines.line()).into_owned();
            let mut parts = line.trim().splitn(3, ' ');
            let wrong = || self.lines.expected("dimension, number and \"name\" of a physical group", line.as_bytes());
            let dimension = parts.next().and_then(|d| d.parse().ok()).ok_or_else(wrong)?;
            let number = parts.next().and_then(|n| n.parse().ok()).ok_or_else(wrong)?;
            let name =
                parts.next().map(|name| name.trim().trim_matches('"')).filter(|n| !n.is_empty()).ok_or_else(wrong)?;
            self.names.insert((dimension, number), name.to_owned());
        }
        Ok(())
    }

    fn node(&mut self, number: i64, place: [f64; 3]) -> Result<()> {
        let number = u64::try_from(number).unwrap_or(0);
        if number == 0 {
            return Err(self.lines.expected("a node's number from 1 on", self.lines.line()));
        }
        self.mesh.add_node(number, place).map_err(|before| {
            self.lines.expected(format!("node {number} once (it is at {before:?} already)"), self.lines.line())
        })
    }

    /// Three coordinates, possibly followed by surface parameters.
    fn place(&self, fields: &[&[u8]]) -> Result<[f64; 3]> {
        let [x, y, z, ..] = fields else { return Err(self.lines.expected("three coordinates", self.lines.line())) };
        Ok([self.lines.real(x, "coordinate")?, self.lines.real(y, "coordinate")?, self.lines.real(z, "coordinate")?])
    }

    fn element_type(&self, number: i64) -> Result<ElementType> {
        element_type(number).ok_or_else(|| {
            self.lines
                .expected("an element type of first or second order (1 to 13, 15 to 19)", number.to_string().as_bytes())
        })
    }

    /// Takes an element's nodes, and gives them to the sets of its groups.
    fn element(&mut self, number: i64, kind: ElementType, nodes: &[i64], groups: &[Group]) -> Result<()> {
        if nodes.len() != kind.nodes {
            return Err(self.lines.expected(format!("{} nodes of the element", kind.nodes), self.lines.line()));
        }
        let nodes: Vec<u64> = nodes.iter().map(|node| u64::try_from(*node).unwrap_or(0)).collect();
        for group in groups {
            let name = self.names.get(group).cloned().unwrap_or_else(|| format!("physical {}", group.1));
            self.mesh.add_to_set(&name, nodes.iter().copied());
        }
        let element = match kind.kind {
            Some(kind) => Element { number: u64::try_from(number).unwrap_or(0), kind, nodes: vec![] },
            None => return Ok(()), // a point
        };
        self.mentions.push((element, kind.ordered(&nodes), self.lines.number()));
        Ok(())
    }

    fn finish(mut self) -> Result<Mesh> {
        if self.mesh.numbers.is_empty() {
            return Err(self.lines.ended("the section $Nodes"));
        }
        for (mut element, nodes, line) in std::mem::take(&mut self.mentions) {
            for node in nodes {
                let index = self.mesh.index_of(node).ok_or_else(|| {
                    let (expected, found) =
                        ("nodes of the mesh".to_owned(), format!("node {node}, which is not there"));
                    ReadError::new(self.lines.path(), Place::Line(line), Problem::Expected { expected, found })
                })?;
                element.nodes.push(index as u32);
            }
            self.mesh.elements.push(element);
        }
        self.mesh.sort_sets();
        Ok(self.mesh)
    }
}
