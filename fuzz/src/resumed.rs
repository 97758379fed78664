//! What `nlmodes-cli run --resume` reads back.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use nlmodes_run::readers::{Interrupted, Left};

use crate::Reader;

/// A rod of so many elements, so much of whose branch is kept; small, so that thousands are read in a second.
const ROD: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = ELEMENTS
start = "clamped"
[structure.material]
youngs_modulus_pa = 1.0
density_kg_m3 = 1.0
[structure.section]
area_m2 = 1.0
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 0.01
"#;

/// Elements, points, and what is beside the rod: each kind of branch that goes on.
const SCENES: [(usize, usize, &str); 7] = [
    (2, 8, "method.harmonics = 2"),
    (6, 24, "method.harmonics = 3\ncontinuation.at_branch_point = \"all\"\ncontinuation.start_energy_ratio = 9.2"),
    (3, 12, "method.harmonics = 3\ncontinuation.internal_resonance = \"skip\""),
    (2, 16, "method.harmonics = 2\ncontinuation.start_energy_ratio = 1.5\ncontinuation.direction = \"both\""),
    (2, 10, "method.accuracy = 1e-2"),
    (2, 6, "method.harmonics = 2\nmethod.kind = \"shooting\""),
    (2, 6, "method.harmonics = 2\nmethod.symmetry = \"none\""),
];

/// Longest valid file, bytes.
const LONGEST: usize = 60_000;

/// Runs of [`SCENES`] that were cut off.
pub struct Runs(Vec<(Interrupted, Left, PathBuf)>);

impl Runs {
    /// Computes them.
    ///
    /// # Errors
    /// If one cannot be computed or does not read back what it left.
    pub fn new(scratch: &Path) -> io::Result<Self> {
        let one = |(number, (elements, points, more)): (usize, &(usize, usize, &str))| {
            let directory = scratch.join(number.to_string());
            fs::create_dir_all(&directory)?;
            // Keys of the top stand before the tables.
            // Multipliers, from the points alone, take most of the time where there are any.
            let stability = if number == 0 { "auto" } else { "never" };
            let text = format!(
                "{more}\noutput.stability = \"{stability}\"\ncontinuation.max_energy_ratio = 20.0\n{}",
                ROD.replace("ELEMENTS", &elements.to_string())
            );
            let scene = Interrupted::new(&text, &directory).map_err(io::Error::other)?;
            let left = scene.compute(*points).map_err(io::Error::other)?;
            let again = scene.read().map_err(io::Error::other)?;
            if again.len() < *points {
                let found = again.len();
                return Err(io::Error::other(format!("scene {number}: {found} of {points} points are read back")));
            }
            Ok((scene, left, directory))
        };
        SCENES.iter().enumerate().map(one).collect::<io::Result<_>>().map(Self)
    }

    /// Valid files: the number of the scene in the first byte, then `run.json`.
    pub fn runs(&self) -> Vec<Vec<u8>> {
        self.numbered(|left| left.run.clone())
    }

    /// The same of `steps.jsonl`, with its first line and without.
    pub fn steps(&self) -> Vec<Vec<u8>> {
        let headless = |steps: &[u8]| {
            let end = steps.iter().position(|byte| *byte == b'\n').map_or(0, |at| at + 1);
            steps[end..].to_vec()
        };
        let all =
            [self.numbered(|left| whole_lines(&left.steps)), self.numbered(|left| headless(&whole_lines(&left.steps)))];
        all.concat()
    }

    fn numbered(&self, part: impl Fn(&Left) -> Vec<u8>) -> Vec<Vec<u8>> {
        self.0.iter().zip(0_u8..).map(|((_, left, _), number)| [vec![number], part(left)].concat()).collect()
    }

    /// Reads `run.json` beside the steps of its scene.
    pub fn run_reader(self) -> Reader {
        Box::new(move |bytes| {
            let Some((scene, left, directory, run)) = self.of(bytes) else { return };
            let written = fs::write(directory.join("run.json"), run)
                .and_then(|()| fs::write(directory.join("steps.jsonl"), lines(&left.steps, 2)));
            if written.is_ok() {
                read(scene);
            }
        })
    }

    /// Reads `steps.jsonl`, behind the first line of its scene if it brings none, beside the right `run.json`.
    pub fn steps_reader(self) -> Reader {
        Box::new(move |bytes| {
            let Some((scene, left, directory, steps)) = self.of(bytes) else { return };
            let header = if steps.starts_with(b"{\"format") { String::new() } else { scene.header() + "\n" };
            let written = fs::write(directory.join("run.json"), &left.run)
                .and_then(|()| fs::write(directory.join("steps.jsonl"), [header.as_bytes(), steps].concat()));
            if written.is_ok() {
                read(scene);
            }
        })
    }

    fn of<'a>(&'a self, bytes: &'a [u8]) -> Option<(&'a Interrupted, &'a Left, &'a Path, &'a [u8])> {
        let (number, rest) = bytes.split_first()?;
        let (scene, left, directory) = &self.0[*number as usize % self.0.len()];
        Some((scene, left, directory, rest))
    }
}

/// What comes back is a point, or a reason why there is none.
fn read(scene: &Interrupted) {
    match scene.read() {
        Ok(points) => {
            for point in points {
                let numbers = [point.omega, point.kinetic_energy, point.total_energy];
                assert!(numbers.iter().all(|number| number.is_finite()), "a point without numbers: {numbers:?}");
            }
        }
        Err(message) => assert!(message.len() > 10, "{message}"),
    }
}

/// As many whole lines as are not too long together.
fn whole_lines(bytes: &[u8]) -> Vec<u8> {
    let mut end = 0;
    bytes.split_inclusive(|byte| *byte == b'\n').for_each(|line| {
        if end + line.len() <= LONGEST {
            end += line.len();
        }
    });
    bytes[..end].to_vec()
}

/// The first lines.
fn lines(bytes: &[u8], count: usize) -> Vec<u8> {
    bytes.split_inclusive(|byte| *byte == b'\n').take(count).collect::<Vec<_>>().concat()
}
