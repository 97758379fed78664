use super::{Figure, marked};
use crate::ReportError;
use crate::StopLine;
use crate::chart::scientific;
use crate::stations::{self, Station};
use crate::surface::{Line, Surface, SurfaceAxis};
use crate::unit::Unit;
use nlmodes_modal::{ModalBranch, ModalPoint};
use std::f64::consts::TAU;

const N_TIMES: usize = 64;
/// Maximum number of positions: more lines would hide the surface.
const MAX_POSITIONS: usize = 41;

/// Motion of the structure over one period as a surface over position and time, as in Fig. 4, with a line at each stop.
///
/// It shows the coordinates of the kind (`axial`, `deflection`) of the contact, or of the first coordinate if there is
/// no contact.
#[derive(Debug, Clone)]
pub struct MotionFigure<'a> {
    branch: &'a ModalBranch,
    point: usize,
    clamped: Vec<f64>,
    stops: Vec<StopLine>,
}

impl<'a> MotionFigure<'a> {
    /// A figure of the motion at point `point` of the branch.
    pub fn new(branch: &'a ModalBranch, point: usize) -> Self {
        Self { branch, point, clamped: Vec::new(), stops: StopLine::first_of(branch).into_iter().collect() }
    }

    /// With displacement zero at these positions, m, which have no coordinate because they are clamped.
    pub fn clamped_at(mut self, positions: &[f64]) -> Self {
        self.clamped.extend_from_slice(positions);
        self
    }

    /// With these stops instead of the first one of the branch; those that limit another kind of motion are not shown.
    pub fn stops(mut self, stops: &[StopLine]) -> Self {
        self.stops = stops.to_vec();
        self
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`ReportError::NoSuchPoint`], [`ReportError::CoefficientShape`] if the point lacks the coordinates of the
    /// branch, [`ReportError::TooFewPositions`], [`ReportError::NothingToDraw`] if the motion is not finite.
    pub fn render(&self) -> Result<Figure, ReportError> {
        let point = self.checked_point()?;
        let kind = stations::kind(self.branch);
        let all = stations::stations(self.branch, kind, &self.clamped);
        let stops = self.shown_stops(kind);
        let kept: Vec<f64> =
            stops.iter().map(|(_, at, _)| *at).chain(stations::contact_position(self.branch)).collect();
        let stations = stations::thinned(all, MAX_POSITIONS, &kept);
        if stations.len() < 2 {
            return Err(ReportError::TooFewPositions { kind: kind.into(), found: stations.len() });
        }
        let heights = heights(point, &stations);
        let is_periodic = point.omega.is_finite() && point.omega > 0.0;
        if !is_periodic || heights.iter().flatten().any(|value| !value.is_finite()) {
            let reason = "the motion or its frequency is not finite";
            return Err(ReportError::NothingToDraw { figure: "motion over a period", reason });
        }
        Ok(Figure::from(self.surface(point, kind, (&stations, &heights), &stops)))
    }

    fn checked_point(&self) -> Result<&ModalPoint, ReportError> {
        let point = marked(&[self.branch], 0, self.point)?;
        let width = point.coefficients.n_harmonics() + 1;
        let (found, expected) = (point.coefficients.n_coordinates(), self.branch.coordinates.len());
        if found == expected {
            return Ok(point);
        }
        Err(ReportError::CoefficientShape { point: self.point, found: (found, width), expected: (expected, width) })
    }

    /// Number, place along the structure and height of the stops that limit motions of this kind.
    fn shown_stops(&self, kind: &str) -> Vec<(usize, f64, f64)> {
        let coordinate = |stop: &StopLine| self.branch.coordinates.get(stop.coordinate).filter(|c| c.kind == kind);
        let finite = self.stops.iter().enumerate().filter(|(_, stop)| stop.position.is_finite());
        finite.filter_map(|(number, stop)| Some((number, coordinate(stop)?.position, stop.position))).collect()
    }

    fn surface(
        &self,
        point: &ModalPoint,
        kind: &str,
        (stations, heights): (&[Station], &[Vec<f64>]),
        stops: &[(usize, f64, f64)],
    ) -> Surface {
        let period = TAU / point.omega;
        let positions: Vec<f64> = stations.iter().map(|(position, _)| *position).collect();
        let times: Vec<f64> = (0..=N_TIMES).map(|k| period * k as f64 / N_TIMES as f64).collect();
        let largest = heights
            .iter()
            .flatten()
            .chain(stops.iter().map(|(.., height)| height))
            .fold(0.0, |m: f64, value| m.max(value.abs()));
        let (name, z) = quantity(kind, largest);
        let x = Unit::fine("m", positions.iter().fold(0.0, |m: f64, value| m.max(value.abs())));
        let t = Unit::fine("s", period);
        let scaled = |values: &[f64], unit: &Unit| values.iter().map(|value| value * unit.per_si).collect::<Vec<_>>();
        let first = stations::contact_position(self.branch);
        let is_contact = |position: f64| Some(position) == first || stops.iter().any(|(_, at, _)| *at == position);
        Surface {
            title: self.title(point),
            x: SurfaceAxis { label: format!("position in {}", x.symbol), values: scaled(&positions, &x) },
            y: SurfaceAxis { label: format!("time in {}", t.symbol), values: scaled(&times, &t) },
            z_label: format!("{name} in {}", z.symbol),
            z: heights.iter().map(|row| scaled(row, &z)).collect(),
            stops: stops
                .iter()
                .map(|(number, at, height)| Line { number: *number, x: at * x.per_si, z: height * z.per_si })
                .collect(),
            contacts: (0..stations.len()).filter(|i| is_contact(stations[*i].0)).collect(),
        }
    }

    fn title(&self, point: &ModalPoint) -> String {
        let frequency = format!("{:.4} Hz", point.omega / TAU);
        format!("Point {}: {frequency}, averaged kinetic energy {} J", self.point, scientific(point.kinetic_energy))
    }
}

/// Displacement at each position (rows) and time (columns) of one period.
fn heights(point: &ModalPoint, stations: &[Station]) -> Vec<Vec<f64>> {
    let phases: Vec<f64> = (0..=N_TIMES).map(|k| TAU * k as f64 / N_TIMES as f64).collect();
    let value = |index: Option<usize>, phase: f64| index.map_or(0.0, |index| point.coefficients.value(index, phase));
    stations.iter().map(|(_, index)| phases.iter().map(|phase| value(*index, *phase)).collect()).collect()
}

fn quantity(kind: &str, largest: f64) -> (&'static str, Unit) {
    let unit = if stations::motion_of(kind) == "rotation" { "rad" } else { "m" };
    (stations::word(kind), Unit::fine(unit, largest))
}
