//! Numbers that make no reduced structure, and what it cannot have.

use std::fs;

use tempfile::tempdir;

use super::{MODE, Outcome, call, said};

/// Two rows and three modes, in the scene.
const SOUND: &str = "[structure]\nkind = \"reduced\"\nfrequencies_hz = [10.0, 40.0, 90.0]\n\
    contact_rows = [[1.0, -1.0, 1.0], [0.5, 0.2, -0.6]]\n\
    flexibility_m_n = [[4e-4, 1.2e-4], [1.2e-4, 1e-4]]\n\
    [[contact]]\nrow = 1\ngap_m = 1e-3\n";

#[test]
fn bad_numbers_are_refused_at_their_keys() -> Outcome {
    let folder = tempdir()?;
    fs::write(folder.path().join("text.csv"), "1.0,2.0,x\n")?;
    fs::write(folder.path().join("nan.csv"), "# rows\n1.0 2.0 3.0\n1.0 nan 3.0\n")?;
    fs::write(folder.path().join("uneven.csv"), "1.0,2.0,3.0\n1.0,2.0\n")?;
    fs::write(folder.path().join("empty.csv"), "# nothing\n")?;
    let rows = "contact_rows = [[1.0, -1.0, 1.0], [0.5, 0.2, -0.6]]";
    let flexibility = "flexibility_m_n = [[4e-4, 1.2e-4], [1.2e-4, 1e-4]]";
    let frequencies = "frequencies_hz = [10.0, 40.0, 90.0]";
    let cases = [
        (rows, "contact_rows = \"none.csv\"", "contact_rows", "none.csv: cannot be read"),
        (rows, "contact_rows = \"text.csv\"", "contact_rows", "text.csv:1: found `x`; expected a number"),
        (rows, "contact_rows = \"nan.csv\"", "contact_rows", "nan.csv:3: the entry of the table `nan` is not a finite"),
        (
            rows,
            "contact_rows = \"uneven.csv\"",
            "contact_rows",
            "uneven.csv:2: numbers in the line, as in the first one: found 2, expected 3",
        ),
        (rows, "contact_rows = \"empty.csv\"", "contact_rows", "empty.csv: found none; expected at least one number"),
        (
            rows,
            "contact_rows = \"k.sti\"",
            "contact_rows",
            "k.sti: found `.sti`; expected numbers in a file .npz, .npy, .csv or .txt",
        ),
        (
            rows,
            "contact_rows = [[1.0, 2.0], [3.0, 4.0]]",
            "contact_rows",
            "found 2 × 2; expected a line of 3 numbers for each row",
        ),
        (
            rows,
            "contact_rows = [[1.0, 2.0, 3.0], [3.0, 4.0]]",
            "contact_rows",
            "found 2 numbers in list 2; expected 3 in each list",
        ),
        (rows, "contact_rows = [[1.0, -1.0, 1.0], [0.0, 0.0, 0.0]]", "contact_rows", "row 2 is zero in all modes"),
        (flexibility, "flexibility_m_n = [[4e-4]]", "flexibility_m_n", "found 1 × 1; expected 2 × 2 numbers"),
        (
            flexibility,
            "flexibility_m_n = [[4e-4, 1.2e-4], [1.3e-4, 1e-4]]",
            "flexibility_m_n",
            "the flexibility between rows 1 and 2 is 1.2e-4 m/N, and 1.3e-4 m/N between 2 and 1",
        ),
        (
            flexibility,
            "flexibility_m_n = [[1e-4, 1.2e-5], [1.2e-5, 1e-4]]",
            "flexibility_m_n",
            "less than what the modes alone give, mostly at row 1",
        ),
        (
            flexibility,
            "residual_flexibility_m_n = [[1e-4, 0.0], [0.0, -1e-5]]",
            "residual_flexibility_m_n",
            "negative, mostly at row 2",
        ),
        (
            flexibility,
            "flexibility_m_n = [[4e-4, 1.2e-4], [1.2e-4, 1e-4]]\nresidual_flexibility_m_n = [[4e-4, 0.0], [0.0, \
                1e-4]]",
            "residual_flexibility_m_n",
            "the flexibility of the rows is given twice",
        ),
        (flexibility, "", "flexibility_m_n", "`structure.flexibility_m_n` is missing"),
        (
            flexibility,
            "flexibility_mm_n = \"f.csv\"",
            "flexibility_mm_n",
            "is a text, whose numbers no unit of the key converts",
        ),
        (
            frequencies,
            "frequencies_hz = [0.0, 40.0, 90.0]",
            "flexibility_m_n",
            "the structure floats, with mode 1 at 0 Hz",
        ),
        (frequencies, "frequencies_hz = [40.0, 10.0, 90.0]", "frequencies_hz", "mode 2 has 10 Hz behind 40 Hz"),
        (frequencies, "frequencies_hz = [-1.0, 40.0, 90.0]", "frequencies_hz", "is not a valid choice"),
        (frequencies, "frequencies_hz = [0.0, 0.0, 0.0]", "frequencies_hz", "rigid-body motions"),
        ("row = 1", "row = 3", "row", "`contact.0.row` is 3, but `structure.contact_rows` has 2 rows"),
        ("row = 1", "", "row", "`contact.0.row` is missing"),
        ("row = 1", "node = 1", "node", "unknown key `contact.0.node`"),
        ("[[contact]]", "[[contact]]\nrow = 1\ngap_m = 2.0\n[[contact]]", "row", "is on the same side of row 1"),
        (
            "[[contact]]",
            "[reduction]\nmodes = 4\n[[contact]]",
            "modes",
            "asks for 4 modes, and `structure.frequencies_hz` has 3",
        ),
        (
            "[[contact]]",
            "[reduction]\nkind = \"held-modes\"\n[[contact]]",
            "kind",
            "`reduction.kind` is not possible for a structure that was reduced elsewhere",
        ),
        (
            "[[contact]]",
            "[gravity]\ndirection = [0, 0, 1]\n[[contact]]",
            "gravity",
            "`gravity` is not possible for a structure that was reduced elsewhere",
        ),
        (
            "[[contact]]",
            "[thermal]\nexpansion_1_k = 1e-5\ntemperature_k = 10.0\n[[contact]]",
            "thermal",
            "`thermal` is not possible for a structure that was reduced elsewhere",
        ),
        (
            "[[contact]]",
            "[base_motion]\nacceleration_m_s2 = 1.0\n[[contact]]",
            "base_motion",
            "the base of a structure that was reduced elsewhere cannot move",
        ),
        ("[[contact]]", "[[static_force]]\nrow = 3\nforce_n = 1.0\n[[contact]]", "static_force", "there is no row 3"),
        (
            "[[contact]]",
            "[[force]]\nnode = 3\ndirection = [1, 0, 0]\n[[contact]]",
            "node",
            "`force.0.node` is not possible for a structure that was reduced elsewhere",
        ),
        (
            "[[contact]]",
            "[updating]\nparameters = [\"density_kg_m3\"]\nfrequencies_hz = [10.0]\n[[contact]]",
            "updating",
            "fits parameters of one rod or beam",
        ),
    ];
    for (before, after, key, message) in cases {
        let scene = SOUND.replacen(before, after, 1);
        assert_ne!(scene, SOUND, "{before}");
        fs::write(folder.path().join("scene.toml"), scene + MODE)?;
        let output = call(&folder, &["check", "scene.toml"])?;
        let text = said(&output);
        assert_eq!(output.status.code(), Some(2), "{after}: {text}");
        assert!(text.contains(message) && text.contains(key), "{after}: {text}");
    }
    fs::write(folder.path().join("scene.toml"), SOUND.to_owned() + MODE)?;
    let output = call(&folder, &["check", "scene.toml"])?;
    assert!(output.status.success(), "{}", said(&output));
    Ok(())
}

/// A rule of the paper for the mass of contact nodes, and rows of another structure.
#[test]
fn what_needs_the_mass_of_contact_nodes_is_refused() -> Outcome {
    let folder = tempdir()?;
    let held = SOUND.to_owned() + &MODE.replace("harmonics = 3", "harmonics = 3\nmass_redistribution = \"drop\"");
    fs::write(folder.path().join("scene.toml"), held)?;
    let text = said(&call(&folder, &["check", "scene.toml"])?);
    assert!(
        text.contains("`method.mass_redistribution` is not possible for a structure that was reduced elsewhere"),
        "{text}"
    );
    let beam = "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 4\nstart = \"clamped\"\n\
        material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }\nsection = { area_m2 = 1.0 }\n\
        [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 0.1\n\
        [damping]\nratio = 0.01\n[[force]]\nrow = 1\n[response]\nkind = \"frequency\"\nfrequency_hz = [0.1, 0.3]\n";
    fs::write(folder.path().join("scene.toml"), beam.to_owned() + MODE)?;
    let text = said(&call(&folder, &["check", "scene.toml"])?);
    assert!(text.contains("`force.0.row` is a row of a structure that was reduced elsewhere"), "{text}");
    assert!(text.contains("expected `at_m` in its place"), "{text}");
    Ok(())
}
