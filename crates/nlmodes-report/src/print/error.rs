use thiserror::Error;

/// Why a figure could not be converted.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PrintError {
    /// The text is not an SVG document.
    #[error("no SVG document")]
    Svg(#[source] resvg::usvg::Error),
    /// PDF cannot represent the contents.
    #[error("cannot be written in PDF: {reason}")]
    Pdf {
        /// The contents.
        reason: String,
    },
    /// The resolution is not a positive number.
    #[error("{dots_per_inch} dots an inch; expected a number greater than 0")]
    Resolution {
        /// The requested number.
        dots_per_inch: f64,
    },
    /// The image would be larger than [`MAX_PIXELS`](super::MAX_PIXELS), or smaller than one pixel.
    #[error(
        "an image of {width:.0} × {height:.0} pixels at {dots_per_inch} dots an inch; expected one to {} pixels in all",
        super::MAX_PIXELS
    )]
    Size {
        /// Its width in pixels.
        width: f64,
        /// Its height in pixels.
        height: f64,
        /// The requested resolution.
        dots_per_inch: f64,
    },
    /// The image could not be compressed.
    #[error("cannot be packed as PNG")]
    Png(#[source] png::EncodingError),
}
