//! `verify`: a point of a run started in the full structure.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

/// A rod of four elements: small enough for its motion to be found exactly next to a point.
const SMALL: [&str; 4] =
    ["structure.elements=4", "title=T", "continuation.max_energy_ratio=1.5", "continuation.frequency_hz=[40.0, 90.0]"];

fn call(arguments: &[&str]) -> Result<Output, Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    Ok(Command::cargo_bin("nlmodes-cli")?.args(arguments).current_dir(workspace).output()?)
}

fn results(set: &[&str]) -> Result<TempDir, Box<dyn Error>> {
    let out = tempdir()?;
    let path = out.path().to_string_lossy();
    let mut arguments = vec!["run", "configs/rod.toml", "--quiet", "--out", &path];
    SMALL.iter().chain(set).for_each(|value| arguments.extend(["--set", value]));
    let output = call(&arguments)?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(out)
}

fn verify(directory: &Path, point: &str) -> Result<(Option<i32>, String, String), Box<dyn Error>> {
    let output = call(&["verify", &directory.to_string_lossy(), "--point", point])?;
    Ok((output.status.code(), String::from_utf8(output.stdout)?, String::from_utf8(output.stderr)?))
}

/// The first number behind a label.
fn number(text: &str, label: &str) -> Option<f64> {
    text.split_once(label)?.1.split_whitespace().next()?.parse().ok()
}

fn last_point(directory: &Path) -> Result<(String, f64), Box<dyn Error>> {
    let table = fs::read_to_string(directory.join("branch.csv"))?;
    let row = table.lines().last().ok_or("an empty table")?;
    let cells: Vec<&str> = row.split(',').collect();
    Ok((cells[0].to_owned(), cells[1].parse()?))
}

#[test]
fn more_harmonics_return_better_and_the_exact_motion_is_told() -> Outcome {
    let mut missing = Vec::new();
    for harmonics in ["method.harmonics=5", "method.harmonics=40"] {
        let out = results(&[harmonics])?;
        let (point, frequency) = last_point(out.path())?;
        let (status, text, error) = verify(out.path(), &point)?;
        assert_eq!(status, Some(0), "{error}");
        missing.push(number(&text, "in the energy norm").ok_or("no energy norm")?);
        assert!(number(&text, "energy drift of the integration").is_some_and(|d| d < 1e-12), "{text}");
        // By another way: the difference of the two frequencies printed.
        let exact = number(&text, "by shooting\n  frequency").ok_or("no exact motion")?;
        let error = number(&text, "frequency of the point less that").ok_or("no frequency error")?;
        // Frequencies are printed with 12 digits, their difference with three.
        assert!((frequency / exact - 1.0 - error).abs() < 0.01 * error.abs() + 1e-11, "{text}");
        assert!(error.abs() < 1e-2 * missing[missing.len() - 1], "{text}");
        assert!(text.contains("stable"), "{text}");
    }
    assert!(missing[0] > 1e-3 && missing[1] < 1e-3 * missing[0], "{missing:?}");
    Ok(())
}

#[test]
fn conventional_harmonic_balance_and_motions_without_symmetry_are_verified_too() -> Outcome {
    let soft = ["method.kind=hbm", "method.mass_redistribution=none", "method.contact_stiffness_n_m=1e11"];
    for set in [&soft[..], &["method.symmetry=none"]] {
        let set: Vec<&str> = set.iter().copied().chain(["method.harmonics=40"]).collect();
        let out = results(&set)?;
        let (point, _) = last_point(out.path())?;
        let (status, text, error) = verify(out.path(), &point)?;
        assert_eq!(status, Some(0), "{error}");
        assert!(number(&text, "in the energy norm").is_some_and(|m| m < 1e-4), "{text}");
    }
    Ok(())
}

#[test]
fn what_is_no_result_is_refused_with_the_reason() -> Outcome {
    let out = results(&["method.harmonics=3"])?;
    let expect = |point: &str, reason: &str| -> Outcome {
        let (status, text, error) = verify(out.path(), point)?;
        assert_eq!((status, text.as_str()), (Some(2), ""), "{error}");
        assert!(error.contains(reason), "{error}");
        Ok(())
    };
    expect("99999", "there is no point 99999: the branch has the points 0 to")?;
    let summary = fs::read_to_string(out.path().join("summary.json"))?;
    let foreign = summary.replace("\"elements\": 4", "\"elements\": 6");
    assert_ne!(summary, foreign);
    fs::write(out.path().join("summary.json"), foreign)?;
    expect("0", "harmonics.npz does not belong to summary.json: degrees of freedom 4, expected 6")?;
    fs::write(out.path().join("summary.json"), summary.replace("\"elements\": 4", "\"elements\": 4000000000"))?;
    expect("0", "4000000000 degrees of freedom")?;
    fs::write(out.path().join("summary.json"), "{}")?;
    expect("0", "is not a summary of `nlmodes-cli run`")?;
    fs::write(out.path().join("summary.json"), &summary)?;
    fs::write(out.path().join("harmonics.npz"), "PK no archive")?;
    expect("0", "not a NumPy archive")?;
    fs::remove_file(out.path().join("harmonics.npz"))?;
    expect("0", "there is no harmonics.npz here")?;
    fs::remove_file(out.path().join("summary.json"))?;
    expect("0", "there is no summary.json here")?;
    let (status, _, error) = verify(&out.path().join("branch.csv"), "0")?;
    assert!(status == Some(2) && error.contains("this is a file; expected the directory"), "{error}");
    let (status, _, error) = verify(&out.path().join("nowhere"), "0")?;
    assert!(status == Some(2) && error.contains("there is no such directory"), "{error}");
    Ok(())
}

#[test]
fn a_run_with_several_numbers_of_harmonics_names_its_folders() -> Outcome {
    let out = results(&["method.harmonics=[1, 2]"])?;
    let (status, _, error) = verify(out.path(), "0")?;
    assert!(
        status == Some(2) && error.contains("give the folder of one") && error.contains("h1") && error.contains("h2"),
        "{error}"
    );
    assert_eq!(verify(&out.path().join("h2"), "0")?.0, Some(0));
    Ok(())
}
