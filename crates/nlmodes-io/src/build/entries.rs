use super::{Fault, mirrors};
use crate::lower::LowerTriangle;

/// Which entries of a symmetric matrix are in the stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Triangles {
    /// Each pair of mirror images once, from either triangle.
    One,
    /// Both triangles, which must agree.
    Both,
}

/// Entries of one block: the unit of allocation while they are read, and of release while they are sorted. 32 MiB, a
/// size that allocators return to the system at once.
const BLOCK: usize = 1 << 21;
/// Marks an entry that came from above the diagonal.
const UPPER: usize = 1 << 31;

#[derive(Clone, Copy)]
struct Entry {
    row: u32,
    column: u32,
    value: f64,
}

/// Collects entries in any order: 16 bytes for each that is not zero, in blocks that are freed as the columns fill, and
/// nothing for the rows in between, whose number is not yet checked.
pub(crate) struct EntryBuilder {
    triangles: Triangles,
    blocks: Vec<Vec<Entry>>,
    watched: Option<Fault>,
    seen: bool,
}

impl EntryBuilder {
    /// With an entry to watch: the second one at the place of a duplicate is an error, and the first at that of an
    /// asymmetry.
    pub(crate) fn new(triangles: Triangles, watched: Option<Fault>) -> Self {
        Self { triangles, blocks: Vec::new(), watched, seen: false }
    }

    /// Takes an entry with indices from 0, below [`MAX_ORDER`](super::MAX_ORDER).
    pub(crate) fn push(&mut self, row: usize, column: usize, value: f64) -> Result<(), Fault> {
        let (low, high) = (row.min(column), row.max(column));
        if let Some(fault) = self.watched {
            self.watch(fault, row, column)?;
        }
        if value == 0.0 {
            return Ok(());
        }
        let upper = if row < column && self.triangles == Triangles::Both { UPPER } else { 0 };
        let entry = Entry { row: (high | upper) as u32, column: low as u32, value };
        match self.blocks.last_mut().filter(|block| block.len() < BLOCK) {
            Some(block) => block.push(entry),
            None => {
                let mut block = Vec::with_capacity(if self.blocks.is_empty() { 64 } else { BLOCK });
                block.push(entry);
                self.blocks.push(block);
            }
        }
        Ok(())
    }

    fn watch(&mut self, fault: Fault, row: usize, column: usize) -> Result<(), Fault> {
        let same = match self.triangles {
            Triangles::One => {
                let (i, j) = fault.place();
                (row.max(column), row.min(column)) == (i.max(j), i.min(j))
            }
            Triangles::Both => (row, column) == fault.place(),
        };
        let late = self.seen || matches!(fault, Fault::Asymmetric { .. });
        if same && late {
            return Err(fault);
        }
        self.seen |= same;
        Ok(())
    }

    /// Number of entries so far.
    pub(crate) fn n_entries(&self) -> usize {
        self.blocks.iter().map(Vec::len).sum()
    }

    /// Sorts the entries into the columns of a matrix of `order` rows. With `to`, entry `(i, j)` goes to
    /// `(to[i], to[j])`, and where there is no such place it is left out; a fault names the rows as they were pushed.
    pub(crate) fn finish(mut self, order: usize, to: Option<&[Option<usize>]>) -> Result<LowerTriangle, Fault> {
        let triangles = self.triangles;
        let place = |k: u32| match to {
            None => Some(k as usize),
            Some(to) => to[k as usize],
        };
        let target = |entry: &Entry| {
            let row = entry.row & !(UPPER as u32);
            let (i, j) = (place(row)?, place(entry.column)?);
            // Places that descend exchange the triangles.
            let upper = (entry.row & UPPER as u32 != 0) != (i < j);
            let mark = if upper && triangles == Triangles::Both { UPPER } else { 0 };
            Some((i.max(j), mark, i.min(j)))
        };
        let mut starts = vec![0; order + 1];
        for (_, _, j) in self.blocks.iter().flatten().filter_map(target) {
            starts[j + 1] += 1;
        }
        for j in 0..order {
            starts[j + 1] += starts[j];
        }
        let mut next = starts.clone();
        let (mut rows, mut values) = (vec![0; starts[order]], vec![0.0; starts[order]]);
        let blocks = std::mem::take(&mut self.blocks);
        for block in blocks {
            for entry in &block {
                if let Some((i, mark, j)) = target(entry) {
                    (rows[next[j]], values[next[j]]) = (i | mark, entry.value);
                    next[j] += 1;
                }
            }
        }
        sort(&starts, &mut rows, &mut values);
        let named = |fault| original(fault, to);
        match triangles {
            Triangles::One => {
                once(&starts, &rows).map_err(named)?;
                Ok(LowerTriangle { column_starts: starts, rows, values })
            }
            Triangles::Both => paired(starts, rows, values).map_err(named),
        }
    }
}

/// A fault in the indices that were pushed.
fn original(fault: Fault, to: Option<&[Option<usize>]>) -> Fault {
    let Some(to) = to else { return fault };
    let back = |k: usize| to.iter().position(|place| *place == Some(k)).unwrap_or(k);
    match fault {
        Fault::Duplicate { row, column } => Fault::Duplicate { row: back(row), column: back(column) },
        Fault::Asymmetric { row, column, value, mirrored } => {
            Fault::Asymmetric { row: back(row), column: back(column), value, mirrored }
        }
    }
}

/// Ascending rows within each column; the lower entry before its mirror image.
fn sort(starts: &[usize], rows: &mut [usize], values: &mut [f64]) {
    let key = |row: usize| (row & !UPPER, row & UPPER);
    let mut column = Vec::new();
    for pair in starts.windows(2) {
        let range = pair[0]..pair[1];
        if rows[range.clone()].is_sorted_by_key(|row| key(*row)) {
            continue;
        }
        column.clear();
        column.extend(rows[range.clone()].iter().copied().zip(values[range.clone()].iter().copied()));
        column.sort_by_key(|(row, _): &(usize, f64)| key(*row));
        for (at, (row, value)) in range.zip(&column) {
            (rows[at], values[at]) = (*row, *value);
        }
    }
}

fn once(starts: &[usize], rows: &[usize]) -> Result<(), Fault> {
    for (j, pair) in starts.windows(2).enumerate() {
        if let Some(two) = rows[pair[0]..pair[1]].windows(2).find(|two| two[0] == two[1]) {
            return Err(Fault::Duplicate { row: two[0], column: j });
        }
    }
    Ok(())
}

/// Lower triangle of a matrix that is there in full, in place.
fn paired(starts: Vec<usize>, mut rows: Vec<usize>, mut values: Vec<f64>) -> Result<LowerTriangle, Fault> {
    let order = starts.len() - 1;
    let mut diagonal = vec![0.0; order];
    for j in 0..order {
        if starts[j] < starts[j + 1] && rows[starts[j]] == j {
            diagonal[j] = values[starts[j]];
        }
    }
    let (mut kept, mut new_starts) = (0, vec![0; order + 1]);
    for j in 0..order {
        let mut at = starts[j];
        while at < starts[j + 1] {
            let (row, upper) = (rows[at] & !UPPER, rows[at] & UPPER != 0);
            let same = |k: usize| k < starts[j + 1] && rows[k] & !UPPER == row;
            let mirrored = if same(at + 1) && rows[at + 1] & UPPER != rows[at] & UPPER { values[at + 1] } else { 0.0 };
            let found = if mirrored == 0.0 { 1 } else { 2 };
            if same(at + found) {
                let twice_upper = rows[at + found] & UPPER != 0;
                let (row, column) = if twice_upper { (j, row) } else { (row, j) };
                return Err(Fault::Duplicate { row, column });
            }
            let fits = row == j || mirrors(values[at], mirrored, (diagonal[row], diagonal[j]));
            if !fits {
                let (row, column) = if upper { (j, row) } else { (row, j) };
                return Err(Fault::Asymmetric { row, column, value: values[at], mirrored });
            }
            (rows[kept], values[kept]) = (row, values[at]);
            kept += 1;
            at += found;
        }
        new_starts[j + 1] = kept;
    }
    rows.truncate(kept);
    values.truncate(kept);
    rows.shrink_to_fit();
    values.shrink_to_fit();
    Ok(LowerTriangle { column_starts: new_starts, rows, values })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built(triangles: Triangles, entries: &[(usize, usize, f64)]) -> Result<Vec<(usize, usize, f64)>, Fault> {
        let mut builder = EntryBuilder::new(triangles, None);
        entries.iter().try_for_each(|&(i, j, v)| builder.push(i, j, v))?;
        Ok(builder.finish(3, None)?.entries().collect())
    }

    #[test]
    fn either_triangle_in_any_order_gives_the_same_matrix() {
        let expected = vec![(0, 0, 1.0), (2, 0, 4.0), (1, 1, 2.0), (2, 1, 5.0), (2, 2, 3.0)];
        let upper = [(1, 2, 5.0), (2, 2, 3.0), (0, 2, 4.0), (1, 1, 2.0), (0, 0, 1.0), (0, 1, 0.0)];
        assert_eq!(built(Triangles::One, &upper), Ok(expected.clone()));
        let lower = upper.map(|(i, j, v)| (j, i, v));
        assert_eq!(built(Triangles::One, &lower), Ok(expected.clone()));
        let both: Vec<_> = upper.into_iter().chain(lower.into_iter().filter(|e| e.0 != e.1)).collect();
        assert_eq!(built(Triangles::Both, &both), Ok(expected));
    }

    #[test]
    fn duplicates_and_entries_without_their_mirror_image_are_found() {
        let one = built(Triangles::One, &[(0, 0, 1.0), (0, 1, 2.0), (1, 0, 2.0)]);
        assert_eq!(one, Err(Fault::Duplicate { row: 1, column: 0 }));
        let twice = built(Triangles::Both, &[(0, 0, 1.0), (0, 1, 2.0), (0, 1, 2.0), (1, 0, 2.0)]);
        assert_eq!(twice, Err(Fault::Duplicate { row: 0, column: 1 }));
        let alone = built(Triangles::Both, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, 2.0)]);
        assert_eq!(alone, Err(Fault::Asymmetric { row: 0, column: 1, value: 2.0, mirrored: 0.0 }));
        let rounded = built(Triangles::Both, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, 1e-12)]);
        assert!(rounded.is_ok(), "rounding is no asymmetry");
    }

    #[test]
    fn places_permute_and_leave_out() {
        for triangles in [Triangles::One, Triangles::Both] {
            let mut builder = EntryBuilder::new(triangles, None);
            for (i, j, v) in [(0, 0, 1.0), (1, 0, 2.0), (1, 1, 3.0), (2, 1, 4.0), (2, 2, 5.0)] {
                builder.push(i, j, v).unwrap();
                if i != j && triangles == Triangles::Both {
                    builder.push(j, i, v).unwrap();
                }
            }
            let placed = builder.finish(2, Some(&[None, Some(1), Some(0)])).unwrap();
            assert_eq!(placed.entries().collect::<Vec<_>>(), [(0, 0, 5.0), (1, 0, 4.0), (1, 1, 3.0)]);
        }
    }

    #[test]
    fn an_index_alone_takes_no_memory() {
        let mut builder = EntryBuilder::new(Triangles::One, None);
        let last = super::super::MAX_ORDER as usize - 1;
        builder.push(last, last, 1.0).unwrap();
        assert_eq!(builder.n_entries(), 1);
        let held: usize = builder.blocks.iter().map(Vec::capacity).sum();
        assert!(held <= 64, "{held} entries for one, of row {last}");
    }

    #[test]
    fn a_second_pass_stops_at_the_entry_that_is_watched() {
        let fault = Fault::Duplicate { row: 1, column: 0 };
        let mut builder = EntryBuilder::new(Triangles::One, Some(fault));
        assert_eq!(builder.push(0, 1, 1.0), Ok(()));
        assert_eq!(builder.push(1, 1, 1.0), Ok(()));
        assert_eq!(builder.push(1, 0, 1.0), Err(fault));
    }
}
