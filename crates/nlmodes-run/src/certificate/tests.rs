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
         [method]\nharmonics = {harmonics}\n[continuation]\nmax_energy_ratio = 1.5\n",
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
    Certificate::of(
        &computed,
        Sources { scene: &scene, open: None, shift: None, thorough, watch: &Watch::default() },
        &mut |_, _, _| true,
    )
}

const SI: [f64; 2] = [1.0, 1.0];

fn check<'a>(certificate: &'a Certificate, name: &str, number: Number) -> &'a Check {
    certificate.checks.iter().find(|c| c.name == name && c.number.is_none_or(|n| n == number)).unwrap()
}

fn usable(certificate: &Certificate, number: Number) -> &NumberUse {
    certificate.numbers.iter().find(|n| n.number == number).unwrap()
}

#[test]
fn what_was_not_asked_for_is_said_and_nothing_speaks_for_the_force() {
    let plain = certificate(2, 5, SI, false);
    for name in ["equations", "contact law", "modes"] {
        assert_eq!(check(&plain, name, Number::Frequency).outcome, CheckOutcome::Good, "{plain:?}");
    }
    for name in ["return after a period", "exact motion", "harmonics"] {
        let check = check(&plain, name, Number::Displacement);
        assert_eq!((check.outcome, check.value), (CheckOutcome::NotLookedAt, None));
        assert!(check.how.is_some(), "{check:?}");
    }
    let force = usable(&plain, Number::PeakForce);
    assert_eq!((force.usable, force.largest_change), (Use::NotShown, None));
    assert!(plain.verdict.contains("nothing speaks for: "), "{}", plain.verdict);
}

#[test]
fn few_harmonics_spoil_the_force_and_many_do_not() {
    let poor = certificate(4, 2, SI, true);
    let force = usable(&poor, Number::PeakForce);
    assert_eq!(force.usable, Use::No, "{poor:?}");
    assert!(force.words.contains("the impulse is not good either"), "{force:?}");
    assert_eq!(check(&poor, "harmonics", Number::PeakForce).outcome, CheckOutcome::Doubtful);
    let fine = certificate(4, 60, SI, true);
    for name in ["energy", "return after a period"] {
        assert_eq!(check(&fine, name, Number::Displacement).outcome, CheckOutcome::Good, "{name}: {fine:?}");
    }
    for number in [Number::Impulse, Number::PeakForce] {
        assert_eq!(usable(&fine, number).usable, Use::Yes, "{fine:?}");
        assert_eq!(check(&fine, "exact motion", number).outcome, CheckOutcome::Good);
    }
    // What is found falls with the harmonics, of whatever it is found.
    for (name, number) in
        [("energy", Number::Displacement), ("harmonics", Number::PeakForce), ("harmonics", Number::Frequency)]
    {
        let [few, many] = [&poor, &fine].map(|c| check(c, name, number).value.unwrap());
        assert!(many < 0.1 * few, "{name}: {few:e} {many:e}");
    }
}

#[test]
fn the_mesh_is_judged_by_the_frequencies_of_discrete_rods() {
    // ω h/c = √(6 (1 − cos κh)/(2 + cos κh)) with κ = π/2 over the length.
    let omega = |n: f64| {
        let cos = (PI / (2.0 * n)).cos();
        n * (6.0 * (1.0 - cos) / (2.0 + cos)).sqrt()
    };
    for (elements, expected) in [(2, CheckOutcome::Doubtful), (40, CheckOutcome::Good)] {
        let found = mesh::frequency(&scene(elements, 1, SI));
        let n = elements as f64;
        let change = omega(n) / omega(2.0 * n) - 1.0;
        assert!((found.value.unwrap() / change - 1.0).abs() < 1e-6, "{found:?} {change:e}");
        assert_eq!(found.outcome, expected);
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
    assert_eq!(
        si.numbers.iter().map(|n| n.usable).collect::<Vec<_>>(),
        mm.numbers.iter().map(|n| n.usable).collect::<Vec<_>>()
    );
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
fn too_few_held_modes_are_doubted_and_enough_are_not() {
    let scene = scene(12, 5, SI);
    let computed = branch(&scene, BranchStart::Grazing);
    let model = computed.structure.model().clone();
    for (kept, expected) in [(3, CheckOutcome::Doubtful), (10, CheckOutcome::Good)] {
        let settings = BranchSettings { held_modes: Some(kept), ..branch_settings(&scene) };
        let few = compute_branch(model.clone(), &settings, |_| ControlFlow::Continue(())).unwrap();
        let sources = Sources { scene: &scene, open: None, shift: None, thorough: true, watch: &Watch::default() };
        let checks = finer::modes(&few, &few_points(&few), sources, &mut |_, _, _| true);
        let force = checks.iter().find(|c| c.number == Some(Number::PeakForce)).unwrap();
        assert_eq!(force.outcome, expected, "{kept}: {checks:?}");
    }
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

/// If a check fails for the largest force only, the impulse can be used; if none was made, it is not mentioned.
#[test]
fn the_impulse_is_recommended_only_where_it_is_good() {
    let check = |number: Number, value: f64| Check::found("harmonics", Some(number), value, number.limit(), "");
    let both = |force: f64, impulse: f64| [check(Number::PeakForce, force), check(Number::Impulse, impulse)];
    let good = NumberUse::new(Number::PeakForce, &both(0.3, 1e-3));
    assert_eq!((good.usable, good.largest_change), (Use::No, Some(0.3)));
    assert!(good.words.contains("use that"), "{}", good.words);
    assert!(!NumberUse::new(Number::PeakForce, &both(0.3, 0.3)).words.contains("use that"));
    assert_eq!(NumberUse::new(Number::PeakForce, &both(1e-3, 0.3)).usable, Use::Yes);
    assert_eq!(NumberUse::new(Number::PeakForce, &both(f64::NAN, 1e-3)).usable, Use::No);
    // What holds for all numbers counts against each.
    let unsolved = [residual([0.0, 1.0, 1e-12].into_iter()), check(Number::PeakForce, 0.0)];
    assert_eq!((unsolved[0].point, &unsolved[0].failed), (Some(1), &vec![1]));
    assert_eq!(NumberUse::new(Number::PeakForce, &unsolved).usable, Use::No);
}

#[test]
fn the_points_that_did_not_pass_are_named_and_so_is_how_many_were_looked_at() {
    let (scene, force) = (scene(4, 2, SI), Number::PeakForce);
    let computed = branch(&scene, BranchStart::Grazing);
    let sources = Sources { scene: &scene, open: None, shift: None, thorough: true, watch: &Watch::default() };
    let poor = Certificate::of(&computed, sources, &mut |_, _, _| true);
    let (all, doubted) = (computed.branch.points.len(), &poor.points_in_doubt);
    assert!(!doubted.is_empty() && doubted.iter().all(|doubt| poor.points.contains(&doubt.place)), "{poor:?}");
    // Each by its own numbers: a point whose force changes beyond the limit is named, one within it is not.
    for &Place { point, frequency_hz, energy_j } in &poor.points {
        let found = &computed.branch.points[point];
        assert_eq!((frequency_hz, energy_j), (found.omega / (2.0 * PI), Some(found.kinetic_energy)));
        let after = computed.refined(point, 4, &computed.structure).unwrap();
        let before = computed.branch.points[point].peak_contact_force;
        let floor = 1e-2 * computed.branch.points.iter().map(|p| p.peak_contact_force).fold(0.0, f64::max);
        let off = after.map(|after| (before - after.peak_contact_force).abs() / after.peak_contact_force.max(floor));
        let named = doubted.iter().any(|d| d.place.point == point && d.against.iter().any(|a| a.contains("harmonics")));
        assert!(named || off.is_some_and(|off| off <= force.limit()), "point {point}: {off:?}, {doubted:?}");
    }
    let looked = poor.points.len();
    let said = if looked == all { format!("all {all} points") } else { format!("{looked} of {all} points") };
    assert!(poor.verdict.contains(&said) && poor.verdict.contains("did not pass"), "{}", poor.verdict);
    // The head of the page has the same verdicts, and nothing if no number is rejected.
    let warning = poor.not_to_use(Some("the coarse one")).unwrap();
    assert!(warning.starts_with("Do not use of the coarse one: ") && warning.contains(force.meaning()), "{warning}");
    assert_eq!(Certificate { numbers: vec![], ..poor.clone() }.not_to_use(None), None);
    // For numbers not shown it states how to have them checked, if possible.
    let quick = Certificate::of(&computed, Sources { thorough: false, ..sources }, &mut |_, _, _| true);
    let open = quick.open(None).unwrap();
    let number = quick.numbers.iter().find(|number| number.usable == Use::NotShown).unwrap();
    assert!(open.contains(number.number.meaning()) && open.ends_with("; `run --certify` looks at them."), "{open}");
    assert!(poor.open(None).is_none_or(|open| !open.contains("--certify")), "{:?}", poor.open(None));
    // The observer may end it: checks that were not made state this.
    let ended = Certificate::of(&computed, sources, &mut |_, _, _| false);
    assert_eq!(check(&ended, "harmonics", Number::Frequency).outcome, CheckOutcome::NotLookedAt);
}

#[test]
fn points_that_touch_no_stop_say_nothing_of_forces() {
    // At grazing, the first point, there is no force.
    let fine = certificate(4, 10, SI, true);
    let looked = |number: Number| check(&fine, "harmonics", number).looked.clone();
    assert!(looked(Number::Frequency).contains(&0));
    for number in [Number::Impulse, Number::PeakForce] {
        assert_eq!(looked(number), looked(Number::Frequency)[1..], "{number:?}");
        let words = &check(&fine, "harmonics", number).words;
        assert!(words.contains("1 of them touch no stop"), "{words}");
    }
    let number = usable(&certificate(4, 2, SI, true), Number::PeakForce).words.clone();
    let at = number.split("at point ").nth(1).unwrap_or_default();
    assert!(at.contains(" Hz, ") && at.contains(" J)"), "a point is found by its frequency and energy: {number}");
}

#[test]
fn whoever_watches_ends_a_check_within_its_points() {
    let scene = scene(4, 4, SI);
    let computed = branch(&scene, BranchStart::Grazing);
    let watch = Watch::new(|_, _| ControlFlow::Break(()));
    let sources = Sources { scene: &scene, open: None, shift: None, thorough: true, watch: &watch };
    // There is no cancellation between points.
    let ended = Certificate::of(&computed, sources, &mut |_, _, _| true);
    for (name, number) in [("harmonics", Number::Frequency), ("return after a period", Number::Displacement)] {
        let check = check(&ended, name, number);
        assert_eq!((check.outcome, check.words.as_str()), (CheckOutcome::NotLookedAt, BROKEN_OFF), "{check:?}");
    }
}

#[test]
fn changes_are_said_in_per_cent_as_far_as_that_is_read() {
    let said = [0.0, 1e-8, 8.6e-4, 6.7e-3, 2.6e-2, 0.128, 3.0].map(share);
    assert_eq!(said, ["0", "1e-8", "0.09 %", "0.67 %", "2.6 %", "13 %", "300 %"]);
}
