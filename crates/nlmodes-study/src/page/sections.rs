//! Parts of the page without script.

use nlmodes::report::escape;
use nlmodes_scene::number;

use crate::collect::Collected;
use crate::statistics::Statistics;
use crate::study::Study;

/// What was computed, and how much of it exists.
pub fn overview(study: &Study, collected: &Collected) -> String {
    let counts = collected.counts;
    let card = |n: usize, name: &str| format!("<li><strong>{n}</strong><span>{name}</span></li>");
    let mut cards = card(counts.cases, "cases") + &card(counts.complete, "complete");
    for (n, name) in [
        (counts.incomplete, "ended early"),
        (counts.failed, "failed"),
        (counts.damaged, "damaged"),
        (counts.missing, "missing"),
    ] {
        if n > 0 {
            cards += &card(n, name);
        }
    }
    let design = &study.design;
    let drawn = if design.kind.is_sampled() {
        format!(", {} samples, seed {}", design.samples, design.seed)
    } else {
        String::new()
    };
    let names: Vec<String> = study.variables.iter().map(|variable| escape(&variable.name)).collect();
    format!(
        "<p class=\"quiet\">{} over {} ({}{drawn})</p>\n<ul class=\"cards\">{cards}</ul>\n",
        escape(&study.scene_name),
        names.join(", "),
        design.kind.name(),
    )
}

/// Scatter and sensitivity of each quantity.
pub fn statistics(all: &[Statistics]) -> String {
    let one = |statistics: &Statistics| format!("<h3>{}</h3>\n{}", escape(&statistics.quantity), of_one(statistics));
    all.iter().map(one).collect()
}

fn of_one(statistics: &Statistics) -> String {
    let Some(spread) = &statistics.spread else { return "<p>No case has it.</p>\n".into() };
    let row = |name: &str, value: String| format!("<tr><th>{name}</th><td class=\"number\">{value}</td></tr>");
    if spread.count < 2 {
        return format!("<p>{} in its only case.</p>\n", number(spread.mean));
    }
    let mut rows = row("values", spread.count.to_string());
    rows += &row("mean", format!("{} ± {:.1e}", number(spread.mean), spread.mean_error));
    rows += &row("standard deviation", format!("{:.4e}", spread.std));
    rows += &row("smallest, largest", format!("{}, {}", number(spread.min), number(spread.max)));
    for [share, value] in &spread.quantiles {
        rows += &row(&format!("{} % below", number(100.0 * share)), number(*value));
    }
    if statistics.without > 0 {
        rows += &row("cases without it", statistics.without.to_string());
    }
    format!("<div class=\"pair\"><table>{rows}</table>\n{}</div>\n", sensitivity(statistics))
}

fn sensitivity(statistics: &Statistics) -> String {
    let mut text = statistics.independence().map_or_else(String::new, |said| format!("<p>{}</p>\n", escape(&said)));
    if !statistics.rank_correlations.is_empty() {
        text += "<table><thead><tr><th>variable</th><th>rank correlation</th><th>95 % interval</th></tr></thead>";
        for found in &statistics.rank_correlations {
            let [low, high] = found.measure.interval;
            text += &format!(
                "<tr><th>{}</th><td class=\"number\">{:.3}</td><td class=\"number\">{low:.3} to {high:.3}</td></tr>",
                escape(&found.variable),
                found.measure.rho
            );
        }
        text += "</table>\n";
    }
    if !statistics.sobol_indices.is_empty() {
        text += &statistics
            .expansion
            .as_ref()
            .map_or_else(String::new, |own| format!("<p>{}</p>\n", escape(&own.to_string())));
        text += "<table><thead><tr><th>variable</th><th>Sobol’ index by itself</th><th>in total</th></tr></thead>";
        for found in &statistics.sobol_indices {
            let index = found.measure;
            text += &format!(
                "<tr><th>{}</th><td class=\"number\">{:.4} ± {:.1e}</td><td class=\"number\">{:.4} ± {:.1e}</td></tr>",
                escape(&found.variable),
                index.first,
                index.first_error,
                index.total,
                index.total_error
            );
        }
        text += "</table>\n";
    }
    if statistics.blocks_left_out > 0 {
        text += &format!(
            "<p>{} blocks of the design are left out: a case in them does not have it.</p>",
            statistics.blocks_left_out
        );
    }
    format!("<div>{text}</div>")
}
