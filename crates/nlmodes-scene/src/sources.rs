//! The texts that a scene is read from: the file, and one text for each `--set` on the command line.
//!
//! They are concatenated on a common axis, so that a range identifies both the text and the position in it.

use std::ops::Range;

/// One text: the file or a command-line argument.
#[derive(Debug, Clone)]
pub struct Source {
    /// Path of the file, or where else the text comes from.
    pub name: String,
    /// The text itself.
    pub text: String,
    start: usize,
}

impl Source {
    /// Where it begins on the common axis.
    pub fn start(&self) -> usize {
        self.start
    }
}

/// All texts of one scene.
#[derive(Debug, Clone)]
pub struct Sources {
    file: Source,
    arguments: Vec<Source>,
}

impl Sources {
    /// Begins with the file.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { file: Source { name: name.into(), text: text.into(), start: 0 }, arguments: Vec::new() }
    }

    /// The scene file.
    pub fn file(&self) -> &Source {
        &self.file
    }

    /// Adds the text of a command-line argument and returns its start on the common axis.
    pub fn add_argument(&mut self, text: String) -> usize {
        let last = self.arguments.last().unwrap_or(&self.file);
        let start = last.start + last.text.len() + 1;
        self.arguments.push(Source { name: "command line".into(), text, start });
        start
    }

    /// The text in which a range of the common axis lies, and the range within it.
    pub fn locate(&self, range: &Range<usize>) -> (&Source, Range<usize>) {
        let source = self.arguments.iter().rev().find(|source| source.start <= range.start).unwrap_or(&self.file);
        let start = floor_boundary(&source.text, range.start.saturating_sub(source.start));
        let end = ceil_boundary(&source.text, range.end.saturating_sub(source.start)).max(start);
        (source, start..end)
    }

    /// The text at a range of the common axis: its first line, shortened if it is long.
    pub fn excerpt(&self, range: &Range<usize>) -> String {
        let (source, range) = self.locate(range);
        let whole = source.text[range].trim();
        let line = whole.lines().next().unwrap_or_default();
        let short: String = line.chars().take(40).collect();
        if short.len() < whole.len() { format!("{} …", short.trim_end()) } else { short }
    }
}

fn floor_boundary(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

fn ceil_boundary(text: &str, at: usize) -> usize {
    (at..text.len()).find(|&i| text.is_char_boundary(i)).unwrap_or(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_finds_its_text() {
        let mut sources = Sources::new("a.toml", "x = 1\n");
        let first = sources.add_argument("--set x=2".into());
        let second = sources.add_argument("--set x=3".into());
        assert_eq!(sources.excerpt(&(4..5)), "1");
        assert_eq!(sources.excerpt(&(first + 8..first + 9)), "2");
        assert_eq!(sources.excerpt(&(second + 8..second + 9)), "3");
    }

    #[test]
    fn ranges_outside_or_inside_a_character_are_mended() {
        let sources = Sources::new("a.toml", "ä");
        assert_eq!(sources.locate(&(1..1)).1, 0..2);
        assert_eq!(sources.locate(&(7..9)).1, 2..2);
        assert_eq!(sources.excerpt(&(0..100)), "ä");
    }
}
