//! Calls, their exit status and what they print.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;

type Outcome = Result<(), Box<dyn Error>>;

fn call(arguments: &[&str]) -> Result<Output, Box<dyn Error>> {
    Ok(Command::cargo_bin("nlmodes-cli")?.args(arguments).current_dir(workspace()).output()?)
}

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn scenes_that_come_along_are_sound() -> Outcome {
    for scene in ["rod", "beam"].map(|name| format!("configs/{name}.toml")) {
        let output = call(&["check", &scene])?;
        assert_eq!(output.status.code(), Some(0));
        // The rule of the paper, by which contact nodes lose their mass, shifts the linear mode: this is the only
        // warning.
        let said = String::from_utf8(output.stderr)?;
        assert!(said.starts_with("warning: taking the mass of the contact nodes away (drop)"), "{scene}: {said}");
        assert_eq!(said.trim().lines().count(), 1, "{scene}: {said}");
    }
    let sound = [
        "rod_two_stops",
        "beam_two_stops",
        "beam_ten_stops",
        "measured_record",
        "beam_hbm",
        "beam_updated",
        "beam_modal",
    ];
    for scene in sound.map(|name| format!("configs/{name}.toml")) {
        let output = call(&["check", &scene])?;
        assert_eq!(String::from_utf8(output.stderr)?, "", "{scene}: with its mass, or at a measured frequency");
    }
    Ok(())
}

#[test]
fn mass_that_is_left_out_is_told_with_both_frequencies_and_what_helps() -> Outcome {
    let check = |elements: usize, rule: &str| {
        let (elements, rule) =
            (format!("structure.elements={elements}"), format!("method.mass_redistribution=\"{rule}\""));
        let uniform = ["--set", "structure.grading=1.0", "--set", elements.as_str(), "--set", rule.as_str()];
        call(&[&["check", "configs/beam_two_stops.toml"], &uniform[..]].concat())
    };
    let output = check(4, "drop")?;
    let (said, verdict) = (String::from_utf8(output.stderr)?, String::from_utf8(output.stdout)?);
    let one = "moves mode 1 from 39.4291 to 56.7027 Hz (+43.8 %): reduction.kind = \"open-modes\" keeps all of it";
    assert!(said.trim_end().ends_with(one) && said.trim_end().lines().count() == 1, "{said}");
    assert!(verdict.contains("can be computed, but see the warning") && !verdict.contains("is sound"), "{verdict}");
    // If the mass is kept, or changes little, there is no warning.
    let output = check(10, "conserve")?;
    assert_eq!(String::from_utf8(output.stderr)?, "");
    assert!(String::from_utf8(output.stdout)?.contains("The scene is sound"));
    Ok(())
}

/// A gap in another unit, which is possible: a scene with warnings is not called sound below them.
#[test]
fn a_scene_that_is_warned_of_is_not_called_sound() -> Outcome {
    let output = call(&["check", "configs/beam_updated.toml", "--set", "contact.0.gap_m=400.0"])?;
    let (said, verdict) = (String::from_utf8(output.stderr)?, String::from_utf8(output.stdout)?);
    assert!(said.contains("warning") && verdict.contains("but see the warning"), "{said}\n{verdict}");
    Ok(())
}

/// For records and virtual tests as for structures, before anything is computed.
#[test]
fn rows_of_what_is_laid_over_that_are_not_used_are_counted_by_check() -> Outcome {
    let folder = tempfile::tempdir()?;
    let table = folder.path().join("rig.csv");
    std::fs::write(&table, "frequency_hz,energy_j\n40,1e-3\n,2e-3\n")?;
    let overlay = format!("overlay=[{{path='{}'}}]", table.display());
    for scene in ["beam", "measured_record", "virtual_test"] {
        let output = call(&["check", &format!("configs/{scene}.toml"), "--set", &overlay])?;
        let said = String::from_utf8(output.stderr)?;
        assert!(output.status.success() && said.contains("1 of 2 rows is not used"), "{scene}: {said}");
        assert!(String::from_utf8(output.stdout)?.contains("but see the warning"), "{scene}");
    }
    Ok(())
}

/// Nothing is forbidden: the errors of the numbers, their sources and what makes them smaller are printed.
#[test]
fn a_plain_run_says_the_errors_of_its_numbers() -> Outcome {
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("out").display().to_string();
    let run = |scene: &str, settings: &[&str]| {
        let call = call(&[&["run", scene, "--set", "output.figures=false", "--out", &out], settings].concat())?;
        Ok::<String, Box<dyn Error>>(String::from_utf8(call.stdout)? + &String::from_utf8(call.stderr)?)
    };
    let text = run("configs/facing_rods.toml", &[])?;
    for part in ["Estimated errors, ", "frequency ±", "displacement ±", "impulse ±", "(7 harmonics)"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(text.contains("smaller with") && text.contains("--set method.harmonics=14"), "{text}");
    assert!(!text.contains("Do not use") && !text.contains("Not met"), "{text}");
    // With more harmonics internal resonances take up the branch but for its first points, which touch lightly.
    let text = run("configs/beam_two_stops.toml", &["--force"])?;
    for part in ["frequency, displacement, impulse, largest contact force not known", "more harmonics or an elastic"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // With the mass of the contacts left out that is the largest source of the frequency's error.
    let text = run("configs/beam.toml", &["--set", "output.require={ frequency = 1e-3 }", "--force"])?;
    let met = "0.10 % required: met at no compared point (4";
    for part in [met, "frequency (at least ±1.7 %, mass of the contacts left out", "reduction.kind=\"open-modes\""] {
        assert!(text.contains(part), "{part}: {text}");
    }
    Ok(())
}

#[test]
fn commands_that_do_not_exist_are_told_only_what_is_near() -> Outcome {
    for (typed, meant) in [("rnu", "run"), ("chek", "check"), ("mode", "modes")] {
        let said = String::from_utf8(call(&[typed, "a.toml"])?.stderr)?;
        assert!(said.contains(&format!("'{meant}'")), "{said}");
    }
    for typed in ["plot", "simulate", "draw"] {
        let said = String::from_utf8(call(&[typed, "a.toml"])?.stderr)?;
        assert!(!said.contains("similar") && said.contains("--help"), "{said}");
    }
    Ok(())
}

#[test]
fn check_says_what_would_be_computed() -> Outcome {
    let output =
        call(&["check", "configs/beam.toml", "--set", "method.harmonics=7", "--set", "structure.elements=10"])?;
    let said = String::from_utf8(output.stdout)?;
    for part in [
        "beam, 0.6297552 m long",
        "10 elements",
        "30 degrees of freedom",
        "gap 0.00103 m",
        "7 harmonics",
        "results/beam",
    ] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
    Ok(())
}

#[test]
fn wrong_calls_end_with_status_2() -> Outcome {
    for arguments in [
        &[][..],
        &["walk"],
        &["check"],
        &["check", "a.toml", "--fast"],
        &["run", "no/such/scene.toml"],
        &["check", "configs"],
    ] {
        let output = call(arguments)?;
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(!output.stderr.is_empty(), "{arguments:?}");
    }
    Ok(())
}

#[test]
fn help_and_version_end_with_status_0() -> Outcome {
    for arguments in [&["--help"][..], &["--version"], &["help", "run"], &["check", "--help"]] {
        assert_eq!(call(arguments)?.status.code(), Some(0), "{arguments:?}");
    }
    Ok(())
}

#[test]
fn messages_have_no_colours_where_nobody_sees_them() -> Outcome {
    let output = call(&["check", "no/such/scene.toml"])?;
    assert!(!output.stderr.contains(&0x1b));
    Ok(())
}

#[test]
fn a_scene_without_command_or_without_ending_is_told_what_to_write() -> Outcome {
    let folder = tempfile::tempdir()?;
    let scene = folder.path().join("bar.toml");
    let scene = scene.to_str().ok_or("a path that is no text")?;
    call(&["new", "rod", scene])?;
    let said = |arguments: &[&str]| -> Result<String, Box<dyn Error>> {
        let output = call(arguments)?;
        assert_eq!(output.status.code(), Some(2));
        Ok(String::from_utf8(output.stderr)?)
    };
    let without_command = said(&[scene])?;
    assert!(without_command.contains(&format!("nlmodes-cli run {scene}")), "{without_command}");
    let without_ending = said(&["check", scene.trim_end_matches(".toml")])?;
    assert!(without_ending.contains(&format!("`{scene}` is there")), "{without_ending}");
    Ok(())
}

#[test]
fn schema_is_json_and_knows_each_key() -> Outcome {
    let schema: serde_json::Value = serde_json::from_slice(&call(&["schema"])?.stdout)?;
    let study: serde_json::Value = serde_json::from_slice(&call(&["schema", "study"])?.stdout)?;
    assert!(study.pointer("/properties/vary/items/properties/key").is_some(), "{study}");
    let keys = [
        ("", "title structure contact method continuation output recording channel linear_modes extraction stop"),
        ("/properties/recording", "files sample_rate_hz time_column"),
        ("/properties/channel/items", "name quantity unit role position_m sign sensitivity delay_s range"),
        ("/properties/linear_modes", "frequencies_hz damping_ratios positions_m shapes"),
        ("/properties/extraction", "mode periods harmonics pbmif_harmonics frequency_hz"),
        ("/properties/stop", "position_m gap_m side"),
        ("/properties/structure/anyOf/0", "kind length_m elements grading mass_matrix start end material section"),
        ("/properties/structure/anyOf/0/properties/material", "youngs_modulus_pa density_kg_m3 poissons_ratio"),
        ("/properties/structure/anyOf/0/properties/section", "area_m2 second_moment_m4 width_m height_m shear_factor"),
        ("/properties/contact/items", "at_m direction side gap_m"),
        (
            "/properties/method/anyOf/0",
            "kind mode harmonics switching samples mass_redistribution contact_solver contact_stiffness_n_m symmetry \
             held_modes",
        ),
        ("/properties/continuation", "max_energy_ratio frequency_hz max_points start_frequency_hz direction"),
        ("/properties/output", "directory"),
    ];
    for (table, names) in keys {
        for name in names.split(' ') {
            let key = schema.pointer(&format!("{table}/properties/{name}"));
            let described = key.and_then(|key| key.get("description")).is_some();
            assert!(described, "{table}: {name}");
        }
    }
    Ok(())
}

/// A branch from 60 to 61 Hz.
#[test]
fn results_that_give_no_answer_give_a_status_and_say_so() -> Outcome {
    let folder = tempfile::tempdir()?;
    let table = folder.path().join("branch.csv");
    std::fs::write(&table, "point,frequency_hz,energy_j\n0,60,1\n1,61,2\n")?;
    let table = table.to_str().ok_or("a path that is no text")?;
    let at = |arguments: &[&str]| call(&[&["at", table], arguments].concat());
    let answer = |output: &Output| -> Result<String, Box<dyn Error>> {
        let curves: serde_json::Value = serde_json::from_slice(&output.stdout)?;
        Ok(curves[0]["answer"].as_str().ok_or("no answer")?.to_owned())
    };
    for (frequency, status, wanted) in [("60.5", 0, "passed"), ("62", 1, "not_passed")] {
        assert_eq!(at(&["--frequency-hz", frequency])?.status.code(), Some(status));
        let output = at(&["--frequency-hz", frequency, "--json"])?;
        assert_eq!((output.status.code(), answer(&output)?.as_str()), (Some(status), wanted));
    }
    let said = |arguments: &[&str]| -> Result<String, Box<dyn Error>> {
        let output = at(arguments)?;
        assert_eq!(output.status.code(), Some(2));
        Ok(String::from_utf8(output.stderr)?)
    };
    let text = said(&["--frequency-hz", "60Hz"])?;
    assert!(text.contains("expected a number with a decimal point and without its unit, as 50.5"), "{text}");
    let text = said(&["--level", "6"])?;
    assert!(
        text.contains("--frequency-hz 50") && text.contains("--energy-j") && !text.contains("as a value"),
        "{text}"
    );
    assert!(said(&["--energy", "6"])?.contains("'--energy-j'"));
    let other = call(&["at", "configs/rod.toml", "--energy-j", "1"])?;
    assert_eq!(other.status.code(), Some(2));
    assert!(
        String::from_utf8(other.stderr)?.contains("expected a directory that `run` has written, or the branch.csv")
    );
    let missing = call(&["at", "no/such/results", "--energy-j", "1"])?;
    assert_eq!(String::from_utf8(missing.stderr)?.trim(), "error: there is no no/such/results");
    Ok(())
}

/// There is a blank between any two titles, and each is above its column.
#[test]
fn titles_of_linear_modes_stand_apart_with_each_rule() -> Outcome {
    for rule in ["drop", "move", "conserve"] {
        let set = format!("method.mass_redistribution={rule}");
        let output = call(&["modes", "configs/beam.toml", "--set", &set])?;
        let text = String::from_utf8(output.stdout)?;
        let head = text.lines().find(|line| line.contains("contact mass kept")).ok_or("no head")?;
        let titles: Vec<&str> = head.split("  ").map(str::trim).filter(|title| !title.is_empty()).collect();
        let own = format!("contact mass: {rule}");
        assert_eq!(titles[..4], ["mode", "contact mass kept", own.as_str(), "contacts held"], "{head}");
        let row = text.lines().find(|line| line.trim_start().starts_with("1 ")).ok_or("no row")?;
        for title in [own.as_str(), "contacts held"] {
            let end = head.find(title).ok_or("no title")? + title.len();
            assert!(row[..end].ends_with(|c: char| c.is_ascii_digit()) && row[end..].starts_with("  "), "{row}");
        }
    }
    Ok(())
}
