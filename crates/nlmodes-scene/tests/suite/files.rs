//! Scenes of structures from files: errors at their keys, normals of surfaces.

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use nlmodes_scene::assemble::{OpenStructure, Structures};
use nlmodes_scene::parse;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// A temporary folder.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        _ = fs::remove_dir_all(&self.0);
    }
}

/// A unit brick in which each displacement of nodes 2, 3, 6 and 7, on its face x = 1, has its own mass and spring.
fn brick(name: &str) -> Outcome<Folder> {
    let folder = Folder(std::env::temp_dir().join(format!("nlmodes-scene-{name}-{}", std::process::id())));
    fs::create_dir_all(&folder.0)?;
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let mut mesh = "*NODE\n".to_owned();
    for (i, [x, y, z]) in corners.iter().enumerate() {
        writeln!(mesh, "{}, {x}, {y}, {z}", i + 1)?;
    }
    mesh += "*ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=END\n2, 3, 6, 7\n";
    fs::write(folder.0.join("brick.inp"), mesh)?;
    let diagonal = |value: fn(usize) -> usize| {
        let entries = (1..=12).map(|i| format!("{i} {i} {}\n", value(i)));
        format!("%%MatrixMarket matrix coordinate real symmetric\n12 12 12\n{}", entries.collect::<String>())
    };
    // Stiffest along x, so that what the modes leave out is what the contacts press.
    fs::write(folder.0.join("k.mtx"), diagonal(|i| 100 * i + if i % 3 == 1 { 10_000 } else { 0 }))?;
    fs::write(folder.0.join("m.mtx"), diagonal(|_| 1))?;
    let rows = [2, 3, 6, 7].iter().flat_map(|node| ["ux", "uy", "uz"].map(|name| format!("{node},{name}")));
    let rows: Vec<String> = rows.enumerate().map(|(i, row)| format!("{},{row}\n", i + 1)).collect();
    fs::write(folder.0.join("dofs.csv"), rows.concat())?;
    Ok(folder)
}

const CONTACT: &str = "[[contact]]\nnodes = \"END\"\nnormal = \"surface\"\ngap_m = 1e-3\n";

/// The structure of the scene, or the error: the key, and the text.
fn open(folder: &Path, contact: &str, more: &str) -> Outcome<Result<OpenStructure, (String, String)>> {
    let text = format!(
        "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\nmesh \
            = \"brick.inp\"\n\
         {contact}{more}\n[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 3.0\n"
    );
    let name = folder.join("scene.toml");
    let file = parse(&name.to_string_lossy(), &text, &[]).map_err(|refused| refused.text(false))?;
    Ok(OpenStructure::of(&file.scene, &Structures::default()).map_err(|error| (error.path(), error.to_string())))
}

#[test]
fn the_normal_of_a_face_is_its_own_up_to_its_edges() -> Outcome {
    let folder = brick("face")?;
    let found = open(&folder.0, CONTACT, "[reduction]\nmodes = 6\n")?.map_err(|(_, text)| text)?;
    let (_, contacts) = found.files.ok_or("no files")?;
    assert_eq!(contacts.iter().map(|contact| contact.node).collect::<Vec<_>>(), [2, 3, 6, 7]);
    assert!(contacts.iter().all(|contact| contact.normal == [1.0, 0.0, 0.0]), "{contacts:?}");
    // A single vertex has the mean of its three faces.
    let corner = CONTACT.replace("\"END\"", "[7]");
    let found = open(&folder.0, &corner, "[reduction]\nmodes = 6\n")?.map_err(|(_, text)| text)?;
    let normal = found.files.ok_or("no files")?.1[0].normal;
    assert!(normal.iter().all(|n| (n - 1.0 / 3.0_f64.sqrt()).abs() < 1e-15), "{normal:?}");
    Ok(())
}

#[test]
fn a_file_that_is_not_there_is_named_at_its_key() -> Outcome {
    for (name, key) in [("k.mtx", "stiffness"), ("m.mtx", "mass"), ("dofs.csv", "dofs"), ("brick.inp", "mesh")] {
        let folder = brick(key)?;
        fs::remove_file(folder.0.join(name))?;
        let (path, text) = open(&folder.0, CONTACT, "")?.err().ok_or("taken")?;
        assert!(path == format!("structure.{key}") && text.contains(name), "{path}: {text}");
    }
    Ok(())
}

#[test]
fn more_modes_than_degrees_of_freedom_are_refused_with_both_numbers() -> Outcome {
    let folder = brick("modes")?;
    let (path, text) = open(&folder.0, CONTACT, "[reduction]\nmodes = 13\n")?.err().ok_or("taken")?;
    assert_eq!(path, "reduction.modes");
    assert!(text.contains("13 modes") && text.contains("12 degrees of freedom"), "{text}");
    Ok(())
}
