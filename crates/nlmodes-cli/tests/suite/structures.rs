//! Structures from files and in free-interface modes, compared with exact relations between structures and with
//! CalculiX.

mod doubts;
mod formats;
mod said;
// The sample of the readers, in every format as the programs write it.
#[path = "../../../nlmodes-io/tests/formats/sample.rs"]
mod sample;
#[allow(dead_code, reason = "what the tests of the readers need beside")]
#[path = "../../../nlmodes-io/tests/formats/writers.rs"]
mod writers;

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;
type Matrix = Vec<Vec<f64>>;

fn configs(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs").join(name)
}

fn call(arguments: &[&str]) -> Outcome<Output> {
    Ok(Command::cargo_bin("nlmodes-cli")?.args(arguments).output()?)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A rod of `n` equal elements without supports: E A = 2.1e7 N, ρ A = 0.78 kg/m, 1 m long.
fn free_rod(n: usize) -> (Matrix, Matrix) {
    let h = 1.0 / n as f64;
    let (mut k, mut m) = (vec![vec![0.0; n + 1]; n + 1], vec![vec![0.0; n + 1]; n + 1]);
    for e in 0..n {
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            k[e + i][e + j] += 2.1e7 / h * if i == j { 1.0 } else { -1.0 };
            m[e + i][e + j] += 0.78 * h / 6.0 * if i == j { 2.0 } else { 1.0 };
        }
    }
    (k, m)
}

/// The same, clamped at its start.
fn rod(n: usize) -> (Matrix, Matrix) {
    let (k, m) = free_rod(n);
    let free = |a: Matrix| a[1..].iter().map(|row| row[1..].to_vec()).collect();
    (free(k), free(m))
}

/// Both matrices side by side.
fn beside(a: &Matrix, b: &Matrix) -> Matrix {
    let (n, m) = (a.len(), b.len());
    let entry = |i: usize, j: usize| match (i < n, j < n) {
        (true, true) => a[i][j],
        (false, false) => b[i - n][j - n],
        _ => 0.0,
    };
    (0..n + m).map(|i| (0..n + m).map(|j| entry(i, j)).collect()).collect()
}

fn matrix_market(a: &Matrix) -> String {
    let entries: Vec<(usize, usize)> =
        (0..a.len()).flat_map(|i| (0..=i).map(move |j| (i, j))).filter(|(i, j)| a[*i][*j] != 0.0).collect();
    let mut text = format!("%%MatrixMarket matrix coordinate real symmetric\n{0} {0} {1}\n", a.len(), entries.len());
    entries.iter().for_each(|(i, j)| _ = writeln!(text, "{} {} {:e}", i + 1, j + 1, a[*i][*j]));
    text
}

/// Runs a scene of these matrices; `rows` name node and component. Gives frequency and energy of each point.
fn branch(folder: &TempDir, (k, m): (&Matrix, &Matrix), rows: &[(usize, &str)], rest: &str) -> Outcome<Vec<[f64; 2]>> {
    let at = |name: &str| folder.path().join(name);
    fs::write(at("k.mtx"), matrix_market(k))?;
    fs::write(at("m.mtx"), matrix_market(m))?;
    let table: Vec<String> =
        rows.iter().enumerate().map(|(i, (node, name))| format!("{},{node},{name}", i + 1)).collect();
    fs::write(at("dofs.csv"), table.join("\n"))?;
    let files = "stiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"";
    let more = "[continuation]\nmax_energy_ratio = 3.0\n[output]\nstability = \"never\"\n";
    fs::write(at("scene.toml"), format!("[structure]\nkind = \"matrices\"\n{files}\n{rest}\n{more}"))?;
    run(&at("scene.toml"), &at("out"), &[])
}

fn run(scene: &Path, out: &Path, set: &[&str]) -> Outcome<Vec<[f64; 2]>> {
    let [scene, out] = [scene, out].map(|path| path.to_string_lossy().into_owned());
    let mut arguments = vec!["run", &scene, "--out", &out, "--quiet", "--force"];
    set.iter().for_each(|value| arguments.extend(["--set", value]));
    let output = call(&arguments)?;
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let mut table = csv::Reader::from_path(Path::new(&out).join("branch.csv"))?;
    let row = |row: csv::StringRecord| -> Outcome<[f64; 2]> { Ok([row[1].parse()?, row[2].parse()?]) };
    table.records().map(|record| row(record?)).collect()
}

/// Energies of the one are `factor` times those of the other. Where a contact comes or goes the point is located to
/// 1e-10 of a step, along which the energy moves: it gets ten times the tolerance of the frequency.
fn assert_same(one: &[[f64; 2]], other: &[[f64; 2]], factor: f64, tolerance: f64) {
    assert_eq!(one.len(), other.len());
    for (a, b) in one.iter().zip(other) {
        let off = [a[0] / b[0] - 1.0, a[1] / (factor * b[1]) - 1.0];
        assert!(off[0].abs() < tolerance && off[1].abs() < 10.0 * tolerance, "{a:?} {b:?}: {off:?}");
    }
}

const METHOD: &str = "[method]\nharmonics = 3\n";

fn along_x(first: usize, count: usize) -> Vec<(usize, &'static str)> {
    (first..first + count).map(|node| (node, "ux")).collect()
}

fn wall(gap: f64) -> String {
    format!("[[contact]]\nnode = 12\nnormal = [1.0, 0.0, 0.0]\ngap_m = {gap:e}\n[reduction]\nmodes = 10\n{METHOD}")
}

#[test]
fn a_pair_of_which_one_is_held_is_a_wall() -> Outcome {
    let folder = tempdir()?;
    let (k, m) = rod(12);
    let before_wall = branch(&folder, (&k, &m), &along_x(1, 12), &wall(1e-4))?;
    assert!(before_wall.len() > 10);
    // Node 99 can move across the rod only.
    let rows: Vec<(usize, &str)> = along_x(1, 12).into_iter().chain([(99, "uy")]).collect();
    let (held_k, held_m) = (beside(&k, &vec![vec![1e12]]), beside(&m, &vec![vec![1e-6]]));
    fs::write(folder.path().join("pairs.csv"), "12,99,1.0,0.0,0.0,1e-4\n")?;
    let rest = format!("[[contact]]\npairs = \"pairs.csv\"\n[reduction]\nmodes = 10\n{METHOD}");
    let before_node = branch(&folder, (&held_k, &held_m), &rows, &rest)?;
    assert_same(&before_node, &before_wall, 1.0, 1e-10);
    Ok(())
}

#[test]
fn two_rods_that_face_each_other_are_one_before_a_wall_at_half_the_gap() -> Outcome {
    let folder = tempdir()?;
    let (k, m) = rod(12);
    let one = branch(&folder, (&k, &m), &along_x(1, 12), &wall(1e-4))?;
    let rows: Vec<(usize, &str)> = along_x(1, 12).into_iter().chain(along_x(101, 12)).collect();
    fs::write(folder.path().join("pairs.csv"), "12,112,1.0,0.0,0.0,2e-4\n")?;
    // In antiphase both move away from each other: the second one is the mirror image of the first.
    let rest = format!("[[contact]]\npairs = \"pairs.csv\"\n[reduction]\nmodes = 20\n{METHOD}");
    let two = branch(&folder, (&beside(&k, &k), &beside(&m, &m)), &rows, &rest)?;
    assert_same(&two, &one, 2.0, 1e-10);
    Ok(())
}

/// A base that shakes, and the response over the frequency across the first resonance, by 1 %.
fn shaken(direction: &str, stop: &str) -> String {
    format!(
        "[damping]\nratio = 0.01\n[base_motion]\n{direction}stop = \"{stop}\"\n\
         [response]\nkind = \"frequency\"\nfrequency_hz = [1250.0, 1350.0]\nlevels_m_s2 = [200.0]\n"
    )
}

#[test]
fn a_base_that_shakes_a_rod_from_files_shakes_it_as_that_of_elements() -> Outcome {
    let folder = tempdir()?;
    let (k, m) = free_rod(12);
    for stop in ["moves", "fixed"] {
        // The rows of the free rod; its first node is held, and the mass between it and the second one counts.
        let more = format!("fixed = [100]\n{}{}", wall(1e-4), shaken("direction = [2.0, 0.0, 0.0]\n", stop));
        let rows: Vec<(usize, &str)> = [(100, "ux")].into_iter().chain(along_x(1, 12)).collect();
        let files = branch(&folder, (&k, &m), &rows, &more)?;
        let elements = rod_of_elements(&folder, &format!("kind = \"open-modes\"\nmodes = 10\n{}", shaken("", stop)))?;
        assert!(files.len() > 20);
        assert_same(&files, &elements, 1.0, 1e-9);
    }
    Ok(())
}

/// Clamped rods of their own in one scene, the second one turned round.
#[test]
fn two_structures_that_face_each_other_are_one_before_a_wall_at_half_the_gap() -> Outcome {
    let folder = tempdir()?;
    let rod = |heading: &str, supports: &str| {
        format!(
            "{heading}\nkind = \"rod\"\nlength_m = 1.0\nelements = 12\n{supports}\n\
             material = {{ youngs_modulus_pa = 2.1e11, density_kg_m3 = 7800.0 }}\nsection = {{ area_m2 = 1e-4 }}\n"
        )
    };
    let contact = |more: &str, gap: f64| {
        format!("[[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = {gap:e}\n{more}\n")
    };
    let rest = |modes: usize| {
        format!(
            "[reduction]\nkind = \"open-modes\"\nmodes = {modes}\n{METHOD}[continuation]\nmax_energy_ratio = \
             3.0\n[output]\nstability = \"never\"\n"
        )
    };
    let first = rod("[structure]", "start = \"clamped\"");
    let scene = folder.path().join("one.toml");
    fs::write(&scene, format!("{first}{}{}", contact("", 1e-4), rest(10)))?;
    let one = run(&scene, &folder.path().join("one"), &[])?;
    assert!(one.len() > 10);
    let both =
        rod("[[structure]]", "start = \"clamped\"") + &rod("[[structure]]", "start = \"free\"\nend = \"clamped\"");
    let pair = contact("structure = 1\nagainst = { structure = 2, at_m = 0.0 }", 2e-4);
    let scene = folder.path().join("two.toml");
    fs::write(&scene, format!("{both}{pair}{}", rest(20)))?;
    let two = run(&scene, &folder.path().join("two"), &[])?;
    assert_same(&two, &one, 2.0, 1e-10);
    Ok(())
}

/// The same rod from its dimensions.
fn rod_of_elements(folder: &TempDir, reduction: &str) -> Outcome<Vec<[f64; 2]>> {
    let scene = folder.path().join("rod.toml");
    let text = format!(
        "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 12\nstart = \"clamped\"\n\
         material = {{ youngs_modulus_pa = 2.1e11, density_kg_m3 = 7800.0 }}\nsection = {{ area_m2 = 1e-4 }}\n\
         [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-4\n\
         [reduction]\n{reduction}\n[method]\nharmonics = 3\n\
         [continuation]\nmax_energy_ratio = 3.0\n[output]\nstability = \"never\"\n"
    );
    fs::write(&scene, text)?;
    run(&scene, &folder.path().join("rod"), &[])
}

#[test]
fn all_open_modes_are_all_held_modes_where_the_contact_node_has_no_mass() -> Outcome {
    let folder = tempdir()?;
    let (k, mut m) = rod(12);
    (0..12).for_each(|i| (m[i][11], m[11][i]) = (0.0, 0.0));
    let all = wall(1e-4).replace("modes = 10", "modes = 11");
    let open = branch(&folder, (&k, &m), &along_x(1, 12), &all)?;
    assert_same(&open, &rod_of_elements(&folder, "kind = \"held-modes\"")?, 1.0, 1e-9);
    Ok(())
}

/// Frequency, damping ratio and energy of the damped mode of a scene.
fn damped_mode(scene: &Path) -> Outcome<Vec<[f64; 3]>> {
    let out = scene.with_extension("out");
    let call = call(&["run", &scene.to_string_lossy(), "--out", &out.to_string_lossy(), "--quiet", "--force"])?;
    assert_eq!(call.status.code(), Some(0), "{}", text(&call.stderr));
    let mut table = csv::Reader::from_path(out.join("branch.csv"))?;
    let names = table.headers()?.clone();
    let place = |name: &str| names.iter().position(|found| found == name).ok_or(format!("no {name} in {names:?}"));
    let places = [place("frequency_hz")?, place("damping_ratio")?, place("total_energy_j")?];
    let row = |row: csv::StringRecord| -> Outcome<[f64; 3]> {
        Ok([row[places[0]].parse()?, row[places[1]].parse()?, row[places[2]].parse()?])
    };
    table.records().map(|record| row(record?)).collect()
}

#[test]
fn stops_that_dissipate_do_so_for_a_rod_from_files_as_for_one_of_elements() -> Outcome {
    let folder = tempdir()?;
    let at = |name: &str| folder.path().join(name);
    let stop = "gap_m = 1e-4\nstiffness_n_m = 2e7\n";
    let rest = "[reduction]\nkind = \"open-modes\"\nmodes = 10\n[damping]\nratio = 0.004\n\
                [[response]]\nkind = \"damped-mode\"\n[method]\nharmonics = 3\n\
                [continuation]\nmax_energy_ratio = 3.0\n[output]\nstability = \"never\"\nfigures = false\npage = \
                false\n";
    let rod_text = |damper: &str| {
        format!(
            "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 12\nstart = \"clamped\"\n\
             material = {{ youngs_modulus_pa = 2.1e11, density_kg_m3 = 7800.0 }}\nsection = {{ area_m2 = 1e-4 }}\n\
             [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\n{stop}{damper}{rest}"
        )
    };
    let damper = "damping_n_s_m = 800.0\n";
    fs::write(at("rod.toml"), rod_text(damper))?;
    fs::write(at("elastic.toml"), rod_text(""))?;
    let (rod_mode, elastic) = (damped_mode(&at("rod.toml"))?, damped_mode(&at("elastic.toml"))?);
    let ratio = |mode: &[[f64; 3]]| mode.last().map_or(f64::NAN, |point| point[1]);
    assert!(ratio(&rod_mode) > 1.1 * ratio(&elastic), "{} {}", ratio(&rod_mode), ratio(&elastic));
    // The same rod in N, m, kg and in N, mm, t; its stop at one node by number, and as a list.
    let (k, m) = rod(12);
    let scaled = |a: &Matrix, by: f64| a.iter().map(|row| row.iter().map(|v| v * by).collect()).collect::<Matrix>();
    let table: Vec<String> = (1..=12).map(|i| format!("{i},{i},ux")).collect();
    fs::write(at("dofs.csv"), table.join("\n"))?;
    for (units, by, node) in [("m-kg-s", 1.0, "node = 12"), ("mm-t-s", 1e-3, "nodes = [12]")] {
        fs::write(at("k.mtx"), matrix_market(&scaled(&k, by)))?;
        fs::write(at("m.mtx"), matrix_market(&scaled(&m, by)))?;
        let text = format!(
            "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\nunits \
             = \"{units}\"\n\
             [[contact]]\n{node}\nnormal = [1.0, 0.0, 0.0]\n{stop}{damper}{rest}"
        );
        fs::write(at("files.toml"), text)?;
        let files = damped_mode(&at("files.toml"))?;
        assert_eq!(files.len(), rod_mode.len(), "{units}");
        for (a, b) in files.iter().zip(&rod_mode) {
            assert!((0..3).all(|i| (a[i] / b[i] - 1.0).abs() < 1e-8), "{units}: {a:?} {b:?}");
        }
    }
    // A rigid stop has no damper.
    fs::write(at("rigid.toml"), fs::read_to_string(at("files.toml"))?.replace("stiffness_n_m = 2e7\n", ""))?;
    let output = call(&["check", &at("rigid.toml").to_string_lossy()])?;
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("has no effect on a rigid stop"), "{}", text(&output.stderr));
    Ok(())
}

#[test]
fn a_rod_of_the_scene_in_open_modes_is_the_same_rod_from_files() -> Outcome {
    let folder = tempdir()?;
    let (k, m) = rod(12);
    let files = branch(&folder, (&k, &m), &along_x(1, 12), &wall(1e-4))?;
    assert_same(&rod_of_elements(&folder, "kind = \"open-modes\"\nmodes = 10")?, &files, 1.0, 1e-10);
    Ok(())
}

/// First frequency of `modes` of a rod of 200 elements: E A = 2.1e7 N, 0.78 kg, 1 m, clamped at its start.
fn first_hz(more: &str) -> Outcome<f64> {
    let folder = tempdir()?;
    let scene = folder.path().join("rod.toml");
    let head = "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 200\nstart = \"clamped\"\n\
                material = { youngs_modulus_pa = 2.1e11, density_kg_m3 = 7800.0 }\nsection = { area_m2 = 1e-4 }\n";
    let rest = "[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 2.0\n";
    fs::write(&scene, format!("{head}{more}{rest}"))?;
    let output = call(&["modes", &scene.to_string_lossy()])?;
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    let row = table.lines().find(|line| line.trim_start().starts_with("1 ")).ok_or("no first mode")?;
    Ok(row.split_whitespace().nth(1).ok_or("no frequency")?.parse()?)
}

#[test]
fn point_masses_and_springs_move_the_first_mode_of_a_rod_as_the_closed_form_says() -> Outcome {
    let (stiffness, mass) = (2.1e7_f64, 0.78_f64);
    // β tan β = m_rod/m_tip for a mass at the tip, β cot β = −k l/EA for a spring there; ω = β √(EA/(m l)).
    let hertz = |beta: f64| beta * (stiffness / mass).sqrt() / std::f64::consts::TAU;
    let root = |f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64| {
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if (f(middle) > 0.0) == (f(low) > 0.0) { low = middle } else { high = middle }
        }
        low
    };
    let heavy = first_hz("[[structure.mass_point]]\nat_m = 1.0\nmass_kg = 0.5\n")?;
    let expected = hertz(root(&|b| b * b.tan() - mass / 0.5, 1e-3, 1.5));
    assert!((heavy / expected - 1.0).abs() < 1e-5, "{heavy} {expected}"); // (π/2)²/24/200² of the mesh
    let held = first_hz("[[structure.spring]]\nat_m = 1.0\ndirection = \"axial\"\nstiffness_n_m = 1e7\n")?;
    let expected = hertz(root(&|b| b / b.tan() + 1e7 / stiffness, 1.6, 3.1));
    assert!((held / expected - 1.0).abs() < 1e-5, "{held} {expected}");
    Ok(())
}
