//! The frame of a self-contained page: head, policy, style, data and script.

use crate::svg::escape;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

/// The common style of all pages.
pub(super) const STYLE: &str = include_str!("page/page.css");

/// A self-contained page: it loads nothing and sends nothing.
///
/// A content security policy permits only its own style and script, whatever a title or a value contains.
///
/// ```
/// let page = nlmodes_report::Page { title: "<A> & B", body: "<p>All of it.</p>", ..Default::default() };
/// let text = page.render();
/// assert!(text.contains("<title>&lt;A&gt; &amp; B</title>") && text.contains("default-src 'none'"));
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct Page<'a> {
    /// Title, as text.
    pub title: &'a str,
    /// Subtitle, as HTML.
    pub head: &'a str,
    /// Contents, as HTML.
    pub body: &'a str,
    /// Style in addition to the common one.
    pub style: &'a str,
    /// Script; it finds the data in the element `data`.
    pub script: &'a str,
    /// Data of the script, as JSON in which `<` and `&` are escaped.
    pub data: &'a str,
}

impl Page<'_> {
    /// The page.
    pub fn render(&self) -> String {
        let Self { head, body, script, data, .. } = self;
        let style = format!("{STYLE}{}", self.style);
        let [allowed_style, allowed_script] =
            [style.as_str(), script].map(|text| BASE64_STANDARD.encode(Sha256::digest(text)));
        let (title, version) = (escape(self.title), env!("CARGO_PKG_VERSION"));
        format!(
            r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'sha256-{allowed_style}';
 script-src 'sha256-{allowed_script}'; base-uri 'none'; form-action 'none'"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<meta name="generator" content="nlmodes {version}"/>
<title>{title}</title>
<style>{style}</style>
</head>
<body>
<header>
<h1>{title}</h1>
{head}</header>
<main>
{body}</main>
<footer>Written by nlmodes {version}. This page is one file; it loads nothing and sends nothing.</footer>
<script type="application/json" id="data">{data}</script>
<script>{script}</script>
</body>
</html>
"#
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Separator between two texts.
    fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
        let (_, rest) = text.split_once(from).unwrap();
        rest.split_once(to).unwrap().0
    }

    #[test]
    fn the_policy_allows_style_and_script_as_they_stand() {
        let page = Page { style: "p { margin: 0; }", script: "const a = 1;", data: "{}", ..Page::default() }.render();
        let hash = |text: &str| BASE64_STANDARD.encode(Sha256::digest(text));
        assert_eq!(between(&page, "style-src 'sha256-", "'"), hash(between(&page, "<style>", "</style>")));
        assert_eq!(between(&page, "script-src 'sha256-", "'"), hash(between(&page, "<script>", "</script>")));
        assert!(page.contains("p { margin: 0; }</style>"));
    }

    #[test]
    fn the_common_style_cannot_end_its_element() {
        assert!(!STYLE.contains("</") && !STYLE.contains("<!--"));
    }
}
