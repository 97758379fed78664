//! Points on disk as they are found.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use nlmodes::modal::ModalPoint;
use nlmodes::report::{BranchWriter, ReportError};
use nlmodes::study::BranchProgress;

use super::progress::Progress;
use super::starts::STARTS;
use super::{figures, summary};

/// Where the files of a branch are: the first one's in the output directory itself, the others' in folders of it.
pub fn branch_directory(directory: &Path, number: usize) -> PathBuf {
    if number == 0 { directory.to_path_buf() } else { directory.join(format!("branch_{number}")) }
}

/// Takes the points of all branches, each into the table of its own.
pub struct Sink<'a> {
    directory: &'a Path,
    writers: Vec<BranchWriter>,
    /// Why a point could not be written.
    pub failure: Option<ReportError>,
    pub progress: Progress,
}

impl<'a> Sink<'a> {
    pub fn new(directory: &'a Path, quiet: bool) -> Self {
        Self { directory, writers: Vec::new(), failure: None, progress: Progress::new(quiet) }
    }

    pub fn take(&mut self, progress: BranchProgress) -> ControlFlow<()> {
        let written = match progress {
            BranchProgress::Found { branch, point } => self.write(branch, point),
            BranchProgress::Withdrawn { branch, kept } => {
                self.writers.get_mut(branch).map_or(Ok(()), |writer| writer.truncate(kept))
            }
            _ => Ok(()),
        };
        if let Err(failure) = written {
            self.failure = Some(failure);
            return ControlFlow::Break(());
        }
        if let BranchProgress::Found { point, .. } = progress {
            self.progress.point(point);
        }
        ControlFlow::Continue(())
    }

    /// Writes the table of the first branch anew, beginning with these points.
    pub fn begin_again<'p>(&mut self, points: impl Iterator<Item = &'p ModalPoint>) {
        self.writers.clear();
        for point in points {
            if self.take(BranchProgress::Found { branch: 0, point }).is_break() {
                return;
            }
        }
    }

    fn write(&mut self, branch: usize, point: &ModalPoint) -> Result<(), ReportError> {
        while self.writers.len() <= branch {
            if self.writers.is_empty() {
                self.remove_earlier();
            }
            let directory = branch_directory(self.directory, self.writers.len());
            fs::create_dir_all(&directory).map_err(|source| ReportError::Io { path: directory.clone(), source })?;
            self.writers.push(BranchWriter::create(directory.join("branch.csv"))?);
        }
        self.writers[branch].append(point)
    }

    /// Removes what an earlier run left and this one may not write again.
    fn remove_earlier(&self) {
        figures::remove(self.directory);
        summary::remove(self.directory);
        let folders = (1..).map(|number| branch_directory(self.directory, number)).take_while(|folder| folder.is_dir());
        for folder in folders {
            // What cannot be removed cannot be overwritten either, which is said when it is.
            ["branch.csv", "harmonics.npz", STARTS, "participation.csv"]
                .iter()
                .for_each(|name| drop(fs::remove_file(folder.join(name))));
            drop(fs::remove_dir(folder));
        }
    }
}
