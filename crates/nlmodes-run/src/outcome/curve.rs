//! The curve of a branch as a line of block characters.

use std::f64::consts::TAU;

use nlmodes::branches::ComputedBranch;
use nlmodes::modal::Event;

/// Columns of the line.
const COLUMNS: usize = 40;
const BLOCKS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// `60.7866 Hz ▁▁▂▃▄▆▇█ 66.5000 Hz, over 1.0 to 4.2 grazing energies`: frequency over the logarithm of the energy, at
/// each column that of the point next to it; nothing for fewer than three points.
pub fn blocks(computed: &ComputedBranch) -> Option<String> {
    let points = computed.branch.points.iter();
    let points: Vec<[f64; 2]> = points.map(|point| [point.kinetic_energy, point.omega / TAU]).collect();
    let event = if computed.grazing.lifts_off { Event::LiftOff } else { Event::Grazing };
    of(&points, (event, computed.grazing.energy))
}

/// The event is the one at which the mode ceases to be linear, with its energy.
fn of(points: &[[f64; 2]], (event, reference): (Event, f64)) -> Option<String> {
    let ends = |of: usize| {
        let values = || points.iter().map(|point| point[of]).filter(|value| value.is_finite() && *value > 0.0);
        Some([values().reduce(f64::min)?, values().reduce(f64::max)?])
    };
    let ([least, most], [low, high]) = (ends(0)?, ends(1)?);
    if points.len() < 3 || most <= least {
        return None;
    }
    let block = |column: usize| {
        let at = least * (most / least).powf(column as f64 / (COLUMNS - 1) as f64);
        let off = |point: &&[f64; 2]| (point[0] / at).ln().abs();
        let near = points.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let height = if high > low { (near[1] - low) / (high - low) } else { 0.0 };
        BLOCKS.get((height * BLOCKS.len() as f64) as usize).or(BLOCKS.last()).copied()
    };
    let line: String = (0..COLUMNS).filter_map(block).collect();
    let energy = |value: f64| nlmodes_scene::significant(value / reference, 2);
    Some(format!("{low:.4} Hz {line} {high:.4} Hz, over {} to {} {event} energies", energy(least), energy(most)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_blocks_rises_as_the_frequency_does_over_the_logarithm_of_the_energy() {
        let points: Vec<[f64; 2]> = (0..50).map(|k| [10.0_f64.powf(k as f64 / 49.0), 50.0 + k as f64]).collect();
        let line = of(&points, (Event::Grazing, 1.0)).unwrap();
        let blocks: Vec<char> = line.chars().filter(|c| BLOCKS.contains(c)).collect();
        assert_eq!((blocks.len(), blocks[0], blocks[COLUMNS - 1]), (COLUMNS, '▁', '█'));
        assert!(blocks.is_sorted() && BLOCKS.iter().all(|block| blocks.contains(block)), "{line}");
        assert!(
            line.starts_with("50.0000 Hz ▁") && line.ends_with("█ 99.0000 Hz, over 1 to 10 grazing energies"),
            "{line}"
        );
        let falls: Vec<[f64; 2]> = points.iter().map(|[energy, hz]| [*energy, 150.0 - hz]).collect();
        let falling: String =
            of(&falls, (Event::Grazing, 1.0)).unwrap().chars().filter(|c| BLOCKS.contains(c)).collect();
        assert_eq!(falling.chars().next(), Some('█'));
        assert_eq!(
            (of(&points[..2], (Event::Grazing, 1.0)), of(&[[1.0, 2.0]; 5], (Event::LiftOff, 1.0))),
            (None, None)
        );
    }
}
