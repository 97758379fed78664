//! Scenes with a motion in time: files, starts, loads from tables, and messages.

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::fs::{self, File};
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use npyz::WriterBuilder;
use npyz::npz::NpzArchive;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

/// A rod of four elements before a rigid stop at its tip.
const ROD: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 4
start = "clamped"
material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }
section = { area_m2 = 1.0 }
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1.0
[damping]
ratio = 0.02
[reduction]
modes = 2
"#;

const QUIET: &str = "[output]\nfigures = false\npage = false\n";

fn call(folder: &Path, arguments: &[&str]) -> Result<Output, Box<dyn Error>> {
    Ok(Command::cargo_bin("nlmodes-cli")?.args(arguments).current_dir(folder).output()?)
}

/// Runs a scene into a folder of its own.
fn run(folder: &Path, name: &str, scene: &str) -> Outcome {
    fs::write(folder.join(format!("{name}.toml")), scene)?;
    let output = call(folder, &["run", &format!("{name}.toml"), "--quiet", "--force", "--out", name])?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}

fn here(scene: &str) -> Result<TempDir, Box<dyn Error>> {
    let folder = tempdir()?;
    run(folder.path(), "out", scene)?;
    Ok(folder)
}

/// An array, and its shape.
fn array(folder: &Path, name: &str) -> Result<(Vec<u64>, Vec<f64>), Box<dyn Error>> {
    let mut archive = NpzArchive::open(folder.join("transient.npz"))?;
    let file = archive.by_name(name)?.ok_or_else(|| format!("no array {name}"))?;
    Ok((file.shape().to_vec(), file.into_vec()?))
}

fn summary(folder: &Path) -> Result<Value, Box<dyn Error>> {
    Ok(serde_json::from_slice(&fs::read(folder.join("summary.json"))?)?)
}

/// Rows of numbers of a table.
fn rows(path: &Path) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let mut table = csv::Reader::from_path(path)?;
    let row = |record: csv::StringRecord| record.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    Ok(table.records().map(|record| record.map(row)).collect::<Result<_, _>>()?)
}

fn transient(load: &str, more: &str) -> String {
    format!("{ROD}{QUIET}[transient]\n{more}\n[[transient.load]]\nat_m = 0.5\n{load}\n")
}

#[test]
fn a_motion_that_starts_on_a_response_with_many_harmonics_stays_on_it() -> Outcome {
    let folder = tempdir()?;
    let response = "[[force]]\nat_m = 0.5\n[response]\nkind = \"frequency\"\nfrequency_hz = [0.26, 0.30]\n\
        levels_n = [0.4]\n[method]\nharmonics = 100\n";
    run(folder.path(), "response", &format!("{ROD}{response}{QUIET}"))?;
    let mut table = csv::Reader::from_path(folder.path().join("response/branch.csv"))?;
    let names = table.headers()?.clone();
    let place = |name: &str| names.iter().position(|own| own == name).ok_or(name.to_owned());
    let [hz, force, fundamental, stable] =
        ["frequency_hz", "peak_contact_force_n", "fundamental_m", "stable"].map(place);
    let [hz, force, fundamental, stable] = [hz?, force?, fundamental?, stable?];
    let records = table.records().collect::<Result<Vec<_>, _>>()?;
    let is_one = |r: &csv::StringRecord| r[force].parse::<f64>().is_ok_and(|f| f > 0.5) && &r[stable] == "true";
    let record = records.iter().find(|record| is_one(record)).ok_or("no stable point with contact")?;
    let [hz, force, fundamental] = [hz, force, fundamental].map(|k| record[k].parse::<f64>().unwrap_or(f64::NAN));
    let more = format!(
        "duration_s = {:?}\nsample_rate_hz = {:?}\nfrom = {{ results = \"response\", point = {} }}",
        20.0 / hz,
        50.0 * hz,
        &record[0]
    );
    let load = format!("sine = {{ amplitude_n = 0.4, frequency_hz = {hz:?} }}");
    run(folder.path(), "time", &transient(&load, &more))?;
    let time = folder.path().join("time");
    let (shape, q) = array(&time, "displacement_m")?;
    // The place of the load and the contact, 20 periods of 50 samples and the last one.
    assert_eq!(shape, [2, 1001]);
    let contact = &q[1001..];
    let amplitude = |from: usize| {
        let turn = |k: usize| TAU * k as f64 / 50.0;
        let sums = (0..50).map(|k| [contact[from + k] * turn(k).cos(), contact[from + k] * turn(k).sin()]);
        let [re, im] = sums.fold([0.0, 0.0], |[re, im], [c, s]| [re + c, im + s]);
        (re * re + im * im).sqrt() / 25.0
    };
    for from in [0, 950] {
        assert!((amplitude(from) / fundamental.abs() - 1.0).abs() < 1e-4, "{} {fundamental}", amplitude(from));
    }
    assert!((0..50).all(|k| (contact[k] - contact[950 + k]).abs() < 2e-3), "it stays");
    let found = summary(&time)?["contacts"][0]["peak_force_n"].as_f64().ok_or("no force")?;
    assert!((found / force - 1.0).abs() < 1e-2, "{found} {force}");
    // Each touch brings what the response has in a period.
    let touches = rows(&time.join("touches.csv"))?;
    assert!(touches.len() >= 20);
    let impulse: f64 = touches.iter().map(|row| row[3]).sum::<f64>() / 20.0;
    let mut contacts = csv::Reader::from_path(folder.path().join("response/contacts.csv"))?;
    let column = contacts.headers()?.iter().position(|name| name == "impulse_ns").ok_or("no impulse")?;
    let own = contacts.records().find(|row| row.as_ref().is_ok_and(|row| row[0] == record[0])).ok_or("no row")??;
    assert!((impulse / own[column].parse::<f64>()? - 1.0).abs() < 2e-3, "{impulse} {}", &own[column]);
    Ok(())
}

#[test]
fn a_table_in_text_or_as_an_array_is_the_pulse_that_it_samples() -> Outcome {
    let folder = tempdir()?;
    let more = "duration_s = 12.0\nsample_rate_hz = 20.0";
    run(folder.path(), "pulse", &transient("half_sine = { peak_n = 3.0, width_s = 2.0 }\nstart_s = 0.5", more))?;
    let at = |k: u32| 2.0 * f64::from(k) / 2000.0;
    let values: Vec<[f64; 2]> = (0..=2000).map(|k| [at(k), 3.0 * (0.5 * PI * at(k)).sin()]).collect();
    let lines: String = values.iter().map(|[t, f]| format!("{f:?},{t:?}\n")).collect();
    fs::write(folder.path().join("named.csv"), format!("# a pulse\nforce_n, time_s\n{lines}"))?;
    let plain: String = values.iter().map(|[t, f]| format!("{t:?} {f:?}\n")).collect();
    fs::write(folder.path().join("plain.txt"), plain)?;
    let options = npyz::WriteOptions::new().default_dtype().shape(&[2001, 2]);
    let mut writer = options.writer(File::create(folder.path().join("array.npy"))?).begin_nd()?;
    writer.extend(values.iter().flatten().copied())?;
    writer.finish()?;
    let (_, expected) = array(&folder.path().join("pulse"), "displacement_m")?;
    let size = expected.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    assert!(size > 1.0 && summary(&folder.path().join("pulse"))?["touches"].as_u64() > Some(0));
    for file in ["named.csv", "plain.txt", "array.npy"] {
        run(folder.path(), "table", &transient(&format!("table = \"{file}\"\nstart_s = 0.5"), more))?;
        let (_, found) = array(&folder.path().join("table"), "displacement_m")?;
        // Straight lines leave out (π/2 · 1e-3)²/8 of the pulse.
        let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-5 * size, "{file}: {off:e}");
    }
    Ok(())
}

#[test]
fn histories_envelope_spectrum_and_touches_are_of_one_motion_and_the_same_in_every_run() -> Outcome {
    let scene = transient("noise = { rms_n = 1.5, band_hz = [0.1, 0.6], seed = 3 }", "duration_s = 200.0");
    let (first, second) = (here(&scene)?, here(&scene)?);
    let [a, b] = [&first, &second].map(|folder| folder.path().join("out"));
    for file in ["transient.npz", "touches.csv"] {
        assert_eq!(fs::read(a.join(file))?, fs::read(b.join(file))?, "{file}");
    }
    let (_, time) = array(&a, "time_s")?;
    let rate = summary(&a)?["sample_rate_hz"].as_f64().ok_or("no rate")?;
    assert!((rate - 64.0 * 0.6).abs() < 1e-12 && (time[1] * rate - 1.0).abs() < 1e-12);
    let ([p, t], q) = ([2, time.len()], array(&a, "displacement_m")?.1);
    assert_eq!(q.len(), p * t);
    let contact = &q[t..];
    let largest = contact.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(largest <= 1.0 + 1e-12, "not through the stop: {largest}");
    let told = summary(&a)?["places"][1]["largest_m"].as_f64().ok_or("no largest value")?;
    assert!((told - 1.0).abs() < 1e-9, "{told}");
    // Velocities are the rates of the displacements.
    let v = array(&a, "velocity_m_s")?.1;
    let between = (2..t - 2).filter(|k| contact[k - 2..k + 3].iter().all(|q| *q < 0.9));
    for k in between.step_by(37) {
        let five = (contact[k - 2] - 8.0 * contact[k - 1] + 8.0 * contact[k + 1] - contact[k + 2]) / 12.0;
        assert!((five * rate - v[t + k]).abs() < 1e-3 * (1.0 + v[t + k].abs()), "{k}");
    }
    // Force is there during touches alone, and adds up to their impulses.
    let (force, touches) = (array(&a, "force_n")?.1, rows(&a.join("touches.csv"))?);
    assert!(touches.len() > 10 && touches.iter().all(|row| row[2] > 0.0 && row[3] > 0.0 && row[4] >= 0.0));
    let is_touching = |t: f64| touches.iter().any(|row| row[1] - 1e-9 <= t && t <= row[1] + row[2] + 1e-9);
    assert!(time.iter().zip(&force).all(|(t, f)| *f >= 0.0 && (*f == 0.0 || is_touching(*t))));
    let told = summary(&a)?["contacts"][0]["impulse_ns"].as_f64().ok_or("no impulse")?;
    assert!((told / touches.iter().map(|row| row[3]).sum::<f64>() - 1.0).abs() < 1e-12);
    let most = array(&a, "envelope_max_m")?;
    assert_eq!(most.0, [2, 500]);
    assert_eq!(most.1[500..].iter().copied().fold(f64::NEG_INFINITY, f64::max), largest);
    // The spectrum of the load's place is in the band of the noise, but for what contacts and damping bring.
    let (hz, amplitude) = (array(&a, "spectrum_frequency_hz")?.1, array(&a, "spectrum_m")?.1);
    let power = |low: f64, high: f64| -> f64 {
        hz.iter().zip(&amplitude).filter(|(f, _)| (low..high).contains(*f)).map(|(_, a)| a * a).sum()
    };
    assert!(power(0.1, 0.6) > 10.0 * power(1.5, 20.0));
    Ok(())
}

#[test]
fn weight_moves_nothing_from_where_it_leaves_the_structure_and_makes_it_fall_from_the_drawing() -> Outcome {
    let scene = |from: &str| {
        let more = format!("[transient]\nduration_s = 40.0\nfrom = \"{from}\"\n[[transient.place]]\nat_m = 1.0\n");
        let of = ROD.replace("gap_m = 1.0", "gap_m = 100.0");
        format!("{of}{QUIET}[gravity]\nacceleration_m_s2 = 0.4\n{more}")
    };
    // The tip under its own weight: ½ g, by modes and statics.
    let still = here(&scene("static"))?;
    let (_, q) = array(&still.path().join("out"), "displacement_m")?;
    assert!(q.iter().all(|q| (q - 0.2).abs() < 1e-12), "{q:?}");
    let falling = here(&scene("rest"))?;
    let (shape, q) = array(&falling.path().join("out"), "displacement_m")?;
    let tip = &q[..shape[1] as usize];
    let most = tip.iter().copied().fold(0.0, f64::max);
    assert!(tip[0].abs() < 0.02, "the drawing, but for what lies beyond the modes: {}", tip[0]);
    assert!(most > 0.37 && most < 0.4, "it swings to nearly twice as much: {most}");
    let last = tip[tip.len() - 40..].iter().map(|q| (q - 0.2).abs()).fold(0.0, f64::max);
    assert!(last < 0.1, "damping brings it to rest: {last}");
    Ok(())
}

#[test]
fn a_shaken_base_pushes_by_the_mass_of_the_structure() -> Outcome {
    // Far below the first mode the tip lags behind a base with the acceleration a by ½ a, as under its weight.
    let load = "[[transient.load]]\nbase = \"acceleration\"\nsine = { amplitude_m_s2 = 0.1, frequency_hz = 0.002 }\n";
    let more = "[transient]\nduration_s = 1000.0\nsample_rate_hz = 1.0\n[[transient.place]]\nat_m = 1.0\n";
    let folder = here(&format!("{ROD}{QUIET}{more}{load}"))?;
    let (shape, q) = array(&folder.path().join("out"), "displacement_m")?;
    let tip = &q[..shape[1] as usize];
    for k in [500, 625, 750, 1000] {
        let expected = -0.05 * (TAU * 0.002 * k as f64).cos();
        assert!((tip[k] - expected).abs() < 1e-3, "{k}: {} {expected}", tip[k]);
    }
    Ok(())
}

#[test]
fn figures_and_page_show_envelope_and_spectrum_and_a_sweep_of_two_stops_is_told_in_words() -> Outcome {
    let folder = tempdir()?;
    let scene =
        transient("chirp = { amplitude_n = 0.5, from_hz = 0.2, to_hz = 0.35, back = true }", "duration_s = 300.0");
    fs::write(folder.path().join("scene.toml"), scene.replace(QUIET, ""))?;
    let output = call(folder.path(), &["run", "scene.toml", "--out", "out"])?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout)?;
    assert!(said.starts_with("300 s of motion in 2 modes, ") && said.contains("contact 0: up to "), "{said}");
    let page = fs::read_to_string(folder.path().join("out/report.html"))?;
    for heading in ["Envelope of the motion", "Spectrum of the motion", "Largest displacements"] {
        assert!(page.contains(heading), "{heading}");
    }
    assert!(folder.path().join("out/envelope.svg").is_file() && folder.path().join("out/spectrum.svg").is_file());
    // The same scene may be run again, another one not unasked.
    assert_eq!(call(folder.path(), &["run", "scene.toml", "--out", "out", "--quiet"])?.status.code(), Some(0));
    let other = call(folder.path(), &["run", "scene.toml", "--out", "out", "--set", "transient.duration_s=5"])?;
    assert_eq!(other.status.code(), Some(2));
    Ok(())
}

#[test]
fn damaged_tables_are_refused_with_their_place() -> Outcome {
    let folder = tempdir()?;
    let scene = transient("table = \"force.csv\"", "duration_s = 1.0");
    fs::write(folder.path().join("scene.toml"), scene)?;
    let cases = [
        ("time_s,force\n0,1\n1,2\n", "columns time_s,force; expected time_s and force_n"),
        ("time_s,force_n\n0,1\n1,x\n", "line 3: `x` in column force_n; expected a number"),
        ("time_s,force_n\n0,1\n1\n", "line 3: `` in column force_n; expected a number"),
        ("0,1\n0,2\n", "row 2: 0 behind 0; expected time_s that grows"),
        ("0,1\n", "1 row; expected two or more"),
        ("0,1,2\n1,2,3\n", "expected two columns"),
        ("0,1\n1,inf\n", "force.csv"),
    ];
    for (text, expected) in cases {
        fs::write(folder.path().join("force.csv"), text)?;
        let output = call(folder.path(), &["check", "scene.toml"])?;
        let said = String::from_utf8(output.stderr)?;
        assert_eq!(output.status.code(), Some(2), "{text}: {said}");
        assert!(said.contains(expected) && said.contains("scene.toml:"), "{text}: {said}");
        assert!(said.contains("expected rows time_s,force_n"), "{said}");
    }
    Ok(())
}

#[test]
fn starts_on_results_that_do_not_fit_are_refused() -> Outcome {
    let folder = tempdir()?;
    let response = "[[force]]\nat_m = 0.5\n[response]\nkind = \"frequency\"\nfrequency_hz = [0.20, 0.21]\n\
        levels_n = [0.1]\n[method]\nharmonics = 3\n";
    run(folder.path(), "response", &format!("{ROD}{response}{QUIET}"))?;
    let said = |scene: &str| -> Result<String, Box<dyn Error>> {
        fs::write(folder.path().join("scene.toml"), scene)?;
        let output = call(folder.path(), &["check", "scene.toml"])?;
        assert_eq!(output.status.code(), Some(2));
        Ok(String::from_utf8(output.stderr)?)
    };
    let from = |point: usize| format!("duration_s = 1.0\nfrom = {{ results = \"response\", point = {point} }}");
    let scene = |point: usize| transient("impact = { impulse_ns = 0.1 }", &from(point));
    let text = said(&scene(9999))?;
    assert!(text.contains("there is no point 9999") && text.contains("expected results of this structure"), "{text}");
    let text = said(&scene(0).replace("elements = 4", "elements = 8"))?;
    assert!(text.contains("these are results of another structure"), "{text}");
    Ok(())
}
