use crate::report::{checked, of_class, points, texts};
use nlmodes_report::{ConvergenceFigure, ReportError};

#[test]
fn a_power_law_is_a_straight_line_with_its_exponent_for_a_slope() {
    let law = |exponent: i32| [1.0, 10.0, 1e3, 1e6].map(|x: f64| (x, 2.0 * x.powi(exponent)));
    let (first, second) = (law(-1), law(-2));
    let figure = ConvergenceFigure::new("stiffness in N/m", "error").title("Law").series("one", &first);
    let figure = figure.series("two", &second).reference("slope −1", &first).render().unwrap();
    let document = checked(&figure);
    assert_eq!((of_class(&document, "series").len(), of_class(&document, "reference").len()), (2, 1));
    assert_eq!(of_class(&document, "value").len(), 8);
    let slope = |at: usize, k: usize| {
        let p = points(of_class(&document, "series")[at]);
        (p[k + 1].1 - p[k].1) / (p[k + 1].0 - p[k].0)
    };
    // Places are written to a hundredth of a pixel, over 100 pixels and more.
    (0..3).for_each(|k| assert!((slope(1, k) / slope(0, 0) - 2.0).abs() < 1e-3));
    let found = texts(&document);
    for text in ["Law", "one", "two", "slope −1", "stiffness in N/m", "error"] {
        assert!(found.iter().any(|t| t == text), "{text}: {found:?}");
    }
}

#[test]
fn what_no_logarithm_shows_is_left_out() {
    let broken = [(1.0, 1.0), (2.0, 0.5), (3.0, 0.0), (4.0, 0.2), (5.0, 0.1), (6.0, f64::NAN)];
    let figure = ConvergenceFigure::new("x", "y").series("broken", &broken).render().unwrap();
    let document = checked(&figure);
    assert_eq!((of_class(&document, "series").len(), of_class(&document, "value").len()), (2, 4));
    let nothing = ConvergenceFigure::new("x", "y").series("nothing", &[(1.0, 0.0), (-1.0, 2.0)]).render();
    assert!(matches!(nothing, Err(ReportError::NothingToDraw { figure: "convergence", .. })));
}
