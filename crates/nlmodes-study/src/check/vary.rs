//! Varied keys and their values.

use nlmodes_scene::{Diagnostic, Diagnostics, number};
use serde_json::Value;

use crate::distribution::Distribution;
use crate::raw::RawVary;
use crate::study::{Design, DesignKind, Values, Variable};

/// The ways in which a table specifies values.
const WAYS: [&str; 6] = ["values", "linspace", "uniform", "loguniform", "normal", "lognormal"];
/// Maximum number of values of a `linspace`.
const MAX_VALUES: f64 = 1e6;

/// The variable of the table number `k`; one that `is_fitted` may begin at the value that the scene has.
pub fn variable(
    raw: &RawVary,
    (k, is_fitted): (usize, bool),
    design: &Design,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Variable> {
    let path = format!("vary.{k}");
    let keys = keys(raw.key.as_ref()?, &path, diagnostics)?;
    let is_as_written = is_fitted && !given(raw).contains(&true);
    let values = match is_as_written {
        true => Values::Listed(Vec::new()),
        false => values(raw, &path, keys.len(), diagnostics)?,
    };
    if let (Values::Drawn(_), false) = (&values, design.kind.takes_distributions()) {
        let diagnostic = Diagnostic::error(format!("a distribution has no values for a {}", design.kind.name())).help(
            "write `values` or `linspace`, or take `design.kind` \"sobol\", \"latin-hypercube\", \"random\" or \
                \"first-order\"",
        );
        diagnostics.put(&path, diagnostic, "expected values");
        return None;
    }
    let name = raw.name.clone().unwrap_or_else(|| keys[0].clone());
    Some(Variable { name, keys, values })
}

/// A list design has one value for each case.
pub fn same_lengths(variables: &[Variable], design: &Design, diagnostics: &mut Diagnostics<'_>) {
    if design.kind != DesignKind::List {
        return;
    }
    let lengths: Vec<usize> = variables.iter().map(crate::design::n_listed).collect();
    for (k, length) in lengths.iter().enumerate() {
        if lengths[0] != *length {
            let diagnostic = Diagnostic::error("the variables of a list have equally many values")
                .help("design.kind = \"grid\" takes all combinations");
            diagnostics.put(
                &format!("vary.{k}"),
                diagnostic,
                format!("has {length}, expected {} as the first one", lengths[0]),
            );
        }
    }
}

fn keys(raw: &Value, path: &str, diagnostics: &mut Diagnostics<'_>) -> Option<Vec<String>> {
    let list = match raw {
        Value::Array(items) => items.clone(),
        single => vec![single.clone()],
    };
    let texts: Vec<String> = list.iter().filter_map(|item| Some(item.as_str()?.trim().to_owned())).collect();
    let sound = |key: &String| !key.is_empty() && !key.contains('=');
    if texts.is_empty() || texts.len() != list.len() || !texts.iter().all(sound) {
        let diagnostic = Diagnostic::error(format!("`{path}.key` is no key of a scene"));
        let label = "expected what `--set` takes, as \"contact.0.gap_m\", or a list of such keys";
        diagnostics.put(&format!("{path}.key"), diagnostic, label);
        return None;
    }
    Some(texts)
}

/// Which of the ways a table takes.
fn given(raw: &RawVary) -> [bool; 6] {
    [
        raw.values.is_some(),
        raw.linspace.is_some(),
        raw.uniform.is_some(),
        raw.loguniform.is_some(),
        raw.normal.is_some(),
        raw.lognormal.is_some(),
    ]
}

fn values(raw: &RawVary, path: &str, n_keys: usize, diagnostics: &mut Diagnostics<'_>) -> Option<Values> {
    let ways: Vec<&str> = WAYS.iter().zip(given(raw)).filter(|(_, given)| *given).map(|(way, _)| *way).collect();
    let [_] = ways.as_slice() else {
        let misspelt = WAYS.iter().any(|way| diagnostics.is_meant(&format!("{path}.{way}")));
        if !(ways.is_empty() && misspelt) {
            let diagnostic = Diagnostic::error(match ways.len() {
                0 => "nothing says which values there are".to_owned(),
                _ => format!("{} exclude each other", ways.join(" and ")),
            });
            diagnostics.put(path, diagnostic, format!("expected one of {}", WAYS.join(", ")));
        }
        return None;
    };
    if let Some(values) = &raw.values {
        return listed(values, path, n_keys, diagnostics).map(Values::Listed);
    }
    if let Some(linspace) = &raw.linspace {
        return evenly(linspace, path, n_keys, diagnostics).map(Values::Listed);
    }
    drawn(raw, path, diagnostics).map(Values::Drawn)
}

/// Individual values; for several keys each may be a list.
fn listed(values: &Value, path: &str, n_keys: usize, diagnostics: &mut Diagnostics<'_>) -> Option<Vec<Vec<Value>>> {
    let Value::Array(items) = values else {
        let diagnostic = Diagnostic::error(format!("`{path}.values` is not a list"));
        diagnostics.put(&format!("{path}.values"), diagnostic, "expected values in square brackets");
        return None;
    };
    if items.is_empty() {
        diagnostics.put(
            &format!("{path}.values"),
            Diagnostic::error(format!("`{path}.values` is empty")),
            "expected a value",
        );
        return None;
    }
    let before = diagnostics.count();
    let rows = items.iter().enumerate().map(|(i, item)| {
        let place = format!("{path}.values.{i}");
        if has_null(item) {
            diagnostics.put(&place, Diagnostic::error(format!("`{place}` is not a finite number")), "expected a value");
        }
        match item {
            Value::Array(row) if n_keys > 1 && row.len() != n_keys => {
                let diagnostic = Diagnostic::error("several keys that move together have a value each");
                diagnostics.put(&place, diagnostic, format!("has {}, expected {n_keys}", row.len()));
                Vec::new()
            }
            Value::Array(row) if n_keys > 1 => row.clone(),
            single => vec![single.clone(); n_keys],
        }
    });
    let rows = rows.collect();
    (diagnostics.count() == before).then_some(rows)
}

/// JSON has no numbers that are not finite.
fn has_null(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Array(items) => items.iter().any(has_null),
        Value::Object(entries) => entries.values().any(has_null),
        _ => false,
    }
}

fn evenly(linspace: &[f64], path: &str, n_keys: usize, diagnostics: &mut Diagnostics<'_>) -> Option<Vec<Vec<Value>>> {
    let &[from, to, count] = linspace else { return None };
    if count.fract() != 0.0 || !(1.0..=MAX_VALUES).contains(&count) || (count == 1.0 && from != to) {
        let diagnostic = Diagnostic::error(format!("`{path}.linspace` asks for {} values", number(count)));
        diagnostics.put(&format!("{path}.linspace.2"), diagnostic, "expected a whole number from 2 to 1000000");
        return None;
    }
    let at = |k: usize| if k + 1 == count as usize { to } else { from + (to - from) * k as f64 / (count - 1.0) };
    Some((0..count as usize).map(|k| vec![Value::from(at(k)); n_keys]).collect())
}

fn drawn(raw: &RawVary, path: &str, diagnostics: &mut Diagnostics<'_>) -> Option<Distribution> {
    if let Some(&[low, high]) = raw.uniform.as_deref() {
        ascending(low, high, &format!("{path}.uniform"), diagnostics)?;
        return Some(Distribution::Uniform { low, high });
    }
    if let Some(&[low, high]) = raw.loguniform.as_deref() {
        let place = format!("{path}.loguniform");
        ascending(low, high, &place, diagnostics)?;
        if low <= 0.0 {
            diagnostics.put(
                &place,
                Diagnostic::error(format!("`{place}` has no logarithm")),
                "expected two positive numbers",
            );
            return None;
        }
        return Some(Distribution::LogUniform { low, high });
    }
    if let Some(normal) = &raw.normal {
        let (min, max) = (normal.min.unwrap_or(f64::NEG_INFINITY), normal.max.unwrap_or(f64::INFINITY));
        ascending(min, max, &format!("{path}.normal"), diagnostics)?;
        return Some(Distribution::Normal { mean: normal.mean?, std: normal.std?, min, max });
    }
    let lognormal = raw.lognormal.as_ref()?;
    Some(Distribution::LogNormal { mean: lognormal.mean?, std: lognormal.std? })
}

fn ascending(low: f64, high: f64, path: &str, diagnostics: &mut Diagnostics<'_>) -> Option<()> {
    if low < high {
        return Some(());
    }
    let diagnostic = Diagnostic::error(format!("the limits of `{path}` are not in order"));
    diagnostics.put(
        path,
        diagnostic,
        format!("found {} before {}, expected the lower one first", number(low), number(high)),
    );
    None
}
