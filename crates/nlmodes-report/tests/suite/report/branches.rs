use crate::report::{checked, of_class, points, samples, texts};
use nlmodes_modal::{Event, ModalBranch, Stability};
use nlmodes_report::{Abscissa, BranchFigure, FigureStyle, ReportError};

const BOTH: [Abscissa; 2] = [Abscissa::Energy, Abscissa::ModalAmplitude];

#[test]
fn curves_have_all_points_of_their_branches_and_the_legend_names_them() {
    let (exact, looped) = (samples::rod(33, 1), samples::looped(100));
    for abscissa in BOTH {
        let figure = BranchFigure::new(abscissa, &[&exact, &looped]).title("a < b & c").render().unwrap();
        let document = checked(&figure);
        let lengths: Vec<usize> = of_class(&document, "branch").iter().map(|curve| points(*curve).len()).collect();
        assert_eq!(lengths, [33, 100]);
        let texts = texts(&document);
        for text in ["a < b & c", "exact", "MS-HBM, 3 harmonics", "frequency in Hz", "branch point", "linear mode"] {
            assert!(texts.iter().any(|found| found == text), "{text}: {texts:?}");
        }
    }
}

#[test]
fn curves_are_not_rounded_to_whole_pixels() {
    let branch = samples::rod(200, 1);
    let figure = BranchFigure::new(Abscissa::Energy, &[&branch]).render().unwrap();
    let document = checked(&figure);
    let points = points(of_class(&document, "branch")[0]);
    assert!(points.windows(2).all(|pair| pair[1].0 > pair[0].0 && pair[1].1 < pair[0].1), "{points:?}");
}

#[test]
fn energy_is_on_a_logarithmic_axis() {
    let branch = samples::rod(3, 1);
    let figure = BranchFigure::new(Abscissa::Energy, &[&branch]).render().unwrap();
    let document = checked(&figure);
    let pixels = points(of_class(&document, "branch")[0]);
    let ratio = |k: usize| (branch.points[k].kinetic_energy / branch.points[0].kinetic_energy).ln();
    let expected = ratio(1) / ratio(2);
    assert!(((pixels[1].0 - pixels[0].0) / (pixels[2].0 - pixels[0].0) - expected).abs() < 1e-3);
}

#[test]
fn each_event_has_a_symbol_and_linear_mode_ends_at_grazing() {
    let branch = samples::looped(100);
    let figure = BranchFigure::new(Abscissa::Energy, &[&branch]).render().unwrap();
    let document = checked(&figure);
    for (event, count) in [("grazing", 1), ("fold", 2), ("branch-point", 1), ("kink", 1), ("frequency-fold", 1)] {
        assert_eq!(of_class(&document, &format!("event {event}")).len(), count, "{event}");
    }
    let line = points(of_class(&document, "linear-mode")[0]);
    assert_eq!(line[1], points(of_class(&document, "branch")[0])[0]);
    assert!(line[0].0 < line[1].0 - 50.0 && line[0].1 == line[1].1, "{line:?}");
}

#[test]
fn branch_that_begins_below_grazing_needs_no_line() {
    let mut branch = samples::rod(10, 1);
    branch.points[0].events.clear();
    branch.points[3].events.push(Event::Grazing);
    let figure = BranchFigure::new(Abscissa::Energy, &[&branch]).render().unwrap();
    assert!(of_class(&checked(&figure), "linear-mode").is_empty());
}

#[test]
fn narrow_frequency_range_is_labelled_with_full_numbers() {
    let mut branch = samples::rod(10, 1);
    for (k, point) in branch.points.iter_mut().enumerate() {
        point.omega = std::f64::consts::TAU * (60.7866 + 1e-5 * k as f64);
    }
    let figure = BranchFigure::new(Abscissa::Energy, &[&branch]).render().unwrap();
    let texts = texts(&checked(&figure));
    let ticks: Vec<&String> = texts.iter().filter(|text| text.starts_with("60.786")).collect();
    assert!(ticks.len() >= 4 && ticks.windows(2).all(|pair| pair[0] != pair[1]), "{ticks:?}");
}

#[test]
fn single_point_and_equal_points_are_drawn() {
    for n in [1, 5] {
        let mut branch = samples::rod(1, 1);
        branch.points = vec![branch.points[0].clone(); n];
        for abscissa in BOTH {
            let figure = BranchFigure::new(abscissa, &[&branch]).render().unwrap();
            assert_eq!(of_class(&checked(&figure), "branch").len(), 1, "{n} {abscissa:?}");
        }
    }
}

#[test]
fn values_that_cannot_be_shown_interrupt_the_curve() {
    let mut branch = samples::rod(20, 1);
    branch.points[8].omega = f64::NAN;
    branch.points[13].kinetic_energy = 0.0;
    let figure = BranchFigure::new(Abscissa::Energy, &[&branch]).render().unwrap();
    let document = checked(&figure);
    let lengths: Vec<usize> = of_class(&document, "branch").iter().map(|piece| points(*piece).len()).collect();
    assert_eq!(lengths, [8, 4, 6]);
}

#[test]
fn the_legend_names_what_has_a_point_in_its_figure() {
    // A test has amplitudes but no energies; its stability is unknown.
    let mut test = samples::rod(4, 1);
    test.label = "measured".into();
    test.points.iter_mut().for_each(|point| (point.kinetic_energy, point.stability) = (f64::NAN, None));
    let mut rod = samples::rod(5, 1);
    for point in &mut rod.points {
        point.stability = Some(Stability::conservative(true, [1.0, 0.0]));
    }
    for (abscissa, is_there) in BOTH.into_iter().zip([false, true]) {
        let figure = BranchFigure::new(abscissa, &[&rod, &test]).scattered(&[1]).render().unwrap();
        let texts = texts(&checked(&figure));
        assert_eq!(texts.contains(&"measured".into()), is_there, "{texts:?}");
        assert!(!texts.contains(&"stability unknown".into()), "{texts:?}");
        assert_eq!(of_class(&checked(&figure), "measured").len(), if is_there { 4 } else { 0 });
    }
}

#[test]
fn the_axis_of_amplitudes_begins_at_zero_unless_all_points_lie_far_from_it() {
    for (step, is_far) in [(0.05, true), (1.0, false)] {
        let mut branch = samples::rod(9, 1);
        branch.points.iter_mut().enumerate().for_each(|(k, point)| point.modal_amplitude = 1.0 + step * k as f64);
        let figure = BranchFigure::new(Abscissa::ModalAmplitude, &[&branch]).render().unwrap();
        let document = checked(&figure);
        let line = points(of_class(&document, "linear-mode")[0]);
        let has_zero = texts(&document).iter().any(|text| text == "0");
        // Without a margin the axis ends 0.04 of the span behind the last point.
        let (first, last) = (branch.points[0].modal_amplitude, branch.points[8].modal_amplitude);
        let curve = points(of_class(&document, "branch")[0]);
        let pixels = (curve[8].0 - curve[0].0) / (last - first);
        let axis = (line[1].0 - line[0].0) / pixels;
        assert_eq!(has_zero, !is_far);
        let expected = if has_zero { first } else { 0.25 * 1.04 * (last - first) };
        assert!((axis / expected - 1.0).abs() < 2e-3, "{axis} {expected}");
    }
}

#[test]
fn the_labels_of_both_axes_have_letters_of_one_size() {
    let branch = samples::rod(9, 1);
    for width in [60.0, 90.0, 180.0] {
        let style = FigureStyle { width_mm: Some(width), has_title: true };
        for abscissa in BOTH {
            let figure = BranchFigure::new(abscissa, &[&branch]).render().unwrap().styled(&style);
            let document = checked(&figure);
            let size = |label: &str| {
                let text = document.descendants().find(|node| node.text().is_some_and(|text| text.starts_with(label)));
                text.and_then(|node| node.attribute("font-size")).map(str::to_owned)
            };
            let x = if abscissa == Abscissa::Energy { "averaged" } else { "modal amplitude" };
            assert!(
                size(x).is_some() && size(x) == size("frequency in"),
                "{width}: {:?} {:?}",
                size(x),
                size("frequency")
            );
        }
    }
}

#[test]
fn nothing_to_draw_is_an_error() {
    let empty = samples::rod(0, 1);
    let mut unknown = samples::rod(3, 1);
    unknown.points.iter_mut().for_each(|point| point.omega = f64::NAN);
    let cases: [&[&ModalBranch]; 3] = [&[], &[&empty], &[&unknown]];
    for branches in cases {
        let error = BranchFigure::new(Abscissa::Energy, branches).render().unwrap_err();
        assert!(matches!(error, ReportError::NothingToDraw { .. }), "{error:?}");
    }
}

#[test]
fn mark_on_a_point_that_does_not_exist_is_an_error() {
    let branch = samples::rod(5, 1);
    for (number, point) in [(0, 5), (1, 0)] {
        let error = BranchFigure::new(Abscissa::Energy, &[&branch]).mark(number, point, "P").render().unwrap_err();
        assert!(matches!(error, ReportError::NoSuchPoint { .. }), "{error:?}");
    }
}

#[test]
fn extreme_values_neither_panic_nor_leave_the_picture_undefined() {
    let extremes = [0.0, -0.0, 5e-324, 1e-300, 1.0, 1.0 + f64::EPSILON, -1.0, 1e300, f64::MAX, f64::MIN, f64::INFINITY];
    for (first, last) in extremes.iter().flat_map(|first| extremes.iter().map(move |last| (*first, *last))) {
        let mut branch = samples::rod(2, 1);
        for (point, value) in branch.points.iter_mut().zip([first, last]) {
            (point.omega, point.kinetic_energy, point.modal_amplitude) = (value, value, value);
        }
        for abscissa in BOTH {
            match BranchFigure::new(abscissa, &[&branch]).render() {
                Ok(figure) => drop(checked(&figure)),
                Err(error) => assert!(matches!(error, ReportError::NothingToDraw { .. }), "{error:?}"),
            }
        }
    }
}

#[test]
fn long_names_and_control_characters_stay_within_a_well_formed_picture() {
    let mut branch = samples::rod(3, 1);
    branch.label = "a \u{0} \u{b} \u{ffff} \"quoted\" <label> & ".repeat(20);
    let title = "very long title ".repeat(20);
    let figure = BranchFigure::new(Abscissa::Energy, &[&branch]).title(&title).render().unwrap();
    let document = checked(&figure);
    let title = document.descendants().find(|node| node.text() == Some(title.as_str())).unwrap();
    assert!(title.attribute("font-size").unwrap().parse::<f64>().unwrap() < 5.0);
}

#[test]
fn unstable_stretches_are_dashed_and_begin_where_the_stable_ones_end() {
    let mut branch = samples::looped(9);
    for (i, point) in branch.points.iter_mut().enumerate() {
        let unstable = (3..6).contains(&i);
        let largest_multiplier = if unstable { [-1.5, 0.0] } else { [1.0, 0.0] };
        point.stability = (i < 7).then_some(Stability::conservative(!unstable, largest_multiplier));
    }
    let figure = BranchFigure::new(Abscissa::Energy, &[&branch]).render().unwrap();
    let document = checked(&figure);
    let count = |class: &str| of_class(&document, class).iter().map(|curve| points(*curve).len()).collect::<Vec<_>>();
    // Points 0 to 3, 6 to 7; 3 to 6; 7 and 8 are not known.
    assert_eq!(count("branch unstable"), [4]);
    assert_eq!(count("branch stability-unknown"), [2]);
    assert_eq!(count("branch"), [4, 2]);
    let dashed = of_class(&document, "branch unstable")[0];
    assert!(dashed.attribute("stroke-dasharray").is_some());
    let texts = texts(&document);
    assert!(["unstable", "stability unknown"].iter().all(|name| texts.iter().any(|text| text == name)), "{texts:?}");
}
