//! Structures with few masses, whose motions are known or can be integrated in time.

use std::collections::BTreeMap;
use std::error::Error;
use std::f64::consts::TAU;
use std::fs;

use tempfile::tempdir;

use super::{Outcome, ROD, number, rows, run, said, summary};

/// NLvib's third example with less damping, the spring at the first mass as a stop with a massless node.
const MASSES: &str = r#"
[structure]
kind = "matrices"
stiffness = "k.mtx"
mass = "m.mtx"
dofs = "dofs.csv"
[[contact]]
node = 3
normal = [1.0, 0.0, 0.0]
gap_m = 1.0
[reduction]
modes = 2
[damping]
rayleigh = { stiffness_s = 0.01 }
[[force]]
node = 2
direction = [1.0, 0.0, 0.0]
[[response]]
kind = "phase-resonance"
frequency_hz = [0.06, 0.19]
levels_n = [0.35]
[[response]]
kind = "frequency"
frequency_hz = [0.06, 0.19]
levels_n = [0.2]
[method]
harmonics = 8
[output]
stability = "never"
"#;

/// The original example, as a rod of two lumped elements: masses of 1 kg on springs of 1 N/m, a spring of 100 N/m at
/// the tip.
const LUMPS: &str = r#"
[structure]
kind = "rod"
length_m = 2.0
elements = 2
mass_matrix = "lumped"
start = "clamped"
end = "free"
material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }
section = { area_m2 = 1.0 }
[[structure.mass_point]]
at_m = 2.0
mass_kg = 0.5
[[contact]]
at_m = 2.0
direction = "axial"
side = "positive"
gap_m = 1.0
stiffness_n_m = 100.0
[damping]
rayleigh = { stiffness_s = 0.03 }
[[force]]
at_m = 1.0
direction = "axial"
[[response]]
kind = "frequency"
frequency_hz = [0.09, 0.1195547349434]
levels_n = [0.1]
[method]
kind = "hbm"
harmonics = 63
[output]
stability = "never"
figures = false
page = false
"#;

#[test]
fn a_structure_of_few_masses_before_an_elastic_stop_moves_in_all_its_modes() -> Outcome {
    let folder = tempdir()?;
    let out = run(folder.path(), LUMPS, &[])?;
    assert!(out.status.success(), "{}", said(&out));
    let branch = rows(folder.path().join("out/branch.csv"))?;
    // Without contact: `((1 + iγ) K − Ω²) q = f`, γ = 0.03 Ω, of two masses, by Cramer's rule.
    let omega = TAU * 0.09;
    let (gamma, square) = (0.03 * omega, omega * omega);
    let free = (1.0 - square, gamma);
    // (a + iγ)(b + 2iγ) − (1 + iγ)² with a = 1 − Ω², b = 2 − Ω²
    let real = free.0 * (2.0 - square) - 2.0 * gamma * gamma - (1.0 - gamma * gamma);
    let imaginary = gamma * (2.0 * free.0 + 2.0 - square - 2.0);
    let linear = 0.1 * free.0.hypot(free.1) / real.hypot(imaginary);
    assert!((number(&branch[0], "drive_fundamental_m") / linear - 1.0).abs() < 1e-9, "{linear}");
    // With 63 harmonics by other code, next to its peak; the exact value is 0.9363056809.
    let peak = branch.iter().map(|row| number(row, "drive_fundamental_m")).fold(0.0, f64::max);
    assert!((peak / 0.9363067661 - 1.0).abs() < 1e-7, "{peak}");
    Ok(())
}

#[test]
fn a_detached_curve_is_followed_from_a_phase_resonance_and_named() -> Outcome {
    let folder = tempdir()?;
    let header = "%%MatrixMarket matrix coordinate real symmetric\n";
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text);
    write("k.mtx", &format!("{header}3 3 5\n1 1 101\n2 1 -1\n2 2 2\n3 1 -100\n3 3 100\n"))?;
    write("m.mtx", &format!("{header}3 3 2\n1 1 1\n2 2 1\n"))?;
    write("dofs.csv", "1,1,ux\n2,2,ux\n3,3,ux\n")?;
    let output = run(folder.path(), MASSES, &[])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let rows = rows(folder.path().join("out/branch.csv"))?;
    let detached: Vec<_> = rows.iter().filter(|row| row["detached"] == "true").collect();
    assert!(detached.len() > 20 && detached.iter().all(|row| row["name"] == "0.2 N, detached"));
    // Around the two resonances that the curve from the ends of the window does not reach.
    let frequencies = detached.iter().map(|row| std::f64::consts::TAU * number(row, "frequency_hz"));
    let (low, high) = frequencies.fold((f64::INFINITY, 0.0_f64), |(low, high), w| (low.min(w), high.max(w)));
    assert!((low - 0.783).abs() < 0.004 && (high - 0.8136).abs() < 0.004, "{low} {high}");
    assert!(summary(folder.path())?.to_string().contains("the branch came back to where it began"));
    Ok(())
}

/// The rod of two elements with 2 % and a force of 12 in time, `q̈ = 3 (12 cos Ωt − 2q − 2 (q − 1)⁺) − 2ζω q̇` with `ω²
/// = 6`: amplitude of the middle at the frequency of the load, for motions of twice its period reached from an initial
/// state.
fn settled(hertz: f64, mut state: [f64; 2]) -> f64 {
    let (omega, damping) = (TAU * hertz, 0.04 * 6.0_f64.sqrt());
    let rate = |t: f64, [q, v]: [f64; 2]| {
        let force = 12.0 * (omega * t).cos() - 2.0 * q - 2.0 * (q - 1.0).max(0.0);
        [v, 3.0 * force - damping * v]
    };
    let along = |x: [f64; 2], k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
    let (steps, periods) = (400, 160);
    let h = TAU / omega / f64::from(steps);
    let mut sum = [0.0; 2];
    for j in 0..steps * periods {
        let t = h * f64::from(j);
        if j >= steps * (periods - 2) {
            let (sin, cos) = (omega * t).sin_cos();
            sum = along(sum, [cos, sin], state[0] / f64::from(steps));
        }
        let a = rate(t, state);
        let b = rate(t + 0.5 * h, along(state, a, 0.5 * h));
        let c = rate(t + 0.5 * h, along(state, b, 0.5 * h));
        let d = rate(t + h, along(state, c, h));
        state = [0, 1].map(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    sum[0].hypot(sum[1])
}

#[test]
fn a_scene_comes_to_motions_of_twice_the_period_that_are_those_of_an_integration_in_time() -> Outcome {
    let folder = tempdir()?;
    let text = ROD.replace("ratio = 0.01", "ratio = 0.02")
        + "[response]\nkind = \"frequency\"\nfrequency_hz = [0.75, 0.95]\nlevels_n = [12.0]\nsubharmonic = 2\n";
    let output = run(folder.path(), &text, &[])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let rows = rows(folder.path().join("out/branch.csv"))?;
    let of = |curve: &'static str| rows.iter().filter(move |row| row["curve"] == curve);
    let doublings: Vec<f64> =
        of("0").filter(|row| row["event"].contains("period-doubling")).map(|row| number(row, "frequency_hz")).collect();
    assert_eq!(doublings.len(), 2);
    let doubled: Vec<_> = of("1").collect();
    let ends = [doubled.first(), doubled.last()].map(|row| row.map_or(f64::NAN, |row| number(row, "frequency_hz")));
    assert!(ends.iter().zip(&doublings).all(|(end, at)| (end / at - 1.0).abs() < 1e-3), "{ends:?} {doublings:?}");
    for wanted in [0.81, 0.84, 0.87] {
        let off = |row: &&&BTreeMap<String, String>| (number(row, "frequency_hz") - wanted).abs();
        let stable = doubled.iter().filter(|row| row["stable"] == "true");
        let row = stable.min_by(|a, b| off(a).total_cmp(&off(b))).ok_or("no stable motion")?;
        for state in [[0.0, 0.0], [-2.0, 0.0], [0.0, 5.0]] {
            let amplitude = settled(number(row, "frequency_hz"), state);
            let found = number(row, "drive_fundamental_m");
            assert!((amplitude / found - 1.0).abs() < 1e-4, "{wanted} {state:?}: {amplitude} {found}");
        }
    }
    Ok(())
}

#[test]
fn the_damper_of_a_stop_takes_power_and_adds_to_the_damping_of_the_mode() -> Outcome {
    let ratio = |stop: &str| -> Result<f64, Box<dyn Error>> {
        let folder = tempdir()?;
        let text = ROD.replace("gap_m = 1.0", &format!("gap_m = 1.0\n{stop}"))
            + "[continuation]\nmax_energy_ratio = 10.0\n[[response]]\nkind = \"damped-mode\"\n\
               [[response]]\nkind = \"frequency\"\nfrequency_hz = [0.35, 0.5]\nlevels_n = [0.2]\n";
        let output = run(folder.path(), &text, &[])?;
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let rows = rows(folder.path().join("out/branch.csv"))?;
        for row in rows.iter().filter(|row| row["kind"] == "frequency") {
            let balance = number(row, "input_power_w") / number(row, "dissipated_power_w") - 1.0;
            assert!(balance.abs() < 1e-12, "{balance:e}");
        }
        let mode = rows.iter().rfind(|row| row["kind"] == "damped-mode").ok_or("no mode")?;
        Ok(number(mode, "damping_ratio"))
    };
    let (elastic, dissipating) = (ratio("stiffness_n_m = 3.0")?, ratio("stiffness_n_m = 3.0\ndamping_n_s_m = 0.5")?);
    assert!(elastic < 0.011 && dissipating > 1.5 * elastic, "{elastic} {dissipating}");
    Ok(())
}
