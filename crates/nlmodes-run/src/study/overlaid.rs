//! What is laid over a branch in its figures and on its page.

use std::path::Path;

use nlmodes::modal::ModalBranch;
use nlmodes::report::{DataTable, ReportError};

use crate::overlay::{Difference, Laid, differences, sentence, table, write};

/// Other results and their differences from the first branch.
pub struct Overlaid {
    laid: Vec<(Laid, Vec<Difference>)>,
    /// Name of the first branch, where there are others beside it.
    first: String,
}

impl Overlaid {
    /// Compares them with the first branch.
    pub fn new(laid: &[Laid], first: &ModalBranch) -> Self {
        let laid = laid.iter().map(|laid| (laid.clone(), differences(laid, first))).collect();
        Self { laid, first: first.label.clone() }
    }

    /// The other branches of a run against its first one.
    pub fn others(all: &[&ModalBranch]) -> Self {
        let Some((first, others)) = all.split_first() else {
            return Self { laid: Vec::new(), first: String::new() };
        };
        let laid = |branch: &&ModalBranch| Laid { branch: (*branch).clone(), is_scattered: false };
        Self::new(&others.iter().map(laid).collect::<Vec<_>>(), first)
    }

    /// Writes the differences, where there is anything laid over.
    ///
    /// # Errors
    /// [`ReportError::Io`].
    pub fn write(&self, directory: &Path, name: &str) -> Result<(), ReportError> {
        if self.laid.is_empty() { Ok(()) } else { write(&directory.join(name), &self.laid) }
    }

    /// The branches that are laid over.
    pub fn branches(&self) -> impl Iterator<Item = &ModalBranch> {
        self.laid.iter().map(|(laid, _)| &laid.branch)
    }

    /// Numbers of those without lines, where they stand behind `before` others.
    pub fn scattered(&self, before: usize) -> Vec<usize> {
        let all = self.laid.iter().enumerate();
        all.filter(|(_, (laid, _))| laid.is_scattered).map(|(number, _)| before + number).collect()
    }

    /// Softer or stiffer, a sentence each.
    pub fn sentences(&self) -> impl Iterator<Item = String> {
        self.laid.iter().map(|(laid, found)| sentence(laid, found, &self.first))
    }

    /// The differences, a table each.
    pub fn tables(&self) -> impl Iterator<Item = DataTable> {
        self.laid.iter().map(|(laid, found)| table(laid, found))
    }
}
