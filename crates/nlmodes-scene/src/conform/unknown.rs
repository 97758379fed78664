//! Keys that the schema does not know, and what they were probably meant to be.

use crate::Diagnostic;
use crate::nearest::nearest;
use crate::rule::{Kind, Rule, join};

/// What an unknown key was probably meant to be.
#[derive(Debug, PartialEq, Eq)]
pub enum Guess {
    /// This key of the same table.
    Key(String),
    /// This key, of the table at this path.
    Elsewhere(String, String),
    /// Something that the program does not compute, by its name.
    Absent(&'static str),
    /// No idea.
    Nothing,
}

/// Features that the program does not have, by the words used for them in keys and values.
const ABSENT: [(&str, &[&str]); 4] = [
    ("friction", &["friction", "coulomb", "mu", "stick", "slip"]),
    ("an annular stop", &["annular", "annulus", "circular", "ring"]),
    ("a restitution coefficient", &["restitution"]),
    ("a nonlinear material", &["plastic", "plasticity", "hyperelastic", "yield"]),
];

/// The probable meaning of an unknown key or word.
pub fn absent(text: &str) -> Option<&'static str> {
    let text = text.to_lowercase();
    let parts = || text.split(['_', '-', ' ']);
    ABSENT.iter().find(|(_, words)| parts().any(|part| words.contains(&part))).map(|(name, _)| *name)
}

/// Adds a note about a feature that the program does not have.
pub fn with_absent(diagnostic: Diagnostic, what: &str) -> Diagnostic {
    diagnostic.help(format!("{what} is not in this program; see \"What it does not do\" in README.md"))
}

/// What the key, written in the table at `path` with a value that may be a text, was probably meant to be.
pub fn guess(key: &str, text: Option<&str>, path: &str, root: Rule<'_>) -> Guess {
    if let Some(what) = absent(key).or_else(|| absent(text?)) {
        return Guess::Absent(what);
    }
    let mut tables = Vec::new();
    collect(root, String::new(), &mut tables);
    let here = without_numbers(path);
    // A letter s too few or too many is a slip in this table, whatever other tables have.
    let is_plural = |one: &str, many: &str| many.strip_suffix('s') == Some(one);
    let own = tables.iter().find(|(table, _)| *table == here);
    let slip = own.and_then(|(_, rule)| rule.keys().find(|own| is_plural(own, key) || is_plural(key, own)));
    if let Some(own) = slip {
        return Guess::Key(own.to_owned());
    }
    let elsewhere = tables.iter().find(|(table, rule)| *table != here && rule.of(key).is_some());
    if let Some((table, _)) = elsewhere {
        return Guess::Elsewhere(key.to_owned(), table.clone());
    }
    let own = own.and_then(|(_, rule)| nearest(key, rule.keys()));
    if let Some(own) = own {
        return Guess::Key(own.to_owned());
    }
    let other = tables.iter().find_map(|(table, rule)| Some((nearest(key, rule.keys())?, table)));
    other.map_or(Guess::Nothing, |(key, table)| Guess::Elsewhere(key.to_owned(), table.clone()))
}

/// All tables of the schema with their paths, arrays of tables without numbers.
fn collect<'a>(rule: Rule<'a>, path: String, tables: &mut Vec<(String, Rule<'a>)>) {
    for key in rule.keys() {
        let inner = rule.of(key).and_then(|rule| if rule.kind() == Kind::Array { rule.items() } else { Some(rule) });
        if let Some(inner) = inner.filter(|inner| inner.kind() == Kind::Table) {
            collect(inner, join(&path, key), tables);
        }
    }
    tables.push((path, rule));
}

fn without_numbers(path: &str) -> String {
    let names: Vec<&str> = path.split('.').filter(|part| part.parse::<usize>().is_err()).collect();
    names.join(".")
}

impl Guess {
    /// The label of the key.
    pub fn label(&self, path: &str) -> String {
        match self {
            Self::Key(key) => format!("did you mean `{key}`?"),
            Self::Absent(_) => "not in this program".into(),
            Self::Elsewhere(..) | Self::Nothing if path.is_empty() => "a scene has no such key here".into(),
            Self::Elsewhere(..) | Self::Nothing => format!("not a key of {}", heading(path)),
        }
    }

    /// The probably intended path, if it is in the table at `path` or in one that occurs once in a scene.
    pub fn path(&self, path: &str) -> Option<String> {
        match self {
            Self::Key(key) => Some(join(path, key)),
            Self::Elsewhere(key, table) => Some(join(table, key)),
            Self::Absent(_) | Self::Nothing => None,
        }
    }
}

/// The diagnostic of an unknown key in the table at `path`.
pub fn diagnostic(key: &str, path: &str, table: Rule<'_>, guess: &Guess) -> Diagnostic {
    let diagnostic = Diagnostic::error(format!("unknown key `{}`", join(path, key)));
    match guess {
        Guess::Key(_) => diagnostic,
        Guess::Absent(what) => with_absent(diagnostic, what),
        Guess::Elsewhere(key, other) if other.is_empty() => {
            diagnostic.help(format!("`{key}` belongs at the top of the file, before the first heading in brackets"))
        }
        Guess::Elsewhere(key, other) => diagnostic.help(format!("`{key}` is a key of {}", heading(other))),
        Guess::Nothing => {
            let keys: Vec<&str> = table.keys().collect();
            let place = if path.is_empty() { "a scene".to_owned() } else { heading(path) };
            diagnostic.help(format!("{place} may have: {}", keys.join(", ")))
        }
    }
}

/// Tables that may occur several times.
const LISTS: [&str; 12] = [
    "contact",
    "channel",
    "vary",
    "quantity",
    "force",
    "static_force",
    "spring",
    "sensitivity",
    "damping.dashpot",
    "structure.mass_point",
    "structure.spring",
    "structure.segment",
];

/// The heading of a table as written: `[structure.material]`, `[[contact]]`.
pub fn heading(path: &str) -> String {
    let name = without_numbers(path);
    if LISTS.contains(&name.as_str()) { format!("[[{name}]]") } else { format!("[{name}]") }
}
