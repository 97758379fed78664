//! Frames for ParaView, read back.

use std::fs;
use std::path::Path;
use std::process::Command;

use base64::Engine;
use nlmodes_io::{FeModel, Mesh, PointField, Surface};

use crate::bracket;

/// The numbers of an array of a frame.
fn decoded(text: &str, name: &str) -> Vec<u8> {
    let start = text.find(&format!("Name=\"{name}\"")).unwrap();
    let body = text[start..].split_once('\n').unwrap().1;
    let bytes = base64::engine::general_purpose::STANDARD.decode(body.split_once('\n').unwrap().0).unwrap();
    let (count, rest) = bytes.split_first_chunk().unwrap();
    assert_eq!(u32::from_le_bytes(*count) as usize, rest.len());
    rest.to_vec()
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

#[test]
fn a_frame_holds_places_and_fields_of_its_points() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("x.inp");
    let deck = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,9,9,9\n6,3,0,0\n\
                *ELEMENT,TYPE=C3D4\n7,1,2,3,4\n*ELEMENT,TYPE=B31\n8,2,6\n";
    fs::write(&path, deck).unwrap();
    let mesh = Mesh::read(&path).unwrap();
    let surface = Surface::new(&mesh, &[4, 0]);
    assert_eq!(surface.points(), [0, 1, 2, 3, 5, 4], "the skin, then what it does not touch");
    let gap = [0.5, f64::NAN, 1.5, 2.5, 3.5, 4.5];
    let frame = surface.frame(&[PointField { name: "gap", components: 1, values: &gap }]);
    let places = floats(&decoded(&frame, "Points"));
    assert_eq!(places[3..6], [1.0, 0.0, 0.0]);
    assert_eq!(places[15..18], [9.0, 9.0, 9.0]);
    let found = floats(&decoded(&frame, "gap"));
    assert!(found[1].is_nan() && found[5] == 4.5);
    assert_eq!(decoded(&frame, "types"), [5, 5, 5, 5, 3, 1]);
    let offsets: Vec<i32> =
        decoded(&frame, "offsets").chunks_exact(4).map(|b| i32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    assert_eq!(offsets, [3, 6, 9, 12, 14, 15]);
}

/// With the Python module meshio, of the interpreter that `NLMODES_PYTHON` names or of `python3`.
#[test]
fn meshio_reads_the_frames_of_the_bracket() {
    let python = std::env::var("NLMODES_PYTHON").unwrap_or_else(|_| "python3".into());
    if !Command::new(&python).args(["-c", "import meshio"]).output().is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: {python} has no module meshio");
        return;
    }
    let model = FeModel::read(&bracket::files()).unwrap();
    let mesh = model.mesh.as_ref().unwrap();
    let surface = Surface::new(mesh, &[]);
    let n = surface.points().len();
    let directory = tempfile::tempdir().unwrap();
    let phases = [0.0, 0.25, 0.5];
    let displacement = phases.map(|phase| (0..3 * n).map(|k| 1e-3 * phase * k as f64).collect::<Vec<f64>>());
    let gap: Vec<f64> = (0..n).map(|k| if k == 2 { 1e-4 } else { f64::NAN }).collect();
    let frames = phases.iter().zip(&displacement).map(|(phase, values)| {
        let fields = vec![
            PointField { name: "displacement", components: 3, values },
            PointField { name: "gap", components: 1, values: &gap },
        ];
        (*phase, fields)
    });
    surface.write(directory.path(), "motion", frames).unwrap();
    let script = "
import sys, meshio, numpy as np
import xml.etree.ElementTree as ET
folder = sys.argv[1]
sets = ET.parse(folder + '/motion.pvd').getroot().findall('./Collection/DataSet')
assert [float(s.get('timestep')) for s in sets] == [0.0, 0.25, 0.5]
for s in sets:
    m = meshio.read(folder + '/' + s.get('file'))
    n = len(m.points)
    u = m.point_data['displacement']
    expected = 1e-3 * float(s.get('timestep')) * np.arange(3 * n).reshape(n, 3)
    assert np.allclose(u, expected, rtol=1e-6), 'displacement'
    gap = m.point_data['gap'].ravel()
    assert abs(gap[2] - 1e-4) < 1e-10 and np.isnan(np.delete(gap, 2)).all(), 'gap'
    assert [c.type for c in m.cells] == ['triangle6'], m.cells
    t = m.cells[0].data
    a, b, c = (m.points[t[:, k]] for k in range(3))
    volume = np.einsum('ij,ij->i', a, np.cross(b - a, c - a)).sum() / 6
    assert abs(volume / 5.28e-6 - 1) < 1e-5, volume
print('read', n, 'points')
";
    let output = Command::new(&python).args(["-c", script]).arg(Path::new(directory.path())).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
