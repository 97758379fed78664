//! Points solved again with twice as many harmonics: against curves that were computed with these.

use nlmodes::response::{
    Event, FinerSettings, ResponseCurve, ResponseModel, ResponseSettings, conservative_mode, damped_mode,
    frequency_response, phase_resonance,
};

use crate::response::curves::{rod_of_two, window};

fn compared(settings: ResponseSettings) -> ResponseSettings {
    ResponseSettings { finer: Some(FinerSettings { least_s: 60.0, ..FinerSettings::default() }), ..settings }
}

fn folds(curve: &ResponseCurve) -> Vec<f64> {
    curve.points.iter().filter(|p| p.events.contains(&Event::Fold)).map(|p| p.omega).collect()
}

/// What a fold is reported to change by is what it changes by in a curve with twice as many harmonics, as far as the
/// line across the coarser curve meets the finer one next to its own fold.
#[test]
fn folds_move_by_what_is_said() {
    let model = rod_of_two();
    for harmonics in [7, 12] {
        let coarse = frequency_response(&model, 0.2, &compared(window(0.3, 0.6, harmonics))).unwrap();
        let fine = frequency_response(&model, 0.2, &window(0.3, 0.6, 2 * harmonics)).unwrap();
        let (own, better) = (folds(&coarse), folds(&fine));
        assert_eq!((own.len(), better.len()), (2, 2));
        for (from, to) in own.iter().zip(&better) {
            let point = coarse.points.iter().position(|p| p.omega == *from).unwrap();
            let finer = coarse.finer.iter().find(|finer| finer.point == point).expect("folds are compared");
            let found = finer.found.as_ref().expect("a motion next to the fold");
            let (said, is) = (found.omega / from - 1.0, to / from - 1.0);
            assert!((said - is).abs() < 0.25 * is.abs() + 1e-7, "{harmonics}: {said:e} for {is:e}");
        }
    }
}

/// The motion with more harmonics solves its equations, has twice as many of them, and balances its power.
#[test]
fn finer_motions_are_motions() {
    let model = rod_of_two();
    let of = |model: &ResponseModel| {
        let settings = || compared(window(0.25, 0.6, 6));
        [
            frequency_response(model, 0.2, &settings()).unwrap(),
            damped_mode(model, 4.0, &settings()).unwrap(),
            conservative_mode(model, 4.0, &settings()).unwrap(),
            phase_resonance(model, 0.1, &settings()).unwrap(),
        ]
    };
    for (kind, curve) in of(&model).iter().enumerate() {
        let found: Vec<_> = curve.finer.iter().filter_map(|finer| Some((finer.point, finer.found.as_ref()?))).collect();
        assert!(found.len() >= 3, "kind {kind}: {} of {}", found.len(), curve.finer.len());
        for (point, finer) in found {
            let own = &curve.points[point].motion;
            assert_eq!((finer.motion.eta.len(), own.eta.len()), (13, 7));
            assert!(finer.residual < 1e-10, "kind {kind}: {:e}", finer.residual);
            // At the same energy, level or place.
            let change = |a: f64, b: f64| (a / b - 1.0).abs();
            assert!(change(finer.omega, curve.points[point].omega) < 0.05);
            match kind {
                1 | 2 => assert!(change(finer.motion.kinetic_energy, own.kinetic_energy) < 1e-9),
                _ => assert!(change(finer.motion.input_power, finer.motion.dissipated_power) < 1e-9),
            }
        }
        let truncation = curve.truncation().unwrap();
        assert!(truncation > 1e-6, "kind {kind}: {truncation:e}");
    }
}

/// Motions that touch nothing have all their harmonics.
#[test]
fn nothing_is_compared_where_nothing_touches() {
    let curve = frequency_response(&rod_of_two(), 1e-4, &compared(window(0.3, 0.6, 5))).unwrap();
    assert!(curve.end.complete && curve.finer.is_empty() && curve.truncation().is_none());
}
