//! Messages about structures from files, and files for other programs.

use std::fs;

use tempfile::tempdir;

use super::{
    METHOD, Outcome, along_x, beside, branch, call, configs, free_rod, matrix_market, rod, run, shaken, text, wall,
};

#[test]
fn mass_beside_supports_that_the_files_hold_already_is_missed_aloud() -> Outcome {
    let folder = tempdir()?;
    let (k, m) = rod(12);
    let more = format!("{}{}", wall(1e-4), shaken("direction = [1.0, 0.0, 0.0]\n", "moves"));
    branch(&folder, (&k, &m), &along_x(1, 12), &more)?;
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("again"));
    let output = call(&["run", &scene.to_string_lossy(), "--out", &out.to_string_lossy()])?;
    assert!(text(&output.stderr).contains("between supported nodes and their neighbours"), "{}", text(&output.stderr));
    fs::write(&scene, fs::read_to_string(&scene)?.replace("direction = [1.0, 0.0, 0.0]\nstop", "stop"))?;
    let output = call(&["check", &scene.to_string_lossy()])?;
    assert!(text(&output.stderr).contains("`base_motion.direction` must be a vector"), "{}", text(&output.stderr));
    Ok(())
}

#[test]
fn check_says_what_the_files_hold_and_modes_are_those_of_calculix() -> Outcome {
    for (name, says) in [
        ("bracket", "1221 degrees of freedom of 407 nodes"),
        ("plate", "1200 degrees of freedom of 400 nodes"),
        ("cantilevers", "node 5 before node 109, normal [0, 0, 1], gap 0.0002 m, rigid"),
    ] {
        let scene = configs(&format!("structures/{name}.toml")).to_string_lossy().into_owned();
        let checked = call(&["check", &scene])?;
        assert_eq!((checked.status.code(), text(&checked.stderr).as_str()), (Some(0), ""), "{name}");
        assert!(text(&checked.stdout).contains(says), "{}", text(&checked.stdout));
        let modes = text(&call(&["modes", &scene])?.stdout);
        let found: Vec<f64> =
            modes.lines().skip(4).filter_map(|line| line.split_whitespace().nth(1)?.parse().ok()).collect();
        let expected = fs::read_to_string(configs(&format!("structures/{name}.hz")))?;
        for (found, expected) in found.iter().zip(expected.lines()) {
            let expected: f64 = expected.parse()?;
            assert!((found / expected - 1.0).abs() < 1e-6, "{name}: {found} {expected}"); // seven digits
        }
        assert!(found.len() >= 8, "{modes}");
    }
    Ok(())
}

#[test]
fn the_plate_runs_and_its_motion_is_there_for_paraview() -> Outcome {
    let folder = tempdir()?;
    let points = run(&configs("structures/plate.toml"), folder.path(), &["continuation.max_energy_ratio=1.5"])?;
    assert!((points[0][0] / 273.5353 - 1.0).abs() < 1e-6 && points.last().is_some_and(|last| last[0] > 274.0));
    let collection = fs::read_to_string(folder.path().join("motion.pvd"))?;
    // 24 equidistant frames, and those where contacts begin, are largest and end.
    let frames = collection.matches("<DataSet").count();
    assert!((25..=24 + 3 * 8).contains(&frames), "{frames}");
    let frame = fs::read_to_string(folder.path().join("motion_000.vtu"))?;
    assert!(["displacement", "contact_force", "gap"].iter().all(|name| frame.contains(&format!("Name=\"{name}\""))));
    // A single node covers no face; the tips of the rotor's blades do.
    assert!(!frame.contains("contact_pressure"));
    run(&configs("structures/rotor.toml"), folder.path(), &["continuation.max_energy_ratio=1.05"])?;
    assert!(fs::read_to_string(folder.path().join("motion_000.vtu"))?.contains("Name=\"contact_pressure\""));
    Ok(())
}

#[test]
fn what_does_not_fit_is_refused_with_its_reason() -> Outcome {
    let scene = configs("structures/bracket.toml").to_string_lossy().into_owned();
    for (value, says) in [
        ("structure.units=\"mm-t\"", "there are no units `mm-t`"),
        ("structure.mass=\"bracket.dof\"", "expected a file of a matrix"),
        ("structure.dofs=\"brackt.dof\"", "cannot be read"),
        ("structure.fixed=[\"TOP\"]", "there is no node set `TOP`; expected one of"),
        ("structure.length_m=1.0", "unknown key `structure.length_m`"),
        ("contact.0.nodes=\"FOOT\"", "none with a row of its own in the matrices"),
        ("contact.0.nodes=[999999]", "the place of node 999999 is not known"),
        ("contact.0.gap_m=1e-3", "`gap_m` says the gap already"),
        ("contact.0.normal=[0,0,0]", "the normal has no direction"),
        ("contact.0.normal=\"surfce\"", "3 numbers in square brackets, or \"surface\""),
        ("contact.0.gapp=1e-3", "unknown key `contact.0.gapp`"),
        ("contact.0.against=\"PAD\"", "there is no wall between two bodies"),
    ] {
        for command in ["check", "run"] {
            let output = call(&[command, &scene, "--set", value])?;
            let errors = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{value}: {errors}");
            let is_placed = errors.contains("bracket.toml") || errors.contains("command line:1");
            assert!(errors.contains(says) && is_placed, "{value}: {errors}");
        }
    }
    Ok(())
}

/// Output of `check` for these matrices; `rows` give node and component.
fn said_of((k, m): (&super::Matrix, &super::Matrix), rows: &[(usize, &str)]) -> Outcome<String> {
    let folder = tempdir()?;
    let at = |name: &str| folder.path().join(name);
    fs::write(at("k.mtx"), matrix_market(k))?;
    fs::write(at("m.mtx"), matrix_market(m))?;
    let table: Vec<String> =
        rows.iter().enumerate().map(|(i, (node, name))| format!("{},{node},{name}", i + 1)).collect();
    fs::write(at("dofs.csv"), table.join("\n"))?;
    let files = "stiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"";
    let stop = "[[contact]]\nnode = 12\nnormal = [1.0, 0.0, 0.0]\ngap_m = 1e-4";
    let rest = "[continuation]\nmax_energy_ratio = 3.0";
    fs::write(
        at("scene.toml"),
        format!("[structure]\nkind = \"matrices\"\n{files}\n{stop}\n{METHOD}mode = 3\n{rest}\n"),
    )?;
    let output = call(&["check", &at("scene.toml").to_string_lossy()])?;
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
    Ok(text(&output.stderr))
}

#[test]
fn a_missing_support_and_a_buckled_structure_are_named() -> Outcome {
    // A free rod along x with the wall, and another one along y without contact.
    let (k, m) = free_rod(12);
    let rows: Vec<(usize, &str)> = along_x(0, 13).into_iter().chain((100..113).map(|node| (node, "uy"))).collect();
    let said = said_of((&beside(&k, &k), &beside(&m, &m)), &rows)?;
    let says = [
        "the structure can move as a rigid body (the bodies of nodes 0, 100)",
        "holding all contacts leaves 1 of these",
    ];
    assert!(says.iter().chain(&["a support is missing"]).all(|says| said.contains(says)), "{said}");
    // K − σ M with σ above the square of the first frequency, (π/2)² EA/m.
    let (mut k, m) = rod(12);
    let sigma = 1.2 * (std::f64::consts::FRAC_PI_2).powi(2) * 2.1e7 / 0.78;
    k.iter_mut().flatten().zip(m.iter().flatten()).for_each(|(k, m)| *k -= sigma * m);
    let said = said_of((&k, &m), &along_x(1, 12))?;
    assert!(
        said.contains("the stiffness is negative in mode 1") && said.contains("buckled under the preload"),
        "{said}"
    );
    Ok(())
}

/// A rod that floats between stops: its first mode is none to begin with, and a load does not say where it is.
#[test]
fn a_floating_structure_is_named_by_check_before_a_branch_and_before_a_response() -> Outcome {
    let (k, m) = free_rod(12);
    let folder = tempdir()?;
    let at = |name: &str| folder.path().join(name);
    fs::write(at("k.mtx"), matrix_market(&k))?;
    fs::write(at("m.mtx"), matrix_market(&m))?;
    let rows: Vec<String> = (0..13).map(|i| format!("{},{},ux", i + 1, i + 1)).collect();
    fs::write(at("dofs.csv"), rows.join("\n"))?;
    let files = "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\n";
    let stop = |x: f64| format!("[[contact]]\nnode = 13\nnormal = [{x:?}, 0.0, 0.0]\ngap_m = 1e-4\n");
    let said = |rest: &str| -> Outcome<(Option<i32>, String)> {
        fs::write(at("scene.toml"), format!("{files}{}{}{rest}", stop(1.0), stop(-1.0)))?;
        let output = call(&["check", &at("scene.toml").to_string_lossy()])?;
        Ok((output.status.code(), text(&output.stderr) + &text(&output.stdout)))
    };
    let branch = |mode: usize| format!("{METHOD}mode = {mode}\n[continuation]\nmax_energy_ratio = 3.0\n");
    let (code, rigid) = said(&branch(1))?;
    let says = "mode 1 strains nothing: the structure has one rigid-body motion";
    assert!(code == Some(2) && rigid.contains(says) && rigid.contains("expected 2 or more"), "{rigid}");
    let (code, elastic) = said(&branch(2))?;
    assert!(code == Some(0) && elastic.contains("one rigid-body motion"), "{elastic}");
    let load = "[[force]]\nnode = 1\ndirection = [1.0, 0.0, 0.0]\namplitude_n = 2.0\n[damping]\nratio = 0.02\n\
                [[response]]\nkind = \"frequency\"\nfrequency_hz = [100.0, 200.0]\n";
    let (code, response) = said(&format!("{METHOD}{load}"))?;
    let says = "the structure floats (the body of node 1): it has one rigid-body motion";
    assert!(code == Some(2) && response.contains(says) && response.contains("a support is missing"), "{response}");
    // Beams by their ends.
    for (start, says) in [("free", "three rigid-body motions"), ("pinned", "one rigid-body motion")] {
        let beam = format!(
            "[structure]\nkind = \"beam\"\nlength_m = 0.5\nelements = 6\nstart = \"{start}\"\n[structure.material]\n\
             youngs_modulus_pa = 2e11\ndensity_kg_m3 = 7800\n[structure.section]\nwidth_m = 0.02\nheight_m = 0.003\n\
             [[contact]]\nat_m = 0.5\ndirection = \"transverse\"\nside = \"positive\"\ngap_m = 1e-3\n"
        );
        let load = load.replace("node = 1\ndirection = [1.0, 0.0, 0.0]", "at_m = 0.5\ndirection = \"transverse\"");
        fs::write(at("beam.toml"), format!("{beam}{METHOD}{load}"))?;
        let output = call(&["check", &at("beam.toml").to_string_lossy()])?;
        let said = text(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(&format!("floats: it has {says}")), "{said}");
        assert!(said.contains("`[[structure.spring]]`"), "{said}");
    }
    Ok(())
}

/// Two rods that float, of which a stop holds one: the other one goes on to float.
#[test]
fn what_no_contact_feels_has_no_frequency_with_the_contacts_held_either() -> Outcome {
    let (k, m) = free_rod(12);
    let (k, m) = (beside(&k, &k), beside(&m, &m));
    let folder = tempdir()?;
    let at = |name: &str| folder.path().join(name);
    fs::write(at("k.mtx"), matrix_market(&k))?;
    fs::write(at("m.mtx"), matrix_market(&m))?;
    let rows: Vec<String> = (0..26).map(|i| format!("{},{},ux", i + 1, i + 1)).collect();
    fs::write(at("dofs.csv"), rows.join("\n"))?;
    let files = "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\n";
    let stop = "[[contact]]\nnode = 13\nnormal = [1.0, 0.0, 0.0]\ngap_m = 1e-4\n";
    fs::write(at("scene.toml"), format!("{files}{stop}{METHOD}mode = 3\n[continuation]\nmax_energy_ratio = 3.0\n"))?;
    let modes = text(&call(&["modes", &at("scene.toml").to_string_lossy()])?.stdout);
    let table: Vec<Vec<&str>> = modes.lines().skip(4).map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(table[0][1..3], ["0.00000000", "0.00000000"], "{modes}");
    assert_eq!(table[1][1], "0.00000000", "{modes}");
    // Of the held rod of 1 m the first frequency is that of a quarter wave.
    let hz: f64 = table[1][2].parse()?;
    assert!((hz / (0.25 * (2.1e7_f64 / 0.78).sqrt()) - 1.0).abs() < 1e-2, "{modes}");
    Ok(())
}
