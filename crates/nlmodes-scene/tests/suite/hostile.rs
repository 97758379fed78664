//! No text or argument makes the reader panic, and every error can be displayed.

use nlmodes_scene as config;
use proptest::prelude::*;

const ROD: &str = include_str!("../../../../configs/rod.toml");
const RECORDS: &str = include_str!("../../../../configs/measured_record.toml");
const TEST: &str = include_str!("../../../../configs/virtual_test.toml");
const PIECES: [&str; 28] = [
    "[",
    "]",
    "[[contact]]",
    "{",
    "}",
    "=",
    "\"",
    "'''",
    ".",
    ",",
    "#",
    "\n",
    "\r\n",
    "\u{0}",
    "\u{1b}[31m",
    "ä",
    "𝄞",
    "-",
    "1e999",
    "nan",
    "inf",
    "0x",
    "9223372036854775808",
    "1979-05-27",
    "true",
    "[method]",
    "structure",
    "\u{feff}",
];

/// Replaces the text between two places by a piece.
fn mutated(text: &str, mutations: &[(usize, usize, &str)]) -> String {
    mutations.iter().fold(text.to_owned(), |text, (from, length, piece)| mutate(&text, *from, *length, piece))
}

fn mutate(text: &str, from: usize, length: usize, piece: &str) -> String {
    let letters: Vec<char> = text.chars().collect();
    let from = from % (letters.len() + 1);
    let to = (from + length).min(letters.len());
    letters[..from].iter().collect::<String>() + piece + &letters[to..].iter().collect::<String>()
}

fn reads(text: &str, overrides: &[String]) {
    match config::parse("scene.toml", text, overrides) {
        Ok(file) => drop(file.warnings_text(true)),
        Err(refused) => assert!(refused.text(true).contains("error")),
    }
}

fn reads_records(text: &str, overrides: &[String]) {
    match config::parse_records("scene.toml", text, overrides) {
        Ok(file) => drop(file.warnings_text(true)),
        Err(refused) => assert!(refused.text(true).contains("error")),
    }
}

fn reads_tests(text: &str, overrides: &[String]) {
    match config::parse_test("scene.toml", text, overrides) {
        Ok(file) => drop(file.warnings_text(true)),
        Err(refused) => assert!(refused.text(true).contains("error")),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_scenes_are_read_or_refused(
        mutations in prop::collection::vec((any::<usize>(), 0_usize..40, prop::sample::select(&PIECES[..])), 1..6),
    ) {
        let text = mutated(ROD, &mutations);
        reads(&text, &[]);
    }

    #[test]
    fn mutated_scenes_of_records_are_read_or_refused(
        mutations in prop::collection::vec((any::<usize>(), 0_usize..40, prop::sample::select(&PIECES[..])), 1..6),
        x in any::<f64>(), key in 0_usize..8,
    ) {
        let text = mutated(RECORDS, &mutations);
        reads_records(&text, &[]);
        let keys = ["recording.sample_rate_hz", "channel.0.sensitivity", "channel.1.delay_s", "channel.2.position_m",
            "linear_modes.shapes.1.2", "linear_modes.frequencies_hz.0", "stop.gap_m", "extraction.pbmif_harmonics"];
        reads_records(RECORDS, &[format!("{}={x:e}", keys[key])]);
    }

    #[test]
    fn mutated_scenes_of_virtual_tests_are_read_or_refused(
        mutations in prop::collection::vec((any::<usize>(), 0_usize..40, prop::sample::select(&PIECES[..])), 1..6),
        x in any::<f64>(), key in 0_usize..8,
    ) {
        let text = mutated(TEST, &mutations);
        reads_tests(&text, &[]);
        let keys = ["drive_m", "damping_ratios.0", "frequencies_hz.5", "sample_rate_hz", "stop.gap_m",
            "stop.stiffness_n_m", "schedule.record_s", "schedule.levels_v.3"];
        reads_tests(TEST, &[format!("virtual_test.{}={x:e}", keys[key])]);
    }

    #[test]
    fn any_number_is_read_or_refused(x in any::<f64>(), n in any::<i64>(), key in 0_usize..8) {
        let keys = ["structure.length_m", "structure.grading", "structure.section.area_m2", "contact.0.at_m",
            "contact.0.gap_m", "structure.material.density_kg_m3", "continuation.frequency_hz.0",
            "continuation.max_energy_ratio"];
        let counts = ["method.mode", "method.harmonics", "method.samples", "method.held_modes",
            "continuation.max_points"];
        reads(ROD, &[format!("{}={x:e}", keys[key]), format!("{}={n}", counts[key % counts.len()])]);
        let height = format!("structure.section.height_m={x:e}");
        reads(ROD, &["structure.kind=beam".into(), "structure.section={width_m=1.0}".into(), height]);
    }

    #[test]
    fn any_argument_is_read_or_refused(
        argument in "\\PC{0,40}",
        key in "[a-z_]{0,9}(\\.[a-z_0-9]{0,9}){0,3}",
        value in "\\PC{0,20}",
    ) {
        reads(ROD, &[argument, format!("{key}={value}")]);
    }

    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,200}") {
        reads(&text, &[]);
    }
}
