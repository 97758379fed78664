//! Points on disk as they are found.

use std::borrow::Cow;
use std::cell::Cell;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use nlmodes::branches::BranchProgress;
use nlmodes::modal::ModalPoint;
use nlmodes::report::{BranchWriter, ReportError};
use nlmodes_scene::assemble::StaticState;

use crate::claim::Claim;
use crate::files::{STARTS, remove_all, remove_ends, remove_temporary};
use crate::physical::count_from_drawing;
use crate::{Event, Observer};

/// Where the files of a branch are: the first one's in the output directory itself, the others' in folders of it.
pub fn branch_directory(directory: &Path, number: usize) -> PathBuf {
    if number == 0 { directory.to_path_buf() } else { directory.join(format!("branch_{number}")) }
}

/// Takes the points of all branches, each into the table of its own.
///
/// Points that are repeated from an earlier run go into a table that replaces its own when the first new one comes:
/// however often a run is cut off, the table never has fewer points than before.
pub struct Sink<'a> {
    directory: &'a Path,
    claim: &'a Claim,
    writers: Vec<BranchWriter>,
    /// Whether points are new.
    computing: Rc<Cell<bool>>,
    /// What static loads and stops that press do to the structure.
    state: Option<&'a StaticState>,
    /// Why a point could not be written.
    pub failure: Option<ReportError>,
    /// The observer, which may request the end.
    pub observer: &'a mut dyn Observer,
}

impl<'a> Sink<'a> {
    pub fn new(
        directory: &'a Path,
        claim: &'a Claim,
        (computing, state): (Rc<Cell<bool>>, Option<&'a StaticState>),
        observer: &'a mut dyn Observer,
    ) -> Self {
        Self { directory, claim, writers: Vec::new(), computing, state, failure: None, observer }
    }

    pub fn take(&mut self, progress: BranchProgress) -> ControlFlow<()> {
        if self.failure.is_some() {
            return ControlFlow::Break(());
        }
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
        match progress {
            BranchProgress::Found { branch, point } => {
                self.observer.event(Event::Point { branch, point, is_new: self.computing.get() });
            }
            BranchProgress::Withdrawn { kept, .. } => self.observer.event(Event::Withdrawn { kept }),
            _ => {}
        }
        if self.observer.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Rewrites the table of the first branch, beginning with these points.
    pub fn begin_again<'p>(&mut self, points: impl Iterator<Item = &'p ModalPoint>) {
        let again = || -> Result<Vec<BranchWriter>, ReportError> {
            let mut writer = BranchWriter::create_hidden(self.directory.join("branch.csv"))?;
            points.into_iter().try_for_each(|point| writer.append(&from_drawing(self.state, point)))?;
            Ok(vec![writer])
        };
        match again() {
            Ok(writers) => {
                let points = writers.iter().map(BranchWriter::n_points).sum();
                self.observer.event(Event::Turned { points });
                self.writers = writers;
            }
            Err(failure) => self.failure = Some(failure),
        }
    }

    /// All points are there.
    pub fn finish(&mut self) {
        self.observer.event(Event::Computed);
        if self.failure.is_none() {
            self.failure = self.show().err();
        }
    }

    /// Whether any point was found.
    pub fn is_empty(&self) -> bool {
        self.writers.iter().all(|writer| writer.n_points() == 0)
    }

    fn show(&mut self) -> Result<(), ReportError> {
        self.writers.iter_mut().try_for_each(BranchWriter::show)
    }

    fn write(&mut self, branch: usize, point: &ModalPoint) -> Result<(), ReportError> {
        while self.writers.len() <= branch {
            if self.writers.is_empty() {
                self.claim.take()?;
                self.remove_earlier();
            }
            let directory = branch_directory(self.directory, self.writers.len());
            fs::create_dir_all(&directory).map_err(|source| ReportError::Io { path: directory.clone(), source })?;
            remove_temporary(&directory);
            self.writers.push(BranchWriter::create_hidden(directory.join("branch.csv"))?);
        }
        self.writers[branch].append(&from_drawing(self.state, point))?;
        if self.computing.get() { self.show() } else { Ok(()) }
    }

    /// Removes what an earlier run left and this one may not write again.
    fn remove_earlier(&self) {
        remove_ends(self.directory);
        if self.claim.resumes() {
            return;
        }
        let folders = (1..).map(|number| branch_directory(self.directory, number)).take_while(|folder| folder.is_dir());
        for folder in folders {
            remove_all(&folder, &["branch.csv", "contacts.csv", "harmonics.npz", STARTS, "participation.csv"]);
            drop(fs::remove_dir(folder));
        }
    }
}

/// The point with displacements that are counted from the drawing.
fn from_drawing<'p>(state: Option<&StaticState>, point: &'p ModalPoint) -> Cow<'p, ModalPoint> {
    let mut point = Cow::Borrowed(point);
    state.into_iter().for_each(|state| count_from_drawing(state, point.to_mut()));
    point
}
