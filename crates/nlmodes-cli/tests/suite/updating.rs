//! `[updating]`: what the paper's Table 1 says about the modulus comes out of the configurations.

use std::error::Error;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::tempdir;

type Outcome = Result<(), Box<dyn Error>>;

/// Status, standard output and standard error.
fn call(arguments: &[&str]) -> Result<(Option<i32>, String, String), Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let output = Command::cargo_bin("nlmodes-cli")?.args(arguments).current_dir(workspace).output()?;
    Ok((output.status.code(), String::from_utf8(output.stdout)?, String::from_utf8(output.stderr)?))
}

#[test]
fn both_moduli_of_table_1_are_found_to_five_digits_and_on_record() -> Outcome {
    let hbm = ["method.kind=hbm", "method.mass_redistribution=none", "method.contact_stiffness_n_m=2.3e6"];
    for (set, expected) in [(&[][..], 181.36e9), (&hbm[..], 187.60e9)] {
        let out = tempdir()?;
        let directory = out.path().to_string_lossy().into_owned();
        let mut arguments = vec!["run", "configs/beam_updated.toml", "--out", &directory];
        set.iter().for_each(|set| arguments.extend(["--set", set]));
        arguments.extend(["--set", "continuation.max_energy_ratio=1.5"]);
        let (status, said, warned) = call(&arguments)?;
        assert_eq!(status, Some(0), "{warned}");
        assert!(said.starts_with("updated youngs_modulus_pa: 2.100000e11 became 1.8"), "{said}");
        let summary: Value = serde_json::from_str(&std::fs::read_to_string(out.path().join("summary.json"))?)?;
        let number = |path: &str| summary.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN);
        for path in ["/scene/updating/done/to/0", "/scene/structure/youngs_modulus"] {
            assert!((number(path) / expected - 1.0).abs() < 5e-6, "{path}: {}", number(path));
        }
        assert_eq!(number("/scene/updating/done/from/0"), 210e9);
        assert!((number("/grazing/frequency_hz") - 40.10).abs() < 1e-8, "{}", number("/grazing/frequency_hz"));
    }
    Ok(())
}

#[test]
fn a_length_takes_the_stop_along() -> Outcome {
    let set = ["--set", "updating.parameters=[\"length_m\"]"];
    let (status, said, warned) = call(&[&["modes", "configs/beam_updated.toml"][..], &set].concat())?;
    assert_eq!(status, Some(0), "{warned}");
    assert!(said.contains("updated length_m: 6.297552e-1 became 6.5328"), "{said}");
    assert!(said.contains("40.10000000"), "{said}");
    Ok(())
}

#[test]
fn check_computes_no_parameter_but_says_which_ones_would_be() -> Outcome {
    let (status, said, _) = call(&["check", "configs/beam_updated.toml"])?;
    assert_eq!(status, Some(0));
    assert!(said.contains("youngs_modulus_pa from mode 1 at 40.1 Hz") && said.contains("of 2.1e11 Pa"), "{said}");
    Ok(())
}

#[test]
fn parameters_that_frequencies_cannot_tell_apart_are_refused_at_their_place() -> Outcome {
    let set = [
        "--set",
        "updating.parameters=[\"length_m\",\"youngs_modulus_pa\"]",
        "--set",
        "updating.frequencies_hz=[40.1,268.62]",
        "--set",
        "updating.modes=[1,2]",
    ];
    let (status, _, said) = call(&[&["modes", "configs/beam_updated.toml"][..], &set].concat())?;
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("cannot tell the parameters apart") && said.contains("updating.parameters"), "{said}");
    let (status, _, said) = call(&["modes", "configs/beam_updated.toml", "--set", "updating.modes=[99]"])?;
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("mode 99 does not exist"), "{said}");
    Ok(())
}
