//! Figures.

mod branch;
mod contacts;
mod convergence;
mod events;
mod history;
mod history_look;
mod measured;
mod motion;
mod participation;
mod response;
mod spread;
mod stiffness;
mod stroboscope;
mod tornado;

pub(crate) use branch::marked;
pub use branch::{Abscissa, BranchFigure};
pub use contacts::ContactFigure;
pub use convergence::ConvergenceFigure;
pub(crate) use events::EventSymbols;
pub use history::HistoryFigure;
pub(crate) use history_look::HistoryLook;
pub use measured::MeasuredFigure;
pub use motion::MotionFigure;
pub(crate) use participation::strongest;
pub use participation::{ParticipationFigure, SHOWN_MODES};
pub use response::{LineKind, Quantity, ResponseFigure, ResponseLine};
pub use spread::SpreadFigure;
pub use stiffness::StiffnessFigure;
pub(crate) use stroboscope::stroboscope;
pub use tornado::TornadoFigure;

use crate::ReportError;
use crate::chart::Chart;
use crate::output::replace_file;
use crate::style::FigureStyle;
use crate::surface::Surface;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// A finished figure: a self-contained SVG document on white.
///
/// It has neither `id` attributes nor styles, so several of them may be in one HTML page.
#[derive(Debug, Clone)]
pub struct Figure {
    drawing: Arc<Drawing>,
    svg: String,
}

/// Figures are equal if they look equal.
impl PartialEq for Figure {
    fn eq(&self, other: &Self) -> bool {
        self.svg == other.svg
    }
}

/// Contents of a figure.
#[derive(Debug)]
enum Drawing {
    Chart(Chart),
    Surface(Surface),
    Tornado(TornadoFigure),
}

impl Drawing {
    fn draw(&self, style: &FigureStyle) -> String {
        match self {
            Self::Chart(chart) => chart.draw(style),
            Self::Surface(surface) => surface.draw(style),
            Self::Tornado(bars) => bars.draw(style),
        }
    }
}

impl From<Chart> for Figure {
    fn from(chart: Chart) -> Self {
        Self::new(Drawing::Chart(chart))
    }
}

impl From<TornadoFigure> for Figure {
    fn from(bars: TornadoFigure) -> Self {
        Self::new(Drawing::Tornado(bars))
    }
}

impl From<Surface> for Figure {
    fn from(surface: Surface) -> Self {
        Self::new(Drawing::Surface(surface))
    }
}

impl Figure {
    fn new(drawing: Drawing) -> Self {
        let svg = drawing.draw(&FigureStyle::default());
        Self { drawing: Arc::new(drawing), svg }
    }

    /// The same figure in another style.
    pub fn styled(&self, style: &FigureStyle) -> Self {
        if *style == FigureStyle::default() {
            return self.clone();
        }
        Self { drawing: Arc::clone(&self.drawing), svg: self.drawing.draw(style) }
    }

    /// The document as text.
    pub fn as_svg(&self) -> &str {
        &self.svg
    }

    /// Writes the document; an existing file is replaced atomically.
    ///
    /// # Errors
    /// [`ReportError::Io`] if the file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), ReportError> {
        replace_file(path.as_ref(), |file| file.write_all(self.svg.as_bytes()))
    }
}
