use std::f64::consts::TAU;

use super::Figure;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, Key, LegendEntry, Panel, Scale};
use crate::palette;
use crate::svg::Stroke;
use crate::unit::Unit;
use nlmodes_modal::{ContactPeriod, Event, ModalBranch, ModalPoint};

/// Most stops that are told apart by colour.
const MAX_STOPS: usize = 8;

/// Share of the period, impulse a period and largest force of each stop over the frequency: a panel each, a curve a stop.
///
/// Of more than eight stops those with the largest impulses are shown.
#[derive(Debug, Clone)]
pub struct ContactFigure<'a> {
    branch: &'a ModalBranch,
    names: Vec<String>,
    title: String,
}

/// One quantity of a contact and how it is shown.
struct Quantity {
    name: &'static str,
    unit: fn(f64) -> Unit,
    value: fn(&ContactPeriod) -> f64,
}

const QUANTITIES: [Quantity; 3] = [
    Quantity {
        name: "closed, % of period",
        unit: |_| Unit { symbol: String::new(), per_si: 100.0 },
        value: |c| c.closed_share,
    },
    Quantity { name: "impulse a period", unit: |most| Unit::both("N s", most), value: |c| c.impulse },
    // The largest force of a blow need not converge with harmonics.
    Quantity { name: "largest force*", unit: |most| Unit::coarse("N", most), value: |c| c.peak_force },
];

impl<'a> ContactFigure<'a> {
    /// A figure of the stops of this branch, with these names in the legend: `stop 0 at 0.63 m`.
    pub fn new(branch: &'a ModalBranch, names: &[String]) -> Self {
        Self { branch, names: names.to_vec(), title: String::new() }
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::NothingToDraw`] if no point has a contact with finite values.
    pub fn render(&self) -> Result<Figure, ReportError> {
        let shown = self.shown();
        let frequencies = self.branch.points.iter().map(|point| point.omega / TAU);
        let scale = Scale::linear(frequencies, 0.04).filter(|_| !shown.is_empty()).ok_or_else(nothing)?;
        let panels = QUANTITIES.iter().map(|quantity| self.panel(quantity, &shown)).collect::<Result<Vec<_>, _>>()?;
        let entry = |(place, stop): (usize, &usize)| LegendEntry {
            key: Key::Line(stroke(place)),
            name: self.names.get(*stop).cloned().unwrap_or_else(|| format!("stop {stop}")),
        };
        let legend = shown.iter().enumerate().map(entry).collect();
        let x = Axis { label: "frequency in Hz (* largest force: of short blows it need not converge)".into(), scale };
        Ok(Figure::new(Chart { title: self.title.clone(), x, panels, panel_height: 150.0, legend }.draw()))
    }

    /// The stops that are shown, ascending.
    fn shown(&self) -> Vec<usize> {
        let points = &self.branch.points;
        let count = points.iter().map(|point| point.contacts.len()).min().unwrap_or(0);
        let most = |stop: usize| points.iter().map(|point| point.contacts[stop].impulse).fold(0.0, f64::max);
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| most(*b).total_cmp(&most(*a)));
        order.truncate(MAX_STOPS);
        order.sort_unstable();
        order
    }

    fn panel(&self, quantity: &Quantity, shown: &[usize]) -> Result<Panel, ReportError> {
        let points = &self.branch.points;
        let value = |point: &ModalPoint, stop: usize| (quantity.value)(&point.contacts[stop]);
        let values = || points.iter().flat_map(|point| shown.iter().map(move |stop| value(point, *stop)));
        let largest = values().filter(|value| value.is_finite()).fold(0.0, |m: f64, value| m.max(value.abs()));
        let unit = (quantity.unit)(largest);
        let scale = Scale::linear(values().map(|value| value * unit.per_si), 0.08).ok_or_else(nothing)?;
        let mut curves = Vec::new();
        for (place, stop) in shown.iter().enumerate() {
            let goes_on = |_: &ModalPoint, next: &ModalPoint| !next.has_event(Event::Resumed);
            curves.extend(points.chunk_by(goes_on).map(|piece| Curve {
                class: "contact",
                points: piece.iter().map(|p| (p.omega / TAU, value(p, *stop) * unit.per_si)).collect(),
                stroke: stroke(place),
            }));
        }
        let label =
            if unit.symbol.is_empty() { quantity.name.into() } else { format!("{} in {}", quantity.name, unit.symbol) };
        Ok(Panel { y: Axis { label, scale }, curves, symbols: Vec::new(), verticals: Vec::new() })
    }
}

/// Line of the stop at this place among those shown.
fn stroke(place: usize) -> Stroke {
    match place {
        7.. => Stroke::dashed(palette::curve(place), 1.8),
        _ => Stroke::solid(palette::curve(place), 1.8),
    }
}

fn nothing() -> ReportError {
    ReportError::NothingToDraw { figure: "contacts", reason: "no point has contacts with finite values" }
}
