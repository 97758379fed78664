//! Comma-separated `parameter,matrix,node,component,other_node,other_component,value`.

use std::path::Path;

use super::{DofLabel, table};
use crate::error::Result;
use crate::text::{Lines, commas};

const NAMES: [&str; 7] = ["parameter", "matrix", "node", "component", "other_node", "other_component", "value"];

/// An entry of stiffness or mass by which a parameter changes these, in the units of the files; with its mirror image
/// where it is not on the diagonal.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterEntry {
    /// Name of the parameter.
    pub parameter: String,
    /// Whether it is one of the mass; else of the stiffness.
    pub is_mass: bool,
    /// Row and column.
    pub at: [DofLabel; 2],
    /// Per unit of the parameter.
    pub value: f64,
}

/// The entries of a table `parameter,matrix,node,component,other_node,other_component,value`, with or without that
/// heading; those of one parameter need not stand together.
///
/// # Errors
/// [`ReadError`](crate::ReadError): another number of columns, another heading, a matrix that is neither `stiffness`
/// nor `mass`, a value that is not finite, an empty table.
pub fn read_parameter_entries(path: &Path) -> Result<Vec<ParameterEntry>> {
    let (mut lines, mut entries) = (Lines::open(path)?, Vec::new());
    while lines.advance()? {
        if lines.line().trim_ascii().is_empty() || lines.line().starts_with(b"#") {
            continue;
        }
        let fields: Vec<&[u8]> = commas(lines.line()).collect();
        let [parameter, matrix, node, component, other, other_component, value] = fields[..] else {
            return Err(lines.expected(format!("seven columns, {}", NAMES.join(",")), lines.line()));
        };
        if entries.is_empty() && parameter.eq_ignore_ascii_case(b"parameter") {
            table::check_heading(&lines, &fields, &NAMES)?;
            continue;
        }
        let name = std::str::from_utf8(parameter).unwrap_or_default();
        if name.is_empty() {
            return Err(lines.expected("the name of a parameter", parameter));
        }
        let label = |node: &[u8], component: &[u8]| {
            let node = lines.unsigned(node, "number of the node")?;
            Ok(DofLabel { node, component: table::component(&lines, component)? })
        };
        entries.push(ParameterEntry {
            parameter: name.to_owned(),
            is_mass: match matrix {
                b"stiffness" => false,
                b"mass" => true,
                _ => return Err(lines.expected("`stiffness` or `mass`", matrix)),
            },
            at: [label(node, component)?, label(other, other_component)?],
            value: lines.real(value, "value")?,
        });
    }
    if entries.is_empty() {
        return Err(lines.ended(&format!("a line {}", NAMES.join(","))));
    }
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Component;

    fn read(text: &str) -> Result<Vec<ParameterEntry>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("entries.csv");
        std::fs::write(&path, text).unwrap();
        read_parameter_entries(&path)
    }

    #[test]
    fn entries_are_read_with_their_matrix_and_labels_and_others_are_named() {
        let heading = "parameter,matrix,node,component,other_node,other_component,value\n";
        let found =
            read(&format!("{heading}# a rib\nrib, stiffness, 3, uy, 4, 2, -1.5\npad,mass,7,ux,7,ux,2e-3\n")).unwrap();
        let label = |node, component| DofLabel { node, component };
        assert_eq!(found[0].at, [label(3, Component::Y), label(4, Component::Y)]);
        assert_eq!((found[0].parameter.as_str(), found[0].is_mass, found[0].value), ("rib", false, -1.5));
        assert_eq!((found[1].parameter.as_str(), found[1].is_mass, found[1].value), ("pad", true, 2e-3));
        for (text, part) in [
            ("rib,stiffness,3,uy,4,2\n", "seven columns"),
            ("rib,damping,3,uy,4,2,1\n", "`stiffness` or `mass`"),
            ("rib,mass,3,uq,4,2,1\n", "a component"),
            (heading, "a line parameter,matrix"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
