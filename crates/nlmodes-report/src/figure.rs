//! Figures: what a reader sees.

mod branch;
mod contacts;
mod convergence;
mod events;
mod history;
mod measured;
mod motion;
mod participation;
mod response;
mod spread;
mod stiffness;
mod stroboscope;

pub use branch::{Abscissa, BranchFigure};
pub use contacts::ContactFigure;
pub use convergence::ConvergenceFigure;
pub(crate) use events::EventSymbols;
pub use history::HistoryFigure;
pub use measured::MeasuredFigure;
pub use motion::MotionFigure;
pub use participation::ParticipationFigure;
pub use response::{LineKind, Quantity, ResponseFigure, ResponseLine};
pub use spread::SpreadFigure;
pub use stiffness::StiffnessFigure;
pub(crate) use stroboscope::stroboscope;

use crate::ReportError;
use crate::output::replace_file;
use std::io::Write;
use std::path::Path;

/// A finished figure: a self-contained SVG document on white.
///
/// It has neither `id` attributes nor styles, so several of them may stand in one HTML page.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    svg: String,
}

impl Figure {
    pub(crate) fn new(svg: String) -> Self {
        Self { svg }
    }

    /// The document as text.
    pub fn as_svg(&self) -> &str {
        &self.svg
    }

    /// Writes the document; a file of that name is replaced at once, never half.
    ///
    /// # Errors
    /// [`ReportError::Io`] if the file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), ReportError> {
        replace_file(path.as_ref(), |file| file.write_all(self.svg.as_bytes()))
    }
}
