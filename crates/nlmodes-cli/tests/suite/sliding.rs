//! How contacts slide in motions that are computed without friction: `contacts.csv` against closed forms and against
//! the histories of the same points.

use std::collections::BTreeMap;
use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use npyz::npz::NpzArchive;
use tempfile::tempdir;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;
type Row = BTreeMap<String, String>;

/// Stiffness along x and z (N/m), mass (kg) of a body on two springs.
const BODY: [f64; 3] = [1e4, 4e6, 0.5];
const DAMPING: f64 = 0.02;
const INTERFERENCE: f64 = 2e-4;

/// A symmetric matrix as Matrix Market.
fn matrix(path: PathBuf, entries: &[(usize, usize, f64)], n: usize) -> Outcome {
    let mut text = format!("%%MatrixMarket matrix coordinate real symmetric\n{n} {n} {}\n", entries.len());
    entries.iter().for_each(|(i, j, value)| text += &format!("{} {} {value:?}\n", i + 1, j + 1));
    Ok(fs::write(path, text)?)
}

/// Runs a scene in a folder, into `out`, and gives its `contacts.csv`.
pub fn run(folder: &Path, text: &str) -> Outcome<Vec<Row>> {
    let scene = folder.join("scene.toml");
    fs::write(&scene, text)?;
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    let output = call.args(["run", "--quiet", "--force", "--out"]).arg(folder.join("out")).arg(&scene).output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    rows(&folder.join("out/contacts.csv"))
}

/// The rows of a table, by the names of its columns.
pub fn rows(path: &Path) -> Outcome<Vec<Row>> {
    let mut table = csv::Reader::from_path(path)?;
    Ok(table.deserialize().collect::<Result<_, _>>()?)
}

fn number(row: &Row, column: &str) -> f64 {
    row.get(column).and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN)
}

/// Whether nothing is reported of sliding.
fn is_empty(row: &Row) -> bool {
    ["wear_work_rate_w", "sliding_path_m", "friction_power_w"].iter().all(|column| row[*column].is_empty())
}

/// `count` equal bodies that move along x and z, each of two springs, that do not feel each other.
fn bodies(folder: &Path, count: usize) -> Outcome {
    let [kx, kz, m] = BODY;
    let each =
        |x: f64, z: f64| (0..2 * count).map(|i| (i, i, if i.is_multiple_of(2) { x } else { z })).collect::<Vec<_>>();
    matrix(folder.join("k.mtx"), &each(kx, kz), 2 * count)?;
    matrix(folder.join("m.mtx"), &each(m, m), 2 * count)?;
    let row = |i: usize| format!("{},{},u{}\n", i + 1, 1 + i / 2, if i.is_multiple_of(2) { "x" } else { "z" });
    Ok(fs::write(folder.join("dofs.csv"), (0..2 * count).map(row).collect::<String>())?)
}

/// A curve over the frequency of bodies that are pressed along z while forces of these amplitudes shake them along x.
fn pressed(against: &str, forces: &[f64]) -> String {
    let force = |(i, amplitude): (usize, &f64)| {
        format!("[[force]]\nnode = {}\ndirection = [1.0, 0.0, 0.0]\namplitude_n = {amplitude:?}\n", i + 1)
    };
    let forces: Vec<String> = forces.iter().enumerate().map(force).collect();
    format!(
        "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\n\
         [[contact]]\n{against}\nnormal = [0.0, 0.0, 1.0]\ngap_m = {:?}\nfriction_estimate = 0.3\n\
         [reduction]\nmodes = {}\n[damping]\nratio = {DAMPING:?}\n{}\
         [[response]]\nkind = \"frequency\"\nfrequency_hz = [15.0, 30.0]\n[method]\nharmonics = 3\n\
         [output]\nstability = \"never\"\nfigures = false\npage = false\n",
        -INTERFERENCE,
        forces.len(),
        forces.concat()
    )
}

/// `λ a Ω 2/π` and `4 a`, `a = F/|k − m Ω² + 2 i D √(k m) Ω|`.
fn check(rows: &[Row], force: f64, amplitude: f64) {
    assert!(rows.len() > 10);
    let [k, _, m] = BODY;
    for row in rows {
        let omega = TAU * number(row, "frequency_hz");
        let a = amplitude / (k - m * omega * omega).hypot(2.0 * DAMPING * (k * m).sqrt() * omega);
        let path = number(row, "sliding_path_m");
        let rate = force * 0.25 * path * omega * 2.0 / PI;
        assert!((number(row, "mean_force_n") / force - 1.0).abs() < 1e-9, "{row:?}");
        // The motion is as good as its residual; what is made of it has the accuracy of the quadrature.
        assert!((path / (4.0 * a) - 1.0).abs() < 1e-4, "{a}: {row:?}");
        assert!((number(row, "wear_work_rate_w") / rate - 1.0).abs() < 2e-7, "{rate}: {row:?}");
        assert!((number(row, "friction_power_w") / (0.3 * rate) - 1.0).abs() < 2e-7, "{rate}: {row:?}");
    }
}

#[test]
fn a_pressed_body_that_is_shaken_slides_as_its_closed_form_and_two_bodies_relative_to_each_other() -> Outcome {
    let folder = tempdir()?;
    bodies(folder.path(), 1)?;
    let stiff = BODY[1];
    check(&run(folder.path(), &pressed("node = 1", &[5.0]))?, stiff * INTERFERENCE, 5.0);
    bodies(folder.path(), 2)?;
    let pair = "pairs = \"pairs.csv\"";
    fs::write(folder.path().join("pairs.csv"), "node_a,node_b\n1,2\n")?;
    check(&run(folder.path(), &pressed(pair, &[5.0, 2.0]))?, 0.5 * stiff * INTERFERENCE, 3.0);
    // Shaken alike they do not slide on each other.
    let alike = run(folder.path(), &pressed(pair, &[5.0, 5.0]))?;
    assert!(!alike.is_empty() && alike.iter().all(is_empty), "{:?}", alike[0]);
    // Without a coefficient there is no power.
    let text = pressed(pair, &[5.0, 2.0]).replace("friction_estimate = 0.3\n", "");
    assert!(run(folder.path(), &text)?.iter().all(|row| row["friction_power_w"].is_empty() && !is_empty(row)));
    Ok(())
}

/// An array of `histories.npz`.
fn array(path: &Path, name: &str) -> Outcome<Vec<f64>> {
    let mut archive = NpzArchive::open(path)?;
    Ok(archive.by_name(name)?.ok_or("no such array")?.into_vec()?)
}

/// A mass on a soft spring along `(cos 30°, sin 30°)` and a stiff one across it, before a stop along z: its node slides
/// by `u_x = φ_x/φ_z (u_z − A λ) + R λ`, with the motion and the force of its history.
#[test]
fn a_mass_on_a_slanted_guide_slides_as_its_history_tells() -> Outcome {
    let folder = tempdir()?;
    let (c, s, soft, stiff, m) = (0.75_f64.sqrt(), 0.5, 2e4, 1e7, 0.8);
    let k = [soft * c * c + stiff * s * s, (soft - stiff) * c * s, soft * s * s + stiff * c * c];
    matrix(folder.path().join("k.mtx"), &[(0, 0, k[0]), (1, 0, k[1]), (1, 1, k[2])], 2)?;
    matrix(folder.path().join("m.mtx"), &[(0, 0, m), (1, 1, m)], 2)?;
    fs::write(folder.path().join("dofs.csv"), "1,1,ux\n2,1,uz\n")?;
    let text = "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\n\
        [[contact]]\nnode = 1\nnormal = [0.0, 0.0, 1.0]\ngap_m = 1e-3\nstiffness_n_m = 2e5\nfriction_estimate = 0.1\n\
        [reduction]\nmodes = 1\n[method]\nharmonics = 60\n[continuation]\nmax_energy_ratio = 3.0\n\
        [output]\nstability = \"never\"\nfigures = false\npage = false\nhistories = [4, 8]\n";
    let rows = run(folder.path(), text)?;
    let path = folder.path().join("out/histories.npz");
    let [time, displacement, force] = ["time_s", "displacement_m", "force_n"].map(|name| array(&path, name));
    let (time, displacement, force) = (time?, displacement?, force?);
    let count = time.len() / 2;
    // Of the mode along the guide, and of the stiff spring beside it: A = c²/k, R = −c s/k.
    let (a, r) = (c * c / stiff, -c * s / stiff);
    let slides: Vec<f64> = displacement.iter().zip(&force).map(|(z, f)| c / s * (z + a * f) - r * f).collect();
    for (number_of, point) in [4, 8].into_iter().enumerate() {
        let row = &rows[point];
        let own = number_of * count..(number_of + 1) * count;
        let (time, u, force) = (&time[own.clone()], &slides[own.clone()], &force[own]);
        let (mut work, mut path) = (0.0, 0.0);
        for j in (1..count).filter(|j| force[*j] > 0.0 || force[j - 1] > 0.0) {
            let step = (u[j] - u[j - 1]).abs();
            (work, path) = (work + 0.5 * (force[j] + force[j - 1]) * step, path + step);
        }
        let rate = work / time[count - 1];
        assert!(rate > 0.0 && (number(row, "wear_work_rate_w") / rate - 1.0).abs() < 2e-3, "{rate}: {row:?}");
        assert!((number(row, "sliding_path_m") / path - 1.0).abs() < 2e-3, "{path}: {row:?}");
        assert!((number(row, "friction_power_w") / (0.1 * rate) - 1.0).abs() < 2e-3, "{row:?}");
    }
    // What does not touch does not slide.
    assert_eq!((number(&rows[0], "wear_work_rate_w"), number(&rows[0], "sliding_path_m")), (0.0, 0.0));
    Ok(())
}

/// A rod has no motion across its axis, and a beam that bends none along it, unless a force shakes it there: then it
/// slides under its stop as a rod does, pressed by `3 E I δ/L³` (without shear, next to nothing).
#[test]
fn rods_and_bending_beams_do_not_slide_but_beams_that_are_shaken_along_their_axis_do() -> Outcome {
    let folder = tempdir()?;
    let structure = |kind: &str| {
        format!(
            "[structure]\nkind = \"{kind}\"\nlength_m = 1.0\nelements = 10\nstart = \"clamped\"\n\
             material = {{ youngs_modulus_pa = 2e11, density_kg_m3 = 8000.0 }}\n\
             section = {{ width_m = 0.01, height_m = 0.01 }}\n"
        )
    };
    let stop = |direction: &str, gap: f64| {
        format!(
            "[[contact]]\nat_m = 1.0\ndirection = \"{direction}\"\nside = \"positive\"\ngap_m = {gap:?}\n\
             friction_estimate = 0.2\n"
        )
    };
    let end = "[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 1.5\n\
        [output]\nstability = \"never\"\nfigures = false\npage = false\n";
    for (kind, direction) in [("rod", "axial"), ("beam", "transverse")] {
        let rows = run(folder.path(), &format!("{}{}{end}", structure(kind), stop(direction, 1e-3)))?;
        assert!(!rows.is_empty() && rows.iter().all(is_empty), "{kind} {direction}: {:?}", rows[0]);
    }
    let shaken = format!(
        "{}{}[damping]\nratio = 0.01\n[[force]]\nat_m = 1.0\ndirection = \"axial\"\namplitude_n = 100.0\n\
         [[response]]\nkind = \"frequency\"\nfrequency_hz = [900.0, 1000.0]\n{end}",
        structure("beam"),
        stop("transverse", -1e-3)
    );
    let rows = run(folder.path(), &shaken)?;
    let branch = self::rows(&folder.path().join("out/branch.csv"))?;
    assert_eq!(rows.len(), branch.len());
    let bending = 2e11 * 0.01_f64.powi(4) / 12.0;
    for (row, point) in rows.iter().zip(&branch) {
        let (a, omega) = (number(point, "drive_fundamental_m"), TAU * number(row, "frequency_hz"));
        let rate = 3.0 * bending * 1e-3 * a * omega * 2.0 / PI;
        assert!((number(row, "wear_work_rate_w") / rate - 1.0).abs() < 1e-3, "{rate}: {row:?}");
        assert!((number(row, "sliding_path_m") / (4.0 * a) - 1.0).abs() < 1e-6, "{row:?}");
        assert!((number(row, "friction_power_w") / (0.2 * rate) - 1.0).abs() < 1e-3, "{row:?}");
    }
    Ok(())
}
