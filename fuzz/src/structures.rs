//! Files of finite-element programs: matrices, labels, meshes.

use std::fs;
use std::path::{Path, PathBuf};

use nlmodes_io::{Address, Format, LabelTable, Mesh, ReadError, Skin, read_matrix, read_numbers};

/// Names of the targets: the endings of the files.
pub const TARGETS: [&str; 13] =
    ["sti", "matrix-market", "abaqus", "npz", "mat5", "mat73", "hb", "pch", "labels", "inp", "msh", "bdf", "numbers"];

/// Words of the text formats.
pub const WORDS: &[&str] = &[
    "\n",
    "\r\n",
    " ",
    ",",
    "*",
    "**",
    "$",
    "-",
    "D+05",
    ".+5",
    "1e999",
    "nan",
    "*INCLUDE, INPUT=case.inp\n",
    "*NSET, NSET=A, GENERATE\n",
    "*ELEMENT, TYPE=C3D20\n",
    "*SURFACE, NAME=S\n",
    "GENERATE",
    "$EndNodes\n",
    "$Elements\n",
    "RSA",
    "(3D25.17)",
    "(1000I200)",
    "%%MatrixMarket matrix array real general\n",
    "coordinate",
    "DMIG*   ",
    "DMIG,KAAX,1,1,,",
    "GRID,1,,0.,0.,0.,3\n",
    "CORD2C,3,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n",
    "INCLUDE 'case.bdf'\n",
    "SET1,4,1,THRU,3\n",
    "*USER ELEMENT, NODES=2\n",
    "*MATRIX, TYPE=MASS\n",
    "*TRANSFORM, NSET=ALL\n",
    "*RIGID BODY, NSET=A, REF NODE=1, ROT NODE=2\n",
    "*ELEMENT, TYPE=S8R\n",
    "*MATERIAL, NAME=M\n",
    "*ELASTIC\n",
    "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n",
    "*DENSITY\n",
    "*SOLID SECTION, ELSET=E, MATERIAL=M\n",
    "*DEPVAR\n",
    "TYPE=T3D2",
    "99999999999",
    "2147483647",
    "\0",
    "ä",
];

const CALCULIX: &str = "1 1  2.0e+00\n1 2 -1.0e+00\n2 2  2.0e+00\n1 3  0.0e+00\n2 3 -1.0e+00\n3 3  1.0e+00\n";
const MATRIX_MARKET: &str =
    "%%MatrixMarket matrix coordinate real symmetric\n% x\n3 3 5\n1 1 2\n2 1 -1\n2 2 2\n3 2 -1\n3 3 1\n";
const GENERAL: &str = "%%MatrixMarket matrix coordinate integer general\n2 2 4\n1 1 2\n2 1 -1\n1 2 -1\n2 2 2\n";
const ARRAY: &str = "%%MatrixMarket matrix array real symmetric\n2 2\n2\n-1\n2\n";
const ABAQUS: &str = "** x\n1,1, 1,1, 2.0\n1,2, 1,1, -1.0\n1,2, 1,2, 2.0\n2,1, 2,1, 1.0e36\n";
const USER_ELEMENT: &str = "** x\n*USER ELEMENT, NODES=2, LINEAR\n** ELEMENT NODES\n** 4, 7\n1, 6\n2, \
    1\n*MATRIX,TYPE=STIFFNESS\n2.0\n0.0, 3.0\n-1.0, 0.0, 2.0\n*MATRIX,TYPE=MASS\n1.0\n0.0, 1.0\n0.0, 0.0, 1.0\n";
const BULK: &str = "SOL 103\nBEGIN \
    BULK\nCORD2C,3,,1.,0.,0.,1.,0.,1.\n,2.,0.,0.\nGRID,1,3,2.,60.,0.5,3\nGRID           2              1.      \
    0.      0.\nGRID*                  3                              0.              1.\n*                     \
    0.\nGRID,4,,0.,0.,1.\nCTETRA,1,1,1,2,3,4\nSET1,5,1,THRU,3\nENDDATA\n";
const HARWELL_BOEING: &str = "t                                                                       \
    key     \n             3             1             1             1             0\nRSA                        \
    2             2             3             0\n(8I10)          (8I10)          (3D25.17)           \n         \
    1         3         4\n         1         2         2\n   2.00000000000000000D+00  -1.00000000000000000D+00   \
    2.00000000000000000D+00\n";
const DMIG: &str = "$ x\nDMIG    KAAX           0       6       2       0                       2\nDMIG*   \
    KAAX                           1               1\n*                      1               1 \
    2.000000000D+00\n*                      1               2-1.000000000D+00\nDMIG*   KAAX                           \
    1               2\n*                      1               2 2.000000000D+00\n";
const LABELS: [&str; 3] = [
    "1.1\n1.2\n10.3\n",
    "Matrix Eqn Node DOF\n1 4 UX\n2 4 ROTZ\n",
    "row,node,component,x,y,z\n0,1,ux,0,0,0\n1,1,2,0,0,0\n",
];
const NUMBERS: [&str; 2] = ["# rows\n1.0,-2.5e-3\n3,4D+05\n", "10.0\n20.0 # Hz\n40.0\n"];
const DECK: &str = "*NODE, NSET=ALL\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4, \
    ELSET=E\n1,1,2,3,4\n*NSET,NSET=A,GENERATE\n1,3,2\n*SURFACE,NAME=S\nE,S2\n*BOUNDARY\n1,1,3\n*MATERIAL, \
    NAME=M\n*ELASTIC\n2.1e11,0.3\n*DENSITY\n7800.\n*SOLID SECTION,ELSET=E,MATERIAL=M\n";
const GMSH: [&str; 2] = [
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"B\"\n$EndPhysicalNames\n$Entities\n0 0 0 1\n1 0 0 \
     0 1 1 1 1 1 0\n$EndEntities\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 \
     1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n",
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n1 \
     4 2 1 1 1 2 3 4\n$EndElements\n",
];

/// Valid files of a target; none if there is no such target.
pub fn corpus(target: &str) -> Option<Vec<Vec<u8>>> {
    let texts = |texts: &[&str]| texts.iter().map(|text| text.as_bytes().to_vec()).collect();
    macro_rules! fixture {
        ($name:literal) => {
            include_bytes!(concat!("../../crates/nlmodes-io/tests/fixtures/", $name)).to_vec()
        };
    }
    Some(match target {
        "sti" => texts(&[CALCULIX]),
        "matrix-market" => texts(&[MATRIX_MARKET, GENERAL, ARRAY]),
        "abaqus" => texts(&[ABAQUS, USER_ELEMENT]),
        "npz" => vec![fixture!("K_csc.npz"), fixture!("M_csr.npz"), fixture!("M_coo.npz"), fixture!("twice.npz")],
        "mat5" => vec![
            fixture!("packed.mat"),
            fixture!("plain.mat"),
            fixture!("wide.mat"),
            fixture!("nested.mat"),
            fixture!("nested_plain.mat"),
        ],
        "mat73" => vec![fixture!("hdf5.mat"), fixture!("nested73.mat")],
        "hb" => texts(&[HARWELL_BOEING]),
        "pch" => texts(&[DMIG, &format!("{BULK}{DMIG}")]),
        "labels" => texts(&LABELS),
        "inp" => texts(&[DECK]),
        "msh" => texts(&GMSH),
        "bdf" => texts(&[BULK, DMIG]),
        "numbers" => [NUMBERS.map(|text| text.as_bytes().to_vec()).to_vec(), vec![fixture!("modes.npz")]].concat(),
        _ => return None,
    })
}

/// Reads the bytes as a file of the target, in a directory for it.
pub fn read(target: &str, directory: &Path, bytes: &[u8]) {
    let written = |name: &str| -> Option<PathBuf> {
        let path = directory.join(name);
        fs::write(&path, bytes).is_ok().then_some(path)
    };
    match target {
        "labels" => ["case.dof", "case.mapping", "case.csv"].iter().filter_map(|name| written(name)).for_each(|path| {
            refused(LabelTable::read(&path).map(drop));
        }),
        "numbers" => ["case.npz", "case.npy", "case.csv"].iter().filter_map(|name| written(name)).for_each(|path| {
            for name in [None, Some("rows")] {
                let address = Address { path: path.clone(), name: name.map(str::to_owned) };
                refused(read_numbers(&address).map(|table| {
                    assert_eq!(table.values.len(), table.shape.iter().product::<usize>());
                    assert!(table.values.iter().all(|value| value.is_finite()));
                }));
            }
        }),
        "inp" | "msh" | "bdf" => written(&format!("case.{target}")).into_iter().for_each(|path| {
            refused(Mesh::read(&path).map(|mesh| drop((Skin::of(&mesh).normals(&mesh), Skin::of(&mesh).edges()))));
        }),
        _ => {
            let format = match target {
                "sti" => Format::Calculix,
                "matrix-market" => Format::MatrixMarket,
                "abaqus" => Format::Abaqus,
                "npz" => Format::Npz,
                "hb" => Format::HarwellBoeing,
                "pch" => Format::Dmig,
                _ => Format::Mat,
            };
            let Some(path) = written("case.matrix") else { return };
            let names: &[Option<&str>] = match format {
                Format::Mat => &[Some("K"), Some("FEM.model.K"), Some("KM{1}")],
                Format::Abaqus => &[None, Some("STIFFNESS")],
                _ => &[None],
            };
            for name in names {
                let address = Address { path: path.clone(), name: name.map(str::to_owned) };
                for order in [None, Some(24)] {
                    refused(read_matrix(&address, format, order).map(|matrix| {
                        let n = matrix.lower.order();
                        assert!(matrix.lower.entries().all(|(i, j, value)| j <= i && i < n && value.is_finite()));
                    }));
                }
            }
        }
    }
}

/// A refusal says why.
fn refused(read: Result<(), ReadError>) {
    if let Err(error) = read {
        assert!(error.to_string().len() > 20, "{error:?} has no message");
    }
}
