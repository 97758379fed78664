//! Stops that press at rest.

use nlmodes::response::{ResponseSettings, frequency_response};

use crate::response::integrated::masses::Masses;

#[test]
fn responses_behind_a_stop_that_presses_at_rest_are_those_of_an_integration_in_time() {
    for masses in [
        Masses { mass: 1.0, stiffness: 1.0, gap: -0.2, force: 1.5, damping: 0.1, stop: 10.0 },
        Masses { mass: 3.0, stiffness: 4e6, gap: -2e-4, force: 1.5, damping: 0.1, stop: 10.0 },
    ] {
        let model = masses.model();
        let window = [0.8, 1.2].map(|w| w * masses.frequency());
        let settings = ResponseSettings { harmonics: 30, stability: false, ..ResponseSettings::new(window) };
        let curve = frequency_response(&model, masses.level(), &settings).unwrap();
        assert!(curve.end.complete, "{:?}", curve.end);
        let opens = |share: f64| (0.05..0.95).contains(&share);
        let mut seen = 0;
        for point in curve.points.iter().step_by(20) {
            let share = point.motion.contacts[0].closed_share;
            assert!(share > 0.0);
            let start = masses.state(&model, point, 1);
            let (found, amplitude) = masses.shoot(point.omega, start, 1);
            let off = masses.distance(point.omega, &found, &start);
            let expected = point.drive;
            let close = (amplitude - expected).norm() < 1e-3 * expected.norm().max(masses.size());
            assert!(
                off < 2e-2 && close,
                "{} {share}: {off:e} {amplitude} {expected}",
                point.omega / masses.frequency()
            );
            seen += usize::from(opens(share));
        }
        assert!(seen > 1, "{seen}");
    }
}
