//! A run in its own thread prints nothing by itself, and ends on request.

use std::thread;

use nlmodes_run::records::RecordOutcome;
use nlmodes_run::virtual_test::TestOutcome;
use nlmodes_run::{Event, Observer, Over, RunError, RunOutcome, Silent};
use nlmodes_scene::{AnyScene, SceneError, SceneFile, parse_each_method};

const ROD: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 6
start = "clamped"
material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }
section = { area_m2 = 1e-4 }
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1e-3
[method]
harmonics = [2, 3]
[continuation]
max_energy_ratio = 3.0
"#;

fn send<T: Send>() {}

#[test]
fn scenes_outcomes_and_errors_go_to_other_threads() {
    send::<(SceneFile, AnyScene, SceneError)>();
    send::<(RunOutcome, RunError, TestOutcome, RecordOutcome)>();
}

/// Ends a run after this many points.
struct Ending {
    points: usize,
    seen: usize,
    parts: usize,
}

impl Observer for Ending {
    fn event(&mut self, event: Event<'_>) {
        match event {
            Event::Point { .. } => self.seen += 1,
            Event::Done(_) => self.parts += 1,
            _ => {}
        }
    }

    fn is_cancelled(&self) -> bool {
        self.seen >= self.points
    }
}

fn scenes(directory: &std::path::Path) -> Vec<SceneFile> {
    let mut scenes = parse_each_method("rod.toml", ROD, &[]).unwrap();
    scenes[0].scene.output_directory = directory.to_path_buf();
    scenes
}

#[test]
fn a_run_in_a_thread_ends_behind_the_point_at_which_it_is_asked_to_and_goes_on_from_there() {
    let place = tempfile::tempdir().unwrap();
    let directory = place.path().join("rod");
    let (cut_off, cut_directory) = (scenes(&directory), directory.clone());
    let ended = thread::spawn(move || {
        let mut observer = Ending { points: 5, seen: 0, parts: 0 };
        let outcome = nlmodes_run::run(cut_off, Over::Same, &mut observer).unwrap();
        (outcome, observer)
    });
    let (outcome, observer) = ended.join().unwrap();
    assert!(outcome.is_cut_off && !outcome.is_complete());
    assert_eq!((outcome.parts.len(), observer.seen, observer.parts), (1, 5, 1));
    assert_eq!(outcome.parts[0].tree.branches[0].branch.points.len(), 5);
    assert!(cut_directory.join("h2/report.html").is_file());

    let resumed = nlmodes_run::run(scenes(&directory), Over::Resumed, &mut Silent).unwrap();
    let whole = nlmodes_run::run(scenes(&place.path().join("whole")), Over::Same, &mut Silent).unwrap();
    assert!(resumed.is_complete() && whole.is_complete());
    for (a, b) in resumed.parts.iter().zip(&whole.parts) {
        let points = |part: &nlmodes_run::PartOutcome| {
            let points = &part.tree.branches[0].branch.points;
            points.iter().map(|point| (point.omega, point.kinetic_energy)).collect::<Vec<_>>()
        };
        assert_eq!(points(a), points(b));
    }
}

#[test]
fn results_of_another_scene_are_an_error_of_the_call() {
    let place = tempfile::tempdir().unwrap();
    nlmodes_run::run(scenes(place.path()), Over::Same, &mut Silent).unwrap();
    let mut other = scenes(place.path());
    if let Some(rod) = other[0].scene.structure.straight_mut() {
        rod.length = 2.0;
    }
    other[0].scene.contacts[0].at = 2.0;
    let error = nlmodes_run::run(other, Over::Same, &mut Silent).unwrap_err();
    assert!(matches!(error, RunError::Foreign { .. }) && error.is_of_the_call(), "{error}");
}
