//! Scalable vector graphics as text: the only place that knows the format.

use std::fmt::Write;

const FONTS: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// Line style.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    pub color: &'static str,
    pub width: f64,
    pub dash: Option<&'static str>,
}

impl Stroke {
    pub const fn solid(color: &'static str, width: f64) -> Self {
        Self { color, width, dash: None }
    }

    pub const fn dashed(color: &'static str, width: f64) -> Self {
        Self { color, width, dash: Some("6 4") }
    }

    /// Short dashes that look like dots, for unstable motions.
    pub const fn short_dashed(color: &'static str, width: f64) -> Self {
        Self { color, width, dash: Some("3 3") }
    }

    fn attributes(&self) -> String {
        let mut text = format!(r#"stroke="{}" stroke-width=""#, self.color);
        push_px(&mut text, self.width);
        text.push('"');
        self.dash.into_iter().for_each(|dash| text.extend([r#" stroke-dasharray=""#, dash, "\""]));
        text
    }
}

/// Text anchor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A picture being drawn; lengths in pixels from its upper left corner.
#[derive(Debug)]
pub(crate) struct Svg {
    width: f64,
    height: f64,
    body: String,
}

impl Svg {
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, body: String::new() }
    }

    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: &Stroke) {
        let (x1, y1, x2, y2) = (px(from.0), px(from.1), px(to.0), px(to.1));
        self.push(&format!(r#"<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" {}/>"#, stroke.attributes()));
    }

    pub fn polyline(&mut self, class: &str, points: &[(f64, f64)], stroke: &Stroke) {
        let (class, points, stroke) = (escape(class), joined(points), stroke.attributes());
        let join = r#"fill="none" stroke-linejoin="round" stroke-linecap="butt""#;
        self.push(&format!(r#"<polyline class="{class}" points="{points}" {join} {stroke}/>"#));
    }

    /// Cubic pieces from point to point, each with its two inner control points.
    pub fn path(&mut self, class: &str, points: &[(f64, f64)], controls: &[[(f64, f64); 2]], stroke: &Stroke) {
        let (class, stroke) = (escape(class), stroke.attributes());
        let Some(first) = points.first() else { return };
        let mut course = format!("M{}", joined(&[*first]));
        for ([a, b], end) in controls.iter().zip(&points[1..]) {
            course.push('C');
            course.push_str(&joined(&[*a, *b, *end]));
        }
        let join = r#"fill="none" stroke-linejoin="round" stroke-linecap="butt""#;
        self.push(&format!(r#"<path class="{class}" d="{course}" {join} {stroke}/>"#));
    }

    /// Subsequent items are clipped to this rectangle (left, top, width, height), with coordinates relative to its
    /// corner, until [`Svg::end_part`].
    pub fn begin_part(&mut self, (left, top, width, height): (f64, f64, f64, f64)) {
        let (x, y, w, h) = (px(left), px(top), px(width), px(height));
        self.push(&format!(r#"<svg x="{x}" y="{y}" width="{w}" height="{h}">"#));
    }

    /// Ends the part begun by [`Svg::begin_part`].
    pub fn end_part(&mut self) {
        self.push("</svg>");
    }

    pub fn polygon(&mut self, class: &str, points: &[(f64, f64)], fill: &str, stroke: &Stroke) {
        // Surfaces have tens of thousands of them, for which general formatting is slow.
        self.body.extend([r#"<polygon class=""#, &escape(class), r#"" points=""#]);
        push_points(&mut self.body, points);
        self.body.extend([r#"" fill=""#, fill, r#"" "#, &stroke.attributes(), "/>\n"]);
    }

    pub fn circle(&mut self, class: &str, center: (f64, f64), radius: f64, fill: &str, stroke: &Stroke) {
        let (class, x, y, stroke) = (escape(class), px(center.0), px(center.1), stroke.attributes());
        self.push(&format!(r#"<circle class="{class}" cx="{x}" cy="{y}" r="{}" fill="{fill}" {stroke}/>"#, px(radius)));
    }

    pub fn rectangle(&mut self, corner: (f64, f64), size: (f64, f64), fill: &str, stroke: &Stroke) {
        let (x, y, w, h) = (px(corner.0), px(corner.1), px(size.0), px(size.1));
        let stroke = stroke.attributes();
        self.push(&format!(r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" fill="{fill}" {stroke}/>"#));
    }

    /// Text with its baseline at `at`, in the size of `size` pixels.
    pub fn text(&mut self, at: (f64, f64), anchor: Anchor, size: f64, text: &str) {
        self.push_text(&format!(r#"x="{}" y="{}""#, px(at.0), px(at.1)), anchor, size, text);
    }

    /// As [`Svg::text`], with a white rim that keeps it readable across lines.
    pub fn haloed_text(&mut self, at: (f64, f64), anchor: Anchor, size: f64, text: &str) {
        let halo = r#"stroke="white" stroke-width="3" stroke-linejoin="round" paint-order="stroke""#;
        self.push_text(&format!(r#"x="{}" y="{}" {halo}"#, px(at.0), px(at.1)), anchor, size, text);
    }

    /// Text that reads upwards, centred at `at`.
    pub fn vertical_text(&mut self, at: (f64, f64), size: f64, text: &str) {
        let place = format!(r#"transform="translate({} {}) rotate(-90)""#, px(at.0), px(at.1));
        self.push_text(&place, Anchor::Middle, size, text);
    }

    fn push_text(&mut self, place: &str, anchor: Anchor, size: f64, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = escape(text);
        self.push(&format!(r#"<text {place} text-anchor="{anchor}" font-size="{size}">{text}</text>"#));
    }

    fn push(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }

    /// The whole document, with the print width if given.
    pub fn finish(self, width_mm: Option<f64>) -> String {
        let (width, height, body) = (px(self.width), px(self.height), self.body);
        let shown = match width_mm {
            Some(mm) => format!(r#"width="{}mm" height="{}mm""#, px(mm), px(mm * self.height / self.width)),
            None => format!(r#"width="{width}" height="{height}""#),
        };
        let size = format!(r#"{shown} viewBox="0 0 {width} {height}""#);
        let open = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="{FONTS}" fill="black">"#);
        let background = format!(r#"<rect width="{width}" height="{height}" fill="white"/>"#);
        format!("{open}\n{background}\n{body}</svg>\n")
    }
}

/// Width of a text in pixels, a conservative estimate since the font depends on the viewer.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}

/// Size, at most `size`, in which a text does not exceed `width`.
pub(crate) fn fitting_size(text: &str, size: f64, width: f64) -> f64 {
    let share = width / text_width(text, size).max(width);
    (10.0 * size * share).floor() / 10.0
}

fn joined(points: &[(f64, f64)]) -> String {
    let mut text = String::with_capacity(14 * points.len());
    push_points(&mut text, points);
    text
}

fn push_points(text: &mut String, points: &[(f64, f64)]) {
    for (i, (x, y)) in points.iter().enumerate() {
        if i > 0 {
            text.push(' ');
        }
        push_px(text, *x);
        text.push(',');
        push_px(text, *y);
    }
}

/// A length to a hundredth of a pixel, without needless zeros.
fn px(value: f64) -> String {
    let mut text = String::with_capacity(8);
    push_px(&mut text, value);
    text
}

/// Appends it, digit by digit.
fn push_px(text: &mut String, value: f64) {
    let hundredths = (100.0 * value).round();
    if !hundredths.is_finite() || hundredths.abs() >= 1e12 {
        // Writing to a string cannot fail.
        let _ = write!(text, "{value:.2}");
        return;
    }
    let whole = hundredths.abs() as u64;
    let mut digits = [0u8; 24];
    let mut at = digits.len();
    let mut put = |digit: u8| {
        at -= 1;
        digits[at] = digit;
    };
    let (tenth, hundredth) = ((whole / 10 % 10) as u8, (whole % 10) as u8);
    if hundredth != 0 {
        put(b'0' + hundredth);
    }
    if tenth != 0 || hundredth != 0 {
        put(b'0' + tenth);
        put(b'.');
    }
    let mut rest = whole / 100;
    loop {
        put(b'0' + (rest % 10) as u8);
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    if hundredths < 0.0 {
        put(b'-');
    }
    // Digits are text.
    text.push_str(str::from_utf8(&digits[at..]).unwrap_or_default());
}

/// Text for elements and attributes; control characters, which XML does not allow, become spaces.
pub fn escape(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut safe, character| {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => safe.push(' '),
            control if control.is_control() => safe.push(' '),
            other => safe.push(other),
        }
        safe
    })
}
