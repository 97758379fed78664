//! Branch points and internal resonances of the rod of Section 3 and the beam of Section 4.

use crate::support;

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use nlmodes::branches::{
    BranchError, BranchPointRule, BranchProgress, BranchSettings, BranchStart, ComputedBranch, ComputedTree,
    ResonanceRule, Watch, compute_branch, compute_tree,
};
use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes::hbm::{Switching, Symmetry};
use nlmodes::modal::{EndReason, Event, ModalPoint, RESONANT_SHARE};
use nlmodes::model::{Drop, MasslessContactModel, Side};
use support::massless_beam;

fn rod() -> MasslessContactModel {
    support::rod(100, MassMatrix::Consistent)
}

fn settings(harmonics: usize) -> BranchSettings {
    BranchSettings {
        harmonics,
        max_energy_ratio: Some(20.0),
        frequency_hz: Some([50.0, 70.0]),
        internal_resonance: ResonanceRule::Follow,
        ..BranchSettings::default()
    }
}

fn go_on(_: BranchProgress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn go_on_alone(_: &ModalPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn last(computed: &ComputedBranch) -> &ModalPoint {
    computed.branch.points.last().unwrap()
}

/// Frequency in Hz and energy over that at grazing.
fn place(computed: &ComputedBranch, point: &ModalPoint) -> (f64, f64) {
    (point.omega / TAU, point.kinetic_energy / computed.grazing.energy)
}

#[test]
fn all_four_arms_meet_where_the_loop_of_the_rod_has_its_tip() {
    let settings = BranchSettings { at_branch_point: BranchPointRule::All, ..settings(3) };
    let mut seen = vec![0; 3];
    let tree: ComputedTree = compute_tree(rod(), &settings, |progress| {
        if let BranchProgress::Found { branch, point } = progress {
            seen[branch] += 1;
            assert!(point.residual < 1e-10);
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!((tree.branches.len(), tree.not_followed), (3, 0));
    assert_eq!(seen, tree.branches.iter().map(|b| b.branch.points.len()).collect::<Vec<_>>());
    let loop_and_backbone = &tree.branches[0];
    assert!((place(loop_and_backbone, last(loop_and_backbone)).0 - 70.0).abs() < 1e-9);
    // The second linear mode, three times a period: at a third of its frequency, and touching at nine grazing energies.
    let third = 182.37496593 / 3.0;
    for b in &tree.branches[1..] {
        let origin = b.origin.unwrap();
        let tip = &tree.branches[origin.branch].branch.points[origin.point];
        assert!(origin.branch == 0 && tip.has_event(Event::BranchPoint));
        let (frequency, energy) = place(b, tip);
        assert!((frequency - third).abs() < 1e-6 && (energy - 9.0005).abs() < 1e-3, "{frequency} {energy}");
    }
    let (below, above) = {
        let falls = |b: &ComputedBranch| b.branch.end.has(EndReason::MinEnergy);
        if falls(&tree.branches[1]) {
            (&tree.branches[1], &tree.branches[2])
        } else {
            (&tree.branches[2], &tree.branches[1])
        }
    };
    for point in &below.branch.points[1..] {
        assert!((place(below, point).0 - third).abs() < 1e-7 && point.contact_fraction == 0.0);
        assert!((point.harmonic_share(3) - 1.0).abs() < 1e-9);
    }
    // Above it hits the stop three times a period, with the scaled backbone of a single impact a period.
    assert_eq!(above.branch.end.reasons, [EndReason::MaxEnergy]);
    let with_contact = above.branch.points.iter().filter(|p| p.contact_fraction > 1e-3);
    assert!(with_contact.clone().count() > 5 && with_contact.clone().all(|p| p.contact_intervals == 3));
    assert!(above.branch.points.windows(2).all(|w| w[1].omega > w[0].omega - 1e-9));
}

/// The place at which the steps come to the tip is another one with each mesh: a little beside it, before or behind one
/// of its two changes of contact.
#[test]
fn the_tip_of_the_loop_is_a_branch_point_with_every_mesh() {
    for elements in [20, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 40, 42] {
        for harmonics in [3, 5, 7] {
            let settings = BranchSettings {
                frequency_hz: Some([10.0, 100.0]),
                at_branch_point: BranchPointRule::All,
                ..settings(harmonics)
            };
            let tree = compute_tree(support::rod(elements, MassMatrix::Consistent), &settings, go_on).unwrap();
            let is_tip = |of: &ComputedBranch, point: &ModalPoint| {
                point.has_event(Event::BranchPoint) && (place(of, point).1 - 9.007).abs() < 0.02
            };
            let (first, origins) = (&tree.branches[0], tree.branches.iter().filter_map(|branch| branch.origin));
            assert!(first.branch.points.iter().any(|point| is_tip(first, point)), "{elements} {harmonics}");
            let of_tip = origins.filter(|origin| {
                let of = &tree.branches[origin.branch];
                is_tip(of, &of.branch.points[origin.point])
            });
            assert!(of_tip.count() >= 2, "{elements} {harmonics}: {}", first.branch.end.message);
        }
    }
}

/// The internal-resonance branch of a coarse rod, whose tip lies beside two changes of contact: whatever the number of
/// harmonics, the branch comes back from it.
#[test]
fn numbers_of_harmonics_that_hardly_differ_tell_the_same_story_of_a_coarse_rod() {
    let [a, b, c] = [13, 14, 15].map(|harmonics| {
        let settings = BranchSettings { max_energy_ratio: Some(15.0), frequency_hz: None, ..settings(harmonics) };
        let computed = compute_branch(support::rod(20, MassMatrix::Consistent), &settings, go_on_alone).unwrap();
        assert_eq!(computed.branch.end.reasons, [EndReason::MaxEnergy], "{harmonics}: {}", computed.branch.end.message);
        let mut events: Vec<Event> = computed.branch.points.iter().flat_map(|p| p.events.clone()).collect();
        events.sort_unstable();
        (events, place(&computed, last(&computed)).0)
    });
    assert!(a.0 == b.0 && b.0 == c.0, "{:?} {:?} {:?}", a.0, b.0, c.0);
    assert!((a.1 - b.1).abs() < 1e-3 && (b.1 - c.1).abs() < 1e-3, "{} {} {}", a.1, b.1, c.1);
}

#[test]
fn motions_that_need_not_be_even_in_time_follow_the_same_branch() {
    // At the tip of the loop, where the third harmonic moves alone, the fundamental may come back with any of three
    // phases.
    let [even, any] = [Symmetry::Even, Symmetry::None]
        .map(|symmetry| compute_branch(rod(), &BranchSettings { symmetry, ..settings(3) }, go_on_alone).unwrap());
    for computed in [&even, &any] {
        assert_eq!(computed.branch.end.reasons, [EndReason::FrequencyWindow], "{}", computed.branch.end.message);
        assert_eq!(computed.tongues().len(), 1);
        // The phase brings no crossings of its own, at grazing or elsewhere.
        assert!(computed.branch.points.iter().all(|p| !p.has_event(Event::Kink)));
    }
    // Up to the tip, where more half-branches meet, it costs little more.
    let [even_up, any_up] = [Symmetry::Even, Symmetry::None].map(|symmetry| {
        let settings = BranchSettings { symmetry, max_energy_ratio: Some(8.0), ..settings(3) };
        let computed = compute_branch(rod(), &settings, go_on_alone).unwrap();
        computed.evaluations as f64 / computed.branch.points.len() as f64
    });
    assert!(any_up < 3.0 * even_up, "{any_up} instead of {even_up} evaluations a point");
    let events = |computed: &ComputedBranch, event: Event| {
        let named = computed.branch.points.iter().filter(|p| p.has_event(event));
        named.map(|p| place(computed, p)).collect::<Vec<_>>()
    };
    for name in [Event::BranchPoint, Event::Fold, Event::FrequencyFold, Event::ContactChange] {
        let (a, b) = (events(&even, name), events(&any, name));
        assert_eq!(a.len(), b.len(), "{name}: {a:?} {b:?}");
        for ((f, e), (g, d)) in a.into_iter().zip(b) {
            assert!((f / g - 1.0).abs() < 1e-7 && (e / d - 1.0).abs() < 1e-5, "{name}: {f} {e}, {g} {d}");
        }
    }
    let [(_, e), (_, d)] = [&even, &any].map(|computed| place(computed, last(computed)));
    assert!((e / d - 1.0).abs() < 1e-8, "{e} {d}");
}

#[test]
fn a_branch_that_switches_leaves_the_loop_onto_the_second_mode() {
    let settings = BranchSettings { at_branch_point: BranchPointRule::Switch, ..settings(3) };
    let computed = compute_branch(rod(), &settings, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(computed.branch.end.reasons, [EndReason::MaxEnergy]);
    assert!(last(&computed).harmonic_share(3) > 0.999);
    let tongues = computed.tongues();
    assert_eq!(tongues.len(), 1);
    assert_eq!((tongues[0].resonance.to_string().as_str(), tongues[0].end), ("3:mode 2", None));
}

#[test]
fn the_loop_of_the_rod_is_labelled() {
    let computed = compute_branch(rod(), &settings(3), |_| ControlFlow::Continue(())).unwrap();
    let tongues = computed.tongues();
    assert_eq!(tongues.len(), 1);
    let tongue = &tongues[0];
    assert_eq!(tongue.resonance.to_string(), "3:mode 2");
    let (frequency, energy) = place(&computed, &computed.branch.points[tongue.tip]);
    assert!((frequency - 182.37496593 / 3.0).abs() < 1e-5 && (energy - 9.0005).abs() < 2e-3, "{frequency} {energy}");
    assert!(tongue.start < tongue.tip && tongue.end.is_some_and(|end| end > tongue.tip));
    assert!(!tongue.skipped && tongue.energy[1] / computed.grazing.energy > 9.0);
}

#[test]
fn a_skipped_tongue_leaves_the_backbone_as_it_is() {
    let followed = compute_branch(rod(), &settings(3), |_| ControlFlow::Continue(())).unwrap();
    let mut kept: Vec<ModalPoint> = Vec::new();
    let skipping = BranchSettings { internal_resonance: ResonanceRule::Skip, ..settings(3) };
    let tree = compute_tree(rod(), &skipping, |progress| {
        match progress {
            BranchProgress::Found { point, .. } => kept.push(point.clone()),
            BranchProgress::Withdrawn { kept: count, .. } => kept.truncate(count),
            _ => {}
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    let computed = &tree.branches[0];
    assert_eq!(kept, computed.branch.points);
    let tongues = computed.tongues();
    assert_eq!(tongues.len(), 1);
    assert!(tongues[0].skipped && tongues[0].resonance.to_string() == "3:mode 2");
    assert!(computed.branch.points.iter().all(|p| p.harmonic_share(3) < 0.25));
    let (end, expected) = (last(computed), last(&followed));
    assert!((end.omega / expected.omega - 1.0).abs() < 1e-10);
    assert!((end.kinetic_energy / expected.kinetic_energy - 1.0).abs() < 1e-8);
    assert!(computed.branch.points.len() < followed.branch.points.len() / 2);
}

/// A strip of 0.8 mm before two stops in two systems of units of time: on the flank behind an internal-resonance branch
/// the share of the resonant harmonic falls, but is large everywhere.
#[test]
fn behind_a_tongue_the_branch_goes_on_at_the_backbone_and_not_on_a_flank() {
    for second in [1.0, 1e3] {
        let strip = Beam {
            material: Material::new(210e9 / (second * second), 7850.0).unwrap(),
            section: Section::rectangle(0.015, 0.0008).unwrap(),
            mesh: Mesh::uniform(0.16, 16).unwrap(),
            mass_matrix: MassMatrix::Consistent,
            start: Support::Clamped,
            end: Support::Free,
        };
        let stops = [
            Stop::rigid(0.16, Direction::Transverse, Side::Positive, 5e-4),
            Stop::rigid(0.1, Direction::Transverse, Side::Negative, 2.94e-4),
        ];
        let model = MasslessContactModel::new(&strip.assemble(&stops).unwrap(), &Drop).unwrap();
        let settings = BranchSettings {
            harmonics: 5,
            max_energy_ratio: Some(10.0),
            internal_resonance: ResonanceRule::Skip,
            ..BranchSettings::default()
        };
        let computed = compute_branch(model, &settings, |_| ControlFlow::Continue(())).unwrap();
        let feet =
            computed.branch.points.iter().filter(|p| p.has_event(Event::TongueFoot) || p.has_event(Event::Resumed));
        let shares: Vec<f64> = feet.map(|p| p.harmonic_share(p.resonance.unwrap().harmonic)).collect();
        assert!(shares.len() > 4 && shares.iter().all(|share| *share <= RESONANT_SHARE), "{shares:?}");
    }
}

#[test]
fn beyond_its_tongues_the_backbone_of_the_beam_changes_little_up_to_20_harmonics() {
    let beam_settings = |harmonics, internal_resonance| BranchSettings {
        harmonics,
        internal_resonance,
        max_energy_ratio: Some(10.0),
        frequency_hz: Some([39.0, 53.5]),
        ..BranchSettings::default()
    };
    let few = compute_branch(massless_beam(), &beam_settings(5, ResonanceRule::Follow), |_| ControlFlow::Continue(()))
        .unwrap();
    let many = compute_branch(massless_beam(), &beam_settings(20, ResonanceRule::Skip), |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(many.branch.end.reasons, [EndReason::FrequencyWindow], "{}", many.branch.end.message);
    assert!(many.tongues().iter().all(|t| t.skipped));
    assert!(many.tongues().iter().any(|t| t.resonance.to_string() == "6:mode 2"));
    let energy_at = |branch: &ComputedBranch, hz: f64| {
        let pair = branch.branch.points.windows(2).find(|w| w[0].omega <= hz * TAU && w[1].omega > hz * TAU)?;
        let share = (hz * TAU - pair[0].omega) / (pair[1].omega - pair[0].omega);
        Some(pair[0].kinetic_energy + share * (pair[1].kinetic_energy - pair[0].kinetic_energy))
    };
    for hz in [40.3, 41.0, 44.4, 46.4, 50.0] {
        let [a, b] = [&few, &many].map(|branch| energy_at(branch, hz).unwrap());
        // Between its internal-resonance branches the branch still bends toward them: by 16 % of its energy, half a
        // hertz, at 50 Hz.
        assert!((b / a - 1.0).abs() < 0.2, "{hz} Hz: {a} with 5, {b} with 20 harmonics");
    }
}

#[test]
fn a_branch_starts_at_an_energy() {
    for (upward, end) in [(true, 15.0_f64), (false, 1.0)] {
        let start = BranchStart::Energy { ratio: 2.0, upward };
        let own = BranchSettings { start, max_energy_ratio: Some(15.0), ..settings(2) };
        let tree = compute_tree(rod(), &own, go_on).unwrap();
        let computed = &tree.branches[0];
        let first = &computed.branch.points[0];
        assert!((place(computed, first).1 - 2.0).abs() < 1e-9 && first.has_event(Event::Start));
        let energies: Vec<f64> = computed.branch.points.iter().map(|p| place(computed, p).1).collect();
        if upward {
            assert!(energies.windows(2).all(|w| w[1] > w[0]) && (energies[energies.len() - 1] - end).abs() < 12.0);
        } else {
            assert!(energies.iter().any(|e| (e - end).abs() < 1e-6), "it does not pass grazing");
        }
    }
}

/// An exact branch comes back from the tip of the loop. Samples that do not divide a period in three part the
/// half-branches there: the branch that ends on the second mode says so.
#[test]
fn a_sampled_branch_that_leaves_its_mode_says_so() {
    let switching = |samples| BranchSettings { switching: Switching::Sampled { samples }, ..settings(3) };
    let computed = compute_branch(rod(), &switching(256), go_on_alone).unwrap();
    let left = computed.left_mode().expect("256 samples part the arms");
    let (hz, energy) = place(&computed, &computed.branch.points[left.point]);
    assert!((hz - 182.37496593 / 3.0).abs() < 1e-5 && (energy / 9.0005 - 1.0).abs() < 1e-3, "{hz} {energy}");
    assert_eq!((left.harmonic, left.mode, left.at_branch_point), (3, Some(2), false));
    assert_eq!(computed.branch.points.iter().filter(|p| p.has_event(Event::OtherMode)).count(), 1);
    let end = &computed.branch.end;
    assert!(!end.complete && end.has(EndReason::OtherMode) && end.message.contains("mode 2"), "{}", end.message);
    // With 384 samples the three touches are alike, as with exact switching.
    for settings in [settings(3), switching(384)] {
        let computed = compute_branch(rod(), &settings, go_on_alone).unwrap();
        assert_eq!(computed.left_mode(), None);
        assert!(computed.branch.points.iter().all(|p| !p.has_event(Event::OtherMode)));
        assert!(computed.branch.end.complete, "{}", computed.branch.end.message);
    }
    // Where the half-branch is asked for it is no failure.
    let asked = BranchSettings { at_branch_point: BranchPointRule::Switch, ..settings(3) };
    let computed = compute_branch(rod(), &asked, go_on_alone).unwrap();
    assert!(computed.left_mode().is_some_and(|left| left.at_branch_point) && computed.branch.end.complete);
}

/// The same rod before a stop a thousand times stiffer than itself, all of its mass kept: conventional harmonic
/// balance.
fn rod_on_spring() -> MasslessContactModel {
    let rod = Rod {
        material: Material::new(210e9, 9000.0).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(20.0, 100).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(20.0, Direction::Axial, Side::Positive, support::ROD_GAP).on_spring(1e13);
    MasslessContactModel::with_spring_tips(&rod.assemble(&[stop]).unwrap(), None).unwrap()
}

/// Whatever samples do at the tip of the loop, in either method: the branch ends where the exact one does, or says that
/// it left its mode.
#[test]
fn sampled_branches_of_either_method_come_back_or_say_that_they_left() {
    for model in [rod, rod_on_spring] {
        let exact = compute_branch(model(), &settings(3), go_on_alone).unwrap();
        assert!(exact.branch.end.complete && exact.left_mode().is_none(), "{}", exact.branch.end.message);
        for samples in [256, 1024] {
            let sampled = BranchSettings { switching: Switching::Sampled { samples }, ..settings(3) };
            let computed = compute_branch(model(), &sampled, go_on_alone).unwrap();
            let end = &computed.branch.end;
            let case = format!("{samples} samples: {} {}", end.names(), end.message);
            let [(hz, energy), (exact_hz, exact_energy)] = [&computed, &exact].map(|c| place(c, last(c)));
            let returns = (hz / exact_hz - 1.0).abs() < 1e-2 && (energy / exact_energy - 1.0).abs() < 0.2;
            let says_so = end.has(EndReason::OtherMode) && computed.left_mode().is_some();
            assert_eq!(end.complete, returns, "{case}: {hz} Hz {energy}, exact {exact_hz} Hz {exact_energy}");
            assert!(returns || (says_so && !end.complete), "{case}");
        }
    }
}

/// Whoever looks on ends a search at once, wherever it is, and what was found before that stays.
#[test]
fn a_study_ends_at_the_next_evaluation_wherever_it_is() {
    let skip = BranchSettings {
        harmonics: 9,
        internal_resonance: ResonanceRule::Skip,
        max_energy_ratio: Some(5.0),
        ..BranchSettings::default()
    };
    let elsewhere = BranchSettings { start: BranchStart::Frequency { hz: 64.0, upward: true }, ..settings(5) };
    for (base, wanted) in [(&skip, None), (&elsewhere, None), (&skip, Some("backbone")), (&elsewhere, Some("backbone"))]
    {
        for after in [1, 50, 400] {
            let (asked, late) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
            let counts = (Arc::clone(&asked), Arc::clone(&late));
            let watch = Watch::new(move |doing, _| {
                let counted = wanted.is_none_or(|wanted| doing.to_string().contains(wanted));
                if counted && counts.0.fetch_add(1, Ordering::Relaxed) + 1 >= after {
                    counts.1.fetch_add(1, Ordering::Relaxed);
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            });
            let settings = BranchSettings { watch: watch.clone(), ..base.clone() };
            let mut seen = 0;
            let computed = compute_branch(support::rod(20, MassMatrix::Consistent), &settings, |_| {
                seen += 1;
                ControlFlow::Continue(())
            });
            assert!(watch.has_ended());
            // Nothing was evaluated once it had ended.
            assert_eq!(late.load(Ordering::Relaxed), 1);
            match computed {
                Ok(computed) => {
                    assert_eq!(computed.branch.end.reasons, [EndReason::Stopped], "{}", computed.branch.end.message);
                    assert!(seen > 0 && !computed.branch.points.is_empty());
                }
                Err(error) => assert!(matches!(error, BranchError::Ended(_)) && seen == 0, "{error}, {seen} points"),
            }
        }
    }
}
