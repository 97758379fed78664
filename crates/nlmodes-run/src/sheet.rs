//! Tables of text with named columns, as a run writes them and as others do: a row that is damaged is refused with its
//! line.
//!
//! The crate `csv`, which writes tables here, reads the rest of a file as one cell where a quotation mark is not
//! closed, and does not tell a last line without an end: what is cut would be taken for whole. So lines are read here,
//! one row each.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use nlmodes::report::columns::Row as ColumnRow;
use thiserror::Error;

/// What may separate two cells.
const SEPARATORS: [char; 3] = [',', ';', '\t'];
/// Longest line in bytes, far beyond any row.
const LONGEST: u64 = 1 << 20;
/// Most names of columns that an error lists.
const LISTED: usize = 12;

/// Why a table, or a row of it, is not read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SheetError {
    /// The file cannot be read.
    #[error("{}", path.display())]
    Unreadable {
        /// The table.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The file has no line.
    #[error("{} is empty, expected a line with the names of the columns", .0.display())]
    Empty(PathBuf),
    /// A line is no text.
    #[error("{}, line {line}: this is no text in UTF-8, expected a table as text", path.display())]
    NoText {
        /// The table.
        path: PathBuf,
        /// The line.
        line: u64,
    },
    /// A quotation mark is not closed.
    #[error("{}, line {line}: a quotation mark is not closed; the row is cut or damaged", path.display())]
    OpenQuotation {
        /// The table.
        path: PathBuf,
        /// The line.
        line: u64,
    },
    /// A column that is needed is not there.
    #[error("{}, line {line}: no column {column}; there are {}", path.display(), listed(columns))]
    NoColumn {
        /// The table.
        path: PathBuf,
        /// The line with the names of the columns.
        line: u64,
        /// The column, or the two of which one is needed.
        column: &'static str,
        /// The columns that are there.
        columns: Vec<String>,
    },
    /// A row has another number of cells than there are columns.
    #[error("{}, line {line}: {} in a table of {expected} columns; \
        {}", path.display(), count(*found), why(*found, *expected, *separator))]
    Cells {
        /// The table.
        path: PathBuf,
        /// The line.
        line: u64,
        /// Cells of the row.
        found: usize,
        /// Columns of the table.
        expected: usize,
        /// What separates the cells.
        separator: char,
    },
    /// A cell holds text where a number was expected.
    #[error("{}, line {line}: {column} is {text:?}, expected a number{}", path.display(), decimal_point(text))]
    NoNumber {
        /// The table.
        path: PathBuf,
        /// The line.
        line: u64,
        /// The column.
        column: &'static str,
        /// What it holds.
        text: String,
    },
    /// The last line of a table that a run has written has no end.
    #[error("{}, line {line}: the last line has no end; the file is cut", path.display())]
    NoEnd {
        /// The table.
        path: PathBuf,
        /// The line.
        line: u64,
    },
}

fn listed(columns: &[String]) -> String {
    let names: Vec<&str> = columns.iter().map(String::as_str).filter(|name| !name.is_empty()).take(LISTED).collect();
    let more = if columns.len() > names.len() { ", …" } else { "" };
    names.join(", ") + more
}

fn count(cells: usize) -> String {
    if cells == 1 { "1 cell".to_owned() } else { format!("{cells} cells") }
}

fn why(found: usize, expected: usize, separator: char) -> &'static str {
    if found > expected && separator == ',' {
        "decimal commas? expected decimal points"
    } else {
        "the row is cut or damaged"
    }
}

fn decimal_point(text: &str) -> String {
    let point = text.replacen(',', ".", 1);
    if text.contains(',') && point.parse::<f64>().is_ok() {
        format!(" with a decimal point, {point}")
    } else {
        String::new()
    }
}

/// A table that is read row by row. Blank lines and comments, lines that begin with `#`, are left out; cells are
/// separated by commas, semicolons or tabs, whichever the line with the names has most.
pub(crate) struct Sheet {
    path: PathBuf,
    lines: Lines,
    separator: char,
    head_line: u64,
    head: Vec<String>,
}

/// A row, its cells without blanks around them.
pub(crate) struct Row {
    /// Its line in the file, from 1.
    pub line: u64,
    cells: Vec<String>,
}

impl Row {
    /// The text of a cell; empty where there is no such column.
    pub fn text(&self, column: Option<usize>) -> &str {
        column.and_then(|column| self.cells.get(column)).map_or("", String::as_str)
    }
}

impl Sheet {
    /// Opens a table and reads the names of its columns.
    pub fn open(path: &Path) -> Result<Self, SheetError> {
        let file = File::open(path).map_err(|source| SheetError::Unreadable { path: path.to_path_buf(), source })?;
        let mut lines = Lines { reader: BufReader::new(file), line: 0, is_ended: true };
        let first = lines.next(path)?.ok_or_else(|| SheetError::Empty(path.to_path_buf()))?;
        let text = first.strip_prefix('\u{feff}').unwrap_or(&first);
        let count = |separator: char| text.matches(separator).count();
        let separator = SEPARATORS.into_iter().rev().max_by_key(|separator| count(*separator)).unwrap_or(',');
        let head_line = lines.line;
        let head = split(text, separator)
            .ok_or_else(|| SheetError::OpenQuotation { path: path.to_path_buf(), line: head_line })?;
        Ok(Self { path: path.to_path_buf(), lines, separator, head_line, head })
    }

    /// Position of a column, by its name in any case.
    pub fn column(&self, name: &str) -> Option<usize> {
        let exactly = self.head.iter().position(|column| column == name);
        exactly.or_else(|| self.head.iter().position(|column| column.eq_ignore_ascii_case(name)))
    }

    /// Position of a column without which the table says nothing.
    pub fn needed(&self, name: &'static str) -> Result<usize, SheetError> {
        self.column(name).ok_or_else(|| self.missing(name))
    }

    /// That a column is missing.
    pub fn missing(&self, column: &'static str) -> SheetError {
        SheetError::NoColumn { path: self.path.clone(), line: self.head_line, column, columns: self.head.clone() }
    }

    /// The next row, if there is one.
    pub fn row(&mut self) -> Result<Option<Row>, SheetError> {
        let Some(text) = self.lines.next(&self.path)? else { return Ok(None) };
        let line = self.lines.line;
        let mut cells =
            split(&text, self.separator).ok_or_else(|| SheetError::OpenQuotation { path: self.path.clone(), line })?;
        let (found, expected) = (cells.len(), self.head.len());
        // Spreadsheets end rows with separators of columns that are empty.
        while cells.len() > expected && cells.last().is_some_and(String::is_empty) {
            cells.pop();
        }
        if cells.len() != expected {
            let (path, separator) = (self.path.clone(), self.separator);
            return Err(SheetError::Cells { path, line, found, expected, separator });
        }
        Ok(Some(Row { line, cells }))
    }

    /// Positions of the columns of such rows, where the table has them.
    pub fn places<R: ColumnRow>(&self) -> Vec<Option<usize>> {
        R::COLUMNS.iter().map(|column| self.column(column.name)).collect()
    }

    /// The columns at these places in a row.
    pub fn read<R: ColumnRow>(&self, row: &Row, places: &[Option<usize>]) -> Result<R, SheetError> {
        let cell = |k: usize| row.text(places.get(k).copied().flatten());
        R::read(cell).map_err(|column| {
            let place = self.column(column.name);
            self.no_number(row, column.name, row.text(place))
        })
    }

    /// That a cell holds something else than a number.
    pub fn no_number(&self, row: &Row, column: &'static str, text: &str) -> SheetError {
        let text = text.chars().take(40).collect();
        SheetError::NoNumber { path: self.path.clone(), line: row.line, column, text }
    }

    /// That the last line which was read has no end, as in a file that was cut while it was written.
    pub fn refuse_open_end(&self) -> Result<(), SheetError> {
        if self.lines.is_ended {
            return Ok(());
        }
        Err(SheetError::NoEnd { path: self.path.clone(), line: self.lines.line })
    }
}

/// Lines that are neither blank nor comments.
struct Lines {
    reader: BufReader<File>,
    /// Number of the line that was read last, from 1.
    line: u64,
    /// Whether that line ended with a line break.
    is_ended: bool,
}

impl Lines {
    fn next(&mut self, path: &Path) -> Result<Option<String>, SheetError> {
        loop {
            let mut bytes = Vec::new();
            let read = (&mut self.reader).take(LONGEST).read_until(b'\n', &mut bytes);
            read.map_err(|source| SheetError::Unreadable { path: path.to_path_buf(), source })?;
            if bytes.is_empty() {
                return Ok(None);
            }
            self.line += 1;
            self.is_ended = bytes.ends_with(b"\n");
            let is_too_long = bytes.len() as u64 == LONGEST && !self.is_ended;
            let text = String::from_utf8(bytes).ok().filter(|text| !is_too_long && !text.contains('\0'));
            let text = text.ok_or_else(|| SheetError::NoText { path: path.to_path_buf(), line: self.line })?;
            let text = text.trim_end_matches(['\n', '\r']);
            if !text.trim().is_empty() && !text.trim_start_matches('\u{feff}').trim_start().starts_with('#') {
                return Ok(Some(text.to_owned()));
            }
        }
    }
}

/// The cells of a line; `None` where a quotation mark is not closed. Within quotation marks a doubled one means
/// itself.
fn split(text: &str, separator: char) -> Option<Vec<String>> {
    let (mut cells, mut cell, mut is_quoted) = (Vec::new(), String::new(), false);
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '"' if is_quoted && rest.peek() == Some(&'"') => {
                cell.push('"');
                rest.next();
            }
            '"' if is_quoted || cell.trim().is_empty() => is_quoted = !is_quoted,
            c if c == separator && !is_quoted => cells.push(std::mem::take(&mut cell)),
            c => cell.push(c),
        }
    }
    cells.push(cell);
    let trimmed = cells.iter().map(|cell| cell.trim().to_owned()).collect();
    (!is_quoted).then_some(trimmed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes::report::columns::BranchRow;

    /// The rows of a table by the two columns `frequency_hz` and `energy_j`, or what is wrong with it without its path.
    fn read(bytes: &[u8]) -> Result<Vec<(u64, [f64; 2])>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rig.csv");
        std::fs::write(&path, bytes).unwrap();
        let rows = || {
            let mut sheet = Sheet::open(&path)?;
            sheet.needed("frequency_hz")?;
            sheet.needed("energy_j")?;
            let (places, mut rows) = (sheet.places::<BranchRow>(), Vec::new());
            while let Some(row) = sheet.row()? {
                let read: BranchRow = sheet.read(&row, &places)?;
                rows.push((row.line, [read.frequency_hz, read.energy_j]));
            }
            sheet.refuse_open_end().map(|()| rows)
        };
        rows().map_err(|error: SheetError| error.to_string().rsplit_once("rig.csv").unwrap().1.to_owned())
    }

    #[test]
    fn separators_case_comments_and_blank_lines_are_those_of_the_file() {
        let wanted = vec![(4, [40.0, 1e-3]), (6, [41.5, 2e-3])];
        let plain = "# rig of 3 May\n\nfrequency_hz,energy_j,note\n40,1e-3,\n # damaged sensor\n41.5,2e-3,\"a, b\"\n";
        assert_eq!(read(plain.as_bytes()).unwrap(), wanted);
        for separator in [";", "\t"] {
            let table = plain.replace(',', separator);
            let table = table.replace("frequency_hz", "\u{feff}Frequency_Hz ").replace("energy_j", " \"ENERGY_J\"");
            assert_eq!(read(table.replace('\n', "\r\n").as_bytes()).unwrap(), wanted, "{table}");
        }
        let padded = "frequency_hz;energy_j\n40;1e-3;;\n;\n";
        let rows = read(padded.as_bytes()).unwrap();
        assert_eq!(rows[0], (2, [40.0, 1e-3]));
        assert!(rows[1].1.iter().all(|x| x.is_nan()), "{rows:?}");
        // Quotation marks within quotation marks, and a separator there.
        assert_eq!(split("\"a \"\"b\"\", c\", d", ',').unwrap(), ["a \"b\", c", "d"]);
    }

    #[test]
    fn what_is_damaged_is_refused_with_its_line() {
        let whole = "frequency_hz,energy_j\n40,1e-3\n41,2e-3\n";
        assert_eq!(read(whole.as_bytes()).unwrap().len(), 2);
        let cases: [(&[u8], &str); 9] = [
            (b"", " is empty, expected a line with the names of the columns"),
            (b"f,E\n1,2\n", ", line 1: no column frequency_hz; there are f, E"),
            (
                b"frequency_hz,energy_j\n40,1e-3\n41\n",
                ", line 3: 1 cell in a table of 2 columns; the row is cut or damaged",
            ),
            (
                b"frequency_hz,energy_j\n40,79,1e-3\n",
                ", line 2: 3 cells in a table of 2 columns; decimal commas? expected decimal points",
            ),
            (
                b"frequency_hz;energy_j\n40,79;1\n",
                ", line 2: frequency_hz is \"40,79\", expected a number with a decimal point, 40.79",
            ),
            (b"#\nfrequency_hz,energy_j\n\nforty,1\n", ", line 4: frequency_hz is \"forty\", expected a number"),
            (b"frequency_hz,energy_j\n40,\"1\n", ", line 2: a quotation mark is not closed; the row is cut or damaged"),
            (b"frequency_hz,energy_j\n40,\xff\n", ", line 2: this is no text in UTF-8, expected a table as text"),
            (b"frequency_hz,energy_j\n40,1e-3\n41,2e", ", line 3: energy_j is \"2e\", expected a number"),
        ];
        for (bytes, wanted) in cases {
            assert_eq!(read(bytes).unwrap_err(), wanted);
        }
        let cut = &whole.as_bytes()[..whole.len() - 1];
        assert_eq!(read(cut).unwrap_err(), ", line 3: the last line has no end; the file is cut");
    }
}
