//! Trees of names and values, such as a scene.

use crate::svg::escape;
use serde_json::Value;

/// As nested lists of names and values.
pub(super) fn tree(value: &Value) -> String {
    match value {
        Value::Object(entries) => {
            let entry = |(name, value): (&String, &Value)| {
                format!("<dt>{}</dt><dd>{}</dd>\n", escape(&name.replace('_', " ")), tree(value))
            };
            let entries: String = entries.iter().filter(|(_, value)| !value.is_null()).map(entry).collect();
            format!("<dl class=\"tree\">{entries}</dl>")
        }
        Value::Array(values) if values.iter().any(Value::is_object) => {
            let entry = |(k, value): (usize, &Value)| format!("<dt>{}</dt><dd>{}</dd>\n", k + 1, tree(value));
            let entries: String = values.iter().enumerate().map(entry).collect();
            format!("<dl class=\"tree\">{entries}</dl>")
        }
        Value::Array(values) => values.iter().map(tree).collect::<Vec<_>>().join(", "),
        Value::String(text) => escape(text),
        Value::Number(number) => escape(&number.to_string()),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        Value::Null => "–".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_values_are_escaped_and_nulls_left_out() {
        let value =
            serde_json::json!({"a_b": "<b>", "<i>": [1, 2.5], "none": null, "many": [{"x": true}, {"x": false}]});
        let html = tree(&value);
        assert!(html.contains("<dt>a b</dt><dd>&lt;b&gt;</dd>"), "{html}");
        assert!(html.contains("<dt>&lt;i&gt;</dt><dd>1, 2.5</dd>"), "{html}");
        assert!(html.contains("<dt>2</dt><dd><dl class=\"tree\"><dt>x</dt><dd>no</dd>"), "{html}");
        assert!(!html.contains("none"));
        assert!(roxmltree::Document::parse(&html).is_ok());
    }
}
