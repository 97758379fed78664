//! Springs and dampers with a law of force from the command line.

use std::collections::HashMap;
use std::error::Error;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

/// Runs a scene in a folder; its table of points, numbers by column.
fn run(folder: &Path, text: &str) -> Result<Vec<HashMap<String, f64>>, Box<dyn Error>> {
    fs::write(folder.join("scene.toml"), text)?;
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    let output = call.args(["run", "scene.toml", "--out", "out", "--force", "--quiet"]).current_dir(folder).output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = fs::read_to_string(folder.join("out/branch.csv"))?;
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().ok_or("no header")?.split(',').collect();
    let row = |line: &str| -> HashMap<String, f64> {
        let cells = names.iter().zip(line.split(','));
        cells.map(|(name, cell)| ((*name).to_owned(), cell.parse().unwrap_or(f64::NAN))).collect()
    };
    Ok(lines.map(row).collect())
}

/// A cantilever of Euler and Bernoulli of 19 elements, 0.7 m long, 14 mm square, with translation and rotation of each
/// node, as Matrix Market files.
fn euler_beam(folder: &Path) -> Outcome {
    let (n, l) = (19, 0.7_f64 / 19.0);
    let (bending, mass) = (2.05e11 * 0.014_f64.powi(4) / 12.0, 7800.0 * 0.014 * 0.014);
    let stiffness = [
        [12.0, 6.0 * l, -12.0, 6.0 * l],
        [6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l],
        [-12.0, -6.0 * l, 12.0, -6.0 * l],
        [6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l],
    ];
    let inertia = [
        [156.0, 22.0 * l, 54.0, -13.0 * l],
        [22.0 * l, 4.0 * l * l, 13.0 * l, -3.0 * l * l],
        [54.0, 13.0 * l, 156.0, -22.0 * l],
        [-13.0 * l, -3.0 * l * l, -22.0 * l, 4.0 * l * l],
    ];
    for (file, element, factor) in [("k.mtx", stiffness, bending / l.powi(3)), ("m.mtx", inertia, mass * l / 420.0)] {
        let mut matrix = vec![vec![0.0; 2 * n]; 2 * n];
        for e in 0..n {
            for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
                if let (Some(row), Some(column)) = ((2 * e + i).checked_sub(2), (2 * e + j).checked_sub(2)) {
                    matrix[row][column] += factor * element[i][j];
                }
            }
        }
        let entries: Vec<String> = (0..2 * n)
            .flat_map(|i| (0..2 * n).map(move |j| (i, j)))
            .filter(|(i, j)| matrix[*i][*j] != 0.0)
            .map(|(i, j)| format!("{} {} {:e}\n", i + 1, j + 1, matrix[i][j]))
            .collect();
        let header = format!("%%MatrixMarket matrix coordinate real general\n{0} {0} {1}\n", 2 * n, entries.len());
        fs::write(folder.join(file), header + &entries.concat())?;
    }
    let rows = (0..2 * n).map(|i| format!("{i},{},{}\n", i / 2 + 1, if i % 2 == 0 { 3 } else { 5 }));
    fs::write(folder.join("dofs.csv"), format!("row,node,component\n{}", rows.collect::<String>()))?;
    Ok(())
}

const BEAM: &str = "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\n\
    units = \"m-kg-s\"\n[method]\nharmonics = 5\n[output]\nfigures = false\npage = false\n";

fn with_law(law: &str, end: &str) -> String {
    format!(
        "{BEAM}[[spring]]\nnode = 19\ndirection = [0.0, 0.0, 1.0]\nlaw = {law}\n[continuation]\nmax_energy_ratio = \
        {end}\n"
    )
}

fn prepared() -> Result<TempDir, Box<dyn Error>> {
    let folder = tempdir()?;
    euler_beam(folder.path())?;
    Ok(folder)
}

/// A published benchmark, a cantilever with a cubic spring of 6e9 N/m³ at its tip: linear frequency 23.66147831 Hz;
/// with five harmonics 23.99502170 Hz at the modal amplitude 1e-4.
#[test]
fn a_cantilever_with_a_cubic_spring_has_the_published_frequency() -> Outcome {
    let folder = prepared()?;
    let rows = run(folder.path(), &with_law("{ polynomial = [0.0, 0.0, 6e9] }", "1e3"))?;
    let points: Vec<(f64, f64)> = rows.iter().map(|row| (row["modal_amplitude"], row["frequency_hz"])).collect();
    let at = points.iter().position(|(a, _)| *a > 1e-4).ok_or("the amplitude is not reached")?;
    // Lagrange through the six points around.
    let near = &points[at - 3..at + 3];
    let weight = |i: usize| -> f64 {
        let others = (0..6).filter(|j| *j != i);
        others.map(|j| (1e-4 - near[j].0) / (near[i].0 - near[j].0)).product()
    };
    let found: f64 = (0..6).map(|i| weight(i) * near[i].1).sum();
    assert!((found / 23.995_021_70 - 1.0).abs() < 1e-7, "{found}");
    Ok(())
}

/// The same cubic law in three ways, and a linear one in place of a stiffer beam.
#[test]
fn laws_that_are_the_same_force_are_the_same_mode() -> Outcome {
    let folder = prepared()?;
    let table: String =
        (-400..=400).map(|i| 5e-6 * f64::from(i)).map(|v| format!("{v},{}\n", 6e9 * v.powi(3))).collect();
    // With the names of the columns above, or without.
    fs::write(folder.path().join("named.csv"), format!("displacement_m,force_n\n{table}"))?;
    fs::write(folder.path().join("cubic.csv"), table)?;
    let last = |law: &str| -> Result<(f64, f64), Box<dyn Error>> {
        let text = with_law(law, "1e3").replace("[continuation]\n", "[continuation]\nstart_energy_j = 1e-7\n");
        let rows = run(folder.path(), &text)?;
        let last = rows.last().ok_or("no points")?;
        Ok((last["energy_j"], last["frequency_hz"]))
    };
    let (energy, cubic) = last("{ polynomial = [0.0, 0.0, 6e9] }")?;
    assert!((energy / 1e-4 - 1.0).abs() < 1e-9, "{energy}");
    let (_, power) = last("{ power = { stiffness = 6e9, exponent = 3 } }")?;
    let (_, table) = last("{ table = \"cubic.csv\" }")?;
    assert_eq!(last("{ table = \"named.csv\" }")?.1, table);
    assert!((power / cubic - 1.0).abs() < 1e-10, "{power} {cubic}");
    assert!((table / cubic - 1.0).abs() < 1e-6, "{table} {cubic}");
    assert!(cubic > 24.2, "{cubic}");
    Ok(())
}

/// A mode begins where its scene says: by the amplitude of the first spring, or the energy of the linear mode there.
#[test]
fn a_mode_begins_at_the_amplitude_of_its_first_spring() -> Outcome {
    let folder = prepared()?;
    let first = |start: &str| -> Result<HashMap<String, f64>, Box<dyn Error>> {
        let law = "{ polynomial = [0.0, 0.0, 6e9] }";
        let text = with_law(law, "1e2").replace("[continuation]\n", &format!("[continuation]\n{start}\n"));
        Ok(run(folder.path(), &text)?.into_iter().next().ok_or("no points")?)
    };
    let by_amplitude = first("start_amplitude_m = 2e-5")?;
    assert!((by_amplitude["fundamental_m"].abs() / 2e-5 - 1.0).abs() < 1e-2, "{by_amplitude:?}");
    let by_energy = first(&format!("start_energy_j = {}", by_amplitude["energy_j"]))?;
    assert!((by_energy["fundamental_m"] / by_amplitude["fundamental_m"] - 1.0).abs() < 1e-6);
    for (start, said) in [
        ("start_amplitude_m = 1e-5\nstart_energy_j = 1e-7", "a mode has one beginning, and this scene has two"),
        ("start_amplitude_m = -1e-5", "expected"),
    ] {
        fs::write(
            folder.path().join("scene.toml"),
            with_law("{ polynomial = [0.0, 0.0, 6e9] }", "1e2")
                .replace("[continuation]\n", &format!("[continuation]\n{start}\n")),
        )?;
        let output =
            Command::cargo_bin("nlmodes-cli")?.args(["check", "scene.toml"]).current_dir(folder.path()).output()?;
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && text.contains(said), "{text}");
    }
    Ok(())
}

/// Beside a spring a dashpot is a linear damper, in a damped mode and its damping ratio.
#[test]
fn a_dashpot_beside_a_spring_is_a_linear_damper() -> Outcome {
    let folder = prepared()?;
    let of = |damping: &str| -> Result<f64, Box<dyn Error>> {
        let text = with_law("{ polynomial = [100.0, 0.0, 6e9] }", "1e2")
            + "[[response]]\nkind = \"damped-mode\"\n[damping]\nratio = 0.002\n"
            + damping;
        let rows = run(folder.path(), &text)?;
        Ok(rows.last().ok_or("no points")?["damping_ratio"])
    };
    let place = "node = 10\ndirection = [0.0, 0.0, 1.0]\n";
    let dashpot = of(&format!("[[damping.dashpot]]\n{place}damping_n_s_m = 1.5\n"))?;
    let damper = of(&format!("[[spring]]\n{place}law = {{ damper = {{ coefficient = 1.5, exponent = 1 }} }}\n"))?;
    let none = of("")?;
    assert!((dashpot / damper - 1.0).abs() < 1e-9, "{dashpot} {damper}");
    assert!(dashpot > none + 1e-4, "{dashpot} {none}");
    Ok(())
}

/// A table with a force at rest, and one that is not there, are refused at their key.
#[test]
fn a_table_that_is_no_law_is_refused() -> Outcome {
    let folder = prepared()?;
    fs::write(folder.path().join("preloaded.csv"), "-1.0,-1.0\n0.0,0.5\n1.0,2.0\n")?;
    for (file, said) in [("preloaded.csv", "0.5 N at rest"), ("missing.csv", "missing.csv: cannot be read")] {
        fs::write(folder.path().join("scene.toml"), with_law(&format!("{{ table = \"{file}\" }}"), "2.0"))?;
        let mut call = Command::cargo_bin("nlmodes-cli")?;
        let output = call.args(["check", "scene.toml"]).current_dir(folder.path()).output()?;
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(said) && text.contains("law = { table"), "{text}");
    }
    Ok(())
}

/// Where Duffing's oscillator jumps in a sweep of its own integration in time: the amplitude falls, or rises, by half.
fn swept(upward: bool) -> f64 {
    let (ratio, cubic, force) = (0.02, 0.05, 0.1);
    let rate = |t: f64, z: [f64; 2], omega: f64| {
        [z[1], force * (omega * t).cos() - 2.0 * ratio * z[1] - z[0] - cubic * z[0].powi(3)]
    };
    let (mut z, mut before) = ([0.0, 0.0], None::<f64>);
    for step in 0..300 {
        let share = f64::from(step) / 300.0;
        let omega = if upward { 0.9 + 0.6 * share } else { 1.5 - 0.6 * share };
        let h = std::f64::consts::TAU / omega / 60.0;
        let mut largest = 0.0_f64;
        for j in 0..60 * 120 {
            let t = h * f64::from(j % 60);
            let add = |k: [f64; 2], by: f64| [z[0] + by * k[0], z[1] + by * k[1]];
            let a = rate(t, z, omega);
            let b = rate(t + 0.5 * h, add(a, 0.5 * h), omega);
            let c = rate(t + 0.5 * h, add(b, 0.5 * h), omega);
            let d = rate(t + h, add(c, h), omega);
            z = [0, 1].map(|i| z[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
            if j >= 60 * 100 {
                largest = largest.max(z[0].abs());
            }
        }
        let has_jumped = before.is_some_and(|b| if upward { largest < 0.6 * b } else { largest > 1.5 * b });
        if has_jumped {
            return omega;
        }
        before = Some(largest);
    }
    f64::NAN
}

/// The jumps that `summary.json` names are those of sweeps in time, to the step of these and what a sweep overshoots.
#[test]
fn jumps_are_where_sweeps_in_time_jump() -> Outcome {
    let folder = tempdir()?;
    for file in ["k.mtx", "m.mtx"] {
        fs::write(folder.path().join(file), "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 1.0\n")?;
    }
    fs::write(folder.path().join("dofs.csv"), "row,node,component\n0,1,3\n")?;
    let [low, high] = [0.9, 1.5].map(|omega| omega / std::f64::consts::TAU);
    let text = BEAM.replace("harmonics = 5", "harmonics = 7")
        + "[[spring]]\nnode = 1\ndirection = [0.0, 0.0, 1.0]\nlaw = { polynomial = [0.0, 0.0, 0.05] }\n\
           [damping]\nratio = 0.02\n[[force]]\nnode = 1\ndirection = [0.0, 0.0, 1.0]\namplitude_n = 0.1\n"
        + &format!(
            "[[response]]\nkind = \"frequency\"\nfrequency_hz = [{low}, {high}]\nsweep = true\nsweep_s = 4000\n"
        );
    run(folder.path(), &text)?;
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("out/summary.json"))?)?;
    let level = &summary["levels"][0];
    let jumps = level["jumps"].as_array().ok_or("no jumps")?;
    assert_eq!(jumps.len(), 2, "{level}");
    for (direction, upward) in [("up", true), ("down", false)] {
        let jump = jumps.iter().find(|jump| jump["direction"] == direction).ok_or("no such jump")?;
        let found = jump["frequency_hz"].as_f64().ok_or("no number")? * std::f64::consts::TAU;
        let swept = swept(upward);
        assert!((found / swept - 1.0).abs() < 5e-3, "{direction}: {found} {swept}");
        // The sweep of the program goes on, and is late by what the motion takes to leave.
        let own = jump["swept_frequency_hz"].as_f64().ok_or("no sweep")? * std::f64::consts::TAU;
        let late = if upward { own / found - 1.0 } else { 1.0 - own / found };
        assert!(late > -1e-3 && late < 0.02, "{direction}: {own} {found}");
        let [before, after] = ["before", "after"].map(|key| jump["amplitude_m"][key].as_f64().unwrap_or(f64::NAN));
        assert!(if upward { after < 0.6 * before } else { after > 1.5 * before }, "{jump}");
    }
    assert!(level["peak"]["amplitude_m"].as_f64() > Some(1.0), "{level}");
    Ok(())
}

/// Two masses of 1 kg on springs of 1 N/m before a Hertz stop: as a rod, as matrices, and reduced elsewhere.
#[test]
fn hertz_stops_of_nodes_and_rows_are_those_of_a_rod() -> Outcome {
    let folder = tempdir()?;
    for (name, text) in [
        ("k.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2\n2 1 -1\n2 2 1\n"),
        ("m.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 1\n2 2 1\n"),
        ("d.csv", "row,node,component\n0,1,ux\n1,2,ux\n"),
    ] {
        fs::write(folder.path().join(name), text)?;
    }
    let stop = "gap_m = 1.0\nstiffness_hertz_n_m15 = 150.0\ndissipation_s_m = 0.1\n";
    let end = |force: &str| {
        format!(
            "[damping]\nrayleigh = {{ stiffness_s = 0.03 }}\n[[force]]\n{force}\n[[response]]\nkind = \"frequency\"\n\
             frequency_hz = [0.10, 0.11]\nlevels_n = [0.3]\n[method]\nharmonics = 10\n[output]\nfigures = false\n\
             page = false\n"
        )
    };
    let rod = format!(
        "[structure]\nkind = \"rod\"\nlength_m = 2.0\nelements = 2\nmass_matrix = \"lumped\"\nstart = \"clamped\"\n\
         material = {{ youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }}\nsection = {{ area_m2 = 1.0 }}\n\
         [[structure.mass_point]]\nat_m = 2.0\nmass_kg = 0.5\n[[contact]]\nat_m = 2.0\ndirection = \"axial\"\n\
         side = \"positive\"\n{stop}{}",
        end("at_m = 1.0\ndirection = \"axial\"")
    );
    let matrices = format!(
        "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"d.csv\"\n[[contact]]\n\
         node = 2\nnormal = [1.0, 0.0, 0.0]\n{stop}[reduction]\nkind = \"open-modes\"\nmodes = 2\n{}",
        end("node = 1\ndirection = [1.0, 0.0, 0.0]")
    );
    // Eigenvalues (3 ∓ √5)/2, and their vectors.
    let root = 5.0_f64.sqrt();
    let hz = [(3.0 - root) / 2.0, (3.0 + root) / 2.0].map(|square: f64| square.sqrt() / std::f64::consts::TAU);
    let of = |square: f64| [1.0, 2.0 - square].map(|v| v / (1.0 + (2.0 - square).powi(2)).sqrt());
    let [a, b] = [of((3.0 - root) / 2.0), of((3.0 + root) / 2.0)];
    let reduced = format!(
        "[structure]\nkind = \"reduced\"\nfrequencies_hz = [{:.17}, {:.17}]\n\
         contact_rows = [[{:.17}, {:.17}], [{:.17}, {:.17}]]\nflexibility_m_n = [[1.0, 1.0], [1.0, 2.0]]\n[[contact]]\n\
         row = 2\n{stop}{}",
        hz[0],
        hz[1],
        a[0],
        b[0],
        a[1],
        b[1],
        end("row = 1")
    );
    let expected = run(folder.path(), &rod)?;
    assert!(expected.iter().any(|row| row["peak_contact_force_n"] > 1.0));
    for text in [matrices, reduced] {
        let found = run(folder.path(), &text)?;
        assert_eq!(found.len(), expected.len());
        for (own, other) in found.iter().zip(&expected) {
            for column in ["frequency_hz", "fundamental_m", "peak_contact_force_n"] {
                let (a, b) = (own[column], other[column]);
                assert!((a - b).abs() <= 1e-8 * b.abs().max(1e-3), "{column}: {a} {b}");
            }
        }
    }
    Ok(())
}

/// One mass of 1 kg on 1 N/m, what else acts on it, and a constant force of 1.5 N.
fn one_mass(acts: &str) -> String {
    format!(
        "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 1\nmass_matrix = \"lumped\"\nstart = \"clamped\"\n\
         material = {{ youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }}\nsection = {{ area_m2 = 1.0 }}\n\
         [[structure.mass_point]]\nat_m = 1.0\nmass_kg = 0.5\n{acts}\n[[static_force]]\nat_m = 1.0\n\
         direction = \"axial\"\nforce_n = 1.5\n[method]\nharmonics = 60\n[continuation]\nstart_energy_j = 1e-2\n\
         max_energy_ratio = 3e2\n[output]\nfigures = false\npage = false\n"
    )
}

/// The place at rest, by halving, and the frequency (Hz) at an energy (J) above it, by a quadrature between the turning
/// points, of one kilogram in the potential `v` with the force `−v'`.
fn by_quadrature(v: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64, energy: f64) -> (f64, f64) {
    let halved = |mut low: f64, mut high: f64, is_below: &dyn Fn(f64) -> bool| {
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if is_below(middle) { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let rest = halved(0.0, 2.0, &|x| slope(x) < 0.0);
    let total = v(rest) + energy;
    let low = halved(rest - 10.0, rest, &|x| v(x) > total);
    let high = halved(rest, rest + 10.0, &|x| v(x) < total);
    let (middle, half, count) = (0.5 * (low + high), 0.5 * (high - low), 1000);
    let part = |j: usize| {
        let theta = std::f64::consts::PI * (j as f64 + 0.5) / f64::from(count);
        half * theta.sin() / (2.0 * (total - v(middle - half * theta.cos()))).sqrt()
    };
    let half_period = (0..count as usize).map(part).sum::<f64>() * std::f64::consts::PI / f64::from(count);
    (rest, 0.5 / half_period)
}

/// About the place where a constant force leaves a mass on a cubic spring, on that beside a linear stop, and on a Hertz
/// stop, which it presses and leaves in part of each period, the mode has the frequencies of a quadrature.
#[test]
fn under_a_constant_force_modes_with_laws_are_those_about_the_place_at_rest() -> Outcome {
    let folder = tempdir()?;
    let spring = "[[spring]]\nat_m = 1.0\ndirection = \"axial\"\nlaw = { polynomial = [0.0, 0.0, 0.7] }";
    let stop = "[[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 0.1\n\
        stiffness_hertz_n_m15 = 20.0";
    let cubic = |x: f64| 0.5 * x * x + 0.175 * x.powi(4) - 1.5 * x;
    let hertz = |x: f64| 0.5 * x * x + 8.0 * (x - 0.1).max(0.0).powf(2.5) - 1.5 * x;
    let pull = |x: f64| x + 0.7 * x.powi(3) - 1.5;
    let press = |x: f64| x + 20.0 * (x - 0.1).max(0.0).powf(1.5) - 1.5;
    let beside = format!("{}\n{spring}", stop.replace("stiffness_hertz_n_m15 = 20.0", "stiffness_n_m = 40.0"));
    let both = |x: f64| cubic(x) + 20.0 * (x - 0.1).max(0.0).powi(2);
    let push = |x: f64| pull(x) + 40.0 * (x - 0.1).max(0.0);
    type Law<'a> = &'a dyn Fn(f64) -> f64;
    let cases: [(&str, Law<'_>, Law<'_>, f64); 3] =
        [(spring, &cubic, &pull, 1e-10), (&beside, &both, &push, 1e-6), (stop, &hertz, &press, 1e-7)];
    for (acts, v, slope, near) in cases {
        let kind = if acts == beside { "[method]\nkind = \"hbm\"" } else { "[method]" };
        let rows = run(folder.path(), &one_mass(acts).replace("[method]", kind))?;
        assert!(rows.len() > 10);
        for row in rows.iter().step_by(5) {
            let (_, hz) = by_quadrature(v, slope, row["total_energy_j"]);
            assert!((row["frequency_hz"] / hz - 1.0).abs() < near, "{acts}: {row:?} {hz}");
        }
    }
    let summary: serde_json::Value = serde_json::from_slice(&fs::read(folder.path().join("out/summary.json"))?)?;
    let (rest, _) = by_quadrature(hertz, press, 1.0);
    let found = summary["rest"][0]["force_n"].as_f64().ok_or("no force at rest")?;
    assert!((found / (1.5 - rest) - 1.0).abs() < 1e-10, "{found} {rest}");
    let last = run(folder.path(), &one_mass(stop))?.len() - 1;
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    let output = call.args(["verify", "out", "--point", &last.to_string()]).current_dir(folder.path()).output()?;
    let text = String::from_utf8(output.stdout)?;
    let missing = text.lines().find(|line| line.starts_with("what is missing")).ok_or(text.clone())?;
    let missing: f64 = missing.split_whitespace().nth(5).ok_or("no number")?.parse()?;
    assert!(missing < 1e-4, "{text}");
    // In time it stays where it rests.
    let scene = one_mass(stop);
    let (structure, _) = scene.split_once("[method]").ok_or("no method")?;
    let motion = "[transient]\nduration_s = 20.0\nfrom = \"static\"\n[[transient.place]]\nat_m = 1.0\n\
        direction = \"axial\"\n[output]\nfigures = false\npage = false\n";
    fs::write(folder.path().join("still.toml"), format!("{structure}{motion}"))?;
    let output = Command::cargo_bin("nlmodes-cli")?.args(["run", "still.toml"]).current_dir(folder.path()).output()?;
    let said = String::from_utf8(output.stdout)?;
    assert!(said.contains("1 m, axial: from 0.256909 to 0.256909 m"), "{said}{rest}");
    Ok(())
}

/// A force at the tip of a bar, a cubic spring at its middle, a rigid stop before the tip: by the place at rest, from
/// the equilibrium of two springs in series, they are a bar with a smaller gap and a spring of degree three.
#[test]
fn gaps_and_laws_under_a_static_load_are_those_at_rest() -> Outcome {
    let folder = tempdir()?;
    let (force, kappa, gap) = (0.4_f64, 3.0, 1.0);
    let mut v = 0.5 * force;
    for _ in 0..50 {
        v -= (v - 0.5 * (force - kappa * v.powi(3))) / (1.0 + 1.5 * kappa * v * v);
    }
    let scene = |gap: f64, law: [f64; 3], load: &str| {
        format!(
            "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 20\nstart = \"clamped\"\n\
             material = {{ youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }}\nsection = {{ area_m2 = 1.0 }}\n\
             [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = {gap:?}\n[[spring]]\n\
             at_m = 0.5\ndirection = \"axial\"\nlaw = {{ polynomial = {law:?} }}\n{load}\n[damping]\nratio = 0.02\n\
             [[force]]\nat_m = 0.75\n[[response]]\nkind = \"frequency\"\nfrequency_hz = [0.25, 0.4]\n\
             levels_n = [0.05]\n[method]\nharmonics = 9\n[output]\nfigures = false\npage = false\n"
        )
    };
    let load = format!("[[static_force]]\nat_m = 1.0\ndirection = \"axial\"\nforce_n = {force}");
    let loaded = run(folder.path(), &scene(gap, [0.0, 0.0, kappa], &load))?;
    let about = [3.0 * kappa * v * v, 3.0 * kappa * v, kappa];
    let moved = v + 0.5 * force;
    let shifted = run(folder.path(), &scene(gap - moved, about, ""))?;
    assert!(loaded.len() == shifted.len() && loaded.iter().any(|row| row["peak_contact_force_n"] > 0.1));
    for (a, b) in loaded.iter().zip(&shifted) {
        assert!((a["frequency_hz"] / b["frequency_hz"] - 1.0).abs() < 1e-9, "{a:?} {b:?}");
        assert!((a["fundamental_m"] / b["fundamental_m"] - 1.0).abs() < 1e-7, "{a:?} {b:?}");
        assert!((a["peak_m"] - moved - b["peak_m"]).abs() < 1e-7, "{a:?} {b:?}");
    }
    Ok(())
}

/// Relative files of a scene count from the folder in which it was run, wherever its results are asked about.
#[test]
fn results_are_verified_and_settled_from_any_folder() -> Outcome {
    let (folder, elsewhere) = (tempdir()?, tempdir()?);
    let table: String =
        (-400..=400).map(|i| 0.01 * f64::from(i)).map(|v| format!("{v},{}\n", 0.7 * v.powi(3))).collect();
    fs::write(folder.path().join("cubic.csv"), table)?;
    let spring = "[[spring]]\nat_m = 1.0\ndirection = \"axial\"\nlaw = { table = \"cubic.csv\" }";
    let load = "[damping]\nratio = 0.05\n[[force]]\nat_m = 1.0\n[[response]]\nkind = \"frequency\"\n\
        frequency_hz = [0.1, 0.14]\nlevels_n = [0.2]";
    let scene = one_mass(&format!("{spring}\n{load}")).replace("start_energy_j = 1e-2\nmax_energy_ratio = 3e2\n", "");
    let rows = run(folder.path(), &scene.replace("harmonics = 60", "harmonics = 9"))?;
    let point = (rows.len() / 2).to_string();
    let results = folder.path().join("out");
    let said = |command: &str, from: &Path, results: &Path| -> Result<String, Box<dyn Error>> {
        let mut call = Command::cargo_bin("nlmodes-cli")?;
        let output = call.arg(command).arg(results).args(["--point", &point]).current_dir(from).output()?;
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Ok(String::from_utf8(output.stdout)?)
    };
    for command in ["verify", "settle"] {
        let here = said(command, folder.path(), Path::new("out"))?;
        assert_eq!(said(command, elsewhere.path(), &results)?, here);
    }
    // Both may move together.
    let moved = elsewhere.path().join("moved");
    fs::rename(folder.path(), &moved)?;
    said("verify", elsewhere.path(), Path::new("moved/out"))?;
    Ok(())
}
