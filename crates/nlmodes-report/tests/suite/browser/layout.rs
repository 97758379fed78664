//! Layout: no overlaps, tables end with a complete row, and lines are readable in a narrow window.

use super::*;

/// Places of an element: left, top, right, bottom.
fn edges(browser: &Browser, element: &str) -> [f64; 4] {
    let found =
        browser.run(&format!("const r = {element}.getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom]"));
    [0, 1, 2, 3].map(|k| found[k].as_f64().unwrap_or(f64::NAN))
}

/// A page with a main figure whose axes have long names, as that of responses.
fn responses(folder: &std::path::Path) -> std::path::PathBuf {
    let [exact, _] = branches();
    let path = folder.join("report.html");
    let still = nlmodes_report::BranchFigure::new(nlmodes_report::Abscissa::Energy, &[&exact]).render().unwrap();
    let levels = (0..exact.points.len()).map(|k| 0.5 * k as f64).collect();
    let all = [&exact];
    let report = HtmlReport::new("Responses", &all).clamped_at(&[0.0]).contact_motion(&contact_motion);
    let report = report.quantity("fundamental of the first contact in m", vec![levels]);
    report.main_figure("Level over frequency", still, ["frequency", "quantity0"]).write(&path).unwrap();
    path
}

#[test]
fn no_button_lies_over_the_choice_of_axes_and_no_figure_over_its_neighbour() {
    let folder = tempfile::tempdir().unwrap();
    let path = responses(folder.path());
    for width in [1400, 1280, 1000, 600] {
        let Some(browser) = Browser::open(&path, (width, 1000), &[]) else { return };
        for k in 0..browser.number("return document.querySelectorAll('.axes label').length") as usize {
            let label = format!("document.querySelectorAll('.axes label')[{k}]");
            browser.run(&format!("{label}.scrollIntoView({{ block: 'center' }})"));
            let [_, top, right, bottom] = edges(&browser, &label);
            let (x, y) = (right - 2.0, 0.5 * (top + bottom));
            let seen = browser.run(&format!("return {label}.contains(document.elementFromPoint({x}, {y}))"));
            assert_eq!(seen.as_bool(), Some(true), "label {k} at {width} px ends below something else");
        }
        if width > 900 {
            let [.., right, _] = edges(&browser, "document.querySelector('#main').closest('.box')");
            let [left, ..] = edges(&browser, "document.querySelector('.beside')");
            assert!(right <= left, "at {width} px the figure ends at {right}, the column beside it begins at {left}");
        }
        let over = browser.number("return document.documentElement.scrollWidth - document.documentElement.clientWidth");
        assert!(over <= 0.0, "at {width} px the page is {over} px wider");
    }
}

#[test]
fn a_table_that_is_scrolled_ends_with_a_whole_row() {
    let [exact, _] = branches();
    let mut table = DataTable::new("Long", &["number", "words", "a number", "another number", "and a last one"]);
    // Rows of one to several lines; numbers do not wrap, so that a narrow window scrolls sideways too.
    let number = || "0.123456789".to_owned();
    table.rows =
        (0..60).map(|k| vec![k.to_string(), "some words ".repeat(1 + k % 23), number(), number(), number()]).collect();
    let mut short = DataTable::new("Short", &["number"]);
    short.rows = vec![vec!["1".into()]; 3];
    let (folder, all) = (tempfile::tempdir().unwrap(), [&exact]);
    let path = folder.path().join("report.html");
    HtmlReport::new(TITLE, &all).table(table).table(short).write(&path).unwrap();
    for width in [1400, 700, 420] {
        let Some(browser) = Browser::open(&path, (width, 1000), &[]) else { return };
        let section =
            |title: &str| format!("[...document.querySelectorAll('.scroll')].find(s => s.ariaLabel === '{title}')");
        let ends = format!(
            "const s = {}, end = s.getBoundingClientRect().top + s.clientHeight; \
             return s.scrollHeight > s.clientHeight && [...s.querySelectorAll('tr')].some(r => \
             Math.abs(r.getBoundingClientRect().bottom - end) < 1.5)",
            section("Long")
        );
        let places = "const s = document.querySelector('.scroll'); return JSON.stringify([s.clientHeight, \
            s.offsetHeight, s.scrollHeight, s.style.maxHeight, [...s.querySelectorAll('tr')].slice(0, 25).map(r => \
            r.offsetTop + r.offsetHeight)])";
        assert!(wait_for(&browser, &ends), "at {width} px the table ends within a row: {}", browser.text(places));
        let whole = browser.run(&format!("const s = {}; return s.scrollHeight <= s.clientHeight", section("Short")));
        assert_eq!(whole.as_bool(), Some(true));
    }
}

#[test]
fn a_scene_of_many_levels_has_lines_that_can_be_read_in_a_narrow_window() {
    let [exact, _] = branches();
    let (folder, all) = (tempfile::tempdir().unwrap(), [&exact]);
    let path = folder.path().join("report.html");
    let section = serde_json::json!({ "area": 2.4e-4, "second_moment": 8e-9, "shear_factor": 0.833_333_333_333_333_4 });
    let structure = serde_json::json!({ "length": 0.629_755_2, "mass_matrix": "consistent", "section": section });
    let scene = serde_json::json!({ "title": "Beam", "structure": structure, "contacts": [{ "gap": 1e-3 }] });
    HtmlReport::new(TITLE, &all).document("Scene", &scene).unwrap().write(&path).unwrap();
    let Some(browser) = Browser::open(&path, (420, 900), &[]) else { return };
    assert!(browser.number("return innerWidth") <= 520.0, "the window is not narrow");
    let narrowest = browser.number(
        "return Math.min(...[...document.querySelectorAll('.scene dd:not(.parts)')].map(d => \
            d.getBoundingClientRect().width))",
    );
    // A number of nine digits with its unit at 14 px.
    assert!(narrowest > 90.0, "{narrowest} px");
}
