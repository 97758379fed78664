//! Bulk data of Nastran: grid points, elements, supports and `SET1` of a deck or of a punch file.

use std::path::Path;

use super::source::{Mention, Source};
use super::{Element, ElementKind, Mesh};
use crate::error::{Place, Problem, ReadError, Result, shown};
use crate::nastran::{BulkCard, BulkLine, Points, Start};
use crate::text::unsigned;

/// How a card names the nodes of its element.
struct Shape {
    kind: ElementKind,
    /// Field of the first node, from 0.
    first: usize,
    /// Number of nodes with those in the middle of edges, which may be left out.
    most: usize,
}

fn shape(name: &str) -> Option<Shape> {
    use ElementKind::{Hexahedron, Line, Pyramid, Quadrangle, Tetrahedron, Triangle, Wedge};
    let (kind, first, most) = match name {
        "CBAR" | "CBEAM" | "CROD" | "CTUBE" | "CBEND" => (Line, 2, 2),
        "CONROD" | "PLOTEL" => (Line, 1, 2),
        "CTRIA3" | "CTRIAR" => (Triangle, 2, 3),
        "CTRIA6" => (Triangle, 2, 6),
        "CQUAD4" | "CQUADR" | "CSHEAR" => (Quadrangle, 2, 4),
        "CQUAD8" | "CQUAD" => (Quadrangle, 2, 8),
        "CTETRA" => (Tetrahedron, 2, 10),
        "CPYRAM" | "CPYRA" => (Pyramid, 2, 13),
        "CPENTA" => (Wedge, 2, 15),
        "CHEXA" => (Hexahedron, 2, 20),
        _ => return None,
    };
    Some(Shape { kind, first, most })
}

/// Cards that join nodes without a shape.
fn joins(name: &str) -> bool {
    const STARTS: [&str; 9] = ["CBUSH", "CELAS", "CMASS", "CONM", "CDAMP", "RBE", "RBAR", "CGAP", "CFAST"];
    STARTS.iter().any(|start| name.starts_with(start))
}

/// Bottom, top, then upright edges from bottom, upright, top.
fn ordered(kind: ElementKind, nodes: &[u64]) -> Vec<u64> {
    let edges = match (kind, nodes.len()) {
        (ElementKind::Hexahedron, 20) => 4,
        (ElementKind::Wedge, 15) => 3,
        _ => return nodes.to_vec(),
    };
    let (head, middle) = nodes.split_at(kind.corners() + edges);
    let (upright, top) = middle.split_at(edges);
    [head, top, upright].concat()
}

pub(super) fn read(path: &Path) -> Result<Mesh> {
    let mut source = Source::open(path)?;
    let mut deck = Deck::default();
    let mut card: Option<(BulkCard, Mention)> = None;
    while source.advance()? {
        let line = BulkLine::read(source.line());
        match line.start {
            Start::Comment => {}
            Start::More => {
                if let Some((card, _)) = &mut card {
                    card.extend(&line);
                }
            }
            Start::Results if source.line().trim_ascii().starts_with(b"=") => {
                return Err(source.error(Problem::Refused {
                    found: shown(source.line()),
                    expected: "cards with all of their fields",
                    reason: "cards that repeat fields of the one before are not read; write the deck with all its \
                        nodes",
                }));
            }
            Start::Card | Start::Results => {
                let name = if line.start == Start::Card { line.name() } else { String::new() };
                let mention = source.mention();
                let next = Deck::reads(&name).then(|| (BulkCard::begin(&line, mention.1), mention));
                if let Some((card, mention)) = std::mem::replace(&mut card, next) {
                    deck.take(&card, mention)?;
                }
                match included(source.line()) {
                    Some(file) => source.include(&file)?,
                    None if name == "ENDDATA" => break,
                    None => {}
                }
            }
        }
    }
    if let Some((card, mention)) = card {
        deck.take(&card, mention)?;
    }
    deck.finish(path)
}

/// The file that a line includes.
pub(crate) fn included(line: &[u8]) -> Option<String> {
    let (head, file) = line.trim_ascii().split_at_checked(7)?;
    let quotes = |c: char| matches!(c, '\'' | '"') || c.is_whitespace();
    head.eq_ignore_ascii_case(b"INCLUDE").then(|| String::from_utf8_lossy(file).trim_matches(quotes).to_owned())
}

/// Most nodes that the sets of a deck name: a few lines could name more than fit into memory.
const MOST_IN_SETS: u64 = 50_000_000;

/// The first and the last number of a range.
type Range = (u64, u64);

/// Ranges in the fields of a card from `first` on: numbers, and `first, THRU, last`.
fn listed(card: &BulkCard, first: usize, mention: &Mention) -> Result<Vec<Range>> {
    let (mut ranges, mut through): (Vec<Range>, bool) = (Vec::new(), false);
    for field in card.fields().skip(first).filter(|field| !field.is_empty()) {
        through |= field.eq_ignore_ascii_case(b"THRU");
        let Some(number) = unsigned(field) else { continue };
        match ranges.last_mut().filter(|_| through) {
            Some((first, last)) if number >= *first => *last = number,
            Some((first, _)) => {
                let expected = format!("a range that ascends from {first}");
                let problem = Problem::Expected { expected, found: number.to_string() };
                return Err(ReadError::new(&mention.0, Place::Line(card.line), problem));
            }
            None => ranges.push((number, number)),
        }
        through = false;
    }
    Ok(ranges)
}

#[derive(Default)]
struct Deck {
    mesh: Mesh,
    points: Points,
    elements: Vec<(u64, ElementKind, Vec<u64>, Mention)>,
    sets: Vec<(String, Vec<Range>)>,
    held: Vec<(Range, [bool; 3])>,
}

impl Deck {
    fn reads(name: &str) -> bool {
        Points::knows(name) || shape(name).is_some() || joins(name) || matches!(name, "SET1" | "SPC" | "SPC1")
    }

    fn take(&mut self, card: &BulkCard, mention: Mention) -> Result<()> {
        match (card.name.as_str(), shape(&card.name)) {
            ("SET1", _) => {
                let name = String::from_utf8_lossy(card.field(0)).into_owned();
                self.sets.push((name, listed(card, 1, &mention)?));
                Ok(())
            }
            ("SPC1", _) => {
                listed(card, 2, &mention)?.into_iter().for_each(|range| self.hold(range, card.field(1)));
                Ok(())
            }
            ("SPC", _) => {
                let nodes = [1, 4].into_iter().filter_map(|k| unsigned(card.field(k)).map(|node| (k, node)));
                nodes.for_each(|(k, node)| self.hold((node, node), card.field(k + 1)));
                Ok(())
            }
            ("GRID", _) => {
                unsigned(card.field(0)).into_iter().for_each(|node| self.hold((node, node), card.field(6)));
                self.points.take(&mention.0, card)
            }
            (_, Some(shape)) => self.element(card, &shape, mention),
            (name, None) if Points::knows(name) => self.points.take(&mention.0, card),
            (name, None) => {
                *self.mesh.passed_over.entry(name.to_owned()).or_default() += 1;
                Ok(())
            }
        }
    }

    fn element(&mut self, card: &BulkCard, shape: &Shape, mention: Mention) -> Result<()> {
        let node = |k: usize| unsigned(card.field(shape.first + k)).filter(|node| *node > 0);
        let wrong = |k: usize| {
            let expected = format!("a node in field {} of {}", k + 2, card.name);
            let problem = Problem::Expected { expected, found: shown(card.field(k)) };
            ReadError::new(&mention.0, Place::Line(card.line), problem)
        };
        let corners = shape.kind.corners();
        let mut nodes = Vec::new();
        for k in 0..corners {
            nodes.push(node(k).ok_or_else(|| wrong(shape.first + k))?);
        }
        // Some midside nodes are omitted: the corner nodes alone define the shape.
        let middles: Option<Vec<u64>> = (corners..shape.most).map(node).collect();
        nodes.extend(middles.unwrap_or_default());
        let number = unsigned(card.field(0)).ok_or_else(|| wrong(0))?;
        self.elements.push((number, shape.kind, ordered(shape.kind, &nodes), mention));
        Ok(())
    }

    /// Fixes the directions whose digits are in a field.
    fn hold(&mut self, range: Range, directions: &[u8]) {
        let mut held = [false; 3];
        for axis in directions.iter().filter_map(|digit| digit.checked_sub(b'1')).filter(|axis| *axis < 3) {
            held[usize::from(axis)] = true;
        }
        if held != [false; 3] {
            self.held.push((range, held));
        }
    }

    /// Sets and supports of the nodes that are there.
    fn resolve(&mut self, path: &Path) -> Result<()> {
        let mut count = 0;
        let mut numbers = self.mesh.numbers.clone();
        numbers.sort_unstable();
        let within = |(first, last): Range| {
            let (from, to) = (numbers.partition_point(|n| *n < first), numbers.partition_point(|n| *n <= last));
            numbers[from..to].to_vec()
        };
        for (name, ranges) in std::mem::take(&mut self.sets) {
            let nodes: Vec<u64> = ranges.into_iter().flat_map(within).collect();
            count += nodes.len() as u64;
            if count > MOST_IN_SETS {
                let (what, limit) = ("number of nodes that sets name", MOST_IN_SETS);
                return Err(ReadError::whole(path, Problem::TooLarge { what, found: count, limit }));
            }
            self.mesh.add_to_set(&name, nodes);
        }
        let supports = self.mesh.supports.get_or_insert_default();
        for (range, held) in std::mem::take(&mut self.held) {
            for node in within(range) {
                supports.entry(node).or_default().iter_mut().zip(held).for_each(|(own, held)| *own |= held);
            }
        }
        self.mesh.sort_sets();
        Ok(())
    }

    fn finish(mut self, path: &Path) -> Result<Mesh> {
        let located = self.points.locate(path);
        if let Some(error) = located.unplaced {
            return Err(error);
        }
        if located.places.is_empty() {
            return Err(ReadError::whole(path, Problem::Ended { expected: "grid points (GRID)".into() }));
        }
        for (number, place) in located.places {
            // Each number comes once.
            let _ = self.mesh.add_node(number, place);
        }
        self.mesh.directions = located.directions;
        self.resolve(path)?;
        for (number, kind, nodes, (path, line)) in std::mem::take(&mut self.elements) {
            let index = |node: &u64| {
                self.mesh.index_of(*node).map(|index| index as u32).ok_or_else(|| {
                    let (expected, found) =
                        ("grid points of the deck".to_owned(), format!("node {node}, which is not there"));
                    ReadError::new(&path, Place::Line(line), Problem::Expected { expected, found })
                })
            };
            let nodes = nodes.iter().map(index).collect::<Result<_>>()?;
            self.mesh.elements.push(Element { number, kind, nodes });
        }
        Ok(self.mesh)
    }
}
