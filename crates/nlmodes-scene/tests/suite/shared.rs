//! Structures from files that several scenes share: the results are the same as for each alone.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use nlmodes_scene::assemble::{Assembly, Structures};
use nlmodes_scene::scene::Scene;

const TWO_MASSES: &str = r#"
[structure]
kind = "matrices"
stiffness = "k.mtx"
mass = "m.mtx"
dofs = "two.csv"
[[contact]]
node = 2
normal = [1.0, 0.0, 0.0]
gap_m = 1e-3
[reduction]
modes = 1
[method]
harmonics = 1
[continuation]
max_energy_ratio = 2.0
"#;

fn scene(name: &Path, text: &str, set: &[&str]) -> Scene {
    let set: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    nlmodes_scene::parse(name.to_str().unwrap(), text, &set).map_err(|refused| refused.text(false)).unwrap().scene
}

fn two_masses(directory: &Path, stiffness: f64) {
    let k = format!(
        "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 {}\n2 1 {}\n2 2 {stiffness}\n",
        2.0 * stiffness,
        -stiffness
    );
    fs::write(directory.join("k.mtx"), k).unwrap();
    fs::write(directory.join("m.mtx"), "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 1\n2 2 1\n")
        .unwrap();
    fs::write(directory.join("two.csv"), "row,node,component\n1,1,ux\n2,2,ux\n").unwrap();
}

/// Everything of a structure, to the last bit.
fn bits(assembly: &Assembly) -> String {
    let model = &assembly.model;
    format!("{:?} {:?} {:?}", model.mass().val(), model.stiffness().val(), model.contacts())
}

#[test]
fn what_is_shared_is_what_each_gets_alone() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/structures/plate.toml");
    let text = fs::read_to_string(&path).unwrap();
    let structures = Structures::default();
    let mut files = Vec::new();
    for set in [
        &[][..],
        &["contact.0.gap_m=1e-3"],
        &["contact.0.gap_m=-1e-4"],
        &["method.harmonics=3"],
        &["contact.0.normal=[0.0, 0.6, 0.8]"],
        &["reduction.kind=\"held-modes\"", "method.kind=\"hbm\"", "method.contact_stiffness_n_m=1e7"],
    ] {
        let scene = scene(&path, &text, set);
        let [shared, alone] = [Assembly::sharing(&scene, &structures).unwrap(), Assembly::of(&scene).unwrap()];
        assert_eq!(bits(&shared), bits(&alone), "{set:?}");
        files.extend(shared.open.and_then(|open| Some(open.files?.0)));
    }
    assert!(files.len() == 5 && files.iter().all(|model| Arc::ptr_eq(model, &files[0])), "the files were read again");
}

#[test]
fn files_that_change_are_read_again() {
    let place = tempfile::tempdir().unwrap();
    let scene = || scene(&place.path().join("two.toml"), TWO_MASSES, &[]);
    let structures = Structures::default();
    for stiffness in [1.0, 100.0] {
        two_masses(place.path(), stiffness);
        let assembly = Assembly::sharing(&scene(), &structures).unwrap();
        let lowest = assembly.open.unwrap().modes.omega_squared()[0];
        // Two unit masses on two springs in series: ω² = k (3 − √5)/2.
        let wanted = stiffness * (3.0 - 5.0_f64.sqrt()) / 2.0;
        assert!((lowest - wanted).abs() < 1e-12 * wanted, "{lowest} {wanted}");
    }
}
