//! Nastran's bulk data: cards of eight or sixteen characters a field, or with commas between fields.

mod points;

use std::borrow::Cow;

pub(crate) use points::{Directions, Points};

/// Separation of the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// Eight fields of eight characters.
    Short,
    /// Four fields of sixteen characters.
    Long,
    /// Fields between commas, as many as in the form of its lines.
    Free { long: bool },
}

/// What begins in a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Start {
    /// A card with a name.
    Card,
    /// Nothing: the fields belong to the card before.
    More,
    /// A comment or an empty line, which ends no card.
    Comment,
    /// Results punched with the cards, and their headings: no card is continued after them.
    Results,
}

/// A line of bulk data.
pub(crate) struct BulkLine<'a> {
    pub(crate) start: Start,
    text: Cow<'a, [u8]>,
    form: Form,
}

/// Tabs represent blanks up to the next field of eight characters.
fn without_tabs(line: &[u8]) -> Cow<'_, [u8]> {
    if !line.contains(&b'\t') {
        return Cow::Borrowed(line);
    }
    let mut text = Vec::with_capacity(2 * line.len());
    for byte in line {
        match byte {
            b'\t' => text.resize((text.len() / 8 + 1) * 8, b' '),
            _ => text.push(*byte),
        }
    }
    Cow::Owned(text)
}

impl<'a> BulkLine<'a> {
    pub(crate) fn read(line: &'a [u8]) -> Self {
        let data = line.iter().position(|byte| *byte == b'$').map_or(line, |end| &line[..end]);
        let empty = data.trim_ascii().is_empty();
        let text = without_tabs(data);
        let commas = text.contains(&b',');
        let first =
            Self { start: Start::Comment, text, form: if commas { Form::Free { long: false } } else { Form::Short } };
        let head = first.head();
        let (long, start) = match head {
            _ if empty && line.to_ascii_uppercase().starts_with(b"$TITLE") => (false, Start::Results),
            _ if empty => (false, Start::Comment),
            [b'*', ..] => (true, Start::More),
            [] | [b'+', ..] => (false, Start::More),
            [letter, ..] if letter.is_ascii_alphabetic() => (head.ends_with(b"*"), Start::Card),
            _ => (false, Start::Results),
        };
        let form = match (commas, long) {
            (true, long) => Form::Free { long },
            (false, true) => Form::Long,
            (false, false) => Form::Short,
        };
        Self { start, form, ..first }
    }

    /// The first field: the name of a card, or a continuation mark.
    fn head(&self) -> &[u8] {
        let end = match self.form {
            Form::Free { .. } => self.text.iter().position(|byte| *byte == b','),
            Form::Short | Form::Long => Some(8),
        };
        let end = end.unwrap_or(self.text.len()).min(self.text.len());
        self.text[..end].trim_ascii()
    }

    /// The name of the card in capital letters, without the star of long fields.
    pub(crate) fn name(&self) -> String {
        let head = self.head();
        String::from_utf8_lossy(head.strip_suffix(b"*").unwrap_or(head)).trim().to_uppercase()
    }

    /// Number of fields of data in a line of this form.
    pub(crate) fn width(&self) -> usize {
        match self.form {
            Form::Short | Form::Free { long: false } => 8,
            Form::Long | Form::Free { long: true } => 4,
        }
    }

    /// Whether fields are long.
    pub(crate) fn is_long(&self) -> bool {
        self.width() == 4
    }

    /// Field `k` of the data, from 0; empty where the line has ended.
    pub(crate) fn field(&self, k: usize) -> &[u8] {
        let width = match self.form {
            Form::Short => 8,
            Form::Long => 16,
            Form::Free { .. } => {
                return self.text.split(|byte| *byte == b',').nth(k + 1).unwrap_or_default().trim_ascii();
            }
        };
        let (from, to) = (8 + k * width, 8 + (k + 1) * width);
        self.text.get(from.min(self.text.len())..to.min(self.text.len())).unwrap_or_default().trim_ascii()
    }

    /// Text after the last comma-separated field, except a continuation mark.
    pub(crate) fn beyond(&self) -> Option<&[u8]> {
        let Form::Free { .. } = self.form else { return None };
        let rest = self.text.split(|byte| *byte == b',').skip(self.width() + 1).map(<[u8]>::trim_ascii);
        let mut rest = rest.filter(|field| !field.is_empty() && !field.starts_with(b"+") && !field.starts_with(b"*"));
        rest.next()
    }
}

/// A card with all of its lines.
pub(crate) struct BulkCard {
    pub(crate) name: String,
    /// Line in which it begins.
    pub(crate) line: u64,
    fields: Vec<Vec<u8>>,
}

/// Most fields of a card that is kept: lists of grid points are the longest ones.
const MOST_FIELDS: usize = 1 << 20;

impl BulkCard {
    pub(crate) fn begin(line: &BulkLine<'_>, number: u64) -> Self {
        let mut card = Self { name: line.name(), line: number, fields: Vec::new() };
        card.extend(line);
        card
    }

    /// Takes the fields of a further line.
    pub(crate) fn extend(&mut self, line: &BulkLine<'_>) {
        if self.fields.len() < MOST_FIELDS {
            self.fields.extend((0..line.width()).map(|k| line.field(k).to_vec()));
        }
    }

    /// Field `k` of the data, from 0, over all lines.
    pub(crate) fn field(&self, k: usize) -> &[u8] {
        self.fields.get(k).map_or(&[], Vec::as_slice)
    }

    pub(crate) fn fields(&self) -> impl Iterator<Item = &[u8]> {
        self.fields.iter().map(Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_the_same_in_each_form() {
        let lines: [&[u8]; 4] = [
            b"GRID           7       3     1.5      2.-2.5+1 $ places",
            b"GRID*                  7               3             1.5              2.",
            b"grid,7,3,1.5, 2.",
            b"GRID\t7\t3\t1.5\t2.",
        ];
        for line in lines {
            let read = BulkLine::read(line);
            let shown = String::from_utf8_lossy(line);
            assert_eq!((read.start, read.name().as_str()), (Start::Card, "GRID"), "{shown}");
            let fields: Vec<&[u8]> = (0..4).map(|k| read.field(k)).collect();
            assert_eq!(fields, [&b"7"[..], b"3", b"1.5", b"2."], "{shown}");
        }
    }

    #[test]
    fn lines_say_what_begins_in_them() {
        let cases: [(&[u8], Start, bool); 9] = [
            (b"*                      1", Start::More, true),
            (b"*A1    ,1,2", Start::More, true),
            (b"+A1            1", Start::More, false),
            (b"               1", Start::More, false),
            (b",1,2", Start::More, false),
            (b"$ anything", Start::Comment, false),
            (b"  ", Start::Comment, false),
            (b"$TITLE   = MODES", Start::Results, false),
            (b"-CONT-                  0.000000E+00", Start::Results, false),
        ];
        for (line, start, long) in cases {
            let read = BulkLine::read(line);
            assert_eq!((read.start, read.is_long()), (start, long), "{}", String::from_utf8_lossy(line));
        }
    }
}
