//! Curves of forced responses: their ends, their powers, and that they meet.

use std::f64::consts::TAU;

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::response::{
    BaseMotion, BaseUnit, Damping, Dashpot, EndReason, Event, ResponseError, ResponseModel, ResponseSettings,
    damped_mode, force_response, frequency_response, phase_resonance, response_from_other_end,
};
use nlmodes_fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
use nlmodes_model::{DofKind, Drop, MasslessContactModel, Side, StructuralModel};

fn rod(elements: usize, ea: f64, rho_a: f64, length: f64, gap: f64, start: Support) -> StructuralModel {
    let rod = Rod {
        material: Material::new(ea, rho_a).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(length, elements).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start,
        end: Support::Free,
    };
    rod.assemble(&[Stop::rigid(length, Direction::Axial, Side::Positive, gap)]).unwrap()
}

/// The rod of two elements with `EA = ρA = L = g₀ = 1`, tip dropped, 1 %, a force at its middle.
pub fn rod_of_two() -> ResponseModel {
    let massless = MasslessContactModel::new(&rod(2, 1.0, 1.0, 1.0, 1.0, Support::Clamped), &Drop).unwrap();
    let open = OpenModes::of_massless(&massless, ModeCount::Lowest(10)).unwrap();
    let mut model = ResponseModel::new(open, &Damping::Ratios(vec![0.01])).unwrap();
    model.push_force(0, 1.0, 1, 0.0).unwrap();
    model.set_drive(0).unwrap();
    model
}

pub fn window(low: f64, high: f64, harmonics: usize) -> ResponseSettings {
    ResponseSettings { harmonics, ..ResponseSettings::new([low * TAU, high * TAU]) }
}

#[test]
fn a_response_goes_through_its_folds_to_the_end_of_the_window_and_balances_power() {
    let curve = frequency_response(&rod_of_two(), 0.2, &window(0.3, 0.6, 12)).unwrap();
    assert_eq!(curve.end.message, "the frequency reached 0.600000 Hz");
    let folds: Vec<_> = curve.points.iter().filter(|p| p.events.contains(&Event::Fold)).collect();
    assert_eq!(folds.len(), 2, "{:?}", folds.iter().map(|p| p.omega / TAU).collect::<Vec<_>>());
    for point in &curve.points {
        let power = point.motion.dissipated_power;
        assert!((point.motion.input_power / power - 1.0).abs() < 1e-12, "{}", point.motion.input_power / power);
        assert!(point.residual < 1e-10 && point.omega > 0.0);
    }
    // The middle of three responses is unstable, the others at its frequency are not.
    let between = |p: &&nlmodes::response::ResponsePoint| (0.415..0.425).contains(&(p.omega / TAU));
    let stable: Vec<bool> =
        curve.points.iter().filter(between).filter_map(|p| p.stability.and_then(|s| s.stable)).collect();
    assert!(stable.contains(&true) && stable.contains(&false), "{stable:?}");
}

#[test]
fn curves_from_both_ends_of_the_window_meet() {
    let model = rod_of_two();
    let up = frequency_response(&model, 0.2, &window(0.3, 0.6, 9)).unwrap();
    let settings = ResponseSettings { from_upper_end: true, ..window(0.3, 0.6, 9) };
    let down = frequency_response(&model, 0.2, &settings).unwrap();
    assert_eq!(up.end.message, "the frequency reached 0.600000 Hz");
    assert_eq!(down.end.message, "the frequency reached 0.300000 Hz");
    let folds = |points: &[nlmodes::response::ResponsePoint]| -> Vec<(f64, f64)> {
        let found = points.iter().filter(|p| p.events.contains(&Event::Fold));
        found.map(|p| (p.omega, p.drive.norm())).collect()
    };
    let (there, mut back) = (folds(&up.points), folds(&down.points));
    back.reverse();
    assert_eq!((there.len(), back.len()), (2, 2));
    for (a, b) in there.iter().zip(&back) {
        assert!((a.0 / b.0 - 1.0).abs() < 1e-9 && (a.1 / b.1 - 1.0).abs() < 1e-5, "{a:?} {b:?}");
    }
    let ends = [(up.points.first(), down.points.last()), (up.points.last(), down.points.first())];
    for (a, b) in ends.map(|(a, b)| (a.unwrap(), b.unwrap())) {
        assert!((a.drive - b.drive).norm() < 1e-9 * a.drive.norm());
    }
}

/// Between its folds, at 0.42 Hz, the structure has a motion before the stop beside that against it: the curve that
/// comes from below ends with the latter, and that from the upper end begins with the former, whose amplitude is
/// `F/|K − ω²M + 2iζω₁ωM|` with `K = EA/h = 2`, `M = 2ρAh/3 = 1/3`.
#[test]
fn where_the_window_ends_between_folds_each_end_shows_its_motion() {
    let model = rod_of_two();
    for upper in [0.42, 0.425] {
        let settings = window(0.3, upper, 9);
        let below = frequency_response(&model, 0.2, &settings).unwrap();
        let above = response_from_other_end(&model, 0.2, &settings, std::slice::from_ref(&below)).unwrap().unwrap();
        let end = format!("the frequency reached {upper:.6} Hz");
        assert_eq!([&below.end.message, &above.end.message], [&end, &end]);
        let (mass, stiffness, omega) = (1.0 / 3.0, 2.0_f64, upper * TAU);
        let damping = 2.0 * 0.01 * (stiffness * mass).sqrt() * omega;
        let expected = 0.2 / (stiffness - omega * omega * mass).hypot(damping);
        let (first, last) = (&above.points[0], below.points.last().unwrap());
        assert!((first.drive.norm() / expected - 1.0).abs() < 1e-9, "{} {expected}", first.drive.norm());
        assert!(first.motion.contacts[0].closed_share == 0.0 && last.motion.contacts[0].closed_share > 0.1);
    }
    for (low, high) in [(0.3, 0.6), (0.42, 0.6)] {
        let settings = window(low, high, 9);
        let known = [frequency_response(&model, 0.2, &settings).unwrap()];
        assert!(response_from_other_end(&model, 0.2, &settings, &known).unwrap().is_none(), "{low} to {high}");
    }
}

#[test]
fn phase_resonance_goes_through_the_peak_of_the_response() {
    let model = rod_of_two();
    let settings = window(0.3, 0.6, 20);
    let curve = phase_resonance(&model, 0.2, &settings).unwrap();
    assert!(curve.end.has(EndReason::Limit));
    let last = curve.points.last().unwrap();
    assert!((last.level - 0.2).abs() < 1e-12);
    assert!((last.omega / TAU - 0.4400260004).abs() < 1e-6, "{}", last.omega / TAU);
    assert!(curve.points.iter().all(|p| (p.lag() - TAU / 4.0).abs() < 1e-9));
    let response = frequency_response(&model, 0.2, &settings).unwrap();
    let highest = response.points.iter().map(|p| p.omega).filter(|w| *w < 0.5 * TAU).fold(0.0, f64::max);
    assert!((highest / last.omega - 1.0).abs() < 0.2);
}

#[test]
fn a_curve_that_begins_outside_of_its_window_says_where() {
    let model = rod_of_two();
    for refused in [
        phase_resonance(&model, 0.2, &window(0.5, 0.9, 5)).unwrap_err(),
        damped_mode(&model, 10.0, &window(0.5, 0.9, 5)).unwrap_err(),
    ] {
        let ResponseError::OutsideWindow { omega, window } = &refused else { panic!("{refused}") };
        assert!(*omega < window[0] && *omega > 0.2 * TAU, "{omega}");
        assert!(refused.to_string().contains("Hz, outside of the window 0.5 to 0.9 Hz"), "{refused}");
    }
}

#[test]
fn a_damped_mode_reaches_its_energy_and_its_damping_is_its_power() {
    let curve = damped_mode(&rod_of_two(), 10.0, &window(0.3, 0.6, 12)).unwrap();
    assert!(curve.end.has(EndReason::MaxEnergy));
    let first = &curve.points[0];
    assert!((first.motion.damping_ratio() - 0.01).abs() < 1e-10);
    for point in &curve.points {
        let power = 2.0 * point.motion.kinetic_energy * point.motion.at.xi;
        assert!((power / point.motion.dissipated_power - 1.0).abs() < 1e-12);
    }
}

#[test]
fn curves_over_the_level_end_at_it_and_never_below_zero() {
    let curve = force_response(&rod_of_two(), 0.42 * TAU, 0.6, &window(0.3, 0.6, 10)).unwrap();
    assert!(curve.end.has(EndReason::Limit));
    assert!(curve.points.iter().all(|p| p.level >= 0.0));
    assert!(curve.points.iter().any(|p| p.events.contains(&Event::Fold)));
}

#[test]
fn a_base_that_shakes_a_rod_linearly_gives_the_exact_discrete_response() {
    // Two elements, mass as it is: (K − ω²M) u = ω² M_full r for the displacement relative to a base with amplitude
    // one.
    for (ea, rho_a, length) in [(1.0, 1.0, 1.0), (2e8, 40.0, 3.0)] {
        let gap = 1e3 * length;
        let model = rod(2, ea, rho_a, length, gap, Support::Clamped);
        let free = rod(2, ea, rho_a, length, gap, Support::Free);
        let l = length / 2.0;
        let omega = 0.7 * (ea / rho_a).sqrt() / length;
        let (k, m) = (ea / l, rho_a * l / 6.0);
        let (a, b, d) = (2.0 * k - omega * omega * 4.0 * m, -k - omega * omega * m, k - omega * omega * 2.0 * m);
        let (f, g) = (omega * omega * 6.0 * m, omega * omega * 3.0 * m);
        let expected = [(d * f - b * g) / (a * d - b * b), (a * g - b * f) / (a * d - b * b)];
        for unit in [BaseUnit::Displacement, BaseUnit::Acceleration] {
            let open = OpenModes::of_model(&model, ModeCount::Lowest(1)).unwrap();
            let all = OpenModes::of_model(&model, ModeCount::Lowest(2));
            assert!(all.is_ok());
            let base = BaseMotion::of_supports(&model, &free, DofKind::Axial, &[], unit, false).unwrap();
            // With one of two modes the rest answers statically: only the share of the first mode is exact.
            let mut response = ResponseModel::new(open.clone(), &Damping::Ratios(vec![0.0])).unwrap();
            response.push_base_motion(&base).unwrap();
            let level = if unit == BaseUnit::Displacement { 1e-6 * length } else { 1e-6 * length * omega * omega };
            let settings = window(0.9 * omega / TAU, 1.1 * omega / TAU, 3);
            let curve = force_response(&response, omega, level, &settings).unwrap();
            let eta = curve.points.last().unwrap().motion.eta[1][0];
            let inertia = [[4.0 * m, m], [m, 2.0 * m]];
            let projected: f64 =
                (0..2).map(|i| open.shapes()[(i, 0)] * (0..2).map(|j| inertia[i][j] * expected[j]).sum::<f64>()).sum();
            let exact = projected * 1e-6 * length;
            assert!((eta.re / exact - 1.0).abs() < 1e-9 && eta.im.abs() < 1e-9 * exact.abs(), "{eta} {exact}");
        }
    }
}

#[test]
fn a_shaken_base_comes_to_the_same_phase_resonance_in_both_units() {
    for (ea, rho_a, length) in [(1.0, 1.0, 1.0), (2e8, 40.0, 3.0)] {
        let gap = 1e-3 * length;
        let (model, free) =
            (rod(4, ea, rho_a, length, gap, Support::Clamped), rod(4, ea, rho_a, length, gap, Support::Free));
        let hz = (ea / rho_a).sqrt() / length / 4.0;
        let found = [BaseUnit::Displacement, BaseUnit::Acceleration].map(|unit| {
            let massless = MasslessContactModel::new(&model, &Drop).unwrap();
            let open = OpenModes::of_massless(&massless, ModeCount::Lowest(4)).unwrap();
            let mut shaken = ResponseModel::new(open, &Damping::Ratios(vec![0.02])).unwrap();
            let base = BaseMotion::of_supports(&model, &free, DofKind::Axial, &[3], unit, false).unwrap();
            shaken.push_base_motion(&base).unwrap();
            shaken.set_drive(1).unwrap();
            let level = gap * if unit == BaseUnit::Displacement { 0.2 } else { 0.2 * (TAU * hz).powi(2) };
            let curve = phase_resonance(&shaken, level, &window(0.8 * hz, 1.6 * hz, 5)).unwrap();
            assert!(curve.end.has(EndReason::Limit));
            assert!(curve.points.iter().all(|p| (p.lag() - TAU / 4.0).abs() < 1e-9));
            assert!(curve.points.iter().any(|p| p.motion.contacts[0].touches > 0));
            let first = &curve.points[0];
            (
                first.omega,
                first.drive.norm() / first.level
                    * if unit == BaseUnit::Displacement { 1.0 } else { first.omega.powi(2) },
            )
        });
        assert!(
            (found[0].0 / found[1].0 - 1.0).abs() < 1e-10 && (found[0].1 / found[1].1 - 1.0).abs() < 1e-9,
            "{found:?}"
        );
    }
}

#[test]
fn dashpots_couple_modes_and_power_still_balances() {
    let massless = MasslessContactModel::new(&rod(6, 1.0, 1.0, 1.0, 1.0, Support::Clamped), &Drop).unwrap();
    let open = OpenModes::of_massless(&massless, ModeCount::Lowest(10)).unwrap();
    let mut model = ResponseModel::new(open, &Damping::Ratios(vec![0.01])).unwrap();
    model.add_dashpots(&[Dashpot { at: vec![(2, 1.0)], damping: 0.05 }]).unwrap();
    model.push_force(2, 1.0, 1, 0.3).unwrap();
    model.set_drive(2).unwrap();
    let curve = frequency_response(&model, 0.3, &window(0.2, 0.3, 5)).unwrap();
    assert!(curve.end.complete, "{:?}", curve.end);
    assert!(curve.points.iter().any(|p| p.motion.contacts[0].touches > 0));
    for point in &curve.points {
        let balance = point.motion.input_power / point.motion.dissipated_power - 1.0;
        assert!(balance.abs() < 1e-12, "{balance:e} {:?} {:e}", point.motion.contacts, point.residual);
    }
}

#[test]
fn what_a_dashpot_moves_beyond_the_modes_is_its_constant_over_the_stiffness_left_over() {
    for (ea, rho_a, length) in [(1.0, 1.0, 1.0), (2e8, 40.0, 3.0)] {
        let massless = MasslessContactModel::new(&rod(2, ea, rho_a, length, length, Support::Clamped), &Drop).unwrap();
        let open = OpenModes::of_massless(&massless, ModeCount::Lowest(10)).unwrap();
        let model = ResponseModel::new(open, &Damping::Ratios(vec![0.01])).unwrap();
        // The tip without mass hangs on one element; the middle moves with the only mode.
        let (stiffness, damping) = (2.0 * ea / length, 0.3 * (ea * rho_a).sqrt());
        let beyond = |dof: usize| model.beyond_modes(&Dashpot { at: vec![(dof, 1.0)], damping }).unwrap();
        assert!((beyond(1) * stiffness / damping - 1.0).abs() < 1e-12);
        assert!(beyond(0).abs() < 1e-12 * damping / stiffness);
    }
}

#[test]
fn what_cannot_be_computed_is_refused() {
    let model = rod_of_two();
    let settings = window(0.3, 0.6, 5);
    assert!(matches!(frequency_response(&model, -1.0, &settings), Err(ResponseError::Setting { .. })));
    assert!(matches!(frequency_response(&model, 1.0, &window(-0.3, 0.6, 5)), Err(ResponseError::Setting { .. })));
    assert!(matches!(frequency_response(&model, 1.0, &window(0.6, 0.3, 5)), Err(ResponseError::Setting { .. })));
    let massless = MasslessContactModel::new(&rod(2, 1.0, 1.0, 1.0, 1.0, Support::Clamped), &Drop).unwrap();
    let open = OpenModes::of_massless(&massless, ModeCount::Lowest(10)).unwrap();
    let bare = ResponseModel::new(open, &Damping::Ratios(vec![0.01])).unwrap();
    assert!(matches!(frequency_response(&bare, 1.0, &settings), Err(ResponseError::NoLoad)));
    assert!(matches!(phase_resonance(&bare, 1.0, &settings), Err(ResponseError::NoDrive)));
}
