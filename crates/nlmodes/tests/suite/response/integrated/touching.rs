//! Stops that just touch at rest: there is no level at which such a structure is linear.

use nlmodes::response::{ResponseSettings, force_response, frequency_response};

use crate::response::integrated::masses::Masses;

const MASSES: [Masses; 2] = [
    Masses { mass: 1.0, stiffness: 1.0, gap: 0.0, force: 1.5, damping: 0.1, stop: 10.0 },
    Masses { mass: 3.0, stiffness: 4e6, gap: 0.0, force: 1.5, damping: 0.1, stop: 3.0 },
];

#[test]
fn responses_before_a_stop_that_touches_at_rest_are_those_of_an_integration_in_time() {
    for masses in MASSES {
        let model = masses.model();
        assert_eq!(model.touching_at_rest().unwrap(), [0]);
        let window = [0.6, 1.4].map(|w| w * masses.frequency());
        let settings = ResponseSettings { harmonics: 30, stability: false, ..ResponseSettings::new(window) };
        let curve = frequency_response(&model, masses.level(), &settings).unwrap();
        assert!(curve.end.complete, "{:?}", curve.end);
        for point in curve.points.iter().step_by(10) {
            let share = point.motion.contacts[0].closed_share;
            assert!((0.02..0.8).contains(&share), "{share}");
            let start = masses.state(&model, point, 1);
            let (found, amplitude) = masses.shoot(point.omega, start, 1);
            let off = masses.distance(point.omega, &found, &start);
            let expected = point.drive;
            let close = (amplitude - expected).norm() < 1e-4 * expected.norm();
            assert!(
                off < 1e-2 && close,
                "{} {share}: {off:e} {amplitude} {expected}",
                point.omega / masses.frequency()
            );
        }
    }
}

/// Before a stop without a gap motions are as large as the load: at any level they are the same, multiplied by it.
#[test]
fn motions_before_a_stop_without_a_gap_grow_with_the_level() {
    for masses in MASSES {
        let model = masses.model();
        let omega = 0.9 * masses.frequency();
        let window = [0.6, 1.4].map(|w| w * masses.frequency());
        let settings = ResponseSettings { harmonics: 12, stability: false, ..ResponseSettings::new(window) };
        let curve = force_response(&model, omega, masses.level(), &settings).unwrap();
        assert!(curve.end.complete, "{:?}", curve.end);
        let last = curve.points.last().unwrap();
        let (unit, first) = (last.drive / last.level, &curve.points[0]);
        assert!((last.level / masses.level() - 1.0).abs() < 1e-9 && first.level < 2e-3 * last.level);
        for point in &curve.points {
            assert!((point.drive / point.level - unit).norm() < 1e-7 * unit.norm(), "{}", point.level);
            let share = point.motion.contacts[0].closed_share;
            assert!((share - last.motion.contacts[0].closed_share).abs() < 1e-7, "{}", point.level);
        }
        // A small gap changes them little, and the less the smaller it is.
        let off = |gap: f64| {
            let beside = Masses { gap: gap * last.motion.contacts[0].fundamental.norm(), ..masses };
            let level = masses.level();
            let curve = force_response(&beside.model(), omega, level, &settings).unwrap();
            (curve.points.last().unwrap().drive / level - unit).norm() / unit.norm()
        };
        let [far, near] = [1e-1, 1e-2].map(off);
        assert!(near < 5e-2 && near < 0.3 * far, "{far:e} {near:e}");
    }
}
