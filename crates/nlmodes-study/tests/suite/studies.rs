//! Studies from their text to their tables.

use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;

use nlmodes_run::Silent;
use nlmodes_study::{Cells, Collected, Settings, State, Study, StudyError, StudyObserver, StudyOutcome, run, status};

const ROD: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 4
start = "clamped"
material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }
section = { area_m2 = 1e-4 }
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1e-3
[method]
harmonics = [1, 2]
[continuation]
max_energy_ratio = 2.0
"#;

const STUDY: &str = r#"
scene = "rod.toml"
[design]
kind = "sobol"
samples = 6
[[vary]]
key = "contact.0.gap_m"
name = "gap"
uniform = [1e-3, 2e-3]
[[vary]]
key = "structure.material.youngs_modulus_pa"
normal = { mean = 210e9, std = 5e9 }
[[quantity]]
name = "f_2"
of = "frequency_hz"
at = { energy_ratio = 2.0 }
[[quantity]]
name = "force"
of = "peak_contact_force_n"
at = "max"
"#;

fn study(text: &str, directory: &Path) -> Study {
    let mut study =
        Study::parse_with_scene("study.toml", text, ROD).map_err(|refused| refused.text(false)).unwrap().scene;
    study.directory = directory.to_path_buf();
    study
}

fn with_jobs(jobs: usize) -> Settings {
    Settings { jobs: NonZeroUsize::new(jobs), ..Settings::default() }
}

fn csv(study: &Study) -> Vec<u8> {
    Collected::new(study, 2).table.to_csv()
}

/// Ends a study after this many cases.
struct Ending(usize, usize);

impl StudyObserver for Ending {
    fn progress(&mut self, outcome: &StudyOutcome) {
        self.1 = outcome.computed;
    }

    fn is_cancelled(&self) -> bool {
        self.1 >= self.0
    }
}

#[test]
fn shards_interruptions_and_threads_give_the_same_table() {
    let place = tempfile::tempdir().unwrap();
    let whole = study(STUDY, &place.path().join("whole"));
    let outcome = run(&whole, &with_jobs(1), &mut Silent).unwrap();
    // Six points with two numbers of harmonics.
    assert!(outcome.is_done() && outcome.computed == 12 && outcome.failed == 0, "{outcome:?}");
    let wanted = csv(&whole);

    let parts = study(STUDY, &place.path().join("parts"));
    let cut = run(&parts, &with_jobs(2), &mut Ending(3, 0)).unwrap();
    assert!(cut.is_cut_off && cut.computed >= 3 && cut.computed < 12, "{cut:?}");
    assert_eq!(status(&parts, 1).missing, 12 - cut.computed);
    let early = Collected::new(&parts, 1);
    assert_eq!((early.table.n_rows(), early.counts.missing), (12, 12 - cut.computed));
    for shard in ["1/3", "0/3", "2/3"] {
        let settings = Settings { shard: shard.parse().unwrap(), ..with_jobs(2) };
        assert!(run(&parts, &settings, &mut Silent).unwrap().is_done());
    }
    let again = run(&parts, &with_jobs(2), &mut Silent).unwrap();
    assert_eq!((again.computed, again.there), (0, 12));
    assert_eq!(String::from_utf8(csv(&parts)).unwrap(), String::from_utf8(wanted).unwrap());
}

#[test]
fn a_case_is_what_a_plain_run_of_its_scene_makes() {
    let place = tempfile::tempdir().unwrap();
    let study = study(STUDY, &place.path().join("study"));
    run(&study, &with_jobs(2), &mut Silent).unwrap();
    let cases = nlmodes_study::case::cases(&study, 1);
    let case = &cases[3];
    let gap = format!("contact.0.gap_m={:?}", case.values[0].as_f64().unwrap());
    let modulus = format!("structure.material.youngs_modulus_pa={:?}", case.values[1].as_f64().unwrap());
    let harmonics = format!("method.harmonics={}", case.harmonics);
    let mut scenes = nlmodes_scene::parse_each_method("rod.toml", ROD, &[gap, modulus, harmonics]).unwrap();
    scenes[0].scene.output_directory = place.path().join("plain");
    nlmodes_run::run(scenes, nlmodes_run::Over::Same, &mut Silent).unwrap();
    let own = study.directory.join("cases").join(case.id.as_ref().unwrap());
    for name in ["branch.csv", "harmonics.npz", "steps.jsonl"] {
        let read = |directory: &Path| fs::read(directory.join(name)).unwrap();
        assert_eq!(read(&own), read(&place.path().join("plain")), "{name}");
    }
    assert!(!own.join("report.html").exists() && own.join("case.json").is_file() && !own.join(".lock").exists());
}

#[test]
fn a_case_that_cannot_be_is_a_row_with_its_reason_and_the_others_go_on() {
    let place = tempfile::tempdir().unwrap();
    let text = r#"
scene = "rod.toml"
[[vary]]
key = "contact.0.at_m"
values = [1.0, 1.2, 0.75]
[[vary]]
key = "method.harmonics"
values = [1]
[[quantity]]
name = "f_3"
of = "frequency_hz"
at = { energy_ratio = 3.0 }
"#;
    let study = study(text, place.path());
    let outcome = run(&study, &with_jobs(2), &mut Silent).unwrap();
    assert!(outcome.is_done() && outcome.computed == 2 && outcome.refused == 1, "{outcome:?}");
    let collected = Collected::new(&study, 1);
    assert_eq!((collected.counts.complete, collected.counts.failed), (2, 1));
    let Some(Cells::Texts(reasons)) = collected.table.column("reason") else { panic!() };
    let reason = |row: usize| reasons[row].clone().unwrap();
    assert!(reason(1).contains("beyond the structure"), "{}", reason(1));
    // The branch ends at twice the grazing energy: the requested value is beyond that, and is not extrapolated.
    assert!(reason(0).contains("f_3: energy_ratio goes from 1 to 2, and is never 3"), "{}", reason(0));
    assert_eq!(collected.table.column("f_3").unwrap().numbers().unwrap(), [None; 3]);
}

#[test]
fn what_was_altered_is_damaged_and_computed_again_when_it_is_removed() {
    let place = tempfile::tempdir().unwrap();
    let study = study(&STUDY.replace("samples = 6", "samples = 2"), place.path());
    run(&study, &with_jobs(1), &mut Silent).unwrap();
    let whole = csv(&study);
    let cases = nlmodes_study::case::cases(&study, 1);
    let directory = study.directory.join("cases").join(cases[1].id.as_ref().unwrap());
    let path = directory.join("branch.csv");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, &text[..text.len() - 30]).unwrap();
    let damaged = Collected::new(&study, 1);
    assert_eq!(damaged.counts.damaged, 1);
    let Some(Cells::Texts(states)) = damaged.table.column("status") else { panic!() };
    assert_eq!(states[1].as_deref(), Some(State::Damaged.name()));
    fs::remove_dir_all(directory).unwrap();
    assert_eq!(run(&study, &with_jobs(1), &mut Silent).unwrap().computed, 1);
    assert_eq!(csv(&study), whole);
}

#[test]
fn names_follow_the_scene_not_its_title_and_what_changed_is_computed() {
    let place = tempfile::tempdir().unwrap();
    let ids = |text: &str, scene: &str| -> Vec<String> {
        let study = Study::parse_with_scene("study.toml", text, scene).unwrap().scene;
        nlmodes_study::case::cases(&study, 1).into_iter().map(|case| case.id.unwrap()).collect()
    };
    let own = ids(STUDY, ROD);
    assert_eq!(own, ids(STUDY, &format!("title = \"another\"\n{ROD}")));
    assert_eq!(own[..10], ids(&STUDY.replace("samples = 6", "samples = 5"), ROD)[..]);
    let other = ids(STUDY, &ROD.replace("elements = 4", "elements = 5"));
    assert!(own.iter().all(|id| !other.contains(id)));
    drop(place);
}

#[test]
fn mistakes_are_said_at_their_place() {
    let said = |from: &str, to: &str| {
        assert!(STUDY.contains(from), "{from}");
        let refused = Study::parse_with_scene("study.toml", &STUDY.replacen(from, to, 1), ROD).unwrap_err();
        refused.text(false)
    };
    for (from, to, parts) in [
        ("samples", "sample", &["study.toml:5", "unknown key `design.sample`", "did you mean `samples`?"][..]),
        ("\"sobol\"", "\"sobl\"", &["study.toml:4", "did you mean \"sobol\"?"]),
        ("\"frequency_hz\"", "\"frequenzy_hz\"", &["did you mean \"frequency_hz\"?"]),
        ("contact.0.gap_m", "contact.0.gap", &["study.toml:7", "unknown key `contact.0.gap`", "did you mean `gap_m`?"]),
        ("contact.0.gap_m", "contact.3.gap_m", &["study.toml:7", "`contact` has no item `3`", "number 0"]),
        ("at = \"max\"", "at = \"maxx\"", &["did you mean \"max\"?"]),
        ("at = \"max\"", "at = { energy_ratoi = 2.0 }", &["did you mean \"energy_ratio\"?"]),
        ("[1e-3, 2e-3]", "[2e-3, 1e-3]", &["study.toml:9", "expected the lower one first"]),
        ("kind = \"sobol\"\nsamples = 6", "", &["a distribution has no values for a grid", "expected values"]),
        ("name = \"force\"", "name = \"gap\"", &["two columns of the table would be called `gap`"]),
        ("std = 5e9", "std = -5e9", &["`vary.1.normal.std` is out of range"]),
        ("name = \"f_2\"\n", "", &["`quantity.0.name` is missing"]),
        ("scene = \"rod.toml\"\n", "", &["`scene` is missing"]),
    ] {
        let text = said(from, to);
        parts.iter().for_each(|part| assert!(text.contains(part), "{to}: {part}\n{text}"));
        assert!(!text.contains("a scene may") && text.contains("in study.toml"), "{text}");
    }
    let nowhere = Study::parse("study.toml", &STUDY.replace("rod.toml", "nowhere.toml")).unwrap_err().text(false);
    assert!(
        nowhere.contains("error: the scene of the study cannot be read") && nowhere.contains("study.toml:2"),
        "{nowhere}"
    );
    // Errors of the scene itself are reported at their position in it.
    let refused = Study::parse_with_scene("study.toml", STUDY, &ROD.replace("gap_m", "gapm")).unwrap_err();
    assert!(refused.text(false).contains("rod.toml:13"), "{}", refused.text(false));
}

#[test]
fn a_study_of_no_sound_case_says_so() {
    let place = tempfile::tempdir().unwrap();
    let text = "scene = \"rod.toml\"\n[[vary]]\nkey = \"contact.0.at_m\"\nvalues = [1.2, 1.3]\n";
    let error = run(&study(text, place.path()), &with_jobs(1), &mut Silent).unwrap_err();
    assert!(
        matches!(error, StudyError::NoCase { cases: 2, .. }) && error.to_string().contains("beyond the structure"),
        "{error}"
    );
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
}

#[test]
fn studies_and_outcomes_go_to_other_threads() {
    fn send<T: Send>() {}
    send::<(Study, Settings, Collected, StudyError, StudyOutcome)>();
}
