//! The head of the page: what it is about, how it ended, and its figures in large letters.

use super::HtmlReport;
use super::number::{hertz, significant};
use crate::svg::escape;
use crate::unit::Unit;
use nlmodes_modal::{Event, ModalBranch, ModalPoint, tongues};

impl HtmlReport<'_> {
    pub(super) fn overview(&self) -> String {
        let lines: String =
            self.lines.iter().map(|line| format!("<p class=\"quiet\">{}</p>\n", escape(line))).collect();
        let Some(branch) = self.branches.first() else { return lines };
        let cards: String = self.cards(branch).into_iter().map(|(value, name)| card(&value, &name)).collect();
        format!("{}{lines}<ul class=\"cards\">\n{cards}</ul>\n", outcome(self.branches))
    }

    fn cards(&self, branch: &ModalBranch) -> Vec<(String, String)> {
        let mut cards = match self.branches {
            [_] => ends(branch),
            _ => Vec::new(),
        };
        let points = || self.branches.iter().flat_map(|branch| &branch.points).filter(|point| point.omega.is_finite());
        if points().next().is_none() {
            return Vec::new();
        }
        let energies = || points().map(|point| point.kinetic_energy).filter(|energy| energy.is_finite());
        let (least, most) = (energies().fold(f64::INFINITY, f64::min), energies().fold(0.0, f64::max));
        let n_branches = self.branches.len();
        let of = if n_branches == 1 { "points".into() } else { format!("points on {n_branches} branches") };
        let n_points: usize = self.branches.iter().map(|branch| branch.points.len()).sum();
        if least.is_finite() {
            let text = format!("{} … {} J", significant(least, 3), significant(most, 3));
            cards.push((text, "averaged kinetic energy".into()));
        }
        let impulses = points().flat_map(|point| &point.contacts).map(|contact| contact.impulse);
        if let Some(most) = impulses.filter(|impulse| impulse.is_finite()).reduce(f64::max) {
            let unit = Unit::both("N s", most);
            let text = format!("{} {}", significant(most * unit.per_si, 4), unit.symbol);
            cards.push((text, "largest impulse of a stop a period".into()));
            cards.push((
                force(points()),
                "largest contact force* (of short blows it need not converge with harmonics)".into(),
            ));
        } else {
            let of = if self.scattered.contains(&0) { " of a point, each the mean over its periods" } else { "" };
            cards.push((force(points()), format!("largest contact force{of}")));
        }
        cards.push((n_points.to_string(), of));
        let mut resonances: Vec<String> = Vec::new();
        for tongue in self.branches.iter().flat_map(|branch| tongues(&branch.points)) {
            let name = tongue.resonance.to_string();
            if !resonances.contains(&name) {
                resonances.push(name);
            }
        }
        if !resonances.is_empty() {
            cards.push((resonances.join(", "), "internal resonance".into()));
        }
        cards
    }
}

/// First and last point that can be shown, and the change of frequency between them in per cent.
fn first_and_last(branch: &ModalBranch) -> Option<(&ModalPoint, &ModalPoint, String)> {
    let mut points = branch.points.iter().filter(|point| point.omega.is_finite());
    let first = points.next()?;
    let last = points.next_back().unwrap_or(first);
    let change = 100.0 * (last.omega / first.omega - 1.0);
    let sign = if change > 0.0 { "+" } else { "" };
    Some((first, last, format!("{sign}{} %", significant(change, 3))))
}

/// Where the only branch begins and ends.
fn ends(branch: &ModalBranch) -> Vec<(String, String)> {
    let Some((first, last, change)) = first_and_last(branch) else { return Vec::new() };
    let start = if first.has_event(Event::Grazing) { "where the stop is first touched" } else { "at the first point" };
    vec![
        (format!("{} Hz", hertz(first.omega)), start.into()),
        (format!("{} Hz", hertz(last.omega)), format!("at the last point, {change}")),
    ]
}

/// Lowest and highest frequency of one of several, as a test may go up and come down again; empty where there is none.
fn range(branch: &ModalBranch) -> String {
    let frequencies = || branch.points.iter().map(|point| point.omega).filter(|omega| omega.is_finite());
    let ends = frequencies().reduce(f64::min).zip(frequencies().reduce(f64::max));
    ends.map_or_else(String::new, |(lowest, highest)| format!(", {} … {} Hz", hertz(lowest), hertz(highest)))
}

fn card(value: &str, name: &str) -> String {
    format!("<li><strong>{}</strong><span>{}</span></li>\n", escape(value), escape(name))
}

fn force<'p>(points: impl Iterator<Item = &'p ModalPoint>) -> String {
    let forces = points.map(|point| point.peak_contact_force);
    let largest = forces.filter(|force| force.is_finite()).fold(0.0, f64::max);
    let unit = Unit::coarse("N", largest);
    format!("{} {}", significant(largest * unit.per_si, 4), unit.symbol)
}

/// The internal resonance on whose tongue a branch ends.
pub(super) fn tongue_at_end(branch: &ModalBranch) -> Option<String> {
    branch.points.last()?.resonance.as_ref().map(ToString::to_string)
}

/// How the branches ended: each of several by its name, and whether one did not end where it should.
fn outcome(branches: &[&ModalBranch]) -> String {
    let early = branches.iter().filter(|branch| !branch.end.complete).count();
    let on_tongue = branches.iter().filter(|branch| branch.end.complete && tongue_at_end(branch).is_some()).count();
    let (class, word) = match (early, on_tongue) {
        (0, 0) => ("done", "✓ Complete"),
        (0, _) => ("early", "⚠ Ended on the tongue of an internal resonance"),
        _ => ("early", "⚠ Ended early"),
    };
    let of = match (branches.len(), early, on_tongue) {
        (1, ..) | (_, 0, 0) => String::new(),
        (n, 0, count) | (n, count, _) => format!(" ({count} of {n} branches)"),
    };
    let said = |branch: &&ModalBranch| match tongue_at_end(branch) {
        Some(tongue) => format!("{}, on the tongue {tongue}", escape(&branch.end.message)),
        None => escape(&branch.end.message),
    };
    let text = match branches {
        [only] => format!(": {}.", said(only)),
        all => {
            let line = |branch: &&ModalBranch| {
                let (label, n, range) = (escape(&branch.label), branch.points.len(), range(branch));
                let early = if branch.end.complete { "" } else { "⚠ " };
                format!("<br/>{early}{label}: {n} points{range}; {}", said(branch))
            };
            all.iter().map(line).collect::<String>()
        }
    };
    format!("<p class=\"outcome {class}\">{word}{of}{text}</p>\n")
}
