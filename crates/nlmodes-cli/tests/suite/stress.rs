//! Largest stress over a period, `stress_pa` of `branch.csv`, against closed forms.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::Path;

use tempfile::tempdir;

use crate::sliding;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;
type Row = BTreeMap<String, String>;

fn run(folder: &Path, text: &str) -> Outcome<Vec<Row>> {
    sliding::run(folder, text)?;
    let rows = sliding::rows(&folder.join("out/branch.csv"))?;
    if rows.is_empty() { Err("no points".into()) } else { Ok(rows) }
}

fn number(row: &Row, column: &str) -> f64 {
    row.get(column).and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN)
}

/// A clamped rod or beam of 0.8 m that a force too small to matter shakes, far before its stop.
fn shaken(kind: &str, section: &str, direction: &str, more: &str) -> String {
    format!(
        "[structure]\nkind = \"{kind}\"\nlength_m = 0.8\nelements = 8\nstart = \"clamped\"\n\
         material = {{ youngs_modulus_pa = 2e11, density_kg_m3 = 8000.0 }}\nsection = {{ {section} }}\n\
         [[contact]]\nat_m = 0.8\ndirection = \"{direction}\"\nside = \"positive\"\ngap_m = 1.0\n\
         [damping]\nratio = 0.01\n[[force]]\nat_m = 0.8\ndirection = \"{direction}\"\namplitude_n = 1e-9\n\
         [[response]]\nkind = \"frequency\"\nfrequency_hz = [2.0, 3.0]\n[method]\nharmonics = 2\n\
         [output]\nstability = \"never\"\nfigures = false\npage = false\n{more}"
    )
}

/// `F L c/I` at the clamp of a beam of every kind of section, `F/A` in a rod, and none under heat in one that may
/// expand.
#[test]
fn rods_and_beams_at_rest_have_the_stress_of_their_static_loads() -> Outcome {
    let folder = tempdir()?;
    let load =
        |direction: &str| format!("[[static_force]]\nat_m = 0.8\ndirection = \"{direction}\"\nforce_n = -12.0\n");
    let rectangle = 12.0 * 0.8 * 0.01 / (0.01 * 0.02_f64.powi(3) / 12.0);
    let tube = 12.0 * 0.8 * 0.02 / (std::f64::consts::PI / 64.0 * (0.04_f64.powi(4) - 0.03_f64.powi(4)));
    let cases = [
        ("width_m = 0.01, height_m = 0.02", rectangle),
        ("outer_m = 0.04, wall_m = 0.005", tube),
        ("area_m2 = 2e-4, second_moment_m4 = 3e-9, outer_fibre_m = 0.012", 12.0 * 0.8 * 0.012 / 3e-9),
    ];
    for (section, expected) in cases {
        for row in run(folder.path(), &shaken("beam", section, "transverse", &load("transverse")))? {
            assert!((number(&row, "stress_pa") / expected - 1.0).abs() < 1e-6, "{section}, {expected}: {row:?}");
            assert_eq!(number(&row, "stress_at"), 0.0);
        }
    }
    for row in run(folder.path(), &shaken("rod", "area_m2 = 2e-4", "axial", &load("axial")))? {
        assert!((number(&row, "stress_pa") / (12.0 / 2e-4) - 1.0).abs() < 1e-6, "{row:?}");
    }
    let heat = "[thermal]\nexpansion_1_k = 1.2e-5\ntemperature_k = 50.0\n";
    for row in run(folder.path(), &shaken("rod", "area_m2 = 2e-4", "axial", heat))? {
        // Next to the stress E α ΔT of a rod that is held.
        assert!(number(&row, "stress_pa") < 1e-9 * 2e11 * 1.2e-5 * 50.0, "{row:?}");
    }
    let unknown = run(folder.path(), &shaken("beam", "area_m2 = 2e-4, second_moment_m4 = 3e-9", "transverse", ""))?;
    assert!(unknown.iter().all(|row| row["stress_pa"].is_empty() && row["stress_at"].is_empty()));
    let off = shaken("rod", "area_m2 = 2e-4", "axial", &load("axial"))
        .replace("page = false", "page = false\nstress = false");
    assert!(run(folder.path(), &off)?.iter().all(|row| row["stress_pa"].is_empty()));
    Ok(())
}

/// A rod of two elements in its first mode before a rigid stop: its stress is `E u′` of the first one.
#[test]
fn a_branch_of_two_elements_has_the_stress_of_its_largest_displacement() -> Outcome {
    let folder = tempdir()?;
    let text = "[structure]\nkind = \"rod\"\nlength_m = 0.5\nelements = 2\nstart = \"clamped\"\n\
        material = { youngs_modulus_pa = 7e10, density_kg_m3 = 2700.0 }\nsection = { area_m2 = 1e-4 }\n\
        [[contact]]\nat_m = 0.5\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-4\n\
        [method]\nharmonics = 5\n[continuation]\nmax_energy_ratio = 2.0\n\
        [output]\nstability = \"never\"\nfigures = false\npage = false\n";
    let rows = run(folder.path(), text)?;
    let stress: Vec<f64> = rows.iter().map(|row| number(row, "stress_pa")).collect();
    // At grazing the mode of two elements has `u(L/2) = u(L)/√2`, so that the first one is strained by √2 u(L)/L.
    let grazing = 7e10 * 2.0_f64.sqrt() * 1e-4 / 0.5;
    assert!((stress[0] / grazing - 1.0).abs() < 1e-6, "{} of {grazing}", stress[0]);
    assert_eq!(number(&rows[0], "stress_at"), 0.125);
    assert!(stress.windows(2).all(|pair| pair[1] > 0.9 * pair[0]) && stress[stress.len() - 1] > 1.2 * grazing);
    Ok(())
}

/// A cube of one element whose free face moves as one along x: `E u/L`, rest included, in the table and in the frames.
#[test]
fn a_mesh_of_a_cube_has_the_stress_of_its_strain() -> Outcome {
    let folder = tempdir()?;
    let deck = "*NODE\n1,0,0,0\n2,0,100,0\n3,0,100,100\n4,0,0,100\n5,100,0,0\n6,100,100,0\n7,100,100,100\n8,100,0,100\n\
        *ELEMENT, TYPE=C3D8, ELSET=E\n1,1,2,3,4,5,6,7,8\n*MATERIAL, NAME=SOFT\n*ELASTIC\n3000., 0.\n\
        *SOLID SECTION, ELSET=E, MATERIAL=SOFT\n*BOUNDARY\n1,1,3\n2,1,3\n3,1,3\n4,1,3\n5,2,3\n6,2,3\n7,2,3\n8,2,3\n";
    fs::write(folder.path().join("cube.inp"), deck)?;
    // Four nodes on 75 N/mm each, tied to each other by far more.
    let mut stiffness = String::from("%%MatrixMarket matrix coordinate real symmetric\n4 4 10\n");
    for (i, j) in (1..=4).flat_map(|i| (1..=i).map(move |j| (i, j))) {
        stiffness += &format!("{i} {j} {:?}\n", if i == j { 75.0 + 3e9 } else { -1e9 });
    }
    fs::write(folder.path().join("k.mtx"), stiffness)?;
    let mass = "%%MatrixMarket matrix coordinate real symmetric\n4 4 4\n1 1 1e-4\n2 2 1e-4\n3 3 1e-4\n4 4 1e-4\n";
    fs::write(folder.path().join("m.mtx"), mass)?;
    fs::write(folder.path().join("dofs.csv"), "1,5,ux\n2,6,ux\n3,7,ux\n4,8,ux\n")?;
    let text = "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\n\
        mesh = \"cube.inp\"\nunits = \"mm-t-s\"\n[[contact]]\nnode = 5\nnormal = [1.0, 0.0, 0.0]\ngap_m = 1.0\n\
        [[static_force]]\nnode = 6\ndirection = [1.0, 0.0, 0.0]\nforce_n = -600.0\n\
        [reduction]\nmodes = 1\n[damping]\nratio = 0.01\n[[force]]\nnode = 7\ndirection = [1.0, 0.0, 0.0]\n\
        amplitude_n = 30.0\n[[response]]\nkind = \"frequency\"\nfrequency_hz = [20.0, 30.0]\ndrive_node = 5\n\
        [method]\nharmonics = 30\n[output]\nstability = \"never\"\n";
    let text = text.replace("drive_node = 5\n", "");
    let rows = run(folder.path(), &text)?;
    for row in &rows {
        // 3 GPa over 0.1 m; 600 N over four springs of 75 N/mm.
        let expected = 3e9 / 0.1 * (600.0 / 3e5 + number(row, "drive_fundamental_m"));
        assert!((number(row, "stress_pa") / expected - 1.0).abs() < 1e-3, "{expected}: {row:?}");
    }
    let frame = fs::read_to_string(folder.path().join("out/motion_000.vtu"))?;
    for field in ["\"stress\" NumberOfComponents=\"6\"", "\"von_mises\"", "\"principal_stress\""] {
        assert!(frame.contains(field), "{field}");
    }
    // Three shapes at eight nodes take 1.4 kB: with less memory there is none, which is reported.
    let rows = run(folder.path(), &(text + "stress_memory_gb = 1e-6\n"))?;
    assert!(rows.iter().all(|row| row["stress_pa"].is_empty()), "{rows:?}");
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("out/summary.json"))?)?;
    let said = summary["stress_left_out"].as_str().unwrap_or_default();
    assert!(said.contains("more than the 1e-6 GB of output.stress_memory_gb"), "{said}");
    Ok(())
}
