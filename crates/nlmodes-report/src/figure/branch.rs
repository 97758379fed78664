mod inset;
mod pieces;

use super::Figure;
use super::events::EventSymbols;
use crate::ReportError;
use crate::chart::{Axis, Chart, Curve, Key, LegendEntry, Name, PANEL_HEIGHT, Panel, Scale, Shape, Symbol};
use crate::palette;
use crate::svg::Stroke;
pub(super) use pieces::{State, corners};

use nlmodes_modal::{Event, ModalBranch, ModalPoint, Tongue, tongues};
use pieces::{branch_stroke, pieces};
use std::f64::consts::TAU;

/// Fraction of the amplitude axis within which the points must begin if it extends to zero.
const FROM_ZERO: f64 = 0.5;

/// Abscissa for the frequency of a nonlinear mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Abscissa {
    /// Averaged kinetic energy, J, on a logarithmic axis, as in Fig. 3 b.
    Energy,
    /// Nonlinear modal amplitude, m·√kg, on a linear axis, as in Fig. 8 a.
    ModalAmplitude,
}

/// Frequency of nonlinear modes over energy or amplitude: several branches in one figure.
///
/// Each event has its own symbol. If a branch starts at grazing, the linear mode below is drawn as a dashed line.
#[derive(Debug, Clone)]
pub struct BranchFigure<'a> {
    abscissa: Abscissa,
    branches: &'a [&'a ModalBranch],
    title: String,
    marks: Vec<(usize, usize, String)>,
    scattered: Vec<usize>,
}

impl<'a> BranchFigure<'a> {
    /// A figure of these branches, named in the legend by their labels.
    pub fn new(abscissa: Abscissa, branches: &'a [&'a ModalBranch]) -> Self {
        Self { abscissa, branches, title: String::new(), marks: Vec::new(), scattered: Vec::new() }
    }

    /// With a title; without one otherwise.
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// With a name, for instance `P1`, beside point `point` of the branch number `branch`.
    pub fn mark(mut self, branch: usize, point: usize, name: impl Into<String>) -> Self {
        self.marks.push((branch, point, name.into()));
        self
    }

    /// Draws the branches with these numbers as points without a line: nothing was measured between them.
    pub fn scattered(mut self, branches: &[usize]) -> Self {
        self.scattered = branches.to_vec();
        self
    }

    /// Draws the figure.
    ///
    /// Points with a value that the axes cannot show (NaN, an energy of zero) interrupt their curve.
    ///
    /// # Errors
    /// [`ReportError::NothingToDraw`] if no branch has a point that the axes can show, [`ReportError::NoSuchPoint`] for
    /// a mark on a point that does not exist.
    pub fn render(&self) -> Result<Figure, ReportError> {
        let mut events = EventSymbols::default();
        let (x, y) = self.scales()?;
        // Dots that only carry names are drawn below the events.
        let mut symbols = self.mark_symbols()?;
        symbols.extend(self.points());
        symbols.extend(self.tongue_symbols());
        symbols.extend(self.event_symbols(&mut events));
        let lines = self.linear_modes(x.ends().0);
        let legend = self.legend(!lines.is_empty(), &events);
        let curves = lines.into_iter().chain(self.curves()).chain(self.skipped()).collect();
        let y = Axis { label: "frequency in Hz".into(), scale: y };
        let panel = Panel { y, curves, symbols, verticals: Vec::new() };
        let x = Axis { label: self.abscissa.label().into(), scale: x };
        let inset = self.inset(x.scale, panel.y.scale);
        Ok(Figure::from(Chart { inset, ..Chart::new(self.title.clone(), x, vec![panel], PANEL_HEIGHT, legend) }))
    }

    fn place(&self, point: &ModalPoint) -> (f64, f64) {
        (self.abscissa.value(point), point.omega / TAU)
    }

    fn is_visible(&self, point: &ModalPoint) -> bool {
        let (x, y) = self.place(point);
        x.is_finite() && y.is_finite() && (x > 0.0 || self.abscissa == Abscissa::ModalAmplitude)
    }

    fn scales(&self) -> Result<(Scale, Scale), ReportError> {
        let points = || self.branches.iter().flat_map(|branch| &branch.points).filter(|point| self.is_visible(point));
        let x_values = points().map(|point| self.abscissa.value(point));
        let grazing = self.branches.iter().filter_map(|branch| self.grazing_start(branch));
        let grazing = grazing.map(|point| self.abscissa.value(point)).reduce(f64::min);
        let x = self.abscissa.scale(x_values, grazing);
        let y = Scale::linear(points().map(|point| point.omega / TAU), 0.06);
        let reason = "no branch has a point with finite values";
        x.zip(y).ok_or(ReportError::NothingToDraw { figure: self.abscissa.figure(), reason })
    }

    /// The grazing point of a branch that begins or ends there, and therefore needs a line for the linear mode below.
    fn grazing_start<'p>(&self, branch: &'p ModalBranch) -> Option<&'p ModalPoint> {
        let mut visible = branch.points.iter().filter(|point| self.is_visible(point));
        let ends = [visible.clone().next(), visible.next_back()];
        ends.into_iter().flatten().find(|point| point.leaves_linear_mode())
    }

    fn linear_modes(&self, start: f64) -> Vec<Curve> {
        let lines = self.branches.iter().enumerate().filter_map(|(index, branch)| {
            let (x, y) = self.place(self.grazing_start(branch)?);
            let stroke = Stroke::dashed(palette::curve(index), 1.6);
            Some(Curve::new("linear-mode", vec![(start, y), (x, y)], stroke))
        });
        lines.collect()
    }

    /// The lines of all branches, from back to front.
    fn curves(&self) -> impl Iterator<Item = Curve> {
        let branches = self.branches.iter().enumerate().filter(|(index, _)| !self.scattered.contains(index));
        let all =
            branches.flat_map(|(index, branch)| pieces(&branch.points).into_iter().map(move |piece| (index, piece)));
        let (behind, front): (Vec<_>, Vec<_>) = all.partition(|(_, piece)| piece.is_behind);
        behind.into_iter().chain(front).map(|(index, piece)| {
            let points = piece.points.iter().map(|point| self.place(point)).collect();
            Curve::new(piece.state.class(), points, piece.stroke(index)).smooth(corners(piece.points))
        })
    }

    /// The points of branches without a line.
    fn points(&self) -> impl Iterator<Item = Symbol> {
        let shown = self.branches.iter().enumerate().filter(|(index, _)| self.scattered.contains(index));
        shown.flat_map(move |(index, branch)| {
            let visible = branch.points.iter().filter(|point| self.is_visible(point));
            let fill = palette::curve(index);
            visible.map(move |point| Symbol::new("measured", self.place(point), Shape::Circle, fill).open())
        })
    }

    /// A dashed line for each internal-resonance branch that was skipped, between its base points.
    fn skipped(&self) -> impl Iterator<Item = Curve> {
        self.branches.iter().enumerate().flat_map(move |(index, branch)| {
            let feet = branch.points.windows(2).filter(|pair| pair[1].has_event(Event::Resumed));
            feet.map(move |pair| {
                let points = pair.iter().map(|point| self.place(point)).collect();
                Curve::new("skipped-tongue", points, Stroke::dashed(palette::curve(index), 1.2))
            })
        })
    }

    /// The name of each internal resonance beside its tip, or beside its first base point if it was skipped; the
    /// largest first, since some may not fit.
    fn tongue_symbols(&self) -> Vec<Symbol> {
        let of_branch = |branch: &&ModalBranch| {
            let symbol = |tongue: Tongue| {
                let point = &branch.points[if tongue.skipped { tongue.start } else { tongue.tip }];
                let name = Some(Name { text: tongue.resonance.to_string(), may_go: true });
                Symbol { name, ..Symbol::new("tongue", self.place(point), Shape::Dot, palette::INK) }
            };
            let shown = tongues(&branch.points).into_iter().filter(|t| self.is_visible(&branch.points[t.tip]));
            shown.map(symbol).collect::<Vec<_>>()
        };
        let mut found: Vec<Symbol> = self.branches.iter().flat_map(of_branch).collect();
        found.sort_by(|a, b| b.at.0.total_cmp(&a.at.0));
        found
    }

    fn event_symbols(&self, events: &mut EventSymbols) -> Vec<Symbol> {
        let points = self.branches.iter().flat_map(|branch| &branch.points).filter(|point| self.is_visible(point));
        let pairs = points.flat_map(|point| point.events.iter().map(move |event| (point, event)));
        let mut found: Vec<(usize, Symbol)> = pairs
            .map(|(point, event)| {
                let (shape, fill) = events.of(*event);
                let symbol = Symbol::new(format!("event {event}"), self.place(point), shape, fill);
                (EventSymbols::layer(*event), symbol.open())
            })
            .collect();
        found.sort_by_key(|(layer, _)| *layer);
        found.into_iter().map(|(_, symbol)| symbol).collect()
    }

    fn mark_symbols(&self) -> Result<Vec<Symbol>, ReportError> {
        let symbol = |(branch, point, name): &(usize, usize, String)| {
            let at = self.place(marked(self.branches, *branch, *point)?);
            let name = Some(Name::fixed(name));
            Ok(Symbol { name, ..Symbol::new("mark", at, Shape::Dot, palette::INK) })
        };
        self.marks.iter().map(symbol).collect()
    }

    fn legend(&self, has_linear_mode: bool, events: &EventSymbols) -> Vec<LegendEntry> {
        let branches = self.branches.iter().enumerate();
        let key = |index: usize| match self.scattered.contains(&index) {
            true => Key::Open(Shape::Circle, palette::curve(index)),
            false => Key::Line(branch_stroke(index)),
        };
        // Curves without points in this figure, such as a test without energies, are not in its legend.
        let branches = branches.filter(|(_, branch)| branch.points.iter().any(|point| self.is_visible(point)));
        let branches = branches.map(|(index, branch)| LegendEntry { key: key(index), name: branch.label.clone() });
        let linear = has_linear_mode.then(|| LegendEntry::line(Stroke::dashed(palette::INK, 1.6), "linear mode"));
        let curves = self.branches.iter().enumerate().filter(|(index, _)| !self.scattered.contains(index));
        let states: Vec<State> =
            curves.flat_map(|(_, branch)| pieces(&branch.points)).map(|piece| piece.state).collect();
        let ink = Stroke { color: palette::INK, ..branch_stroke(0) };
        let of = [(State::Unstable, "unstable"), (State::Unknown, "stability unknown")];
        let of = of.into_iter().filter(|(state, _)| states.contains(state));
        let of = of.map(|(state, name)| LegendEntry::line(state.stroke(ink), name));
        branches.chain(linear).chain(of).chain(events.legend()).collect()
    }
}

/// The point with this number of the branch with that one.
///
/// # Errors
/// [`ReportError::NoSuchPoint`].
pub(crate) fn marked<'b>(
    branches: &[&'b ModalBranch],
    branch: usize,
    point: usize,
) -> Result<&'b ModalPoint, ReportError> {
    let found = branches.get(branch);
    found.and_then(|branch| branch.points.get(point)).ok_or_else(|| {
        let label = found.map_or_else(|| format!("number {branch}"), |branch| branch.label.clone());
        ReportError::NoSuchPoint { point, branch: label, n_points: found.map_or(0, |branch| branch.points.len()) }
    })
}

impl Abscissa {
    fn figure(self) -> &'static str {
        match self {
            Self::Energy => "frequency over energy",
            Self::ModalAmplitude => "frequency over modal amplitude",
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Energy => "averaged kinetic energy in J",
            Self::ModalAmplitude => "modal amplitude in m √kg",
        }
    }

    fn value(self, point: &ModalPoint) -> f64 {
        match self {
            Self::Energy => point.kinetic_energy,
            Self::ModalAmplitude => point.modal_amplitude,
        }
    }

    /// Axis over `values` with room for the linear mode below `grazing`: all of it, or a fifth of the axis if the
    /// points are far from zero.
    fn scale(self, values: impl Iterator<Item = f64>, grazing: Option<f64>) -> Option<Scale> {
        match self {
            Self::Energy => {
                let scale = Scale::logarithmic(values, 0.04)?;
                let (low, high) = scale.ends();
                let start = grazing.map(|energy| energy * (low / high).powf(0.2));
                Some(start.map_or(scale, |start| scale.starting_at(start.min(low))))
            }
            Self::ModalAmplitude => {
                let scale = Scale::linear(values, 0.04)?;
                let (low, high) = scale.ends();
                let below = grazing.filter(|amplitude| *amplitude > 0.0);
                Some(below.map_or(scale, |amplitude| match low > FROM_ZERO * high {
                    true => scale.starting_at(low.min(amplitude - 0.25 * (high - amplitude))),
                    false => scale.starting_at(0.0),
                }))
            }
        }
    }
}
