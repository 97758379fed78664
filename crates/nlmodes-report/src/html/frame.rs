//! The page around its sections: head, policy, style, data and script.

use super::data::Data;
use super::sections::Section;
use crate::svg::escape;

const STYLE: &str = include_str!("page/page.css");
const SCRIPT: &str = concat!(
    include_str!("page/element.js"),
    include_str!("page/scale.js"),
    include_str!("page/symbol.js"),
    include_str!("page/chart.js"),
    include_str!("page/branches.js"),
    include_str!("page/participation.js"),
    include_str!("page/histories.js"),
    include_str!("page/motion.js"),
    include_str!("page/start.js"),
);

/// SHA-256 of [`STYLE`] and [`SCRIPT`] in Base64: the page allows these two texts and nothing else, whatever a title may hold.
const STYLE_HASH: &str = "Q9s9zuy/Z8yaH/KnTkg1NbPYLFSGwO9gBZga+fePb4A=";
const SCRIPT_HASH: &str = "IuUXHrNsRJdn37QHOsOOL31UP2XPpBb1pUoR2LZfGzs=";

pub(super) fn page(title: &str, sections: &[Section], data: &Data) -> String {
    let policy = format!(
        "default-src 'none'; style-src 'sha256-{STYLE_HASH}'; script-src 'sha256-{SCRIPT_HASH}'; base-uri 'none'; form-action 'none'"
    );
    let (title, data) = (escape(title), data.json());
    let (head, body): (Vec<&Section>, Vec<&Section>) = sections.iter().partition(|section| section.title.is_empty());
    let overview: String = head.iter().map(|section| section.html.as_str()).collect();
    let links: String = body.iter().map(|s| format!("<a href=\"#{}\">{}</a>", s.id, s.title)).collect();
    let body: String =
        body.iter().map(|s| format!("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", s.id, s.title, s.html)).collect();
    let version = env!("CARGO_PKG_VERSION");
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
<header>
<h1>{title}</h1>
{overview}<nav aria-label="Sections">{links}</nav>
</header>
<main>
{body}</main>
<footer>Written by nlmodes {version}. This page is one file; it loads nothing and sends nothing.</footer>
<script type="application/json" id="data">{data}</script>
<script>{SCRIPT}</script>
</body>
</html>
"#
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::Engine;
    use base64::prelude::BASE64_STANDARD;
    use sha2::{Digest, Sha256};

    fn hash(text: &str) -> String {
        BASE64_STANDARD.encode(Sha256::digest(text))
    }

    #[test]
    fn hashes_of_the_policy_are_those_of_style_and_script() {
        assert_eq!(STYLE_HASH, hash(STYLE), "STYLE_HASH");
        assert_eq!(SCRIPT_HASH, hash(SCRIPT), "SCRIPT_HASH");
    }

    #[test]
    fn script_and_style_cannot_end_their_elements() {
        for text in [SCRIPT, STYLE] {
            assert!(!text.contains("</") && !text.contains("<!--"));
        }
    }
}
