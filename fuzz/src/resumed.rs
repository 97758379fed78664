//! What `nlmodes-cli run --resume` reads back.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use nlmodes_run::{Event, Observer, Over, RunError, chain, run};
use nlmodes_scene::{SceneFile, parse_each_method};

use crate::Reader;

/// A rod of so many elements, so much of whose branch is kept; small, so that many are read in a second.
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
pub struct Runs(Vec<Interrupted>);

/// One of them.
struct Interrupted {
    files: Vec<SceneFile>,
    directory: PathBuf,
    /// Points that were computed: those that were asked for, or all that there are.
    points: usize,
    /// What it left: `run.json` and `steps.jsonl`.
    run: Vec<u8>,
    steps: Vec<u8>,
}

/// Ends a run after so many new points, and keeps the others.
struct Ending {
    left: usize,
    repeated: Vec<[f64; 3]>,
}

impl Observer for Ending {
    fn event(&mut self, event: Event<'_>) {
        match event {
            Event::Point { is_new: true, .. } => self.left = self.left.saturating_sub(1),
            Event::Point { point, .. } => {
                self.repeated.push([point.omega, point.kinetic_energy, point.total_energy]);
            }
            _ => {}
        }
    }

    fn is_cancelled(&self) -> bool {
        self.left == 0
    }
}

impl Interrupted {
    /// Computes the first points of a scene.
    fn new(text: &str, directory: PathBuf, points: usize) -> Result<Self, String> {
        let mut files = parse_each_method("scene.toml", text, &[]).map_err(|refused| refused.text(false))?;
        files.iter_mut().for_each(|file| file.scene.output_directory.clone_from(&directory));
        let mut ending = Ending { left: points, repeated: Vec::new() };
        run(files.clone(), Over::Anything, &mut ending).map_err(|error| chain(&error))?;
        let read = |name: &str| fs::read(directory.join(name)).map_err(|error| error.to_string());
        Ok(Self { points: points - ending.left, run: read("run.json")?, steps: read("steps.jsonl")?, files, directory })
    }

    /// Puts these files in place of its own, and reads the points back.
    fn read(&self, run_json: &[u8], steps: &[u8]) -> Result<Vec<[f64; 3]>, String> {
        let written = fs::write(self.directory.join("run.json"), run_json)
            .and_then(|()| fs::write(self.directory.join("steps.jsonl"), steps));
        written.map_err(|error| error.to_string())?;
        let mut ending = Ending { left: 1, repeated: Vec::new() };
        match run(self.files.clone(), Over::Resumed, &mut ending) {
            Ok(_) | Err(RunError::Ended) => Ok(ending.repeated),
            Err(error) => Err(chain(&error)),
        }
    }
}

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
                "{more}\noutput.stability = \"{stability}\"\noutput.page = false\noutput.figures = false\n\
                continuation.max_energy_ratio = 20.0\n{}",
                ROD.replace("ELEMENTS", &elements.to_string())
            );
            let scene = Interrupted::new(&text, directory, *points).map_err(io::Error::other)?;
            let again = scene.read(&scene.run, &scene.steps).map_err(io::Error::other)?;
            if again.len() < scene.points {
                let (found, points) = (again.len(), scene.points);
                return Err(io::Error::other(format!("scene {number}: {found} of {points} points are read back")));
            }
            Ok(scene)
        };
        SCENES.iter().enumerate().map(one).collect::<io::Result<_>>().map(Self)
    }

    /// Valid files: the number of the scene in the first byte, then `run.json`.
    pub fn runs(&self) -> Vec<Vec<u8>> {
        self.numbered(|scene| scene.run.clone())
    }

    /// The same of `steps.jsonl`, with its first line and without.
    pub fn steps(&self) -> Vec<Vec<u8>> {
        let headless = |steps: &[u8]| {
            let end = steps.iter().position(|byte| *byte == b'\n').map_or(0, |at| at + 1);
            steps[end..].to_vec()
        };
        let all = [
            self.numbered(|scene| whole_lines(&scene.steps)),
            self.numbered(|scene| headless(&whole_lines(&scene.steps))),
        ];
        all.concat()
    }

    fn numbered(&self, part: impl Fn(&Interrupted) -> Vec<u8>) -> Vec<Vec<u8>> {
        self.0.iter().zip(0_u8..).map(|(scene, number)| [vec![number], part(scene)].concat()).collect()
    }

    /// Reads `run.json` beside the steps of its scene.
    pub fn run_reader(self) -> Reader {
        Box::new(move |bytes| {
            let Some((scene, run)) = self.of(bytes) else { return };
            check(scene.read(run, &lines(&scene.steps, 2)));
        })
    }

    /// Reads `steps.jsonl`, behind the first line of its scene if it brings none, beside the right `run.json`.
    pub fn steps_reader(self) -> Reader {
        Box::new(move |bytes| {
            let Some((scene, steps)) = self.of(bytes) else { return };
            let header = if steps.starts_with(b"{\"format") { Vec::new() } else { lines(&scene.steps, 1) };
            check(scene.read(&scene.run, &[&header, steps].concat()));
        })
    }

    fn of<'a>(&'a self, bytes: &'a [u8]) -> Option<(&'a Interrupted, &'a [u8])> {
        let (number, rest) = bytes.split_first()?;
        Some((&self.0[*number as usize % self.0.len()], rest))
    }
}

/// What comes back is a point, or a reason why there is none.
fn check(found: Result<Vec<[f64; 3]>, String>) {
    match found {
        Ok(points) => {
            for numbers in points {
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
