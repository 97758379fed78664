//! Contact problems in words.

use nlmodes::contact::{LcpError, LcpStatistics};

use super::problem::Problem;
use super::solve::Solved;

impl Solved {
    /// Violation, iterations and time, per sample.
    pub fn text(&self, problem: &Problem) -> String {
        let Self { solver, solution, time, .. } = self;
        let (c, statistics) = (problem.matrix.n_contacts(), solution.statistics());
        let samples = statistics.len();
        let (worst, violation) = largest(statistics, |s| s.violation);
        let (longest, most) = largest(statistics, |s| s.iterations as f64);
        let mean = statistics.iter().map(|s| s.iterations).sum::<usize>() as f64 / samples as f64;
        let closed: Vec<usize> = (0..samples).map(|k| solution.closed(k).iter().filter(|c| **c).count()).collect();
        let (fewest, most_closed) = (closed.iter().min().unwrap_or(&0), closed.iter().max().unwrap_or(&0));
        let micro = time.as_secs_f64() * 1e6 / samples as f64;
        [
            row("problem", &format!("{c} contact(s), {samples} sample(s)")),
            row("solver", solver),
            row("closed", &format!("{fewest} to {most_closed} contacts a sample")),
            row("violation", &format!("at most {violation:.1e} (sample {worst}), scaled; 1e-10 is the limit")),
            row("iterations", &format!("{mean:.2} a sample, at most {most} (sample {longest})")),
            row("time", &format!("{micro:.3} µs a sample, {:.3} ms in all", time.as_secs_f64() * 1e3)),
        ]
        .join("\n")
    }

    /// Why a sample has no solution, with numbers that can be checked where that is proven; nothing where all have one.
    pub fn failure_text(&self) -> Option<String> {
        let reason = self.failure.as_ref()?;
        let proof = match reason {
            LcpError::Infeasible { ray } => format!("\n{}", proof(ray)),
            _ => String::new(),
        };
        Some(format!("sample {} has no solution: {reason}{proof}", self.samples))
    }
}

fn proof(ray: &[f64]) -> String {
    let shown: Vec<String> = ray.iter().take(8).map(|v| format!("{v:.3e}")).collect();
    let more = if ray.len() > shown.len() { ", …" } else { "" };
    format!(
        "proof: forces ∝ [{}{more}] move nothing, A λ = 0, and bᵀ λ < 0: they cannot open these gaps",
        shown.join(", ")
    )
}

fn row(name: &str, text: &str) -> String {
    format!("  {name:<12}{text}")
}

/// The first sample with the largest value, and the value.
fn largest(statistics: &[LcpStatistics], value: fn(&LcpStatistics) -> f64) -> (usize, f64) {
    let mut best = (0, f64::NEG_INFINITY);
    for (sample, s) in statistics.iter().enumerate().filter(|(_, s)| !value(s).is_nan()) {
        if value(s) > best.1 {
            best = (sample, value(s));
        }
    }
    best
}
