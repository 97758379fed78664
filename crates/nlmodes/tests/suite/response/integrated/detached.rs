//! Curves that no response from an end of the window reaches.

use nlmodes::response::{
    EndReason, ResponsePoint, ResponseSettings, detached_response, frequency_response, lies_on, phase_resonance,
};

use num_complex::Complex64;

use crate::response::integrated::masses::Masses;

/// Before the second harmonic meets the second mode the force that holds a resonance falls from 0.289 to 0.125 on the
/// way up: between them there are three phase resonances, and only one of them belongs to the response that begins at
/// rest.
#[test]
fn a_detached_curve_lies_where_a_level_has_three_phase_resonances_and_integration_finds_it_too() {
    for masses in [
        Masses { mass: 1.0, stiffness: 1.0, gap: 1.0, force: 0.2, damping: 0.01, stop: 100.0 },
        Masses { mass: 3.0, stiffness: 4e6, gap: 2e-4, force: 0.2, damping: 0.01, stop: 100.0 },
    ] {
        let model = masses.model();
        let window = [0.4, 1.2].map(|w| w * masses.frequency());
        let level = masses.level();
        let settings =
            ResponseSettings { harmonics: 20, stability: false, levels: vec![level], ..ResponseSettings::new(window) };
        let resonances = phase_resonance(&model, 1.6 * level, &settings).unwrap().at_levels;
        assert_eq!(resonances.len(), 3);
        let up = frequency_response(&model, level, &settings).unwrap();
        let down = ResponseSettings { from_upper_end: true, ..settings.clone() };
        let down = frequency_response(&model, level, &down).unwrap();
        assert!(up.end.complete && down.end.complete, "{:?} {:?}", up.end, down.end);
        let is_reached = |point: &&ResponsePoint| lies_on(point, &up) || lies_on(point, &down);
        let (reached, islands): (Vec<_>, Vec<_>) = resonances.iter().partition(is_reached);
        assert_eq!((reached.len(), islands.len()), (1, 2));
        let detached = detached_response(&model, islands[0], &settings).unwrap();
        assert!(detached.end.has(EndReason::Closed));
        assert!(lies_on(islands[1], &detached));
        // Exact motions lie there too, all the way round; twenty harmonics come to some thousandths of them, but near
        // folds.
        let n = detached.points.len();
        let around: Vec<&ResponsePoint> = (0..12).map(|k| &detached.points[k * n / 12]).collect();
        let miss = |point: &&ResponsePoint| {
            let exact = masses.exact(&model, point, 1)?;
            let row = model.row(1).unwrap();
            let drive: Complex64 = row.modes.iter().enumerate().map(|(k, phi)| exact.modal_harmonic(k, 1) * *phi).sum();
            Some((drive - point.drive).norm() / drive.norm())
        };
        let misses: Vec<Option<f64>> = around.iter().map(miss).collect();
        let close = misses.iter().flatten().filter(|miss| **miss < 1e-2).count();
        assert!(misses.iter().flatten().count() + 1 >= misses.len() && close * 2 > misses.len(), "{misses:?}");
    }
}
