//! Figures in SVG as PDF, for journals, and as PNG, for slides: with the width of the figure, and identical on every
//! machine.
//!
//! | from | to | item |
//! | --- | --- | --- |
//! | an SVG document, a pixel of which is 1/96 inch | PDF of that size, vector graphics with embedded font | [`pdf`] |
//! | | PNG with the given dots per inch, on white | [`png`](png()) |
//!
//! Letters, Latin and Greek, come from a font of this crate (Arimo, as wide as Helvetica and Arial, under the SIL Open
//! Font License); system fonts are used only for other characters.
//!
//! ```
//! let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 720 480">
//!   <text x="360" y="240" font-family="sans-serif" font-size="20">ω in rad/s</text></svg>"#;
//! assert!(nlmodes_report::print::pdf(svg)?.starts_with(b"%PDF"));
//! let image = nlmodes_report::print::png(svg, 300.0)?;
//! // 90 mm at 300 dots per inch are 1063 pixels.
//! assert_eq!(image[16..20], 1063_u32.to_be_bytes());
//! # Ok::<(), nlmodes_report::print::PrintError>(())
//! ```

mod error;
mod image;
mod tree;

pub use error::PrintError;
pub use image::{MAX_PIXELS, png};

/// Dots per inch of an SVG document.
pub(crate) const SVG_DOTS_PER_INCH: f32 = 96.0;

/// A PDF document of one page, as large as the figure.
///
/// # Errors
/// [`PrintError::Svg`] if the text is not an SVG document, [`PrintError::Pdf`] if it has contents that PDF cannot
/// represent.
pub fn pdf(svg: &str) -> Result<Vec<u8>, PrintError> {
    let page = svg2pdf::PageOptions { dpi: SVG_DOTS_PER_INCH };
    svg2pdf::to_pdf(&tree::parsed(svg)?, svg2pdf::ConversionOptions::default(), page)
        .map_err(|error| PrintError::Pdf { reason: error.to_string() })
}
