//! What the parameters of a scene do at the points of a curve that matter, as tornado figures and a table.

use nlmodes::modal::{Event, Gradient, GradientOf, ModalBranch, ModalPoint};
use nlmodes::report::{DataTable, Figure, TornadoFigure, hertz};
use nlmodes_scene::short;

/// A point, what is shown of it, and what it is called.
struct Pick<'a> {
    point: &'a ModalPoint,
    what: GradientOf,
    name: String,
}

/// Folds that are shown.
const FOLDS: usize = 2;

/// Of a response over the frequency its largest amplitude, its largest contact force, each at a point of its own, and
/// the frequencies of its first folds; of a response over the level those levels; of any other curve the frequency and
/// the contact force of its last point.
fn picks(branch: &ModalBranch) -> Vec<Pick<'_>> {
    let points = || branch.points.iter().filter(|point| !point.gradients.is_empty());
    let is_known = |what| points().any(|point| point.gradients.iter().any(|own| own.of(what).is_some()));
    let is_free = |point: &ModalPoint| point.driven.is_none_or(|driven| driven.level.is_none());
    let folds = |what, word: &str| {
        let found = points().filter(|point| point.events.contains(&Event::Fold)).take(FOLDS);
        let name = |point: &ModalPoint| format!("{word} of the fold at {:.4} Hz", hertz(point.listed_omega()));
        found.map(|point| Pick { point, what, name: name(point) }).collect::<Vec<_>>()
    };
    let Some(last) = points().next_back() else { return Vec::new() };
    if is_known(GradientOf::Level) {
        return folds(GradientOf::Level, "level");
    }
    if is_free(last) || !same_level(branch) {
        let of_last = [GradientOf::Frequency, GradientOf::PeakForce];
        return of_last
            .map(|what| Pick { point: last, what, name: format!("{} at the last point", what.words()) })
            .into();
    }
    let largest = |what, word: &str, size: &dyn Fn(&ModalPoint) -> f64| {
        let point = points().max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(last);
        Pick { point, what, name: format!("{word} at {:.4} Hz", hertz(point.listed_omega())) }
    };
    let amplitude = largest(GradientOf::Amplitude, "largest amplitude", &|point| point.fundamental.abs());
    let force = largest(GradientOf::PeakForce, "largest contact force", &|point| point.peak_contact_force);
    [amplitude, force].into_iter().chain(folds(GradientOf::Frequency, "frequency")).collect()
}

/// Whether all points have one level of the load.
fn same_level(branch: &ModalBranch) -> bool {
    let mut levels = branch.points.iter().filter_map(|point| point.driven?.level);
    let first = levels.next();
    levels.all(|level| Some(level) == first)
}

/// What is differentiated, at a point.
fn value(point: &ModalPoint, what: GradientOf) -> f64 {
    match what {
        GradientOf::Frequency => hertz(point.listed_omega()),
        GradientOf::Amplitude => point.fundamental.abs(),
        GradientOf::Peak => point.peak,
        GradientOf::PeakForce => point.peak_contact_force,
        GradientOf::Impulse => point.impulse().unwrap_or(f64::NAN),
        GradientOf::Level => point.driven.and_then(|driven| driven.level).unwrap_or(f64::NAN),
        GradientOf::DampingRatio => point.driven.and_then(|driven| driven.damping_ratio).unwrap_or(f64::NAN),
    }
}

/// Change of the quantity by one per cent of the parameter, %.
fn effect(pick: &Pick<'_>, gradient: &Gradient) -> f64 {
    gradient.of(pick.what).map_or(f64::NAN, |slope| slope * gradient.value / value(pick.point, pick.what))
}

/// Parameters that figures and the page show, those with the largest effects; tables have all.
const SHOWN: usize = 40;

/// The parameters that are shown of a point, in the order of the scene, and how many more there are.
fn shown<'a>(pick: &Pick<'a>) -> (Vec<&'a Gradient>, usize) {
    let all = &pick.point.gradients;
    let size = |k: &usize| effect(pick, &all[*k]).abs();
    let mut order: Vec<usize> = (0..all.len()).collect();
    if all.len() > SHOWN {
        order.sort_by(|a, b| size(b).total_cmp(&size(a)));
        order.truncate(SHOWN);
        order.sort_unstable();
    }
    (order.iter().map(|k| &all[*k]).collect(), all.len() - order.len())
}

/// The figures, each with its title; none without parameters.
pub fn figures(branch: &ModalBranch) -> Vec<(String, Figure)> {
    let figure = |pick: Pick<'_>| {
        let (shown, _) = shown(&pick);
        let bars = shown.into_iter().map(|own| (own.parameter.to_string(), effect(&pick, own)));
        let axis = format!("change of the {} in % for 1 % of the parameter", pick.what.words());
        let title = format!("Effect on the {}", pick.name);
        Some((title.clone(), TornadoFigure::new(axis, bars).title(title).render().ok()?))
    };
    picks(branch).into_iter().filter_map(figure).collect()
}

/// The table of these points; none without parameters.
pub fn table(branch: &ModalBranch) -> Option<DataTable> {
    let head = ["quantity", "its value", "parameter", "its value", "derivative", "% for 1 %"];
    let mut table = DataTable::new("Gradients by the parameters of the scene, in SI units per unit of the key", &head);
    for pick in picks(branch) {
        let (shown, more) = shown(&pick);
        for gradient in shown {
            table.rows.push(vec![
                pick.name.clone(),
                short(value(pick.point, pick.what)),
                gradient.parameter.to_string(),
                short(gradient.value),
                gradient.of(pick.what).map_or_else(|| "–".to_owned(), |slope| format!("{slope:.5e}")),
                Some(effect(&pick, gradient))
                    .filter(|e| e.is_finite())
                    .map_or_else(|| "–".to_owned(), |e| format!("{e:.4}")),
            ]);
        }
        if more > 0 {
            let rest = format!("and {more} parameters with smaller effects, in branch.csv");
            table.rows.push([vec![pick.name.clone(), String::new(), rest], vec![String::new(); 3]].concat());
        }
    }
    (!table.rows.is_empty()).then_some(table)
}
