//! Figures of quantities over variables.

use nlmodes::report::SpreadFigure;

use crate::collect::Collected;
use crate::statistics::quantile;
use crate::study::Study;
use crate::table::Cells;

/// Maximum number of figures of a study.
const MOST: usize = 60;
/// Maximum number of groups of neighbours, and minimum number of cases in each.
const GROUPS: usize = 24;
const OF_GROUP: usize = 20;

/// Each quantity over each numerical variable, as the name of its file and an SVG document; those without any value are
/// omitted.
pub fn figures(study: &Study, collected: &Collected) -> Vec<(String, String)> {
    let numbers = |name: &str| collected.table.column(name).and_then(Cells::numbers).unwrap_or_default();
    let mut figures = Vec::new();
    for quantity in &study.quantities {
        let y = numbers(&quantity.name);
        for variable in &study.variables {
            let x = numbers(&variable.name);
            let points: Vec<(f64, f64)> = x.iter().zip(&y).filter_map(|(x, y)| x.zip(*y)).collect();
            let file = format!("{}_over_{}.svg", plain(&quantity.name), plain(&variable.name));
            if let Some(svg) = figure(&study.title, &variable.name, &quantity.label(), &points)
                && figures.len() < MOST
            {
                figures.push((file, svg));
            }
        }
    }
    figures
}

fn figure(title: &str, x_label: &str, y_label: &str, points: &[(f64, f64)]) -> Option<String> {
    let [low, middle, high] = percentiles(points);
    let figure = SpreadFigure::new(x_label, y_label, points).title(title);
    let figure = match middle.is_empty() {
        true => figure,
        false => figure.middle("median", &middle).limit("5 and 95 %", &low).limit("", &high),
    };
    figure.render().ok().map(|figure| figure.as_svg().to_owned())
}

/// 5, 50 and 95 % of groups of neighbours; `None` if there are too few for three groups.
fn percentiles(points: &[(f64, f64)]) -> [Vec<(f64, f64)>; 3] {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups = GROUPS.min(sorted.len() / OF_GROUP);
    let mut lines = [Vec::new(), Vec::new(), Vec::new()];
    for g in 0..if groups < 3 { 0 } else { groups } {
        let own = &sorted[g * sorted.len() / groups..(g + 1) * sorted.len() / groups];
        let x = own.iter().map(|p| p.0).sum::<f64>() / own.len() as f64;
        let mut values: Vec<f64> = own.iter().map(|p| p.1).collect();
        values.sort_by(f64::total_cmp);
        for (line, share) in lines.iter_mut().zip([0.05, 0.5, 0.95]) {
            line.push((x, quantile(&values, share)));
        }
    }
    lines
}

/// A portable file name.
pub fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_groups_are_those_of_their_values() {
        // Within each of 24 groups of 100 the values run evenly from 0 to 99.
        let points: Vec<(f64, f64)> = (0..2400).map(|k| (f64::from(k), f64::from(k % 100))).collect();
        let [low, middle, high] = percentiles(&points);
        assert_eq!(middle.len(), 24);
        assert!(low.iter().all(|p| (p.1 - 4.95).abs() < 1e-9) && high.iter().all(|p| (p.1 - 94.05).abs() < 1e-9));
        assert!(middle.iter().enumerate().all(|(g, p)| p.1 == 49.5 && p.0 == 100.0 * g as f64 + 49.5));
        assert!(percentiles(&points[..59]).iter().all(Vec::is_empty));
        assert_eq!(plain("contact.0.gap_m/ä"), "contact_0_gap_m__");
    }
}
