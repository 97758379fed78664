//! Warnings about suspicious files and contacts, for rows of cubes connected by springs.

use std::fmt::Write as _;
use std::fs;

use tempfile::{TempDir, tempdir};

use super::{Matrix, Outcome, call, matrix_market, text};

/// Edge of a cube, m.
const EDGE: f64 = 0.01;
/// Mass of a cube of steel, kg.
const CUBE: f64 = 7850.0 * EDGE * EDGE * EDGE;
/// Corners of a cross section in the order of a solid's, in edges along y and z.
const SECTION: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Rows of three cubes along x. Layer by layer they have nodes from `first` on; the nodes of one end are fixed and have
/// no rows.
struct Row {
    first: usize,
    start: f64,
    held_layer: usize,
}

impl Row {
    fn layers(&self) -> impl Iterator<Item = [usize; 4]> {
        let first = self.first;
        (0..4).map(move |layer| [0, 1, 2, 3].map(|k| first + 4 * layer + k))
    }

    fn cubes(&self) -> Vec<[usize; 8]> {
        let layers: Vec<[usize; 4]> = self.layers().collect();
        let cube = |pair: &[[usize; 4]]| std::array::from_fn(|k| pair[k / 4][k % 4]);
        layers.windows(2).map(cube).collect()
    }

    fn free(&self) -> Vec<usize> {
        let held = self.held_layer;
        self.layers().enumerate().filter(|(layer, _)| *layer != held).flat_map(|(_, nodes)| nodes).collect()
    }
}

/// From 0 to 30 mm, and from 30.3 mm to 60.3 mm.
const ROWS: [Row; 2] =
    [Row { first: 1, start: 0.0, held_layer: 0 }, Row { first: 101, start: 3.03 * EDGE, held_layer: 3 }];

fn deck(rows: &[Row], elements: &[[usize; 8]]) -> String {
    let mut deck = "*NODE\n".to_owned();
    for row in rows {
        for (layer, nodes) in row.layers().enumerate() {
            for (node, [y, z]) in nodes.into_iter().zip(SECTION) {
                _ = writeln!(deck, "{node}, {}, {}, {}", row.start + layer as f64 * EDGE, y * EDGE, z * EDGE);
            }
        }
    }
    deck += "*ELEMENT, TYPE=C3D8\n";
    for (number, nodes) in elements.iter().enumerate() {
        _ = writeln!(deck, "{}, {}", number + 1, nodes.map(|node| node.to_string()).join(", "));
    }
    deck += "*NSET, NSET=TIP\n13, 14, 15, 16\n*NSET, NSET=SIDE\n2, 3, 6, 7, 10, 11, 14, 15\n";
    if rows.len() > 1 {
        deck += "*NSET, NSET=FACE\n101, 102, 103, 104\n";
    }
    deck
}

/// Springs between all nodes of each cube, the same in all directions; an eighth of its mass at each.
fn matrices() -> (Matrix, Matrix, String) {
    let free: Vec<usize> = ROWS.iter().flat_map(Row::free).collect();
    let n = 3 * free.len();
    let (mut k, mut m) = (vec![vec![0.0; n]; n], vec![vec![0.0; n]; n]);
    let row = |node: usize, axis: usize| free.iter().position(|known| *known == node).map(|at| 3 * at + axis);
    for cube in ROWS.iter().flat_map(Row::cubes) {
        for (a, axis) in cube.iter().flat_map(|a| (0..3).map(move |axis| (*a, axis))) {
            let Some(i) = row(a, axis) else { continue };
            m[i][i] += CUBE / 8.0;
            for b in cube.into_iter().filter(|b| *b != a) {
                k[i][i] += 1e7;
                row(b, axis).into_iter().for_each(|j| k[i][j] -= 1e7);
            }
        }
    }
    let labels = free.iter().flat_map(|node| ["ux", "uy", "uz"].map(|name| format!("{node},{name}")));
    let labels: Vec<String> = labels.enumerate().map(|(i, label)| format!("{},{label}", i + 1)).collect();
    (k, m, labels.join("\n"))
}

/// Files of the rows, with these keys of the structure and this contact.
fn scene(folder: &TempDir, structure: &str, contact: &str) -> Outcome<String> {
    let at = |name: &str| folder.path().join(name);
    let (k, m, labels) = matrices();
    fs::write(at("k.mtx"), matrix_market(&k))?;
    fs::write(at("m.mtx"), matrix_market(&m))?;
    fs::write(at("dofs.csv"), labels)?;
    let cubes: Vec<[usize; 8]> = ROWS.iter().flat_map(Row::cubes).collect();
    fs::write(at("mesh.inp"), deck(&ROWS, &cubes))?;
    // Each element reaches one layer too far.
    let shifted =
        |cube: &[usize; 8]| std::array::from_fn(|k| cube[k] + if k < 4 || cube[k] % 100 > 12 { 0 } else { 4 });
    fs::write(at("other.inp"), deck(&ROWS, &cubes.iter().map(shifted).collect::<Vec<_>>()))?;
    // The first row alone, and seven rows, two of which are in the matrices.
    fs::write(at("small.inp"), deck(&ROWS[..1], &ROWS[0].cubes()))?;
    let more = (2..7).map(|row| Row { first: 100 * row + 1, start: 5.0 * row as f64 * EDGE, held_layer: 0 });
    let rows: Vec<Row> = ROWS.into_iter().chain(more).collect();
    fs::write(at("large.inp"), deck(&rows, &rows.iter().flat_map(Row::cubes).collect::<Vec<_>>()))?;
    let files = "stiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"";
    let rest = "[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 1.05\n[output]\nstability = \"never\"\n";
    let mesh = if structure.contains("mesh") { "" } else { "mesh = \"mesh.inp\"" };
    let scene =
        format!("[structure]\nkind = \"matrices\"\n{files}\n{mesh}\n{structure}\n[[contact]]\n{contact}\n{rest}");
    fs::write(at("scene.toml"), scene)?;
    Ok(at("scene.toml").to_string_lossy().into_owned())
}

/// Output of `check`: status, warnings and errors, outline.
fn checked(structure: &str, contact: &str) -> Outcome<(Option<i32>, String, String)> {
    let folder = tempdir()?;
    let output = call(&["check", &scene(&folder, structure, contact)?])?;
    Ok((output.status.code(), text(&output.stderr), text(&output.stdout)))
}

const TIP: &str = "nodes = \"TIP\"\nnormal = [1.0, 0.0, 0.0]\n";
const PAIRS: &str = "nodes = \"TIP\"\nagainst = \"FACE\"\nnormal = [1.0, 0.0, 0.0]\n";
const SI: &str = "units = \"m-kg-s\"";

#[test]
fn sound_files_and_contacts_give_no_warning() -> Outcome {
    for contact in [
        format!("{TIP}gap_m = 1e-4"),
        format!("{TIP}wall_point_m = [0.0301, 7.0, 0.0]"),
        format!("{PAIRS}gap_m = 3e-4"),
        format!("{PAIRS}gap_m = 3.2e-4"),
        PAIRS.to_owned(),
        "nodes = \"TIP\"\nnormal = \"surface\"\ngap_m = 1e-4".to_owned(),
        // Nodes of an edge, of a wall along its face.
        "nodes = [14, 15]\nnormal = [0.0, 1.0, 0.0]\ngap_m = 1e-4".to_owned(),
    ] {
        let (status, errors, outline) = checked(SI, &contact)?;
        assert_eq!((status, errors.as_str()), (Some(0), ""), "{contact}");
        assert!(
            outline.contains("8 nodes of the mesh without rows") && outline.contains("m-kg-s in the files"),
            "{outline}"
        );
    }
    Ok(())
}

#[test]
fn what_looks_wrong_is_warned_of() -> Outcome {
    let wall = format!("{TIP}gap_m = 1e-4");
    for (structure, contact, says) in [
        (
            SI,
            "nodes = \"TIP\"\nnormal = [-2.0, 0.0, 0.0]\ngap_m = 1e-4".to_owned(),
            "`contact.0.normal` [-1, 0, 0] points into the structure at all 4 nodes; outward is [1, 0, 0] at node 13",
        ),
        (SI, format!("{TIP}wall_point_m = [30.1, 0.0, 0.0]"), "`contact.0.wall_point_m` has a gap of 30.1 m at node"),
        (SI, format!("{TIP}gap_m = 0.1"), "`contact.0.gap_m` has a gap of 0.1 m at node"),
        (
            SI,
            format!("{PAIRS}gap_m = 4e-4"),
            "`contact.0.gap_m` has a gap of 0.0004 m, but in the mesh node 16 is 0.0003 m from node 104 along the \
             normal (all 4 pairs differ so)",
        ),
        (
            "units = \"mm-t-s\"",
            wall.clone(),
            "`structure.units` mm-t-s gives a density of 6.54e15 kg/m³ (39.2 kg that can move, 6e-15 m³ of the mesh), \
             which no material has: in m-kg-s it would be plausible",
        ),
        (
            "units = \"m-kg-s\"\nmesh = \"small.inp\"",
            wall.clone(),
            "`structure.mesh` does not look like the mesh of the matrices: 12 of 24 nodes of the matrices are not in \
             it;",
        ),
        (
            "units = \"m-kg-s\"\nmesh = \"large.inp\"",
            wall.clone(),
            "`structure.mesh` does not look like the mesh of the matrices: 15 of its 21 elements have no node with a \
             row;",
        ),
        (
            "units = \"m-kg-s\"\nmesh = \"other.inp\"",
            wall.clone(),
            "`structure.mesh` does not look like the mesh of the matrices: the stiffness does not couple the nodes of",
        ),
    ] {
        let (status, errors, outline) = checked(structure, &contact)?;
        assert_eq!(status, Some(0), "{errors}");
        assert!(errors.contains(says), "{errors}\n{says}");
        assert!(outline.contains("but see the warning"), "{outline}");
    }
    Ok(())
}

#[test]
fn a_wall_behind_the_nodes_presses() -> Outcome {
    // The vibrating parts then have no contact: the other row, and the first one transversely.
    let (_, errors, _) = checked(SI, &format!("{TIP}wall_point_m = [0.0298, 0.0, 0.0]"))?;
    let says = "`contact.0.wall_point_m` has a negative gap at all 4 nodes: at rest the structure is pressed against \
        this stop, which stands up to 0.0002 m";
    assert!(errors.contains(says), "{errors}");
    Ok(())
}

#[test]
fn a_run_warns_as_check_does() -> Outcome {
    let folder = tempdir()?;
    let scene = scene(&folder, SI, "nodes = \"TIP\"\nnormal = [-1.0, 0.0, 0.0]\ngap_m = 1e-4")?;
    let out = folder.path().join("out").to_string_lossy().into_owned();
    let output = call(&["run", &scene, "--out", &out, "--quiet"])?;
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{errors}");
    assert_eq!(errors.matches("points into the structure at all 4 nodes").count(), 1, "{errors}");
    let summary = fs::read_to_string(folder.path().join("out/summary.json"))?;
    assert!(summary.contains("\"mass_redistribution\": \"none\""), "contacts of open modes lose no mass: {summary}");
    Ok(())
}

#[test]
fn check_says_which_nodes_cannot_touch_and_what_was_assumed() -> Outcome {
    let side = "nodes = \"SIDE\"\nnormal = [0.0, 1.0, 0.0]\ngap_m = 1e-4\n[reduction]\nmodes = 3";
    let (status, errors, outline) = checked("", side)?;
    assert_eq!((status, errors.as_str()), (Some(0), ""));
    for says in [
        "m-kg-s assumed, since `structure.units` is left out",
        "contact 0: 2 of 8 nodes of `SIDE` have no rows, being fixed or dependent on others, and are left out",
        "stop 5: node 15 before a wall",
    ] {
        assert!(outline.contains(says), "{outline}\n{says}");
    }
    let (_, _, outline) = checked(SI, PAIRS)?;
    assert!(
        outline
            .contains("stop 0: node 13 before node 101, normal [1, 0, 0], gap 0.0003 m, rigid; 0.0003 m in the mesh"),
        "{outline}"
    );
    Ok(())
}

/// A matrix in the format of CalculiX.
fn sti(n: usize, entry: impl Fn(usize, usize) -> f64) -> String {
    let upper = (0..n).flat_map(|j| (0..=j).map(move |i| (i, j)));
    upper.map(|(i, j)| format!("{} {} {:e}\n", i + 1, j + 1, entry(i, j))).collect()
}

/// A chain of four nodes, clamped before the first one, each of whose three elements has an internal unknown driven by
/// strain, as those of C3D8I.
fn chain(folder: &TempDir, more: &str) -> Outcome<(String, String)> {
    let at = |name: &str| folder.path().join(name);
    let stiffness = |i: usize, j: usize| match (i, j) {
        (3, 3) => 2e6,
        (_, 4..) if i == j => 1e6,
        _ if i == j => 4e6,
        (_, ..4) if i + 1 == j => -2e6,
        (_, 4..) if i + 4 == j => 1e5,
        (_, 4..) if i + 3 == j => -1e5,
        _ => 0.0,
    };
    fs::write(at("c.sti"), sti(7, stiffness))?;
    fs::write(at("c.mas"), sti(7, |i, j| if i == j { 1.0 } else { 0.0 }))?;
    fs::write(at("c.dof"), "1.1\n2.1\n3.1\n4.1\n5.1\n6.1\n7.1\n")?;
    let files = "kind = \"matrices\"\nstiffness = \"c.sti\"\nmass = \"c.mas\"\ndofs = \"c.dof\"";
    let stop = "[[contact]]\nnode = 4\nnormal = [1, 0, 0]\ngap_m = 1e-4\n[reduction]\nmodes = 3";
    let rest = "[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 1.05";
    fs::write(at("c.toml"), format!("[structure]\n{files}\n{stop}\n{rest}\n{more}"))?;
    let output = call(&["check", &at("c.toml").to_string_lossy()])?;
    let (errors, outline) = (text(&output.stderr), text(&output.stdout));
    assert_eq!(output.status.code(), Some(0), "{errors}");
    Ok((errors, outline))
}

#[test]
fn no_mass_is_said_where_unknowns_within_elements_are_among_the_nodes() -> Outcome {
    let folder = tempdir()?;
    let (errors, outline) = chain(&folder, "")?;
    let says = "not known without a mesh: the rows of 3 of 7 nodes do not answer a rigid displacement";
    assert!(errors.is_empty() && outline.contains(says), "{errors}{outline}");
    let shaken = "[damping]\nratio = 0.01\n[base_motion]\ndirection = [1, 0, 0]\nstop = \"moves\"\n\
                  [response]\nkind = \"frequency\"\nfrequency_hz = [50.0, 100.0]\nlevels_m_s2 = [1.0]\n";
    let (errors, _) = chain(&folder, shaken)?;
    assert!(errors.contains("and would be moved by the base: `structure.mesh` tells which are nodes"), "{errors}");
    Ok(())
}

/// Two equal rods, each with its own stop; and a free rod.
#[test]
fn modes_of_the_same_frequency_and_bodies_that_are_pushed_to_one_side_are_warned_of() -> Outcome {
    let folder = tempdir()?;
    let said = |(k, m): &(Matrix, Matrix), mode: usize, contacts: &[(usize, f64)]| -> Outcome<String> {
        let path = |name: &str| folder.path().join(name);
        fs::write(path("k.mtx"), matrix_market(k))?;
        fs::write(path("m.mtx"), matrix_market(m))?;
        fs::write(path("dofs.csv"), (0..k.len()).map(|i| format!("{i},{},ux,{i},0,0\n", i + 1)).collect::<String>())?;
        let files = "stiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"";
        let contact = |(node, side): &(usize, f64)| {
            format!("[[contact]]\nnode = {node}\nnormal = [{side:?}, 0.0, 0.0]\ngap_m = 1e-4\n")
        };
        let contacts: String = contacts.iter().map(contact).collect();
        let rest = format!(
            "[reduction]\nmodes = 4\n[method]\nmode = {mode}\nharmonics = 3\n[continuation]\nmax_energy_ratio = 2.0\n"
        );
        fs::write(path("scene.toml"), format!("[structure]\nkind = \"matrices\"\n{files}\n{contacts}{rest}"))?;
        Ok(text(&call(&["check", &path("scene.toml").to_string_lossy()])?.stderr))
    };
    let (k, m) = super::rod(8);
    let twice = (super::beside(&k, &k), super::beside(&m, &m));
    let same = "have the same frequency (1300 Hz): any combination of them is a linear mode";
    for mode in [1, 2] {
        let warned = said(&twice, mode, &[(8, 1.0), (16, 1.0)])?;
        assert!(warned.contains(same), "{warned}");
    }
    // One stop, or two at one of them, determine the motion uniquely.
    assert_eq!(said(&twice, 1, &[(8, 1.0)])?, "");
    assert_eq!(said(&twice, 1, &[(8, 1.0), (8, -1.0)])?, "");
    let free = super::free_rod(8);
    let pushed = "the structure floats, and all contacts push it to the same side";
    assert!(said(&free, 2, &[(9, 1.0)])?.contains(pushed));
    assert!(said(&free, 2, &[(9, 1.0), (5, 1.0)])?.contains(pushed));
    assert_eq!(said(&free, 2, &[(9, 1.0), (1, -1.0)])?, "");
    Ok(())
}

/// A rod whose first mode moves its contact, next to the clamped end, by an eighth of its tip.
#[test]
fn a_mode_that_hardly_moves_the_contacts_is_warned_of() -> Outcome {
    let folder = tempdir()?;
    let (k, m) = super::rod(12);
    fs::write(folder.path().join("k.mtx"), matrix_market(&k))?;
    fs::write(folder.path().join("m.mtx"), matrix_market(&m))?;
    let rows = (1..=12).map(|i| format!("{i},{i},ux,{},0,0\n", f64::from(i) / 12.0));
    fs::write(folder.path().join("dofs.csv"), rows.collect::<String>())?;
    let said = |node: usize, gap: f64| -> Outcome<String> {
        let scene = folder.path().join("scene.toml");
        let files = "stiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"";
        let rest = "[reduction]\nmodes = 8\n[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 2.0\n";
        let contact = format!("[[contact]]\nnode = {node}\nnormal = [1.0, 0.0, 0.0]\ngap_m = {gap:e}\n");
        fs::write(&scene, format!("[structure]\nkind = \"matrices\"\n{files}\n{contact}{rest}"))?;
        Ok(text(&call(&["check", &scene.to_string_lossy()])?.stderr))
    };
    // sin(π/24) of the tip's: 10 mm there are 77 mm at the tip.
    let warned = said(1, 0.01)?;
    assert!(warned.contains("mode 1 (1300 Hz) hardly moves the contacts: where node 1 has gone"), "{warned}");
    assert!(warned.contains("node 12 is displaced by 0.0766 m, in a structure of 0.917 m"), "{warned}");
    // Small displacements, or a contact that dominates the mode.
    for (node, gap) in [(1, 1e-4), (12, 0.05)] {
        assert_eq!(said(node, gap)?, "", "{node} {gap}");
    }
    Ok(())
}
