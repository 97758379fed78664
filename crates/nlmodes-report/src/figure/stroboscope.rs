use super::Figure;
use crate::chart::{Axis, Chart, Curve, Panel, Scale};
use crate::palette;
use crate::stations::Station;
use crate::svg::Stroke;
use crate::unit::Unit;
use nlmodes_modal::ModalPoint;
use std::f64::consts::TAU;

const N_INSTANTS: usize = 16;
const STROKE: Stroke = Stroke::solid(palette::INK, 0.9);

/// Shapes of the structure at sixteen instants of a period in one figure, with short lines at the stops (number,
/// position, displacement).
///
/// `None` if the motion is not finite.
pub(crate) fn stroboscope(
    point: &ModalPoint,
    name: &str,
    stations: &[Station],
    stops: &[(usize, f64, f64)],
) -> Option<Figure> {
    let shapes: Vec<Vec<f64>> = (0..N_INSTANTS).map(|k| shape(point, stations, k)).collect();
    let positions: Vec<f64> = stations.iter().map(|(position, _)| *position).collect();
    let heights = || shapes.iter().flatten().copied().chain(stops.iter().map(|(.., stop)| *stop));
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |m: f64, value| m.max(value.abs()));
    let unit = Unit::fine(if name == "rotation" { "rad" } else { "m" }, largest(&mut heights()));
    let x = Unit::fine("m", largest(&mut positions.iter().copied()));
    let curve = |class, points: Vec<(f64, f64)>, stroke| {
        let points = points.into_iter().map(|(at, height)| (at * x.per_si, height * unit.per_si)).collect();
        Curve::new(class, points, stroke)
    };
    let moving = shapes
        .iter()
        .map(|shape| curve("instant", positions.iter().copied().zip(shape.iter().copied()).collect(), STROKE));
    let reach = 0.03 * largest(&mut positions.iter().copied());
    let walls = stops.iter().map(|(number, at, stop)| {
        let stroke = Stroke::solid(palette::stop(*number), 2.4);
        curve("stop", vec![(at - reach, *stop), (at + reach, *stop)], stroke)
    });
    let y_scale = Scale::linear(heights().map(|value| value * unit.per_si), 0.08)?;
    let x_scale = Scale::linear(positions.iter().map(|value| value * x.per_si), 0.04)?;
    let y = Axis { label: format!("{name} in {}", unit.symbol), scale: y_scale };
    let panel = Panel { y, curves: moving.chain(walls).collect(), symbols: Vec::new(), verticals: Vec::new() };
    let x = Axis { label: format!("position in {}", x.symbol), scale: x_scale };
    let title = format!("Sixteen instants of a period, {:.4} Hz", point.omega / TAU);
    Some(Figure::from(Chart::new(title, x, vec![panel], 280.0, Vec::new())))
}

fn shape(point: &ModalPoint, stations: &[Station], instant: usize) -> Vec<f64> {
    let phase = TAU * instant as f64 / N_INSTANTS as f64;
    let value = |index: &Option<usize>| index.map_or(0.0, |index| point.coefficients.value(index, phase));
    stations.iter().map(|(_, index)| value(index)).collect()
}
