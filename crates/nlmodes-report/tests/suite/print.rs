//! Output files, read again: sizes, colours, letters.

use std::error::Error;

use nlmodes_report::print::{PrintError, pdf, png};

type Outcome = Result<(), Box<dyn Error>>;

/// 90 × 60 mm, the right half red.
fn halves(inside: &str) -> String {
    format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 720 480"
        font-family="Helvetica, sans-serif">
<rect x="360" y="0" width="360" height="480" fill="red"/>{inside}</svg>"#
    )
}

struct Image {
    width: usize,
    height: usize,
    colours: Vec<u8>,
    dots_per_metre: Option<u32>,
}

impl Image {
    fn of(packed: &[u8]) -> Result<Self, Box<dyn Error>> {
        let mut reader = png::Decoder::new(packed).read_info()?;
        let mut colours = vec![0; reader.output_buffer_size()];
        reader.next_frame(&mut colours)?;
        let info = reader.info();
        let dots_per_metre = info.pixel_dims.map(|dims| dims.xppu);
        Ok(Self { width: info.width as usize, height: info.height as usize, colours, dots_per_metre })
    }

    fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let from = 3 * (y * self.width + x);
        [self.colours[from], self.colours[from + 1], self.colours[from + 2]]
    }
}

#[test]
fn an_image_has_the_size_resolution_and_colours_of_the_figure() -> Outcome {
    for (dots, width, height, a_metre) in [(300.0, 1063, 709, 11811), (96.0, 340, 227, 3780)] {
        let image = Image::of(&png(&halves(""), dots)?)?;
        assert_eq!((image.width, image.height, image.dots_per_metre), (width, height, Some(a_metre)));
        assert_eq!(image.at(width / 4, height / 2), [255, 255, 255]);
        assert_eq!(image.at(3 * width / 4, height / 2), [255, 0, 0]);
    }
    Ok(())
}

#[test]
fn a_page_is_as_large_as_the_figure_and_has_its_font() -> Outcome {
    let page = pdf(&halves(r#"<text x="10" y="40" font-size="20">ω₁ in rad/s</text>"#))?;
    let text = String::from_utf8_lossy(&page);
    let (_, rest) = text.split_once("/MediaBox").ok_or("no size")?;
    let numbers: Vec<f64> = rest
        .split([']', '['])
        .nth(1)
        .ok_or("no numbers")?
        .split_whitespace()
        .map(str::parse)
        .collect::<Result<_, _>>()?;
    // 72 points an inch.
    let points = |mm: f64| mm / 25.4 * 72.0;
    assert!((numbers[2] - points(90.0)).abs() < 0.01 && (numbers[3] - points(60.0)).abs() < 0.01, "{numbers:?}");
    assert!(text.contains("Arimo") && text.contains("/FontFile"), "the font is embedded");
    Ok(())
}

#[test]
fn the_signs_of_our_figures_are_in_the_font() -> Outcome {
    let ink = |text: &str| -> Result<Vec<u8>, Box<dyn Error>> {
        let text = format!(r#"<text x="20" y="300" font-size="200">{text}</text>"#);
        Ok(Image::of(&png(&halves(&text), 40.0)?)?.colours)
    };
    let nothing = ink("")?;
    let mut seen = Vec::new();
    for sign in "×√–−·°…±µäλωξηαβσζΔ²³¹⁰⁴⁵⁶⁷⁸⁹⁻₁₂≤≥".chars() {
        let drawn = ink(&sign.to_string())?;
        assert_ne!(drawn, nothing, "{sign}");
        // A sign that is missing would look like any other that is.
        assert!(!seen.contains(&drawn), "{sign} looks like another");
        seen.push(drawn);
    }
    Ok(())
}

#[test]
fn what_cannot_be_is_refused() {
    assert!(matches!(pdf("no picture"), Err(PrintError::Svg(_))));
    assert!(matches!(png("<svg", 300.0), Err(PrintError::Svg(_))));
    for dots in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(png(&halves(""), dots), Err(PrintError::Resolution { .. })), "{dots}");
    }
    for dots in [1e-3, 1e6, 1e300] {
        let refused = png(&halves(""), dots);
        assert!(matches!(refused, Err(PrintError::Size { .. })), "{dots}");
    }
}
