//! The columns of derivatives, behind those of every point: as many as a scene has parameters.

use std::sync::Arc;

use nlmodes_modal::{Gradient, GradientOf, ModalPoint};

use super::{Cells, Column};

/// Their names and meanings; `<key>` is the key of a parameter.
pub const GRADIENT_COLUMNS: [Column; 7] = [
    Column::new(
        "d_frequency_d_<key>",
        "Hz per unit of the key",
        "derivative of `frequency_hz` by this parameter, of a mode at constant energy, at phase \
         resonance at constant level, of a response over the frequency at constant amplitude of stop 0: at a fold that \
         of the jump frequency, whatever is held; infinite or empty at a peak, where d_amplitude counts",
    ),
    Column::new(
        "d_amplitude_d_<key>",
        "m per unit of the key",
        "derivative of the magnitude of `fundamental_m`, of a mode at constant energy, of a response at constant \
         frequency and level; infinite or empty at a fold, where d_frequency or d_level counts",
    ),
    Column::new("d_peak_d_<key>", "m per unit of the key", "the same of `peak_m`"),
    Column::new("d_peak_force_d_<key>", "N per unit of the key", "the same of `peak_contact_force_n`"),
    Column::new("d_impulse_d_<key>", "N·s per unit of the key", "the same of `impulse_ns`"),
    Column::new(
        "d_level_d_<key>",
        "unit of the level per unit of the key",
        "of a response over the level: derivative of `level` at constant frequency and amplitude; at a fold that of \
         the level at which the response jumps",
    ),
    Column::new("d_damping_ratio_d_<key>", "per unit of the key", "of a damped mode: derivative of `damping_ratio`"),
];

/// The columns of derivatives that the points of a table have.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GradientColumns {
    parameters: Arc<[Arc<str>]>,
    known: Arc<[GradientOf]>,
}

/// The derivatives of a point as cells.
#[derive(Debug, Clone, PartialEq)]
pub struct GradientCells {
    columns: GradientColumns,
    values: Vec<Option<f64>>,
}

impl GradientColumns {
    /// Of a table with these points.
    pub fn of<'p>(points: impl Iterator<Item = &'p ModalPoint> + Clone) -> Self {
        let first = points.clone().find(|point| !point.gradients.is_empty());
        let parameters = first.into_iter().flat_map(|point| &*point.gradients);
        let is_known = |what: &GradientOf| {
            points.clone().flat_map(|point| &*point.gradients).any(|gradient| gradient.of(*what).is_some())
        };
        let known = GradientOf::ALL.into_iter().filter(is_known);
        Self { parameters: parameters.map(|gradient| gradient.parameter.clone()).collect(), known: known.collect() }
    }

    /// The cells of a point; empty where it has no derivatives.
    pub fn cells(&self, point: &ModalPoint) -> GradientCells {
        // Those of a scene come in one order at all points.
        let of = |k: usize, parameter: &Arc<str>| {
            let there = point.gradients.get(k).filter(|gradient| gradient.parameter == *parameter);
            there.or_else(|| point.gradients.iter().find(|gradient| gradient.parameter == *parameter))
        };
        let values = self.parameters.iter().enumerate().flat_map(|(k, parameter)| {
            let gradient: Option<&Gradient> = of(k, parameter);
            self.known.iter().map(move |what| gradient.and_then(|gradient| gradient.of(*what)))
        });
        GradientCells { values: values.collect(), columns: self.clone() }
    }
}

impl Cells for GradientCells {
    fn header(&self) -> Vec<String> {
        let GradientColumns { parameters, known } = &self.columns;
        let names = |parameter: &Arc<str>| {
            let parameter = parameter.clone();
            known.iter().map(move |what| format!("d_{}_d_{parameter}", what.name()))
        };
        parameters.iter().flat_map(names).collect()
    }

    fn cells(&self) -> Vec<String> {
        self.values.iter().map(|value| value.map_or_else(String::new, |value| format!("{value:?}"))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_columns_of_what_is_known_and_points_without_any_have_empty_cells() {
        let mut by = [None; 7];
        (by[0], by[3]) = (Some(-1.5), Some(2e7));
        let gradient = |key: &str, by| Gradient { parameter: key.into(), value: 1e-3, by };
        let with = ModalPoint {
            gradients: [gradient("contact.0.gap_m", by), gradient("structure.section.height_mm", [None; 7])].into(),
            ..ModalPoint::default()
        };
        let points = [ModalPoint::default(), with];
        let columns = GradientColumns::of(points.iter());
        assert_eq!(
            columns.cells(&points[0]).header(),
            [
                "d_frequency_d_contact.0.gap_m",
                "d_peak_force_d_contact.0.gap_m",
                "d_frequency_d_structure.section.height_mm",
                "d_peak_force_d_structure.section.height_mm"
            ]
        );
        assert_eq!(columns.cells(&points[1]).cells(), ["-1.5", "20000000.0", "", ""]);
        assert_eq!(columns.cells(&points[0]).cells(), ["", "", "", ""]);
        assert!(GradientColumns::of(points[..1].iter()).cells(&points[0]).header().is_empty());
    }
}
