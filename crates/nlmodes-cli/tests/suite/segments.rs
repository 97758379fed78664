//! One long record with all levels.

use std::collections::HashMap;
use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use nlmodes::experiment::records::{Channel, Quantity, Record, Role, write_record};

type Outcome = Result<(), Box<dyn Error>>;
type Row = HashMap<String, String>;

const RATE: f64 = 2000.0;
/// Amplitude (mm), frequency (Hz) and the samples of each level; ramps of a second lie between them.
const LEVELS: [(f64, f64, [usize; 2]); 3] =
    [(1.0, 40.1, [1000, 4000]), (2.0, 41.3, [6000, 10_000]), (2.5, 42.9, [12_000, 15_000])];

/// Amplitude, frequency and whether a level is held, at a sample.
fn drive(j: usize) -> (f64, f64, bool) {
    let before = LEVELS.iter().rposition(|(.., [first, _])| j >= *first);
    let of = |k: Option<usize>| k.map_or((0.2, 39.0), |k| (LEVELS[k].0, LEVELS[k].1));
    let ((a, f), held) = (of(before), before.is_some_and(|k| j < LEVELS[k].2[1]));
    let from = before.map_or(0, |k| LEVELS[k].2[1]);
    let next = before.map_or(0, |k| k + 1);
    if held || next == LEVELS.len() {
        return (a, f, held);
    }
    let share = (j - from) as f64 / (LEVELS[next].2[0] - from) as f64;
    let (b, g) = of(Some(next));
    (a + share * (b - a), f + share * (g - f), false)
}

/// A force a quarter of a period ahead of a displacement with a second harmonic, and the flag.
fn record() -> Record {
    let (mut phase, mut force, mut x, mut flag) = (0.0_f64, vec![], vec![], vec![]);
    for j in 0..16_000 {
        let (a, f, held) = drive(j);
        let noise = 1e-4 * f64::sin((j * j) as f64 * 0.7);
        force.push(-3.0 * a * phase.sin() + noise);
        x.push(1e-3 * (a * phase.cos() + 0.1 * a * (2.0 * phase + 0.3).cos() + noise));
        flag.push(if held { 5.0 } else { 0.01 });
        phase += TAU * f / RATE;
    }
    Record::new("all", RATE)
        .with(Channel::new("force", Quantity::Force, Role::Excitation, None), force)
        .with(Channel::new("x", Quantity::Displacement, Role::DrivePoint, None), x)
        .with(Channel::new("settled", Quantity::Phase, Role::ExcitationPhase, None), flag)
}

fn scene(files: &str, more: &str) -> String {
    format!(
        "[recording]\nfiles = [{files}]\nsample_rate_hz = 2000.0\n[[channel]]\nname = \"force\"\nquantity = \"force\"\n\
         role = \"excitation\"\nposition_m = 0.1\n[[channel]]\nname = \"x\"\nquantity = \"displacement\"\n\
         role = \"drive-point\"\nposition_m = 0.1\n[linear_modes]\nfrequencies_hz = [40.0]\npositions_m = [0.1]\n\
         shapes = [[1.0]]\n{more}"
    )
}

/// Exit status, output, and the rows of the table, in the order of its header.
pub fn extract(folder: &Path, text: &str) -> Result<(i32, String, Vec<Row>), Box<dyn Error>> {
    let (path, out) = (folder.join("scene.toml"), folder.join("out"));
    drop(fs::remove_dir_all(&out));
    fs::write(&path, text)?;
    let mut command = Command::cargo_bin("nlmodes-cli")?;
    let output = command.args(["experiment", "extract"]).arg(&path).arg("--out").arg(&out).output()?;
    let said = String::from_utf8(output.stdout)? + &String::from_utf8(output.stderr)?;
    let table = out.join("modal_points.csv");
    let rows =
        if table.exists() { csv::Reader::from_path(table)?.deserialize().collect::<Result<_, _>>()? } else { vec![] };
    Ok((output.status.code().ok_or("no status")?, said, rows))
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or(f64::NAN)
}

/// What a row says about its level, without the names of record and segment.
fn without_names(row: &Row) -> Vec<(String, String)> {
    let of_part = ["record", "segment", "from_s", "to_s"];
    let mut cells: Vec<_> = row.iter().filter(|(name, _)| !of_part.contains(&name.as_str())).collect();
    cells.sort();
    cells.into_iter().map(|(name, cell)| (name.clone(), cell.clone())).collect()
}

#[test]
fn a_long_record_gives_the_rows_of_its_levels_alone() -> Outcome {
    let folder = tempfile::tempdir()?;
    let record = record();
    let names: Vec<String> = (0..3).map(|k| format!("level_{k}.csv")).collect();
    for (name, (.., [first, end])) in names.iter().zip(LEVELS) {
        write_record(&folder.path().join(name), &record.part(name, first..end))?;
    }
    write_record(&folder.path().join("all.csv"), &record)?;
    write_record(&folder.path().join("all.npy"), &record)?;
    let files = names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    let (status, said, alone) = extract(folder.path(), &scene(&files, ""))?;
    assert_eq!((status, alone.len()), (0, 3), "{said}");
    assert!(!alone[0].contains_key("segment"));
    for (row, (amplitude, frequency, _)) in alone.iter().zip(LEVELS) {
        assert!((number(row, "frequency_hz") / frequency - 1.0).abs() < 1e-6, "{row:?}");
        assert!((number(row, "modal_amplitude") / amplitude / 1e-3 - 1.0).abs() < 1e-4, "{row:?}");
        assert!((number(row, "lag_deg") - 90.0).abs() < 0.01, "{row:?}");
    }
    let times =
        LEVELS.map(|(.., [a, b])| format!("[[segment]]\nfrom_s = {}\nto_s = {}\n", a as f64 / RATE, b as f64 / RATE));
    // A column more than channels, which is the flag; a table names it.
    for (file, more) in [
        ("\"all.csv\"", times.concat()),
        ("\"all.csv\"", "[[segment]]\nflag = \"settled\"\n".to_owned()),
        ("\"all.npy\"", "[[segment]]\nflag = \"3\"\nname = \"up\"\n".to_owned()),
    ] {
        let (status, said, rows) = extract(folder.path(), &scene(file, &more))?;
        assert_eq!((status, rows.len()), (0, 3), "{said}");
        for (k, (row, alone)) in rows.iter().zip(&alone).enumerate() {
            assert_eq!(without_names(row), without_names(alone), "{file} {more}");
            let [first, end] = LEVELS[k].2;
            assert_eq!([number(row, "from_s"), number(row, "to_s")], [first as f64 / RATE, end as f64 / RATE]);
            let name = if file.contains("npy") { format!("up {}", k + 1) } else { (k + 1).to_string() };
            assert_eq!(row["segment"], name);
        }
        assert!(said.contains("segment ") && said.contains("3 s to 5 s"), "{said}");
        let page = fs::read_to_string(folder.path().join("out/report.html"))?;
        assert!(page.contains("3 s to 5 s"));
        let summary = fs::read_to_string(folder.path().join("out/summary.json"))?;
        assert!(summary.contains("\"from_s\": 3.0"), "{summary}");
    }
    for more in ["[[segment]]\nsegments = \"steady\"\n", "[extraction]\nperiods = 30\n"] {
        let text = scene("\"all.csv\"", more);
        let text = if more.contains("extraction") {
            text.replace("[recording]", "[recording]\nsegments = \"steady\"")
        } else {
            text
        };
        let (status, said, rows) = extract(folder.path(), &text)?;
        assert_eq!((status, rows.len()), (0, 3), "{said}");
        // The last level goes on to the end of the record, behind its flag.
        for (row, (amplitude, frequency, [first, end])) in rows.iter().zip(LEVELS) {
            let [from, to] = [number(row, "from_s") * RATE, number(row, "to_s") * RATE];
            assert!(from >= first as f64 && (to <= end as f64 || frequency > 42.0), "{row:?}");
            assert!((number(row, "frequency_hz") / frequency - 1.0).abs() < 1e-6, "{row:?}");
            assert!((number(row, "modal_amplitude") / amplitude / 1e-3 - 1.0).abs() < 1e-4, "{row:?}");
        }
    }
    Ok(())
}

#[test]
fn segments_that_cannot_be_are_refused_with_their_place() -> Outcome {
    let folder = tempfile::tempdir()?;
    let mut record = record();
    record.samples[2].iter_mut().for_each(|x| *x = 0.0);
    write_record(&folder.path().join("all.csv"), &record)?;
    let span = |from: f64, to: f64| format!("[[segment]]\nfrom_s = {from}\nto_s = {to}\n");
    for (more, said) in [
        (span(0.5, 2.0) + &span(1.5, 3.0), vec!["`segment.1`", "overlap from 1.5 s to 2 s"]),
        (span(2.0, 0.5), vec!["`segment.0`", "expected more than `from_s`, 2 s"]),
        (span(6.0, 8.5), vec!["`segment.0`", "all.csv", "6 s to 8.5 s, expected times from 0 s to 8 s"]),
        (span(0.5, 0.8) + "[extraction]\nperiods = 20\n", vec!["`segment.0`", "12", "expected 20 at least"]),
        (span(0.5, 0.51), vec!["`segment.0`", "expected 2 at least"]),
        ("[[segment]]\nflag = \"settled\"\n".into(), vec!["flag = \"settled\"", "never set", "zero throughout"]),
        ("[[segment]]\nflag = \"setled\"\n".into(), vec!["\"setled\"", "the file has", "settled"]),
        ("[[segment]]\nname = \"a\"\n".into(), vec!["does not say which part", "`flag`"]),
        ("[[segment]]\nfrom_s = 1.0\n".into(), vec!["`segment.0.to_s` is missing"]),
        (span(1.0, 2.0) + "flag = \"settled\"\n", vec!["several ways"]),
        (span(1.0, 2.0) + "[[segment]]\nsegments = \"steady\"\n", vec!["may be the same part"]),
        (span(1.0, 2.0) + "file = \"al.csv\"\n", vec!["al.csv", "did you mean \"all.csv\"?"]),
        (
            "[[segment]]\nsegments = \"steady\"\n[extraction]\nperiods = 300\n".into(),
            vec!["no level is found", "300 periods"],
        ),
    ] {
        let (status, found, rows) = extract(folder.path(), &scene("\"all.csv\"", &more))?;
        assert_eq!((status, rows.len()), (2, 0), "{more}: {found}");
        for said in said {
            assert!(found.contains(said), "{more}: {said} is not in\n{found}");
        }
    }
    Ok(())
}
