use std::fmt;
use std::path::{Path, PathBuf};

/// A matrix in a file: the file, and the matrix's name in it where it holds several, as in `model.mat#K`.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "String", from = "String"))]
pub struct Address {
    /// The file.
    pub path: PathBuf,
    /// Name of the matrix within it.
    pub name: Option<String>,
}

impl Address {
    /// Takes an address apart at its last `#`; a file whose own name contains one is used as it is.
    ///
    /// ```
    /// use nlmodes_io::Address;
    /// let address = Address::parse("model.mat#K");
    /// assert_eq!((address.path.to_str(), address.name.as_deref()), (Some("model.mat"), Some("K")));
    /// assert_eq!(Address::parse("plate.sti").name, None);
    /// ```
    pub fn parse(text: &str) -> Self {
        match text.rsplit_once('#') {
            Some((path, name)) if !path.is_empty() && !name.is_empty() && !Path::new(text).exists() => {
                Self { path: path.into(), name: Some(name.to_owned()) }
            }
            _ => Self { path: text.into(), name: None },
        }
    }

    /// The same matrix of a file relative to `directory`.
    pub fn within(self, directory: &Path) -> Self {
        Self { path: directory.join(self.path), name: self.name }
    }

    /// Ending of the file's name in lower case, without `.gz`.
    pub(crate) fn ending(&self) -> String {
        let name = self.path.file_name().map_or_else(String::new, |name| name.to_string_lossy().to_lowercase());
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        name.rsplit_once('.').map_or_else(String::new, |(_, ending)| ending.to_owned())
    }
}

impl From<String> for Address {
    fn from(text: String) -> Self {
        Self::parse(&text)
    }
}

impl From<Address> for String {
    fn from(address: Address) -> Self {
        address.to_string()
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        self.name.as_ref().map_or(Ok(()), |name| write!(f, "#{name}"))
    }
}
