/// Pixels of a figure without a width.
const PIXELS: f64 = 720.0;
/// Letters of 13 pixels print at 8 points, 2.82 mm.
const PIXELS_PER_MM: f64 = 13.0 / 2.822;

/// Style of a figure, independent of its contents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureStyle {
    /// Width in print, mm, with letters of 8 points: 90 for a column, 190 for two; without it 720 pixels.
    pub width_mm: Option<f64>,
    /// Whether the figure has a title; a caption may replace it.
    pub has_title: bool,
}

impl Default for FigureStyle {
    fn default() -> Self {
        Self { width_mm: None, has_title: true }
    }
}

impl FigureStyle {
    /// Least width in print, mm: a narrower figure has no space for its numbers.
    pub const LEAST_MM: f64 = 60.0;
    /// Largest width in print, mm.
    pub const MOST_MM: f64 = 400.0;

    /// Width of the drawing, pixels.
    pub(crate) fn pixels(&self) -> f64 {
        self.width_mm.map_or(PIXELS, |mm| (PIXELS_PER_MM * mm.clamp(Self::LEAST_MM, Self::MOST_MM)).round())
    }

    /// Height of a panel over that in a drawing of the usual width: narrow figures are flatter, but less so than they
    /// are narrow.
    pub(crate) fn height_share(&self) -> f64 {
        (self.pixels() / PIXELS).sqrt().clamp(0.6, 1.3)
    }
}
