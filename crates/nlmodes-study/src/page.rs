//! The page of a study: its contents, in the common frame of all pages.

mod data;
mod first_order;
mod sections;

use nlmodes::report::Page;

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
pub fn page(study: &Study, collected: &Collected) -> String {
    let head = sections::overview(study, collected);
    let statistics = sections::statistics(&collected.statistics);
    let first_order = collected.first_order.as_ref().map_or_else(String::new, first_order::section);
    let body = format!(
        r#"<noscript><p class="outcome early">Figures and table of this page are drawn by its script; the numbers are in
study.csv too.</p></noscript>
<section id="figures"></section>
<section id="statistics"><h2>Spread and sensitivity</h2>
{statistics}</section>
{first_order}<section id="cases"></section>
"#
    );
    let data = data::json(study, collected);
    Page { title: &study.title, head: &head, body: &body, style: STYLE, script: SCRIPT, data: &data }.render()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn script_and_style_cannot_end_their_elements() {
        assert!(!STYLE.contains("</") && !SCRIPT.to_lowercase().contains("</script") && !SCRIPT.contains("<!--"));
        assert!(!SCRIPT.contains("innerHTML") && !SCRIPT.contains("eval("));
    }
}
