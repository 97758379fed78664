use std::f64::consts::PI;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, BranchStart, ComputedBranch, compute_branch};

use super::*;
use crate::settings::branch_settings;

/// A rod with a stop, with this many elements and harmonics, its lengths in `length` m and its masses in `mass` kg.
fn scene(elements: usize, harmonics: usize, [length, mass]: [f64; 2]) -> Scene {
    let (e, density, area) = (210e9 * length / mass, 7800.0 * length.powi(3) / mass, 1e-4 / length.powi(2));
    let text = format!(
        "[structure]\nkind = \"rod\"\nlength_m = {}\nelements = {elements}\nstart = \"clamped\"\n\
         material = {{ youngs_modulus_pa = {e:e}, density_kg_m3 = {density:e} }}\nsection = {{ area_m2 = {area:e} }}\n\
         [[contact]]\nat_m = {}\ndirection = \"axial\"\nside = \"positive\"\ngap_m = {:e}\n\
         [method]\nharmonics = {harmonics}\nmass_redistribution = \"drop\"\n[continuation]\nmax_energy_ratio = 1.5\n",
        1.0 / length,
        1.0 / length,
        1e-3 / length
    );
    let mut files =
        nlmodes_scene::parse_each_method("rod.toml", &text, &[]).map_err(|refused| refused.text(false)).unwrap();
    files.swap_remove(0).scene
}

fn branch(scene: &Scene, start: BranchStart) -> ComputedBranch {
    let model = nlmodes_scene::assemble::structural_model(scene).unwrap();
    let massless = nlmodes_scene::assemble::contact_model(scene, &model).unwrap();
    let settings = BranchSettings { start, ..branch_settings(scene) };
    compute_branch(massless, &settings, |_| ControlFlow::Continue(())).unwrap()
}

fn certificate(elements: usize, harmonics: usize, units: [f64; 2], thorough: bool) -> Certificate {
    let scene = scene(elements, harmonics, units);
    let computed = branch(&scene, BranchStart::Grazing);
    Certificate::of(&computed, sources(&scene, thorough, &Watch::default()), &mut |_, _, _| true)
}

fn sources<'a>(scene: &'a Scene, thorough: bool, watch: &'a Watch) -> Sources<'a> {
    Sources { scene, open: None, shift: None, thorough, points_time: Duration::from_secs(60), watch }
}

const SI: [f64; 2] = [1.0, 1.0];

fn check<'a>(certificate: &'a Certificate, name: &str, number: Number) -> &'a Check {
    certificate.checks.iter().find(|c| c.name == name && c.number.is_none_or(|n| n == number)).unwrap()
}

fn error(certificate: &Certificate, number: Number) -> &NumberError {
    certificate.errors.iter().find(|error| error.number == number).unwrap()
}

#[test]
fn a_plain_run_estimates_all_errors_and_says_which_checks_were_not_made() {
    let plain = certificate(2, 5, SI, false);
    for name in ["equations", "contact law"] {
        assert_eq!(check(&plain, name, Number::Frequency).outcome, CheckOutcome::Good, "{plain:?}");
    }
    for name in ["return after a period", "exact motion"] {
        let check = check(&plain, name, Number::Displacement);
        assert_eq!((check.outcome, check.value), (CheckOutcome::NotMade, None));
        assert!(check.how.is_some(), "{check:?}");
    }
    assert!(plain.errors.iter().all(|error| error.estimate.is_some_and(|error| error > 0.0)), "{plain:?}");
    assert!(plain.points.len() <= 3 && plain.warning(None).is_none(), "{}", plain.verdict);
    // Two elements say more of the frequency than five harmonics do.
    let frequency = error(&plain, Number::Frequency);
    assert_eq!(frequency.source.as_ref().map(|source| source.kind), Some(SourceKind::Mesh), "{frequency:?}");
    assert!(plain.verdict.contains("--set structure.elements=4, --set method.harmonics=10"), "{}", plain.verdict);
}

/// What is estimated is what a branch with many more harmonics shows, within a factor of three.
#[test]
fn errors_are_those_against_many_more_harmonics() {
    let (scene, mut compared) = (scene(4, 3, SI), 0);
    let computed = branch(&scene, BranchStart::Grazing);
    let found = Certificate::of(&computed, sources(&scene, true, &Watch::default()), &mut |_, _, _| true);
    let many = |k: usize| computed.refined(k, 48, &computed.structure).unwrap();
    let harmonics = |number| check(&found, "harmonics", number);
    for (number, of) in [
        (Number::Frequency, (|point: &ModalPoint| point.omega) as fn(&ModalPoint) -> f64),
        (Number::Impulse, |point| point.contacts[0].impulse),
        (Number::PeakForce, |point| point.peak_contact_force),
    ] {
        for (k, estimate) in harmonics(number).looked.iter().filter(|(k, _)| *k > 0) {
            let Some(fine) = many(*k) else { continue };
            let true_error = (of(&computed.branch.points[*k]) / of(&fine) - 1.0).abs();
            let near = *estimate > true_error / 3.0 - 1e-9 && *estimate < 3.0 * true_error + 1e-9;
            // Near grazing forces count by the largest of the branch.
            compared += usize::from(near);
            assert!(near || *estimate < true_error, "{number:?} {k}: {estimate:e} {true_error:e}");
        }
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn errors_fall_with_the_harmonics() {
    let [poor, fine] = [2, 60].map(|harmonics| certificate(4, harmonics, SI, true));
    let value = |of: &Certificate, name, number| check(of, name, number).value.unwrap();
    for (name, number) in [
        ("energy", Number::Displacement),
        ("return after a period", Number::Displacement),
        ("harmonics", Number::PeakForce),
        ("harmonics", Number::Frequency),
        ("exact motion", Number::Impulse),
    ] {
        let [few, many] = [&poor, &fine].map(|of| value(of, name, number));
        assert!(many < 0.1 * few, "{name}: {few:e} {many:e}");
    }
    for number in [Number::Impulse, Number::PeakForce] {
        let [few, many] = [&poor, &fine].map(|of| error(of, number).estimate.unwrap());
        assert!(few > 0.05 && many < 0.05, "{number:?}: {few:e} {many:e}");
    }
}

#[test]
fn the_mesh_is_judged_by_the_frequencies_of_discrete_rods() {
    // ω h/c = √(6 (1 − cos κh)/(2 + cos κh)) with κ = π/2 over the length.
    let omega = |n: f64| {
        let cos = (PI / (2.0 * n)).cos();
        n * (6.0 * (1.0 - cos) / (2.0 + cos)).sqrt()
    };
    for elements in [2, 40] {
        let found = mesh::frequency(&scene(elements, 1, SI), None);
        let n = elements as f64;
        let change = omega(n) / omega(2.0 * n) - 1.0;
        assert!((found.value.unwrap() / change - 1.0).abs() < 1e-6, "{found:?} {change:e}");
    }
}

#[test]
fn a_certificate_is_the_same_in_millimetres_and_tonnes() {
    let [si, mm] = [SI, [1e-3, 1e3]].map(|units| certificate(3, 4, units, true));
    for (a, b) in si.checks.iter().zip(&mm.checks) {
        assert_eq!((a.name, a.number, a.outcome), (b.name, b.number, b.outcome), "{a:?} {b:?}");
        // Below 1e-8 values are rounding.
        let [a, b] = [a, b].map(|c| c.value.unwrap_or(0.0));
        assert!((a - b).abs() < 1e-5 * a + 1e-8, "{a:e} {b:e}");
    }
    let kinds = |of: &Certificate| -> Vec<_> {
        of.errors.iter().map(|error| error.source.as_ref().map(|source| source.kind)).collect()
    };
    assert_eq!(kinds(&si), kinds(&mm));
}

#[test]
fn a_point_solved_with_more_harmonics_is_that_of_a_branch_with_them() {
    let computed = branch(&scene(3, 4, SI), BranchStart::Grazing);
    let k = computed.branch.points.len() / 2;
    let point = &computed.branch.points[k];
    let refined = computed.refined(k, 8, &computed.structure).unwrap().unwrap();
    let ratio = point.kinetic_energy / computed.grazing.energy;
    let other = branch(&scene(3, 8, SI), BranchStart::Energy { ratio, upward: true });
    let own = &other.branch.points[0];
    assert!((refined.omega / own.omega - 1.0).abs() < 1e-9, "{} {}", refined.omega, own.omega);
    assert!((refined.peak_contact_force / own.peak_contact_force - 1.0).abs() < 1e-6);
    assert!((refined.omega / point.omega - 1.0).abs() > 1e-9, "more harmonics change it");
}

#[test]
fn the_point_at_grazing_is_none_at_which_more_harmonics_are_tried_unasked() {
    let computed = branch(&scene(3, 4, SI), BranchStart::Grazing);
    let own = finer::switching(&computed.branch.points);
    assert_eq!(own, (1..computed.branch.points.len()).collect::<Vec<usize>>());
}

#[test]
fn too_few_held_modes_are_an_error_and_enough_are_not() {
    let scene = scene(12, 5, SI);
    let computed = branch(&scene, BranchStart::Grazing);
    let model = computed.structure.model().clone();
    let [few, enough] = [3, 10].map(|kept| {
        let settings = BranchSettings { held_modes: Some(kept), ..branch_settings(&scene) };
        let few = compute_branch(model.clone(), &settings, |_| ControlFlow::Continue(())).unwrap();
        let watch = Watch::default();
        let checks = finer::modes(&few, &few_points(&few), sources(&scene, true, &watch), &mut |_, _, _| true);
        let force = checks.iter().find(|check| check.number == Some(Number::PeakForce));
        force.and_then(|check| check.value).unwrap_or_else(|| panic!("{checks:?}"))
    });
    assert!(few > 0.05 && enough < 0.05, "{few:e} {enough:e}");
}

#[test]
fn a_force_that_pulls_and_a_gap_that_is_negative_break_the_contact_law() {
    let computed = branch(&scene(3, 4, SI), BranchStart::Grazing);
    let last = computed.branch.points.len() - 1;
    let motions = nlmodes::branches::Histories::of(&computed).at(last, 256, "").unwrap();
    let strongest = computed.branch.points[last].peak_contact_force;
    assert!(contacts::violation(&computed, strongest, &motions) < 1e-9);
    let mut pulls = motions.clone();
    pulls[0].force.iter_mut().for_each(|f| *f = -*f);
    assert!(contacts::violation(&computed, strongest, &pulls) > 0.9);
    let mut through = motions;
    through[0].displacement.iter_mut().for_each(|q| *q *= 1.1);
    assert!(contacts::violation(&computed, strongest, &through) > 0.05);
}

fn estimate(kind: SourceKind, number: Number, values: &[(usize, f64)]) -> Check {
    let source = ErrorSource { kind, name: format!("{kind:?}"), command: format!("--less-{kind:?}") };
    let largest = values.iter().fold(0.0_f64, |most, (_, value)| most.max(*value));
    Check { looked: values.to_vec(), ..Check::estimate("check", (number, source), largest, "") }
}

fn places(n: usize) -> Vec<Place> {
    (0..n).map(|point| Place { point, frequency_hz: 50.0 + point as f64, energy_j: None }).collect()
}

#[test]
fn errors_of_different_kinds_add_as_independent_ones_and_of_one_kind_the_largest_counts() {
    let force = Number::PeakForce;
    let checks = [
        estimate(SourceKind::Harmonics, force, &[(0, 1e-3), (4, 3e-2)]),
        estimate(SourceKind::Harmonics, force, &[(0, 2e-3), (4, 1e-2)]),
        Check { looked: Vec::new(), ..estimate(SourceKind::Mesh, force, &[(0, 4e-2)]) },
    ];
    let found = NumberError::new(force, &checks, &places(5), &Requirement::default());
    assert!((found.estimate.unwrap() - 5e-2).abs() < 1e-12, "{found:?}");
    assert_eq!((found.command.as_deref(), found.met.as_ref()), (Some("--less-Mesh"), None));
    assert_eq!(numbers::all(&[found]), "largest contact force ±5.0 % (Mesh)");
    // Without a comparison of harmonics an error is not known.
    let unknown = NumberError::new(force, &checks[2..], &places(5), &Requirement::default());
    assert!(unknown.estimate.is_none() && unknown.text().contains("not known"), "{unknown:?}");
    let impulse = NumberError::new(Number::Impulse, &checks, &places(5), &Requirement::default());
    assert_eq!(impulse.estimate, None);
}

#[test]
fn a_required_error_is_met_by_stretches() {
    let values = [(0, 1e-4), (1, 2e-3), (2, 5e-3), (3, 1e-4), (4, 1e-4)];
    let checks = [estimate(SourceKind::Harmonics, Number::Frequency, &values)];
    let required = |frequency| Requirement { frequency: Some(frequency), ..Requirement::default() };
    let found = NumberError::new(Number::Frequency, &checks, &places(5), &required(1e-3));
    let met = found.met.clone().unwrap();
    assert_eq!((met.everywhere, met.share, met.except_hz), (false, 0.6, vec![[51.0, 52.0]]));
    assert_eq!(found.beyond, [1, 2]);
    assert!(found.text().ends_with("met at 60 % of the compared points, not at 51 to 52 Hz"), "{}", found.text());
    let met = NumberError::new(Number::Frequency, &checks, &places(5), &required(1e-2)).met.unwrap();
    assert_eq!((met.everywhere, met.share, met.except_hz), (true, 1.0, vec![]));
    let whole = Certificate::new(&places(5), checks.to_vec(), &required(1e-3));
    assert!(whole.warning(Some("one")).unwrap().starts_with("Not met of one: frequency ±0.50 %"), "{whole:?}");
    assert_eq!(whole.points_in_doubt.iter().map(|doubt| doubt.place.point).collect::<Vec<_>>(), [1, 2]);
}

#[test]
fn equations_that_do_not_hold_are_a_warning() {
    let unsolved = residual([0.0, 1.0, 1e-12].into_iter());
    assert_eq!((unsolved.worst(), unsolved.outcome), (Some(1), CheckOutcome::Doubtful));
    let found = Certificate::new(&places(3), vec![unsolved], &Requirement::default());
    let warning = found.warning(None).unwrap();
    assert!(warning.contains("equations: 100 % at point 1 (51 Hz)"), "{warning}");
    let solved = Certificate::new(&places(3), vec![residual([0.0, 1e-12].into_iter())], &Requirement::default());
    assert_eq!(solved.warning(None), None);
}

#[test]
fn who_ends_the_checks_reads_that_they_were_not_made() {
    let scene = scene(4, 2, SI);
    let computed = branch(&scene, BranchStart::Grazing);
    let ended = Certificate::of(&computed, sources(&scene, true, &Watch::default()), &mut |_, _, _| false);
    assert_eq!(check(&ended, "harmonics", Number::Frequency).outcome, CheckOutcome::NotMade);
    assert!(ended.errors.iter().all(|error| error.estimate.is_none() && error.why == BROKEN_OFF), "{ended:?}");
}

#[test]
fn points_that_touch_no_stop_say_nothing_of_forces() {
    // At grazing, the first point, there is no force.
    let fine = certificate(4, 10, SI, true);
    let looked = |number: Number| -> Vec<usize> {
        check(&fine, "harmonics", number).looked.iter().map(|(point, _)| *point).collect()
    };
    assert!(looked(Number::Frequency).contains(&0));
    for number in [Number::Impulse, Number::PeakForce] {
        assert_eq!(looked(number), looked(Number::Frequency)[1..], "{number:?}");
        let words = &check(&fine, "harmonics", number).words;
        assert!(words.contains("1 of them touch no stop"), "{words}");
    }
}

#[test]
fn whoever_watches_ends_a_check_within_its_points() {
    let scene = scene(4, 4, SI);
    let computed = branch(&scene, BranchStart::Grazing);
    let watch = Watch::new(|_, _| ControlFlow::Break(()));
    let sources = sources(&scene, true, &watch);
    // There is no cancellation between points.
    let ended = Certificate::of(&computed, sources, &mut |_, _, _| true);
    for (name, number) in [("harmonics", Number::Frequency), ("return after a period", Number::Displacement)] {
        let check = check(&ended, name, number);
        assert_eq!((check.outcome, check.words.as_str()), (CheckOutcome::NotMade, BROKEN_OFF), "{check:?}");
    }
}

#[test]
fn changes_are_said_in_per_cent_as_far_as_that_is_read() {
    let said = [0.0, 1e-8, 8.6e-4, 6.7e-3, 2.6e-2, 0.128, 3.0].map(share);
    assert_eq!(said, ["0", "1e-6 %", "0.09 %", "0.67 %", "2.6 %", "13 %", "300 %"]);
}

#[test]
fn small_motions_do_not_stand_for_large_ones_that_have_no_motion_to_compare_with() {
    let place = |point: usize| Place { point, frequency_hz: 20.0, energy_j: None };
    let source = ErrorSource { kind: SourceKind::Harmonics, name: "7 harmonics".to_owned(), command: String::new() };
    let checks = |sizes: [f64; 2], lost: usize| {
        let mut compared = finer::Compared::default();
        compared.take(place(1), sizes, Some([Some(1e-6); 4]));
        (2..2 + lost).for_each(|k| compared.take(place(k), [20.0, 1e-3], None));
        compared.checks(("harmonics", "", source.clone()), |_, _| String::new())
    };
    for small in [[0.1, 1e-3], [20.0, 1e-5]] {
        assert!(checks(small, 9).iter().all(|check| check.value.is_none() && check.words.contains("no motion")));
        assert!(checks(small, 0).iter().all(|check| check.value == Some(1e-6)));
    }
    assert!(checks([11.0, 1e-3], 9).iter().all(|check| check.value == Some(1e-6)));
}
