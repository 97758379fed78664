use std::f64::consts::TAU;

use super::Figure;
use super::branch::corners;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, LegendEntry, Panel, Scale};
use crate::palette;
use crate::svg::Stroke;
use crate::unit::Unit;
use nlmodes_modal::{ContactPeriod, Event, ModalBranch, ModalPoint};

/// Maximum number of stops in one figure.
const MAX_STOPS: usize = 10;

/// Share of the period, impulse per period and largest force of each stop over frequency: one panel each, one curve per
/// stop.
///
/// With more than ten stops, those with the largest impulses are shown.
#[derive(Debug, Clone)]
pub struct ContactFigure<'a> {
    branch: &'a ModalBranch,
    names: Vec<String>,
    title: String,
}

/// One quantity of a contact and its axis.
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
    // The largest force of a short contact need not converge with harmonics.
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
        let name = |stop: usize| self.names.get(stop).cloned().unwrap_or_else(|| format!("stop {stop}"));
        let legend = shown.iter().map(|stop| LegendEntry::line(stroke(*stop), name(*stop))).collect();
        let x = Axis { label: "frequency in Hz".into(), scale };
        let note = Some(self.note(shown.len()));
        Ok(Figure::from(Chart { note, ..Chart::new(self.title.clone(), x, panels, 150.0, legend) }))
    }

    /// The note below the figure.
    fn note(&self, shown: usize) -> String {
        let more = self.n_stops().saturating_sub(shown);
        let more = if more > 0 {
            format!("; {more} more stops, with smaller impulses, are in contacts.csv")
        } else {
            String::new()
        };
        format!("* of short blows the largest force need not converge with harmonics, the impulse does{more}")
    }

    fn n_stops(&self) -> usize {
        self.branch.points.iter().map(|point| point.contacts.len()).min().unwrap_or(0)
    }

    /// The stops that are shown, ascending.
    fn shown(&self) -> Vec<usize> {
        let points = &self.branch.points;
        let most = |stop: usize| points.iter().map(|point| point.contacts[stop].impulse).fold(0.0, f64::max);
        let mut order: Vec<usize> = (0..self.n_stops()).collect();
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
        for stop in shown {
            let goes_on = |_: &ModalPoint, next: &ModalPoint| !next.has_event(Event::Resumed);
            curves.extend(points.chunk_by(goes_on).map(|piece| {
                let points = piece.iter().map(|p| (p.omega / TAU, value(p, *stop) * unit.per_si)).collect();
                Curve::new("contact", points, stroke(*stop)).smooth(corners(piece))
            }));
        }
        let label =
            if unit.symbol.is_empty() { quantity.name.into() } else { format!("{} in {}", quantity.name, unit.symbol) };
        Ok(Panel { y: Axis { label, scale }, curves, symbols: Vec::new(), verticals: Vec::new() })
    }
}

/// Line of the stop with this number.
fn stroke(stop: usize) -> Stroke {
    if palette::is_first_round(stop) {
        Stroke::solid(palette::stop(stop), 1.8)
    } else {
        Stroke::dashed(palette::stop(stop), 1.8)
    }
}

fn nothing() -> ReportError {
    ReportError::NothingToDraw { figure: "contacts", reason: "no point has contacts with finite values" }
}
