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
    /// The structure whose linear modes are to be used, where the scene gives no modes.
    pub structure: Option<Structure>,
    /// What is to be extracted.
    pub settings: ExtractionSettings,
    /// Results overlaid on the records in figures and page.
    pub overlays: Vec<Overlay>,
    /// Directory of the result files.
    pub output_directory: PathBuf,
    /// Warnings about the scene, as text.
    pub warnings: Vec<String>,
}
