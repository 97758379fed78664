//! A surface over position and time in a box, seen from the front, the right and above.

mod draw;
mod view;

/// Contents of the figure; the numbers are in the units of the labels.
#[derive(Debug)]
pub(crate) struct Surface {
    pub title: String,
    /// Along the structure.
    pub x: SurfaceAxis,
    /// Over time.
    pub y: SurfaceAxis,
    pub z_label: String,
    /// Heights: one row for each of `x`, one column for each of `y`.
    pub z: Vec<Vec<f64>>,
    /// The stops.
    pub stops: Vec<Line>,
    /// Rows of `z` that are drawn bold: the motions of the contacts.
    pub contacts: Vec<usize>,
}

/// Ascending values of an axis and its label with the unit.
#[derive(Debug)]
pub(crate) struct SurfaceAxis {
    pub label: String,
    pub values: Vec<f64>,
}

/// A line along time at this position and height.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// Number of the stop.
    pub number: usize,
    pub x: f64,
    pub z: f64,
}
