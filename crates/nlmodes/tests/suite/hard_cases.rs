//! Cases at the limits of numbers that are quick; all of them: `cargo run --example hard_cases` in `benchmarks`.

use nlmodes::modal::{BranchEnd, EndReason, Event};
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use nlmodes::branches::{BranchError, BranchSettings, ComputedBranch, ResonanceRule, compute_branch};
use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes::hbm::{HbmError, Switching};
use nlmodes::linalg::{Triplet, sparse_from_triplets};
use nlmodes::model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};

/// Masses in a row, the first held by a wall.
fn chain(masses: &[f64], springs: &[f64], contacts: Vec<Contact>) -> StructuralModel {
    let n = masses.len();
    let m: Vec<Triplet> = masses.iter().enumerate().filter(|(_, m)| **m > 0.0).map(|(i, m)| (i, i, *m)).collect();
    let mut k: Vec<Triplet> = Vec::new();
    for (i, &spring) in springs.iter().enumerate() {
        k.push((i, i, spring));
        if i > 0 {
            k.extend([(i - 1, i - 1, spring), (i - 1, i, -spring), (i, i - 1, -spring)]);
        }
    }
    let dofs = (0..n).map(|node| Dof { node, position: (node + 1) as f64, kind: DofKind::Axial }).collect();
    let matrix = |entries: &[Triplet]| sparse_from_triplets(n, n, entries).unwrap();
    StructuralModel::new(matrix(&m), matrix(&k), dofs, contacts).unwrap()
}

fn massless(model: &StructuralModel) -> MasslessContactModel {
    MasslessContactModel::new(model, &Drop).unwrap()
}

/// The rod of Section 3 with stops of the given position over length, side and gap.
fn rod(elements: usize, stops: &[(f64, Side, f64)]) -> MasslessContactModel {
    let rod = Rod {
        material: Material::new(210e9, 9000.0).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(20.0, elements).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    massless(&rod.assemble(&placed(stops, 20.0, Direction::Axial)).unwrap())
}

fn beam(elements: usize, stops: &[(f64, Side, f64)]) -> MasslessContactModel {
    let beam = Beam {
        material: Material::new(210e9, 7850.0).unwrap(),
        section: Section::rectangle(0.012, 0.02).unwrap(),
        mesh: Mesh::uniform(0.63, elements).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    massless(&beam.assemble(&placed(stops, 0.63, Direction::Transverse)).unwrap())
}

fn placed(stops: &[(f64, Side, f64)], length: f64, direction: Direction) -> Vec<Stop> {
    stops.iter().map(|&(at, side, gap)| Stop::rigid(at * length, direction, side, gap)).collect()
}

fn try_follow(model: MasslessContactModel, ratio: f64, harmonics: usize) -> Result<ComputedBranch, BranchError> {
    let internal_resonance = ResonanceRule::Follow;
    let settings =
        BranchSettings { harmonics, max_energy_ratio: Some(ratio), internal_resonance, ..BranchSettings::default() };
    compute_branch(model, &settings, |_| ControlFlow::Continue(()))
}

/// The branch to `ratio` times the energy of its start, which it reaches, with nothing pulling or penetrating.
fn follow(model: MasslessContactModel, ratio: f64, harmonics: usize) -> ComputedBranch {
    let computed = try_follow(model, ratio, harmonics).unwrap();
    assert_eq!(computed.branch.end.reasons, [EndReason::MaxEnergy], "{}", computed.branch.end.message);
    let mut problem = computed.problem(0).unwrap();
    for (point, x) in computed.branch.points.iter().zip(&computed.unknowns) {
        assert!(point.residual <= 1e-10, "{:e}", point.residual);
        assert!(problem.check_contact(x, 64).unwrap().complementarity < 1e-9);
    }
    drop(problem);
    computed
}

fn last_hz(computed: &ComputedBranch) -> f64 {
    computed.branch.points.last().unwrap().omega / TAU
}

/// First frequency of the rod of `n` consistent elements with its tip held, Hz.
fn held_rod(n: usize) -> f64 {
    let (l, kappa) = (20.0 / n as f64, PI / n as f64);
    (6.0 * 210e9 / (9000.0 * l * l) * (2.0 - 2.0 * kappa.cos()) / (4.0 + 2.0 * kappa.cos())).sqrt() / TAU
}

#[test]
fn before_a_stop_that_touches_the_frequency_is_that_of_two_half_periods_at_every_energy() {
    // A mass and an elastic stop: ω = 2 ω₁ ω₂/(ω₁ + ω₂), by conventional harmonic balance.
    for k_c in [1e-2, 1.0, 8.0] {
        let model = chain(&[1.0], &[1.0], vec![Contact::elastic(0, Side::Positive, 0.0, k_c)]);
        let computed = follow(MasslessContactModel::with_spring_tips(&model, None).unwrap(), 100.0, 60);
        let stiff = (1.0 + k_c).sqrt();
        for point in &computed.branch.points {
            assert!((point.omega / (2.0 * stiff / (1.0 + stiff)) - 1.0).abs() < 1e-9, "{k_c}: {}", point.omega);
        }
        assert_eq!(computed.branch.points[0].events, [Event::Start]);
        // Nothing else gives an energy: that of the start is 1 J, up to the residual that counts as none.
        assert!((computed.branch.points[0].kinetic_energy - 1.0).abs() < 1e-10);
    }
    // The rod of two elements before a rigid stop: ω² = 6 off it, 12 at it.
    let model = chain(&[1.0 / 3.0, 0.0], &[2.0, 2.0], vec![Contact::rigid(1, Side::Positive, 0.0)]);
    let [off, at] = [6.0_f64.sqrt(), 12.0_f64.sqrt()];
    for point in &follow(massless(&model), 4.0, 60).branch.points {
        assert!((point.omega / (2.0 * off * at / (off + at)) - 1.0).abs() < 1e-10, "{}", point.omega);
        // The halves of a period share it like their lengths.
        assert!((point.contact_fraction / (off / (off + at)) - 1.0).abs() < 1e-4, "{}", point.contact_fraction);
    }
}

#[test]
fn stops_that_touch_on_both_sides_hold_the_node() {
    let computed = follow(rod(20, &[(1.0, Side::Positive, 0.0), (1.0, Side::Negative, 0.0)]), 3.0, 3);
    assert!(computed.branch.points.iter().all(|p| (p.omega / TAU / held_rod(20) - 1.0).abs() < 1e-10));
}

#[test]
fn the_branch_of_a_gap_leads_to_that_without_as_the_energy_grows() {
    let flat = last_hz(&follow(rod(20, &[(1.0, Side::Positive, 0.0)]), 1.1, 1));
    // The gap counts as its share of the amplitude: f(E) = f(∞) − a/√E + …, so each hundredfold energy takes a tenth of
    // the difference.
    let off = [1e2, 1e4].map(|ratio| flat - last_hz(&follow(rod(20, &[(1.0, Side::Positive, 0.5)]), ratio, 1)));
    assert!((off[0] / off[1] / 10.0 - 1.0).abs() < 0.05, "{off:?}");
}

#[test]
fn a_stop_that_touches_beside_one_with_a_gap_starts_below_the_other() {
    let computed = follow(rod(20, &[(1.0, Side::Positive, 0.0), (0.5, Side::Negative, 1e-3)]), 20.0, 3);
    let points = &computed.branch.points;
    let change = points.iter().position(|p| p.has_event(Event::ContactChange)).unwrap();
    // Until the other stop is met, nothing but the amplitude changes.
    assert!(change > 1 && points[..change].iter().all(|p| (p.omega / points[0].omega - 1.0).abs() < 1e-10));
    assert!(last_hz(&computed) > points[0].omega / TAU * 1.01);
}

#[test]
fn a_pressed_beam_gets_off_its_stop_in_few_points() {
    let computed = follow(beam(20, &[(1.0, Side::Positive, -1e-3)]), 20.0, 5);
    let points = &computed.branch.points;
    // (5000 points did not leave the held mode when lengths were scaled by what moves a contact that is held.)
    assert!(points.len() < 400, "{}", points.len());
    // Where the force vanishes for an instant, rounding of 1e-14 opens the contact for its root.
    assert!(points[0].contact_fraction > 1.0 - 1e-6, "{}", points[0].contact_fraction);
    // Softer than held, stiffer than before a stop that just touches.
    let flat = last_hz(&follow(beam(20, &[(1.0, Side::Positive, 0.0)]), 1.1, 5));
    let [first, last] = [points[0].omega / TAU, last_hz(&computed)];
    assert!(flat < last && last < first, "{flat} {last} {first}");
}

#[test]
fn a_gap_of_a_nanometre_is_a_gap() {
    for (harmonics, ratio) in [(1, 20.0), (3, 5.0)] {
        let [tiny, large] = [1e-9, 0.5].map(|gap| follow(rod(20, &[(1.0, Side::Positive, gap)]), ratio, harmonics));
        assert!((last_hz(&tiny) / last_hz(&large) - 1.0).abs() < 1e-12);
        let fraction = |c: &ComputedBranch| c.branch.points.last().unwrap().contact_fraction;
        assert!((fraction(&tiny) - fraction(&large)).abs() < 1e-9);
    }
}

#[test]
fn springs_a_million_times_stiffer_make_one_mass_of_two() {
    let contact = |dof| vec![Contact::rigid(dof, Side::Positive, 1.0)];
    let merged = last_hz(&follow(massless(&chain(&[2.0, 2.0, 0.0], &[1.0; 3], contact(2))), 3.0, 5));
    for stiff in [1e6, 1e12] {
        let model = chain(&[1.0, 1.0, 1.0, 1.0, 0.0], &[1.0, stiff, 1.0, stiff, 1.0], contact(4));
        let found = last_hz(&follow(massless(&model), 3.0, 5));
        // What the spring yields, and what 1 + s keeps of 1 in the matrix itself.
        assert!((found / merged - 1.0).abs() < 2.0 / stiff + 4.0 * stiff * f64::EPSILON, "{stiff}: {found} {merged}");
    }
}

/// From grazing this branch falls in energy: a start that touches by rounding, which is another one in each unit, must
/// not lead back along the linear mode.
#[test]
fn a_branch_that_falls_from_grazing_is_followed_in_any_unit_of_length() {
    for unit in [1.0, 1e3, 0.3] {
        let length = 0.12043553631126717 * unit;
        let beam = Beam {
            material: Material::new(225006232.79075196, 3786.6294895791543).unwrap(),
            section: Section::rectangle(0.001080577785698326 * unit, 0.0006975243913832966 * unit).unwrap(),
            mesh: Mesh::uniform(length, 29).unwrap(),
            mass_matrix: MassMatrix::Consistent,
            start: Support::Free,
            end: Support::Clamped,
        };
        let stop = |element: f64, side, gap: f64| {
            Stop::rigid(length * element / 29.0, Direction::Transverse, side, gap * unit)
        };
        let stops = [
            stop(4.0, Side::Positive, 5.181623348518085e-07),
            stop(18.0, Side::Negative, 5.175929256926308e-07),
            stop(18.0, Side::Positive, 5.175929256926308e-07),
        ];
        for switching in [Switching::Exact, Switching::Sampled { samples: 256 }] {
            let settings = BranchSettings {
                mode: 3,
                harmonics: 9,
                switching,
                max_energy_ratio: Some(1.05),
                internal_resonance: ResonanceRule::Skip,
                ..BranchSettings::default()
            };
            let model = massless(&beam.assemble(&stops).unwrap());
            let computed = compute_branch(model, &settings, |_| ControlFlow::Continue(())).unwrap();
            let BranchEnd { reasons, message, .. } = &computed.branch.end;
            // Samples make a staircase of some contact changes, at which a branch may end.
            let ends = if switching == Switching::Exact {
                &[EndReason::MaxEnergy][..]
            } else {
                &[EndReason::MaxEnergy, EndReason::NoStep]
            };
            assert!(reasons.iter().all(|reason| ends.contains(reason)), "{unit} {switching:?}: {message}");
            assert!(computed.branch.points[1].kinetic_energy < computed.grazing.energy);
        }
    }
}

#[test]
fn redundant_stops_act_as_one() {
    let one = follow(rod(20, &[(1.0, Side::Positive, 0.5)]), 5.0, 3);
    let two = follow(rod(20, &[(1.0, Side::Positive, 0.5); 2]), 5.0, 3);
    assert_eq!(one.branch.points.len(), two.branch.points.len());
    assert!((last_hz(&two) / last_hz(&one) - 1.0).abs() < 1e-11);
    // With the same gap at the last nodes of a massless part, they touch at once and all but one bear nothing.
    let stops: Vec<_> = (0..5).map(|i| (1.0 - 0.05 * i as f64, Side::Positive, 0.5)).collect();
    follow(rod(20, &stops), 3.0, 3);
}

#[test]
fn facing_stops_a_micrometre_away_hold_the_node_at_high_energy() {
    let branches =
        [1e6, 1e9].map(|ratio| follow(rod(20, &[(1.0, Side::Positive, 1e-6), (1.0, Side::Negative, 1e-6)]), ratio, 1));
    let [near, far] = [0, 1].map(|i| 1.0 - last_hz(&branches[i]) / held_rod(20));
    assert!(near > 0.0 && near < 2e-3, "{near}");
    // The gap counts as its share of the amplitude, which grows like the root of the energy.
    assert!((near / far / 1e3_f64.sqrt() - 1.0).abs() < 0.05, "{near} {far}");
    // Steps grow with the amplitude: with steps of the same length it took more than 5000 points.
    assert!(branches[1].branch.points.len() < 1000, "{}", branches[1].branch.points.len());
}

#[test]
fn a_branch_goes_on_where_harmonics_3_to_9_are_resonant_at_once() {
    // 1:3:5:7:9 up to 4e-7 to 3e-5: singular values down to 1e-7, and contacts that open by 1e-9 of the gap. What
    // rounding leaves open must neither refuse all steps nor let a contact pass for closed that has opened.
    let computed = follow(rod(600, &[(1.0, Side::Positive, 0.5)]), 3.6, 9);
    let free = held_rod(600) / 2.0;
    let hz = last_hz(&computed);
    // Along an internal-resonance branch: nearly at the frequency of the linear mode, half of that held, but for half
    // an element of mass left out.
    assert!((hz / free - 1.0).abs() < 2.0 / 600.0, "{hz} {free}");
}

#[test]
fn harmonic_balance_says_when_a_contact_spring_drowns_the_structure() {
    let model = |ratio: f64| {
        let model = chain(&[1.0, 1.0], &[2.0, 2.0], vec![Contact::elastic(1, Side::Positive, 1.0, ratio)]);
        MasslessContactModel::with_spring_tips(&model, None).unwrap()
    };
    // Two springs of 2 in series: a static stiffness of 1.
    let error = try_follow(model(1e12), 3.0, 3).unwrap_err();
    let BranchError::Hbm(HbmError::ContactTooStiff { contact: 0, ratio, .. }) = error else { panic!("{error}") };
    assert!((ratio.log10() - 12.0).abs() < 0.01, "{ratio:e}");
    follow(model(1e7), 3.0, 3);
}
