use crate::report::samples;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use nlmodes_modal::{ContactPeriod, Event, InternalResonance, ModalBranch, Participation, TimeHistory};
use nlmodes_report::{DataTable, HtmlReport, ReportError, StopLine};
use roxmltree::Document;

const HOSTILE: &str = "</script><script>alert(1)</script><b>\u{0}&\"'";

/// The text of the page without the contents of style and script, which are no XML, and without its document type.
fn markup(page: &str) -> String {
    let mut text = page.replace("<!DOCTYPE html>", "");
    for (open, close) in [("<style>", "</style>"), ("<script>", "</script>")] {
        let start = text.find(open).unwrap() + open.len();
        let end = start + text[start..].find(close).unwrap();
        text.replace_range(start..end, "");
    }
    text
}

fn data(page: &str) -> serde_json::Value {
    let text = markup(page);
    let document = Document::parse(&text).unwrap();
    let script = document.descendants().find(|node| node.attribute("id") == Some("data")).unwrap();
    serde_json::from_str(script.text().unwrap()).unwrap()
}

/// Rows of whole numbers with a factor: the factor, their length, and all of them as text.
fn rows(packed: &serde_json::Value) -> Vec<Vec<f64>> {
    let (scale, width) = (packed[0].as_f64().unwrap(), packed[1].as_u64().unwrap() as usize);
    let bytes = BASE64_STANDARD.decode(packed[2].as_str().unwrap()).unwrap();
    let number = |b: &[u8]| scale * f64::from(i16::from_le_bytes([b[0], b[1]]));
    bytes.chunks(2 * width).map(|row| row.chunks(2).map(number).collect()).collect()
}

/// A column of numbers of 32 bits as text.
fn column(packed: &serde_json::Value) -> Vec<f32> {
    let bytes = BASE64_STANDARD.decode(packed.as_str().unwrap()).unwrap();
    bytes.chunks(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

fn hostile() -> ModalBranch {
    let mut branch = samples::rod(12, 3);
    branch.label = HOSTILE.into();
    branch.end.message = HOSTILE.into();
    branch
}

#[test]
fn page_is_well_formed_and_every_text_is_escaped() {
    let (branch, history) = (hostile(), samples::history(HOSTILE, 2.3e6));
    let all = [&branch];
    let mut table = DataTable::new(HOSTILE, &[HOSTILE]);
    table.rows.push(vec![HOSTILE.into()]);
    let report =
        HtmlReport::new(HOSTILE, &all).line(HOSTILE).mark(0, 5, HOSTILE).history(HOSTILE, &history).table(table);
    let page = report.document(HOSTILE, &serde_json::json!({ HOSTILE: HOSTILE })).unwrap().render().unwrap();
    assert_eq!((page.matches("<script").count(), page.matches("alert(1)</script").count()), (2, 0));
    let text = markup(&page);
    let document = Document::parse(&text).unwrap();
    let heading = document.descendants().find(|node| node.tag_name().name() == "h1").unwrap();
    assert_eq!(heading.text(), Some(HOSTILE.replace('\u{0}', " ").as_str()));
    assert_eq!(data(&page)["branches"][0]["label"], HOSTILE);
}

#[test]
fn page_names_no_address_but_that_of_the_format() {
    let branch = samples::rod(12, 3);
    let page = HtmlReport::new("rod", &[&branch]).render().unwrap();
    let foreign = page.replace("http://www.w3.org/2000/svg", "");
    assert!(!foreign.contains("http:") && !foreign.contains("https:") && !foreign.contains("//www"));
    assert!(!foreign.contains(" src=") && !foreign.contains("@import") && !foreign.contains(" style="));
    assert_eq!(page.matches("<svg").count(), 3);
}

#[test]
fn values_that_are_not_finite_become_null_and_the_rest_stays() {
    let mut branch = samples::rod(12, 3);
    branch.points[4].omega = f64::NAN;
    branch.points[5].kinetic_energy = f64::INFINITY;
    branch.points[6].coefficients.of_mut(2)[1].re = f64::NAN;
    let page = HtmlReport::new("rod", &[&branch]).clamped_at(&[0.0]).render().unwrap();
    let data = data(&page);
    let branch_data = &data["branches"][0];
    assert!(branch_data["frequency"][4].is_null() && branch_data["energy"][5].is_null());
    let moving: Vec<u64> =
        branch_data["motion"]["points"].as_array().unwrap().iter().filter_map(|p| p.as_u64()).collect();
    assert_eq!(moving, [0, 1, 2, 3, 4, 5, 7, 8, 9, 10, 11]);
    let text = markup(&page);
    let document = Document::parse(&text).unwrap();
    for attribute in document.descendants().flat_map(|node| node.attributes()) {
        assert!(!attribute.value().contains("NaN") && !attribute.value().contains("inf"), "{}", attribute.value());
    }
}

#[test]
fn motion_on_the_page_is_that_of_the_branch_to_a_ten_thousandth() {
    let branch = samples::rod(12, 5);
    let data = data(&HtmlReport::new("rod", &[&branch]).clamped_at(&[0.0]).render().unwrap());
    let frame = &data["branches"][0]["motion"]["frames"][7]["motion"];
    let most = branch.points[7].coefficients.of(78).iter().fold(0.0, |m: f64, q| m.max(q.norm()));
    // Station 0 is the clamp; of two kinds of coordinates the page shows the axial ones.
    let rows = rows(&frame[0]);
    assert!(frame[1].is_null() && rows.len() == 41 && rows[0].iter().all(|q| *q == 0.0));
    for (station, row) in rows.iter().enumerate().skip(1) {
        for (n, q) in branch.points[7].coefficients.of(2 * (station - 1)).iter().enumerate() {
            let found = row.get(n).copied().unwrap_or(0.0);
            assert!((found - q.re).abs() <= 1e-4 * most, "{station} {n}");
        }
    }
}

#[test]
fn long_branch_keeps_points_with_events_and_a_sensible_size() {
    let mut branch = samples::rod(3000, 8);
    branch.points[1234].events.push(Event::Fold);
    let page = HtmlReport::new("rod", &[&branch]).mark(0, 1777, "P1").render().unwrap();
    let data = data(&page);
    let moving = data["branches"][0]["motion"]["points"].as_array().unwrap();
    assert!(moving.len() < 400 && [0, 1234, 1777, 2999].iter().all(|k| moving.contains(&(*k).into())));
    assert_eq!(data["branches"][0]["frequency"].as_array().unwrap().len(), 3000);
    assert!(page.len() < 4_000_000, "{}", page.len());
}

/// A contact that is closed for a fifth of the period, slightly later at each stop.
fn contact_histories(_: usize, point: usize) -> Option<Vec<TimeHistory>> {
    let time: Vec<f64> = (0..=600).map(|k| f64::from(k) / 600.0).collect();
    let history = |stop: usize| {
        let begin = 0.3 + 0.02 * stop as f64 + 1e-4 * point as f64;
        let blow = |t: &f64| (1.0 - ((t - begin - 0.1) / 0.1).powi(2)).max(0.0) * (1.0 + 0.3 * (60.0 * t).sin());
        TimeHistory {
            label: format!("stop {stop}"),
            displacement: time.iter().map(|t| 0.5 - 0.3 * (std::f64::consts::TAU * (t - begin)).cos()).collect(),
            velocity: vec![0.0; time.len()],
            acceleration: vec![0.0; time.len()],
            force: time.iter().map(blow).collect(),
            time: time.clone(),
            stop: samples::STOP,
            instants: Vec::new(),
        }
    };
    Some((0..10).map(history).collect())
}

#[test]
fn ten_branches_of_five_hundred_points_before_ten_stops_stay_under_five_megabytes() {
    let period = |stop: usize, point: usize| ContactPeriod {
        closed_share: 0.017 * stop as f64 + 1e-5 * point as f64,
        peak_force: 123.456_789 / (1 + stop) as f64,
        mean_force: 2.345_678_9,
        impulse: 3.456_789e-3 * (1 + point) as f64,
        touches: 3,
        approach_velocity: 0.123_456,
        sliding: None,
    };
    let rod = samples::rod(500, 12);
    let branch = |number: usize| {
        let mut branch = rod.clone();
        branch.label = format!("{number} harmonics");
        for (k, point) in branch.points.iter_mut().enumerate() {
            point.contacts = (0..10).map(|stop| period(stop, k)).collect();
            point.omega *= 1.0 + 1e-3 * (number * k) as f64 / 500.0;
            // With ten stops, contacts change at every third point.
            if k % 3 == 0 {
                point.events.push(Event::ContactChange);
            }
        }
        branch
    };
    let branches: Vec<ModalBranch> = (3..13).map(branch).collect();
    let all: Vec<&ModalBranch> = branches.iter().collect();
    let stop = |k: usize| StopLine { coordinate: 2 * (39 - 3 * k), position: samples::STOP, positive: true };
    let stops: Vec<StopLine> = (0..10).map(stop).collect();
    let report = HtmlReport::new("ten", &all).stops(&stops).contact_motion(&contact_histories);
    let page = report.render().unwrap();
    assert!(page.len() < 5_000_000, "{} bytes", page.len());
    let data = data(&page);
    for branch in data["branches"].as_array().unwrap() {
        let motion = &branch["motion"];
        let (points, frames) = (motion["points"].as_array().unwrap(), motion["frames"].as_array().unwrap());
        assert!(points.len() >= 12 && points.contains(&0.into()) && points.contains(&499.into()), "{points:?}");
        assert!(frames.iter().all(|frame| frame["contacts"].as_array().unwrap().len() == 10));
        assert_eq!(column(&branch["stops"][9]["force"])[77], 12.345_679);
    }
}

#[test]
fn measured_points_are_no_branch_and_the_tongue_at_an_end_that_was_asked_for_is_no_warning() {
    const DONE: &str = "<p class=\"outcome done\">";
    const EARLY: &str = "<p class=\"outcome early\">";
    let (computed, mut test) = (samples::looped(20), samples::rod(7, 1));
    test.label = "rig".into();
    let own = [&computed, &test];
    let page = HtmlReport::new("rod", &own).scattered(&[1]).render().unwrap();
    for text in
        ["rig: 7 measured points", "<strong>7</strong><span>measured points", "<strong>20</strong><span>points<"]
    {
        assert!(page.contains(text), "{text}");
    }
    assert!(!page.contains("on 2 branches") && page.contains(DONE));
    // Records alone.
    let page = HtmlReport::new("records", &own[1..]).scattered(&[0]).render().unwrap();
    assert!(page.contains("✓ All measured") && !page.contains("Complete"), "{}", &page[..3000]);
    test.end.complete = false;
    let page = HtmlReport::new("records", &[&test]).scattered(&[0]).render().unwrap();
    assert!(page.contains(EARLY) && page.contains("⚠ Not all measured"));
    let mut ended = samples::looped(20);
    ended.points.last_mut().unwrap().resonance = Some(InternalResonance { harmonic: 16, mode: 2 });
    let page = HtmlReport::new("rod", &[&ended]).render().unwrap();
    assert!(
        page.contains(DONE) && page.contains("on the internal-resonance branch 16:mode 2") && !page.contains(EARLY)
    );
    ended.end.complete = false;
    assert!(HtmlReport::new("rod", &[&ended]).render().unwrap().contains("⚠ Ended early"));
}

/// Participation of two modes, one of which has its sign changed at each point.
fn participation(branch: &ModalBranch) -> Vec<Participation> {
    let of = |k: usize| Participation {
        factors: vec![1.0 - 1e-3 * k as f64, if k.is_multiple_of(2) { 1e-3 } else { -1e-3 } * k as f64],
        quadrature: vec![0.0; 2],
        harmonics: 1..=3,
        energy_shares: vec![1.0 - 1e-3 * k as f64, 1e-3 * k as f64],
    };
    (0..branch.points.len()).map(of).collect()
}

#[test]
fn participation_has_a_panel_a_mode_and_a_curve_a_branch() {
    let (first, second) = (samples::rod(12, 3), samples::looped(20));
    let (all, factors) = ([&first, &second], [participation(&first), participation(&second)]);
    let slices = factors.each_ref().map(Vec::as_slice);
    let page = HtmlReport::new("rod", &all).participation(&slices).render().unwrap();
    let text = markup(&page);
    let document = Document::parse(&text).unwrap();
    let section = document.descendants().find(|node| node.attribute("id") == Some("participations")).unwrap();
    let curves = section.descendants().filter(|node| node.attribute("class") == Some("participation"));
    assert_eq!(curves.count(), 4);
    let found = column(&data(&page)["branches"][1]["participation"][1]);
    assert_eq!((found[4], found[5], found.len()), (4e-3, 5e-3, 20));
    // Omitted if it is not given for each branch, rejected if it is not given for each point.
    let one = HtmlReport::new("rod", &all).participation(&slices[..1]).render().unwrap();
    assert!(!one.contains("id=\"participations\""));
    let short = [slices[0], &slices[1][1..]];
    let error = HtmlReport::new("rod", &all).participation(&short).render().unwrap_err();
    assert!(matches!(error, ReportError::SeriesLength { found: 19, expected: 20, .. }), "{error}");
}

#[test]
fn histories_over_each_other_share_a_figure() {
    let branch = samples::rod(12, 3);
    let (hard, soft) = (samples::history("hard", 2.3e6), samples::history("soft", 2.3e5));
    let all = [&branch];
    let report = HtmlReport::new("rod", &all).histories("P1", &[&hard, &soft]).histories("none", &[]);
    let page = report.history("P2", &soft).render().unwrap();
    let histories = data(&page)["histories"].clone();
    assert_eq!(histories.as_array().unwrap().len(), 2);
    let (shared, alone) = (&histories[0], &histories[1]);
    assert_eq!((shared["label"].as_str(), shared["others"][0]["label"].as_str()), (Some("hard"), Some("soft")));
    assert!(shared["color"] == "#0072b2" && shared["others"][0]["color"] == "#d55e00");
    assert_eq!((alone["name"].as_str(), alone["others"].as_array().unwrap().len()), (Some("P2"), 0));
    assert_eq!(page.matches("class=\"history\"").count(), 3 * 4);
}

#[test]
fn empty_branch_makes_a_page_and_a_missing_point_an_error() {
    let branch = samples::rod(0, 1);
    let page = HtmlReport::new("nothing", &[&branch]).render().unwrap();
    assert!(Document::parse(&markup(&page)).is_ok() && !page.contains("<svg"));
    let missing = HtmlReport::new("nothing", &[&branch]).mark(0, 0, "P1").render();
    assert!(matches!(missing, Err(ReportError::NoSuchPoint { point: 0, n_points: 0, .. })));
}

/// The stop with the largest force, if there are several: not always the first one, whose contact share is shown beside
/// it.
#[test]
fn key_points_say_at_which_stop_the_largest_force_is() {
    let contact = |peak_force| ContactPeriod {
        closed_share: 0.1,
        peak_force,
        mean_force: 1.0,
        impulse: 1.0,
        touches: 1,
        approach_velocity: 1.0,
        sliding: None,
    };
    let page = |forces: [&[f64]; 2]| {
        let mut branch = samples::rod(20, 3);
        for (point, forces) in [3, 7].into_iter().zip(forces) {
            branch.points[point].contacts = forces.iter().map(|force| contact(*force)).collect();
        }
        let all = [&branch];
        let page = HtmlReport::new("Stops", &all).mark(0, 3, "P1").mark(0, 7, "P2").render().unwrap();
        page.split_once("Key points</h3>").unwrap().1.split_once("</section>").unwrap().0.to_owned()
    };
    let of_several = page([&[3.0, 5.0], &[0.0, 0.0]]);
    assert!(of_several.contains("stop 0 closed, % of period") && of_several.contains(">at</th>"), "{of_several}");
    assert!(of_several.contains("<td>stop 1</td></tr>") && of_several.contains("–</td></tr>"), "{of_several}");
    let of_one = page([&[3.0], &[5.0]]);
    assert!(of_one.contains("contact, % of period") && !of_one.contains(">at</th>"), "{of_one}");
}
