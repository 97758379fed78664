//! Colours that colour-blind readers can distinguish: the set of Okabe and Ito, and viridis for surfaces.

/// Body text, frames, outlines.
pub(crate) const INK: &str = "#222222";
/// Grid at the labelled ticks.
pub(crate) const GRID: &str = "#dddddd";
/// Grid between the labelled ticks.
pub(crate) const FINE_GRID: &str = "#f0f0f0";
/// Contact begins.
pub(crate) const TOUCHING: &str = "#d62728";
/// Contact ends.
pub(crate) const LEAVING: &str = "#2ca02c";

pub(crate) const CURVES: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];

/// Stops, their walls and their quantities: the muted set of Tol, distinct from the colours of branches.
pub(crate) const STOPS: [&str; 7] = ["#332288", "#882255", "#117733", "#999933", "#aa4499", "#44aa99", "#661100"];

const VIRIDIS: [[f64; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 45.0, 123.0],
    [59.0, 82.0, 139.0],
    [44.0, 114.0, 142.0],
    [33.0, 145.0, 140.0],
    [40.0, 174.0, 128.0],
    [94.0, 201.0, 98.0],
    [173.0, 220.0, 48.0],
    [253.0, 231.0, 37.0],
];

/// Colour of the curve number `index`; the colours repeat after the seventh.
pub(crate) fn curve(index: usize) -> &'static str {
    CURVES[index % CURVES.len()]
}

/// Colour of the stop number `index`; the colours repeat after the seventh.
pub(crate) fn stop(index: usize) -> &'static str {
    STOPS[index % STOPS.len()]
}

/// Whether no stop with a lower number has the same colour.
pub(crate) fn is_first_round(index: usize) -> bool {
    index < STOPS.len()
}

/// Viridis from 0 (dark violet) to 1 (yellow).
pub(crate) fn viridis(share: f64) -> String {
    let last = VIRIDIS.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f64;
    let index = (place as usize).min(last - 1);
    let weight = place - index as f64;
    let channel = |c: usize| VIRIDIS[index][c] + weight * (VIRIDIS[index + 1][c] - VIRIDIS[index][c]);
    let digit = |value: u8| char::from_digit(u32::from(value), 16).unwrap_or('0');
    let mut text = String::from("#");
    for value in [0, 1, 2].map(|c| channel(c).round() as u8) {
        text.extend([digit(value / 16), digit(value % 16)]);
    }
    text
}
