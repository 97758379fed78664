//! The page in a real browser: its appearance, mouse and keyboard actions, and the absence of network requests.
//!
//! Without Chromium and ChromeDriver on the path the tests print a note and pass.

mod axes;
mod driver;
mod layout;
#[allow(dead_code, reason = "samples of all kinds, of which the page needs some")]
use crate::report::samples;

use driver::Browser;
use nlmodes_modal::{ModalBranch, Participation, TimeHistory};
use nlmodes_report::{DataTable, HtmlReport, StopLine};
use serde_json::Value;
use std::f64::consts::TAU;
use tempfile::TempDir;

const OMEGA_0: f64 = TAU * 60.0;
const WINDOW: (u32, u32) = (1400, 1000);
/// A title that breaks out of every element in which it is not escaped.
const TITLE: &str = "Rod </title></script><script>document.title='broken'</script><img src=x \
    onerror=\"document.title='broken'\"> & \"stop\"";

/// Largest deflection of point `k` of the first branch, m.
fn amplitude(k: usize) -> f64 {
    samples::STOP * (1.0 + 2.0 * (k as f64 / 120.0).powi(2))
}

/// Displacement of the tip at a phase from 0 to 1: one flight from the stop to the stop.
fn tip(k: usize, phase: f64) -> f64 {
    let (time, omega) = (phase - phase.round(), samples::omega(amplitude(k)));
    -amplitude(k) * (OMEGA_0 * time * TAU / omega).cos()
}

fn contact_motion(branch: usize, point: usize) -> Option<Vec<TimeHistory>> {
    let phases: Vec<f64> = (0..=128).map(|j| f64::from(j) / 128.0).collect();
    let displacement: Vec<f64> = phases.iter().map(|phase| tip(point, *phase)).collect();
    let zeros = || vec![0.0; 129];
    let history = || TimeHistory {
        label: String::new(),
        velocity: zeros(),
        acceleration: zeros(),
        force: phases.iter().map(|phase| f64::from(u8::from((phase - 0.5).abs() < 0.05))).collect(),
        displacement,
        time: phases,
        stop: samples::STOP,
        instants: Vec::new(),
    };
    (branch == 0).then(|| vec![history()])
}

fn branches() -> [ModalBranch; 2] {
    let mut exact = samples::rod(120, 8);
    exact.label = "exact <b>".into();
    [exact, samples::looped(200)]
}

/// Participation of two modes.
fn participation(branch: &ModalBranch) -> Vec<Participation> {
    let shares = |k: usize| vec![1.0 - 1e-3 * k as f64, 1e-4 * k as f64];
    let of = |k: usize| Participation {
        factors: shares(k),
        quadrature: vec![0.0; 2],
        harmonics: 1..=3,
        energy_shares: shares(k),
    };
    (0..branch.points.len()).map(of).collect()
}

/// The page in a folder that lasts as long as the first value.
fn page() -> (TempDir, std::path::PathBuf) {
    let [exact, looped] = branches();
    let (all, history) = ([&exact, &looped], samples::history("stop", 2.3e6));
    let softer = samples::history("softer stop", 2.3e5);
    let factors = [participation(&exact), participation(&looped)];
    let factors = factors.each_ref().map(Vec::as_slice);
    let mut table = DataTable::new("Linear <frequencies>", &["mode", "Hz"]);
    table.rows.push(vec!["1".into(), "60.0".into()]);
    let report =
        HtmlReport::new(TITLE, &all).line("three harmonics").clamped_at(&[0.0]).contact_motion(&contact_motion);
    let report =
        report.mark(0, 30, "P1").histories("P1 <i>", &[&history, &softer]).participation(&factors).table(table);
    let report = report.document("Scene", &serde_json::json!({ "title": TITLE, "length": 20.0 })).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    report.write(&path).unwrap();
    (folder, path)
}

/// Position of a value on an axis of the figure `id`, in pixels of the window: a straight line through the labelled
/// ticks.
fn axis(browser: &Browser, id: &str, axis: &str) -> impl Fn(f64) -> f64 + use<> {
    let middle = if axis == "x" { "r.left + r.width / 2" } else { "r.top + r.height / 2" };
    let ticks = browser.run(&format!(
        "return [...document.querySelectorAll('#{id} .tick.{axis}')].map(t => {{ const r = t.getBoundingClientRect(); \
         return [Number(t.dataset.value), {middle}]; }})"
    ));
    let tick = |value: &Value| (value[0].as_f64().unwrap(), value[1].as_f64().unwrap());
    let ticks: Vec<(f64, f64)> = ticks.as_array().unwrap().iter().map(tick).collect();
    let logarithmic = id == "energy" && axis == "x";
    let place = move |value: f64| if logarithmic { value.log10() } else { value };
    let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
    assert!(ticks.len() > 2, "{ticks:?}");
    move |value| first.1 + (place(value) - place(first.0)) / (place(last.0) - place(first.0)) * (last.1 - first.1)
}

/// Values of the labelled ticks of an abscissa.
fn ticks(browser: &Browser, id: &str) -> Vec<f64> {
    let values = browser
        .run(&format!("return [...document.querySelectorAll('#{id} .tick.x')].map(t => Number(t.dataset.value))"));
    values.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

/// Scrolls an element to the middle of the window.
fn show(browser: &Browser, selector: &str) {
    browser.run(&format!("document.querySelector('{selector}').scrollIntoView({{ block: 'center' }})"));
}

/// Pixels of a point of the first branch in the figure over energy.
fn pixels(browser: &Browser, branch: &ModalBranch, point: usize) -> (f64, f64) {
    let (x, y) = (axis(browser, "energy", "x"), axis(browser, "energy", "y"));
    let point = &branch.points[point];
    (x(point.kinetic_energy), y(point.omega / TAU))
}

#[test]
fn figures_are_there_and_nothing_is_asked_of_a_network() {
    let (_folder, path) = page();
    let Some(browser) = Browser::open(&path, WINDOW, &[]) else { return };
    assert_eq!(browser.text("return document.title"), TITLE);
    assert_eq!(browser.text("return document.querySelector('h1').textContent"), TITLE);
    assert_eq!(browser.number("return document.querySelectorAll('img, iframe, link, object').length"), 0.0);
    assert_eq!(browser.number("return document.querySelectorAll('script').length"), 2.0);
    for figure in ["#energy", "#amplitude", "#participation", "#motion", "#contact", "[data-history]"] {
        let lines = format!("return document.querySelectorAll('{figure} svg :is(polyline, path)').length");
        assert!(browser.number(&lines) >= 1.0, "{figure}");
        let area = format!(
            "return Math.max(...[...document.querySelectorAll('{figure} svg')].map(s => {{ \
             const r = s.getBoundingClientRect(); return r.width * r.height; }}))"
        );
        assert!(browser.number(&area) > 40_000.0, "{figure}");
    }
    // Two branches in each of two panels; two histories in each of four.
    for (figure, curves) in [("#participation", 4.0), ("[data-history]", 8.0)] {
        let lines = format!("return document.querySelectorAll('{figure} svg .curve').length");
        assert!(browser.number(&lines) >= curves, "{figure}");
    }
    // The static figures are replaced by the interactive ones.
    assert_eq!(
        browser.number("return [...document.querySelectorAll('.still')].filter(s => s.offsetHeight).length"),
        0.0
    );
    let invalid = "return document.body.innerHTML.match(/(NaN|Infinity|undefined)[^<>]*/)?.[0] ?? ''";
    let body = format!(
        "document.getElementById('data').remove(); document.querySelectorAll('script').forEach(s => s.remove()); \
            {invalid}"
    );
    assert_eq!(browser.text(&body), "");
    assert_eq!(browser.number("return performance.getEntriesByType('resource').length"), 0.0);
    let requests = browser.requests();
    let own = format!("file://{}", path.display());
    assert!(requests.iter().all(|address| *address == own || address.starts_with("data:")), "{requests:?}");
    assert!(requests.contains(&own));
    assert_eq!(browser.console(), Vec::<Value>::new());
}

#[test]
fn policy_refuses_what_the_page_did_not_bring() {
    let (_folder, path) = page();
    let Some(browser) = Browser::open(&path, WINDOW, &[]) else { return };
    let inject = "const s = document.createElement('script'); s.textContent = 'document.title = \"broken\"'; \
        document.body.append(s); \
        const i = new Image(); i.src = 'http://127.0.0.1:9/x.png'; document.body.append(i); return document.title";
    assert_eq!(browser.text(inject), TITLE);
    let refusals = browser.console();
    assert!(
        refusals.len() >= 2 && refusals.iter().all(|line| line.to_string().contains("Content Security Policy")),
        "{refusals:?}"
    );
}

#[test]
fn hovering_tells_the_values_of_the_point() {
    let (_folder, path) = page();
    let Some(browser) = Browser::open(&path, WINDOW, &[]) else { return };
    let [exact, _] = branches();
    show(&browser, "#energy");
    for k in [0, 47, 103] {
        browser.point_at(pixels(&browser, &exact, k));
        let said = browser.text("return document.querySelector('#energy .tip').innerText");
        let point = &exact.points[k];
        let energy = 0.25 * 2.0 * (OMEGA_0 * amplitude(k)).powi(2);
        let frequency = samples::omega(amplitude(k)) / TAU;
        let expected = [
            format!("exact <b>: point {k}\n"),
            format!("frequency: {frequency:.5} Hz"),
            format!(
                "averaged kinetic energy: {} J",
                if energy < 1e5 {
                    format!("{energy:.0}")
                } else {
                    format!("{:.4}\u{2009}×\u{2009}10⁵", energy / 1e5)
                }
            ),
            format!("modal amplitude: {:.5}", point.modal_amplitude),
            "contact fraction: 0 %".into(),
        ];
        // Four decimals at the leading digit before the point.
        for text in expected {
            assert!(said.contains(text.trim_end_matches(char::is_numeric)), "{text} in {said}");
        }
        assert_eq!(said.contains("event: grazing"), k == 0);
        // The same point is shown in the other figure.
        assert_eq!(browser.number("return document.querySelectorAll('#amplitude .hovered').length"), 1.0);
    }
    browser.point_at((5.0, 5.0));
    assert!(browser.run("return document.querySelector('#energy .tip').hidden").as_bool().unwrap());
}

#[test]
fn wheel_drag_and_double_click_change_the_view() {
    let (_folder, path) = page();
    let Some(browser) = Browser::open(&path, WINDOW, &[]) else { return };
    let [exact, _] = branches();
    show(&browser, "#energy");
    let (whole, (x, y)) = (ticks(&browser, "energy"), pixels(&browser, &exact, 60));
    let scroll = browser.number("return scrollY");
    (0..4).for_each(|_| browser.wheel((x, y), -200));
    let span = |ticks: &[f64]| ticks[ticks.len() - 1] / ticks[0];
    let zoomed = ticks(&browser, "energy");
    assert!(span(&zoomed).ln() < 0.5 * span(&whole).ln(), "{zoomed:?} {whole:?}");
    assert_eq!(browser.number("return scrollY"), scroll);
    // The point under the mouse is fixed; the wheel has whole pixels only, and ordinate labels are half a pixel off.
    let there = pixels(&browser, &exact, 60);
    assert!((there.0 - x).abs() < 4.0 && (there.1 - y).abs() < 6.0, "{there:?} {x} {y}");
    browser.double_click((x, y));
    assert_eq!(ticks(&browser, "energy"), whole);
    let (from, to) = (pixels(&browser, &exact, 20), pixels(&browser, &exact, 70));
    browser.drag((from.0, from.1 + 15.0), (to.0, to.1 - 15.0));
    let part = ticks(&browser, "energy");
    let ends = [exact.points[20].kinetic_energy, exact.points[70].kinetic_energy];
    assert!(part.iter().all(|value| (0.98 * ends[0]..1.02 * ends[1]).contains(value)), "{part:?} {ends:?}");
    browser.run("document.querySelector('#energy svg').focus()");
    browser.keys("0");
    assert_eq!(ticks(&browser, "energy"), whole);
    browser.keys("++");
    assert!(span(&ticks(&browser, "energy")) < span(&whole));
}

#[test]
fn structure_moves_as_computed_and_stops_when_asked() {
    let (_folder, path) = page();
    let Some(browser) = Browser::open(&path, WINDOW, &[]) else { return };
    let [exact, _] = branches();
    let shape = "return document.querySelector('#motion .structure').getAttribute('points')";
    let frames: Vec<String> = (0..40).map(|_| browser.text(shape)).collect();
    assert!(frames.iter().any(|frame| *frame != frames[0]), "the structure stands still");
    show(&browser, "#energy");
    browser.click(pixels(&browser, &exact, 80));
    assert_eq!(browser.text("return document.querySelector('#details h3').textContent"), "Point 80");
    browser.run("document.querySelector('.play').click(); document.querySelector('.phase').focus()");
    // Home, then 36 steps of one degree.
    browser.keys(&format!("\u{e011}{}", "\u{e014}".repeat(36)));
    assert_eq!(browser.text(shape), browser.text(shape));
    let reading = browser.text("return document.querySelector('#controls .reading').textContent");
    let value = reading.trim_start_matches("36°, contact node at ").trim_end_matches(" m").replace('−', "-");
    let (found, expected): (f64, f64) = (value.parse().expect(&reading), tip(80, 0.1));
    // Between samples of a 128th of a period the page draws straight lines, an error of (2π/128)²/8 of the amplitude at
    // most; it leaves out samples for another 2e-3 of it.
    let error = amplitude(80) * ((TAU / 128.0).powi(2) / 8.0 + 2e-3 + 2e-4);
    assert!((found - expected).abs() < error, "{found} {expected}");
    // The clamp does not move; the first coordinate next to it moves by its harmonics.
    let points = browser.text(shape);
    let heights: Vec<f64> = points.split(' ').map(|pair| pair.split_once(',').unwrap().1.parse().unwrap()).collect();
    let of_tip = (heights[heights.len() - 1] - heights[0]) / expected;
    let middle = exact.points[80].coefficients.value(38, TAU * 0.1);
    let index = 20;
    // Two decimals of a pixel, four digits of the motion.
    assert!(
        (heights[index] - heights[0] - of_tip * middle).abs() < 0.3,
        "{} {}",
        heights[index] - heights[0],
        of_tip * middle
    );
}

#[test]
fn the_reading_says_of_which_of_several_stops_it_is() {
    let [exact, _] = branches();
    let stop = |coordinate| StopLine { coordinate, position: samples::STOP, positive: true };
    let (folder, all) = (tempfile::tempdir().unwrap(), [&exact]);
    for (stops, said) in
        [(vec![stop(78)], "contact node at "), (vec![stop(78), stop(38)], "contact node of stop 0 at ")]
    {
        let path = folder.path().join(format!("{}.html", stops.len()));
        HtmlReport::new(TITLE, &all).clamped_at(&[0.0]).stops(&stops).write(&path).unwrap();
        let Some(browser) = Browser::open(&path, WINDOW, &[]) else { return };
        let reading = browser.text("return document.querySelector('#controls .reading').textContent");
        assert!(reading.contains(said), "{reading}");
    }
}

/// What a script returns as soon as it is true, two seconds at most.
fn wait_for(browser: &Browser, script: &str) -> bool {
    (0..40).any(|_| {
        let found = browser.run(script).as_bool() == Some(true);
        if !found {
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        found
    })
}

#[test]
fn a_click_moves_the_structure_beside_the_curve() {
    let (_folder, path) = page();
    let Some(browser) = Browser::open(&path, WINDOW, &[]) else { return };
    let [exact, _] = branches();
    show(&browser, "#energy");
    browser.click(pixels(&browser, &exact, 80));
    let place = |selector: &str, side: &str| {
        browser.number(&format!("return document.querySelector('{selector}').getBoundingClientRect().{side}"))
    };
    assert!(place("#motion svg", "left") >= place("#energy svg", "right"));
    assert!(place("#motion svg", "top") >= 0.0 && place("#motion svg", "bottom") <= f64::from(WINDOW.1));
    assert_eq!(browser.text("return document.querySelector('#details h3').textContent"), "Point 80");
}
