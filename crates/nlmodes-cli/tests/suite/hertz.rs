//! Stops with a law of force from the command line.

use std::collections::HashMap;
use std::error::Error;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use tempfile::tempdir;

type Outcome = Result<(), Box<dyn Error>>;
type Table = Vec<HashMap<String, f64>>;

/// A cantilever before a stop at its tip, of which this is the law.
fn beam(law: &str) -> String {
    format!(
        "[structure]\nkind = \"beam\"\nlength_m = 0.7\nelements = 10\nstart = \"clamped\"\n[structure.material]\n\
        youngs_modulus_pa = 2.05e11\ndensity_kg_m3 = 7800.0\n[structure.section]\nwidth_m = 0.014\n\
        height_m = 0.014\n[method]\nharmonics = 15\n[output]\nfigures = false\npage = false\n\
        [[contact]]\nat_m = 0.7\ndirection = \"transverse\"\nside = \"positive\"\ngap_mm = 1.0\n{law}\n"
    )
}

const HERTZ: &str = "stiffness_hertz_n_m15 = 6e5";

const MODE: &str = "[continuation]\nmax_energy_ratio = 3.0\n";

fn forced(kind: &str) -> String {
    format!(
        "[damping]\nratio = 0.01\n[[force]]\nat_m = 0.35\ndirection = \"transverse\"\namplitude_n = 20.0\n\
        [[response]]\n{kind}\n"
    )
}

/// Runs a scene in a folder; a table of its results, numbers by column.
fn run(folder: &Path, text: &str) -> Result<[Table; 2], Box<dyn Error>> {
    fs::write(folder.join("scene.toml"), text)?;
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    let output = call.args(["run", "scene.toml", "--out", "out", "--force", "--quiet"]).current_dir(folder).output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = |file: &str| -> Result<Table, Box<dyn Error>> {
        let text = fs::read_to_string(folder.join("out").join(file))?;
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().ok_or("no header")?.split(',').collect();
        let row = |line: &str| -> HashMap<String, f64> {
            let cells = names.iter().zip(line.split(','));
            cells.map(|(name, cell)| ((*name).to_owned(), cell.parse().unwrap_or(f64::NAN))).collect()
        };
        Ok(lines.map(row).collect())
    };
    Ok([table("branch.csv")?, table("contacts.csv")?])
}

/// With the exponent one it is a stop on a spring, which is computed as a contact: the same mode and the same response,
/// and what is reported of the contact.
#[test]
fn a_stop_with_the_exponent_one_is_the_stop_on_a_spring() -> Outcome {
    let folder = tempdir()?;
    // Modes with laws of force follow internal resonances.
    let mode = [MODE.to_owned(), format!("{MODE}internal_resonance = \"follow\"\n")];
    let response = forced("kind = \"force\"\nfrequency_hz = [25.0]");
    for [with_law, with_spring] in [mode, [response.clone(), response]] {
        let last = |law: &str, rest: &str| -> Result<[HashMap<String, f64>; 2], Box<dyn Error>> {
            let tables = run(folder.path(), &(beam(law) + rest))?;
            let [points, stops] = tables.map(|table| table.last().cloned());
            Ok([points.ok_or("no points")?, stops.ok_or("no contacts")?])
        };
        let [point, stop] = last("stiffness_hertz_n_m15 = 2e4\nexponent = 1.0", &with_law)?;
        let [linear, spring] = last("stiffness_n_m = 2e4", &with_spring)?;
        for (key, tolerance) in [
            ("frequency_hz", 1e-7),
            ("energy_j", 2e-7),
            ("total_energy_j", 2e-7),
            ("peak_m", 1e-6),
            ("contact_fraction", 2e-5),
            // Beyond the harmonics the contact follows its own residual flexibility, and the law does not.
            ("peak_contact_force_n", 1e-5),
            ("impulse_ns", 1e-5),
        ] {
            assert!((point[key] / linear[key] - 1.0).abs() < tolerance, "{key}: {} {}", point[key], linear[key]);
        }
        for (key, tolerance) in [("mean_force_n", 1e-5), ("impulse_ns", 1e-5), ("approach_velocity_m_s", 1e-3)] {
            assert!((stop[key] / spring[key] - 1.0).abs() < tolerance, "{key}: {} {}", stop[key], spring[key]);
        }
        assert_eq!(stop["touches"], spring["touches"]);
    }
    Ok(())
}

/// A mode begins where the stop is first touched; dissipation is left out of it, and is in damped modes and responses.
#[test]
fn a_mode_begins_at_the_stop_and_a_response_loses_what_that_dissipates() -> Outcome {
    let folder = tempdir()?;
    let [points, stops] = run(folder.path(), &(beam(HERTZ) + MODE))?;
    assert!((points[0]["peak_m"] / 1e-3 - 1.0).abs() < 1e-9 && stops[0]["peak_force_n"] == 0.0, "{:?}", points[0]);
    let last = points.last().ok_or("no points")?;
    assert!(last["energy_j"] / points[0]["energy_j"] > 2.99 && last["peak_contact_force_n"] > 1.0);
    let dissipating = format!("{HERTZ}\ndissipation_s_m = 2.0");
    let [same, _] = run(folder.path(), &(beam(&dissipating) + MODE))?;
    let other = same.last().ok_or("no points")?;
    assert!((other["frequency_hz"] / last["frequency_hz"] - 1.0).abs() < 1e-12);
    let damped = "kind = \"damped-mode\"";
    let ratio = |law: &str| -> Result<f64, Box<dyn Error>> {
        let [points, _] = run(folder.path(), &(beam(law) + &forced(damped) + MODE))?;
        Ok(points.last().ok_or("no points")?["damping_ratio"])
    };
    let (elastic, lossy) = (ratio(HERTZ)?, ratio(&dissipating)?);
    assert!(elastic > 0.005 && lossy > elastic + 1e-3, "{elastic} {lossy}");
    let at_once = "kind = \"force\"\nfrequency_hz = [25.0]";
    let end = |law: &str| -> Result<HashMap<String, f64>, Box<dyn Error>> {
        let [points, _] = run(folder.path(), &(beam(law) + &forced(at_once)))?;
        Ok(points.last().cloned().ok_or("no points")?)
    };
    let (elastic, lossy) = (end(HERTZ)?, end(&dissipating)?);
    for point in [&elastic, &lossy] {
        assert!((point["input_power_w"] / point["dissipated_power_w"] - 1.0).abs() < 1e-8, "{point:?}");
        assert!(point["largest_multiplier"] < 1.0 || point["largest_multiplier"].is_nan());
    }
    assert!(lossy["peak_m"] < elastic["peak_m"], "{lossy:?} {elastic:?}");
    Ok(())
}

/// The motion of a response goes on in time as it is: the same touches in each period, from the state at its beginning.
#[test]
fn a_motion_in_time_from_a_response_before_such_a_stop_stays_on_it() -> Outcome {
    let folder = tempdir()?;
    let law = "stiffness_hertz_n_m15 = 6e5\ndissipation_s_m = 0.5";
    let beam = beam(law).replace("harmonics = 15", "harmonics = 25") + "[reduction]\nmodes = 5\n";
    let cubic = "[[spring]]\nat_m = 0.35\ndirection = \"transverse\"\nlaw = { polynomial = [0.0, 0.0, 1e8] }\n";
    let response = forced("kind = \"force\"\nfrequency_hz = [25.0]");
    let [points, stops] = run(folder.path(), &(beam.clone() + cubic + &response))?;
    let (point, stop) = (points.last().ok_or("no points")?, stops.last().ok_or("no contacts")?);
    assert_eq!((stop["touches"], points.len()), (1.0, stops.len()));
    let transient = format!(
        "[damping]\nratio = 0.01\n[transient]\nduration_s = 0.4\nfrom = {{ results = \"out\", point = {} }}\n\
        [[transient.load]]\nat_m = 0.35\ndirection = \"transverse\"\n\
        sine = {{ amplitude_n = 20.0, frequency_hz = 25.0 }}\n",
        points.len() - 1
    );
    fs::write(folder.path().join("transient.toml"), beam + cubic + &transient)?;
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    let output =
        call.args(["run", "transient.toml", "--out", "moved", "--quiet"]).current_dir(folder.path()).output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(folder.path().join("moved/touches.csv"))?;
    let touches: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    // It begins within a touch.
    assert_eq!(touches.len(), 11, "{text}");
    let whole = &touches[1..10];
    for (touch, next) in whole.iter().zip(&whole[1..]) {
        assert!((next[1] - touch[1] - 0.04).abs() < 1e-6, "{touch:?} {next:?}");
    }
    for touch in whole {
        assert_eq!(touch[0], 0.0);
        assert!((touch[2] / (0.04 * stop["contact_fraction"]) - 1.0).abs() < 1e-3, "{touch:?} {stop:?}");
        assert!((touch[3] / stop["impulse_ns"] - 1.0).abs() < 1e-4, "{touch:?} {stop:?}");
        assert!((touch[4] / stop["approach_velocity_m_s"] - 1.0).abs() < 1e-3, "{touch:?} {stop:?}");
    }
    assert!(point["peak_m"] > 1.1e-3);
    Ok(())
}

/// What does not work beside such a stop is refused at its key.
#[test]
fn what_a_stop_with_a_law_of_force_excludes_is_refused_by_name() -> Outcome {
    let folder = tempdir()?;
    let scene = beam(HERTZ) + MODE;
    let second = "[[contact]]\nat_m = 0.35\ndirection = \"transverse\"\nside = \"positive\"\ngap_mm = 1.0\n";
    let base = forced("kind = \"frequency\"\nfrequency_hz = [20.0, 25.0]\nlevels_m_s2 = [1.0]").replace(
        "[[force]]\nat_m = 0.35\ndirection = \"transverse\"\namplitude_n = 20.0\n",
        "[base_motion]\ndirection = \"transverse\"\nacceleration_m_s2 = 1.0\nstop = \"fixed\"\n",
    );
    let beside = |text: &str| scene.replace(HERTZ, &format!("{HERTZ}\n{text}"));
    let with = |text: &str| scene.clone() + text;
    for (text, said) in [
        (beside("stiffness_n_m = 1e5"), "`contact.0.stiffness_n_m` beside `stiffness_hertz_n_m15`"),
        (beside("damping_n_s_m = 1.0"), "`contact.0.damping_n_s_m` beside `stiffness_hertz_n_m15`"),
        (beside("friction_estimate = 0.3"), "`contact.0.friction_estimate` beside `stiffness_hertz_n_m15`"),
        (scene.replace(HERTZ, "exponent = 1.5"), "`contact.0.exponent` belongs to a stop with a law of force"),
        (with(second), "`contact.0` has a law of force, and `contact.1` none"),
        (scene.replace("harmonics = 15", "harmonics = 15\nmass_redistribution = \"drop\""), "keep their mass"),
        (beam(HERTZ) + &base, "is fixed while the base moves"),
    ] {
        fs::write(folder.path().join("scene.toml"), text)?;
        let output =
            Command::cargo_bin("nlmodes-cli")?.args(["check", "scene.toml"]).current_dir(folder.path()).output()?;
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && text.contains(said), "{said}: {text}");
    }
    Ok(())
}
