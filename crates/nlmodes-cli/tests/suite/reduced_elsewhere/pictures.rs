//! Pictures of a structure that was reduced elsewhere, compared with those of its matrices.

use std::fmt::Write as _;
use std::fs;

use tempfile::{TempDir, tempdir};

use super::{Chain, MODE, Outcome, call, said};

/// Largest difference of displacements over the largest one: frames have 24 bits.
const SAME: f32 = 1e-6;

/// The masses 5, 10 … of the chain, joined by lines.
fn mesh(folder: &TempDir) -> Outcome<Vec<usize>> {
    let masses: Vec<usize> = (1..=8).map(|k| 5 * k).collect();
    let (mut nodes, mut lines, mut dofs) = (String::new(), String::new(), "row,node,component\n".to_owned());
    for (row, mass) in masses.iter().enumerate() {
        writeln!(nodes, "{mass} {mass}.0 0.0 0.0")?;
        writeln!(dofs, "{},{mass},ux", row + 1)?;
    }
    for (element, pair) in masses.windows(2).enumerate() {
        writeln!(lines, "{} 1 0 {} {}", element + 1, pair[0], pair[1])?;
    }
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n{nodes}$EndNodes\n$Elements\n7\n{lines}$EndElements\n"
    );
    fs::write(folder.path().join("chain.msh"), text)?;
    fs::write(folder.path().join("picture.csv"), dofs)?;
    Ok(masses)
}

/// The displacements in a frame of a run.
fn frame(folder: &TempDir, scene: &str, number: usize) -> Outcome<Vec<f32>> {
    fs::write(folder.path().join("scene.toml"), scene)?;
    let output = call(folder, &["run", "scene.toml", "--quiet", "--out", "results"])?;
    assert!(output.status.success(), "{}", said(&output));
    let text = fs::read_to_string(folder.path().join(format!("results/motion_{number:03}.vtu")))?;
    let (_, field) = text.split_once("Name=\"displacement\"").ok_or("no displacement")?;
    let bytes = decoded(field.lines().nth(1).ok_or("no data")?);
    fs::remove_dir_all(folder.path().join("results"))?;
    Ok(bytes[4..].chunks_exact(4).map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect())
}

/// The bytes of a text in base64.
fn decoded(text: &str) -> Vec<u8> {
    let digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let value = |letter: char| digits.find(letter).map(|value| value as u32);
    let values: Vec<u32> = text.trim().chars().filter_map(value).collect();
    let four = |four: &[u32]| {
        let bits = four.iter().fold(0, |bits, value| bits << 6 | value) << (6 * (4 - four.len()));
        bits.to_be_bytes()[1..four.len()].to_vec()
    };
    values.chunks(4).flat_map(four).collect()
}

/// Displacements of nodes with what contact and constant forces add beyond the modes, whole or residual; without that
/// those of the modes alone, which penetrate the stop.
#[test]
fn pictures_are_those_of_the_matrices() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: true, n: 40 });
    let nodes = mesh(&folder)?;
    let push = "[[static_force]]\nROW\nforce_n = 3.0\n";
    let at_node = push.replace("ROW", "node = 20\ndirection = [1, 0, 0]");
    let matrices =
        chain.matrices(&folder, 12, &[(40, 1.0, 1e-3)])?.replace("[reduction]", "mesh = \"chain.msh\"\n[reduction]");
    let expected = |number: usize| frame(&folder, &format!("{matrices}{MODE}{at_node}"), number);
    let expected = [expected(0)?, expected(7)?];
    let largest = expected[0].iter().fold(0.0_f32, |largest, u| largest.max(u.abs()));
    assert!(expected[0].len() == 3 * nodes.len() && largest > 1e-3, "{expected:?}");
    let off = |found: &[f32], expected: &[f32]| {
        found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0_f32, f32::max) / largest
    };
    for flexibility in ["flexibility_m_n", "residual_flexibility_m_n"] {
        let [by_rows, answers] = chain.seen(12, &nodes, &[40, 20], flexibility == "flexibility_m_n");
        fs::write(folder.path().join("shapes.csv"), by_rows)?;
        fs::write(folder.path().join("answers.csv"), answers)?;
        let reduced = chain.reduced(&folder, 12, &[40, 20], flexibility)?;
        let picture = "[structure.picture]\nrows = \"shapes.csv\"\ndofs = \"picture.csv\"\nmesh = \"chain.msh\"\n";
        let rest = format!("[[contact]]\nrow = 1\ngap_m = 1e-3\n{MODE}{}", push.replace("ROW", "row = 2"));
        let whole = format!("{reduced}{picture}flexibility_m_n = \"answers.csv\"\n{rest}");
        for (number, expected) in [0, 7].into_iter().zip(&expected) {
            let found = frame(&folder, &whole, number)?;
            assert!(found.len() == expected.len() && off(&found, expected) < SAME, "{found:?} {expected:?}");
        }
        let modes_alone = frame(&folder, &format!("{reduced}{picture}{rest}"), 0)?;
        let missing = off(&modes_alone, &expected[0]);
        assert!(missing > 1e-5 && missing < 0.1, "{missing}");
        fs::write(folder.path().join("scene.toml"), &whole)?;
        let check = said(&call(&folder, &["check", "scene.toml"])?);
        assert!(check.contains("8 displacements of 8 nodes, shapes.csv; static ones answers.csv"), "{check}");
    }
    Ok(())
}

/// What does not fit is refused at its key.
#[test]
fn pictures_that_do_not_fit_are_refused() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: true, n: 40 });
    let nodes = mesh(&folder)?;
    let [by_rows, answers] = chain.seen(12, &nodes, &[40], true);
    fs::write(folder.path().join("shapes.csv"), &by_rows)?;
    fs::write(
        folder.path().join("fewer.csv"),
        by_rows.lines().skip(1).map(|line| format!("{line}\n")).collect::<String>(),
    )?;
    fs::write(folder.path().join("answers.csv"), answers.lines().skip(1).collect::<Vec<_>>().join("\n"))?;
    fs::write(
        folder.path().join("other.csv"),
        "1,5,ux\n2,10,ux\n3,15,ux\n4,20,ux\n5,25,ux\n6,30,ux\n7,35,ux\n8,41,ux\n",
    )?;
    let reduced = chain.reduced(&folder, 12, &[40], "flexibility_m_n")?;
    let picture = "[structure.picture]\nrows = \"shapes.csv\"\nflexibility_m_n = \"answers.csv\"\n\
        dofs = \"picture.csv\"\nmesh = \"chain.msh\"\n";
    let sound = "flexibility_m_n = \"answers.csv\"\n";
    for (from, to, key, wanted) in [
        ("shapes.csv", "fewer.csv", "fewer.csv\"", "found 7 displacements; expected 8, as"),
        ("", "", "answers.csv\"", "expected 8 × 1 numbers, a line for each displacement of the picture"),
        (sound, "", "", "sound"),
        ("picture.csv", "other.csv", "chain.msh\"", "no node 41"),
        ("chain.msh", "none.msh", "none.msh\"", "none.msh"),
        ("picture.csv", "none.csv", "none.csv\"", "none.csv"),
    ] {
        let text = if from.is_empty() { picture.to_owned() } else { picture.replace(from, to) };
        let scene = format!("{reduced}{text}[[contact]]\nrow = 1\ngap_m = 1e-3\n{MODE}");
        fs::write(folder.path().join("scene.toml"), scene)?;
        let output = call(&folder, &["check", "scene.toml"])?;
        let text = said(&output);
        let code = if key.is_empty() { 0 } else { 2 };
        assert!(output.status.code() == Some(code) && text.contains(key) && text.contains(wanted), "{wanted}: {text}");
    }
    Ok(())
}
