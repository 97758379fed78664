//! The files of a run: their contents, their description, and that no others are written.

mod figures;
mod scripts;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use nlmodes::report::columns::{self, Column, FILES};
use npyz::npz::NpzArchive;
use tempfile::tempdir;

type Outcome = Result<(), Box<dyn Error>>;

/// A rod between two stops that face each other, and one in its middle.
const SCENE: &str = r#"
title = "Three stops"
[structure]
kind = "rod"
length_m = 1.0
elements = 6
start = "clamped"
material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }
section = { area_m2 = 1e-4 }
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1e-3
[[contact]]
at_m = 1.0
direction = "axial"
side = "negative"
gap_m = 1.2e-3
[[contact]]
at_m = 0.5
direction = "axial"
side = "positive"
gap_m = 0.9e-3
[method]
harmonics = 5
[continuation]
max_energy_ratio = 4.0
internal_resonance = "follow"
"#;

/// Runs the scene with further keys and flags; returns its directory, which exists as long as the first value, and the
/// output.
fn run(set: &[&str]) -> Result<(tempfile::TempDir, PathBuf, String), Box<dyn Error>> {
    let folder = tempdir()?;
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    fs::write(&scene, SCENE)?;
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    call.arg("run").arg(&scene).args(["--quiet", "--out"]).arg(&out);
    let (flags, values): (Vec<&&str>, Vec<&&str>) = set.iter().partition(|word| word.starts_with("--"));
    flags.into_iter().for_each(|flag| _ = call.arg(flag));
    values.into_iter().for_each(|value| _ = call.args(["--set", value]));
    let output = call.output()?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    Ok((folder, out, said))
}

/// Names of the columns, and the rows.
type Table = (Vec<String>, Vec<Vec<String>>);

fn table(path: &Path) -> Result<Table, Box<dyn Error>> {
    let mut reader = csv::Reader::from_path(path)?;
    let head = reader.headers()?.iter().map(str::to_owned).collect();
    let rows = reader.records().map(|row| Ok(row?.iter().map(str::to_owned).collect()));
    Ok((head, rows.collect::<Result<_, csv::Error>>()?))
}

fn array(path: &Path, name: &str) -> Result<(Vec<u64>, Vec<f64>), Box<dyn Error>> {
    let mut archive = NpzArchive::open(path)?;
    let found = archive.by_name(name)?.ok_or("no such array")?;
    Ok((found.shape().to_vec(), found.into_vec()?))
}

/// The documented columns of a file.
fn explained(name: &str) -> Vec<&'static Column> {
    FILES.iter().filter(|file| file.name == name).flat_map(|file| file.all_columns()).collect()
}

#[test]
fn every_file_column_and_array_is_explained_and_every_explained_one_is_there() -> Outcome {
    let (_folder, out, _) = run(&["output.matlab=true"])?;
    for entry in fs::read_dir(&out)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        let is_figure = name.ends_with(".svg");
        assert!(is_figure || FILES.iter().any(|file| file.name == name), "{name} is not explained");
        let found: Vec<String> = match name.rsplit_once('.') {
            Some((_, "csv")) => table(&out.join(&name))?.0,
            Some((_, "npz")) => NpzArchive::open(out.join(&name))?.array_names().map(str::to_owned).collect(),
            _ => continue,
        };
        let known = explained(&name);
        for column in &found {
            assert!(known.iter().any(|known| known.is_named(column)), "{name}: {column} is not explained");
        }
        for known in known {
            assert!(found.iter().any(|column| known.is_named(column)), "{name}: there is no {}", known.name);
        }
    }
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/files_and_columns.md");
    assert_eq!(
        fs::read_to_string(page)?,
        columns::markdown(),
        "nlmodes-cli columns --markdown > docs/files_and_columns.md"
    );
    Ok(())
}

#[test]
fn stops_have_a_row_each_that_agrees_with_the_branch_and_with_their_histories() -> Outcome {
    let (_folder, out, said) = run(&["output.histories=[3, 7, 9999]"])?;
    assert!(said.contains("point 9999") && said.contains("output.histories"), "{said}");
    let (head, rows) = table(&out.join("contacts.csv"))?;
    assert_eq!(
        head.join(","),
        "point,contact,contact_fraction,peak_force_n,mean_force_n,impulse_ns,touches,approach_velocity_m_s,\
        frequency_hz,\
         wear_work_rate_w,sliding_path_m,friction_power_w"
    );
    let (_, branch) = table(&out.join("branch.csv"))?;
    assert_eq!(rows.len(), 3 * branch.len());
    let number = |text: &String| text.parse::<f64>();
    for (k, row) in rows.iter().enumerate() {
        assert_eq!((&row[0], &row[1]), (&(k / 3).to_string(), &(k % 3).to_string()));
    }
    for (point, own) in branch.iter().zip(rows.chunks(3)) {
        let of = |column: usize| own.iter().map(|row| number(&row[column])).collect::<Result<Vec<f64>, _>>();
        assert_eq!(number(&point[7])?, of(2)?[0]);
        assert_eq!(number(&point[9])?, of(3)?.into_iter().fold(0.0, f64::max));
        assert_eq!(number(&point[8])?, of(6)?.iter().sum::<f64>());
        assert_eq!(number(&point[18])?, of(5)?.iter().sum::<f64>());
        let frequency = number(&point[1])?;
        assert!(of(8)?.iter().all(|hertz| *hertz == frequency));
        let period = 1.0 / frequency;
        for (mean, impulse) in of(4)?.into_iter().zip(of(5)?) {
            assert!((mean * period - impulse).abs() <= 1e-12 * impulse);
        }
    }
    let path = out.join("histories.npz");
    let (_, points) = {
        let mut archive = NpzArchive::open(&path)?;
        let found = archive.by_name("point")?.ok_or("no points")?;
        (found.shape().to_vec(), found.into_vec::<i64>()?)
    };
    assert!(points.contains(&3) && points.contains(&7) && points.is_sorted(), "{points:?}");
    let (shape, time) = array(&path, "time_s")?;
    let (_, stop) = array(&path, "stop_m")?;
    let (forces, force) = array(&path, "force_n")?;
    let (_, displacement) = array(&path, "displacement_m")?;
    let [n, t] = shape[..] else { return Err("time has no two dimensions".into()) };
    assert_eq!((n as usize, &forces), (points.len(), &vec![n, 3, t]));
    let t = t as usize;
    for (p, point) in points.iter().enumerate() {
        let time = &time[p * t..(p + 1) * t];
        assert!(time.windows(2).all(|pair| pair[0] < pair[1]));
        assert!((time[t - 1] * number(&branch[*point as usize][1])? - 1.0).abs() < 1e-12);
        for contact in 0..3 {
            let at = |values: &[f64], j: usize| values[(3 * p + contact) * t + j];
            let steps = (1..t).map(|j| 0.5 * (time[j] - time[j - 1]) * (at(&force, j) + at(&force, j - 1)));
            let (sum, wanted) = (steps.sum::<f64>(), number(&rows[3 * *point as usize + contact][5])?);
            assert!((sum - wanted).abs() <= 1e-3 * wanted, "point {point}, stop {contact}: {sum:e}, {wanted:e}");
            let side = stop[contact].signum();
            let gaps = (0..t).map(|j| side * (stop[contact] - at(&displacement, j)));
            assert!(gaps.zip(0..t).all(|(gap, j)| gap > -1e-12 && (gap < 1e-12 || at(&force, j) == 0.0)));
        }
    }
    Ok(())
}

#[test]
fn what_is_not_asked_for_is_not_written_and_asked_points_are_all_the_same() -> Outcome {
    let (_folder, out, _) = run(&["output.figures=false", "output.page=false", "output.histories=[2]"])?;
    let mut names: Vec<String> = fs::read_dir(&out)?
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<Result<_, std::io::Error>>()?;
    names.sort();
    let expected = [
        "branch.csv",
        "contacts.csv",
        "harmonics.npz",
        "histories.npz",
        "participation.csv",
        "run.json",
        "steps.jsonl",
        "summary.json",
    ];
    assert_eq!(names, expected);
    let mut archive = NpzArchive::open(out.join("histories.npz"))?;
    assert_eq!(archive.by_name("point")?.ok_or("no points")?.into_vec::<i64>()?, [2]);
    let (_folder, out, _) = run(&["output.figures=false", "output.page=false"])?;
    assert!(!out.join("histories.npz").exists() && out.join("branch.csv").exists());
    Ok(())
}

/// Skipped without Python with SciPy.
#[test]
fn scipy_reads_the_matlab_file_as_the_tables_are() -> Outcome {
    let (_folder, out, _) = run(&["output.matlab=true"])?;
    let python = std::env::var("NLMODES_PYTHON").unwrap_or_else(|_| "python3".into());
    let script = "import sys, csv, numpy as n; from scipy.io import loadmat; o = sys.argv[1] + '/'\n\
        m = loadmat(o + 'results.mat', simplify_cells=True); h = n.load(o + 'harmonics.npz'); t = n.load(o + \
        'histories.npz')\n\
        rows = list(csv.DictReader(open(o + 'branch.csv'))); stops = list(csv.DictReader(open(o + 'contacts.csv')))\n\
        for key, values in m['branch'].items():\n\
        \x20 if key in ('event', 'resonance'): assert [str(v) if len(v) else '' for v in values] == \
        [r[key] for r in rows], values\n\
        \x20 elif key == 'stable': assert all(n.isnan(v) or r[key] == ('true' if v else 'false') for v, r in \
        zip(values, rows))\n\
        \x20 else: assert all((n.isnan(v) and r[key] == '') or v == float(r[key]) for v, r in zip(values, rows)), key\n\
        for key, values in m['contacts'].items():\n\
        \x20 assert all((n.isnan(v) and r[key] == '') or v == float(r[key]) for v, r in zip(values.ravel(), stops)), \
        key\n\
        for name, arrays in (('harmonics', h), ('histories', t)):\n\
        \x20 for key in arrays.files:\n\
        \x20   if key != 'dof_kind': assert (m[name][key] == arrays[key]).all(), key\n\
        assert list(m['harmonics']['dof_kind']) == list(h['dof_kind'])\n\
        print('same')";
    if !std::process::Command::new(&python).args(["-c", "import scipy.io"]).output().is_ok_and(|o| o.status.success()) {
        return Ok(());
    }
    let output = std::process::Command::new(&python).args(["-c", script]).arg(&out).output()?;
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "same", "{}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}

/// Each check has a value or states how to have it made, never both; each number has an error; the page has both at its
/// end.
#[test]
fn the_certificate_is_in_the_summary_and_at_the_foot_of_the_page() -> Outcome {
    let small = ["method.harmonics=3", "continuation.max_energy_ratio=2.0"];
    let mut made = Vec::new();
    for flags in [&[][..], &["--certify"]] {
        let set: Vec<&str> = small.iter().chain(flags).copied().collect();
        let (_folder, out, _) = run(&set)?;
        let summary: serde_json::Value = serde_json::from_str(&fs::read_to_string(out.join("summary.json"))?)?;
        let certificate = &summary["certificate"];
        assert!(
            certificate["verdict"].as_str().is_some_and(|text| text.starts_with("Estimated errors, ")),
            "{certificate}"
        );
        let points = summary["points"].as_u64().ok_or("no points")?;
        let looked = certificate["points"].as_array().ok_or("no points looked at")?;
        assert!(!looked.is_empty() && looked.iter().all(|at| at["point"].as_u64() < Some(points)), "{certificate}");
        let (head, rows) = table(&out.join("branch.csv"))?;
        for (name, value) in [("frequency_hz", "frequency_hz"), ("energy_j", "energy_j")] {
            let column = head.iter().position(|column| column == name).ok_or(name)?;
            for at in looked {
                let own: f64 = rows[at["point"].as_u64().ok_or("no point")? as usize][column].parse()?;
                // Frequencies of tables have 15 digits.
                assert!(at[value].as_f64().is_some_and(|value| (value / own - 1.0).abs() < 1e-14), "{at}");
            }
        }
        let checks = certificate["checks"].as_array().ok_or("no checks")?;
        for check in checks {
            let text = |key: &str| check[key].as_str().is_some_and(|text| !text.is_empty());
            assert!(text("name") && text("words"), "{check}");
            match check["outcome"].as_str() {
                Some("good") => {
                    assert!(check["value"].as_f64() <= check["limit"].as_f64() && check.get("how").is_none())
                }
                Some("doubtful") => assert!(check.get("how").is_none(), "{check}"),
                Some("estimated") => {
                    assert!(check["value"].as_f64().is_some_and(|value| value >= 0.0) && check.get("how").is_none())
                }
                Some("not-made") => assert!(check.get("value").is_none() && text("how"), "{check}"),
                other => return Err(format!("{other:?}").into()),
            }
        }
        for number in ["frequency", "displacement", "impulse", "peak_force"] {
            let error = &summary["errors"][number];
            assert!(error["estimate"].as_f64().is_some_and(|error| error > 0.0 && error < 1.0), "{number}: {error}");
            let source = error["source"].as_str().ok_or("no source")?;
            assert_eq!(
                (source, error["command"].as_str()),
                ("3 harmonics", Some("--set method.harmonics=6")),
                "{error}"
            );
            assert!(error.get("met").is_none(), "nothing is required: {error}");
        }
        made.push(checks.iter().filter(|check| check["outcome"] != "not-made").count());
        let page = fs::read_to_string(out.join("report.html"))?;
        let places = ["Scene and method</h2>", "How far to trust these numbers</h2>", "peak_contact_force_n)"];
        let places = places.map(|text| page.rfind(text).unwrap_or(0));
        assert!(places[0] > 0 && places[0] < places[1] && places[1] < places[2], "{places:?}");
    }
    assert!(made[0] < made[1], "more is compared where all is asked for: {made:?}");
    Ok(())
}
