//! All cases with known answers pass, and `benchmarks/verification.md` says what they give.

use std::collections::HashSet;
use std::path::Path;

use nlmodes_benchmarks::verification::{Outcome, TOPICS, manual, recorded_values, run};

#[test]
fn all_cases_pass_and_the_manual_has_their_numbers() {
    let results = run(|_| true, |_| {});
    let outcomes: Vec<&Outcome> = results.iter().flat_map(|(_, outcomes)| outcomes).collect();
    let failed = |o: &&Outcome| (!o.passes()).then_some(o.case.name);
    let failures: Vec<&str> = outcomes.iter().filter_map(failed).collect();
    assert!(failures.is_empty(), "{failures:?}\n{}", manual(&results, ""));

    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("verification.md");
    let recorded = recorded_values(&std::fs::read_to_string(path).unwrap());
    let again = "write it anew: cargo run --release -p nlmodes-benchmarks --example verification";
    assert_eq!(recorded.len(), outcomes.len(), "benchmarks/verification.md has other cases: {again}");
    for (outcome, (name, values)) in outcomes.iter().zip(&recorded) {
        let checks = outcome.checks.as_ref().unwrap();
        assert_eq!((outcome.case.name, checks.len()), (name.as_str(), values.len()), "{again}");
        for (check, (value, passed)) in checks.iter().zip(values) {
            // Numbers are written to a tenth of their limit, or to 12 digits.
            let digits = (0.1 * check.limit).max(1e-10) * check.size + 1e-10 * value.abs();
            let off = (check.obtained - value).abs();
            assert!(off <= digits, "{name}, {}: {} here, {value} on the page: {again}", check.what, check.obtained);
            assert!(*passed, "{name}, {}: {again}", check.what);
        }
    }
}

#[test]
fn every_case_states_what_it_needs_to_and_has_a_name_of_its_own() {
    let mut names = HashSet::new();
    for case in TOPICS.iter().flat_map(|topic| topic.cases) {
        assert!(names.insert(case.name), "{} is there twice", case.name);
        assert!(case.problem.lines().count() <= 3 && !case.reference.is_empty(), "{}", case.name);
    }
    assert!(names.len() >= 60, "{}", names.len());
}
