//! `[[sensitivity]]` from the command line: columns, figures and page, against differences of whole runs.

use std::collections::HashMap;
use std::error::Error;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

/// A cantilever with a point mass and a spring before two stops, an elastic one at its tip.
const BEAM: &str = "[structure]\nkind = \"beam\"\nlength_m = 0.5\nelements = 8\nstart = \"clamped\"\n\
    material = { youngs_modulus_gpa = 210.0, density_kg_m3 = 7800.0, poissons_ratio = 0.3 }\n\
    section = { width_mm = 20.0, height_mm = 6.0 }\n\
    [[structure.mass_point]]\nat_m = 0.25\nmass_kg = 0.05\n\
    [[structure.spring]]\nat_m = 0.375\ndirection = \"transverse\"\nstiffness_n_m = 800.0\n\
    [[contact]]\nat_m = 0.5\ndirection = \"transverse\"\nside = \"positive\"\ngap_mm = 1.0\nstiffness_n_m = 2e4\n\
    [[contact]]\nat_m = 0.375\ndirection = \"transverse\"\nside = \"negative\"\ngap_mm = 0.7\n\
    [method]\nharmonics = 5\n[output]\nstability = \"never\"\n";

const MODE: &str = "[continuation]\nmax_energy_ratio = 4.0\n";

const FORCE: &str = "[damping]\nratio = 0.01\n[[force]]\nat_m = 0.125\ndirection = \"transverse\"\namplitude_n = 8.0\n\
    [[response]]\nkind = \"frequency\"\nfrequency_hz = [12.0, 26.0]\n";

/// Keys with their values.
const KEYS: [(&str, f64); 10] = [
    ("contact.0.gap_mm", 1.0),
    ("contact.1.gap_m", 0.7e-3),
    ("contact.0.stiffness_n_m", 2e4),
    ("structure.material.youngs_modulus_gpa", 210.0),
    ("structure.material.density_kg_m3", 7800.0),
    ("structure.length_m", 0.5),
    ("structure.section.height_mm", 6.0),
    ("structure.mass_point.0.mass_kg", 0.05),
    ("structure.spring.0.stiffness_n_m", 800.0),
    ("structure.mass_point.0.at_m", 0.25),
];

/// Positions that move with the length.
const PLACES: [(&str, f64); 4] = [
    ("structure.mass_point.0.at_m", 0.25),
    ("structure.spring.0.at_m", 0.375),
    ("contact.0.at_m", 0.5),
    ("contact.1.at_m", 0.375),
];

fn with_keys(text: &str, keys: &[(&str, f64)]) -> String {
    keys.iter().fold(text.to_owned(), |text, (key, _)| text + &format!("[[sensitivity]]\nkey = \"{key}\"\n"))
}

/// Runs a scene in a folder of its own; the exit status and what was reported.
fn call(text: &str, more: &[String]) -> Result<(TempDir, Option<i32>, String), Box<dyn Error>> {
    let folder = tempdir()?;
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, text)?;
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    call.arg("run").arg(&scene).args(["--quiet", "--out", "out"]).current_dir(folder.path());
    more.iter().for_each(|set| _ = call.args(["--set", set]));
    let output = call.output()?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    Ok((folder, output.status.code(), said))
}

/// The rows of `branch.csv`, numbers by the names of columns.
fn rows(folder: &Path) -> Result<Vec<HashMap<String, f64>>, Box<dyn Error>> {
    let mut table = csv::Reader::from_path(folder.join("out/branch.csv"))?;
    let header = table.headers()?.clone();
    let number = |row: csv::StringRecord| {
        header.iter().zip(&row).map(|(name, cell)| (name.to_owned(), cell.parse().unwrap_or(f64::NAN))).collect()
    };
    table.records().map(|row| Ok(number(row?))).collect()
}

fn last_row(text: &str, more: &[String]) -> Result<(TempDir, HashMap<String, f64>), Box<dyn Error>> {
    let (folder, code, said) = call(text, more)?;
    assert_eq!(code, Some(0), "{said}");
    let last = rows(folder.path())?.pop().ok_or("no point")?;
    Ok((folder, last))
}

/// The overrides with a key times a factor.
fn changed(key: &str, value: f64, factor: f64, places: &[(&str, f64)]) -> Vec<String> {
    let own = format!("{key}={:?}", value * factor);
    let moved = places.iter().filter(|_| key == "structure.length_m");
    std::iter::once(own).chain(moved.map(|(place, at)| format!("{place}={:?}", at * factor))).collect()
}

fn grazing_energy(text: &str, more: &[String]) -> Result<f64, Box<dyn Error>> {
    let short = [more, &["continuation.max_energy_ratio=1.01".to_owned()]].concat();
    let (folder, code, said) = call(text, &short)?;
    assert_eq!(code, Some(0), "{said}");
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("out/summary.json"))?)?;
    Ok(summary["grazing"]["energy_j"].as_f64().ok_or("no energy")?)
}

/// Relative steps of a difference of runs: next to a resonance responses bend more.
const STEP: f64 = 1e-4;
const OF_RESPONSE: f64 = 5e-5;

#[test]
fn gradients_of_a_beam_between_two_stops_are_those_of_runs_that_end_at_the_same_energy() -> Outcome {
    let text = format!("{BEAM}figures = true\n{MODE}");
    let own = grazing_energy(&text, &[])?;
    let ratio = |energy: f64| format!("continuation.max_energy_ratio={:?}", 4.0 * own / energy);
    let (folder, base) = last_row(&with_keys(&text, &KEYS), &[ratio(own)])?;
    for file in ["gradients_1.svg", "gradients_2.svg"] {
        assert!(folder.path().join("out").join(file).is_file(), "{file}");
    }
    let page = fs::read_to_string(folder.path().join("out/report.html"))?;
    assert!(page.contains("Gradients by the parameters of the scene"));
    let plain = format!("{BEAM}figures = false\npage = false\n{MODE}");
    for (key, value) in KEYS {
        let end = |factor: f64| -> Result<HashMap<String, f64>, Box<dyn Error>> {
            let set = changed(key, value, factor, &PLACES);
            let energy = grazing_energy(&plain, &set)?;
            Ok(last_row(&plain, &[set, vec![ratio(energy)]].concat())?.1)
        };
        let (above, below) = (end(1.0 + STEP)?, end(1.0 - STEP)?);
        for (name, of) in [
            ("frequency", "frequency_hz"),
            ("amplitude", "fundamental_m"),
            ("peak", "peak_m"),
            ("peak_force", "peak_contact_force_n"),
            ("impulse", "impulse_ns"),
        ] {
            let difference = (above[of].abs() - below[of].abs()) / (2.0 * STEP * value);
            let gradient = base[&format!("d_{name}_d_{key}")];
            let size = difference.abs().max(1e-2 * base[of].abs() / value);
            let error = (gradient - difference).abs() / size;
            // The mesh bends with a position over the length of an element: differences of runs err by more.
            let allowed = if key.ends_with("at_m") { 1e-5 } else { 2e-6 };
            assert!(error < allowed, "{key}, {name}: {gradient} by gradient, {difference}, {error:.1e}");
        }
    }
    Ok(())
}

#[test]
fn gradients_of_a_response_are_those_of_runs_that_end_at_the_same_frequency() -> Outcome {
    let text = format!("{BEAM}figures = false\npage = false\n{FORCE}");
    let more = [("damping.ratio", 0.01), ("force.0.amplitude_n", 8.0)];
    let keys: Vec<(&str, f64)> = KEYS.iter().chain(&more).copied().collect();
    let places: Vec<(&str, f64)> = PLACES.iter().chain(&[("force.0.at_m", 0.125)]).copied().collect();
    let (_folder, base) = last_row(&with_keys(&text, &keys), &[])?;
    assert!(base["peak_contact_force_n"] > 0.0);
    for (key, value) in keys {
        let end = |factor: f64| last_row(&text, &changed(key, value, factor, &places)).map(|(_, row)| row);
        let (above, below) = (end(1.0 + OF_RESPONSE)?, end(1.0 - OF_RESPONSE)?);
        for (name, of) in [
            ("amplitude", "fundamental_m"),
            ("peak", "peak_m"),
            ("peak_force", "peak_contact_force_n"),
            ("impulse", "impulse_ns"),
        ] {
            let difference = (above[of] - below[of]) / (2.0 * OF_RESPONSE * value);
            let gradient = base[&format!("d_{name}_d_{key}")];
            let error = (gradient - difference).abs() / difference.abs().max(1e-2 * base[of].abs() / value);
            assert!(error < 2e-6, "{key}, {name}: {gradient} by gradient, {difference}, {error:.1e}");
        }
    }
    Ok(())
}

/// At the rows with the largest amplitude and the largest contact force the derivatives are those of these maxima,
/// which lie between the steps of a curve and move in frequency with most parameters.
#[test]
fn gradients_of_a_peak_are_those_of_the_peaks_of_other_runs() -> Outcome {
    let keys = [
        ("contact.0.gap_mm", 1.0),
        ("structure.section.height_mm", 6.0),
        ("structure.material.youngs_modulus_gpa", 210.0),
        ("damping.ratio", 0.01),
        ("response.levels_n.0", 8.0),
    ];
    let force = FORCE.replace("amplitude_n = 8.0\n", "") + "levels_n = [8.0]\n";
    let text = with_keys(&format!("{BEAM}figures = false\npage = false\n{force}"), &keys);
    let largest = |rows: &[HashMap<String, f64>], of: &str| -> Result<HashMap<String, f64>, Box<dyn Error>> {
        Ok(rows.iter().max_by(|a, b| a[of].total_cmp(&b[of])).ok_or("no rows")?.clone())
    };
    let run = |more: &[String]| -> Result<Vec<HashMap<String, f64>>, Box<dyn Error>> {
        let (folder, code, said) = call(&text, more)?;
        assert_eq!(code, Some(0), "{said}");
        rows(folder.path())
    };
    let base = run(&[])?;
    for (key, value) in keys {
        let set = key.replace("response.levels", "response.0.levels");
        let end = |factor: f64| run(&[format!("{set}={:?}", value * factor)]);
        let (above, below) = (end(1.0 + STEP)?, end(1.0 - STEP)?);
        for (name, of) in [("amplitude", "fundamental_m"), ("peak_force", "peak_contact_force_n")] {
            let difference = (largest(&above, of)?[of] - largest(&below, of)?[of]) / (2.0 * STEP * value);
            let own = largest(&base, of)?;
            let gradient = own[&format!("d_{name}_d_{key}")];
            let error = (gradient - difference).abs() * value / own[of];
            assert!(error < 1e-6, "{key}, {name}: {gradient} by gradient, {difference}, {error:.1e}");
        }
    }
    Ok(())
}

#[test]
fn what_has_no_gradient_is_refused_by_name() -> Outcome {
    let cases: [(&str, &str, &str); 6] = [
        ("method.harmonics", "", "is no parameter of the structure or its load"),
        ("contact.3.gap_m", "", "the scene does not write `contact.3.gap_m`"),
        ("structure.kind", "", "no single number"),
        ("contact.0.at_m", "", "cannot vary on both sides"),
        ("contact.0.gap_m", "method.mass_redistribution=drop", "free-interface"),
        ("contact.0.gap_m", "method.kind=shooting", "harmonics"),
    ];
    for (key, set, expected) in cases {
        let text = with_keys(&format!("{BEAM}{MODE}"), &[(key, 0.0)]);
        let more: Vec<String> = [set].iter().filter(|set| !set.is_empty()).map(|set| (*set).to_owned()).collect();
        let (_folder, code, said) = call(&text, &more)?;
        assert!(code == Some(2) && said.contains(expected), "{key} {set}: {said}");
    }
    Ok(())
}

/// Stiffness, mass and labels of a chain of six masses between springs that are all different, in N/mm and t, with one
/// entry (row and column from 1, of `k` or `m`) increased by so much.
fn chain_files(folder: &Path, name: &str, changes: &[Entry]) -> Result<String, Box<dyn Error>> {
    let spring = |i: usize| 200.0 + 30.0 * (i as f64);
    let mut entries = Vec::new();
    for i in 1..=6 {
        entries.push(('k', i, i, spring(i) + if i < 6 { spring(i + 1) } else { 0.0 }));
        entries.push(('m', i, i, 1e-3 + 1e-4 * i as f64));
        if i > 1 {
            entries.push(('k', i, i - 1, -spring(i)));
        }
    }
    entries.extend(changes);
    let mut parts = String::new();
    for (matrix, key) in [('k', "stiffness"), ('m', "mass")] {
        let mut sums = HashMap::<(usize, usize), f64>::new();
        for (_, i, j, value) in entries.iter().filter(|entry| entry.0 == matrix) {
            *sums.entry((*i, *j)).or_default() += value;
        }
        let lines: Vec<String> = sums.iter().map(|((i, j), value)| format!("{i} {j} {value:.17e}")).collect();
        let heading = format!("%%MatrixMarket matrix coordinate real symmetric\n6 6 {}\n", lines.len());
        let path = folder.join(format!("{name}_{matrix}.mtx"));
        fs::write(&path, heading + &lines.join("\n") + "\n")?;
        parts += &format!("{key} = {:?}\n", path.display().to_string());
    }
    let labels: Vec<String> = (1..=6).map(|i| format!("{i},{i},ux")).collect();
    let path = folder.join("dofs.csv");
    fs::write(&path, labels.join("\n") + "\n")?;
    Ok(format!(
        "[structure]\nkind = \"matrices\"\n{parts}dofs = {:?}\nunits = \"mm-t-s\"\n",
        path.display().to_string()
    ))
}

/// Matrix, row, column and value.
type Entry = (char, usize, usize, f64);

/// A spring, a mass and an entry beside the diagonal of each matrix, in the units of the files.
const DIRECTIONS: [(&str, &[Entry]); 4] = [
    ("spring", &[('k', 3, 3, 1.0), ('k', 2, 2, 1.0), ('k', 3, 2, -1.0)]),
    ("pad", &[('m', 5, 5, 1e-5)]),
    ("k_41", &[('k', 4, 1, 1.0)]),
    ("m_65", &[('m', 6, 5, 1e-5)]),
];

const CHAIN: &str = "[[contact]]\nnode = 6\nnormal = [1.0, 0.0, 0.0]\ngap_mm = 1.0\nstiffness_n_m = 2e5\n\
    [reduction]\nmodes = 4\n[method]\nharmonics = 5\n[output]\nstability = \"never\"\nfigures = false\npage = false\n";

#[test]
fn gradients_by_entries_of_stiffness_and_mass_are_those_of_runs_with_other_files() -> Outcome {
    let place = tempdir()?;
    let mut table = "parameter,matrix,node,component,other_node,other_component,value\n".to_owned();
    for (name, entries) in DIRECTIONS {
        for (matrix, i, j, value) in entries {
            let matrix = if *matrix == 'k' { "stiffness" } else { "mass" };
            table += &format!("{name},{matrix},{i},ux,{j},ux,{value}\n");
        }
    }
    let file = place.path().join("entries.csv");
    fs::write(&file, table)?;
    let asked = format!("[[sensitivity]]\nentries = {:?}\n", file.display().to_string());
    let force = "[[force]]\nnode = 2\ndirection = [1.0, 0.0, 0.0]\namplitude_n = 30.0\n\
        [[response]]\nkind = \"frequency\"\nfrequency_hz = [12.0, 20.0]\n";
    let damped = [
        "[damping]\nratio = 0.02\n",
        "[damping]\nratio = 0.02\n[[contact]]\nnode = 4\nnormal = [-1.0, 0.0, 0.0]\ngap_mm = 0.6\n\
            stiffness_hertz_n_m15 = 5e6\ndissipation_s_m = 0.5\n[[spring]]\nnode = 3\n\
            direction = [1.0, 0.0, 0.0]\nlaw = { polynomial = [0.0, 0.0, 1e10] }\n",
        "[damping]\nrayleigh = { mass_1_s = 2.0, stiffness_s = 1e-4 }\n[[damping.dashpot]]\nnode = 4\n\
            direction = [1.0, 0.0, 0.0]\ndamping_n_s_m = 3.0\n",
    ];
    for damping in damped {
        let text = |name: &str, changes: &[Entry]| -> Result<String, Box<dyn Error>> {
            Ok(chain_files(place.path(), name, changes)? + CHAIN + damping + force)
        };
        let (_folder, base) = last_row(&(text("own", &[])? + &asked), &[])?;
        assert!(base["peak_contact_force_n"] > 0.0, "{base:?}");
        for (name, entries) in DIRECTIONS {
            let h = 1e-3;
            let end = |times: f64| -> Result<HashMap<String, f64>, Box<dyn Error>> {
                let moved: Vec<_> = entries.iter().map(|(m, i, j, value)| (*m, *i, *j, times * h * value)).collect();
                Ok(last_row(&text(&format!("{name}_{times}"), &moved)?, &[])?.1)
            };
            let (above, below) = (end(1.0)?, end(-1.0)?);
            for (what, of) in [
                ("amplitude", "fundamental_m"),
                ("peak", "peak_m"),
                ("peak_force", "peak_contact_force_n"),
                ("impulse", "impulse_ns"),
            ] {
                let difference = (above[of] - below[of]) / (2.0 * h);
                let gradient = base[&format!("d_{what}_d_{name}")];
                let error = (gradient - difference).abs() / difference.abs();
                assert!(error < 1e-5, "{name}, {what}: {gradient} by gradient, {difference}, {error:.1e}");
            }
        }
    }
    Ok(())
}

#[test]
fn tables_of_entries_are_refused_where_they_are_about_something_else() -> Outcome {
    let place = tempdir()?;
    let file = place.path().join("entries.csv");
    let asked = format!("[[sensitivity]]\nentries = {:?}\n", file.display().to_string());
    let chain = chain_files(place.path(), "own", &[])? + CHAIN + MODE + &asked;
    for (row, text, code, expected) in [
        ("spring,stiffness,9,ux,9,ux,1.0\n", chain.clone(), Some(2), "ux of node 9, which is no row"),
        ("spring,damping,1,ux,1,ux,1.0\n", chain.clone(), Some(2), "`stiffness` or `mass`"),
        ("spring,stiffness,1,ux,1,ux,1.0\n", format!("{BEAM}{MODE}{asked}"), Some(2), "only a structure from files"),
        ("spring,stiffness,1,ux,1,ux,1.0\n", chain + "key = \"contact.0.gap_mm\"\n", Some(2), "`key` or `entries`"),
    ] {
        fs::write(&file, row)?;
        let (_folder, found, said) = call(&text, &[])?;
        assert!(found == code && said.contains(expected), "{row} {found:?}: {said}");
    }
    Ok(())
}

/// A uniform bar of unit length, stiffness and mass: on the backbone `T = 3 + g/√(2E)`, so that `dT/dg = 1/√(2E)` at
/// constant energy. All its modes are in resonance there: each harmonic that is taken makes the backbone nearer and the
/// branches beside it more, so that few are taken.
#[test]
fn the_period_of_a_uniform_bar_changes_with_the_gap_as_its_closed_form_says() -> Outcome {
    let bar = "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 100\nstart = \"clamped\"\n\
        material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }\nsection = { area_m2 = 1.0 }\n\
        [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1.0\n\
        [method]\nharmonics = 5\n[output]\npage = false\nfigures = false\n\
        [continuation]\nmax_energy_ratio = 200.0\nstart_frequency_hz = 0.32\ndirection = \"up\"\n\
        [[sensitivity]]\nkey = \"contact.0.gap_m\"\n";
    let mut worst = Vec::new();
    for harmonics in [1, 2, 5] {
        let (folder, code, said) = call(bar, &[format!("method.harmonics={harmonics}")])?;
        assert!(matches!(code, Some(0 | 1)), "{said}");
        let all = rows(folder.path())?;
        let length = |row: &HashMap<String, f64>| 1.0 / (2.0 * row["total_energy_j"]).sqrt();
        let (mut of_period, mut of_gradient, mut seen) = (0.0_f64, 0.0_f64, 0);
        for pair in all.windows(2) {
            let [row, next] = [&pair[0], &pair[1]];
            let (period, share) = (1.0 / row["frequency_hz"], length(row));
            if !(3.05..3.2).contains(&period) {
                continue;
            }
            // The gradient holds the averaged kinetic energy, the closed form all of it.
            let ratio = |row: &HashMap<String, f64>| row["energy_j"] / row["total_energy_j"];
            let bend = (ratio(next) / ratio(row)).ln() / (length(next) / share).ln();
            let slope = -period * period * row["d_frequency_d_contact.0.gap_m"] / share * (1.0 - 0.5 * bend);
            of_period = of_period.max((period / (3.0 + share) - 1.0).abs());
            of_gradient = of_gradient.max((slope - 1.0).abs());
            seen += 1;
        }
        assert!(seen > 2, "{seen}");
        worst.push((of_period, of_gradient));
    }
    assert!(worst[0].0 > 5.0 * worst[2].0 && worst[0].1 > 3.0 * worst[2].1, "{worst:?}");
    assert!(worst[2].0 < 2e-3 && worst[2].1 < 0.05, "{worst:?}");
    Ok(())
}

/// A stop with a law of force, a cubic spring at the tip, one of another power and a damper along the beam, beside both
/// stops.
const LAWS: &str = "[[contact]]\nat_m = 0.25\ndirection = \"transverse\"\nside = \"positive\"\ngap_mm = 0.25\n\
    stiffness_hertz_n_m15 = 2e6\nexponent = 1.6\ndissipation_s_m = 1.5\n\
    [[spring]]\nat_m = 0.5\ndirection = \"transverse\"\nlaw = { polynomial = [50.0, 0.0, 4e8] }\n\
    [[spring]]\nat_m = 0.25\ndirection = \"transverse\"\nlaw = { power = { stiffness = 2e5, exponent = 1.5 } }\n\
    [[spring]]\nat_m = 0.375\ndirection = \"transverse\"\nlaw = { damper = { coefficient = 3.0, exponent = 2.0 } }\n";

#[test]
fn gradients_beside_what_follows_a_law_of_force_are_those_of_runs() -> Outcome {
    let keys = [
        ("spring.0.law.polynomial.2", 4e8),
        ("spring.0.law.polynomial.0", 50.0),
        ("spring.1.law.power.stiffness", 2e5),
        ("spring.1.law.power.exponent", 1.5),
        ("spring.2.law.damper.coefficient", 3.0),
        ("contact.0.gap_mm", 1.0),
        ("contact.0.stiffness_n_m", 2e4),
        ("contact.2.gap_mm", 0.25),
        ("contact.2.stiffness_hertz_n_m15", 2e6),
        ("contact.2.exponent", 1.6),
        ("contact.2.dissipation_s_m", 1.5),
        ("structure.section.height_mm", 6.0),
        ("structure.mass_point.0.mass_kg", 0.05),
        ("damping.ratio", 0.01),
        ("force.0.amplitude_n", 8.0),
    ];
    let beam = BEAM.replace("[method]\nharmonics = 5\n", &format!("{LAWS}[method]\nharmonics = 3\n"));
    let end = |text: &str, keys: &[(&str, f64)], factor: f64| {
        let set: Vec<String> = keys.iter().flat_map(|(key, value)| changed(key, *value, factor, &[])).collect();
        last_row(text, &set).map(|(_, row)| row)
    };
    let forced = format!("{beam}figures = false\npage = false\n{FORCE}");
    let (_folder, base) = last_row(&with_keys(&forced, &keys), &[])?;
    assert!(base["peak_contact_force_n"] > 0.0);
    // Several at once by the same share: the derivative in that direction is the sum of theirs.
    for together in keys.chunks(4) {
        let (above, below) = (end(&forced, together, 1.0 + OF_RESPONSE)?, end(&forced, together, 1.0 - OF_RESPONSE)?);
        for (name, of) in [
            ("amplitude", "fundamental_m"),
            ("peak", "peak_m"),
            ("peak_force", "peak_contact_force_n"),
            ("impulse", "impulse_ns"),
        ] {
            let difference = (above[of] - below[of]) / (2.0 * OF_RESPONSE);
            let gradient: f64 = together.iter().map(|(key, value)| value * base[&format!("d_{name}_d_{key}")]).sum();
            let error = (gradient - difference).abs() / difference.abs().max(1e-2 * base[of].abs());
            assert!(error < 5e-6, "{together:?}, {name}: {gradient} by gradients, {difference}, {error:.1e}");
        }
    }
    // A mode ends at a multiple of the energy that is asked for at its start.
    let mode = format!(
        "{beam}figures = false\npage = false\n[continuation]\nstart_energy_j = 1e-4\nmax_energy_ratio = 1.01\n"
    );
    let keys = [keys[0], keys[2], keys[3], keys[11], keys[12]];
    let (_folder, base) = last_row(&with_keys(&mode, &keys), &[])?;
    for together in keys.chunks(3) {
        let (above, below) = (end(&mode, together, 1.0 + STEP)?, end(&mode, together, 1.0 - STEP)?);
        let difference = (above["frequency_hz"] - below["frequency_hz"]) / (2.0 * STEP);
        let gradient: f64 = together.iter().map(|(key, value)| value * base[&format!("d_frequency_d_{key}")]).sum();
        let error = (gradient - difference).abs() / difference.abs();
        assert!(error < 5e-6, "{together:?}: {gradient} by gradients, {difference}, {error:.1e}");
    }
    Ok(())
}
