//! Choices that may be written with either of two words.

use nlmodes_scene::parse_each_method;
use nlmodes_scene::scene::{ReductionKind, StabilityChoice};

const ROD: &str = "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 4\nstart = \"clamped\"\n\
    material = { youngs_modulus_pa = 2e11, density_kg_m3 = 7800.0 }\nsection = { area_m2 = 1e-4 }\n\
    [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-4\n\
    [method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 5.0\n";

#[test]
fn a_choice_of_two_words_is_read_by_either() {
    let kinds = [
        ("open-modes", ReductionKind::OpenModes),
        ("free-interface", ReductionKind::OpenModes),
        ("held-modes", ReductionKind::HeldModes),
        ("fixed-interface", ReductionKind::HeldModes),
    ];
    let stabilities = [
        ("auto", StabilityChoice::Auto),
        ("figures", StabilityChoice::Auto),
        ("always", StabilityChoice::Always),
        ("all", StabilityChoice::Always),
        ("never", StabilityChoice::Never),
    ];
    for ((word, kind), (often, stability)) in kinds.into_iter().flat_map(|kind| stabilities.map(|s| (kind, s))) {
        let text = format!(
            "{ROD}[reduction]\nkind = \"{word}\"\n[output]\nstability = \"{often}\"\nstability_budget_s = 2.5\n"
        );
        let files = parse_each_method("rod.toml", &text, &[]).map_err(|refused| refused.text(false)).unwrap();
        let scene = &files[0].scene;
        assert_eq!(scene.reduction.and_then(|reduction| reduction.kind), Some(kind), "{word}");
        assert_eq!((scene.stability, scene.stability_budget_s), (stability, Some(2.5)), "{often}");
    }
}

#[test]
fn a_word_of_another_choice_is_refused() {
    let text = format!("{}internal_resonance = \"figures\"\n", ROD);
    let refused = parse_each_method("rod.toml", &text, &[]).map_err(|refused| refused.text(false)).unwrap_err();
    assert!(refused.contains("\"follow\" or \"skip\"") && !refused.contains("\"skip\" or \"figures\""), "{refused}");
}

/// Harmonics of a scene with these tables in place of `[method]`.
fn harmonics(tables: &str) -> Vec<usize> {
    let text = ROD.replace("[method]\nharmonics = 3\n", "") + tables;
    let files = parse_each_method("rod.toml", &text, &[]).map_err(|refused| refused.text(false)).unwrap();
    files[0].scene.method.harmonics_list.clone()
}

#[test]
fn without_a_method_modes_have_seven_harmonics_and_responses_fifteen() {
    const RESPONSE: &str = "[damping]\nratio = 0.01\n[response]\nkind = \"damped-mode\"\n\
        [[force]]\nat_m = 1.0\ndirection = \"axial\"\namplitude_n = 1.0\n";
    assert_eq!((harmonics(""), harmonics("[method]\n")), (vec![7], vec![7]));
    assert_eq!((harmonics(RESPONSE), harmonics("[method]\nharmonics = [5, 3]\n")), (vec![15], vec![3, 5]));
    // An accuracy chooses them, from two on.
    assert_eq!(harmonics("[method]\naccuracy = 1e-3\n"), vec![2]);
}
