use super::source::Source;
use crate::error::Result;

/// A line that begins with a star: the keyword and its options, all in capital letters but the names of files.
pub(super) struct Keyword {
    pub(super) name: String,
    options: Vec<(String, Option<String>)>,
}

/// A name as decks compare them.
pub(super) fn name(text: &[u8]) -> String {
    String::from_utf8_lossy(text.trim_ascii()).trim_matches('"').to_uppercase()
}

impl Keyword {
    /// Reads the line, and those that follow it in its deck where it ends in a comma.
    pub(super) fn read(source: &mut Source) -> Result<Self> {
        let mut text = source.line().trim_ascii().to_vec();
        while text.ends_with(b",") && text.len() < 1 << 16 {
            if !source.advance_here()? {
                break;
            }
            text.extend_from_slice(source.line().trim_ascii());
        }
        let text = String::from_utf8_lossy(&text).into_owned();
        let mut parts = text[1..].split(',');
        let blanks = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").to_uppercase();
        let keyword = blanks(parts.next().unwrap_or_default());
        let option = |part: &str| match part.split_once('=') {
            None => (blanks(part), None),
            Some((option, value)) => {
                let option = blanks(option);
                let value = value.trim().trim_matches('"').to_owned();
                let value = if option == "INPUT" { value } else { value.to_uppercase() };
                (option, Some(value))
            }
        };
        Ok(Self { name: keyword, options: parts.map(option).collect() })
    }

    pub(super) fn has(&self, option: &str) -> bool {
        self.options.iter().any(|(found, _)| found == option)
    }

    pub(super) fn option(&self, option: &str) -> Option<String> {
        self.options.iter().find(|(found, _)| found == option).and_then(|(_, value)| value.clone())
    }

    pub(super) fn need(&self, source: &Source, option: &str) -> Result<String> {
        let value = self.option(option).filter(|value| !value.is_empty());
        value.ok_or_else(|| source.expected(&format!("{option}=… with *{}", self.name)))
    }
}
