//! The head of the page: subject, end, and key figures in large letters.

use super::HtmlReport;
use super::number::{hertz, significant};
use crate::svg::escape;
use crate::unit::Unit;
use nlmodes_modal::{Event, ModalBranch, ModalPoint, tongues};

impl HtmlReport<'_> {
    pub(super) fn overview(&self) -> String {
        let warnings = self.warnings.iter().map(|text| format!("<p class=\"warning\">⚠ {}</p>\n", escape(text)));
        let lines = self.lines.iter().map(|line| format!("<p class=\"quiet\">{}</p>\n", escape(line)));
        let lines: String = warnings.chain(lines).collect();
        let Some(branch) = self.branches.first() else { return lines };
        let cards: String = self.cards(branch).into_iter().map(|(value, name)| card(&value, &name)).collect();
        format!("{}{lines}<ul class=\"cards\">\n{cards}</ul>\n", self.outcome())
    }

    /// The branches that were computed, or those that were measured.
    fn branches_that(&self, are_measured: bool) -> impl Iterator<Item = &ModalBranch> {
        let all = self.branches.iter().enumerate();
        all.filter(move |(k, _)| self.scattered.contains(k) == are_measured).map(|(_, branch)| *branch)
    }

    fn cards(&self, branch: &ModalBranch) -> Vec<(String, String)> {
        let computed: Vec<&ModalBranch> = self.branches_that(false).collect();
        let mut cards = match computed.as_slice() {
            [only] => ends(only),
            [] if self.branches.len() == 1 => ends(branch),
            _ => Vec::new(),
        };
        // Overlays on a test are not the subject of the page.
        let is_test = self.scattered.contains(&0);
        let points = || self.branches_that(is_test).flat_map(|branch| &branch.points).filter(|p| p.omega.is_finite());
        if points().next().is_none() {
            return Vec::new();
        }
        let energies = || points().map(|point| point.kinetic_energy).filter(|energy| energy.is_finite());
        let (least, most) = (energies().fold(f64::INFINITY, f64::min), energies().fold(0.0, f64::max));
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
            let of = if is_test { " of a point, each the mean over its periods" } else { "" };
            cards.push((force(points()), format!("largest contact force{of}")));
        }
        cards.extend(self.counts(computed.len()));
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

impl HtmlReport<'_> {
    /// Numbers of computed points, branches, and measured points.
    fn counts(&self, computed: usize) -> impl Iterator<Item = (String, String)> {
        let count = |measured: bool| self.branches_that(measured).map(|branch| branch.points.len()).sum::<usize>();
        let of = if computed == 1 { "points".to_owned() } else { format!("points on {computed} branches") };
        let all = [(count(false), of), (count(true), "measured points".to_owned())];
        all.into_iter().filter(|(count, _)| *count > 0).map(|(count, of)| (count.to_string(), of))
    }

    /// How the branches ended: by name if there are several, and whether one ended early. Measured branches have no
    /// end.
    fn outcome(&self) -> String {
        let early = self.branches.iter().filter(|branch| !branch.end.complete).count();
        let on_tongue =
            self.branches.iter().filter(|branch| branch.end.complete && tongue_at_end(branch).is_some()).count();
        let is_test = self.scattered.contains(&0);
        let (class, word) = match (early, on_tongue) {
            (0, _) if is_test => ("done", "✓ All measured"),
            (0, 0) => ("done", "✓ Complete"),
            (0, _) => ("done", "✓ Complete; it ends on an internal-resonance branch"),
            _ if is_test => ("early", "⚠ Not all measured"),
            _ => ("early", "⚠ Ended early"),
        };
        let of = match (self.branches_that(false).count(), if early > 0 { early } else { on_tongue }) {
            (0 | 1, _) | (_, 0) => String::new(),
            (n, count) => format!(" ({count} of {n} branches)"),
        };
        let text = match self.branches {
            [only] => format!(": {}.", said(only)),
            all => {
                let line = |(k, branch): (usize, &&ModalBranch)| {
                    let (label, n, range) = (escape(&branch.label), branch.points.len(), range(branch));
                    let is_measured = self.scattered.contains(&k);
                    let points = if is_measured { "measured points" } else { "points" };
                    let (class, early) = match branch.end.complete {
                        false => ("early", "⚠ "),
                        true if is_measured && !is_test => ("beside", ""),
                        true => ("done", ""),
                    };
                    format!("<br/><span class=\"{class}\">{early}{label}: {n} {points}{range}; {}</span>", said(branch))
                };
                all.iter().enumerate().map(line).collect::<String>()
            }
        };
        format!("<p class=\"outcome {class}\">{word}{of}{text}</p>\n")
    }
}

/// Why a branch ended, and on which internal resonance where its message does not name that.
fn said(branch: &ModalBranch) -> String {
    let resonance = branch.points.last().and_then(|point| point.resonance);
    match resonance.filter(|resonance| !branch.end.is_on(*resonance)) {
        Some(tongue) => format!("{}, on the internal-resonance branch {tongue}", escape(&branch.end.message)),
        None => escape(&branch.end.message),
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

/// Start and end of the only branch.
fn ends(branch: &ModalBranch) -> Vec<(String, String)> {
    let Some((first, last, change)) = first_and_last(branch) else { return Vec::new() };
    let start = match first.leaves_linear_mode() {
        true if first.has_event(Event::LiftOff) => "where the stop is first left",
        true => "where the stop is first touched",
        false => "at the first point",
    };
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

/// The internal resonance at which a branch ends.
pub(super) fn tongue_at_end(branch: &ModalBranch) -> Option<String> {
    branch.points.last()?.resonance.as_ref().map(ToString::to_string)
}
