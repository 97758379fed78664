//! The page of a study: one file that loads nothing.

mod data;
mod sections;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

use crate::collect::Collected;
use crate::study::Study;

const STYLE: &str = include_str!("page/page.css");
const SCRIPT: &str = concat!(
    include_str!("page/element.js"),
    include_str!("page/plot.js"),
    include_str!("page/figures.js"),
    include_str!("page/cases.js"),
    include_str!("page/start.js"),
);

/// The page: table, scatter of any two columns, histogram and quantiles, sensitivities, all branches with percentiles.
///
/// All texts are escaped, and a content security policy allows this page's own script and style alone.
pub fn page(study: &Study, collected: &Collected) -> String {
    let [style, script] = [STYLE, SCRIPT].map(|text| BASE64_STANDARD.encode(Sha256::digest(text)));
    let policy = format!(
        "default-src 'none'; style-src 'sha256-{style}'; script-src 'sha256-{script}'; base-uri 'none'; form-action 'none'"
    );
    let (title, version) = (escape(&study.title), env!("CARGO_PKG_VERSION"));
    let (overview, statistics) = (sections::overview(study, collected), sections::statistics(&collected.statistics));
    let data = data::json(study, collected);
    format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<meta http-equiv="Content-Security-Policy" content="{policy}"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<meta name="generator" content="nlmodes {version}"/>
<title>{title}</title>
<style>{STYLE}</style>
</head>
<body>
<header><h1>{title}</h1>
{overview}</header>
<main>
<noscript><p class="warn">Figures and table of this page are drawn by its script; the numbers are in study.csv too.</p></noscript>
<section id="figures"></section>
<section id="statistics"><h2>Spread and sensitivity</h2>
{statistics}</section>
<section id="cases"></section>
</main>
<footer>Written by nlmodes {version}. This page is one file; it loads nothing and sends nothing.</footer>
<script type="application/json" id="data">{data}</script>
<script>{SCRIPT}</script>
</body>
</html>
"#
    )
}

/// Text that stands in the page.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn script_and_style_cannot_end_their_elements() {
        assert!(!STYLE.contains("</") && !SCRIPT.to_lowercase().contains("</script") && !SCRIPT.contains("<!--"));
        assert!(!SCRIPT.contains("innerHTML") && !SCRIPT.contains("eval("));
    }

    #[test]
    fn titles_are_escaped() {
        assert_eq!(escape("<a b=\"c\">&"), "&lt;a b=&quot;c&quot;&gt;&amp;");
    }
}
