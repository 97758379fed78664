//! How much memory a scene needs, before anything is computed: what does not fit is refused, and not killed half-way.

use std::fs;
use std::str::FromStr;

use nlmodes::hbm::MAX_RECORDED;
use nlmodes_io::FeFiles;

use crate::scene::{Numbers, RecordScene, ReducedModel, Scene, SceneStructure, Switching, Symmetry, TestScene};
use crate::{AnyScene, SceneError, SceneFile};

const GIB: f64 = 1024.0 * 1024.0 * 1024.0;
const UNITS: [(&str, f64); 7] =
    [("KiB", 1024.0), ("MiB", 1024.0 * 1024.0), ("GiB", GIB), ("kB", 1e3), ("MB", 1e6), ("GB", 1e9), ("B", 1.0)];
/// Default if the memory of the machine is unknown.
const UNKNOWN: f64 = 4.0 * GIB;
// The estimates below are 1.2 to 1.6 times the measured values: rods of 590 and 20000 elements, a beam of 3000, 300
// harmonics.

/// Share of the machine's memory that a run may take.
const SHARE: f64 = 0.75;
/// A branch of fewer points is not worth the attempt.
const FEWEST_POINTS: f64 = 20.0;
/// More points than most branches have.
const USUAL_POINTS: usize = 1000;

/// Bytes of the program itself.
const PROGRAM: f64 = 20.0 * 1024.0 * 1024.0;
/// Bytes a degree of freedom, in sparse matrices, their factors and parts.
const BYTES_OF_A_DOF: f64 = 1500.0;
/// Copies of a dense matrix that its factorisation takes.
const DENSE_COPIES: f64 = 6.0;
/// Copies of a table of modes: basis, vectors, and the shapes kept.
const MODE_COPIES: f64 = 5.0;
/// Copies of the Jacobian in problem and continuation.
const JACOBIAN_COPIES: f64 = 10.0;
/// Bytes of a point in addition to its coefficients.
const BYTES_OF_A_POINT: f64 = 500.0;
/// Up to this size the linear modes are computed densely; up to the second one all fixed-interface modes are used.
const DENSE: [f64; 2] = [600.0, 400.0];

/// Degrees of freedom of a reduced structure, where these are not known yet.
const REDUCED_DOFS: f64 = 200.0;
/// Bytes of a matrix entry in a text file without its two indices, in a packed file, and of both matrices in memory.
const BYTES_OF_A_VALUE: f64 = 23.0;
const BYTES_OF_A_PACKED_ENTRY: f64 = 8.0;
const BYTES_OF_A_READ_ENTRY: f64 = 80.0;
/// Entries in a row of the lower triangle of a stiffness of tetrahedra, and bytes of its factor over the 4/3rd power of
/// its size.
const ENTRIES_OF_A_ROW: f64 = 40.0;
const FACTOR: f64 = 150.0;

/// Most memory that a run may take, bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit(f64);

impl Limit {
    /// Three quarters of the memory that machine or container has.
    pub fn of_machine() -> Self {
        let total = fs::read_to_string("/proc/meminfo").ok().and_then(|text| total(&text));
        let container = ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"];
        let container = container.iter().find_map(|path| fs::read_to_string(path).ok()?.trim().parse::<f64>().ok());
        let all = [total, container].into_iter().flatten().reduce(f64::min);
        Self(all.map_or(UNKNOWN, |bytes| SHARE * bytes))
    }

    /// Memory limit for each of this many simultaneous runs.
    #[must_use]
    pub fn shared_by(self, runs: usize) -> Self {
        Self(self.0 / runs.max(1) as f64)
    }

    /// The limit in bytes.
    pub(crate) fn bytes(self) -> f64 {
        self.0
    }

    fn help(self, needed: f64) -> String {
        let wanted = (1.2 * needed / GIB).ceil().max(1.0);
        format!("the limit is {}; --memory-limit {wanted}GiB raises it", text(self.0))
    }
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "expected a number with a unit, as 8GiB, 500MB or 1000000B".to_owned();
        let (name, factor) = UNITS.into_iter().find(|(name, _)| text.ends_with(name)).ok_or_else(wrong)?;
        let number = text.trim_end_matches(name).trim().parse::<f64>().map_err(|_| wrong())?;
        if number.is_finite() && number > 0.0 { Ok(Self(number * factor)) } else { Err(wrong()) }
    }
}

/// `MemTotal:   16318712 kB`
fn total(meminfo: &str) -> Option<f64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    Some(1024.0 * line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()?)
}

/// Bytes in words.
fn text(bytes: f64) -> String {
    let (name, factor) = [UNITS[2], UNITS[1]].into_iter().find(|(_, f)| bytes >= *f).unwrap_or(UNITS[0]);
    format!("{:.1} {name}", bytes / factor)
}

/// What a branch needs, bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Needs {
    /// Matrices and modes.
    structure: f64,
    /// The problem with its Jacobian.
    problem: f64,
    /// Each point.
    point: f64,
}

impl Needs {
    fn of(scene: &Scene) -> Self {
        let method = &scene.method;
        let (full, dofs) = match &scene.structure {
            SceneStructure::Straight(structure) => (0.0, structure.free_dofs() as f64),
            SceneStructure::Several(structures) => {
                (structures.iter().map(|body| BYTES_OF_A_DOF * body.free_dofs() as f64).sum(), REDUCED_DOFS)
            }
            // Reading and factorising the files comes before the reduced problem.
            SceneStructure::Matrices(matrices) => (of_files(&matrices.files), REDUCED_DOFS),
            SceneStructure::Reduced(model) => (of_numbers(model), REDUCED_DOFS),
        };
        // An accuracy may choose its most everywhere.
        let harmonics = method.accuracy.map_or(method.harmonics, |accuracy| accuracy.max_harmonics) as f64;
        let chosen = if dofs <= DENSE[1] { dofs } else { 2.0 * (32.0 + 8.0 * harmonics) };
        let modes = method.held_modes.map_or(chosen, |n| n as f64).min(dofs);
        let dense = dofs <= DENSE[0] || 3.0 * modes > dofs;
        let modes = if dense { 8.0 * DENSE_COPIES * dofs * dofs } else { 8.0 * MODE_COPIES * dofs * modes };
        let width = match method.symmetry {
            Symmetry::Even => harmonics + 1.0,
            Symmetry::None => 2.0 * harmonics + 1.0,
        };
        let contacts = scene.n_contact_tables() as f64;
        let unknowns = contacts * width + 2.0;
        let samples = if method.switching == Switching::Sampled { method.samples as f64 } else { 0.0 };
        Self {
            structure: PROGRAM + full + BYTES_OF_A_DOF * dofs + modes,
            problem: 8.0 * JACOBIAN_COPIES * unknowns * unknowns + 8.0 * samples * (2.0 * width + 4.0 * contacts),
            point: 16.0 * dofs.min(MAX_RECORDED as f64) * (harmonics + 1.0) + 16.0 * unknowns + BYTES_OF_A_POINT,
        }
    }

    fn fixed(self) -> f64 {
        self.structure + self.problem
    }
}

/// Bytes that reading and factorising the matrices of these files takes, from the size of the files.
pub(crate) fn of_files(files: &FeFiles) -> f64 {
    let path = &files.stiffness.path;
    let size = fs::metadata(path).map_or(0.0, |data| data.len() as f64);
    let packed = path.extension().is_some_and(|ending| ending == "gz" || ending == "npz" || ending == "mat");
    let entries = if packed { size / BYTES_OF_A_PACKED_ENTRY } else { entries_of_text(size) };
    // A factor of a solid grows with the 4/3rd power of its size.
    let unknowns = entries / ENTRIES_OF_A_ROW;
    BYTES_OF_A_READ_ENTRY * entries + FACTOR * unknowns.powf(4.0 / 3.0)
}

/// Bytes of the numbers of a structure that was reduced elsewhere while they are read and judged.
fn of_numbers(model: &ReducedModel) -> f64 {
    let size = |numbers: &Numbers| match numbers {
        Numbers::File(address) => fs::metadata(&address.path).map_or(0.0, |data| data.len() as f64),
        Numbers::List(_) | Numbers::Table(_) => 0.0,
    };
    DENSE_COPIES
        * [&model.frequencies_hz, &model.contact_rows, model.flexibility.numbers()].map(size).iter().sum::<f64>()
}

/// Number of matrix entries in a text file of this size: the larger the matrix, the more digits its indices have, on
/// average a tenth of a digit less than the logarithm of the number of rows.
fn entries_of_text(size: f64) -> f64 {
    let rows = (size / (BYTES_OF_A_VALUE + 10.0) / ENTRIES_OF_A_ROW).max(10.0);
    size / (BYTES_OF_A_VALUE + 2.0 * (rows.log10() - 0.1))
}

/// What reducing a solid takes on one core of a usual machine: factorisation, modes, and one solution for each contact,
/// after figures of tetrahedra with 10⁵ to 10⁶ degrees of freedom; thinner structures take less.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Most memory, bytes.
    pub bytes: f64,
    /// CPU time, s.
    pub seconds: f64,
}

impl Effort {
    /// For a structure with this many degrees of freedom, contacts and free-interface modes.
    pub fn of_reduction(dofs: usize, contacts: usize, modes: usize) -> Self {
        let millions = dofs as f64 / 1e6;
        let factor = 13.6e9 * millions.powf(1.45);
        let tables = 8.0 * dofs as f64 * (3 * modes + 64) as f64;
        let solutions = factor / 13.6e9;
        let seconds = 112.0 * millions.powi(2) + solutions * (4.0 * modes as f64 + 0.3 * contacts as f64);
        Self { bytes: PROGRAM + 1.2 * factor + tables, seconds }
    }

    /// Both in words.
    pub fn text(&self) -> String {
        let seconds = match self.seconds {
            s if s < 1.0 => "under a second".to_owned(),
            s if s < 120.0 => format!("some {s:.0} s"),
            s => format!("some {:.0} min", s / 60.0),
        };
        format!("{seconds} of one core and {} of memory", text(self.bytes))
    }
}

/// Upper estimate for the branch of a scene with a typical number of points, bytes.
pub fn estimate(file: &SceneFile) -> f64 {
    let needs = Needs::of(&file.scene);
    needs.fixed() + needs.point * file.scene.continuation.max_points.min(USUAL_POINTS) as f64
}

/// Rejects a scene that does not fit, with a message; the number of points of branches is reduced to what fits.
///
/// # Errors
/// The message at its place in the scene.
pub fn admit_any(scene: &mut AnyScene, limit: Option<Limit>) -> Result<(), SceneError> {
    match scene {
        AnyScene::Structure(files) => admit(files, limit),
        AnyScene::Records(file) => admit_records(file, limit),
        AnyScene::Test(file) => admit_test(file, limit),
    }
}

/// Rejects scenes that do not fit, with a message, and reduces the number of points to what fits.
///
/// # Errors
/// The message at its place in the scene.
pub fn admit(files: &mut [SceneFile], limit: Option<Limit>) -> Result<(), SceneError> {
    let limit = limit.unwrap_or_else(Limit::of_machine);
    let needs: Vec<Needs> = files.iter().map(|file| Needs::of(&file.scene)).collect();
    for (file, needs) in files.iter().zip(&needs) {
        let least = needs.fixed() + FEWEST_POINTS * needs.point;
        if least > limit.0 {
            return Err(too_large(file, *needs, least, limit));
        }
    }
    // All branches of a file are kept until their common figures are drawn.
    let branches = |file: &SceneFile| file.scene.method.harmonics_list.len().max(1) as f64;
    let point: f64 = files.iter().zip(&needs).map(|(file, needs)| branches(file) * needs.point).sum();
    let fixed = needs.iter().map(|needs| needs.fixed()).fold(0.0, f64::max);
    let fit = ((limit.0 - fixed) / point).max(2.0);
    for file in files.iter_mut().filter(|file| file.scene.continuation.max_points as f64 > fit) {
        let label = format!("each point takes {}: {fit:.0} of them fit", text(point));
        let all = fixed + point * file.scene.continuation.max_points as f64;
        file.scene.continuation.max_points = fit as usize;
        file.warn_at(
            "continuation.max_points",
            "not all points of the branch may fit into memory",
            &label,
            &limit.help(all),
        );
    }
    Ok(())
}

fn too_large(file: &SceneFile, needs: Needs, least: f64, limit: Limit) -> SceneError {
    let scene = &file.scene;
    let structure = match &scene.structure {
        SceneStructure::Straight(_) => "structure.elements",
        SceneStructure::Several(_) | SceneStructure::Matrices(_) => "structure.stiffness",
        SceneStructure::Reduced(_) => "structure.contact_rows",
    };
    let path = if needs.structure > needs.problem { structure } else { "method.harmonics" };
    let title = format!("the scene needs some {} of memory", text(least));
    let elements = scene.structure.straight().map(|structure| (structure.elements, "element"));
    let counts = [(scene.method.harmonics, "harmonic"), (scene.n_contact_tables(), "stop")];
    let all = elements.into_iter().chain(counts);
    let label: Vec<String> = all.map(|(n, name)| format!("{n} {name}{}", if n == 1 { "" } else { "s" })).collect();
    let label = label.join(", ");
    let less = match &scene.structure {
        SceneStructure::Straight(_) => {
            "fewer `structure.elements`, `method.harmonics` or `method.held_modes` take less"
        }
        SceneStructure::Several(_) | SceneStructure::Matrices(_) => {
            "a coarser mesh or fewer `method.harmonics` take less"
        }
        SceneStructure::Reduced(_) => "fewer rows or fewer `method.harmonics` take less",
    };
    file.error_at(path, &title, &label, &[&limit.help(least), less]).with_last_line("nothing was computed or written")
}

/// The same for a virtual test, with the records of all levels.
///
/// # Errors
/// The message at its place in the scene.
fn admit_test(file: &SceneFile<TestScene>, limit: Option<Limit>) -> Result<(), SceneError> {
    let (scene, limit) = (&file.scene, limit.unwrap_or_else(Limit::of_machine));
    let samples = scene.schedule.record * scene.sample_rate;
    let channels = scene.accelerometers.len() as f64 + 7.0;
    // One record is taken apart at a time.
    let needed = 8.0 * samples * channels * (scene.schedule.count as f64 + 4.0);
    if needed <= limit.0 {
        return Ok(());
    }
    let label = format!("{} levels, {samples:.0} samples, {channels} channels", scene.schedule.count);
    let title = format!("the records need some {} of memory", text(needed));
    Err(file.error_at("virtual_test.schedule", &title, &label, &[&limit.help(needed)]))
}

/// The same for measured records, which are read one after the other.
///
/// # Errors
/// The message at its place in the scene.
fn admit_records(file: &SceneFile<RecordScene>, limit: Option<Limit>) -> Result<(), SceneError> {
    let (scene, limit) = (&file.scene, limit.unwrap_or_else(Limit::of_machine));
    let bytes = |name: &String| fs::metadata(scene.base.join(name)).map_or(0.0, |data| data.len() as f64);
    // Two bytes of a sound file become a number of eight; text and its numbers are there at the same time.
    let needed = 4.0 * scene.files.iter().map(bytes).fold(0.0, f64::max);
    if needed <= limit.0 {
        return Ok(());
    }
    let title = format!("the records need some {} of memory", text(needed));
    Err(file.error_at("recording.files", &title, "the largest of these files", &[&limit.help(needed)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rod(arguments: &[&str]) -> Vec<SceneFile> {
        let arguments: Vec<String> = arguments.iter().map(|argument| (*argument).to_owned()).collect();
        vec![crate::parse("rod.toml", include_str!("../../../configs/rod.toml"), &arguments).unwrap()]
    }

    #[test]
    fn sizes_are_read_as_people_write_them() {
        assert_eq!("8GiB".parse::<Limit>(), Ok(Limit(8.0 * GIB)));
        assert_eq!("500 MB".parse::<Limit>(), Ok(Limit(5e8)));
        assert_eq!("12B".parse::<Limit>(), Ok(Limit(12.0)));
        for wrong in ["", "8", "-1GB", "nanGB", "GiB", "1e999GB"] {
            assert!(wrong.parse::<Limit>().is_err(), "{wrong}");
        }
        assert_eq!(total("MemTotal:       16318712 kB\nMemFree: 1 kB\n"), Some(16318712.0 * 1024.0));
    }

    #[test]
    fn the_entries_of_a_text_are_estimated_from_its_size() {
        // Files of CalculiX: bytes and lines of the bracket of configs/structures as it is there and finer ones.
        for (size, entries) in [(1_079_121.0, 36_957.0), (127_725_282.0, 3_889_089.0), (1_435_292_556.0, 41_217_432.0)]
        {
            assert!((entries_of_text(size) / entries - 1.0).abs() < 0.05, "{size} {}", entries_of_text(size));
        }
    }

    #[test]
    fn the_effort_grows_as_it_was_measured() {
        // Degrees of freedom, seconds of factorisation and 20 modes, GB.
        for (dofs, seconds, gigabytes) in [(101_988, 11.0, 0.95), (306_741, 61.0, 4.75)] {
            let found = Effort::of_reduction(dofs, 1, 20);
            assert!((0.3..3.0).contains(&(found.seconds / seconds)), "{found:?}");
            assert!((0.4..2.0).contains(&(found.bytes / 1e9 / gigabytes)), "{found:?}");
        }
        assert!(Effort::of_reduction(2000, 40, 20).text().starts_with("under a second"));
    }

    #[test]
    fn what_fits_is_admitted_and_what_does_not_is_refused_with_both_figures() {
        let limit = Some(Limit(GIB));
        admit(&mut rod(&[]), limit).unwrap();
        let said =
            admit(&mut rod(&["method.harmonics=1000", "structure.elements=100000"]), limit).unwrap_err().to_string();
        assert!(said.contains("GiB of memory") && said.contains("the limit is 1.0 GiB"), "{said}");
        // 10⁵ elements with 5 harmonics are to be computed within 2 GiB.
        let mut large = rod(&["method.harmonics=5", "structure.elements=100000"]);
        admit(&mut large, Some(Limit(2.0 * GIB))).unwrap();
        assert!(large[0].scene.continuation.max_points < 5000);
        assert!(large[0].warnings_text(false).contains("may fit into memory"));
    }
}
