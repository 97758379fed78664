//! Axes with any column, overlaid results, and the main figure of a page.

use super::*;

#[test]
fn axes_show_any_column_and_other_results_lie_over_the_curves() {
    let (_folder, path) = page();
    let Some(browser) = Browser::open(&path, WINDOW, &[]) else { return };
    let [exact, _] = branches();
    // Ordinate first.
    browser.run(
        "const s = document.querySelectorAll('.axes')[0].querySelectorAll('select'); s[0].value = 'amplitude'; \
            s[0].dispatchEvent(new Event('change'))",
    );
    let title = "return document.querySelector('#energy').closest('.box').querySelector('h3').textContent";
    assert_eq!(browser.text(title), "Modal amplitude over averaged kinetic energy");
    let y = axis(&browser, "energy", "y");
    let drawn = browser.text("return document.querySelector('#energy path.curve').getAttribute('d')");
    let first: f64 = drawn[1..].split([',', 'C']).nth(1).unwrap().parse().unwrap();
    let top = browser.number("return document.querySelector('#energy svg').getBoundingClientRect().top");
    assert!((y(exact.points[0].modal_amplitude) - top - first).abs() < 1.5, "{drawn:.60}");
    // A test that is one per cent softer.
    let measured = |points: &[usize]| -> String {
        let row = |k: &usize| {
            format!("r{k},{:e},{:e}\n", 0.99 * exact.points[*k].omega / TAU, exact.points[*k].modal_amplitude)
        };
        "record,frequency_hz,modal_amplitude\n".to_owned() + &points.iter().map(row).collect::<String>()
    };
    let drop = |name: &str, text: &str| {
        browser.run(&format!(
            "const d = new DataTransfer(); d.items.add(new File([{}], '{name}')); \
             document.dispatchEvent(new DragEvent('drop', {{ dataTransfer: d, cancelable: true }}))",
            serde_json::Value::from(text)
        ))
    };
    drop("test.csv", &measured(&[20, 40, 60, 80, 100]));
    assert!(wait_for(&browser, "return document.querySelector('#lay').innerText.includes('softer than exact <b>')"));
    assert!(browser.text("return document.querySelector('#lay').innerText").contains("−1.00 % at 5 points"));
    assert!(browser.text("return document.querySelector('#legend').innerText").contains("test.csv"));
    // With few points the range is stated.
    drop("few.csv", &measured(&[20, 60, 100]));
    assert!(wait_for(&browser, "return document.querySelector('#lay').innerText.includes('−1.00 % at 3 points')"));
    drop("other.csv", "a,b\n1,2\n");
    assert!(wait_for(&browser, "return document.querySelector('#lay').innerText.includes('no column frequency_hz')"));
    assert_eq!(browser.console(), Vec::<Value>::new());
}

/// A page that is about an amplitude over the frequency: points are hovered and selected there, the numbers are visible
/// beside it, events are explained.
#[test]
fn the_figure_that_a_page_is_about_is_hovered_and_chosen() {
    let (folder, [exact, _]) = (tempfile::tempdir().unwrap(), branches());
    let path = folder.path().join("report.html");
    let still = nlmodes_report::BranchFigure::new(nlmodes_report::Abscissa::Energy, &[&exact]).render().unwrap();
    let levels = (0..exact.points.len()).map(|k| 0.5 * k as f64).collect();
    let all = [&exact];
    let report = HtmlReport::new("Responses", &all).clamped_at(&[0.0]).contact_motion(&contact_motion);
    let report = report.quantity("level in m/s²", vec![levels]).quantity("too short in m", vec![vec![1.0]]);
    report.main_figure("Level over frequency", still, ["frequency", "quantity0"]).write(&path).unwrap();
    let Some(browser) = Browser::open(&path, WINDOW, &[]) else { return };
    assert_eq!(
        browser.text("return document.querySelector('#main').closest('.box').querySelector('h3').textContent"),
        "Level over frequency"
    );
    show(&browser, "#main");
    let (x, y) = (axis(&browser, "main", "x"), axis(&browser, "main", "y"));
    let at = |k: usize| (x(exact.points[k].omega / TAU), y(0.5 * k as f64));
    browser.point_at(at(90));
    let said = browser.text("return document.querySelector('#main .tip').innerText");
    assert!(said.contains("point 90") && said.contains("level: 45.000 m/s²"), "{said}");
    // The values are above or below the pointer, close to it.
    let [tip, near] = ["top", "bottom"].map(|side| {
        browser.number(&format!("return document.querySelector('#main .tip').getBoundingClientRect().{side}"))
    });
    let (_, pointer) = at(90);
    assert!((near - pointer).abs().min((tip - pointer).abs()) < 25.0, "{tip} to {near} beside {pointer}");
    assert!(!browser.text("return document.querySelector('.axes').innerText").contains("too short"));
    browser.click(at(70));
    assert_eq!(browser.text("return document.querySelector('#details h3').textContent"), "Point 70");
    let edge = |selector: &str, side: &str| {
        browser.number(&format!("return document.querySelector('{selector}').getBoundingClientRect().{side}"))
    };
    assert!(edge("#details table", "top") >= 0.0 && edge("#details td", "bottom") <= f64::from(WINDOW.1));
    assert!(edge("#motion svg", "top") >= 0.0 && edge("#motion svg", "bottom") <= f64::from(WINDOW.1));
    // If there is no space above or below, the values are beside the pointer.
    browser.run("document.querySelector('#main svg.chart').scrollIntoView({ block: 'end' })");
    let (x, y) = (axis(&browser, "main", "x"), axis(&browser, "main", "y"));
    browser.point_at((x(exact.points[2].omega / TAU), y(1.0)));
    assert!(edge("#main .tip", "top") >= 0.0 && edge("#main .tip", "bottom") <= f64::from(WINDOW.1));
    // Hovering an event shows its meaning.
    let event = "document.querySelector('#legend .event')";
    browser.run(&format!("{event}.click()"));
    let meaning = browser.text("return document.querySelector('#legend [role=status]').textContent");
    assert!(meaning.starts_with("grazing: ") && meaning.len() > 20, "{meaning}");
    browser.run(&format!("{event}.click()"));
    assert_eq!(browser.text("return document.querySelector('#legend [role=status]').textContent"), "");
    assert_eq!(browser.console(), Vec::<Value>::new());
}
