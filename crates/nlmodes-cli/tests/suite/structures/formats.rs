//! One structure through every format, and turned in space: the same branch.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::{TempDir, tempdir};

use crate::structures::sample::{Entry, N, mass, stiffness};
use crate::structures::{Outcome, call, text, writers};

/// Frequency (Hz), energy (J), largest displacement (m) and force (N) of each point.
type Branch = Vec<[f64; 4]>;

/// The sample with a stop beside node 80, which its first mode moves most, from these files; `files` are the lines that
/// name them.
fn branch(folder: &TempDir, files: &str, normal: [f64; 3]) -> Outcome<Branch> {
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    let text_of_scene = format!(
        "[structure]\nkind = \"matrices\"\n{files}\n[[contact]]\nnode = 80\nnormal = {normal:?}\ngap_m = 2e-4\n\
         [reduction]\nmodes = 6\n[method]\nharmonics = 5\n[continuation]\nmax_energy_ratio = 3.0\n\
         [output]\nstability = \"never\"\nfigures = false\npage = false\n"
    );
    fs::write(&scene, text_of_scene)?;
    let arguments = ["run", &scene.to_string_lossy(), "--out", &out.to_string_lossy(), "--quiet", "--force"];
    let output = call(&arguments)?;
    assert_eq!(output.status.code(), Some(0), "{files}: {}", text(&output.stderr));
    let mut table = csv::Reader::from_path(out.join("branch.csv"))?;
    let names = table.headers()?.clone();
    let place = |name: &str| names.iter().position(|found| found == name).ok_or(format!("no {name} in {names:?}"));
    let places = [place("frequency_hz")?, place("energy_j")?, place("peak_m")?, place("peak_contact_force_n")?];
    let mut rows = Branch::new();
    for record in table.records() {
        let record = record?;
        let mut row = [0.0; 4];
        for (value, place) in row.iter_mut().zip(places) {
            *value = record[place].parse()?;
        }
        rows.push(row);
    }
    Ok(rows)
}

/// All numbers of all points agree, forces where there are any.
#[track_caller]
fn assert_same(found: &Branch, expected: &Branch, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let force = expected.iter().fold(0.0_f64, |most, row| most.max(row[3]));
    for (a, b) in found.iter().zip(expected) {
        for i in 0..4 {
            let size = if i == 3 { force } else { b[i] };
            assert!((a[i] - b[i]).abs() <= 1e-9 * size, "{what}: {a:?} {b:?}");
        }
    }
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../nlmodes-io/tests/fixtures").join(name)
}

fn named(stiffness: &str, mass: &str, dofs: &str) -> String {
    let dofs = if dofs.is_empty() { String::new() } else { format!("dofs = \"{dofs}\"") };
    format!("stiffness = \"{stiffness}\"\nmass = \"{mass}\"\n{dofs}")
}

/// Writes both matrices as one program does and gives the lines that name them.
fn written(folder: &TempDir, ending: &str, of: impl Fn(&str, &[Entry]) -> String, dofs: &str) -> Outcome<String> {
    let name = |matrix: &str| format!("{matrix}{ending}");
    for (matrix, lower) in [("K", stiffness()), ("M", mass())] {
        fs::write(folder.path().join(name(matrix)), of(matrix, &lower))?;
    }
    Ok(named(&name("K"), &name("M"), dofs))
}

/// The text of a matrix in a format.
type Writer = fn(&[Entry]) -> String;

/// A unit vector; what yields along z has no mass at that node.
const NORMAL: [f64; 3] = [0.36, 0.48, 0.8];

#[test]
fn a_structure_has_the_same_branch_from_every_format() -> Outcome {
    let folder = tempdir()?;
    fs::write(folder.path().join("table.csv"), writers::table())?;
    fs::write(folder.path().join("x.dof"), writers::dof())?;
    fs::write(folder.path().join("x.mapping"), writers::mapping())?;
    let expected = branch(&folder, &written(&folder, ".mtx", |_, a| writers::matrix_market(a), "table.csv")?, NORMAL)?;
    assert!(expected.len() > 10 && expected.iter().any(|row| row[3] > 0.0));
    let files = [
        ("K_csc.npz", "M_csc.npz"),
        ("K_csr.npz", "M_csr.npz"),
        ("K_coo.npz", "M_coo.npz"),
        ("K_general.mtx", "M_general.mtx"),
        ("K_array.mtx", "M_array.mtx"),
        ("plain.mat#K", "plain.mat#M"),
        ("packed.mat#K", "packed.mat#M"),
        ("hdf5.mat#K", "hdf5.mat#M"),
    ];
    for (stiffness, mass) in files {
        let [k, m] = [stiffness, mass].map(|name| fixture(name).to_string_lossy().into_owned());
        assert_same(&branch(&folder, &named(&k, &m, "table.csv"), NORMAL)?, &expected, stiffness);
    }
    let texts: [(&str, Writer, &str); 3] = [
        (".sti", writers::calculix, "x.dof"),
        (".hb", writers::harwell_boeing, "x.mapping"),
        ("_.mtx", |a| writers::abaqus(a, false), ""),
    ];
    for (ending, of, dofs) in texts {
        let files = written(&folder, ending, |_, a| of(a), dofs)?;
        assert_same(&branch(&folder, &files, NORMAL)?, &expected, ending);
    }
    Ok(())
}

/// A punch file has ten digits: the structure that it describes is another one, which Matrix Market can hold too.
#[test]
fn a_structure_of_ten_digits_is_the_same_from_a_punch_file() -> Outcome {
    let folder = tempdir()?;
    fs::write(folder.path().join("table.csv"), writers::table())?;
    let rounded = |lower: &[Entry]| -> Vec<Entry> {
        let digits = |value: f64| writers::exponent(value, 9).parse().unwrap_or(f64::NAN);
        lower.iter().map(|(i, j, value)| (*i, *j, digits(*value))).collect()
    };
    let of_market = |_: &str, a: &[Entry]| writers::matrix_market(&rounded(a));
    let expected = branch(&folder, &written(&folder, ".mtx", of_market, "table.csv")?, NORMAL)?;
    let punched = written(&folder, ".pch", |matrix, a| writers::dmig(&format!("{matrix}AAX"), a), "")?;
    assert_same(&branch(&folder, &punched, NORMAL)?, &expected, "punch file");
    Ok(())
}

/// `R_ij` of a turn about an axis that is none of the structure's.
fn turn() -> [[f64; 3]; 3] {
    let ([x, y, z], angle) = ([2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0], 0.9_f64);
    let (sin, cos, rest) = (angle.sin(), angle.cos(), 1.0 - angle.cos());
    [
        [cos + x * x * rest, x * y * rest - z * sin, x * z * rest + y * sin],
        [y * x * rest + z * sin, cos + y * y * rest, y * z * rest - x * sin],
        [z * x * rest - y * sin, z * y * rest + x * sin, cos + z * z * rest],
    ]
}

/// `R A Rᵀ`, node by node.
fn turned(lower: &[Entry]) -> Vec<Vec<f64>> {
    let mut full = vec![vec![0.0; N]; N];
    lower.iter().for_each(|&(i, j, value)| (full[i][j], full[j][i]) = (value, value));
    let (r, mut turned) = (turn(), vec![vec![0.0; N]; N]);
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let (a, b) = (3 * (i / 3), 3 * (j / 3));
        turned[i][j] = (0..3)
            .flat_map(|k| (0..3).map(move |l| (k, l)))
            .map(|(k, l)| r[i % 3][k] * full[a + k][b + l] * r[j % 3][l])
            .sum();
    }
    turned
}

#[test]
fn a_structure_that_is_turned_in_space_has_the_same_branch() -> Outcome {
    let folder = tempdir()?;
    fs::write(folder.path().join("table.csv"), writers::table())?;
    let expected = branch(&folder, &written(&folder, ".mtx", |_, a| writers::matrix_market(a), "table.csv")?, NORMAL)?;
    for (name, lower) in [("K.mtx", stiffness()), ("M.mtx", mass())] {
        fs::write(folder.path().join(name), crate::structures::matrix_market(&turned(&lower)))?;
    }
    let normal = turn().map(|row| row.iter().zip(NORMAL).map(|(r, n)| r * n).sum());
    assert_same(&branch(&folder, &named("K.mtx", "M.mtx", "table.csv"), normal)?, &expected, "turned");
    Ok(())
}
