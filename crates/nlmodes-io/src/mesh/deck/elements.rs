use crate::mesh::{ElementKind, Expanded};

/// How many nodes the elements of a type have, what shape they make, and what CalculiX makes of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub(super) kind: ElementKind,
    pub(super) nodes: usize,
    pub(super) expansion: Option<Expansion>,
}

/// Elements that CalculiX expands into solids.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Expansion {
    /// Plane stress, plane strain, axisymmetric: all nodes of the solid that come of one move with it in the plane.
    Plane,
    /// Shells: nodes below, above, and at corners of quadratic ones between.
    Shell,
    /// Membranes, whose nodes are hinges between solids of that shape.
    Membrane,
    /// Beams: nodes around the axis, four or, at the ends of quadratic ones, eight.
    Beam,
    /// Trusses, whose nodes are hinges between solids of that shape.
    Truss,
}

impl Expansion {
    fn of(name: &str) -> Option<Self> {
        let starts = |starts: &[&str]| starts.iter().any(|start| name.starts_with(start));
        match name {
            _ if starts(&["CPS", "CPE", "CAX"]) => Some(Self::Plane),
            _ if starts(&["S3", "S4", "S6", "S8"]) => Some(Self::Shell),
            _ if starts(&["M3D"]) => Some(Self::Membrane),
            _ if starts(&["B31", "B32"]) => Some(Self::Beam),
            _ if starts(&["T3D"]) => Some(Self::Truss),
            _ => None,
        }
    }

    /// What becomes of node `k` of an element of `nodes` nodes.
    pub(super) fn expanded(self, k: usize, nodes: usize) -> Expanded {
        let copies = match (self, nodes) {
            (Self::Plane, _) => return Expanded::InPlane,
            (Self::Shell | Self::Membrane, 6 | 8) if k < nodes / 2 => 3,
            (Self::Shell | Self::Membrane, _) => 2,
            (Self::Beam | Self::Truss, 3) if k != 1 => 8,
            (Self::Beam | Self::Truss, _) => 4,
        };
        match self {
            // Their mean is the node: one of them depends on it.
            Self::Membrane | Self::Truss => Expanded::Hinge(copies - 1),
            Self::Plane | Self::Shell | Self::Beam => Expanded::Copies(copies),
        }
    }
}

/// The shape of the elements of a type of CalculiX or Abaqus, whatever their formulation; nothing if it is not known.
pub(super) fn shape(name: &str) -> Option<Shape> {
    use ElementKind::{Hexahedron, Line, Quadrangle, Tetrahedron, Triangle, Wedge};
    const STARTS: [(&str, ElementKind, &[usize]); 16] = [
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
        ("CAX", Triangle, &[3, 6]),
        ("CAX", Quadrangle, &[4, 8]),
    ];
    const BEAMS: [(&str, usize); 8] =
        [("B31", 2), ("B32", 3), ("B33", 2), ("B21", 2), ("B23", 2), ("T3D2", 2), ("T3D3", 3), ("PIPE31", 2)];
    let expansion = Expansion::of(name);
    if let Some((_, nodes)) = BEAMS.iter().find(|(start, _)| name.starts_with(start)) {
        return Some(Shape { kind: Line, nodes: *nodes, expansion });
    }
    let of = |(start, kind, counts): &(&str, ElementKind, &[usize])| {
        let rest = name.strip_prefix(start)?;
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let nodes: usize = rest[..digits].parse().ok()?;
        // Letters after the number are variants of the formulation: R, I, H, T, M, P …
        let letters = rest[digits..].chars().all(|c| c.is_ascii_alphabetic() || (c.is_ascii_digit() && nodes == 4));
        (counts.contains(&nodes) && letters).then_some(Shape { kind: *kind, nodes, expansion })
    };
    STARTS.iter().find_map(of).or_else(|| (name == "STRI65").then_some(Shape { kind: Triangle, nodes: 6, expansion }))
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
            ("CAX8R", Quadrangle, 8),
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
