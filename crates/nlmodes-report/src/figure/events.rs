//! Symbols of the events on a branch: open, distinct in shape as well as in colour.

use nlmodes_modal::Event;

use crate::chart::{Key, LegendEntry, Shape};

const KNOWN: [(Event, Shape, &str); 10] = [
    (Event::Grazing, Shape::Circle, "#222222"),
    (Event::LiftOff, Shape::Circle, "#222222"),
    (Event::Fold, Shape::Triangle, "#222222"),
    (Event::BranchPoint, Shape::Square, "#222222"),
    (Event::Kink, Shape::Diamond, "#aa3377"),
    (Event::FrequencyFold, Shape::Pentagon, "#222222"),
    (Event::ContactChange, Shape::TriangleDown, "#b87700"),
    (Event::StabilityChange, Shape::Star, "#222222"),
    (Event::TongueFoot, Shape::Cross, "#222222"),
    (Event::Resumed, Shape::Plus, "#222222"),
];
/// Events that are drawn above all others, the last one on top.
const TOPMOST: [Event; 4] = [Event::Grazing, Event::LiftOff, Event::Kink, Event::BranchPoint];
const FURTHER: [Shape; 3] = [Shape::Star, Shape::TriangleDown, Shape::Pentagon];
const FURTHER_COLORS: [&str; 2] = ["#777777", "#b87700"];

/// Events in the order in which they first occur, each with its symbol.
#[derive(Debug, Default)]
pub(crate) struct EventSymbols {
    found: Vec<(Event, Shape, &'static str)>,
    n_further: usize,
}

impl EventSymbols {
    /// The symbol of an event; one without its own symbol gets an unused one.
    pub fn of(&mut self, event: Event) -> (Shape, &'static str) {
        if let Some((_, shape, fill)) = self.found.iter().find(|(known, ..)| *known == event) {
            return (*shape, *fill);
        }
        let known = KNOWN.iter().find(|(known, ..)| *known == event).map(|(_, shape, fill)| (*shape, *fill));
        let (shape, fill) = known.unwrap_or_else(|| self.next_further());
        self.found.push((event, shape, fill));
        (shape, fill)
    }

    fn next_further(&mut self) -> (Shape, &'static str) {
        let index = self.n_further;
        self.n_further += 1;
        (FURTHER[index % FURTHER.len()], FURTHER_COLORS[index / FURTHER.len() % FURTHER_COLORS.len()])
    }

    /// Meaning of an event, as a sentence without full stop; empty for one without its own description.
    pub fn meaning(event: Event) -> &'static str {
        match event {
            Event::Grazing => "the motion just touches a stop; below it the mode is the linear one",
            Event::LiftOff => "a stop that presses at rest is just left; below it the mode is that of the closed stop",
            Event::Start => "the branch was begun here",
            Event::Fold => "the averaged energy of a mode, or what a response is drawn over, has a maximum or minimum",
            Event::FrequencyFold => {
                "the frequency has a maximum or minimum along the branch: it turns from stiffening to softening or back"
            }
            Event::BranchPoint => "another branch of periodic motions crosses here",
            Event::Kink => "the branch turns by an angle, because a contact begins to close or to stay closed",
            Event::ContactChange => "the number or order of the intervals in which stops are closed changes",
            Event::StabilityChange => "small disturbances grow on one side and die away on the other",
            Event::PeriodDoubling => "motions of twice the period begin here",
            Event::NeimarkSacker => "motions with a second frequency begin here",
            Event::OtherMode => "the branch has gone over to another mode",
            Event::Harmonics => "the point before once more, with another number of harmonics",
            Event::HarmonicsUnproven => {
                "another number of harmonics, of which it is not shown that the branch is the same"
            }
            Event::HarmonicsNoHelp => "more harmonics were tried here and did not lead on",
            Event::AccuracyLimit => "from here on the accuracy that was asked for is not reached",
            Event::TongueFoot => "an internal-resonance branch begins here and is left out",
            Event::Resumed => "the branch goes on here behind an internal-resonance branch that was left out",
            _ => "",
        }
    }

    /// Drawing order of an event: rarer and more informative ones above others.
    pub fn layer(event: Event) -> usize {
        TOPMOST.iter().position(|top| *top == event).map_or(0, |place| place + 1)
    }

    /// Shape and colour of each event that occurred.
    pub fn all(&self) -> impl Iterator<Item = (Event, Shape, &'static str)> {
        self.found.iter().copied()
    }

    /// An entry for each event that occurred.
    pub fn legend(&self) -> impl Iterator<Item = LegendEntry> {
        self.all().map(|(event, shape, fill)| LegendEntry {
            key: Key::Open(shape, fill),
            name: event.name().replace('-', " "),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_seven_kinds_of_events_differ_in_shape() {
        let mut symbols = EventSymbols::default();
        let names = [
            Event::Fold,
            Event::Start,
            Event::Grazing,
            Event::Resumed,
            Event::Kink,
            Event::OtherMode,
            Event::BranchPoint,
        ];
        let shapes: Vec<Shape> = names.iter().map(|event| symbols.of(*event).0).collect();
        assert!(shapes.iter().enumerate().all(|(i, shape)| !shapes[..i].contains(shape)), "{shapes:?}");
        assert_eq!(symbols.of(Event::Start), symbols.of(Event::Start));
        assert_eq!(symbols.legend().count(), names.len());
    }
}
