//! What gradients say, as a section of the page.

use nlmodes::report::escape;
use nlmodes_scene::number;

use crate::first_order::{Effect, FirstOrder, OfQuantity};
use crate::store::Store;

/// The section; with the reason where there is nothing.
pub fn section(first_order: &FirstOrder) -> String {
    let body = match &first_order.reason {
        Some(reason) => format!("<p>{}</p>\n", escape(reason)),
        None => {
            let note = "<p class=\"quiet\">With the variables at their means, and independent tolerances; corners are \
                those of the box of tolerances.</p>\n";
            note.to_owned() + &first_order.quantities.iter().map(quantity).collect::<String>()
        }
    };
    format!("<section id=\"first-order\"><h2>By gradients</h2>\n{body}</section>\n")
}

fn quantity(of: &OfQuantity) -> String {
    let mut text = format!("<h3>{}</h3>\n", escape(&of.quantity));
    let (Some(value), Some(std), None) = (of.value, of.std, &of.reason) else {
        let reason = of.reason.as_deref().unwrap_or("the case with the means does not have it");
        return text + &format!("<p>It has no gradient: {}</p>\n", escape(reason));
    };
    text += &format!("<p>{} at the means, standard deviation {std:.3e}", number(value));
    text += &of.of_cases.map_or_else(String::new, |cases| format!("; {}", escape(&cases.to_string())));
    text += "</p>\n<table><thead><tr><th>variable</th><th>mean</th><th>standard deviation</th><th>derivative</th>\
        <th>for one deviation</th><th>share of the variance</th><th>Sobol’ index less that</th></tr></thead>";
    text += &of.effects.iter().map(effect).collect::<String>();
    text += "</table>\n<ul>";
    for corner in &of.corners {
        let said = escape(&corner.to_string());
        text += &match corner.case.as_str() {
            "" => format!("<li>{said}</li>"),
            id => format!("<li>{said} (<a href=\"{}/\">case</a>)</li>", Store::link(id)),
        };
    }
    text += &of.limit.as_ref().map_or_else(String::new, |kept| format!("<li>{}</li>", escape(&kept.to_string())));
    text + "</ul>\n"
}

fn effect(effect: &Effect) -> String {
    let share = effect.share.map_or_else(|| "–".to_owned(), |share| format!("{:.1} %", 100.0 * share));
    let index = effect.index_less_share;
    let index = index.map_or_else(|| "–".to_owned(), |[less, error]| format!("{less:+.4} ± {error:.4}"));
    format!(
        "<tr><th>{}</th><td class=\"number\">{}</td><td class=\"number\">{:.3e}</td><td class=\"number\">{:.4e}</td>\
         <td class=\"number\">{:+.3e}</td><td class=\"number\">{share}</td><td class=\"number\">{index}</td></tr>",
        escape(&effect.variable),
        number(effect.mean),
        effect.std,
        effect.derivative,
        effect.derivative * effect.std,
    )
}
