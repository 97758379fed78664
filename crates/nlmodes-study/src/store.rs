//! The directory of a study: a case is complete when its `case.json` exists, and is computed by the process that holds
//! its lock.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::case::hex;
use crate::error::StudyError;

const CASES: &str = "cases";
const RECORD: &str = "case.json";
const LOCK: &str = ".lock";

/// How a case ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Its branch is complete.
    Complete,
    /// Its branch ended early, with the reason.
    Incomplete,
    /// There is no branch, with the reason.
    Failed,
}

impl Status {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Incomplete => "incomplete",
            Self::Failed => "failed",
        }
    }
}

/// Contents of `case.json`, the last file of a case to be written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseRecord {
    /// Version of the program.
    pub version: String,
    /// How it ended.
    pub status: Status,
    /// Why it ended, in words, also for a complete branch.
    pub reason: String,
    /// The `--set` arguments, in addition to the scene.
    pub set: Vec<String>,
    /// Computation time, s, of the last process.
    pub seconds: f64,
    /// SHA-256 of `branch.csv`; empty if there is none.
    pub branch_sha256: String,
}

/// The directory of a study.
#[derive(Debug, Clone)]
pub struct Store {
    directory: PathBuf,
}

/// The right to compute a case, until it is dropped.
#[derive(Debug)]
pub struct Claim {
    lock: PathBuf,
    _file: File,
}

impl Store {
    /// In this directory, which need not exist yet.
    pub fn new(directory: &Path) -> Self {
        Self { directory: directory.to_path_buf() }
    }

    /// The directory.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// The directory of a case.
    pub fn case(&self, id: &str) -> PathBuf {
        self.directory.join(CASES).join(id)
    }

    /// Path of a case within the directory of the study, as a link of its page.
    pub fn link(id: &str) -> String {
        format!("{CASES}/{id}")
    }

    /// How a case ended; `None` if it has not ended yet, or its record is damaged.
    pub fn record(&self, id: &str) -> Option<CaseRecord> {
        serde_json::from_slice(&fs::read(self.case(id).join(RECORD)).ok()?).ok()
    }

    /// Acquires the right to compute a case; `None` if another process has it.
    ///
    /// # Errors
    /// [`StudyError::Io`] if its directory cannot be written.
    pub fn claim(&self, id: &str) -> Result<Option<Claim>, StudyError> {
        let directory = self.case(id);
        fs::create_dir_all(&directory).map_err(StudyError::io(&directory))?;
        let lock = directory.join(LOCK);
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(&lock);
        let file = file.map_err(StudyError::io(&lock))?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Claim { lock, _file: file })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(source)) => Err(StudyError::io(&lock)(source)),
        }
    }

    /// Records how a case ended, which releases the claim.
    ///
    /// # Errors
    /// [`StudyError::Io`] if it cannot be written.
    pub fn finish(&self, id: &str, record: &CaseRecord, claim: Claim) -> Result<(), StudyError> {
        let path = self.case(id).join(RECORD);
        let text = serde_json::to_vec(record).unwrap_or_default();
        replace(&path, &text).map_err(StudyError::io(&path))?;
        // A process that opened the same file before will find, once it has the lock, that the case is complete.
        drop(fs::remove_file(&claim.lock));
        Ok(())
    }

    /// Removes the record of a case, so that it is computed again.
    ///
    /// # Errors
    /// [`StudyError::Io`] if it cannot be removed.
    pub fn forget(&self, id: &str) -> Result<(), StudyError> {
        let path = self.case(id).join(RECORD);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(StudyError::io(&path)(error)),
            _ => Ok(()),
        }
    }

    /// Names of all directories of cases, also of other studies and versions.
    pub fn all(&self) -> Vec<String> {
        let Ok(entries) = fs::read_dir(self.directory.join(CASES)) else { return Vec::new() };
        let mut names: Vec<String> =
            entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

/// SHA-256 of the branch in a directory; empty if there is none.
pub fn branch_sha256(directory: &Path) -> String {
    fs::read(directory.join("branch.csv")).map_or_else(|_| String::new(), |bytes| hex(&Sha256::digest(&bytes)))
}

/// Writes a file under another name and renames it, so that it is either complete or absent.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let temporary = path.with_file_name(format!(".{name}.{}.nlmodes.tmp", std::process::id()));
    let written = File::create(&temporary).and_then(|mut file| file.write_all(bytes));
    written.and_then(|()| fs::rename(&temporary, path)).inspect_err(|_| drop(fs::remove_file(&temporary)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_is_computed_by_one_and_done_when_its_record_is_there() {
        let place = tempfile::tempdir().unwrap();
        let store = Store::new(place.path());
        let claim = store.claim("a").unwrap().unwrap();
        assert!(store.claim("a").unwrap().is_none() && store.claim("b").unwrap().is_some());
        assert_eq!(store.record("a"), None);
        let record = CaseRecord {
            version: "1".into(),
            status: Status::Complete,
            reason: "it closed".into(),
            set: vec!["a=1".into()],
            seconds: 0.5,
            branch_sha256: String::new(),
        };
        store.finish("a", &record, claim).unwrap();
        assert_eq!(store.record("a"), Some(record));
        fs::write(store.case("a").join(RECORD), "{\"version\":").unwrap();
        assert_eq!(store.record("a"), None);
        // A killed process left its lock file, which no process holds.
        assert!(store.claim("a").unwrap().is_some() && store.claim("a").unwrap().is_some());
    }
}
