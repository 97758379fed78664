use super::Figure;
use crate::ReportError;
use crate::style::FigureStyle;
use crate::svg::{Anchor, Stroke, Svg};

/// What several parameters do to one quantity: a bar each, the longest one above, to the right where the quantity grows
/// with the parameter and to the left where it falls.
#[derive(Debug, Clone, PartialEq)]
pub struct TornadoFigure {
    title: String,
    axis: String,
    bars: Vec<(String, f64)>,
}

/// Lengths in pixels: of a bar with the space below it, above and below all bars, and of letters.
const BAR: f64 = 26.0;
const GAP: f64 = 8.0;
const TOP: f64 = 52.0;
const BOTTOM: f64 = 46.0;
const LETTERS: f64 = 13.0;
/// Width of a letter, and of the numbers beside bars.
const LETTER: f64 = 7.2;
const NUMBER: f64 = 66.0;
/// Largest share of the width that names take.
const NAMES: f64 = 0.5;

impl TornadoFigure {
    /// Of these parameters, each with its effect in the unit of the axis; what is not finite is left out.
    pub fn new(axis: impl Into<String>, bars: impl IntoIterator<Item = (String, f64)>) -> Self {
        let mut bars: Vec<(String, f64)> = bars.into_iter().filter(|(_, effect)| effect.is_finite()).collect();
        bars.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        Self { title: String::new(), axis: axis.into(), bars }
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::NothingToDraw`] without a bar.
    pub fn render(self) -> Result<Figure, ReportError> {
        if self.bars.is_empty() {
            let reason = "no parameter has a finite effect";
            return Err(ReportError::NothingToDraw { figure: "tornado", reason });
        }
        Ok(Figure::from(self))
    }

    pub(super) fn draw(&self, style: &FigureStyle) -> String {
        let width = style.pixels();
        let height = TOP + BOTTOM + BAR * self.bars.len() as f64;
        let longest = self.bars.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0) as f64;
        let names = (LETTER * longest + 20.0).min(NAMES * width);
        let (left, right) = (names + NUMBER, width - NUMBER);
        let most = self.bars.iter().map(|(_, effect)| effect.abs()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let middle = 0.5 * (left + right);
        let x = |effect: f64| middle + 0.5 * (right - left) * effect / most;
        let mut svg = Svg::new(width, height);
        if style.has_title && !self.title.is_empty() {
            svg.text((0.5 * width, 26.0), Anchor::Middle, 1.2 * LETTERS, &self.title);
        }
        let thin = Stroke::solid("#000000", 1.0);
        for (k, (name, effect)) in self.bars.iter().enumerate() {
            let y = TOP + BAR * k as f64;
            let (fill, end) = if *effect < 0.0 { ("#d55e00", x(*effect)) } else { ("#0072b2", x(*effect)) };
            svg.rectangle((middle.min(end), y), ((end - middle).abs(), BAR - GAP), fill, &Stroke::solid(fill, 0.5));
            let base = y + 0.5 * (BAR - GAP) + 0.35 * LETTERS;
            svg.text((names, base), Anchor::End, LETTERS, name);
            let (at, anchor) = if *effect < 0.0 { (end - 6.0, Anchor::End) } else { (end + 6.0, Anchor::Start) };
            svg.text((at, base), anchor, LETTERS, &three_digits(*effect));
        }
        svg.line((middle, TOP - 6.0), (middle, height - BOTTOM), &thin);
        svg.text((middle, height - 16.0), Anchor::Middle, LETTERS, &self.axis);
        svg.finish(style.width_mm)
    }
}

/// A number with three digits.
fn three_digits(value: f64) -> String {
    let size = value.abs();
    match size {
        0.0 => "0".to_owned(),
        _ if !(1e-3..1e4).contains(&size) => format!("{value:.2e}"),
        _ => {
            let decimals = (2 - size.log10().floor() as i32).clamp(0, 6) as usize;
            format!("{value:.decimals$}")
        }
    }
    .replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_bar_stands_above_and_its_side_is_that_of_its_sign() {
        let bars = [("gap".to_owned(), -0.31), ("modulus".to_owned(), 0.5), ("nothing".to_owned(), f64::NAN)];
        let svg = TornadoFigure::new("% for 1 %", bars).title("effects").render().unwrap().as_svg().to_owned();
        let order = ["modulus", "gap"].map(|name| svg.find(name).unwrap());
        assert!(order[0] < order[1] && !svg.contains("nothing"));
        assert!(svg.contains("0.500") && svg.contains("\u{2212}0.310"));
        assert!(TornadoFigure::new("", []).render().is_err());
    }
}
