use crate::report::{checked, of_class, points, samples, texts};
use nlmodes_report::{HistoryFigure, ReportError};

#[test]
fn three_panels_have_all_samples_and_their_units() {
    let history = samples::history("stiff stop", 2.3e6);
    let figure = HistoryFigure::new(&[&history]).render().unwrap();
    let document = checked(&figure);
    let lengths: Vec<usize> = of_class(&document, "history").iter().map(|curve| points(*curve).len()).collect();
    assert_eq!(lengths, [2001; 3]);
    let texts = texts(&document);
    for text in ["displacement in mm", "velocity in m/s", "contact force in N", "time in ms", "stiff stop", "touching"]
    {
        assert!(texts.iter().any(|found| found == text), "{text}: {texts:?}");
    }
}

#[test]
fn acceleration_is_a_fourth_panel_on_request() {
    let history = samples::history("stiff stop", 2.3e6);
    let figure = HistoryFigure::new(&[&history]).with_acceleration().render().unwrap();
    assert_eq!(of_class(&checked(&figure), "history").len(), 4);
}

#[test]
fn instants_of_touching_and_leaving_lie_on_the_stop() {
    let history = samples::history("stiff stop", 2.3e6);
    let figure = HistoryFigure::new(&[&history]).render().unwrap();
    let document = checked(&figure);
    let stop = points(of_class(&document, "stop")[0])[0].1;
    let touching = of_class(&document, "touching");
    assert_eq!((touching.len(), of_class(&document, "leaving").len()), (2, 2));
    for symbol in touching {
        let height: f64 = symbol.attribute("cy").unwrap().parse().unwrap();
        assert!((height - stop).abs() < 0.1, "{height} {stop}");
    }
}

#[test]
fn open_motion_has_a_flat_force_and_no_instants() {
    let mut history = samples::history("open", 2.3e6);
    history.force.fill(0.0);
    history.instants.clear();
    let figure = HistoryFigure::new(&[&history]).render().unwrap();
    let document = checked(&figure);
    assert!(!texts(&document).contains(&"touching".into()));
    let force = points(of_class(&document, "history")[2]);
    assert!(force.iter().all(|point| point.1 == force[0].1));
}

#[test]
fn instant_outside_the_record_is_left_out() {
    let mut history = samples::history("stiff stop", 2.3e6);
    history.instants[0].time = -1.0;
    history.instants[2].time = f64::NAN;
    let figure = HistoryFigure::new(&[&history]).render().unwrap();
    assert!(of_class(&checked(&figure), "touching").is_empty());
}

#[test]
fn histories_that_cannot_be_drawn_are_errors() {
    let mut short = samples::history("short", 2.3e6);
    short.velocity.pop();
    let error = HistoryFigure::new(&[&short]).render().unwrap_err();
    let is_velocity =
        matches!(error, ReportError::SeriesLength { series: "velocity", found: 2000, expected: 2001, .. });
    assert!(is_velocity, "{error:?}");

    let mut unknown = samples::history("unknown", 2.3e6);
    unknown.force.fill(f64::NAN);
    for histories in [&[][..], &[&unknown][..]] {
        let error = HistoryFigure::new(histories).render().unwrap_err();
        assert!(matches!(error, ReportError::NothingToDraw { .. }), "{error:?}");
    }
}
