//! Symbols of the events on a branch: open, distinct in shape as well as in colour.

use crate::chart::{Key, LegendEntry, Shape};

const KNOWN: [(&str, Shape, &str); 7] = [
    ("grazing", Shape::Circle, "#222222"),
    ("fold", Shape::Triangle, "#222222"),
    ("branch-point", Shape::Square, "#0072b2"),
    ("kink", Shape::Diamond, "#aa3377"),
    ("frequency-fold", Shape::Pentagon, "#222222"),
    ("contact-change", Shape::TriangleDown, "#b87700"),
    ("stability-change", Shape::Star, "#d55e00"),
];
/// Events that are drawn above all others, the last one on top.
const TOPMOST: [&str; 3] = ["grazing", "kink", "branch-point"];
const FURTHER: [Shape; 3] = [Shape::Star, Shape::TriangleDown, Shape::Pentagon];
const FURTHER_COLORS: [&str; 2] = ["#009e73", "#777777"];

/// Events in the order in which they first occur, each with its symbol.
#[derive(Debug, Default)]
pub(crate) struct EventSymbols {
    names: Vec<(String, Shape, &'static str)>,
    n_further: usize,
}

impl EventSymbols {
    /// The symbol of an event; a name that is not known gets one that is still free.
    pub fn of(&mut self, event: &str) -> (Shape, &'static str) {
        if let Some((_, shape, fill)) = self.names.iter().find(|(name, ..)| name == event) {
            return (*shape, *fill);
        }
        let known = KNOWN.iter().find(|(name, ..)| *name == event).map(|(_, shape, fill)| (*shape, *fill));
        let (shape, fill) = known.unwrap_or_else(|| self.next_further());
        self.names.push((event.into(), shape, fill));
        (shape, fill)
    }

    fn next_further(&mut self) -> (Shape, &'static str) {
        let index = self.n_further;
        self.n_further += 1;
        (FURTHER[index % FURTHER.len()], FURTHER_COLORS[index / FURTHER.len() % FURTHER_COLORS.len()])
    }

    /// Where an event is drawn: what is rarer and says more lies above what may hide it.
    pub fn layer(event: &str) -> usize {
        TOPMOST.iter().position(|name| *name == event).map_or(0, |place| place + 1)
    }

    /// Name, shape and colour of each event that occurred.
    pub fn all(&self) -> impl Iterator<Item = (&str, Shape, &'static str)> {
        self.names.iter().map(|(name, shape, fill)| (name.as_str(), *shape, *fill))
    }

    /// An entry for each event that occurred.
    pub fn legend(&self) -> impl Iterator<Item = LegendEntry> {
        self.names
            .iter()
            .map(|(name, shape, fill)| LegendEntry { key: Key::Open(*shape, fill), name: name.replace('-', " ") })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_seven_kinds_of_events_differ_in_shape() {
        let mut symbols = EventSymbols::default();
        let names = ["fold", "a", "grazing", "b", "kink", "c", "branch-point"];
        let shapes: Vec<Shape> = names.iter().map(|name| symbols.of(name).0).collect();
        assert!(shapes.iter().enumerate().all(|(i, shape)| !shapes[..i].contains(shape)), "{shapes:?}");
        assert_eq!(symbols.of("a"), symbols.of("a"));
        assert_eq!(symbols.legend().count(), names.len());
    }
}
