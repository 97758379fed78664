use std::fmt::Write;

use super::{Check, Outcome, Topic};

/// Heading of what stands behind the cases.
const HEADING_OF_ERRORS: &str = "## What the cases are worth";

/// Errors below are rounding, whose digits depend on the processor.
const ROUNDING: f64 = 1e-11;

const HEAD: &str = "\
# Verification

Problems with known answers, recomputed whenever this page is written:

```sh
cargo run --release -p nlmodes-benchmarks --example verification
```

`cargo test -p nlmodes-benchmarks --test verification` runs the same cases and compares their numbers with those of \
    this page. A single case can be run:
`cargo run --release -p nlmodes-benchmarks --example verification -- sdnd122` prints those whose name contains the \
    word and writes nothing.

No reference value was computed with this program. References are closed forms evaluated by the case itself (*exact*); \
    other methods for the same
equations, written only for the case (*independent computation*); published numbers (*other program*); or
measurements (*measured*). Errors are relative unless a scale is given. Each limit has its reason: the theory of the \
    discretisation error, or rounding.
Errors below 1e-11 are shown as rounding.

";

const ERRORS: &str = "\
## What the cases are worth

Deliberate errors, each put into a copy of the program (`benchmarks/mutations.py`), and the cases that fail upon it: \
    of those that take less than a quarter of a
second, and of the others where none of these does.

<!-- errors: written by benchmarks/mutations.py -->

The table has not been made yet.

<!-- end of errors -->
";

/// The manual of these results; the table of deliberate errors is taken over from the page `before`.
pub fn manual(results: &[(Topic, Vec<Outcome>)], before: &str) -> String {
    let mut text = HEAD.to_owned();
    let all = || results.iter().flat_map(|(_, outcomes)| outcomes);
    let passed = all().filter(|o| o.passes()).count();
    let checks: usize = all().filter_map(|o| o.checks.as_ref().ok()).map(Vec::len).sum();
    let _ = writeln!(text, "{} cases with {checks} comparisons; {passed} cases pass.\n", all().count());
    let _ = writeln!(text, "| topic | cases | pass |\n| --- | --- | --- |");
    for (topic, outcomes) in results {
        let pass = outcomes.iter().filter(|o| o.passes()).count();
        let _ = writeln!(text, "| [{}](#{}) | {} | {pass} |", topic.title, anchor(topic.title), outcomes.len());
    }
    for (topic, outcomes) in results {
        let _ = writeln!(text, "\n## {}", topic.title);
        outcomes.iter().for_each(|outcome| text.push_str(&section(outcome)));
    }
    let errors = before.find(HEADING_OF_ERRORS).map_or(ERRORS, |at| &before[at..]);
    text + "\n" + errors
}

fn anchor(title: &str) -> String {
    title.to_lowercase().replace(' ', "-")
}

fn section(outcome: &Outcome) -> String {
    let case = outcome.case;
    let mut text = format!("\n### `{}`\n\n{}\n\n", case.name, case.problem);
    let _ = writeln!(text, "*Reference ({}):* {}\n", case.kind.name(), case.reference);
    if !case.remark.is_empty() {
        let _ = writeln!(text, "*Remark:* {}\n", case.remark);
    }
    match &outcome.checks {
        Ok(checks) => {
            text.push_str(
                "| | obtained | reference | error | limit | why | |\n| --- | --- | --- | --- | --- | --- | --- |\n",
            );
            checks.iter().for_each(|check| text.push_str(&row(check)));
        }
        Err(error) => {
            let _ = writeln!(text, "**Fails:** {error}");
        }
    }
    text
}

fn row(check: &Check) -> String {
    let verdict = if check.passes() { "pass" } else { "**FAIL**" };
    let [obtained, reference] = [check.obtained, check.reference].map(|value| number(value, check));
    let error = if check.error() < ROUNDING { "rounding".to_owned() } else { format!("{:.0e}", check.error()) };
    let limit = if check.limit == 0.0 { "0".to_owned() } else { format!("{:.0e}", check.limit) };
    format!("| {} | {obtained} | {reference} | {error} | {limit} | {} | {verdict} |\n", check.what, check.why)
}

/// With the digits that mean something beside the limit, twelve at most.
fn number(value: f64, check: &Check) -> String {
    if check.limit == 0.0 {
        return format!("{value}");
    }
    if value.abs() < ROUNDING * check.size {
        return "0".to_owned();
    }
    let smallest = (0.01 * check.limit * check.size).max(1e-12 * check.size);
    let digits = (value.abs() / smallest).log10().ceil().clamp(2.0, 12.0) as usize;
    let exponent = value.abs().log10().floor() as i32;
    if (-4..7).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.*e}", digits - 1)
    }
}

/// The obtained values and verdicts that a manual holds, case by case in its order.
pub fn recorded_values(manual: &str) -> Vec<(String, Vec<(f64, bool)>)> {
    let mut found: Vec<(String, Vec<(f64, bool)>)> = Vec::new();
    // Behind the cases stands a table of another kind.
    let cases = manual.split(HEADING_OF_ERRORS).next().unwrap_or(manual);
    for line in cases.lines() {
        if let Some(name) = line.strip_prefix("### `") {
            found.push((name.trim_end_matches('`').to_owned(), Vec::new()));
        } else if let (Some((_, values)), Some(cells)) = (found.last_mut(), line.strip_prefix("| ")) {
            let cells: Vec<&str> = cells.split(" | ").collect();
            if let (Some(Ok(value)), Some(verdict)) = (cells.get(1).map(|cell| cell.parse()), cells.last()) {
                values.push((value, verdict.trim_end_matches(" |") == "pass"));
            }
        }
    }
    found
}
