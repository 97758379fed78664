//! Gravity, constant forces and heat from the command line.

use std::collections::HashMap;
use std::error::Error;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

/// A cantilever of 1 m above a rigid ledge at its tip.
const LEDGE: &str = "[structure]\nkind = \"beam\"\nlength_m = 1.0\nelements = 10\nstart = \"clamped\"\n\
    material = { youngs_modulus_pa = 2.1e11, density_kg_m3 = 7800.0, poissons_ratio = 0.3 }\n\
    section = { area_m2 = 2.4e-4, second_moment_m4 = 8e-9, shear_factor = 0.8333333333333334 }\n\
    [[contact]]\nat_m = 1.0\ndirection = \"transverse\"\nside = \"negative\"\ngap_m = 0.0\n\
    [method]\nharmonics = 1\nmass_redistribution = \"drop\"\n[continuation]\nmax_energy_ratio = 5.0\n";

const WEIGHT: &str = "[gravity]\nacceleration_m_s2 = 9.81\ndirection = \"transverse\"\nside = \"negative\"\n";

/// `w L⁴/(8 E I) + w L²/(2 κ G A)`, m, of the weight `w` per length; exact at the nodes of Timoshenko elements.
const SAG: f64 = {
    let weight = 7800.0 * 2.4e-4 * 9.81;
    weight / (8.0 * 2.1e11 * 8e-9) + weight / (2.0 * 0.8333333333333334 * 2.1e11 / 2.6 * 2.4e-4)
};

/// A rod of 1 m before a stop at its end.
const ROD: &str = "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 10\nstart = \"clamped\"\n\
    material = { youngs_modulus_pa = 2.1e11, density_kg_m3 = 7800.0 }\nsection = { area_m2 = 1e-4 }\n\
    [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 0.4e-3\n\
    [method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 1.5\n";

fn scene(folder: &TempDir, text: &str) -> Result<std::path::PathBuf, Box<dyn Error>> {
    let path = folder.path().join("scene.toml");
    fs::write(&path, text)?;
    Ok(path)
}

fn call(command: &str, scene: &Path, more: &[&str]) -> Result<(Option<i32>, String), Box<dyn Error>> {
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    let folder = scene.parent().ok_or("no folder")?;
    let output = call.arg(command).arg(scene).args(more).current_dir(folder).output()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    Ok((output.status.code(), text))
}

fn run(text: &str, set: &[&str]) -> Result<(TempDir, serde_json::Value), Box<dyn Error>> {
    let folder = tempdir()?;
    let path = scene(&folder, text)?;
    let mut more = vec!["--quiet", "--out", "out"];
    set.iter().for_each(|value| more.extend(["--set", value]));
    let (code, said) = call("run", &path, &more)?;
    assert_eq!(code, Some(0), "{said}");
    let summary = serde_json::from_str(&fs::read_to_string(folder.path().join("out/summary.json"))?)?;
    Ok((folder, summary))
}

/// A row of `branch.csv`, by the names of its columns; cells without a number are NaN.
type Row = HashMap<String, f64>;

fn rows(folder: &TempDir) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut reader = csv::Reader::from_path(folder.path().join("out/branch.csv"))?;
    let rows: Result<Vec<HashMap<String, String>>, csv::Error> = reader.deserialize().collect();
    let number = |(name, cell): (String, String)| (name, cell.parse().unwrap_or(f64::NAN));
    let rows: Vec<Row> = rows?.into_iter().map(|row| row.into_iter().map(number).collect()).collect();
    if rows.is_empty() { Err("no points".into()) } else { Ok(rows) }
}

/// The numbers of a text, in its order.
fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().filter_map(|word| word.trim_end_matches([',', ';']).parse().ok()).collect()
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Force, frequency, energy of lift-off and the end of the branch were computed elsewhere, from the matrices of ten
/// Timoshenko elements.
#[test]
fn a_heavy_cantilever_lies_on_its_ledge() -> Outcome {
    let (folder, summary) = run(&format!("{LEDGE}{WEIGHT}"), &[])?;
    let (rest, grazing) = (&summary["rest"][0], &summary["grazing"]);
    assert!((number(&rest["free_gap_m"]) / -SAG - 1.0).abs() < 1e-9, "{rest}");
    assert!((number(&rest["force_n"]) / 6.887_335_985_09 - 1.0).abs() < 1e-9, "{rest}");
    assert_eq!((rest["closed"].as_bool(), rest["clearance_m"].as_f64()), (Some(true), Some(0.0)));
    assert!((number(&grazing["frequency_hz"]) / 73.395_632_377_7 - 1.0).abs() < 1e-9, "{grazing}");
    assert!((number(&grazing["energy_j"]) / 2.551_653_349_35e-4 - 1.0).abs() < 1e-9, "{grazing}");
    assert_eq!(
        (summary["events"][0]["event"].as_str(), summary["events"][0]["point"].as_u64()),
        (Some("lift-off"), Some(0))
    );
    let rows = rows(&folder)?;
    let last = rows.last().ok_or("no points")?;
    assert!((last["frequency_hz"] / 63.894_765 - 1.0).abs() < 1e-7, "{last:?}");
    // Displacements count from the drawing, where the tip just touches, and energies from rest.
    assert!(rows.iter().all(|row| row["peak_m"].abs() < 1e-12), "{rows:?}");
    let first = &rows[0];
    assert!((first["total_energy_j"] / (2.0 * first["energy_j"]) - 1.0).abs() < 1e-6, "{first:?}");
    let (_, said) = call("check", &folder.path().join("scene.toml"), &[])?;
    assert!(said.contains("gap -0.00136696 m under the loads with open stops; closed, 6.88734 N"), "{said}");
    Ok(())
}

/// The motion is that of the structure with the gap that the load leaves, and `verify` finds it in the files.
#[test]
fn loads_are_gaps() -> Outcome {
    let hung = LEDGE.replace("gap_m = 0.0", "gap_m = 3e-3");
    let (loaded, _) = run(&format!("{hung}{WEIGHT}"), &[])?;
    let left = 3e-3 - SAG;
    let (by_hand, _) = run(&hung, &[&format!("contact.0.gap_m={left:e}")])?;
    let (a, b) = (rows(&loaded)?, rows(&by_hand)?);
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert!(
            (a["frequency_hz"] / b["frequency_hz"] - 1.0).abs() < 1e-8
                && (a["total_energy_j"] / b["total_energy_j"] - 1.0).abs() < 1e-7,
            "{a:?} {b:?}"
        );
        assert!((a["peak_m"] - b["peak_m"] - (3e-3 - left)).abs() < 1e-10, "{a:?} {b:?}");
    }
    // Missing after a period of the full structure, drift, force, exact motion: with displacements that count from
    // another place they would be those of another motion.
    let point = (a.len() - 1).to_string();
    let verified = |folder: &TempDir| call("verify", &folder.path().join("out"), &["--point", &point]);
    let [(_, a), (_, b)] = [verified(&loaded)?, verified(&by_hand)?];
    let [a, b] = [a, b].map(|said| numbers(&said));
    assert!(a.len() > 8 && a.len() == b.len(), "{a:?} {b:?}");
    // Drifts are rounding.
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-4 * a.abs().max(1e-6);
    assert!(a.iter().zip(&b).all(close), "{a:?} {b:?}");
    Ok(())
}

/// `F = E A (α ΔT − g/L)`; a push by the same force closes the gap just as far; in free-interface modes and in those
/// of the paper.
#[test]
fn a_rod_that_grows_into_its_stop_is_pressed() -> Outcome {
    let thermal = format!("{ROD}[thermal]\nexpansion_1_k = 1.2e-5\ntemperature_k = 50.0\n");
    let pushed = format!("{ROD}[[static_force]]\nat_m = 1.0\nforce_kn = 12.6\n");
    for (text, set) in [
        (&thermal, &["method.mode=1"][..]),
        (&thermal, &["method.mass_redistribution=\"drop\""]),
        (&pushed, &["method.mode=1"]),
    ] {
        let (folder, summary) = run(text, set)?;
        let rest = &summary["rest"][0];
        assert!((number(&rest["force_n"]) / 4200.0 - 1.0).abs() < 1e-9, "{rest}");
        assert!((number(&rest["free_gap_m"]) / -0.2e-3 - 1.0).abs() < 1e-9, "{rest}");
        // At rest and at the first point the end is at its stop, 0.4 mm beyond the drawing.
        assert!((rows(&folder)?[0]["peak_m"] / 0.4e-3 - 1.0).abs() < 1e-6);
    }
    Ok(())
}

/// A load in a direction in which no contact moves changes nothing.
#[test]
fn a_load_that_moves_no_contact_changes_no_motion() -> Outcome {
    let hung = LEDGE.replace("gap_m = 0.0", "gap_m = 1e-3");
    let (plain, _) = run(&hung, &[])?;
    let (loaded, _) = run(&format!("{hung}[gravity]\ndirection = \"axial\"\n"), &[])?;
    let (plain, loaded) = (rows(&plain)?, rows(&loaded)?);
    assert_eq!(plain.len(), loaded.len());
    for (a, b) in plain.iter().zip(&loaded) {
        for name in ["frequency_hz", "energy_j", "total_energy_j", "peak_m", "peak_contact_force_n", "impulse_ns"] {
            assert!((a[name] - b[name]).abs() <= 1e-12 * a[name].abs().max(1e-12), "{name}: {a:?} {b:?}");
        }
    }
    Ok(())
}

/// A force response about a structure that hangs closer to its stop: amplitudes count from the drawing, the powers
/// balance.
#[test]
fn responses_take_static_loads() -> Outcome {
    let text = LEDGE.replace("gap_m = 0.0", "gap_m = 2e-3").replace("mass_redistribution = \"drop\"\n", "")
        + WEIGHT
        + "[damping]\nratio = 0.02\n[[force]]\nat_m = 0.5\namplitude_n = 1.0\n\
           [response]\nkind = \"frequency\"\nfrequency_hz = [10.0, 30.0]\n[output]\nstability = \"never\"\n";
    let (folder, summary) = run(&text, &[])?;
    let rest = &summary["rest"][0];
    assert!((number(&rest["free_gap_m"]) / (2e-3 - SAG) - 1.0).abs() < 1e-9, "{rest}");
    let rows = rows(&folder)?;
    assert!(rows.iter().all(|row| row["peak_m"] > 1.366e-3 && row["peak_m"] < 2e-3 + 1e-9), "{rows:?}");
    assert!(rows.iter().any(|row| (row["peak_m"] - 2e-3).abs() < 1e-9));
    assert!(rows.iter().all(|row| (row["input_power_w"] / row["dissipated_power_w"] - 1.0).abs() < 1e-9));
    Ok(())
}

/// About a rest on the ledge: the conservative mode as a response has the end of that as a branch, which is computed in
/// another way; phase resonance begins at the linear mode of the closed ledge, lags by a quarter of a turn with powers
/// in balance, and lies on the response at its level; the damped mode begins where the conservative one does.
#[test]
fn modes_phase_resonance_and_responses_begin_at_closed_stops() -> Outcome {
    let text = LEDGE.replace("mass_redistribution = \"drop\"\n", "").replace("harmonics = 1", "harmonics = 5")
        + WEIGHT
        + "[output]\nstability = \"never\"\n";
    let set = ["continuation.max_energy_ratio=1.5"];
    let (conservative, _) = run(&text, &set)?;
    let conservative = rows(&conservative)?;
    let damped = "[damping]\nratio = 0.01\n[[force]]\nat_m = 0.5\n";
    let response = |text: &str| run(&format!("{text}{damped}"), &set);
    let (mode, _) = response(&format!("{text}[[response]]\nkind = \"mode\"\n[[response]]\nkind = \"damped-mode\"\n"))?;
    let all = rows(&mode)?;
    let of = |number: f64| all.iter().filter(|row| row["curve"] == number).collect::<Vec<_>>();
    let (modes, damped_mode) = (of(0.0), of(1.0));
    let ends = [conservative.last(), modes.last().copied()].map(|row| row.map_or(f64::NAN, |row| row["frequency_hz"]));
    assert!((ends[0] / ends[1] - 1.0).abs() < 1e-8, "{ends:?}");
    let starts =
        [conservative.first(), damped_mode.first().copied()].map(|row| row.map_or(f64::NAN, |row| row["energy_j"]));
    assert!((starts[0] / starts[1] - 1.0).abs() < 1e-6, "{starts:?}");
    let (forced, _) = response(&format!(
        "{text}[[response]]\nkind = \"phase-resonance\"\nlevels_n = [0.1, 0.3]\n\
         [[response]]\nkind = \"frequency\"\nfrequency_hz = [60.0, 78.0]\nlevels_n = [0.1]\n"
    ))?;
    let all = rows(&forced)?;
    let resonances: Vec<_> = all.iter().filter(|row| row["curve"] == 0.0).collect();
    assert!(
        (resonances[0]["frequency_hz"] / conservative[0]["frequency_hz"] - 1.0).abs() < 1e-4,
        "{:?}",
        resonances[0]
    );
    for row in &all {
        assert!((row["input_power_w"] / row["dissipated_power_w"] - 1.0).abs() < 1e-9, "{row:?}");
    }
    assert!(resonances.iter().all(|row| (row["drive_lag_deg"] - 90.0).abs() < 1e-6));
    // The largest energy on the response is that at phase resonance, where damping is weak.
    let energy = |rows: &mut dyn Iterator<Item = &Row>| rows.map(|row| row["energy_j"]).fold(0.0, f64::max);
    let at_level = resonances[0]["energy_j"] * (0.1 / resonances[0]["level"]).powi(2);
    let largest = energy(&mut all.iter().filter(|row| row["curve"] == 1.0));
    assert!((largest / at_level - 1.0).abs() < 0.02, "{largest} {at_level}");
    Ok(())
}

/// A force on a rigid stop that stays closed does no work: its force is the weight's and its own, no amplitude and no
/// balance of powers is stated; at mid-span both are.
#[test]
fn a_force_on_a_closed_stop_does_no_work() -> Outcome {
    let text = format!("{LEDGE}{WEIGHT}[damping]\nratio = 0.01\n[[force]]\ndirection = \"transverse\"\n")
        .replace("mass_redistribution = \"drop\"\n", "")
        .replace("[continuation]\nmax_energy_ratio = 5.0\n", "")
        + "[output]\nstability = \"never\"\n";
    for (at_m, works) in [(1.0, false), (0.5, true)] {
        let force = text.replace("[[force]]\n", &format!("[[force]]\nat_m = {at_m}\n"));
        let (folder, summary) = run(
            &format!("{force}[response]\nkind = \"frequency\"\nfrequency_hz = [60.0, 80.0]\nlevels_n = [0.02]\n"),
            &[],
        )?;
        let imbalance = &summary["largest_power_imbalance"];
        assert_eq!(imbalance.as_f64().is_some_and(|most| most < 1e-9), works, "{imbalance}");
        assert_eq!(imbalance.is_null(), !works, "{imbalance}");
        for row in rows(&folder)? {
            assert_eq!((row["fundamental_m"], row["contact_fraction"]), (0.0, 1.0), "{row:?}");
            assert!(works || (row["peak_contact_force_n"] / 6.907_335_985_09 - 1.0).abs() < 1e-9, "{row:?}");
        }
        let peak = &summary["levels"][0]["peak"];
        assert_eq!(peak["amplitude_m"].as_f64(), Some(0.0), "{peak}");
        assert!(number(&peak["peak_contact_force_n"]) > 6.9, "{peak}");
    }
    Ok(())
}

/// Stops that press are told from those of a drawing without loads.
#[test]
fn check_speaks_of_loads_where_there_are_any() -> Outcome {
    for (load, gap) in [("", "gap -0.001 m in the drawing"), (WEIGHT, "gap -0.00236696 m under the loads")] {
        let folder = tempdir()?;
        let text = LEDGE.replace("gap_m = 0.0", "gap_m = -1e-3");
        let (code, said) = call("check", &scene(&folder, &format!("{text}{load}"))?, &[])?;
        assert!(code == Some(0) && said.contains(gap) && said.contains("mode 1 from lift-off"), "{said}");
    }
    Ok(())
}

/// About the rest the structure vibrates with its stop closed: as its elements do with the node of the stop held.
#[test]
fn the_frequencies_about_the_rest_are_listed() -> Outcome {
    let kept = LEDGE.replace("mass_redistribution = \"drop\"\n", "");
    let (folder, summary) = run(&format!("{kept}{WEIGHT}[reduction]\nmodes = 10\n"), &[])?;
    let linear = &summary["linear_frequencies_hz"];
    let [rest, held] = ["about_rest", "contacts_held"].map(|of| number(&linear[of][0]));
    assert!((rest / held - 1.0).abs() < 1e-5, "{linear}");
    let (_, said) = call("check", &folder.path().join("scene.toml"), &[])?;
    assert!(said.contains(" Hz, contacts open; 73.39") && said.contains(" Hz about the rest"), "{said}");
    Ok(())
}

/// With many harmonics the end rattles on its ledge, and the mode bends within less than a millionth of its steps.
#[test]
fn a_damped_mode_is_followed_where_it_rattles() -> Outcome {
    let text = LEDGE.replace("mass_redistribution = \"drop\"\n", "").replace("harmonics = 1", "harmonics = 15")
        + WEIGHT
        + "[damping]\nratio = 0.01\n[[force]]\nat_m = 0.5\n[response]\nkind = \"damped-mode\"\n\
           [output]\nstability = \"never\"\nfigures = false\npage = false\n";
    let (folder, _) = run(&text, &["continuation.max_energy_ratio=2.0"])?;
    let rows = rows(&folder)?;
    let last = rows.last().ok_or("no points")?;
    assert!((last["energy_j"] / rows[0]["energy_j"] - 2.0).abs() < 1e-6, "{last:?}");
    Ok(())
}

/// A mass of 1 kg on 1 N/m with a tip of 20 N/m before a rigid stop, with a second mode that its row does not see.
fn mass_with_tip(gap_m: f64, more: &str) -> String {
    format!(
        "[structure]\nkind = \"reduced\"\nfrequencies_hz = [0.15915494309189535, 50.0]\n\
         contact_rows = [[1.0, 0.0]]\nresidual_flexibility_m_n = [[0.05]]\n\
         [[contact]]\nrow = 1\ngap_m = {gap_m}\n[method]\nharmonics = 30\n\
         [continuation]\nmax_energy_ratio = 10.0\n[output]\nstability = \"never\"\n{more}"
    )
}

/// Damping by the mass alone, which moves no mode, and the damped mode.
const BY_MASS: &str = "[damping]\nrayleigh = { mass_1_s = 0.1 }\n[[response]]\nkind = \"damped-mode\"\n";

/// Angular frequency of that mass where it is pressed with 1 N, of this amplitude about rest into the stop: on both
/// springs until the force is gone, then on its own.
fn pressed(amplitude: f64) -> f64 {
    let both = 21.0_f64.sqrt();
    let closed = (-0.05 / amplitude).acos();
    let speed = amplitude * both * closed.sin();
    let open = (1.05 / 1.05_f64.hypot(speed)).acos();
    std::f64::consts::PI / (closed / both + open)
}

/// The conservative mode, the damped one of the same frequencies, `D = c/(2ω)`, and one value that was computed
/// elsewhere.
#[test]
fn a_pressed_mass_has_the_frequencies_of_its_two_parts() -> Outcome {
    assert!((pressed(0.15) / 3.239_040_111_081_4 - 1.0).abs() < 1e-13);
    for more in ["", BY_MASS] {
        let (folder, summary) = run(&mass_with_tip(-1.05, more), &[])?;
        assert!((number(&summary["rest"][0]["force_n"]) - 1.0).abs() < 1e-12, "{}", summary["rest"]);
        let rows = rows(&folder)?;
        assert!((rows[0]["frequency_hz"] * std::f64::consts::TAU / 21.0_f64.sqrt() - 1.0).abs() < 1e-9);
        for row in &rows[1..] {
            let (omega, amplitude) =
                (row["frequency_hz"] * std::f64::consts::TAU, (row["peak_contact_force_n"] - 1.0) / 20.0);
            assert!((omega / pressed(amplitude) - 1.0).abs() < 1e-5, "{row:?}");
            // ½ k a² about rest, of its own motion alone.
            if more.is_empty() {
                let expected = pressed((row["total_energy_j"] / 10.5).sqrt());
                assert!((omega / expected - 1.0).abs() < 1e-7, "{row:?}");
            } else {
                assert!((row["damping_ratio"] / (0.1 / (2.0 * omega)) - 1.0).abs() < 1e-6, "{row:?}");
            }
        }
    }
    Ok(())
}

/// Angular frequency of a mass of 1 kg on 1 N/m pressed by 0.05 m into a stop of 20 N/m on either side, of this
/// amplitude: on both stops up to 0.05 m, beyond on one of them.
fn between_stops(amplitude: f64) -> f64 {
    let (both, one) = (41.0_f64.sqrt(), 21.0_f64.sqrt());
    if amplitude <= 0.05 {
        return both;
    }
    // x + 20 (x + 0.05) is 21 (x + 1/21): beyond 0.05 m a motion about −1/21 m.
    let (centre, beyond) = (1.0 / 21.0, amplitude + 1.0 / 21.0);
    let outside = ((0.05 + centre) / beyond).acos();
    let speed = beyond * one * outside.sin();
    let inside = (0.05 * both).atan2(speed);
    std::f64::consts::FRAC_PI_2 / (outside / one + inside / both)
}

/// Two elastic stops that press a mass between them: both have their whole stiffness up to the amplitude at which one
/// is left. Frequency, energy ½ k x² + ½ k_c Σ (…)² from rest, and the largest displacement are those of its pieces.
#[test]
fn a_mass_is_pressed_between_two_stops() -> Outcome {
    for (amplitude, omega) in [(0.05, 6.4031), (0.1, 5.7537), (1.0, 4.7191)] {
        assert!((between_stops(amplitude) / omega - 1.0_f64).abs() < 1e-5);
    }
    let stop = |side: &str| format!("[[contact]]\nrow = 1\nside = \"{side}\"\ngap_m = -0.05\nstiffness_n_m = 20.0\n");
    let text = format!(
        "[structure]\nkind = \"reduced\"\nfrequencies_hz = [0.15915494309189535, 50.0]\n\
         contact_rows = [[1.0, 0.0]]\nresidual_flexibility_m_n = [[0.0]]\n{}{}[method]\nharmonics = 30\n\
         [continuation]\nmax_energy_ratio = 1000.0\n[output]\nstability = \"never\"\n",
        stop("positive"),
        stop("negative"),
    );
    for more in ["", BY_MASS] {
        let (folder, summary) = run(&format!("{text}{more}"), &[])?;
        let rest = [0, 1].map(|i| number(&summary["rest"][i]["force_n"]));
        assert!(rest.iter().all(|force| (force - 1.0).abs() < 1e-12), "{rest:?}");
        let rows = rows(&folder)?;
        for row in &rows {
            let (omega, amplitude) = (row["frequency_hz"] * std::f64::consts::TAU, row["peak_m"]);
            assert!((omega / between_stops(amplitude) - 1.0).abs() < 1e-5, "{row:?}");
            assert!((row["peak_contact_force_n"] / (20.0 * (amplitude + 0.05)) - 1.0).abs() < 1e-9, "{row:?}");
            if more.is_empty() {
                let stops = 20.0 * amplitude.powi(2).min(0.5 * (amplitude + 0.05).powi(2) - 0.0025);
                let energy = 0.5 * amplitude.powi(2) + stops;
                assert!((row["total_energy_j"] / energy - 1.0).abs() < 1e-4, "{row:?}");
            }
        }
        let last = rows.last().ok_or("no points")?;
        assert!((rows[0]["peak_m"] / 0.05 - 1.0).abs() < 1e-9 && last["peak_m"] > 1.0, "{last:?}");
    }
    Ok(())
}

/// Before a stop that touches at rest without force all amplitudes have the frequency `2ω₀ω₁/(ω₀ + ω₁)`, also damped;
/// phase resonance is as large as its level.
#[test]
fn modes_and_phase_resonance_begin_at_stops_without_a_gap() -> Outcome {
    let force = "[[response]]\nkind = \"mode\"\n[[response]]\nkind = \"phase-resonance\"\ndrive_row = 1\n\
        levels_n = [1e-3, 0.1]\n[[force]]\nrow = 1\namplitude_n = 1.0\n";
    let (folder, _) = run(&mass_with_tip(0.0, &format!("{BY_MASS}{force}")), &[])?;
    let all = rows(&folder)?;
    let omega = |row: &Row| row["frequency_hz"] * std::f64::consts::TAU;
    let both = 21.0_f64.sqrt();
    for row in all.iter().filter(|row| row["curve"] < 2.0) {
        assert!((omega(row) / (2.0 * both / (1.0 + both)) - 1.0).abs() < 1e-6, "{row:?}");
        if row["curve"] == 0.0 {
            assert!((row["damping_ratio"] / (0.1 / (2.0 * omega(row))) - 1.0).abs() < 1e-6, "{row:?}");
        }
    }
    let resonances: Vec<_> = all.iter().filter(|row| row["curve"] == 2.0).collect();
    let (first, last) = (resonances[0], resonances[resonances.len() - 1]);
    assert!(first["level"] <= 5e-4 && (last["level"] / 0.1 - 1.0).abs() < 1e-9, "{first:?} {last:?}");
    for row in &resonances {
        assert!((row["drive_lag_deg"] - 90.0).abs() < 1e-6, "{row:?}");
        assert!((row["input_power_w"] / row["dissipated_power_w"] - 1.0).abs() < 1e-9, "{row:?}");
        let unit = |row: &Row| row["fundamental_m"] / row["level"];
        assert!((unit(row) / unit(last) - 1.0).abs() < 1e-7 && (omega(row) / omega(last) - 1.0).abs() < 1e-9);
    }
    Ok(())
}

/// Exact motions too: of a rod of two elements whose tip, without mass, touches at rest, `6` and `12` rad²/s² open
/// and closed; and those of the heavy cantilever on its ledge, at lift-off. `verify` finds the former again.
#[test]
fn exact_motions_begin_at_stops_that_touch_or_press() -> Outcome {
    let rod = "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 2\nstart = \"clamped\"\n\
        material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }\nsection = { area_m2 = 1.0 }\n\
        [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 0.0\n\
        [method]\nkind = \"shooting\"\nharmonics = 9\nmass_redistribution = \"drop\"\n\
        [continuation]\nmax_energy_ratio = 5.0\n";
    let (folder, _) = run(rod, &[])?;
    let all = rows(&folder)?;
    let [open, closed] = [6.0_f64.sqrt(), 12.0_f64.sqrt()];
    let hz = 2.0 * open * closed / (open + closed) / std::f64::consts::TAU;
    for row in &all {
        assert!((row["frequency_hz"] / hz - 1.0).abs() < 1e-9 && row["largest_multiplier"].is_finite(), "{row:?}");
    }
    assert!((all[all.len() - 1]["energy_j"] / all[0]["energy_j"] - 5.0).abs() < 1e-6);
    let (code, said) = call("verify", &folder.path().join("out"), &["--point", "3"])?;
    assert!(code == Some(0) && said.contains("exact motion"), "{said}");
    let heavy = format!("{LEDGE}{WEIGHT}").replace("[method]\n", "[method]\nkind = \"shooting\"\nheld_modes = 4\n");
    let (folder, summary) = run(&heavy, &["continuation.max_energy_ratio=1.00003"])?;
    assert!((number(&summary["grazing"]["energy_j"]) / 2.551_653_349_35e-4 - 1.0).abs() < 1e-9, "{summary}");
    assert!((rows(&folder)?[0]["frequency_hz"] / 73.395_632_377_7 - 1.0).abs() < 1e-9);
    assert_eq!(summary["events"][0]["event"], "lift-off");
    Ok(())
}

/// A mode of a beam before a stop without a gap, with a second one at some distance: the conservative mode begins and
/// ends where the branch does, which is computed in another way.
#[test]
fn a_mode_before_a_stop_without_a_gap_is_that_of_the_branch() -> Outcome {
    let other = "[[contact]]\nat_m = 0.6\ndirection = \"transverse\"\nside = \"positive\"\ngap_m = 1e-3\n";
    let text = LEDGE
        .replace("mass_redistribution = \"drop\"\n", "")
        .replace("harmonics = 1", "harmonics = 5")
        .replace("[method]", &format!("{other}[method]"))
        + "[output]\nstability = \"never\"\n";
    let (branch, _) = run(&text, &[])?;
    let (mode, _) = run(&format!("{text}[response]\nkind = \"mode\"\n"), &[])?;
    let [branch, mode] = [rows(&branch)?, rows(&mode)?];
    for (a, b) in [(branch.first(), mode.first()), (branch.last(), mode.last())] {
        let (a, b) = (a.ok_or("no point")?, b.ok_or("no point")?);
        assert!((a["frequency_hz"] / b["frequency_hz"] - 1.0).abs() < 1e-8, "{a:?} {b:?}");
        assert!((a["energy_j"] / b["energy_j"] - 1.0).abs() < 1e-8, "{a:?} {b:?}");
    }
    Ok(())
}

/// What does not rest, and what does not fit, is refused at its place.
#[test]
fn loads_that_do_not_fit_are_refused() -> Outcome {
    let free = ROD.replace("start = \"clamped\"", "start = \"free\"");
    let held = free.replace("harmonics = 3", "harmonics = 3\nmass_redistribution = \"drop\"");
    let cases = [
        (format!("{held}[gravity]\nside = \"negative\"\n"), "the structure falls away under `gravity`"),
        (format!("{free}[gravity]\nside = \"negative\"\n"), "the structure falls away under `gravity`"),
        (format!("{ROD}[thermal]\nexpansion_1_k = 1.2e-5\n"), "`thermal` is not complete"),
        (format!("{ROD}[static_displacement]\nfile = \"u.csv\"\n"), "is of a structure from files"),
        (format!("{ROD}[[static_force]]\nnodes = [3]\nforce_n = 1.0\n"), "are nodes of a structure from files"),
        (format!("{ROD}[gravity]\ndirection = \"transverse\"\n"), "cannot be \"transverse\" on a rod"),
        (format!("{ROD}[gravity]\nacceleration_m_s2 = -9.81\n"), "gravity.acceleration_m_s2"),
        (
            mass_with_tip(-0.05, "[[contact]]\nrow = 1\nside = \"negative\"\ngap_m = 0.04\n"),
            "the structure does not fit between stops 0, 1 (counted from 0)",
        ),
    ];
    for (text, wanted) in cases {
        let folder = tempdir()?;
        let (code, said) = call("check", &scene(&folder, &text)?, &[])?;
        assert!(code == Some(2) && said.contains(wanted), "{code:?} {wanted}: {said}");
    }
    Ok(())
}

/// Two unit masses on unit springs above a stop: weight, a force that nodes share, thermal forces and displacements
/// from tables all bring the second one 30 m down, however the structure is reduced.
#[test]
fn structures_from_files_take_loads_in_four_ways() -> Outcome {
    let folder = tempdir()?;
    for (name, text) in [
        ("two.sti", "1 1 2.0\n1 2 -1.0\n2 2 1.0\n"),
        ("two.mas", "1 1 1.0\n1 2 0.0\n2 2 1.0\n"),
        ("two.dof", "7.3\n10.3\n"),
        ("forces.csv", "node,component,force_n\n7,uz,-10\n10,uz,-10\n"),
        ("places.csv", "7,3,-20\n10,3,-30\n"),
        ("elsewhere.csv", "8,uz,-10\n"),
        ("broken.csv", "node,component,force_n\n7,uz,x\n"),
        ("twice.csv", "7,uz,1\n10,uz,1\n7,3,2\n"),
    ] {
        fs::write(folder.path().join(name), text)?;
    }
    let structure = "[structure]\nkind = \"matrices\"\nstiffness = \"two.sti\"\nmass = \"two.mas\"\n\
        dofs = \"two.dof\"\nunits = \"m-kg-s\"\n\
        [[contact]]\nnode = 10\nnormal = [0.0, 0.0, -1.0]\ngap_m = 35.0\nstiffness_n_m = 2.0\n\
        [method]\nharmonics = 1\n[continuation]\nmax_energy_ratio = 2.0\n";
    for load in [
        "[gravity]\nacceleration_m_s2 = 10.0\ndirection = [0.0, 0.0, -1.0]\n",
        "[[static_force]]\nnodes = [7, 10]\ndirection = [0.0, 0.0, -1.0]\nforce_n = 20.0\n",
        "[thermal]\nforces = \"forces.csv\"\n",
        "[static_displacement]\nfile = \"places.csv\"\n",
    ] {
        for reduction in ["", "[reduction]\nkind = \"held-modes\"\n"] {
            let (code, said) = call("check", &scene(&folder, &format!("{structure}{load}{reduction}"))?, &[])?;
            assert!(code == Some(0) && said.contains("gap 5 m under the loads with open stops; open by 5 m"), "{said}");
        }
    }
    // Closer by 10 m it is pressed: λ = 5/(2 + 1/2) with the flexibility of the chain and of the stop.
    let pressed = structure.replace("gap_m = 35.0", "gap_m = 25.0") + "[static_displacement]\nfile = \"places.csv\"\n";
    let (_, said) = call("check", &scene(&folder, &pressed)?, &[])?;
    assert!(said.contains("gap -5 m under the loads with open stops; closed, 2 N"), "{said}");
    for (file, wanted) in [
        ("elsewhere.csv", "the structure has no row for uz of node 8"),
        ("broken.csv", "broken.csv:2: found `x`; expected a number, the force_n"),
        ("twice.csv", "twice.csv:3: found uz of node 7 a second time, after line 1"),
        ("missing.csv", "missing.csv"),
    ] {
        let (code, said) =
            call("check", &scene(&folder, &format!("{structure}[thermal]\nforces = \"{file}\"\n"))?, &[])?;
        assert!(code == Some(2) && said.contains(wanted), "{code:?} {said}");
    }
    for (load, wanted) in [
        ("[static_displacement]\nfile = \"places.csv\"\n[gravity]\ndirection = [0.0, 0.0, -1.0]\n", "says already"),
        ("[[static_force]]\nnode = 7\ndirection = [1.0, 0.0, 0.0]\nforce_n = 1.0\n", "does not move there"),
    ] {
        let (code, said) = call("check", &scene(&folder, &format!("{structure}{load}"))?, &[])?;
        assert!(code == Some(2) && said.contains(wanted), "{code:?} {said}");
    }
    Ok(())
}

/// Frequency and averaged kinetic energy of a mass m on a spring k under the weight w, of this amplitude about rest: on
/// the spring until `cos ωt = −w/(k a)`, then free.
fn bounce([m, k, w]: [f64; 3], amplitude: f64) -> [f64; 2] {
    let (omega, g) = ((k / m).sqrt(), w / m);
    let pressed = (-w / (k * amplitude)).acos() / omega;
    let speed = amplitude * omega * (omega * pressed).sin();
    let half = pressed + speed / g;
    let on_spring = (amplitude * omega).powi(2) * (0.5 * pressed - (2.0 * omega * pressed).sin() / (4.0 * omega));
    [std::f64::consts::PI / half, 0.5 * m * (on_spring + speed.powi(3) / (3.0 * g)) / half]
}

/// A mass of 1 kg and 10 N, with a second mode that its row does not see, on an elastic stop.
const MASS: &str = "[structure]\nkind = \"reduced\"\nfrequencies_hz = [0.0, 1000.0]\ncontact_rows = [[1.0, 0.0]]\n\
    residual_flexibility_m_n = [[0.0]]\n[[static_force]]\nrow = 1\nforce_n = -10.0\n\
    [[contact]]\nrow = 1\nside = \"negative\"\ngap_m = 0.0\nstiffness_n_m = 1000.0\n\
    [method]\nharmonics = 40\n[continuation]\nmax_energy_ratio = 15.0\n";

#[test]
fn a_mass_bounces_on_its_stop() -> Outcome {
    let (folder, summary) = run(MASS, &[])?;
    let rest = &summary["rest"][0];
    assert!((number(&rest["force_n"]) - 10.0).abs() < 1e-9 && rest["closed"] == true, "{rest}");
    assert_eq!(summary["events"][0]["event"].as_str(), Some("lift-off"));
    let rows = rows(&folder)?;
    let first = &rows[0];
    assert!(
        (first["energy_j"] / 0.025 - 1.0).abs() < 1e-9 && (first["frequency_hz"] / 5.032_921_210_45 - 1.0).abs() < 1e-9
    );
    for row in &rows[1..] {
        // Counted from rest: ½ k a² of the amplitude a about it.
        let amplitude = (row["total_energy_j"] / 500.0).sqrt();
        let [omega, energy] = bounce([1.0, 1000.0, 10.0], amplitude);
        assert!((row["frequency_hz"] * std::f64::consts::TAU / omega - 1.0).abs() < 1e-7, "{row:?}");
        assert!((row["energy_j"] / energy - 1.0).abs() < 1e-6, "{row:?}");
        assert!((row["peak_contact_force_n"] / (10.0 + 1000.0 * amplitude) - 1.0).abs() < 1e-5, "{row:?}");
    }
    let (code, said) = call("verify", &folder.path().join("out"), &["--point", &(rows.len() - 1).to_string()])?;
    assert!(code == Some(0), "{said}");
    Ok(())
}

/// A free rod on its end: as one that is fixed there it begins at `c/4L`, in free-interface modes and in those of the
/// paper; and its damped mode and its response begin where that does, with powers in balance.
#[test]
fn a_rod_bounces_on_its_end() -> Outcome {
    let text = ROD
        .replace("start = \"clamped\"", "start = \"free\"")
        .replace("side = \"positive\"", "side = \"negative\"")
        .replace("at_m = 1.0", "at_m = 0.0")
        .replace("max_energy_ratio = 1.5", "max_energy_ratio = 1.002")
        + "[gravity]\nside = \"negative\"\ndirection = \"axial\"\nacceleration_m_s2 = 10.0\n";
    let quarter = (2.1e11_f64 / 7800.0).sqrt() / 4.0;
    for set in ["method.mode=1", "method.mass_redistribution=\"drop\""] {
        let (folder, summary) = run(&text, &[set])?;
        // The whole weight is carried, that of the contact node too.
        assert!((number(&summary["rest"][0]["force_n"]) / 7.8 - 1.0).abs() < 1e-9, "{}", summary["rest"]);
        let rows = rows(&folder)?;
        assert!((rows[0]["frequency_hz"] / quarter - 1.0).abs() < 5e-3, "{:?}", rows[0]);
        // It ends where it falls to, 0.4 mm below the drawing.
        assert!((rows[0]["peak_m"] / 0.4e-3 - 1.0).abs() < 1e-6, "{:?}", rows[0]);
        let (_, said) = call("check", &folder.path().join("scene.toml"), &[])?;
        assert!(said.contains("which carry the structure") && said.contains("from lift-off"), "{said}");
        assert!(said.contains("stop 0: gap 0.0004 m in the drawing; closed, 7.8 N"), "{said}");
    }
    let damped = text.replace("max_energy_ratio = 1.002", "max_energy_ratio = 1.5")
        + "[damping]\nratio = 0.02\n[[force]]\nat_m = 1.0\n[output]\nstability = \"never\"\n\
        [[response]]\nkind = \"damped-mode\"\n\
        [[response]]\nkind = \"frequency\"\nfrequency_hz = [1100.0, 1500.0]\nlevels_n = [0.09, 1.0]\n";
    let (folder, summary) = run(&damped, &[])?;
    let all = rows(&folder)?;
    let of = |curve: f64| all.iter().filter(|row| row["curve"] == curve).collect::<Vec<_>>();
    assert!((of(0.0)[0]["frequency_hz"] / quarter - 1.0).abs() < 5e-3);
    assert!(of(1.0).iter().all(|row| row["contact_fraction"] == 1.0), "0.09 N lets go of nothing");
    assert!(of(2.0).iter().any(|row| row["contact_fraction"] < 0.95), "1 N does");
    assert!(number(&summary["largest_power_imbalance"]) < 1e-6, "{}", summary["largest_power_imbalance"]);
    Ok(())
}

/// A free beam of 20 kg/m on supports, which move it across alone: along its axis it is left at rest, or refused where
/// something pushes it there.
#[test]
fn a_free_beam_lies_on_its_supports_or_falls() -> Outcome {
    let beam = |supports: &str| {
        format!(
            "[structure]\nkind = \"beam\"\nlength_m = 2.0\nelements = 16\nstart = \"free\"\n\
             material = {{ youngs_modulus_pa = 2.1e11, density_kg_m3 = 7800.0, poissons_ratio = 0.3 }}\n\
             section = {{ width_m = 0.04, height_m = 0.03 }}\n{supports}\
             [method]\nmode = 2\nharmonics = 3\n[continuation]\nmax_energy_ratio = 1.01\n"
        )
    };
    let support = |at: f64, side: &str| {
        format!("[[contact]]\nat_m = {at}\ndirection = \"transverse\"\nside = \"{side}\"\ngap_m = 0.0\n")
    };
    let below = |places: &[f64]| places.iter().map(|at| support(*at, "negative")).collect::<String>();
    // Two supports a quarter and three eighths from the middle carry it as a lever says.
    let (folder, summary) = run(&(beam(&below(&[0.5, 1.75])) + WEIGHT), &[])?;
    let (weight, rest) = (7800.0 * 0.04 * 0.03 * 2.0 * 9.81, &summary["rest"]);
    let carried = [0, 1].map(|i| number(&rest[i]["force_n"]) / weight);
    assert!((carried[0] - 0.6).abs() < 1e-9 && (carried[1] - 0.4).abs() < 1e-9, "{rest}");
    assert_eq!(rows(&folder)?[0]["contact_fraction"], 1.0);
    // Of the mode on its supports, not of a rigid-body motion.
    assert!(number(&summary["errors"]["frequency"]["estimate"]) < 0.01, "{}", summary["errors"]);
    for (supports, mode, wanted) in [
        (below(&[0.5, 1.75]), 1, "that is the first mode on its contacts"),
        (below(&[0.25, 0.75]), 2, "no forces of its contacts balance the load"),
        (below(&[1.0]), 2, "rigid-body motions that no contact feels"),
        (below(&[1.0]) + &below(&[1.75]).replace("0.0\n", "0.01\n"), 2, "it can still roll or tip over them"),
        (support(0.5, "positive") + &support(1.5, "positive"), 2, "no forces of its contacts balance the load"),
    ] {
        let folder = tempdir()?;
        let text = beam(&supports).replace("mode = 2", &format!("mode = {mode}")) + WEIGHT;
        let (code, said) = call("check", &scene(&folder, &text)?, &[])?;
        assert!(code == Some(2) && said.contains(wanted), "{code:?} {wanted}: {said}");
    }
    let pushed =
        beam(&below(&[0.5, 1.75])) + WEIGHT + "[[static_force]]\nat_m = 1.0\ndirection = \"axial\"\nforce_n = 1.0\n";
    let folder = tempdir()?;
    let (code, said) = call("check", &scene(&folder, &pushed)?, &[])?;
    assert!(code == Some(2) && said.contains("in a way that no contact feels") && said.contains("axial"), "{said}");
    Ok(())
}

/// A conservative mode begins at lift-off with the frequency that it has without the damper, and has it later as far as
/// harmonics go; a small damper changes a damped mode little.
#[test]
fn modes_start_where_a_stop_with_a_damper_is_closed_at_rest() -> Outcome {
    let elastic = "gap_m = 0.0\nstiffness_n_m = 2e4\n";
    let ledge = LEDGE.replace("gap_m = 0.0\n", elastic) + WEIGHT;
    let ledge = ledge.replace("harmonics = 1\nmass_redistribution = \"drop\"\n", "harmonics = 15\n");
    let scene = |damper: &str, kind: &str| {
        let stop = format!("{elastic}{damper}");
        ledge.replace(elastic, &stop) + &format!("[damping]\nratio = 0.01\n[[response]]\nkind = \"{kind}\"\n")
    };
    let both = |damper: &str, kind: &str| -> Result<[f64; 2], Box<dyn Error>> {
        let (folder, _) = run(&scene(damper, kind), &["output.figures=false", "output.page=false"])?;
        let rows = rows(&folder)?;
        Ok([&rows[0], &rows[rows.len() - 1]].map(|row| row["frequency_hz"]))
    };
    let (plain, with) = (both("", "mode")?, both("damping_n_s_m = 5.0\n", "mode")?);
    let off = [0, 1].map(|k| (with[k] / plain[k] - 1.0).abs());
    assert!(off[0] < 1e-9 && off[1] < 1e-3, "{with:?} Hz with the damper, {plain:?} Hz without");
    let (plain, with) = (both("", "damped-mode")?, both("damping_n_s_m = 0.01\n", "damped-mode")?);
    let off = [0, 1].map(|k| (with[k] / plain[k] - 1.0).abs());
    assert!(off[0] < 1e-6 && off[1] < 1e-4, "{with:?} Hz with the damper, {plain:?} Hz without");
    Ok(())
}

/// A beam that two springs carry also moves along its axis, which nothing feels: its linear response is stable
/// everywhere.
#[test]
fn what_no_contact_feels_has_no_part_in_stability() -> Outcome {
    let spring = |at: f64| {
        format!(
            "[[contact]]\nat_m = {at:?}\ndirection = \"transverse\"\nside = \"negative\"\ngap_m = 0.0\n\
             stiffness_n_m = 2e6\n"
        )
    };
    let text = "[structure]\nkind = \"beam\"\nlength_m = 3.0\nelements = 12\nstart = \"free\"\nend = \"free\"\n\
        material = { youngs_modulus_gpa = 210.0, density_kg_m3 = 7850.0 }\n\
        section = { width_mm = 60.0, height_mm = 40.0 }\n[damping]\nratio = 0.02\n\
        [[force]]\nat_m = 1.75\ndirection = \"transverse\"\n\
        [[response]]\nkind = \"frequency\"\nfrequency_hz = [12.0, 24.0]\nlevels_n = [0.5]\n[method]\nmode = 2\n";
    let (_folder, summary) = run(&(text.to_owned() + &spring(0.75) + &spring(2.75) + WEIGHT), &[])?;
    assert_eq!(summary["levels"][0]["stable"], serde_json::json!([[12.0, 24.0]]), "{}", summary["levels"]);
    Ok(())
}
