//! What is wrong with the text of a scene before it is TOML.

use std::ops::Range;

use crate::Diagnostic;
use crate::units::converted;

/// Maximum number of syntax errors shown: one slip often makes the rest of the text look wrong too.
const MOST: usize = 3;

/// The first syntax errors, at most one a line.
pub fn problems(text: &str, errors: &[toml::de::Error]) -> Vec<Diagnostic> {
    if !errors.is_empty()
        && let Some(problem) = no_scene(text)
    {
        return vec![problem];
    }
    let place = |error: &toml::de::Error| error.span().unwrap_or(text.len()..text.len());
    let line = |error: &toml::de::Error| text.bytes().take(place(error).start).filter(|byte| *byte == b'\n').count();
    let mut shown: Vec<&toml::de::Error> = Vec::new();
    for error in errors {
        if shown.last().is_none_or(|last| line(last) != line(error)) {
            shown.push(error);
        }
    }
    let more = shown.len().saturating_sub(MOST);
    shown.truncate(MOST);
    let mut diagnostics: Vec<Diagnostic> =
        shown.iter().map(|error| problem(text, error.message(), place(error))).collect();
    if more > 0
        && let Some(last) = diagnostics.last_mut()
    {
        last.help.push("the lines that follow cannot be read either; mend these first".into());
    }
    diagnostics
}

fn problem(text: &str, message: &str, place: Range<usize>) -> Diagnostic {
    if let Some(number) = decimal_comma(text, place.start) {
        return Diagnostic::error("a number is written with a decimal comma")
            .at(place, "expected a decimal point")
            .help(format!("write {number}"));
    }
    if let Some((key, value)) = number_with_unit(text, place.start) {
        return Diagnostic::error(format!("`{key}` is a number with a unit after it"))
            .at(place, "expected the end of the line")
            .help(format!("write {key} = {value}; the unit is part of the key"));
    }
    if message == "duplicate key"
        && let Some(problem) = one_bracket(text, place.start)
    {
        return problem;
    }
    let (title, label) = match message {
        "duplicate key" => ("a key is given twice in the same table", message),
        _ if message.contains("must be quoted") => {
            ("a text has no quotation marks", "expected a text in quotation marks")
        }
        _ if message.contains("expected `\"`") || message.contains("expected `'`") => {
            ("a quotation mark is not closed", "expected a quotation mark before the end of the line")
        }
        _ => ("the scene is not valid TOML", message),
    };
    let diagnostic = Diagnostic::error(title).at(place.clone(), label);
    match message {
        _ if message.contains("must be quoted") => {
            let (key, value) = bare_word(text, place.start).unwrap_or(("kind", "rod"));
            diagnostic.help(format!("texts need quotation marks: {key} = \"{value}\""))
        }
        _ if message.contains("array") => {
            diagnostic.help("a list needs square brackets: [50.0, 66.5]; is one not closed?")
        }
        _ => diagnostic,
    }
}

/// That a file is something else: no line of it is a heading as `[structure]`, and its first one is no key with a
/// value.
fn no_scene(text: &str) -> Option<Diagnostic> {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let first = lines.next()?;
    let is_heading = |line: &str| {
        let name = line.strip_prefix('[').map(|line| line.trim_start_matches('['));
        name.is_some_and(|name| name.starts_with(char::is_alphabetic) && name.contains(']'))
    };
    if first.contains('=') || is_heading(first) || lines.any(is_heading) {
        return None;
    }
    let kind = match first.chars().next() {
        Some('{') => "JSON, as results have it",
        Some('<') => "a page or XML",
        _ if first.contains([',', ';', '\t']) => "a table, as CSV",
        _ => "other text",
    };
    let start = text.find(first).unwrap_or(0);
    let end = start + first.chars().take(60).map(char::len_utf8).sum::<usize>();
    let diagnostic =
        Diagnostic::error("this file is not a scene: it has no heading such as [structure] and no key with a value")
            .at(start..end, format!("this looks like {kind}"))
            .help("a scene is a TOML file; `nlmodes-cli new rod` writes one with comments");
    Some(match kind {
        "a table, as CSV" => diagnostic.help(
            "a scene names its tables: measured points under [[overlay]], measured \
            records under [recording]; `nlmodes-cli at` asks branch.csv of a run",
        ),
        _ => diagnostic,
    })
}

/// That a heading has one bracket where others of the same name have two, at the one with one bracket. `at` is in any
/// of them.
fn one_bracket(text: &str, at: usize) -> Option<Diagnostic> {
    let start = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let line = text.get(start..)?.lines().next()?;
    let name = line.trim_start().trim_start_matches('[').split(']').next()?.trim();
    let place_of = |heading: &str| {
        let is_there = |line: &&str| line.split('#').next().is_some_and(|found| found.trim() == heading);
        let mut lines = text.split_inclusive('\n').scan(0, |end, line| {
            *end += line.len();
            Some((*end - line.trim_start().len(), line))
        });
        lines.find(|(_, line)| is_there(line)).map(|(place, _)| place)
    };
    let (one, two) = (format!("[{name}]"), format!("[[{name}]]"));
    place_of(&two)?;
    let place = place_of(&one)?;
    Some(
        Diagnostic::error(format!("a heading {one} is mixed with several {two}"))
            .at(place..place + one.len(), "expected two brackets")
            .help(format!("write {two}: each of several tables of the same name has two brackets")),
    )
}

/// The key of the line, and the unquoted text after it.
fn bare_word(text: &str, at: usize) -> Option<(&str, &str)> {
    let start = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let (key, value) = text.get(start..)?.lines().next()?.split('#').next()?.split_once('=')?;
    let (key, value) = (key.trim(), value.trim());
    (!key.is_empty() && !value.is_empty() && !value.contains(['"', '\\', '[', '{', ','])).then_some((key, value))
}

/// The key of the line, and a suggestion for its value, if that is a number followed by a unit.
fn number_with_unit(text: &str, at: usize) -> Option<(&str, String)> {
    let start = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let line = text.get(start..)?.lines().next()?;
    let (key, value) = line.split('#').next()?.split_once('=')?;
    let key = key.trim();
    Some((key, converted(key, value.trim())?))
}

/// The number around a comma between digits, with a point.
fn decimal_comma(text: &str, at: usize) -> Option<String> {
    let behind = text.get(at..)?.strip_prefix(',')?;
    let is_part = |c: &char| c.is_ascii_digit() || *c == '_';
    let whole: String = text.get(..at)?.chars().rev().take_while(is_part).collect();
    let decimals: String = behind.chars().take_while(is_part).collect();
    let number =
        format!("{}.{decimals}{}", whole.chars().rev().collect::<String>(), exponent(&behind[decimals.len()..]));
    (!whole.is_empty() && !decimals.is_empty()).then_some(number)
}

/// The power of ten with which the text begins, as `e-3`; nothing if there is none.
fn exponent(text: &str) -> &str {
    let Some(power) = text.strip_prefix(['e', 'E']) else { return "" };
    let signed = power.strip_prefix(['+', '-']).unwrap_or(power);
    let digits = signed.chars().take_while(char::is_ascii_digit).count();
    if digits == 0 { "" } else { &text[..text.len() - signed.len() + digits] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decimal_comma_keeps_sign_and_size() {
        let number = |text: &str| decimal_comma(text, text.find(',').unwrap_or(0));
        assert_eq!(number("gap_m = 1,5e-3").as_deref(), Some("1.5e-3"));
        assert_eq!(number("gap_m = 1,0E+2 # m").as_deref(), Some("1.0E+2"));
        assert_eq!(number("gap_m = 20,25").as_deref(), Some("20.25"));
        assert_eq!(number("gap_m = 1,5e").as_deref(), Some("1.5"));
        assert_eq!(number("a = [1, 2]"), None);
    }

    #[test]
    fn a_heading_with_one_bracket_is_found_wherever_it_stands() {
        let texts = [("[[contact]]\na = 1\n  [contact] # second\n", 20), ("[contact]\na = 1\n[[contact]]\n", 0)];
        for (text, wanted) in texts {
            let error = toml::de::DeTable::parse(text).unwrap_err();
            let problem = one_bracket(text, error.span().unwrap().start).unwrap();
            let place = problem.place.unwrap().range;
            assert_eq!((&text[place.clone()], place.start), ("[contact]", wanted));
        }
        assert!(one_bracket("[method]\na = 1\n[method]\n", 16).is_none());
    }

    #[test]
    fn files_of_other_kinds_are_no_scenes_and_slips_are() {
        for text in ["a,b\n1,2\n", "{\n \"a\": [1]\n}\n", "<html>\n", "# rig\nf;A\n"] {
            assert!(no_scene(text).is_some(), "{text}");
        }
        for text in ["title My rod\n[structure]\n", "kind = rod\n", "[structure\nkind = 1\n[[contact]]\n", ""] {
            assert!(no_scene(text).is_none(), "{text}");
        }
    }
}
