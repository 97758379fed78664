//! Colours of overlaid histories and of their walls, identical in figures and on the page.

use crate::palette;

/// Distinguishing features of the histories in one figure.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct HistoryLook {
    /// Number of the stop of each history; stop 0 if unknown.
    stops: Vec<usize>,
}

impl HistoryLook {
    /// Histories at the stops with these numbers.
    pub fn at(stops: &[usize]) -> Self {
        Self { stops: stops.to_vec() }
    }

    fn stop(&self, index: usize) -> usize {
        self.stops.get(index).copied().unwrap_or(0)
    }

    /// Colour of the curve number `index` of this many: black if it is the only one, that of its stop if the stops
    /// differ, otherwise that of its branch.
    pub fn curve(&self, index: usize, count: usize) -> &'static str {
        let one_stop = (0..count).all(|other| self.stop(other) == self.stop(0));
        match (count, one_stop) {
            (1, _) => palette::INK,
            (_, true) => palette::curve(index),
            (_, false) => palette::stop(self.stop(index)),
        }
    }

    /// Whether the curve number `index` of this many is dashed, because a stop with a lower number has its colour.
    pub fn is_dashed(&self, index: usize, count: usize) -> bool {
        count > 1 && self.curve(index, count) == self.wall(index) && !palette::is_first_round(self.stop(index))
    }

    /// Colour of the wall of the history number `index`.
    pub fn wall(&self, index: usize) -> &'static str {
        palette::stop(self.stop(index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_has_one_colour_and_branches_keep_theirs() {
        let stops = HistoryLook::at(&[1, 4]);
        assert_eq!([stops.curve(0, 2), stops.curve(1, 2)], [palette::stop(1), palette::stop(4)]);
        assert_eq!([stops.wall(0), stops.wall(1)], [palette::stop(1), palette::stop(4)]);
        let branches = HistoryLook::at(&[3, 3]);
        assert_eq!([branches.curve(0, 2), branches.curve(1, 2)], [palette::curve(0), palette::curve(1)]);
        assert_eq!(branches.wall(1), palette::stop(3));
        assert_eq!(HistoryLook::default().curve(0, 1), palette::INK);
        // Stop colours differ from those of branches and of contact marks.
        for stop in palette::STOPS {
            assert!(!palette::CURVES.contains(&stop) && ![palette::TOUCHING, palette::LEAVING].contains(&stop));
        }
    }
}
