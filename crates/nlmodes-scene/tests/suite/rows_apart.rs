//! Rows that nothing couples to the others: those that a program has taken out, and masses on springs of their own.

use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use nlmodes_scene::assemble::{OpenStructure, Structures};
use nlmodes_scene::outline::Outline;
use nlmodes_scene::{doubts, parse};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// Two masses of 2 kg in a row on springs of 3 kN/m, nodes 1 and 2, and rows apart with these stiffnesses and masses
/// (N/m, kg), nodes 11, 12, …; a stop before node `stop`. Gives the number of unknowns, the frequencies, the outline
/// and what looks wrong.
fn said(folder: &Path, apart: &[(f64, f64)], stop: usize) -> Outcome<(usize, Vec<f64>, String, Vec<String>)> {
    let n = 2 + apart.len();
    let file = |name: &str, chain: &[&str], of: &dyn Fn(&(f64, f64)) -> f64| {
        let rows = apart.iter().enumerate().map(|(i, row)| format!("{0} {0} {1:e}", i + 3, of(row)));
        let lines: Vec<String> = chain.iter().map(|line| (*line).to_owned()).chain(rows).collect();
        let head = format!("%%MatrixMarket matrix coordinate real symmetric\n{n} {n} {}\n", lines.len());
        fs::write(folder.join(name), head + &lines.join("\n") + "\n")
    };
    file("k.mtx", &["1 1 6000", "2 1 -3000", "2 2 3000"], &|row| row.0)?;
    file("m.mtx", &["1 1 2", "2 2 2"], &|row| row.1)?;
    let nodes = [1, 2].into_iter().chain((0..apart.len()).map(|i| 11 + i)).enumerate();
    let table: Vec<String> = nodes.map(|(i, node)| format!("{},{node},ux", i + 1)).collect();
    fs::write(folder.join("dofs.csv"), table.join("\n"))?;
    let text = format!(
        "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\n[[contact]]\n\
         node = {stop}\nnormal = [1.0, 0.0, 0.0]\ngap_m = 1e-4\nstiffness_n_m = 1e5\n[method]\nharmonics = 3\n\
         [continuation]\nmax_energy_ratio = 3.0\n"
    );
    let file = parse(&folder.join("scene.toml").to_string_lossy(), &text, &[]);
    let scene = file.map_err(|refused| refused.text(false))?.scene;
    let open = OpenStructure::of(&scene, &Structures::default())?;
    let hz = open.modes.omega_squared().iter().map(|square| square.sqrt() / TAU).collect();
    let outline = Outline::of_structure(&scene, (Some(&open), None), false).to_string();
    Ok((open.modes.n_dofs(), hz, outline, doubts::of(&scene, &open)))
}

/// Of the chain: `ω² = (3 ∓ √5)/2 · k/m`.
fn chain() -> [f64; 2] {
    [-1.0, 1.0].map(|sign| (0.5 * (3.0 + sign * 5_f64.sqrt()) * 1500.0).sqrt() / TAU)
}

#[test]
fn rows_with_equal_values_on_both_diagonals_are_no_modes() -> Outcome {
    for value in [1.0, 1e6, 2.75e3, 1e30] {
        let folder = tempfile::tempdir()?;
        let (n, hz, outline, doubts) = said(folder.path(), &[(value, value); 3], 2)?;
        assert_eq!((n, hz.len()), (2, 2), "{value:e}");
        hz.iter().zip(chain()).for_each(|(hz, exact)| assert!((hz / exact - 1.0).abs() < 1e-12, "{value:e}: {hz}"));
        assert!(outline.contains("3 of them by equal values on both diagonals"), "{outline}");
        assert!(doubts.iter().all(|text| !text.contains("coupled to nothing")), "{doubts:?}");
    }
    Ok(())
}

#[test]
fn a_mass_on_a_spring_of_its_own_stays_and_several_alike_are_asked_about() -> Outcome {
    let folder = tempfile::tempdir()?;
    let is_asked = |doubts: &[String]| doubts.iter().any(|text| text.contains("coupled to nothing"));
    // 450.158 Hz.
    for stop in [2, 11] {
        let (n, hz, _, doubts) = said(folder.path(), &[(4e5, 0.05)], stop)?;
        let own = (4e5_f64 / 0.05).sqrt() / TAU;
        assert!(n == 3 && hz.iter().any(|hz| (hz / own - 1.0).abs() < 1e-12), "{hz:?}");
        assert!(!is_asked(&doubts), "{doubts:?}");
    }
    // One on the diagonal of the stiffness, and the inverse of a frequency on that of the mass.
    let (n, hz, _, doubts) = said(folder.path(), &[(1.0, 1.0 / 62831.0); 3], 2)?;
    assert_eq!((n, hz.len()), (5, 5));
    let says = "3 degrees of freedom of 3 nodes (11, 12, 13) are coupled to nothing, vibrate at 39.9 Hz each";
    assert!(doubts.iter().any(|text| text.contains(says)), "{doubts:?}");
    // A stop before one of two says what they are.
    let (n, .., doubts) = said(folder.path(), &[(4e5, 0.05); 2], 11)?;
    assert!(n == 4 && !is_asked(&doubts), "{doubts:?}");
    Ok(())
}
