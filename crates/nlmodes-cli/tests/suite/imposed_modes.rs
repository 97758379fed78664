//! `[structure.modes]`: imposed frequencies in the linear modes, on the branch, and in the messages.

use std::collections::HashMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

type Outcome = Result<(), Box<dyn Error>>;

const IMPOSED: [f64; 6] = [40.10, 268.62, 758.26, 1371.82, 2427.72, 3508.31];

fn configuration(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs").join(name)
}

/// Exit status, and the output on both channels.
fn call(arguments: &[&str]) -> Result<(i32, String), Box<dyn Error>> {
    let output = Command::cargo_bin("nlmodes-cli")?.args(arguments).output()?;
    let said = String::from_utf8(output.stdout)? + &String::from_utf8(output.stderr)?;
    Ok((output.status.code().ok_or("no status")?, said))
}

fn summary(directory: &Path) -> Result<Value, Box<dyn Error>> {
    Ok(serde_json::from_str(&fs::read_to_string(directory.join("summary.json"))?)?)
}

fn floats(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

fn rows(path: &Path) -> Result<Vec<HashMap<String, String>>, Box<dyn Error>> {
    Ok(csv::Reader::from_path(path)?.deserialize().collect::<Result<_, _>>()?)
}

#[test]
fn both_methods_begin_at_the_imposed_frequencies_and_say_so() -> Outcome {
    let (out, scene) = (tempfile::tempdir()?, configuration("beam_modal.toml"));
    let (scene, folder) = (scene.display().to_string(), out.path().display().to_string());
    let (status, said) = call(&["run", &scene, "--out", &folder, "--set", "continuation.max_energy_ratio=2.5"])?;
    assert_eq!(status, 0, "{said}");
    assert!(
        said.contains("modal model: the lowest 6 bending modes have their frequencies imposed, 40.1, 268.62"),
        "{said}"
    );
    for (method, column) in [("ms-hbm", "mass_redistributed"), ("hbm", "mass_kept")] {
        let found = summary(&out.path().join(method))?;
        assert!(found["model"].as_str().is_some_and(|text| text.starts_with("modal model")), "{method}");
        assert_eq!(floats(&found["scene"]["structure"]["modes"]["frequencies_hz"]), IMPOSED);
        // The fifth mode is the first axial one, c/4L with the wave speed c: imposed frequencies do not change it.
        let all = floats(&found["linear_frequencies_hz"][column]);
        let own = floats(&found["linear_frequencies_hz"]["of_the_elements"]);
        for (wanted, mode) in IMPOSED.iter().zip([0, 1, 2, 3, 5, 6]) {
            assert!((all[mode] / wanted - 1.0).abs() < 1e-10, "{method}: {} {wanted}", all[mode]);
            assert!(mode == 0 || (own[mode] / wanted - 1.0).abs() > 1e-5, "{method}: mode {mode} had that frequency");
        }
        for mode in [4, 7, 8] {
            assert!((all[mode] / own[mode] - 1.0).abs() < 1e-10, "{method}: mode {}", mode + 1);
        }
        // Up to contact it is the imposed linear mode alone.
        let points = rows(&out.path().join(method).join("branch.csv"))?;
        assert!((points[0]["frequency_hz"].parse::<f64>()? / 40.10 - 1.0).abs() < 1e-9);
        let participation = &rows(&out.path().join(method).join("participation.csv"))?[0];
        let share = |k: usize| participation[&format!("participation_{k}")].parse::<f64>();
        assert!((share(1)? - 1.0).abs() < 1e-9 && share(2)?.abs() < 1e-9, "{method}");
    }
    common_figures(out.path())
}

/// Both methods overlaid, at equal amplitude, with beginning and end of contact; and everything on the page.
fn common_figures(out: &Path) -> Outcome {
    for name in ["P1", "P2"] {
        let figure = fs::read_to_string(out.join(format!("history_{name}.svg")))?;
        assert!(figure.contains(&format!("{name}: equal modal amplitude, ")), "{name}");
        assert!(figure.contains("MS-HBM, 5 harmonics: ") && figure.contains(">HBM, 5 harmonics: "), "{name}");
        assert_eq!(
            figure.matches("class=\"history\"").count(),
            8,
            "displacement, velocity, acceleration, force of two"
        );
        assert!(figure.contains("class=\"touching\"") && figure.contains("class=\"leaving\""), "{name}");
    }
    let page = fs::read_to_string(out.join("report.html"))?;
    let expected =
        ["modal model: the lowest 6", "Participation of linear modes", "id=\"participation\"", "P2: equal modal"];
    for text in expected {
        assert!(page.contains(text), "{text}");
    }
    Ok(())
}

#[test]
fn frequencies_that_cannot_be_imposed_are_refused_at_their_place() -> Outcome {
    let directory = tempfile::tempdir()?;
    let path = directory.path().join("scene.toml");
    let text = fs::read_to_string(configuration("rod.toml"))?;
    let cases = [
        ("60.0, 500.0", "elements = 100", "500 Hz, is not below the next mode"),
        ("1.0, 2.0, 3.0", "elements = 2", "frequencies of 3 modes are wanted, but the structure has 1 mode "),
        ("60.0", "elements = 3000", "2999 of them, 2000 at most"),
    ];
    for (frequencies, elements, message) in cases {
        let modes = format!("[structure.modes]\nfrequencies_hz = [{frequencies}]\n\n[structure.material]");
        let scene = text.replace("[structure.material]", &modes).replace("elements = 100", elements);
        fs::write(&path, scene)?;
        let (status, said) = call(&["modes", &path.display().to_string()])?;
        assert_eq!(status, 2, "{said}");
        assert!(said.contains(message) && said.contains(&format!("frequencies_hz = [{frequencies}]")), "{said}");
    }
    Ok(())
}

#[test]
fn updating_comes_before_imposing() -> Outcome {
    let directory = tempfile::tempdir()?;
    let path = directory.path().join("scene.toml");
    let text = fs::read_to_string(configuration("beam_updated.toml"))?;
    let modes = "[structure.modes]\nfrequencies_hz = [41.0]\n\n[structure.material]";
    fs::write(&path, text.replace("[structure.material]", modes))?;
    let (status, said) = call(&["modes", &path.display().to_string()])?;
    assert_eq!(status, 0, "{said}");
    // The modulus of Table 1 corresponds to 40.10 Hz of the elements.
    assert!(said.contains("became 1.813"), "{said}");
    let row = said.lines().find(|line| line.trim_start().starts_with("1 ")).ok_or("no first mode")?;
    let found: Vec<f64> = row.split_whitespace().filter_map(|x| x.parse().ok()).collect();
    assert!((found[2] - 41.0).abs() < 1e-7 && (found[4] - 40.10).abs() < 1e-5, "{row}");
    Ok(())
}
