//! Damaged files: each is rejected with the file, the line or part, and the expected contents.

mod matrices;
mod meshes;
mod packed;

use std::fs;
use std::path::Path;

/// One way to damage a text, and the message.
struct Damage {
    what: &'static str,
    text: String,
    says: String,
}

/// The text with line `line` (from 1) replaced; an empty one is removed.
fn line(text: &str, line: usize, new: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    if new.is_empty() {
        lines.remove(line - 1);
    } else {
        lines[line - 1] = new;
    }
    lines.join("\n") + "\n"
}

/// The first lines of a text.
fn head(text: &str, lines: usize) -> String {
    text.lines().take(lines).map(|line| format!("{line}\n")).collect()
}

/// The text without its last characters.
fn cut(text: &str, characters: usize) -> String {
    text[..text.len() - characters].to_owned()
}

fn damage(what: &'static str, text: String, says: impl Into<String>) -> Damage {
    Damage { what, text, says: says.into() }
}

#[track_caller]
fn refused<T>(file: &str, cases: Vec<Damage>, read: impl Fn(&Path) -> nlmodes_io::Result<T>) {
    assert!(cases.len() >= 10, "{} ways to damage {file}", cases.len());
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(file);
    for case in cases {
        fs::write(&path, &case.text).unwrap();
        let message = match read(&path) {
            Ok(_) => panic!("{file}: {} is not refused", case.what),
            Err(error) => error.to_string(),
        };
        assert!(message.contains(file), "{}: {message}", case.what);
        assert!(message.contains(&case.says), "{}: {message}\ndoes not say: {}", case.what, case.says);
        assert!(message.contains("expected"), "{}: {message}", case.what);
    }
}
