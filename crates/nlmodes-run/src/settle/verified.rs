//! One period of the structure of responses from a computed point, under its load.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

use nlmodes_scene::{number, short};

use super::Size;
use super::search::Search;
use crate::motion::Motion;
use crate::verify::VerifyError;
use crate::verify::results::scene_of;

/// Result for a point of a response.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundResponse {
    title: String,
    point: usize,
    harmonics: usize,
    modes: usize,
    /// Angular frequency of the motion, rad/s.
    omega: f64,
    /// Level of the load, and its unit; none of a free motion.
    level: Option<(f64, &'static str)>,
    /// Difference of the state after a period to that at its beginning, over its size.
    pub missing: f64,
    /// The displacement of the first contact, spring or force.
    size: Size,
    /// Of the exact motion under the same load next to it the distance of the first states over its size, its
    /// displacement, and its largest multiplier (real part, imaginary part); none where none was found, and of free
    /// motions.
    pub exact: Option<(f64, Size, [f64; 2])>,
}

/// One period of the structure, in the modes of the run, from a point of responses: under its load, or free without
/// dissipation from one of a nonlinear mode.
///
/// # Errors
/// [`VerifyError`] if there is no such point, or the structure cannot be integrated.
pub fn verify_response(directory: &Path, point: usize) -> Result<FoundResponse, VerifyError> {
    let title = scene_of(directory)?.title;
    let harmonics = Motion::read(directory, point)?.coefficients.n_harmonics();
    let search = Search::read_any(directory, point)?;
    let exact = search.start.as_ref().zip(search.off()).map(|(start, off)| {
        let most = start.multipliers.first().copied().unwrap_or_default();
        (off, Search::size(start), [most.re, most.im])
    });
    Ok(FoundResponse {
        title,
        point,
        harmonics,
        modes: search.n_modes(),
        omega: search.at.omega / search.at.subharmonic as f64,
        level: search.is_forced().then_some((search.at.level, search.unit)),
        missing: search.missing()?,
        size: search.before,
        exact,
    })
}

impl FoundResponse {
    /// What came out of the point, in words.
    pub fn text(&self) -> String {
        let at = self.level.map_or_else(String::new, |(level, unit)| format!(", {} {unit}", number(level)));
        let (hz, period) = (self.omega / TAU, TAU / self.omega);
        let mut text = format!(
            "{}\npoint {}: {hz:.10} Hz{at}, {} harmonics, {} modes\n\n",
            self.title, self.point, self.harmonics, self.modes
        );
        let mut line = |what: &str, value: String| _ = writeln!(text, "{what:<44}{value}");
        let of = |size: &Size| format!("{} to {} m", short(size.smallest_m), short(size.largest_m));
        line("one period in time", format!("{period:.9e} s"));
        line("what is missing after it", format!("{:.2e} of the largest", self.missing));
        line("displacement of the point", of(&self.size));
        match (self.exact, self.level) {
            (Some((off, size, [re, im])), _) => {
                let imaginary = if im == 0.0 { String::new() } else { format!(" ± {} i", short(im.abs())) };
                let stable = if re.hypot(im) < 1.0 { "stable" } else { "unstable" };
                text.push_str("\nexact motion under the same load next to it, by shooting\n");
                let mut line = |what: &str, value: String| _ = writeln!(text, "{what:<44}{value}");
                line("  its distance", format!("{:.2e} of its size", off));
                line("  its displacement", of(&size));
                line("  largest Floquet multiplier", format!("{}{imaginary}, {stable}", short(re)));
            }
            (None, Some(_)) => text.push_str("\nno exact motion under the same load was found next to it\n"),
            (None, None) => {}
        }
        text
    }
}
