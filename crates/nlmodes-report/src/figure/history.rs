use super::Figure;
use super::history_look::HistoryLook;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, Key, LegendEntry, Panel, Scale, Shape, Symbol};
use crate::palette;
use crate::svg::Stroke;
use crate::unit::Unit;
use nlmodes_modal::{ContactInstant, TimeHistory};

const TOUCHING: (Shape, &str) = (Shape::Circle, palette::TOUCHING);
const LEAVING: (Shape, &str) = (Shape::Square, palette::LEAVING);
const INSTANT: Stroke = Stroke { color: "#999999", width: 0.8, dash: Some("2 3") };

/// Displacement, velocity and contact force over time, as in Fig. 9: one panel each, several histories in each.
///
/// Histories at several stops have the colours of these stops, those of several branches at one stop the colours of the
/// branches; the stops themselves are lines of their colours. The beginning of contact is marked red, its end green,
/// with different symbols; with several histories, in the colour of the curve.
#[derive(Debug, Clone)]
pub struct HistoryFigure<'a> {
    histories: &'a [&'a TimeHistory],
    look: HistoryLook,
    title: String,
    has_acceleration: bool,
}

/// One quantity of a history and its axis.
struct Quantity {
    name: &'static str,
    unit: fn(f64) -> Unit,
    values: fn(&TimeHistory) -> &[f64],
}

const DISPLACEMENT: Quantity =
    Quantity { name: "displacement", unit: |largest| Unit::fine("m", largest), values: |h| &h.displacement };
const VELOCITY: Quantity =
    Quantity { name: "velocity", unit: |largest| Unit::fine("m/s", largest), values: |h| &h.velocity };
const ACCELERATION: Quantity =
    Quantity { name: "acceleration", unit: |largest| Unit::plain("m/s²", largest), values: |h| &h.acceleration };
const FORCE: Quantity =
    Quantity { name: "contact force", unit: |largest| Unit::coarse("N", largest), values: |h| &h.force };

impl<'a> HistoryFigure<'a> {
    /// A figure of these histories, named in the legend by their labels.
    pub fn new(histories: &'a [&'a TimeHistory]) -> Self {
        Self { histories, look: HistoryLook::default(), title: String::new(), has_acceleration: false }
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// At the stops with these numbers, one for each history; otherwise all are at stop 0.
    pub fn at_stops(mut self, stops: &[usize]) -> Self {
        self.look = HistoryLook::at(stops);
        self
    }

    /// In these colours.
    pub(crate) fn look(mut self, look: &HistoryLook) -> Self {
        self.look = look.clone();
        self
    }

    /// With a fourth panel.
    pub fn with_acceleration(mut self) -> Self {
        self.has_acceleration = true;
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::SeriesLength`] if a series does not match its time, [`ReportError::NothingToDraw`] if there is no
    /// finite time or a panel has no finite value.
    pub fn render(&self) -> Result<Figure, ReportError> {
        let quantities = self.quantities();
        for history in self.histories {
            check_lengths(history, &quantities)?;
        }
        let unit = Unit::fine("s", largest(self.histories.iter().flat_map(|history| &history.time)));
        let times = self.histories.iter().flat_map(|history| &history.time).map(|time| time * unit.per_si);
        let scale = Scale::linear(times, 0.0).ok_or_else(|| nothing("there is no finite time"))?;
        let panels = quantities.iter().map(|quantity| self.panel(quantity, unit.per_si));
        let panels = panels.collect::<Result<Vec<_>, _>>()?;
        let x = Axis { label: format!("time in {}", unit.symbol), scale };
        Ok(Figure::from(Chart::new(self.title.clone(), x, panels, 150.0, self.legend())))
    }

    fn quantities(&self) -> Vec<Quantity> {
        let acceleration = self.has_acceleration.then_some(ACCELERATION);
        [DISPLACEMENT, VELOCITY].into_iter().chain(acceleration).chain([FORCE]).collect()
    }

    fn panel(&self, quantity: &Quantity, per_second: f64) -> Result<Panel, ReportError> {
        let has_stop = quantity.name == DISPLACEMENT.name;
        let stops = self.histories.iter().filter(|_| has_stop).map(|history| &history.stop);
        let values = || self.histories.iter().flat_map(|history| (quantity.values)(history)).chain(stops.clone());
        let unit = (quantity.unit)(largest(values()));
        let scale = Scale::linear(values().map(|value| value * unit.per_si), 0.08);
        let scale = scale.ok_or_else(|| nothing("a panel has no finite value"))?;
        let mut walls: Vec<(f64, &'static str)> = Vec::new();
        for (index, stop) in stops.clone().enumerate().filter(|(_, stop)| stop.is_finite()) {
            let wall = (*stop, self.look.wall(index));
            if !walls.contains(&wall) {
                walls.push(wall);
            }
        }
        let lines: Vec<Curve> =
            walls.into_iter().map(|(stop, color)| self.stop_line(stop * unit.per_si, per_second, color)).collect();
        let curves = self.histories.iter().enumerate().map(|(index, history)| {
            let pairs = history.time.iter().zip((quantity.values)(history));
            let points = pairs.map(|(time, value)| (time * per_second, value * unit.per_si)).collect();
            Curve::new("history", points, self.stroke(index))
        });
        let symbols = self.symbols(quantity, per_second, unit.per_si);
        let verticals = self.instants().map(|(.., instant)| (instant.time * per_second, INSTANT)).collect();
        let y = Axis { label: format!("{} in {}", quantity.name, unit.symbol), scale };
        Ok(Panel { y, curves: lines.into_iter().chain(curves).collect(), symbols, verticals })
    }

    /// A stop over the time of all histories.
    fn stop_line(&self, stop: f64, per_second: f64, color: &'static str) -> Curve {
        let times = || self.histories.iter().flat_map(|history| &history.time).copied();
        let ends = [times().fold(f64::NAN, f64::min), times().fold(f64::NAN, f64::max)];
        Curve::new("stop", ends.map(|time| (time * per_second, stop)).to_vec(), Stroke::solid(color, 2.4))
    }

    fn instants(&self) -> impl Iterator<Item = (usize, &TimeHistory, &ContactInstant)> {
        let histories = self.histories.iter().enumerate();
        histories.flat_map(|(index, history)| history.instants.iter().map(move |instant| (index, *history, instant)))
    }

    /// Instants at which contact begins and ends, on the displacement only: the other quantities may jump there.
    fn symbols(&self, quantity: &Quantity, per_second: f64, per_si: f64) -> Vec<Symbol> {
        let instants = self.instants().filter(|_| quantity.name == DISPLACEMENT.name);
        let symbols = instants.filter_map(|(index, history, instant)| {
            let value = interpolate(&history.time, &history.displacement, instant.time)?;
            let (shape, fill) = if instant.touching { TOUCHING } else { LEAVING };
            let fill = if self.histories.len() > 1 { self.stroke(index).color } else { fill };
            let class = if instant.touching { "touching" } else { "leaving" };
            Some(Symbol::new(class, (instant.time * per_second, value * per_si), shape, fill))
        });
        symbols.collect()
    }

    fn legend(&self) -> Vec<LegendEntry> {
        let histories = self.histories.iter().enumerate();
        let histories = histories.map(|(index, history)| LegendEntry::line(self.stroke(index), &history.label));
        let instants = [(TOUCHING, true, "touching"), (LEAVING, false, "leaving")].into_iter();
        let instants = instants.filter(|(_, touching, _)| self.instants().any(|(.., i)| i.touching == *touching));
        let several = self.histories.len() > 1;
        let instants = instants.map(|((shape, fill), _, name)| LegendEntry {
            key: Key::Symbol(shape, if several { "#ffffff" } else { fill }),
            name: name.into(),
        });
        // Curves in the colours of their stops already identify them.
        let is_named = (0..self.histories.len()).any(|index| self.look.wall(index) == self.stroke(index).color);
        let stop = (!is_named).then(|| LegendEntry::line(Stroke::solid(self.look.wall(0), 2.4), "stop"));
        histories.chain(stop).chain(instants).collect()
    }

    fn stroke(&self, index: usize) -> Stroke {
        let count = self.histories.len();
        let color = self.look.curve(index, count);
        if self.look.is_dashed(index, count) { Stroke::dashed(color, 1.8) } else { Stroke::solid(color, 1.8) }
    }
}

fn check_lengths(history: &TimeHistory, quantities: &[Quantity]) -> Result<(), ReportError> {
    let expected = history.time.len();
    let wrong = quantities.iter().find(|quantity| (quantity.values)(history).len() != expected);
    wrong.map_or(Ok(()), |quantity| {
        let (label, series) = (history.label.clone(), quantity.name);
        Err(ReportError::SeriesLength { label, series, found: (quantity.values)(history).len(), expected })
    })
}

fn nothing(reason: &'static str) -> ReportError {
    ReportError::NothingToDraw { figure: "time history", reason }
}

fn largest<'v>(values: impl IntoIterator<Item = &'v f64>) -> f64 {
    values.into_iter().filter(|value| value.is_finite()).fold(0.0, |largest, value| value.abs().max(largest))
}

/// Value at `at` between the samples; none outside them.
fn interpolate(time: &[f64], values: &[f64], at: f64) -> Option<f64> {
    let after = time.partition_point(|time| *time < at);
    let (t1, v1) = (*time.get(after)?, *values.get(after)?);
    let before = after.checked_sub(1).map(|before| (time[before], values[before]));
    match before {
        Some((t0, v0)) => Some(v0 + (v1 - v0) * (at - t0) / (t1 - t0)),
        None => (t1 == at).then_some(v1),
    }
}
