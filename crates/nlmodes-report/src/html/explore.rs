//! The page on which a scene is changed with sliders and its branch recomputed: three files served from one origin,
//! which load nothing else.

use crate::svg::escape;
use serde_json::Value;

/// The style, `explore.css`.
pub const STYLE: &str = concat!(include_str!("page/page.css"), include_str!("page/explore.css"));

/// The script, `explore.js`.
pub const SCRIPT: &str = concat!(
    include_str!("page/element.js"),
    include_str!("page/packed.js"),
    include_str!("page/scale.js"),
    include_str!("page/symbol.js"),
    include_str!("page/smooth.js"),
    include_str!("page/names.js"),
    include_str!("page/save.js"),
    include_str!("page/chart.js"),
    include_str!("page/branches.js"),
    include_str!("page/player.js"),
    include_str!("page/motion.js"),
    include_str!("page/effects.js"),
    include_str!("page/explore.js"),
);

/// Content policy of the page: only from the same origin.
pub const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; base-uri \
    'none'; form-action 'none'; frame-ancestors 'none'";

/// The page, with its sliders: `[{ key, label, unit, kind, from, to, value }]`.
pub fn page(title: &str, sliders: &Value) -> String {
    let title = escape(title);
    let sliders = sliders.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026");
    format!(
        r#"<!DOCTYPE html>
<html lang="en" class="live">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<title>{title}</title>
<link rel="stylesheet" href="explore.css"/>
</head>
<body>
<header><h1>{title}</h1><p id="state" class="quiet" role="status">computing …</p></header>
<main class="explore">
<form id="sliders" class="box" aria-label="Values of the scene"></form>
<div><div class="box"><h2 class="plain">Frequency over averaged kinetic energy</h2><div id="levels"></div>
<div id="curve" class="plot"></div></div>
<div class="box"><div id="controls" class="controls"></div><div id="motion"></div></div></div>
<div><div id="effects" class="box" hidden></div><div id="details" class="box"></div></div>
</main>
<script type="application/json" id="settings">{sliders}</script>
<script src="explore.js"></script>
</body>
</html>
"#
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn braces_of_the_style_are_closed_where_they_are_opened() {
        // One too many takes the next rule with it.
        let mut depth = 0_i32;
        for c in STYLE.chars() {
            depth += i32::from(c == '{') - i32::from(c == '}');
            assert!((0..=2).contains(&depth));
        }
        assert_eq!(depth, 0);
    }
}
