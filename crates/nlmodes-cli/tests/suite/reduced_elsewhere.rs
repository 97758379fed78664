//! Structures that were reduced elsewhere, compared with the reduction of their matrices and with closed forms.

mod chain;
mod pictures;
mod refused;
mod superelement;

use std::error::Error;
use std::fs;
use std::process::Output;

use assert_cmd::Command;
use chain::Chain;
use tempfile::{TempDir, tempdir};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// Ratio up to which the numbers of both ways may differ, over the largest of their column.
const SAME: f64 = 1e-8;

/// Without stability: at grazing, and where the exact motion beside a point is just found, rounding decides what is
/// written.
const MODE: &str = "[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 3.0\n[output]\nstability = \"never\"\n";

fn call(folder: &TempDir, arguments: &[&str]) -> Outcome<Output> {
    Ok(Command::cargo_bin("nlmodes-cli")?.args(arguments).current_dir(folder.path()).output()?)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// Runs the scene and gives the columns of a table of its results.
fn run(folder: &TempDir, scene: &str, table: &str) -> Outcome<Vec<(String, Vec<f64>)>> {
    let results = folder.path().join("results");
    fs::write(folder.path().join("scene.toml"), scene)?;
    let output = call(folder, &["run", "scene.toml", "--quiet", "--out", "results"])?;
    assert!(output.status.success(), "{}", said(&output));
    let mut reader = csv::Reader::from_path(results.join(table))?;
    let mut columns: Vec<(String, Vec<f64>)> = reader.headers()?.iter().map(|name| (name.into(), Vec::new())).collect();
    for record in reader.records() {
        let record = record?;
        columns.iter_mut().zip(&record).for_each(|(column, cell)| column.1.push(cell.parse().unwrap_or(f64::NAN)));
    }
    assert!(columns[0].1.len() > 5, "{} points", columns[0].1.len());
    fs::remove_dir_all(&results)?;
    Ok(columns)
}

/// Both scenes have the same numbers in all columns of a table but for rounding, and for `residual`.
fn same(scenes: [(&TempDir, &str); 2], table: &str) -> Outcome {
    same_but(scenes, table, &["residual"])
}

/// The same but for these columns.
fn same_but(scenes: [(&TempDir, &str); 2], table: &str, but: &[&str]) -> Outcome {
    let [own, other] = [run(scenes[0].0, scenes[0].1, table)?, run(scenes[1].0, scenes[1].1, table)?];
    assert_eq!(own.len(), other.len());
    let compared = own.iter().zip(&other).filter(|((name, _), _)| !but.contains(&name.as_str()));
    for ((name, own), (_, other)) in compared {
        assert_eq!(own.len(), other.len(), "{name}: points");
        let largest = own.iter().filter(|x| x.is_finite()).fold(0.0_f64, |largest, x| largest.max(x.abs()));
        for (k, (a, b)) in own.iter().zip(other).enumerate() {
            let agree = (a - b).abs() <= SAME * largest || a.is_nan() && b.is_nan();
            assert!(agree, "{name} of point {k}: {a:e} and {b:e}, largest {largest:e}");
        }
    }
    Ok(())
}

/// Mode and contacts on both sides, in all of `branch.csv` and `contacts.csv`; files of NumPy and of text.
#[test]
fn a_branch_of_closed_forms_is_that_of_the_matrices() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: true, n: 40 });
    let matrices = chain.matrices(&folder, 12, &[(40, 1.0, 1e-3), (20, -1.0, 0.8e-3)])? + MODE;
    let reduced = chain.reduced(&folder, 12, &[40, 20], "flexibility_m_n")?
        + "[[contact]]\nrow = 1\ngap_mm = 1.0\n[[contact]]\nrow = 2\nside = \"negative\"\ngap_m = 0.8e-3\n"
        + MODE;
    for table in ["branch.csv", "contacts.csv"] {
        same([(&folder, &matrices), (&folder, &reduced)], table)?;
    }
    // The same with what the modes leave, and as a line a mode.
    let residual = chain.reduced(&folder, 12, &[40, 20], "residual_flexibility_m_n")?;
    assert!(residual.contains("residual_flexibility_m_n = \"residual_flexibility_m_n.csv\""));
    let contacts = &reduced[reduced.find("[[contact]]").ok_or("contacts")?..];
    same([(&folder, &matrices), (&folder, &(residual.replace("rows.csv", "by_mode.csv") + contacts))], "branch.csv")
}

/// Stops that face each other with a row each, the second one against the first: they share a displacement.
#[test]
fn stops_that_face_each_other_may_have_a_row_each() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: true, n: 40 });
    let matrices = chain.matrices(&folder, 12, &[(40, 1.0, 1e-3), (40, -1.0, 2e-3)])? + MODE;
    let reduced = chain.reduced(&folder, 12, &[40, 40], "flexibility_m_n")? + "[[contact]]\nrow = 1\ngap_m = 1e-3\n";
    let same_sign = reduced.clone() + "[[contact]]\nrow = 2\nside = \"negative\"\ngap_m = 2e-3\n" + MODE;
    same([(&folder, &matrices), (&folder, &same_sign)], "branch.csv")?;
    // Toward the other stop: the second row with its sign changed.
    let rows = fs::read_to_string(folder.path().join("rows.csv"))?;
    let (first, second) = rows.split_once('\n').ok_or("rows")?;
    let turned: Vec<String> = second.trim().split(',').map(|x| format!("-{x}").replace("--", "")).collect();
    fs::write(folder.path().join("rows.csv"), format!("{first}\n{}\n", turned.join(",")))?;
    let whole = 40.0 / 4e5;
    fs::write(folder.path().join("flexibility_m_n.csv"), format!("{whole:e},-{whole:e}\n-{whole:e},{whole:e}\n"))?;
    let other_sign = reduced + "[[contact]]\nrow = 2\ngap_m = 2e-3\n" + MODE;
    same([(&folder, &matrices), (&folder, &other_sign)], "branch.csv")
}

/// Fewer modes than were computed: the others join the flexibility.
#[test]
fn modes_that_are_not_asked_for_answer_statically() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: true, n: 40 });
    let rest = "[[contact]]\nrow = 1\ngap_m = 1e-3\n".to_owned() + MODE;
    let asked = chain.reduced(&folder, 20, &[40], "flexibility_m_n")? + &rest + "[reduction]\nmodes = 8\n";
    let matrices = chain.matrices(&folder, 8, &[(40, 1.0, 1e-3)])? + MODE;
    same([(&folder, &matrices), (&folder, &asked)], "branch.csv")
}

/// Forces, dashpots, drive points, damped stops and constant forces at rows.
#[test]
fn responses_of_rows_are_those_of_nodes() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: true, n: 40 });
    let common = "[method]\nharmonics = 3\n[damping]\nratio = 0.02\n";
    let at_nodes = "[[force]]\nnode = 7\ndirection = [1, 0, 0]\namplitude_n = 2.0\n\
        [[static_force]]\nnode = 40\ndirection = [1, 0, 0]\nforce_n = -5.0\n\
        [[damping.dashpot]]\nnode = 20\ndirection = [1, 0, 0]\ndamping_n_s_m = 3.0\n";
    let at_rows = "[[force]]\nrow = 3\namplitude_n = 2.0\n\
        [[static_force]]\nrow = 1\nforce_n = -5.0\n\
        [[damping.dashpot]]\nrow = 2\ndamping_n_s_m = 3.0\n";
    let matrices = chain.matrices(&folder, 12, &[(40, 1.0, 1e-3)])? + "stiffness_n_m = 1e6\ndamping_n_s_m = 20.0\n";
    let reduced = chain.reduced(&folder, 12, &[40, 20, 7], "flexibility_m_n")?
        + "[[contact]]\nrow = 1\ngap_m = 1e-3\nstiffness_n_m = 1e6\ndamping_n_s_m = 20.0\n";
    let hz = chain.hz(1);
    let window = format!("frequency_hz = [{}, {}]\n", 0.95 * hz, 1.2 * hz);
    let responses = [
        ("frequency", "levels_n = [3.0]\n", "drive_node = 20\ndrive_direction = [1, 0, 0]\n", "drive_row = 2\n"),
        ("phase-resonance", "levels_n = [6.0]\n", "", ""),
        ("damped-mode", "", "", ""),
    ];
    for (kind, levels, at_node, at_row) in responses {
        let response = format!("[[response]]\nkind = \"{kind}\"\n{window}{levels}");
        let end = "[continuation]\nmax_energy_ratio = 3.0\n";
        let of_nodes = format!("{matrices}{common}{at_nodes}{response}{at_node}{end}");
        let of_rows = format!("{reduced}{common}{at_rows}{response}{at_row}{end}");
        same([(&folder, &of_nodes), (&folder, &of_rows)], "branch.csv").map_err(|error| format!("{kind}: {error}"))?;
    }
    Ok(())
}

/// A chain that nothing holds, between two stops; the flexibility of loads in balance is the sum over the modes left
/// out, in closed form. Rounding decides whether the double multiplier 1 of the first touch is found.
#[test]
fn what_floats_between_stops_is_that_of_the_matrices() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: false, n: 30 });
    let rest = MODE.replace("harmonics = 3", "harmonics = 2\nmode = 2");
    let matrices = chain.matrices(&folder, 12, &[(30, 1.0, 1e-3), (1, -1.0, 1e-3)])? + &rest;
    let reduced = chain.reduced(&folder, 12, &[30, 1], "residual_flexibility_m_n")?
        + "[[contact]]\nrow = 1\ngap_m = 1e-3\n[[contact]]\nrow = 2\nside = \"negative\"\ngap_m = 1e-3\n"
        + &rest;
    let but = ["residual", "stable", "largest_multiplier", "multiplier_angle_deg"];
    same_but([(&folder, &matrices), (&folder, &reduced)], "branch.csv", &but)
}

/// Files in millimetres and tonnes.
#[test]
fn files_in_other_units_come_out_in_si() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: true, n: 40 });
    let rest = "[[contact]]\nrow = 1\ngap_m = 1e-3\n".to_owned() + MODE;
    let si = chain.reduced(&folder, 8, &[40], "flexibility_m_n")? + &rest;
    let other = tempdir()?;
    let scaled = |name: &str, factor: f64| -> Outcome {
        let text = fs::read_to_string(folder.path().join(name))?;
        let line = |line: &str| -> Outcome<String> {
            let numbers = line.split(',').map(|x| Ok(format!("{:e}", factor * x.parse::<f64>()?)));
            Ok(numbers.collect::<Outcome<Vec<String>>>()?.join(","))
        };
        let lines = text.lines().map(line).collect::<Outcome<Vec<String>>>()?;
        Ok(fs::write(other.path().join(name), lines.join("\n"))?)
    };
    // 1/√kg is √1000 /√t, and m/N is 1000 mm/N.
    scaled("rows.csv", 1000.0_f64.sqrt())?;
    scaled("flexibility_m_n.csv", 1000.0)?;
    let units = si.replace("kind = \"reduced\"", "kind = \"reduced\"\nunits = \"mm-t-s\"");
    same([(&folder, &si), (&other, &units)], "branch.csv")
}

/// What `check` and `modes` tell, and one period of a point in time.
#[test]
fn check_modes_and_verify_take_it() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: true, n: 40 });
    let scene =
        chain.reduced(&folder, 12, &[40, 7], "flexibility_m_n")? + "[[contact]]\nrow = 1\ngap_m = 1e-3\n" + MODE;
    fs::write(folder.path().join("scene.toml"), scene)?;
    let check = call(&folder, &["check", "scene.toml"])?;
    let text = said(&check);
    assert!(check.status.success(), "{text}");
    for part in ["12 modes", "2 rows, a line a row, rows.csv", "row 1, on the positive side, gap 0.001 m, rigid"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let modes = said(&call(&folder, &["modes", "scene.toml"])?);
    for mode in [1, 2, 5] {
        assert!(modes.contains(&format!("{:.8}", chain.hz(mode))), "{modes}");
    }
    let run = call(&folder, &["run", "scene.toml", "--quiet", "--out", "results"])?;
    assert!(run.status.success(), "{}", said(&run));
    let verify = call(&folder, &["verify", "results", "--point", "0"])?;
    assert!(verify.status.success(), "{}", said(&verify));
    Ok(())
}
