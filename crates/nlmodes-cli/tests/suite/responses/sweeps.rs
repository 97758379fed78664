//! Sweeps in time beside curves over the frequency.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use super::{Outcome, ROD, run, said, summary};

const SWEPT: &str = r#"
[[response]]
kind = "frequency"
frequency_hz = [0.38, 0.47]
levels_n = [0.2]
sweep = true
"#;

/// How much later than on the curve a sweep jumps, over the frequency.
fn late(jump: &Value) -> f64 {
    let [curve, swept] = ["frequency_hz", "swept_frequency_hz"].map(|key| jump[key].as_f64().unwrap_or(f64::NAN));
    if jump["direction"] == "up" { swept / curve - 1.0 } else { 1.0 - swept / curve }
}

#[test]
fn a_slow_sweep_follows_the_curve_and_jumps_behind_its_folds() -> Outcome {
    let folder = tempdir()?;
    let output = run(folder.path(), &format!("{ROD}{SWEPT}[output]\npage = false\n"), &[])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let found = summary(folder.path())?;
    let jumps = found["levels"][0]["jumps"].as_array().ok_or("no jumps")?;
    assert_eq!(jumps.len(), 2, "{jumps:?}");
    for jump in jumps {
        let late = late(jump);
        // It takes the motion some time to leave, in which the frequency goes on.
        assert!(late > -2.5e-4 && late < 6e-3, "{jump}");
    }
    let sweeps = found["sweeps"].as_array().ok_or("no sweeps")?;
    assert_eq!((&sweeps[0]["direction"], &sweeps[1]["direction"]), (&"up".into(), &"down".into()));
    // Up to the fold the sweep has the amplitudes of the curve; downward it misses the peak.
    let [up, down] = [0, 1].map(|k| sweeps[k]["peak"]["amplitude_m"].as_f64().unwrap_or(f64::NAN));
    let peak = found["levels"][0]["peak"]["amplitude_m"].as_f64().ok_or("no peak")?;
    assert!((up / peak - 1.0).abs() < 0.03, "{up} {peak}");
    assert!(down < 0.7 * peak, "{down} {peak}");
    // 2 ζ f = 0.0078 Hz: in 1/0.0078 s four thousandths of the frequency, which are less than a quarter of it.
    let width = 0.02 * 6_f64.sqrt() / std::f64::consts::TAU;
    let expected = 0.09 / (width * (0.004 * 0.38));
    assert!((sweeps[0]["duration_s"].as_f64().ok_or("no duration")? / expected - 1.0).abs() < 1e-9);
    let figure = fs::read_to_string(folder.path().join("out/responses.svg"))?;
    assert!(figure.contains("0.2 N, swept up") && figure.contains("0.2 N, swept down"));
    Ok(())
}

/// Without a stop the amplitudes of a sweep are those of the first spring, as on the curve.
#[test]
fn with_a_cubic_spring_both_jumps_are_in_the_sweeps() -> Outcome {
    let scene = "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 4\nstart = \"clamped\"\n\
        material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }\nsection = { area_m2 = 1.0 }\n\
        [[spring]]\nat_m = 1.0\ndirection = \"axial\"\nlaw = { polynomial = [0.0, 0.0, 0.3] }\n\
        [damping]\nratio = 0.02\n[reduction]\nmodes = 2\n[[force]]\nat_m = 0.5\ndirection = \"axial\"\n\
        [[response]]\nkind = \"frequency\"\nfrequency_hz = [0.25, 0.28]\nlevels_n = [0.07]\n\
        sweep = true\nsweep_s = 4800.0\n[method]\nharmonics = 5\n\
        [output]\nfigures = false\npage = false\n";
    let folder = tempdir()?;
    let output = run(folder.path(), scene, &[])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let found = summary(folder.path())?;
    let jumps = found["levels"][0]["jumps"].as_array().ok_or("no jumps")?;
    assert_eq!(jumps.len(), 2, "{jumps:?}");
    for jump in jumps {
        let late = late(jump);
        // A quarter of a per cent of it in the time 1/(2 ζ f), of which leaving takes two.
        assert!(late > 0.0 && late < 6e-3, "{jump}");
    }
    let peak = |of: &Value| of["peak"]["amplitude_m"].as_f64().unwrap_or(f64::NAN);
    let (up, curve) = (peak(&found["sweeps"][0]), peak(&found["levels"][0]));
    assert!((up / curve - 1.0).abs() < 0.02, "{up} {curve}");
    Ok(())
}

#[test]
fn sweeps_that_cannot_be_are_refused() -> Outcome {
    let folder = tempdir()?;
    let shaken = ROD.replace("[[force]]\nat_m = 0.5\n", "[base_motion]\namplitude_m = 0.1\n");
    let output = run(folder.path(), &format!("{shaken}{}", SWEPT.replace("levels_n", "levels_m")), &[])?;
    assert_eq!(output.status.code(), Some(2));
    let text = said(&output);
    let expected = "a base that is swept in time has an acceleration";
    assert!(text.contains(expected) && text.contains("sweep = true"), "{text}");
    Ok(())
}
