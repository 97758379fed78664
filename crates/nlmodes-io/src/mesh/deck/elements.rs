use crate::mesh::ElementKind;

/// How many nodes the elements of a type have, and what shape they make.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub(super) kind: ElementKind,
    pub(super) nodes: usize,
}

/// The shape of the elements of a type of CalculiX or Abaqus, whatever their formulation; nothing if it is not known.
pub(super) fn shape(name: &str) -> Option<Shape> {
    use ElementKind::{Hexahedron, Line, Quadrangle, Tetrahedron, Triangle, Wedge};
    const STARTS: [(&str, ElementKind, &[usize]); 14] = [
        ("C3D", Hexahedron, &[8, 20]),
        ("C3D", Tetrahedron, &[4, 10]),
        ("C3D", Wedge, &[6, 15]),
        ("SC", Hexahedron, &[8]),
        ("SC", Wedge, &[6]),
        ("S", Triangle, &[3, 6]),
        ("S", Quadrangle, &[4, 8]),
        ("M3D", Triangle, &[3, 6]),
        ("M3D", Quadrangle, &[4, 8]),
        ("STRI", Triangle, &[3]),
        ("CPS", Triangle, &[3, 6]),
        ("CPS", Quadrangle, &[4, 8]),
        ("CPE", Triangle, &[3, 6]),
        ("CPE", Quadrangle, &[4, 8]),
    ];
    const BEAMS: [(&str, usize); 8] =
        [("B31", 2), ("B32", 3), ("B33", 2), ("B21", 2), ("B23", 2), ("T3D2", 2), ("T3D3", 3), ("PIPE31", 2)];
    if let Some((_, nodes)) = BEAMS.iter().find(|(start, _)| name.starts_with(start)) {
        return Some(Shape { kind: Line, nodes: *nodes });
    }
    let of = |(start, kind, counts): &(&str, ElementKind, &[usize])| {
        let rest = name.strip_prefix(start)?;
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let nodes: usize = rest[..digits].parse().ok()?;
        // Letters after the number are variants of the formulation: R, I, H, T, M, P …
        let letters = rest[digits..].chars().all(|c| c.is_ascii_alphabetic() || (c.is_ascii_digit() && nodes == 4));
        (counts.contains(&nodes) && letters).then_some(Shape { kind: *kind, nodes })
    };
    STARTS.iter().find_map(of).or_else(|| (name == "STRI65").then_some(Shape { kind: Triangle, nodes: 6 }))
}

impl Shape {
    /// Nodes with corners first: the second node of a quadratic beam is the one in its middle.
    pub(super) fn ordered(self, nodes: &[u32]) -> Vec<u32> {
        match (self.kind, nodes) {
            (ElementKind::Line, [a, middle, b]) => vec![*a, *b, *middle],
            _ => nodes.to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_have_their_shapes() {
        use ElementKind::{Hexahedron, Line, Quadrangle, Tetrahedron, Triangle, Wedge};
        let cases = [
            ("C3D8I", Hexahedron, 8),
            ("C3D20R", Hexahedron, 20),
            ("C3D10M", Tetrahedron, 10),
            ("C3D4", Tetrahedron, 4),
            ("C3D6", Wedge, 6),
            ("C3D15", Wedge, 15),
            ("S3", Triangle, 3),
            ("S4R", Quadrangle, 4),
            ("S8R", Quadrangle, 8),
            ("S6", Triangle, 6),
            ("B31", Line, 2),
            ("B32R", Line, 3),
            ("SC8R", Hexahedron, 8),
            ("CPS4", Quadrangle, 4),
            ("STRI3", Triangle, 3),
            ("STRI65", Triangle, 6),
            ("T3D2", Line, 2),
        ];
        for (name, kind, nodes) in cases {
            let found = shape(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!((found.kind, found.nodes), (kind, nodes), "{name}");
        }
        for name in ["SPRINGA", "MASS", "C3D27", "GAPUNI", "DASHPOTA", "U1", "S", "C3D", "SAX1"] {
            assert!(shape(name).is_none(), "{name}");
        }
    }
}
