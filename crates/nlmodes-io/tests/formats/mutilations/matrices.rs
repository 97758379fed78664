//! Matrices as text.

use super::{cut, damage, head, line, refused};
use crate::agreement::read;
use crate::sample::{N, stiffness};
use crate::writers;

#[test]
fn calculix() {
    let good = writers::calculix(&stiffness());
    let lines = good.lines().count();
    let cases = vec![
        damage("a letter in a row", line(&good, 3, "x 2 1.0"), ":3: found `x`; expected a row from 1 to 24"),
        damage("a row beyond the last", line(&good, 3, "25 2 1.0"), ":3: found `25`; expected a row from 1 to 24"),
        damage(
            "a column beyond the table of degrees of freedom",
            line(&good, 3, "1 25 1.0"),
            ":3: found `25`; expected a column from 1 to 24, as many as the table of degrees of freedom has: .dof, \
                .sti and .mas of one run belong together (those of a \
             cyclic sector",
        ),
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
        damage(
            "a field too many between commas",
            line(&good, 3, "DMIG,KAAX,10,1,,10,1,1.0,,5"),
            ":3: found `5`; expected at most 8 fields between commas",
        ),
        damage(
            "a card between the columns",
            line(&good, 5, "GRID,1,,0.,0.,0."),
            ":8: found `DMIG*   KAAX                          10               2`; expected the columns of KAAX one \
                behind the other",
        ),
        damage("cut within a number", cut(&good, 4), format!(":{lines}: the file ends here")),
        damage("a header alone", head(&good, 2), ":3: the file ends here; expected columns of KAAX"),
    ];
    refused("x.pch", cases, |path| read(path, None, None));
}
