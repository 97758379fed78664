//! Direct matrix input at grid points, as Nastran punches: fields of 8 or 16 characters or between commas, symmetric
//! (form 6) or square (form 1), among any other cards.

use std::path::Path;

use super::MatrixData;
use super::labelled::{LabelledBuilder, label};
use crate::build::{Fault, Pass, Triangles, with_lines_of_faults};
use crate::error::{Problem, ReadError, Result};
use crate::labels::DofLabel;
use crate::mesh::included;
use crate::nastran::{BulkCard, BulkLine, Points, Start};
use crate::text::{Lines, real, unsigned};

pub(super) fn read(path: &Path, name: Option<&str>) -> Result<MatrixData> {
    let contents = Contents::read(path)?;
    let name = contents.chosen(path, name)?;
    let mut matrix = with_lines_of_faults(
        |fault| Reader::new(&name, fault).read(path),
        |fault| ReadError::whole(path, fault.problem(|k| format!("degree of freedom {}", k + 1))),
    )?;
    let located = contents.points.locate(path);
    matrix.positions = located.places.into_iter().collect();
    matrix.directions = located.directions;
    Ok(matrix)
}

/// Contents of a file in addition to matrix entries.
#[derive(Default)]
struct Contents {
    names: Vec<String>,
    included: Vec<String>,
    points: Points,
}

impl Contents {
    fn read(path: &Path) -> Result<Self> {
        let mut lines = Lines::open(path)?;
        let mut contents = Self::default();
        let mut card: Option<BulkCard> = None;
        while lines.advance_whole()? {
            let line = BulkLine::read(lines.line());
            match line.start {
                Start::Comment => {}
                Start::More => card.iter_mut().for_each(|card| card.extend(&line)),
                Start::Card => contents.take(path, card.replace(BulkCard::begin(&line, lines.number())))?,
                Start::Results => contents.take(path, card.take())?,
            }
            if line.start == Start::Card && !contents.begin(&lines, &line)? {
                card = None;
            }
        }
        contents.take(path, card)?;
        Ok(contents)
    }

    /// Whether the card that begins in a line belongs to a point, all lines of which are needed.
    fn begin(&mut self, lines: &Lines, line: &BulkLine<'_>) -> Result<bool> {
        self.included.extend(included(lines.line()));
        let name = line.name();
        if name == "DMIG" {
            self.names.extend(header(lines, line)?.map(|header| header.name));
        }
        Ok(Points::knows(&name))
    }

    fn take(&mut self, path: &Path, card: Option<BulkCard>) -> Result<()> {
        card.map_or(Ok(()), |card| self.points.take(path, &card))
    }

    /// The requested name, or that of the only matrix.
    fn chosen(&self, path: &Path, name: Option<&str>) -> Result<String> {
        let names = &self.names;
        let problem = match (name, names.as_slice()) {
            (_, []) => self.without_matrices(),
            (Some(name), _) if names.iter().any(|known| known.eq_ignore_ascii_case(name)) => return Ok(name.to_owned()),
            (Some(name), _) => Problem::Missing { what: "matrix", name: name.to_owned(), known: names.clone() },
            (None, [name]) => return Ok(name.clone()),
            (None, [first, ..]) => {
                let file = path.file_name().map_or("model.pch".into(), |name| name.to_string_lossy());
                let example = format!("{file}#{first}");
                Problem::Ambiguous { what: "matrices", known: names.clone(), example }
            }
        };
        Err(ReadError::whole(path, problem))
    }

    fn without_matrices(&self) -> Problem {
        let found = match self.included.first() {
            Some(file) => format!("none, but the file includes `{file}`, which may hold it"),
            None => "none".into(),
        };
        let expected = "a DMIG header: Nastran punches matrices with EXTSEOUT(STIFFNESS, MASS, DMIGPCH) or \
                        PARAM,EXTOUT,DMIGPCH; with MATOP4, DMIGOP2 or MATRIXDB it puts them into .op4, .op2 or its \
                        database instead, which are not read"
            .into();
        Problem::Expected { expected, found }
    }
}

/// `DMIG name 0 form type …`
struct Header {
    name: String,
    form: u64,
    kind: u64,
}

fn name_of(lines: &Lines, line: &BulkLine<'_>) -> Result<String> {
    let name = String::from_utf8_lossy(line.field(0)).to_uppercase();
    if name.is_empty() { Err(lines.expected("the name of a matrix", lines.line())) } else { Ok(name) }
}

/// The header, if a card is one.
fn header(lines: &Lines, line: &BulkLine<'_>) -> Result<Option<Header>> {
    let name = name_of(lines, line)?;
    if lines.unsigned(line.field(1), "number of the grid point")? != 0 {
        return Ok(None);
    }
    let form = lines.unsigned(line.field(2), "form")?;
    Ok(Some(Header { name, form, kind: lines.unsigned(line.field(3), "type of the numbers")? }))
}

/// What the lines that come belong to.
#[derive(Clone, Copy)]
enum Under {
    /// A card that is no matrix, or nothing.
    Other,
    /// The header of a matrix: a long one is continued.
    Header,
    /// A column of another matrix.
    OtherColumn,
    /// A column of the matrix that is wanted.
    Column(DofLabel),
}

/// Reads the entries of one matrix.
struct Reader<'a> {
    wanted: &'a str,
    fault: Option<Fault>,
    builder: Option<LabelledBuilder>,
    known: Vec<String>,
    under: Under,
    /// A card that is not a matrix after columns of this one.
    left: bool,
}

impl<'a> Reader<'a> {
    fn new(wanted: &'a str, fault: Option<Fault>) -> Self {
        Self { wanted, fault, builder: None, known: Vec::new(), under: Under::Other, left: false }
    }

    fn read(mut self, path: &Path) -> Result<Pass<MatrixData>> {
        let mut lines = Lines::open(path)?;
        while lines.advance_whole()? {
            let line = BulkLine::read(lines.line());
            match line.start {
                Start::Comment => {}
                Start::More => self.more(&lines, &line)?,
                Start::Card if line.name() == "DMIG" => self.card(&lines, &line)?,
                Start::Card | Start::Results => {
                    check_misspelt(&lines, &line)?;
                    self.left |= self.builder.as_ref().is_some_and(|builder| !builder.is_empty());
                    self.under = Under::Other;
                }
            }
        }
        match self.builder {
            Some(builder) if !builder.is_empty() => Ok(builder.finish()),
            _ => Err(lines.ended(&format!("columns of {}", self.wanted))),
        }
    }

    fn card(&mut self, lines: &Lines, line: &BulkLine<'_>) -> Result<()> {
        check_end(lines, line)?;
        if let Some(Header { name, form, kind }) = header(lines, line)? {
            if name.eq_ignore_ascii_case(self.wanted) {
                if self.builder.is_some() {
                    return Err(lines.expected(format!("the header of {name} once"), lines.line()));
                }
                self.builder = Some(LabelledBuilder::new(triangles(lines, form, kind)?, self.fault));
            }
            self.known.push(name);
            self.under = Under::Header;
            return Ok(());
        }
        let name = name_of(lines, line)?;
        if !self.known.contains(&name) {
            return Err(lines.expected(format!("the header of {name} before its columns"), lines.line()));
        }
        let label = dof(lines, line.field(1), line.field(2))?;
        if !name.eq_ignore_ascii_case(self.wanted) {
            self.under = Under::OtherColumn;
            return Ok(());
        }
        if self.left {
            let expected = format!("the columns of {name} one behind the other, without other cards between them");
            return Err(lines.expected(expected, lines.line()));
        }
        self.under = Under::Column(label);
        if line.is_long() { Ok(()) } else { self.entry(lines, line, label, 4) }
    }

    fn more(&mut self, lines: &Lines, line: &BulkLine<'_>) -> Result<()> {
        let Under::Column(label) = self.under else { return Ok(()) };
        check_end(lines, line)?;
        self.entry(lines, line, label, 0)?;
        if line.is_long() { Ok(()) } else { self.entry(lines, line, label, 4) }
    }

    /// Grid point, direction and value from field `first` on, if there is anything.
    fn entry(&mut self, lines: &Lines, line: &BulkLine<'_>, column: DofLabel, first: usize) -> Result<()> {
        let at = |k: usize| line.field(first + k);
        let Some(builder) = self.builder.as_mut().filter(|_| (0..4).any(|k| !at(k).is_empty())) else { return Ok(()) };
        let row = dof(lines, at(0), at(1))?;
        if real(at(2)).is_none() {
            return Err(lines.expected("a number, the value", at(2)));
        }
        builder.push(row, column, lines.real(at(2), "value")?).map_err(|problem| lines.error(problem))
    }
}

/// Nothing may follow the last field.
fn check_end(lines: &Lines, line: &BulkLine<'_>) -> Result<()> {
    let more = |more| Err(lines.expected(format!("at most {} fields between commas, and DMIG", line.width()), more));
    line.beyond().map_or(Ok(()), more)
}

/// A card whose name differs from that of a matrix by one letter would lose its column.
fn check_misspelt(lines: &Lines, line: &BulkLine<'_>) -> Result<()> {
    const CARDS: [&str; 5] = ["DMIG", "DMIJ", "DMIK", "DMI", "DTI"];
    let name = line.name();
    let differ = name.bytes().zip(b"DMIG").filter(|(a, b)| a != *b).count();
    let misspelt = line.start == Start::Card && name.len() == 4 && differ == 1 && !CARDS.contains(&name.as_str());
    if misspelt { Err(lines.expected("DMIG or another card of Nastran", lines.line())) } else { Ok(()) }
}

fn dof(lines: &Lines, node: &[u8], direction: &[u8]) -> Result<DofLabel> {
    let node = lines.unsigned(node, "number of the grid point")?;
    let number = if direction.is_empty() { Some(0) } else { unsigned(direction) };
    number
        .and_then(|number| label(node, number, true))
        .filter(|label| label.node > 0)
        .ok_or_else(|| lines.expected("a direction from 1 to 6, or 0 of a scalar point", direction))
}

fn triangles(lines: &Lines, form: u64, kind: u64) -> Result<Triangles> {
    if kind > 2 {
        return Err(lines.error(Problem::Refused {
            found: format!("numbers of type {kind}"),
            expected: "type 1 or 2, real numbers",
            reason: "complex matrices hold damping, which is given elsewhere",
        }));
    }
    match form {
        6 => Ok(Triangles::One),
        1 => Ok(Triangles::Both),
        _ => Err(lines.expected("form 6, symmetric, or form 1, square", form.to_string().as_bytes())),
    }
}
