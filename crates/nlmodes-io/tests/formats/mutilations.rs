//! Damaged files: each is refused with the file, the line or part, and what was expected.

use std::fs;
use std::path::Path;

use nlmodes_io::{LabelTable, Mesh};

use crate::agreement::{fixture, read};
use crate::sample::{N, stiffness};
use crate::writers;

/// One way to damage a text, and what the message says.
struct Damage {
    what: &'static str,
    text: String,
    says: String,
}

/// The text with line `line` (from 1) replaced; an empty one is taken out.
fn line(text: &str, line: usize, new: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    if new.is_empty() {
        lines.remove(line - 1);
    } else {
        lines[line - 1] = new;
    }
    lines.join("\n") + "\n"
}

/// The first lines of a text.
fn head(text: &str, lines: usize) -> String {
    text.lines().take(lines).map(|line| format!("{line}\n")).collect()
}

/// The text without its last characters.
fn cut(text: &str, characters: usize) -> String {
    text[..text.len() - characters].to_owned()
}

fn damage(what: &'static str, text: String, says: impl Into<String>) -> Damage {
    Damage { what, text, says: says.into() }
}

#[track_caller]
fn refused<T>(file: &str, cases: Vec<Damage>, read: impl Fn(&Path) -> nlmodes_io::Result<T>) {
    assert!(cases.len() >= 10, "{} ways to damage {file}", cases.len());
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(file);
    for case in cases {
        fs::write(&path, &case.text).unwrap();
        let message = match read(&path) {
            Ok(_) => panic!("{file}: {} is not refused", case.what),
            Err(error) => error.to_string(),
        };
        assert!(message.contains(file), "{}: {message}", case.what);
        assert!(message.contains(&case.says), "{}: {message}\ndoes not say: {}", case.what, case.says);
        assert!(message.contains("expected"), "{}: {message}", case.what);
    }
}

#[test]
fn calculix() {
    let good = writers::calculix(&stiffness());
    let lines = good.lines().count();
    let cases = vec![
        damage("a letter in a row", line(&good, 3, "x 2 1.0"), ":3: found `x`; expected a row from 1 to 24"),
        damage("a row beyond the last", line(&good, 3, "25 2 1.0"), ":3: found `25`; expected a row from 1 to 24"),
        damage("row zero", line(&good, 1, "0 1 1.0"), ":1: found `0`; expected a row from 1 to 24"),
        damage("no value", line(&good, 4, "1 3"), ":4: found nothing; expected a number, the value"),
        damage("a fourth field", line(&good, 4, "1 3 1.0 2.0"), ":4: found `2.0`; expected the end of the line"),
        damage("a value that is not finite", line(&good, 4, "1 3 nan"), ":4: the value `nan` is not a finite number"),
        damage("an overflow", line(&good, 4, "1 3 1e999"), ":4: the value `1e999` is not a finite number"),
        damage("an entry twice", format!("{}{good}", "1 1 3.0\n"), ":2: entry (1, 1) is there a second time"),
        damage("the mirror image too", line(&good, 1, "2 1 3.0"), ":2: entry (2, 1) is there a second time"),
        damage("cut at a line's end", head(&good, lines - 1), format!(":{lines}: the file ends here")),
        damage(
            "cut within a number",
            cut(&good, 3),
            format!(":{lines}: the file ends here; expected the end of the line"),
        ),
        damage("nothing in it", String::new(), ":1: the file ends here"),
        damage("a decimal row", line(&good, 2, "1.0 2 1.0"), ":2: found `1.0`; expected a row from 1 to 24"),
    ];
    refused("x.sti", cases, |path| read(path, None, Some(N)));
}

#[test]
fn matrix_market() {
    let good = writers::matrix_market(&stiffness());
    let lines = good.lines().count();
    let entries = stiffness().len();
    let cases = vec![
        damage("another first word", line(&good, 1, "%%MatrixMarkt matrix coordinate real symmetric"), ":1: found"),
        damage(
            "complex",
            line(&good, 1, "%%MatrixMarket matrix coordinate complex symmetric"),
            ":1: found `complex`; expected real or integer",
        ),
        damage("pattern", line(&good, 1, "%%MatrixMarket matrix coordinate pattern symmetric"), ":1: found `pattern`"),
        damage(
            "skew",
            line(&good, 1, "%%MatrixMarket matrix coordinate real skew-symmetric"),
            ":1: found `skew-symmetric`; expected symmetric or general",
        ),
        damage(
            "half a general one",
            line(&good, 1, "%%MatrixMarket matrix coordinate real general"),
            ":6: entry (2, 1) is",
        ),
        damage(
            "not square",
            line(&good, 4, &format!("24 25 {entries}")),
            ":4: columns of a symmetric matrix: found 25, expected 24",
        ),
        damage(
            "another size",
            line(&good, 4, &format!("23 23 {entries}")),
            ":4: number of rows: found 23, expected 24",
        ),
        damage(
            "too many promised",
            line(&good, 4, &format!("24 24 {}", entries + 1)),
            format!(":{}: the file ends here; expected entry {}", lines + 1, entries + 1),
        ),
        damage("too few promised", line(&good, 4, &format!("24 24 {}", entries - 1)), format!(":{lines}: found")),
        damage("a row beyond the last", line(&good, 6, "99 1 1.0"), ":6: found `99`; expected a row from 1 to 24"),
        damage("an entry twice", line(&good, 7, "1 1 1.0"), ":7: entry (1, 1) is there a second time"),
        damage("no number", line(&good, 7, "5 1 1,0"), ":7: found `1,0`; expected a number, the value"),
        damage("cut within a number", cut(&good, 2), format!(":{lines}: the file ends here")),
    ];
    refused("x.mm", cases, |path| read(path, None, Some(N)));
}

#[test]
fn abaqus() {
    let good = writers::abaqus(&stiffness(), false);
    let lines = good.lines().count();
    let cases = vec![
        damage(
            "a multiplier",
            line(&good, 4, "-3,1, 10,1, 1.0"),
            ":4: found node -3; expected nodes of the mesh: negative numbers are Lagrange multipliers",
        ),
        damage(
            "a direction beyond",
            line(&good, 4, "20,8, 10,1, 1.0"),
            ":4: found `8`; expected a direction from 1 to 6",
        ),
        damage("a fraction", line(&good, 4, "20,1.5, 10,1, 1.0"), ":4: found `1.5`; expected a direction from 1 to 6"),
        damage("no value", line(&good, 4, "20,1, 10,1"), ":4: found nothing; expected a number, the value"),
        damage(
            "a sixth field",
            line(&good, 4, "20,1, 10,1, 1.0, 2.0"),
            ":4: found `2.0`; expected the end of the line",
        ),
        damage("blanks for commas", line(&good, 4, "20 1 10 1 1.0"), ":4: found `20 1 10 1 1.0`; expected a node"),
        damage(
            "an entry twice",
            line(&good, 3, "10,1, 10,1, 1.0"),
            ":3: entry (ux of node 10, ux of node 10) is there a second time",
        ),
        damage("not finite", line(&good, 4, "20,1, 10,1, inf"), ":4: the value `inf` is not a finite number"),
        damage("a keyword", line(&good, 2, "*MATRIX ASSEMBLE"), ":2: found `*MATRIX ASSEMBLE`; expected a node"),
        damage("cut within a number", cut(&good, 5), format!(":{lines}: the file ends here")),
        damage(
            "comments only",
            "** nothing\n".into(),
            ":2: the file ends here; expected a line `node,dof, node,dof, value`",
        ),
        damage("node zero", line(&good, 4, "0,1, 10,1, 1.0"), ":4: found `0`; expected a node"),
    ];
    refused("y.mtx", cases, |path| read(path, None, None));
}

#[test]
fn harwell_boeing() {
    let good = writers::harwell_boeing(&stiffness());
    let lines: Vec<&str> = good.lines().collect();
    let count = lines.len();
    let of = |number: usize| lines[number - 1].to_owned();
    let cases = vec![
        damage("an unsymmetric matrix", line(&good, 3, &of(3).replace("RSA", "RUA")), ":3: found `RUA`; expected RSA"),
        damage("a complex matrix", line(&good, 3, &of(3).replace("RSA", "CSA")), ":3: found `CSA`; expected RSA"),
        damage("another size", line(&good, 3, &of(3).replace("24", "25")), ":3: number of rows: found 25, expected 24"),
        damage(
            "no format",
            line(&good, 4, &of(4).replace("(16I4)", "(16Z4)")),
            ":4: found `(16Z4)`; expected a Fortran format of row indices",
        ),
        damage(
            "values as integers",
            line(&good, 4, &of(4).replace("3D25.17", "3I25")),
            ":4: found `(1P,3I25)`; expected a Fortran format of values",
        ),
        damage(
            "a pointer that descends",
            line(&good, 5, &of(5).replacen("     5", "     0", 1)),
            "entry 1 of `pointers`: found 0; expected at least 1",
        ),
        damage(
            "more entries promised",
            line(&good, 3, &of(3).replace("85", "86")),
            "entry 24 of `pointers`: found 86; expected 87",
        ),
        damage(
            "a row beyond the last",
            line(&good, 8, &of(8).replacen("   1", "  99", 1)),
            ":8: found `99`; expected a row from 1 to 24",
        ),
        damage(
            "above the diagonal",
            line(&good, 8, &of(8).replacen("   2   3   5   9", "   1   3   5   9", 1)),
            "(1, 2)",
        ),
        damage("a letter", line(&good, count, &of(count).replace('D', "Q")), format!(":{count}: found")),
        damage("cut at a line's end", head(&good, count - 1), format!(":{count}: the file ends here; expected value")),
        damage("cut within a number", cut(&good, 4), format!(":{count}: the file ends here")),
        damage("only a title", head(&good, 1), ":2: the file ends here; expected the numbers of lines"),
    ];
    refused("x.hb", cases, |path| read(path, None, Some(N)));
}

#[test]
fn dmig() {
    let good = writers::dmig("KAAX", &stiffness());
    let lines = good.lines().count();
    let long = |row: usize, node: &str, direction: &str, value: &str| {
        line(&good, row, &format!("*       {node:>16}{direction:>16}{value:>16}"))
    };
    let header = "DMIG    KAAX           0       6       2       0";
    let cases = vec![
        damage(
            "complex numbers",
            line(&good, 2, &header.replace("6       2", "6       4")),
            ":2: found numbers of type 4; expected type 1 or 2",
        ),
        damage(
            "a rectangle",
            line(&good, 2, &header.replace("6       2", "9       2")),
            ":2: found `9`; expected form 6, symmetric, or form 1, square",
        ),
        damage(
            "half a square",
            line(&good, 2, &header.replace("6       2", "1       2")),
            ":5: entry (uy of node 10, ux of node 10) is",
        ),
        damage("no header", line(&good, 2, ""), "found none; expected a DMIG header"),
        damage("another name", line(&good, 3, &format!("DMIG*   {:<16}{:>16}{:>16}", "MAAX", 10, 1)), ":3: found"),
        damage("a direction beyond", long(4, "10", "7", "1.0"), ":4: found `7`; expected a direction from 1 to 6"),
        damage("no number", long(4, "10", "1", "1.0D"), ":4: found `1.0D`; expected a number, the value"),
        damage("not finite", long(4, "10", "1", "nan"), ":4: the value `nan` is not a finite number"),
        damage(
            "no node",
            long(4, "x", "1", "1.0"),
            ":4: found `x`; expected a whole number, the number of the grid point",
        ),
        damage(
            "an entry twice",
            long(5, "10", "1", "1.0"),
            ":5: entry (ux of node 10, ux of node 10) is there a second time",
        ),
        damage("another card", line(&good, 5, "DMAG*   KAAX"), ":5: found `DMAG*   KAAX`; expected DMIG"),
        damage("commas", line(&good, 3, "DMIG,KAAX,10,1"), ":3: found `DMIG,KAAX,10,1`; expected DMIG"),
        damage("cut within a number", cut(&good, 4), format!(":{lines}: the file ends here")),
        damage("a header alone", head(&good, 2), ":3: the file ends here; expected columns of KAAX"),
    ];
    refused("x.pch", cases, |path| read(path, None, None));
}

#[test]
fn tables_of_labels() {
    let good = writers::dof();
    let dof = vec![
        damage("no point", line(&good, 2, "10"), ":2: found `10`; expected `node.direction`"),
        damage("a fraction", line(&good, 2, "10.25"), ":2: found `10.25`"),
        damage("direction 0", line(&good, 2, "10.0"), ":2: found `10.0`"),
        damage("direction 7", line(&good, 2, "10.7"), ":2: found `10.7`"),
        damage("two points", line(&good, 2, "10.2.3"), ":2: found `10.2.3`"),
        damage("an exponent", line(&good, 2, "1e1.2"), ":2: found `1e1.2`"),
        damage("a sign", line(&good, 2, "-10.2"), ":2: found `-10.2`"),
        damage("an empty line", line(&good, 2, " "), ":2: found nothing"),
        damage("a label twice", line(&good, 4, "10.1"), ":4: found ux of node 10 a second time, after line 1"),
        damage("cut", cut(&good, 1), ":24: the file ends here"),
        damage("two labels", line(&good, 2, "10.2 10.3"), ":2: found `10.2 10.3`"),
    ];
    refused("x.dof", dof, LabelTable::read);
    let good = writers::mapping();
    let mapping = vec![
        damage("an equation left out", line(&good, 4, ""), ":4: found `4`; expected equation 3"),
        damage("a temperature", line(&good, 4, "3 10 TEMP"), ":4: found `TEMP`; expected a direction UX"),
        damage("a number as direction", line(&good, 4, "3 10 3"), ":4: found `3`; expected a direction UX"),
        damage("no direction", line(&good, 4, "3 10"), ":4: found nothing"),
        damage("no node", line(&good, 4, "3 x UZ"), ":4: found `x`; expected a whole number, the number of the node"),
        damage("a label twice", line(&good, 4, "3 10 UX"), ":4: found ux of node 10 a second time, after line 2"),
        damage("a fourth field", line(&good, 4, "3 10 UZ 1"), ":4: found `1`; expected the end of the line"),
        damage("a heading alone", head(&good, 1), ":2: the file ends here; expected equation 1"),
        damage("cut", cut(&good, 2), ":25: the file ends here"),
        damage("text within", line(&good, 4, "* 10 UZ"), ":4: found `*`; expected equation 3"),
        damage("a fraction", line(&good, 4, "3.0 10 UZ"), ":4: found `3.0`; expected equation 3"),
    ];
    refused("x.mapping", mapping, LabelTable::read);
    let good = writers::table();
    let table = vec![
        damage(
            "another heading",
            line(&good, 1, "row,node,dof,x,y,z"),
            ":1: found `dof`; expected the column `component`",
        ),
        damage("four columns", line(&good, 1, "row,node,component,x"), ":1: found"),
        damage("a column less", line(&good, 3, "22,80,2,1,2"), ":3: found `22,80,2,1,2`; expected 6 columns"),
        damage("no component", line(&good, 3, "22,80,up,20.0,0.5,-2"), ":3: found `up`; expected a component 1 to 6"),
        damage("component 7", line(&good, 3, "22,80,7,20.0,0.5,-2"), ":3: found `7`; expected a component 1 to 6"),
        damage(
            "a negative row",
            line(&good, 3, "-22,80,2,20.0,0.5,-2"),
            ":3: found `-22`; expected a whole number, the row",
        ),
        damage(
            "a row twice",
            line(&good, 3, "21,80,2,20.0,0.5,-2"),
            ": found row 21; expected each row from 0 to 23 once, so row 22 next",
        ),
        damage(
            "a label twice",
            line(&good, 3, "22,80,3,20.0,0.5,-2"),
            ":3: found uz of node 80 a second time, after line 2",
        ),
        damage(
            "a node at two places",
            line(&good, 3, "22,80,2,20.5,0.5,-2"),
            ":3: found `22,80,2,20.5,0.5,-2`; expected node 80 at the place",
        ),
        damage("a coordinate", line(&good, 3, "22,80,2,20.0,?,-2"), ":3: found `?`; expected a number, the coordinate"),
        damage("a heading alone", head(&good, 1), ":2: the file ends here; expected a line row,node,component"),
        damage("semicolons", good.replace(',', ";"), ":1: found"),
    ];
    refused("x.csv", table, LabelTable::read);
}

#[test]
fn decks() {
    let good = "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=E\n1, 1, 2, 3, 4\n*NSET, NSET=TIP\n3, 4\n*SURFACE, NAME=S\nE, S1\n";
    assert!(
        Mesh::read(&{
            let path = tempfile::tempdir().unwrap().keep().join("good.inp");
            fs::write(&path, good).unwrap();
            path
        })
        .is_ok()
    );
    let cases = vec![
        damage("two coordinates", line(good, 3, "2, 1, 0"), ":3: found `2, 1, 0`; expected a node: number, x, y, z"),
        damage("a letter", line(good, 3, "2, 1, o, 0"), ":3: found `o`; expected a number, the coordinate"),
        damage(
            "a node moved",
            line(good, 3, "1, 1, 0, 0"),
            ":3: found `1, 1, 0, 0`; expected node 1 at [0.0, 0.0, 0.0]",
        ),
        damage("not finite", line(good, 3, "2, nan, 0, 0"), ":3: the coordinate `nan` is not a finite number"),
        damage(
            "no type",
            line(good, 6, "*ELEMENT, ELSET=E"),
            ":6: found `*ELEMENT, ELSET=E`; expected TYPE=… with *ELEMENT",
        ),
        damage(
            "a node too few",
            line(good, 7, "1, 1, 2, 3"),
            ":8: found 3 before this line; expected 4 nodes of element 1",
        ),
        damage(
            "a node too many",
            line(good, 7, "1, 1, 2, 3, 4, 5"),
            ":7: found `1, 1, 2, 3, 4, 5`; expected 4 nodes of element 1",
        ),
        damage(
            "a node that is not there",
            line(good, 7, "1, 1, 2, 3, 9"),
            ":7: found node 9, which is not there; expected nodes of the deck",
        ),
        damage("a set's node that is not there", line(good, 9, "3, 44"), ":9: found node 44, which is not there"),
        damage(
            "a set that is not there",
            line(good, 9, "EDGE"),
            ":9: there is no set `EDGE`; expected one of `ALL`, `TIP`",
        ),
        damage("a face that is not there", line(good, 11, "E, S5"), ":11: found `E, S5`; expected a face"),
        damage("a part", line(good, 1, "*PART, NAME=P"), ":1: found *PART; expected a flat deck in global axes"),
        damage("generated nodes", line(good, 1, "*NGEN"), ":1: found *NGEN; expected a flat deck"),
        damage(
            "turned axes",
            line(good, 1, "*NODE, SYSTEM=C"),
            ":1: found `*NODE, SYSTEM=C`; expected coordinates along global axes",
        ),
        damage(
            "an element twice",
            line(good, 8, "1, 1, 2, 3, 4"),
            ":8: found `1, 1, 2, 3, 4`; expected element 1 once",
        ),
        damage("a deck that is not there", line(good, 1, "*INCLUDE, INPUT=none.inp"), ":1: found"),
        damage("no nodes", "*HEADING\nx\n".into(), "the file ends here; expected nodes (*NODE)"),
    ];
    refused("x.inp", cases, Mesh::read);
}

#[test]
fn gmsh() {
    let good = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";
    let cases = vec![
        damage("another beginning", line(good, 1, "$Format"), ":1: found `$Format`; expected $MeshFormat"),
        damage("another version", line(good, 2, "3 0 8"), ":2: found `3`; expected version 4.1 or 2.2"),
        damage("binary", line(good, 2, "4.1 1 8"), ":2: found a binary file; expected a file of text"),
        damage("a node too many", line(good, 6, "3 1 0 5"), ":11: found"),
        damage("a node too few", line(good, 6, "3 1 0 3"), ":10: found"),
        damage("two coordinates", line(good, 12, "1 0"), ":12: found `1 0`; expected three coordinates"),
        damage("a letter", line(good, 12, "1 o 0"), ":12: found `o`; expected a number, the coordinate"),
        damage("a node twice", line(good, 8, "1"), ":12: found `1 0 0`; expected node 1 once"),
        damage(
            "a type beyond",
            line(good, 18, "3 1 29 1"),
            ":18: found `29`; expected an element type of first or second order",
        ),
        damage(
            "a node of an element missing",
            line(good, 19, "1 1 2 3"),
            ":19: found `1 1 2 3`; expected 4 nodes of the element",
        ),
        damage("a node that is not there", line(good, 19, "1 1 2 3 7"), ":19: found node 7, which is not there"),
        damage("another end", line(good, 15, "$EndElements"), ":15: found `$EndElements`; expected $EndNodes"),
        damage("cut", head(good, 13), ":14: the file ends here"),
        damage("no nodes", head(good, 3), ":4: the file ends here; expected the section $Nodes"),
    ];
    refused("x.msh", cases, Mesh::read);
}

#[test]
fn archives_and_matlab() {
    let cases = [
        ("skew.npz", None, "entry (2, 5) is"),
        ("half.npz", None, "expected a symmetric matrix, both triangles stored"),
        ("complex.npz", None, "`data`: found numbers of type '<c16'; expected real numbers"),
        ("wide.npz", None, "`shape`: found [24, 20]; expected as many rows as columns"),
        ("dia.npz", None, "`format`: found `dia`; expected csc, csr or coo"),
        ("twice.npz", None, "number of rows: found 2, expected 24"),
        ("nan.npz", None, "entry 3 of `data`: the value `NaN` is not a finite number"),
        ("outside.npz", None, "entry 4 of `indices`: found 24; expected a row from 0 to 23"),
        ("skew.mat", Some("K"), "entry (2, 5) is"),
        ("skew.mat", Some("C"), "`C`: found complex numbers; expected real numbers"),
        ("skew.mat", Some("X"), "there is no matrix `X`; expected one of `K`, `C`"),
        (
            "skew.mat",
            None,
            "found several matrices: `K`, `C`; expected the name of one behind the file's, as in `skew.mat#K`",
        ),
        ("wide.mat", None, "`K`: columns of a symmetric matrix: found 20, expected 24"),
        ("skew73.mat", Some("K"), "entry (2, 5) is"),
        ("skew73.mat", Some("X"), "there is no matrix `X`; expected one of `K`"),
        ("hdf5.mat", None, "found several matrices: `K`, `M`"),
    ];
    for (file, name, says) in cases {
        let message = read(&fixture(file), name, Some(N)).unwrap_err().to_string();
        assert!(
            message.contains(file)
                && message.contains(says)
                && message.contains("expected") | message.contains("found"),
            "{message}"
        );
    }
    let twice = read(&fixture("twice.npz"), None, None).unwrap_err().to_string();
    assert!(twice.contains("entry (1, 1) is there a second time"), "{twice}");
}

#[test]
fn binary_files_that_are_cut_or_changed_anywhere_are_refused_or_read_right() {
    let directory = tempfile::tempdir().unwrap();
    let good = stiffness();
    for (file, name) in [
        ("K_csc.npz", None),
        ("K_csr.npz", None),
        ("packed.mat", Some("K")),
        ("plain.mat", Some("K")),
        ("hdf5.mat", Some("K")),
    ] {
        let bytes = fs::read(fixture(file)).unwrap();
        let path = directory.path().join(file);
        for k in 0..10 {
            fs::write(&path, &bytes[..bytes.len() * k / 10]).unwrap();
            let message = read(&path, name, Some(N));
            let cut_behind =
                file.ends_with(".mat") && message.as_ref().is_ok_and(|m| m.lower.entries().eq(good.iter().copied()));
            assert!(message.is_err() || cut_behind, "{file} cut to {k} tenths");
        }
        for k in 0..200 {
            let mut changed = bytes.clone();
            changed[(k * 7919) % bytes.len()] ^= 0x41;
            fs::write(&path, &changed).unwrap();
            // Whatever comes out: no panic, and no entry that is not finite.
            if let Ok(matrix) = read(&path, name, Some(N)) {
                assert!(matrix.lower.entries().all(|e| e.2.is_finite() && e.0 < N && e.1 <= e.0));
            }
        }
    }
}
