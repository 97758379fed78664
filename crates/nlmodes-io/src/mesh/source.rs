use std::path::Path;
use std::rc::Rc;

use crate::error::{Problem, ReadError, Result};
use crate::keyword::Keyword;
use crate::text::Lines;

/// A position: a deck and a line of it.
pub(super) type Mention = (Rc<Path>, u64);

/// Most decks that include each other.
const DEEPEST: usize = 16;

/// Most decks that are included in all: a few that include each other twice would be a million.
const MOST: u64 = 10_000;

/// The lines of a deck and of the decks that it includes.
pub(super) struct Source {
    open: Vec<(Lines, Rc<Path>)>,
    included: u64,
}

impl Source {
    pub(super) fn open(path: &Path) -> Result<Self> {
        Ok(Self { open: vec![(Lines::open(path)?, path.into())], included: 0 })
    }

    fn top(&self) -> &(Lines, Rc<Path>) {
        &self.open[self.open.len() - 1]
    }

    /// Goes on to the next line; after the last one of an included deck, in the deck that includes it.
    pub(super) fn advance(&mut self) -> Result<bool> {
        loop {
            let last = self.open.len() - 1;
            if self.open[last].0.advance()? {
                return Ok(true);
            }
            if last == 0 {
                return Ok(false);
            }
            self.open.pop();
        }
    }

    /// Goes on to the next line of this deck, if it has one.
    fn advance_here(&mut self) -> Result<bool> {
        let last = self.open.len() - 1;
        self.open[last].0.advance()
    }

    /// Goes on with another deck; its name is relative to that of this one.
    pub(super) fn include(&mut self, name: &str) -> Result<()> {
        if self.open.len() == DEEPEST {
            let (found, limit) = (DEEPEST as u64 + 1, DEEPEST as u64);
            return Err(self.error(Problem::TooLarge {
                what: "number of decks that include each other",
                found,
                limit,
            }));
        }
        self.included += 1;
        if self.included > MOST {
            let (found, limit) = (self.included, MOST);
            return Err(self.error(Problem::TooLarge { what: "number of decks that are included", found, limit }));
        }
        let path = self.top().1.parent().unwrap_or(Path::new("")).join(name);
        let lines = Lines::open(&path).map_err(|error| {
            let found = error.to_string();
            self.error(Problem::Expected { expected: "a deck that can be read".into(), found })
        })?;
        self.open.push((lines, path.into()));
        Ok(())
    }

    /// The keyword that begins in this line, with the lines of its deck that follow it where it ends in a comma.
    pub(super) fn keyword(&mut self) -> Result<Keyword> {
        let mut text = self.line().trim_ascii().to_vec();
        while text.ends_with(b",") && text.len() < 1 << 16 {
            if !self.advance_here()? {
                break;
            }
            text.extend_from_slice(self.line().trim_ascii());
        }
        Ok(Keyword::parse(&text))
    }

    /// The value of an option that a keyword must have.
    pub(super) fn need(&self, keyword: &Keyword, option: &str) -> Result<String> {
        let value = keyword.option(option).filter(|value| !value.is_empty());
        value.ok_or_else(|| self.expected(&format!("{option}=… with *{}", keyword.name)))
    }

    pub(super) fn line(&self) -> &[u8] {
        self.top().0.line()
    }

    pub(super) fn mention(&self) -> Mention {
        let (lines, path) = self.top();
        (Rc::clone(path), lines.number())
    }

    pub(super) fn error(&self, problem: Problem) -> ReadError {
        self.top().0.error(problem)
    }

    /// Unexpected line.
    pub(super) fn expected(&self, expected: &str) -> ReadError {
        self.top().0.expected(expected, self.line())
    }

    pub(super) fn unsigned(&self, field: &[u8], what: &str) -> Result<u64> {
        self.top().0.unsigned(field, what)
    }

    pub(super) fn real(&self, field: &[u8], what: &'static str) -> Result<f64> {
        self.top().0.real(field, what)
    }
}
