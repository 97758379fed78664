//! `experiment extract`: from files of records to the table.

use std::collections::HashMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use nlmodes::experiment::records::{Channel, Quantity, Record, Recording, Role, write_record};

type Outcome = Result<(), Box<dyn Error>>;
type Row = HashMap<String, String>;

fn configs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs")
}

/// Exit status, output, and the rows of the table.
fn extract(scene: &Path, out: &Path, more: &[&str]) -> Result<(i32, String, Vec<Row>), Box<dyn Error>> {
    let mut command = Command::cargo_bin("nlmodes-cli")?;
    let output = command.args(["experiment", "extract"]).arg(scene).arg("--out").arg(out).args(more).output()?;
    let said = String::from_utf8(output.stdout)? + &String::from_utf8(output.stderr)?;
    let table = out.join("modal_points.csv");
    let rows =
        if table.exists() { csv::Reader::from_path(table)?.deserialize().collect::<Result<_, _>>()? } else { vec![] };
    Ok((output.status.code().ok_or("no status")?, said, rows))
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or(f64::NAN)
}

#[test]
fn the_short_records_have_the_answer_they_were_made_with() -> Outcome {
    let out = tempfile::tempdir()?;
    let (status, said, rows) = extract(&configs().join("measured_record.toml"), out.path(), &[])?;
    assert_eq!((status, rows.len()), (0, 2), "{said}");
    let (below, against) = (&rows[0], &rows[1]);
    assert_eq!(below["record"], "records/below_stop.csv");
    // The force follows the velocity of the first mode: undamped frequency, its damping ratio.
    assert!((number(below, "frequency_hz") - 40.1).abs() < 1e-4);
    assert!((number(below, "damping") / 0.0019 - 1.0).abs() < 1e-3);
    assert!((number(below, "participation_1") - 1.0).abs() < 1e-4 && number(below, "participation_2").abs() < 1e-4);
    assert_eq!(below["contact_stiffness_n_m"], "");
    assert!((number(against, "contact_stiffness_n_m") / 2e5 - 1.0).abs() < 0.01);
    assert!(number(against, "frequency_hz") > 42.0 && number(against, "pbmif") < 0.95);
    // 4000 Hz over 43.2 Hz.
    assert_eq!(against["pbmif_harmonics"], "92");
    for column in ["lag_deg", "modal_amplitude", "peak_contact_force_n", "restitution_mean", "restitution_std"] {
        assert!(number(against, column).is_finite(), "{column}");
        assert!(against["frequency_hz_uncertainty"].parse::<f64>()? < 1e-3);
    }
    assert_eq!(against["findings"], "");
    for file in [
        "frequency_amplitude.svg",
        "damping_amplitude.svg",
        "history_1.svg",
        "history_2.svg",
        "contact_2.svg",
        "restitution.svg",
        "summary.json",
    ] {
        assert!(out.path().join(file).exists(), "{file}");
    }
    assert!(said.contains("from 92 harmonics") && said.contains("contact stiffness"), "{said}");
    Ok(())
}

/// A computed branch is overlaid on the records in figures and page, with the differences at equal modal amplitude.
#[test]
fn a_branch_is_laid_beside_records() -> Outcome {
    let folder = tempfile::tempdir()?;
    let text = fs::read_to_string(configs().join("measured_record.toml"))?;
    let records = configs().join("records").to_string_lossy().replace('\\', "/");
    let text = text.replace("\"records/", &format!("\"{records}/"));
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    fs::write(&scene, &text)?;
    let (status, said, rows) = extract(&scene, &out, &[])?;
    assert_eq!((status, rows.len(), out.join("overlay.csv").exists()), (0, 2, false), "{said}");
    // One hertz below what was measured, at amplitudes around it.
    let mut branch = String::from("frequency_hz,modal_amplitude\n");
    let amplitudes: Vec<f64> = rows.iter().map(|row| number(row, "modal_amplitude")).collect();
    let frequencies: Vec<f64> = rows.iter().map(|row| number(row, "frequency_hz")).collect();
    let slope = (frequencies[1] - frequencies[0]) / (amplitudes[1] - amplitudes[0]);
    for share in [-0.5, 0.0, 0.25, 0.5, 0.75, 1.0, 1.5] {
        let amplitude = amplitudes[0] + share * (amplitudes[1] - amplitudes[0]);
        branch += &format!("{},{amplitude}\n", frequencies[0] + slope * (amplitude - amplitudes[0]) - 1.0);
    }
    fs::create_dir(folder.path().join("run"))?;
    fs::write(folder.path().join("run/branch.csv"), branch)?;
    fs::write(&scene, format!("{text}\n[[overlay]]\npath = \"run\"\nlabel = \"my model\"\n"))?;
    let (status, said, _) = extract(&scene, &out, &["--force"])?;
    assert_eq!(status, 0, "{said}");
    let differences: Vec<Row> =
        csv::Reader::from_path(out.join("overlay.csv"))?.deserialize().collect::<Result<_, _>>()?;
    assert_eq!(differences.len(), 2);
    for row in &differences {
        let off = number(row, "frequency_hz") - number(row, "branch_frequency_hz");
        assert!((off - 1.0).abs() < 1e-6, "{row:?}");
    }
    let page = fs::read_to_string(out.join("report.html"))?;
    assert!(page.contains("test over my model") && page.contains("stiffer"));
    assert!(fs::read_to_string(out.join("frequency_amplitude.svg"))?.contains("my model"));
    fs::write(&scene, format!("{text}\n[[overlay]]\npath = \"nowhere\"\n"))?;
    let (status, said, _) = extract(&scene, &out, &["--force"])?;
    assert!(status == 2 && said.contains("nowhere"), "{said}");
    Ok(())
}

/// One of the short records in another format, with a scene beside it.
fn rewritten(folder: &Path, name: &str, change: impl Fn(&mut Record)) -> Result<PathBuf, Box<dyn Error>> {
    let scene = fs::read_to_string(configs().join("measured_record.toml"))?;
    let channel = |name: &str, quantity, role| Channel::new(name, quantity, role, None);
    use Quantity::{Acceleration, Displacement, Force, Velocity};
    let channels = vec![
        channel("force_N", Force, Role::Excitation),
        channel("x_drive_m", Displacement, Role::DrivePoint),
        channel("v_drive_mps", Velocity, Role::DrivePoint),
        channel("a1_mps2", Acceleration, Role::Response),
        channel("a2_mps2", Acceleration, Role::Response),
        channel("x_tip_m", Displacement, Role::Response),
        channel("v_tip_mps", Velocity, Role::Response),
        channel("f_contact_N", Force, Role::Contact),
    ];
    let recording = Recording { channels, sample_rate: Some(8000.0), time_column: Some("time_s".into()) };
    let mut record = recording.read(&configs().join("records/against_stop.csv"))?;
    change(&mut record);
    write_record(&folder.join(name), &record)?;
    let files = format!("files = [\"{name}\"]");
    let scene = scene.replace("files = [\"records/below_stop.csv\", \"records/against_stop.csv\"]", &files);
    let path = folder.join("scene.toml");
    fs::write(&path, scene)?;
    Ok(path)
}

#[test]
fn every_format_gives_the_same_point() -> Outcome {
    let out = tempfile::tempdir()?;
    let (_, _, rows) = extract(&configs().join("measured_record.toml"), out.path(), &[])?;
    for (name, digits) in [("r.csv", 1e-12), ("r.uff", 1e-12), ("r.npy", 1e-12), ("r.wav", 1e-6)] {
        let folder = tempfile::tempdir()?;
        let scene = rewritten(folder.path(), name, |_| ())?;
        let (status, said, found) = extract(&scene, &folder.path().join("out"), &[])?;
        assert_eq!((status, found.len()), (0, 1), "{name}: {said}");
        for column in ["frequency_hz", "modal_amplitude", "damping", "pbmif", "contact_stiffness_n_m"] {
            let (a, b) = (number(&found[0], column), number(&rows[1], column));
            assert!((a / b - 1.0).abs() <= digits, "{name}: {column} {a} {b}");
        }
    }
    Ok(())
}

#[test]
fn a_reversed_force_is_said_with_its_number() -> Outcome {
    let out = tempfile::tempdir()?;
    let scene = configs().join("measured_record.toml");
    let (status, said, rows) = extract(&scene, out.path(), &["--set", "channel.0.sign=-1"])?;
    assert_eq!(status, 0);
    assert!(rows.iter().all(|row| row["findings"] == "reversed-force" && number(row, "pbmif") < 0.0));
    assert!(
        said.contains("reversed-force: the force takes power out (mode indicator -0.7795 from 92 harmonics)"),
        "{said}"
    );
    Ok(())
}

#[test]
fn a_record_that_gives_no_point_has_a_row_with_the_reason() -> Outcome {
    let folder = tempfile::tempdir()?;
    let scene = rewritten(folder.path(), "r.csv", |record| {
        record.samples.iter_mut().for_each(|samples| samples.truncate(300));
    })?;
    let (status, said, rows) = extract(&scene, &folder.path().join("out"), &["--set", "extraction.frequency_hz=43.2"])?;
    assert_eq!((status, rows.len()), (1, 1), "{said}");
    assert_eq!((rows[0]["findings"].as_str(), rows[0]["frequency_hz"].as_str()), ("too-short", ""));
    assert!(said.contains("1.62 periods, 2 are wanted"), "{said}");
    Ok(())
}

#[test]
fn a_file_that_cannot_be_read_ends_it_and_nothing_is_written() -> Outcome {
    let cases: [(&str, &[u8], &str); 5] = [
        ("r.csv", b"time_s;force_N\n0,0;1,5\n0,1;2,5\n", "comma as decimal sign"),
        ("r.csv", b"time_s,force_N\n0,1\r\n0.1,2\n", "line 2 ends with CR LF"),
        ("r.uff", b"\x00\x01garbage", "no dataset 58"),
        ("r.npy", b"\x93NUMPY\x01\x00\xff\xff{", "ends within its header"),
        ("r.wav", b"RIFF\x00\x00\x00\x00WAVE", "WAV file cannot be read"),
    ];
    for (name, bytes, reason) in cases {
        let folder = tempfile::tempdir()?;
        let scene = rewritten(folder.path(), name, |_| ())?;
        fs::write(folder.path().join(name), bytes)?;
        let (status, said, rows) = extract(&scene, &folder.path().join("out"), &[])?;
        assert_eq!((status, rows.len()), (2, 0), "{said}");
        assert!(said.contains(reason) && said.contains("files = ["), "{said}");
        assert!(!folder.path().join("out").exists());
    }
    let folder = tempfile::tempdir()?;
    let scene = rewritten(folder.path(), "r.csv", |_| ())?;
    fs::remove_file(folder.path().join("r.csv"))?;
    let (status, said, _) = extract(&scene, &folder.path().join("out"), &[])?;
    assert!(status == 2 && said.contains("paths count from the directory of the scene"), "{said}");
    let (status, said, _) = extract(
        &configs().join("measured_record.toml"),
        &folder.path().join("out"),
        &["--set", "recording.sample_rate_hz=8000.1"],
    )?;
    assert!(status == 2 && said.contains("sampling-rates-disagree"), "{said}");
    Ok(())
}

#[test]
fn a_file_that_is_not_there_is_named_before_anything_else() -> Outcome {
    let folder = tempfile::tempdir()?;
    let (scene, out) = (rewritten(folder.path(), "r.csv", |_| ())?, folder.path().join("out"));
    assert_eq!(extract(&scene, &out, &[])?.0, 0);
    let text = fs::read_to_string(&scene)?.replace("r.csv", "rr.csv");
    let line = 1 + text.lines().take_while(|line| !line.contains("rr.csv")).count();
    fs::write(&scene, text)?;
    let check = Command::cargo_bin("nlmodes-cli")?.arg("check").arg(&scene).output()?;
    let checked = String::from_utf8(check.stdout)? + &String::from_utf8(check.stderr)?;
    let (status, extracted, _) = extract(&scene, &out, &[])?;
    assert_eq!((check.status.code(), status), (Some(2), 2), "{checked}\n{extracted}");
    for said in [checked, extracted] {
        let path = folder.path().join("rr.csv");
        assert!(said.contains(&path.display().to_string()) && said.contains("No such file"), "{said}");
        assert!(said.contains(&format!("scene.toml:{line}")) || said.contains(&format!("{line} |")), "{said}");
        assert!(!said.contains("sound") && !said.contains("another scene"), "{said}");
    }
    Ok(())
}

#[test]
fn an_accelerometer_declared_in_g_is_named_with_its_factor() -> Outcome {
    let out = tempfile::tempdir()?;
    let scene = configs().join("measured_record.toml");
    let (status, said, rows) = extract(&scene, out.path(), &["--set", "channel.3.unit=\"g\""])?;
    assert_eq!((status, rows.len()), (0, 2), "{said}");
    assert!(rows.iter().all(|row| row["findings"] == "wrong-scale"), "{said}");
    assert!(
        said.contains("channel \"a1_mps2\" is 9.8") && said.contains("declared in g, are its numbers in m/s^2?"),
        "{said}"
    );
    Ok(())
}

#[test]
fn scenes_of_one_kind_are_refused_by_commands_of_the_other() -> Outcome {
    for (arguments, said) in [
        (["run", "measured_record.toml"].as_slice(), "`nlmodes-cli experiment extract`"),
        (&["experiment", "extract", "rod.toml"], "`nlmodes-cli run`"),
    ] {
        let output = Command::cargo_bin("nlmodes-cli")?.args(arguments).current_dir(configs()).output()?;
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8(output.stderr)?.contains(said));
    }
    Ok(())
}

/// Mass-normalised first mode of a slender cantilever (Euler-Bernoulli).
fn cantilever(x_over_l: f64, mass: f64) -> f64 {
    let (beta, sigma) = (1.875_104_068_711_961, 0.734_095_513_757_5);
    let b = beta * x_over_l;
    (b.cosh() - b.cos() - sigma * (b.sinh() - b.sin())) / mass.sqrt()
}

#[test]
fn a_structure_gives_the_linear_modes_at_the_sensors() -> Outcome {
    let (length, width, height, modulus, density) = (0.5, 0.02, 0.002, 200e9, 7800.0);
    let mass = density * width * height * length;
    let (amplitude, frequency, positions) = (3e-4, 6.5, [0.13, 0.26, 0.41, 0.5]);
    let folder = tempfile::tempdir()?;
    let mut record = Record::new("r", 1000.0);
    let mut scene = format!(
        "[recording]\nfiles = [\"r.csv\"]\ntime_column = \"time_s\"\n\n[structure]\nkind = \"beam\"\nlength_m = \
         {length}\nelements = 30\nstart = \"clamped\"\n\
         [structure.material]\nyoungs_modulus_pa = {modulus}\ndensity_kg_m3 = {density}\n[structure.section]\nwidth_m \
         = {width}\nheight_m = {height}\n"
    );
    for (i, x) in positions.into_iter().enumerate() {
        let size = amplitude * cantilever(x / length, mass);
        let samples =
            (0..1000).map(|j| size * (std::f64::consts::TAU * frequency * f64::from(j) * 1e-3).sin()).collect();
        record = record.with(Channel::new(format!("x{i}"), Quantity::Displacement, Role::Response, Some(x)), samples);
        scene += &format!(
            "[[channel]]\nname = \"x{i}\"\nquantity = \"displacement\"\nrole = \"response\"\nposition_m = {x}\n"
        );
    }
    write_record(&folder.path().join("r.csv"), &record)?;
    let path = folder.path().join("scene.toml");
    fs::write(&path, scene)?;
    let (status, said, rows) = extract(&path, &folder.path().join("out"), &[])?;
    assert_eq!((status, rows.len()), (0, 1), "{said}");
    // Shear and rotary inertia of a beam of this slenderness change the shape by 1e-5.
    assert!((number(&rows[0], "modal_amplitude") / amplitude - 1.0).abs() < 1e-4, "{said}");
    assert!((number(&rows[0], "participation_1") - 1.0).abs() < 1e-4);
    assert!(number(&rows[0], "participation_2").abs() < 1e-4);
    Ok(())
}
