//! A made-up model of eight nodes with three displacements each; `fixtures/make.py` has the same entries to the last
//! bit.

/// Number of rows.
pub const N: usize = 24;

/// An entry, from 0.
pub type Entry = (usize, usize, f64);

/// Lower triangle of the stiffness, column by column.
pub fn stiffness() -> Vec<Entry> {
    let mut entries = Vec::new();
    for i in 0..N {
        entries.push((i, i, 1e5 * (10 + i) as f64 / 3.0));
        for step in [1, 3, 7].into_iter().filter(|step| i + step < N) {
            entries.push((i + step, i, -1e4 / (2 * i + step + 2) as f64));
        }
    }
    entries
}

/// Lower triangle of the mass; the last row has none.
pub fn mass() -> Vec<Entry> {
    let mut entries = Vec::new();
    for i in 0..N - 1 {
        entries.push((i, i, 1e-3 * (i + 1) as f64 / 7.0));
        if i + 6 < N - 1 {
            entries.push((i + 6, i, 1e-4 / (i + 11) as f64));
        }
    }
    entries
}

/// Node and direction of a row: nodes 10, 20 … 80.
pub fn label(row: usize) -> (usize, usize) {
    (10 * (row / 3 + 1), row % 3 + 1)
}
