use std::collections::{HashMap, HashSet};

use super::{ElementKind, Mesh};

/// A cell of a skin.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinCell {
    /// [`ElementKind::Line`], [`ElementKind::Triangle`] or [`ElementKind::Quadrangle`].
    pub kind: ElementKind,
    /// Indices of its nodes in the mesh: corner nodes, then midside nodes.
    pub nodes: Vec<u32>,
}

/// What can be seen of a mesh: faces that belong to one solid only, shells, beams.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Skin {
    /// Its cells, with normals outward where they cover solids.
    pub cells: Vec<SkinCell>,
}

/// The corner nodes of a face in ascending order; triangles end with a number that no node has.
fn key(face: &[usize], nodes: &[u32]) -> [u32; 4] {
    let mut key = [u32::MAX; 4];
    face.iter().zip(&mut key).for_each(|(corner, at)| *at = nodes[*corner]);
    key.sort_unstable();
    key
}

impl Skin {
    /// The skin of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        Self::of_elements(mesh, |_| true)
    }

    /// The skin of its solids alone, with all normals outward.
    pub fn of_solids(mesh: &Mesh) -> Self {
        Self::of_elements(mesh, ElementKind::is_solid)
    }

    fn of_elements(mesh: &Mesh, counts: impl Fn(ElementKind) -> bool) -> Self {
        let mut faces: HashMap<[u32; 4], u8> = HashMap::new();
        for element in mesh.elements.iter().filter(|element| element.kind.is_solid()) {
            for face in element.kind.faces() {
                let count = faces.entry(key(face, &element.nodes)).or_insert(0);
                *count = count.saturating_add(1);
            }
        }
        let mut cells = Vec::new();
        for element in mesh.elements.iter().filter(|element| counts(element.kind)) {
            let kind = element.kind;
            if kind == ElementKind::Line {
                cells.push(SkinCell { kind, nodes: element.nodes.clone() });
            }
            for face in kind.faces() {
                let count = faces.get(&key(face, &element.nodes)).copied().unwrap_or(0);
                // A shell on the face of a solid shows what the solid shows.
                if count == u8::from(kind.is_solid()) {
                    let nodes = kind.face_nodes(face, &element.nodes);
                    let is_solid = kind.is_solid();
                    let kind = if face.len() == 3 { ElementKind::Triangle } else { ElementKind::Quadrangle };
                    let cell = SkinCell { kind, nodes };
                    // Elements of mirrored parts are numbered the other way round.
                    let inward = is_solid && looks_toward(&cell, &element.nodes, mesh);
                    cells.push(if inward { turned(cell) } else { cell });
                }
            }
        }
        Self { cells }
    }

    /// The volume that it encloses, m³ if positions are in m: a third of the flux of the position through its faces,
    /// each defined by its corner nodes.
    pub fn volume(&self, mesh: &Mesh) -> f64 {
        let corner = |cell: &SkinCell, k: usize| mesh.places[cell.nodes[k % cell.kind.corners()] as usize];
        let of = |cell: &SkinCell| -> f64 {
            let middle = middle(&cell.nodes[..cell.kind.corners()], mesh);
            let pieces = (0..cell.kind.corners()).map(|k| half_product(middle, corner(cell, k), corner(cell, k + 1)));
            pieces.map(|area| (0..3).map(|axis| area[axis] * middle[axis]).sum::<f64>()).sum()
        };
        self.cells.iter().filter(|cell| cell.kind != ElementKind::Line).map(of).sum::<f64>() / 3.0
    }

    /// Indices of the nodes that it touches, ascending.
    pub fn nodes(&self) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.cells.iter().flat_map(|cell| cell.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Pairs of corner nodes connected by edges, each once, the smaller index first.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let of_cell = |cell: &SkinCell| {
            let ends = |edge: &[usize; 2]| [cell.nodes[edge[0]], cell.nodes[edge[1]]];
            let ordered = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
            cell.kind.edges().iter().map(ends).map(ordered).collect::<Vec<_>>()
        };
        let mut edges: Vec<[u32; 2]> = self.cells.iter().flat_map(of_cell).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The edges at which the surface bends by more than `angle` (rad), ends, or meets more than one other face; and
    /// all lines.
    pub fn sharp_edges(&self, mesh: &Mesh, angle: f64) -> Vec<[u32; 2]> {
        let mut around: HashMap<[u32; 2], Vec<[f64; 3]>> = HashMap::new();
        let mut lines = Vec::new();
        for cell in &self.cells {
            let area = cell_area(cell, mesh);
            for edge in cell.kind.edges() {
                let [a, b] = [cell.nodes[edge[0]], cell.nodes[edge[1]]];
                let ordered = [a.min(b), a.max(b)];
                if cell.kind == ElementKind::Line {
                    lines.push(ordered)
                } else {
                    around.entry(ordered).or_default().push(area)
                }
            }
        }
        let length = |a: &[f64; 3]| a.iter().map(|x| x * x).sum::<f64>().sqrt();
        let is_sharp = |faces: &[[f64; 3]]| match faces {
            [a, b] => {
                let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                dot < angle.cos() * length(a) * length(b)
            }
            _ => true,
        };
        lines.extend(around.into_iter().filter(|(_, faces)| is_sharp(faces)).map(|(edge, _)| edge));
        lines.sort_unstable();
        lines.dedup();
        lines
    }

    /// The outward normal times the area that belongs to each node of the mesh, m² if its places are in m; zero for
    /// nodes elsewhere. A face gives each of its nodes an equal part.
    pub fn normals(&self, mesh: &Mesh) -> Vec<[f64; 3]> {
        self.normals_of(mesh, |_| true)
    }

    /// The same for nodes (by index) of a set: if it contains complete faces (all of their corner nodes), only these
    /// are used, so that normals at its edges are not tilted toward adjacent faces. Nodes of a set without a complete
    /// face, such as an edge, have the mean of all adjacent faces.
    pub fn normals_within(&self, mesh: &Mesh, nodes: &[u32]) -> Vec<[f64; 3]> {
        let set: HashSet<u32> = nodes.iter().copied().collect();
        let inside = |cell: &SkinCell| cell.nodes[..cell.kind.corners()].iter().all(|node| set.contains(node));
        let (own, all) = (self.normals_of(mesh, inside), self.normals(mesh));
        own.into_iter().zip(all).map(|(own, all)| if own == [0.0; 3] { all } else { own }).collect()
    }

    fn normals_of(&self, mesh: &Mesh, counts: impl Fn(&SkinCell) -> bool) -> Vec<[f64; 3]> {
        let mut normals = vec![[0.0; 3]; mesh.places.len()];
        for cell in self.cells.iter().filter(|cell| cell.kind != ElementKind::Line && counts(cell)) {
            let area = cell_area(cell, mesh);
            for node in &cell.nodes {
                (0..3).for_each(|axis| normals[*node as usize][axis] += area[axis] / cell.nodes.len() as f64);
            }
        }
        normals
    }
}

/// Whether a face is oriented toward the interior of its element.
fn looks_toward(face: &SkinCell, element: &[u32], mesh: &Mesh) -> bool {
    let mean = |nodes: &[u32], axis: usize| {
        nodes.iter().map(|n| mesh.places[*n as usize][axis]).sum::<f64>() / nodes.len() as f64
    };
    let normal = cell_area(face, mesh);
    let out = |axis: usize| mean(&face.nodes, axis) - mean(element, axis);
    (0..3).map(|axis| normal[axis] * out(axis)).sum::<f64>() < 0.0
}

/// The reversed face: corner nodes and midside nodes in reverse order.
fn turned(mut cell: SkinCell) -> SkinCell {
    let corners = cell.kind.corners();
    cell.nodes[1..corners].reverse();
    cell.nodes[corners..].reverse();
    cell
}

/// Outward normal of a face times its area.
pub(super) fn cell_area(cell: &SkinCell, mesh: &Mesh) -> [f64; 3] {
    let corners = &cell.nodes[..cell.kind.corners()];
    let centre = middle(corners, mesh);
    corners.iter().zip(corners.iter().cycle().skip(1)).fold([0.0; 3], |sum, (a, b)| {
        let part = half_product(centre, mesh.places[*a as usize], mesh.places[*b as usize]);
        std::array::from_fn(|axis| sum[axis] + part[axis])
    })
}

/// Mean place of some nodes.
fn middle(nodes: &[u32], mesh: &Mesh) -> [f64; 3] {
    let sum = |axis: usize| nodes.iter().map(|n| mesh.places[*n as usize][axis]).sum::<f64>();
    [0, 1, 2].map(|axis| sum(axis) / nodes.len() as f64)
}

/// Normal of the triangle `o a b` times its area.
fn half_product(o: [f64; 3], a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let u: [f64; 3] = std::array::from_fn(|k| a[k] - o[k]);
    let v: [f64; 3] = std::array::from_fn(|k| b[k] - o[k]);
    [(u[1] * v[2] - u[2] * v[1]) / 2.0, (u[2] * v[0] - u[0] * v[2]) / 2.0, (u[0] * v[1] - u[1] * v[0]) / 2.0]
}
