//! The sample in the text formats, written as the programs write it.

use super::sample::{Entry, N, label};

/// CalculiX: upper triangle column by column, zeros between the entries of a column included.
pub fn calculix(lower: &[Entry]) -> String {
    let mut text = String::new();
    for column in 0..N {
        let value = |row: usize| lower.iter().find(|e| (e.0, e.1) == (column, row)).map_or(0.0, |e| e.2);
        let first = (0..column).find(|row| value(*row) != 0.0).unwrap_or(column);
        for row in first..=column {
            text += &format!("{} {} {:>21}\n", row + 1, column + 1, exponent(value(row), 13));
        }
    }
    text
}

/// `1.5e+05`, as C writes it.
pub fn exponent(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, power) = text.split_once('e').unwrap();
    let power: i32 = power.parse().unwrap();
    format!("{mantissa}e{}{:02}", if power < 0 { '-' } else { '+' }, power.abs())
}

pub fn dof() -> String {
    (0..N).map(|row| format!("{}.{}\n", label(row).0, label(row).1)).collect()
}

pub fn mapping() -> String {
    let names = ["UX", "UY", "UZ"];
    let rows = (0..N).map(|row| format!("{:>12}{:>12}   {}\n", row + 1, label(row).0, names[label(row).1 - 1]));
    format!("  Matrix Eqn        Node   DOF\n{}", rows.collect::<String>())
}

pub fn table() -> String {
    let row = |row: usize| {
        let (node, component) = label(row);
        format!("{row},{node},{component},{:.1},0.5,-2\n", node as f64 / 4.0)
    };
    format!("row,node,component,x,y,z\n{}", (0..N).rev().map(row).collect::<String>())
}

pub fn matrix_market(lower: &[Entry]) -> String {
    let rows = lower.iter().map(|(i, j, v)| format!("{} {} {v:.17e}\n", i + 1, j + 1));
    format!(
        "%%MatrixMarket matrix coordinate real symmetric\n% made up\n\n{N} {N} {}\n{}",
        lower.len(),
        rows.collect::<String>()
    )
}

/// Abaqus: one triangle, with a fixed degree of freedom first.
pub fn abaqus(lower: &[Entry], held: bool) -> String {
    let mut text = String::from("** MATRIX INPUT\n");
    if held {
        text += "5,1, 5,1,  1.000000000000000e+36\n10,1, 5,1, -3.0e+03\n";
    }
    for (i, j, v) in lower {
        let (a, b) = (label(*i), label(*j));
        text += &format!("{},{}, {},{}, {:>23}\n", a.0, a.1, b.0, b.1, exponent(*v, 17));
    }
    text
}

/// Ansys: Fortran's columns without blanks between wide numbers, `D` exponents.
pub fn harwell_boeing(lower: &[Entry]) -> String {
    let mut starts = vec![1];
    for j in 0..N {
        starts.push(starts[j] + lower.iter().filter(|e| e.1 == j).count());
    }
    let lines = |fields: Vec<String>, count: usize| -> (usize, String) {
        let lines: Vec<String> = fields.chunks(count).map(|c| c.concat() + "\n").collect();
        (lines.len(), lines.concat())
    };
    let (p, pointers) = lines(starts.iter().map(|s| format!("{s:>6}")).collect(), 10);
    let (r, rows) = lines(lower.iter().map(|e| format!("{:>4}", e.0 + 1)).collect(), 16);
    let numbers = lower.iter().map(|e| format!("{:>25}", exponent(e.2, 17).replace('e', "D")));
    let (v, values) = lines(numbers.collect(), 3);
    format!(
        "{:<72}{:<8}\n{:>14}{p:>14}{r:>14}{v:>14}{:>14}\nRSA           \
        {N:>14}{N:>14}{:>14}{:>14}\n{:<16}{:<16}{:<20}{:<20}\n{pointers}{rows}{values}",
        "Stiffness matrix",
        "STIFF",
        p + r + v,
        0,
        lower.len(),
        0,
        "(10I6)",
        "(16I4)",
        "(1P,3D25.17)",
        ""
    )
}

/// Nastran: fields of 16 characters.
pub fn dmig(name: &str, lower: &[Entry]) -> String {
    let mut text = format!("$TITLE   = SAMPLE\nDMIG    {name:<8}{:>8}{:>8}{:>8}{:>8}{:>24}\n", 0, 6, 2, 0, N);
    for j in 0..N {
        let (node, direction) = label(j);
        text += &format!("DMIG*   {name:<16}{node:>16}{direction:>16}\n");
        for (i, _, v) in lower.iter().filter(|e| e.1 == j) {
            let (node, direction) = label(*i);
            text += &format!("*       {node:>16}{direction:>16}{:>16}\n", exponent(*v, 9).replace('e', "D"));
        }
    }
    text
}

/// Nastran: fields of eight characters, exponents without a letter; the first entry is in the line of the column.
pub fn dmig_short(name: &str, lower: &[Entry]) -> String {
    let mut text = format!("DMIG    {name:<8}{:>8}{:>8}{:>8}{:>8}\n", 0, 6, 1, 0);
    for j in 0..N {
        let (node, direction) = label(j);
        let entries = lower.iter().filter(|e| e.1 == j).map(|(i, _, v)| {
            let value = exponent(*v, 2).replace("e+0", "+").replace("e-0", "-");
            format!("{:>8}{:>8}{value:>8}{:>8}", label(*i).0, label(*i).1, "")
        });
        let entries: Vec<String> = entries.collect();
        text += &format!(
            "DMIG    {name:<8}{node:>8}{direction:>8}{:>8}{}\n",
            "",
            entries.first().cloned().unwrap_or_default()
        );
        for pair in entries.get(1..).unwrap_or_default().chunks(2) {
            text += &format!("+       {}\n", pair.concat());
        }
    }
    text
}
