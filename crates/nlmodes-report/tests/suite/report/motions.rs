use crate::report::{checked, of_class, points, samples, texts};
use nlmodes_report::{MotionFigure, ReportError};

#[test]
fn surface_covers_the_structure_from_the_clamp_to_the_tip_over_one_period() {
    let branch = samples::rod(20, 8);
    let figure = MotionFigure::new(&branch, 12).clamped_at(&[0.0]).render().unwrap();
    let document = checked(&figure);
    assert_eq!(of_class(&document, "cell").len(), 40 * 64);
    let without = MotionFigure::new(&branch, 12).render().unwrap();
    assert_eq!(of_class(&checked(&without), "cell").len(), 39 * 64);
    let frequency = branch.points[12].omega / std::f64::consts::TAU;
    let texts = texts(&document);
    for text in ["Point 12".into(), format!("{frequency:.4} Hz"), "position in m".into(), "time in ms".into()] {
        assert!(texts.iter().any(|found| found.contains(&text)), "{text}: {texts:?}");
    }
}

#[test]
fn tip_touches_the_line_of_the_stop_and_stays_below() {
    let branch = samples::rod(20, 60);
    let figure = MotionFigure::new(&branch, 12).clamped_at(&[0.0]).render().unwrap();
    let document = checked(&figure);
    let (stop, tip) = (of_class(&document, "stop"), of_class(&document, "contact"));
    assert_eq!((stop.len(), tip.len()), (64, 64));
    assert!(stop.iter().all(|piece| piece.attribute("stroke") == Some("#332288")));
    let sorted = |pieces: Vec<roxmltree::Node<'_, '_>>| {
        let mut starts: Vec<(f64, f64)> = pieces.into_iter().map(|piece| points(piece)[0]).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts
    };
    let gaps: Vec<f64> = sorted(stop).iter().zip(sorted(tip)).map(|(stop, tip)| tip.1 - stop.1).collect();
    let smallest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((0.0..6.0).contains(&smallest) && gaps[0] > 100.0, "{smallest} {gaps:?}");
}

#[test]
fn fine_mesh_is_thinned_and_keeps_its_ends() {
    let mut branch = samples::rod(2, 1);
    let coordinates = std::mem::take(&mut branch.coordinates);
    branch.coordinates = (0..2000)
        .map(|k| nlmodes_modal::Coordinate { position: 0.01 * f64::from(k), ..coordinates[0].clone() })
        .collect();
    branch.points[1].coefficients = nlmodes_modal::HarmonicCoefficients::zeros(2000, 1);
    branch.contact_coordinate = Some(1234);
    let figure = MotionFigure::new(&branch, 1).render().unwrap();
    let document = checked(&figure);
    assert_eq!(of_class(&document, "cell").len(), 41 * 64);
    assert_eq!(of_class(&document, "contact").len(), 64);
}

#[test]
fn structure_at_rest_without_contact_is_a_plane() {
    let mut branch = samples::rod(1, 1);
    branch.points[0].coefficients = nlmodes_modal::HarmonicCoefficients::zeros(80, 1);
    (branch.contact_coordinate, branch.stop) = (None, None);
    let figure = MotionFigure::new(&branch, 0).render().unwrap();
    let document = checked(&figure);
    assert!(of_class(&document, "stop").is_empty());
    assert_eq!(of_class(&document, "cell").len(), 39 * 64);
}

#[test]
fn motions_that_cannot_be_drawn_are_errors() {
    let branch = samples::rod(2, 1);
    let error = MotionFigure::new(&branch, 2).render().unwrap_err();
    assert!(matches!(error, ReportError::NoSuchPoint { point: 2, n_points: 2, .. }), "{error:?}");

    let mut lone = samples::rod(1, 1);
    lone.coordinates.truncate(1);
    lone.contact_coordinate = Some(0);
    let error = MotionFigure::new(&lone, 0).render().unwrap_err();
    assert!(matches!(error, ReportError::CoefficientShape { point: 0, .. }), "{error:?}");
    lone.points[0].coefficients = nlmodes_modal::HarmonicCoefficients::zeros(1, 1);
    let error = MotionFigure::new(&lone, 0).render().unwrap_err();
    assert!(matches!(error, ReportError::TooFewPositions { found: 1, .. }), "{error:?}");
    MotionFigure::new(&lone, 0).clamped_at(&[0.0]).render().unwrap();

    let mut unknown = samples::rod(1, 1);
    unknown.points[0].coefficients.of_mut(78)[1].re = f64::NAN;
    let error = MotionFigure::new(&unknown, 0).render().unwrap_err();
    assert!(matches!(error, ReportError::NothingToDraw { .. }), "{error:?}");
}
