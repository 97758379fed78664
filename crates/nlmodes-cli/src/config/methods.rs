//! A scene with several methods: one scene for each, with the same places.

/// Heading of one of several methods, and of the only one; both are of one length.
const HEADINGS: (&str, &str) = ("[[method]]", " [method] ");

/// The texts of the scenes with one method each; the text itself where there is no heading `[[method]]`.
///
/// The tables of the other methods become spaces, so that every line and column stays where it is.
pub fn split(text: &str) -> Vec<String> {
    let count = text.split_inclusive('\n').filter(|line| is_method(line)).count();
    if count == 0 {
        return vec![text.to_owned()];
    }
    (0..count).map(|number| only(text, number)).collect()
}

fn only(text: &str, number: usize) -> String {
    let (mut seen, mut hidden) = (0, false);
    let line = |line: &str| {
        if is_method(line) {
            hidden = seen != number;
            seen += 1;
        } else if line.trim_start().starts_with('[') {
            hidden = false;
        }
        if hidden { line.chars().map(blank).collect() } else { line.replacen(HEADINGS.0, HEADINGS.1, 1) }
    };
    text.split_inclusive('\n').map(line).collect()
}

fn is_method(line: &str) -> bool {
    line.trim_start().starts_with(HEADINGS.0)
}

/// Spaces of the same number of bytes.
fn blank(c: char) -> String {
    if c == '\n' || c == '\r' { c.to_string() } else { " ".repeat(c.len_utf8()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "a = 1\n[[method]] # first\nkind = \"ms-hbm\" # é\n\n[[method]]\nkind = \"hbm\"\n[output]\nb = 2\n";

    #[test]
    fn each_method_has_a_scene_with_the_same_places() {
        let found = split(TEXT);
        assert_eq!(found.len(), 2);
        for (text, kind) in found.iter().zip(["ms-hbm", "hbm"]) {
            assert_eq!(text.len(), TEXT.len());
            assert_eq!(text.find("kind"), TEXT.find(&format!("kind = \"{kind}\"")));
            assert!(text.contains("[output]\nb = 2\n") && text.starts_with("a = 1\n"));
            assert!(text.parse::<toml::Table>().unwrap()["method"]["kind"].as_str() == Some(kind));
        }
    }

    #[test]
    fn a_scene_with_one_method_is_itself() {
        let text = "[method]\nkind = \"hbm\"\n";
        assert_eq!(split(text), [text]);
        assert_eq!(split("[[method]]\nx = 1\n"), [" [method] \nx = 1\n"]);
    }
}
