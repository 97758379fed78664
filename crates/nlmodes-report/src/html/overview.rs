//! The head of the page: what it is about, how it ended, and its figures in large letters.

use super::HtmlReport;
use super::number::{hertz, significant};
use crate::svg::escape;
use crate::unit::Unit;
use nlmodes_modal::{ModalBranch, ModalPoint, tongues};

impl HtmlReport<'_> {
    pub(super) fn overview(&self) -> String {
        let lines: String =
            self.lines.iter().map(|line| format!("<p class=\"quiet\">{}</p>\n", escape(line))).collect();
        let Some(branch) = self.branches.first() else { return lines };
        let cards: String = self.cards(branch).into_iter().map(|(value, name)| card(&value, &name)).collect();
        format!("{}{lines}<ul class=\"cards\">\n{cards}</ul>\n", outcome(self.branches))
    }

    fn cards(&self, branch: &ModalBranch) -> Vec<(String, String)> {
        let points = || branch.points.iter().filter(|point| point.omega.is_finite());
        let (Some(first), Some(last)) = (points().next(), points().next_back()) else { return Vec::new() };
        let start = if first.has_event("grazing") { "where the stop is first touched" } else { "at the first point" };
        let change = 100.0 * (last.omega / first.omega - 1.0);
        let sign = if change > 0.0 { "+" } else { "" };
        let n_points: usize = self.branches.iter().map(|branch| branch.points.len()).sum();
        let n_branches = self.branches.len();
        let of = if n_branches == 1 { "points".into() } else { format!("points on {n_branches} branches") };
        let energies = || points().map(|point| point.kinetic_energy).filter(|energy| energy.is_finite());
        let (least, most) = (energies().fold(f64::INFINITY, f64::min), energies().fold(0.0, f64::max));
        let mut cards = vec![
            (format!("{} Hz", hertz(first.omega)), start.into()),
            (format!("{} Hz", hertz(last.omega)), format!("at the last point, {sign}{} %", significant(change, 3))),
            (format!("{} … {} J", significant(least, 3), significant(most, 3)), "averaged kinetic energy".into()),
            (force(branch), "largest contact force".into()),
            (n_points.to_string(), of),
        ];
        let resonances: Vec<String> = tongues(&branch.points).iter().map(|t| t.resonance.to_string()).collect();
        if !resonances.is_empty() {
            cards.push((resonances.join(", "), "internal resonance".into()));
        }
        cards
    }
}

fn card(value: &str, name: &str) -> String {
    format!("<li><strong>{}</strong><span>{}</span></li>\n", escape(value), escape(name))
}

fn force(branch: &ModalBranch) -> String {
    let forces = branch.points.iter().map(|point: &ModalPoint| point.peak_contact_force);
    let largest = forces.filter(|force| force.is_finite()).fold(0.0, f64::max);
    let unit = Unit::coarse("N", largest);
    format!("{} {}", significant(largest * unit.per_si, 4), unit.symbol)
}

/// How the main branch ended, and whether another one did not end where it should.
fn outcome(branches: &[&ModalBranch]) -> String {
    let early = branches.iter().filter(|branch| !branch.end.complete).count();
    let end = branches.first().map_or("", |branch| branch.end.message.as_str());
    let (class, word) = if early == 0 { ("done", "✓ Complete") } else { ("early", "⚠ Ended early") };
    let of = if branches.len() > 1 && early > 0 {
        format!(" ({early} of {} branches)", branches.len())
    } else {
        String::new()
    };
    format!("<p class=\"outcome {class}\">{word}{of}: {}.</p>\n", escape(end))
}
