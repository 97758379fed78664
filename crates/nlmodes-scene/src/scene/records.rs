use std::path::PathBuf;

use nlmodes::experiment::extraction::ExtractionSettings;
use nlmodes::experiment::records::Recording;

use super::{Overlay, Structure};

/// Records of a test and the extraction settings: plain values in SI units, with all defaults.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordScene {
    /// Title of tables and figures.
    pub title: String,
    /// Files as the scene names them, in its order.
    pub files: Vec<String>,
    /// Directory from which their paths count: that of the scene.
    pub base: PathBuf,
    /// Channels, sampling rate and time column.
    pub recording: Recording,
    /// Which parts of the records are levels; a record that none of them names is one level.
    pub segments: Vec<SegmentRule>,
    /// The free decay at the end of each record, if there is one: its beginning and end, s, where they are known.
    pub free_decay: Option<[Option<f64>; 2]>,
    /// The structure whose linear modes are to be used, where the scene gives no modes.
    pub structure: Option<Structure>,
    /// What is extracted from the records.
    pub settings: ExtractionSettings,
    /// Results overlaid on the records in figures and page.
    pub overlays: Vec<Overlay>,
    /// Directory of the result files.
    pub output_directory: PathBuf,
    /// Warnings about the scene, as text.
    pub warnings: Vec<String>,
}

/// Which part of a record is a level, or which parts are.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentRule {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Number of the file, from 0; `None`: each of them.
    pub file: Option<usize>,
    /// Its place in the scene, for messages.
    pub key: String,
    /// What tells it.
    pub told: SegmentTold,
}

/// What tells the part of a record in which a level is held.
#[derive(Debug, Clone, PartialEq)]
pub enum SegmentTold {
    /// Its first instant and its end, s on the time axis of the file.
    Times([f64; 2]),
    /// The name of a channel that is not zero while a level is held.
    Flag(String),
    /// Force and motion, where they are steady.
    Steady,
}

impl RecordScene {
    /// The rules for a file, by its number from 0.
    pub fn segments_of(&self, file: usize) -> Vec<&SegmentRule> {
        self.segments.iter().filter(|rule| rule.file.is_none_or(|own| own == file)).collect()
    }
}
