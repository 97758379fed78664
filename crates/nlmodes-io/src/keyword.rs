//! Lines of Abaqus and CalculiX that begin with a star.

/// The keyword and its options, all in capital letters but the names of files.
pub(crate) struct Keyword {
    pub(crate) name: String,
    options: Vec<(String, Option<String>)>,
}

/// A name as decks compare them.
pub(crate) fn name(text: &[u8]) -> String {
    String::from_utf8_lossy(text.trim_ascii()).trim_matches('"').to_uppercase()
}

impl Keyword {
    /// Takes the whole text of a keyword apart, from its star on.
    pub(crate) fn parse(text: &[u8]) -> Self {
        let text = String::from_utf8_lossy(text.strip_prefix(b"*").unwrap_or(text)).into_owned();
        let mut parts = text.split(',');
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
        Self { name: keyword, options: parts.map(option).collect() }
    }

    pub(crate) fn has(&self, option: &str) -> bool {
        self.options.iter().any(|(found, _)| found == option)
    }

    pub(crate) fn option(&self, option: &str) -> Option<String> {
        self.options.iter().find(|(found, _)| found == option).and_then(|(_, value)| value.clone())
    }
}
