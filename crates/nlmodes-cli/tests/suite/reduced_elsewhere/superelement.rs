//! Craig-Bampton matrices, as Nastran and Ansys write them: small matrices, of which the program makes free-interface
//! modes itself.

use std::fmt::Write as _;
use std::fs;

use tempfile::tempdir;

use super::chain::Chain;
use super::{MODE, Outcome, run, same};

/// Node of the first modal coordinate.
const FIRST: usize = 1001;

fn array(a: &[Vec<f64>]) -> String {
    let numbers: String = a.iter().flatten().map(|x| format!("{x:e}\n")).collect();
    format!("%%MatrixMarket matrix array real general\n{0} {0}\n{numbers}", a.len())
}

/// As Nastran punches it, with scalar points for the modal coordinates.
fn dmig(name: &str, a: &[Vec<f64>], boundary: usize) -> Outcome<String> {
    let label = |i: usize| if i == 0 { (boundary, 1) } else { (FIRST + i - 1, 0) };
    let mut text = format!("DMIG    {name:<8}{:8}{:8}{:8}{:8}\n", 0, 6, 2, 0);
    for (j, column) in a.iter().enumerate() {
        let (node, component) = label(j);
        writeln!(text, "DMIG*   {name:<16}{node:16}{component:16}")?;
        for (i, value) in column.iter().enumerate().skip(j).filter(|(_, value)| **value != 0.0) {
            let (node, component) = label(i);
            let exponent = value.abs().log10().floor() as i32;
            let number = format!("{:.9}E{exponent:+03}", value / 10_f64.powi(exponent));
            writeln!(text, "*       {node:16}{component:16}{number:>16}")?;
        }
    }
    Ok(text)
}

/// With all of its fixed-interface modes a superelement is the structure itself.
#[test]
fn a_superelement_with_all_its_modes_is_the_structure() -> Outcome {
    let (folder, chain) = (tempdir()?, Chain { held: true, n: 40 });
    let whole = chain.matrices(&folder, 12, &[(40, 1.0, 1e-3)])? + MODE;
    let [k, m] = chain.craig_bampton();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text);
    write("ks.mtx", array(&k))?;
    write("ms.mtx", array(&m))?;
    let modal = (1..k.len()).map(|r| format!("{r},{},1\n", FIRST + r - 1));
    write("rows.csv", format!("row,node,component\n0,40,1\n{}", modal.collect::<String>()))?;
    let files = |of: &str| whole.replace("k.mtx", of).replace("m.mtx", &of.replace('k', "m").replace("KAAX", "MAAX"));
    let of_ansys = files("ks.mtx").replace("dofs.csv", "rows.csv");
    same([(&folder, &whole), (&folder, &of_ansys)], "branch.csv")?;
    // A punch has ten digits.
    write("s.pch", dmig("KAAX", &k, 40)? + &dmig("MAAX", &m, 40)?)?;
    let of_nastran = files("s.pch#KAAX").replace("dofs = \"dofs.csv\"\n", "");
    let hz = |scene: &str| -> Outcome<f64> {
        let columns = run(&folder, scene, "branch.csv")?;
        let found = columns.iter().find(|(name, _)| name == "frequency_hz").and_then(|(_, hz)| hz.last().copied());
        found.ok_or_else(|| "no frequency".into())
    };
    let (own, punched) = (hz(&whole)?, hz(&of_nastran)?);
    assert!((punched / own - 1.0).abs() < 1e-6, "{punched} {own}");
    Ok(())
}
