//! Motions of a mesh for ParaView: a `.vtu` file for each phase, and a `.pvd` file that names them.

use std::fs;
use std::io;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::mesh::{ElementKind, Mesh, Skin};

/// Values at the points of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct PointField<'a> {
    /// Name, as ParaView shows it.
    pub name: &'a str,
    /// Numbers of a point: 1, or 3 of a vector.
    pub components: usize,
    /// The numbers of all points, in the order of [`Surface::points`]; NaN where there is no value.
    pub values: &'a [f64],
}

/// The skin of a mesh as ParaView draws it; all frames of a motion share it.
#[derive(Debug, Clone)]
pub struct Surface {
    points: Vec<u32>,
    head: String,
}

impl Surface {
    /// The skin of `mesh`, and single points for those of `nodes` (indices in the mesh) that it does not touch.
    pub fn new(mesh: &Mesh, nodes: &[usize]) -> Self {
        let skin = Skin::of(mesh);
        let mut points = skin.nodes();
        let on_skin = points.len();
        let mut alone: Vec<u32> =
            nodes.iter().map(|node| *node as u32).filter(|n| points.binary_search(n).is_err()).collect();
        alone.sort_unstable();
        alone.dedup();
        points.extend(&alone);
        let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
        let index = |node: &u32| points[..on_skin].partition_point(|point| point < node) as i32;
        for cell in &skin.cells {
            connectivity.extend(cell.nodes.iter().map(index));
            offsets.push(connectivity.len() as i32);
            types.push(cell_type(cell.kind, cell.nodes.len()));
        }
        for point in on_skin..points.len() {
            connectivity.push(point as i32);
            offsets.push(connectivity.len() as i32);
            types.push(1);
        }
        let places: Vec<f64> = points.iter().flat_map(|point| mesh.places[*point as usize]).collect();
        let cells = [
            integers("connectivity", &connectivity),
            integers("offsets", &offsets),
            array("UInt8", "types", 1, &types),
        ];
        let head = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt32\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" \
             NumberOfCells=\"{}\">\n<Points>\n{}\
             </Points>\n<Cells>\n{}</Cells>\n",
            points.len(),
            types.len(),
            floats("Points", 3, &places),
            cells.concat()
        );
        Self { points, head }
    }

    /// Indices in the mesh of the points, in the order in which fields give their values.
    pub fn points(&self) -> &[u32] {
        &self.points
    }

    /// The text of a frame: an unstructured grid with its fields, numbers in 32 bits and base64.
    ///
    /// # Panics
    /// If a field has not as many values as the points need.
    pub fn frame(&self, fields: &[PointField<'_>]) -> String {
        let mut text = self.head.clone();
        text.push_str("<PointData>\n");
        for field in fields {
            assert_eq!(field.values.len(), field.components * self.points.len(), "values of the field {}", field.name);
            text.push_str(&floats(field.name, field.components, field.values));
        }
        text.push_str("</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        text
    }

    /// Writes frames as `NAME_000.vtu` … beside `NAME.pvd` into `directory`, each with its time or phase.
    ///
    /// # Errors
    /// Message of the file system.
    pub fn write<'a>(
        &self,
        directory: &Path,
        name: &str,
        frames: impl IntoIterator<Item = (f64, Vec<PointField<'a>>)>,
    ) -> io::Result<()> {
        let mut collection =
            String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
        for (k, (time, fields)) in frames.into_iter().enumerate() {
            let file = format!("{name}_{k:03}.vtu");
            fs::write(directory.join(&file), self.frame(&fields))?;
            collection.push_str(&format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"{}\"/>\n", escaped(&file)));
        }
        collection.push_str("</Collection>\n</VTKFile>\n");
        fs::write(directory.join(format!("{name}.pvd")), collection)
    }
}

/// Numbers of VTK's cells.
fn cell_type(kind: ElementKind, nodes: usize) -> u8 {
    match (kind, nodes) {
        (ElementKind::Line, 2) => 3,
        (ElementKind::Line, _) => 21,
        (ElementKind::Triangle, 3) => 5,
        (ElementKind::Triangle, _) => 22,
        (_, 4) => 9,
        _ => 23,
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn floats(name: &str, components: usize, values: &[f64]) -> String {
    let bytes: Vec<u8> = values.iter().flat_map(|value| (*value as f32).to_le_bytes()).collect();
    array("Float32", name, components, &bytes)
}

fn integers(name: &str, values: &[i32]) -> String {
    array("Int32", name, 1, &values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>())
}

/// The number of bytes and the bytes, in one piece of base64.
fn array(kind: &str, name: &str, components: usize, bytes: &[u8]) -> String {
    let mut counted = (bytes.len() as u32).to_le_bytes().to_vec();
    counted.extend_from_slice(bytes);
    format!(
        "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\" \
            format=\"binary\">\n{}\n</DataArray>\n",
        escaped(name),
        STANDARD.encode(counted)
    )
}
