//! The text of a scene as TOML, read once.

use toml::Spanned;
use toml::de::{DeTable, Error};

use crate::methods;

/// The text of a scene, from which come the tables of each of its methods and kinds.
#[derive(Debug)]
pub struct Text<'a> {
    /// What it is called in messages.
    pub name: &'a str,
    /// As it is written.
    pub text: &'a str,
    /// As TOML, as far as valid.
    pub root: Spanned<DeTable<'a>>,
    /// Where it is not.
    pub errors: Vec<Error>,
}

impl<'a> Text<'a> {
    /// Reads the text.
    pub fn new(name: &'a str, text: &'a str) -> Self {
        let (root, errors) = DeTable::parse_recoverable(text);
        Self { name, text, root, errors }
    }

    /// Number of its methods.
    pub fn n_methods(&self) -> usize {
        methods::count(self.root.get_ref())
    }
}
