//! Whole structures from several files, which one input holds one after the other, between lines of `====`.

use std::fs;
use std::path::Path;

use nlmodes_io::{FeFiles, FeModel};
use nlmodes_scene::assemble::{OpenStructure, Structures};

/// Names of the targets.
pub const TARGETS: [&str; 2] = ["model", "reduced"];

/// The line between two files.
const BETWEEN: &str = "====\n";

/// Words of these files.
pub const WORDS: &[&str] = &[
    BETWEEN,
    "\n",
    ",",
    "0",
    "-",
    "1e30",
    "1e999",
    "1e-320",
    "nan",
    "2.3\n",
    "3.1\n",
    "99999999999",
    "*ELEMENT, TYPE=S8R\n",
    "*ELEMENT, TYPE=T3D2\n",
    "*ELEMENT, TYPE=CPS4\n",
    "*TRANSFORM, NSET=ALL\n1,0,0,0,1,0\n",
    "*EQUATION\n2\n2,1,1.,3,1,-1.\n",
    "*ELASTIC\n",
    "#",
    "\0",
    "ä",
];

/// A shell of one element of which nodes 3 and 4 are two nodes each, one row of node 2 and one that is held by equal
/// values: stiffness, mass, labels, deck.
const SHELL: [&str; 4] = [
    "1 1 10.0\n1 2 -1.0\n2 2 8.0\n2 3 -3.0\n3 3 8.0\n3 4 -2.0\n4 4 9.0\n4 5 -1.5\n5 5 7.0\n6 6 1e6\n",
    "1 1 1.0\n1 2 0.1\n2 2 2.0\n3 3 2.0\n4 4 2.5\n5 5 2.0\n6 6 1e6\n",
    "2.3\n3.3\n3.3\n4.3\n4.3\n5.3\n",
    "*NODE, NSET=ALL\n1\n2, 1\n3, 1, 1\n4, 0, 1\n5, 0, 2\n*ELEMENT, TYPE=S4, ELSET=E\n1, 1, 2, 3, 4\n*BOUNDARY\n1, 1, 6\n2, \
     3\n*MATERIAL, NAME=M\n*ELASTIC\n2.1e11, 0.3\n*SHELL SECTION, ELSET=E, MATERIAL=M\n0.001\n",
];
/// Frequencies, rows of the contacts and flexibility.
const REDUCED: [[&str; 3]; 2] = [
    ["10.0\n20.0 # Hz\n40.0\n", "# rows\n1.0,-2.5e-3,0.3\n0.2,1.1,4D-01\n", "1e-3,2e-4\n2e-4,2e-3\n"],
    ["0\n20.0\n40.0\n", "1.0,0.5\n0.2,1.1\n0.3,0.4\n", "1e-4 0\n0 1e-4\n"],
];

/// Valid files of a target; none if there is no such target.
pub fn corpus(target: &str) -> Option<Vec<Vec<u8>>> {
    let joined = |parts: &[&str]| parts.join(BETWEEN).into_bytes();
    match target {
        "model" => Some(vec![joined(&SHELL)]),
        "reduced" => Some(REDUCED.iter().map(|parts| joined(parts)).collect()),
        _ => None,
    }
}

/// Reads the parts of the bytes as the files of a structure, in a directory for them.
pub fn read(target: &str, directory: &Path, bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let parts: Vec<&str> = text.split(BETWEEN).collect();
    let written = |names: &[&str]| {
        let part = |(k, name): (usize, &&str)| fs::write(directory.join(name), parts.get(k).unwrap_or(&"")).is_ok();
        names.iter().enumerate().all(part)
    };
    match target {
        "model" if written(&["x.sti", "x.mas", "x.dof", "x.inp"]) => model(directory),
        "reduced" if written(&["f.csv", "rows.csv", "a.csv"]) => {
            ["flexibility_m_n", "residual_flexibility_m_n"].into_iter().for_each(|key| reduced(directory, key));
        }
        _ => {}
    }
}

fn model(directory: &Path) {
    let at = |name: &str| directory.join(name).to_string_lossy().into_owned();
    let mut files = FeFiles::new(&at("x.sti"), &at("x.mas"));
    files.dofs = Some(at("x.dof").into());
    for mesh in [None, Some(at("x.inp").into())] {
        files.mesh = mesh;
        match FeModel::read(&files) {
            Ok(model) => {
                let n = model.n_dofs();
                assert!(model.stiffness.order() == n && model.mass.order() == n && model.rows_alone().len() == n);
                // Finite entries of the largest sizes may have sums that are not.
                if let Ok(written) = model.written()
                    && let Some(origin) = written.origin
                {
                    assert_eq!((origin.motion.nrows(), origin.motion.ncols()), (origin.stiffness.nrows(), n));
                }
            }
            Err(error) => assert!(error.to_string().len() > 20, "{error:?} has no message"),
        }
    }
}

fn reduced(directory: &Path, key: &str) {
    let text = format!(
        "[structure]\nkind = \"reduced\"\nfrequencies_hz = \"f.csv\"\ncontact_rows = \"rows.csv\"\n{key} = \
         \"a.csv\"\n[[contact]]\nrow = 1\ngap_m = 1e-3\n[[contact]]\nrow = 2\nside = \"negative\"\ngap_m = \
         1e-3\n[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 5.0\n"
    );
    match nlmodes_scene::parse(&directory.join("scene.toml").to_string_lossy(), &text, &[]) {
        Ok(file) => {
            if let Err(error) = OpenStructure::of(&file.scene, &Structures::default()) {
                assert!(error.to_string().len() > 20, "{error:?} has no message");
            }
        }
        Err(refused) => assert!(refused.text(false).contains("error"), "a scene is refused without a reason"),
    }
}
