//! The same motion is reported alike, whether it is computed as a branch or as a response.

use std::f64::consts::TAU;

use nlmodes::modal::{ModalPoint, Participation};
use nlmodes_run::{Over, Silent, responses};

/// A rod before a wall, whose third harmonic excites its second mode.
const ROD: &str = "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 8\nstart = \"clamped\"\n\
    material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }\nsection = { area_m2 = 1e-4 }\n\
    [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-3\n\
    [method]\nharmonics = 5\n[reduction]\nkind = \"open-modes\"\nmodes = 6\n\
    [output]\nstability = \"never\"\nfigures = false\npage = false\n[continuation]\nmax_energy_ratio = 3.0\n";

/// Points with their participation.
type Points = Vec<(ModalPoint, Participation)>;

fn pairs(points: &[ModalPoint], found: &[Participation]) -> Points {
    assert_eq!(points.len(), found.len());
    points.iter().cloned().zip(found.iter().cloned()).collect()
}

fn branch() -> Points {
    let place = tempfile::tempdir().unwrap();
    // As the response, which does so anyway.
    let text = format!("{ROD}internal_resonance = \"follow\"\n");
    let mut scenes = nlmodes_scene::parse_each_method("rod.toml", &text, &[]).unwrap();
    scenes[0].scene.output_directory = place.path().join("out");
    let outcome = nlmodes_run::run(scenes, Over::Same, &mut Silent).unwrap();
    let part = &outcome.parts[0];
    pairs(&part.tree.branches[0].branch.points, &part.participation[0])
}

fn response(more: &str) -> Points {
    let place = tempfile::tempdir().unwrap();
    let text = format!("{ROD}{more}").replace("figures = false", "figures = true\nmatlab = true");
    let mut file = nlmodes_scene::parse("rod.toml", &text, &[]).unwrap_or_else(|error| panic!("{}", error.text(false)));
    file.scene.output_directory = place.path().join("out");
    let outcome = responses::run(&file, Over::Same, &mut Silent).unwrap();
    let only = &outcome.curves[0];
    assert!(only.said().is_ok(), "{:?}", only.said());
    assert!(outcome.certificate.checks.iter().any(|check| check.name == "mesh" && check.value.is_some()));
    let written = ["contacts.csv", "harmonics.npz", "participation.csv", "histories.npz", "results.mat"];
    let drawn = ["contacts.svg", "participation.svg", "motion_1.svg", "motion_4.svg", "history_P1.svg"];
    for name in written.into_iter().chain(drawn) {
        assert!(place.path().join("out").join(name).is_file(), "{name}");
    }
    pairs(&only.branch.points, &only.participation)
}

/// Compares the shares of the modes with those of the branch at the nearest place of the latter, and the resonance with
/// those on both sides of it; the number of points that could be compared, and of those with a resonance.
fn compare(found: &Points, branch: &Points, tolerance: f64) -> [usize; 2] {
    let at = |point: &ModalPoint| [point.kinetic_energy.ln(), point.omega.ln()];
    let mut counts = [0, 0];
    for (point, own) in found {
        let here = at(point);
        let near = branch.windows(2).filter_map(|pair| {
            let (a, b) = (at(&pair[0].0), at(&pair[1].0));
            let way = [b[0] - a[0], b[1] - a[1]];
            let length = way[0] * way[0] + way[1] * way[1];
            let share = ((here[0] - a[0]) * way[0] + (here[1] - a[1]) * way[1]) / length;
            let off = (0..2).map(|k| (here[k] - a[k] - share * way[k]).powi(2)).sum::<f64>().sqrt();
            (-1e-9..=1.0 + 1e-9).contains(&share).then_some((off, share, pair))
        });
        let Some((off, share, pair)) = near.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        assert!(off < tolerance, "a motion at {here:?} that the branch does not have, by {off:e}");
        let [before, after] = [&pair[0], &pair[1]];
        for (k, shown) in own.energy_shares.iter().enumerate() {
            let expected = (1.0 - share) * before.1.energy_shares[k] + share * after.1.energy_shares[k];
            assert!((shown - expected).abs() < tolerance, "mode {}: {shown} and {expected} at {here:?}", k + 1);
        }
        let sides = [before.0.resonance, after.0.resonance];
        assert!(sides.contains(&point.resonance), "{:?} between {sides:?}", point.resonance);
        counts = [counts[0] + 1, counts[1] + usize::from(point.resonance.is_some())];
    }
    counts
}

#[test]
fn a_mode_as_a_response_and_as_a_branch_have_the_same_resonance_and_participation() {
    let (branch, mode) = (branch(), response("[[response]]\nkind = \"mode\"\n"));
    let [compared, resonant] = compare(&mode, &branch, 2e-3);
    assert!(compared > 10 && resonant > 5, "{compared} {resonant}");
    assert_eq!(branch.iter().filter_map(|(point, _)| point.resonance).next().unwrap().to_string(), "3:mode 2");
    let sum: f64 = mode[0].1.energy_shares.iter().sum();
    assert!((sum - 1.0).abs() < 1e-12 && (mode[0].1.factors[0].abs() - 1.0).abs() < 1e-9, "{:?}", mode[0].1);
}

#[test]
fn next_to_no_damping_a_phase_resonance_is_the_mode() {
    let branch = branch();
    let (grazing, ratio, gap) = (&branch[0].0, 1e-6, 1e-3);
    // Power of the damping 2 ζ ω over that of the force: three times that at which the linear mode touches.
    let level = 3.0 * 2.0 * ratio * (grazing.omega * grazing.modal_amplitude).powi(2) / gap;
    let hz = grazing.omega / TAU;
    let phase = response(&format!(
        "[damping]\nratio = {ratio}\n[[force]]\nat_m = 1.0\n[[response]]\nkind = \"phase-resonance\"\n\
         levels_n = [{level}]\nfrequency_hz = [{}, {}]\n",
        0.9 * hz,
        2.0 * hz
    ));
    let beyond: Points =
        phase.into_iter().filter(|(p, _)| p.kinetic_energy > 1.0001 * grazing.kinetic_energy).collect();
    let [compared, resonant] = compare(&beyond, &branch, 5e-3);
    assert!(compared > 20 && resonant > 1, "{compared} {resonant}");
}
