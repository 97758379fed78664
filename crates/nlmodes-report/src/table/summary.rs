use crate::ReportError;
use crate::output::replace_file;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// Writes a summary as indented JSON; an existing file is replaced atomically.
///
/// JSON has no NaN and no infinity: they become `null`.
///
/// # Errors
/// [`ReportError::Json`] if `summary` has no JSON form, [`ReportError::Io`] if the file cannot be written.
pub fn write_summary(path: impl AsRef<Path>, summary: &impl Serialize) -> Result<(), ReportError> {
    let path = path.as_ref();
    let text = serde_json::to_string_pretty(summary)
        .map_err(|source| ReportError::Json { path: path.to_path_buf(), source })?;
    replace_file(path, |file| writeln!(file, "{text}"))
}
