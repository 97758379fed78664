use resvg::tiny_skia::{Color, Pixmap, Transform};

use super::{PrintError, SVG_DOTS_PER_INCH, tree};

/// Maximum number of pixels of an image: of 190 × 130 mm at 2400 dots per inch.
pub const MAX_PIXELS: u32 = 1 << 28;

/// Dots of a metre over those of an inch.
const INCHES_IN_A_METRE: f64 = 1.0 / 0.0254;

/// A PNG image on white with the given dots per inch, recorded in the file.
///
/// # Errors
/// [`PrintError::Resolution`], [`PrintError::Size`], [`PrintError::Svg`] if the text is not an SVG document,
/// [`PrintError::Png`].
pub fn png(svg: &str, dots_per_inch: f64) -> Result<Vec<u8>, PrintError> {
    if !(dots_per_inch > 0.0 && dots_per_inch.is_finite()) {
        return Err(PrintError::Resolution { dots_per_inch });
    }
    let tree = tree::parsed(svg)?;
    let scale = dots_per_inch / f64::from(SVG_DOTS_PER_INCH);
    let (width, height) =
        ((f64::from(tree.size().width()) * scale).round(), (f64::from(tree.size().height()) * scale).round());
    let size = PrintError::Size { width, height, dots_per_inch };
    if width < 1.0 || height < 1.0 || width * height > f64::from(MAX_PIXELS) {
        return Err(size);
    }
    let Some(mut pixels) = Pixmap::new(width as u32, height as u32) else { return Err(size) };
    pixels.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale as f32, scale as f32), &mut pixels.as_mut());
    packed(&pixels, dots_per_inch).map_err(PrintError::Png)
}

/// On white every pixel is opaque, so there is no alpha channel.
fn packed(pixels: &Pixmap, dots_per_inch: f64) -> Result<Vec<u8>, png::EncodingError> {
    let colours: Vec<u8> =
        pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    let a_metre = (dots_per_inch * INCHES_IN_A_METRE).round() as u32;
    let mut packed = Vec::new();
    let mut info = png::Info::with_size(pixels.width(), pixels.height());
    info.color_type = png::ColorType::Rgb;
    info.bit_depth = png::BitDepth::Eight;
    info.pixel_dims = Some(png::PixelDimensions { xppu: a_metre, yppu: a_metre, unit: png::Unit::Meter });
    let mut writer = png::Encoder::with_info(&mut packed, info)?.write_header()?;
    writer.write_image_data(&colours)?;
    writer.finish()?;
    Ok(packed)
}
