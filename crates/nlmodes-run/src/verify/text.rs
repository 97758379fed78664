//! What is missing after a period, in words.

use std::f64::consts::TAU;
use std::fmt::Write;

use super::{Exact, Found, Point};
use nlmodes::timestep::Verification;

/// Closed intervals that are listed.
const LISTED: usize = 12;

impl Found {
    /// What came out of the point, in words.
    pub fn text(&self, point: &Point) -> String {
        let v = &self.verification;
        let mut text = format!(
            "{}\npoint {}: {:.10} Hz, {} harmonics, {} modes of the full structure\n\n",
            point.title,
            point.number,
            point.omega / TAU,
            point.coefficients.n_harmonics(),
            self.modes
        );
        let mut line = |what: &str, value: String| _ = writeln!(text, "{}", format!("{what:<44}{value}").trim_end());
        line("one period of the full structure", format!("{:.9e} s", v.period));
        line("energy at its beginning", format!("{:.9e} J", v.energy));
        line("what is missing after it", String::new());
        line("  in the energy norm", format!("{:.2e} of the root of the energy", v.energy_norm));
        line("  displacement", format!("{:.2e} of the largest", v.displacement));
        line("  velocity", format!("{:.2e} of the largest", v.velocity));
        line("energy drift of the integration", format!("{:.2e}", v.energy_drift));
        line("largest contact force", format!("{:.6e} N", v.peak_force));
        line("closed intervals a period", v.n_intervals.to_string());
        for (contact, share) in v.closed_share.iter().enumerate() {
            line(&format!("  contact {contact} closed"), format!("{:.4} % of the period", 100.0 * share));
        }
        intervals(v, &mut text);
        text += &match &self.exact {
            None => String::new(),
            Some(Ok(exact)) => of_exact(point, exact),
            Some(Err(error)) => format!("\nno exact motion of that energy was found next to it: {error}\n"),
        };
        text
    }
}

fn intervals(v: &Verification, text: &mut String) {
    for interval in v.intervals.iter().take(LISTED) {
        let [from, to] = [interval.from, interval.to].map(|t| 100.0 * t / v.period);
        _ = writeln!(text, "    contact {}: {from:.6} to {to:.6} % of the period", interval.contact);
    }
    if v.intervals.len() > LISTED {
        _ = writeln!(text, "    and {} more", v.intervals.len() - LISTED);
    }
}

fn of_exact(point: &Point, exact: &Exact) -> String {
    let motion = &exact.motion;
    format!(
        "\nexact motion of that averaged kinetic energy next to it, by shooting\n\
         {:<44}{:.10} Hz\n{:<44}{:.2e} relative\n{:<44}{:.9}, {}\n",
        "  frequency",
        motion.omega / TAU,
        "  frequency of the point less that",
        point.omega / motion.omega - 1.0,
        "  largest Floquet multiplier",
        exact.largest_multiplier,
        if exact.stable { "stable" } else { "unstable" }
    )
}
