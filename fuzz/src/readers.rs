use std::io;
use std::path::{Path, PathBuf};
use std::{env, fs, process};

use nlmodes_experiment::records::{
    Channel, Quantity, RecordError, RecordTable, Role, read_csv, read_npy, read_uff, read_wav,
};
use nlmodes_run::verify::Point;
use nlmodes_run::{chain, lcp};
use nlmodes_scene as config;

use crate::resumed::Runs;
use crate::{corpus, models, structures};

/// A function of bytes.
pub type Reader = Box<dyn Fn(&[u8]) + Send + Sync>;

/// A reader, and valid files to begin with.
pub struct Target {
    /// Whatever it does with the bytes: an error is as good as a result.
    pub read: Reader,
    /// Valid files.
    pub corpus: Vec<Vec<u8>>,
    /// Words of its format.
    pub words: &'static [&'static str],
}

/// The target of this name; `None` if there is none.
///
/// # Errors
/// If the valid files cannot be made.
pub fn target(name: &str, scratch: &Scratch) -> io::Result<Option<Target>> {
    let directory = scratch.0.clone();
    let (read, corpus): (Reader, Vec<Vec<u8>>) = match name {
        "scene" => (Box::new(scene), corpus::scenes()),
        "record-scene" => (Box::new(record_scene), corpus::record_scenes()),
        "test-scene" => (Box::new(test_scene), corpus::test_scenes()),
        "csv" => (Box::new(|bytes| record(read_csv(bytes, Some("time_s")))), corpus::csv()?),
        "uff" => (Box::new(|bytes| record(read_uff(bytes))), corpus::uff()?),
        "wav" => (Box::new(|bytes| record(read_wav(bytes))), corpus::wav()?),
        "npy" => (Box::new(|bytes| record(read_npy(bytes))), corpus::npy()?),
        "lcp" => (Box::new(move |bytes| contact_problem(&directory, bytes)), corpus::contact_problems()),
        "results" => (Box::new(move |bytes| results(&directory, bytes)), corpus::results()),
        "resumed-run" => {
            let runs = Runs::new(&directory)?;
            let corpus = runs.runs();
            (runs.run_reader(), corpus)
        }
        "resumed-steps" => {
            let runs = Runs::new(&directory)?;
            let corpus = runs.steps();
            (runs.steps_reader(), corpus)
        }
        _ if models::TARGETS.contains(&name) => {
            let Some(corpus) = models::corpus(name) else { return Ok(None) };
            let target = name.to_owned();
            (Box::new(move |bytes: &[u8]| models::read(&target, &directory, bytes)), corpus)
        }
        _ => match structures::corpus(name) {
            Some(corpus) => {
                let target = name.to_owned();
                let read: Reader = Box::new(move |bytes: &[u8]| structures::read(&target, &directory, bytes));
                (read, corpus)
            }
            None => return Ok(None),
        },
    };
    let words = match name {
        "scene" | "record-scene" | "test-scene" => corpus::TOML_WORDS,
        "csv" | "uff" => corpus::TEXT_WORDS,
        "results" => corpus::JSON_WORDS,
        "resumed-run" | "resumed-steps" => corpus::STEP_WORDS,
        name if structures::TARGETS.contains(&name) => structures::WORDS,
        name if models::TARGETS.contains(&name) => models::WORDS,
        _ => corpus::BINARY_WORDS,
    };
    Ok(Some(Target { read, corpus, words }))
}

/// Everything the program does with a scene before it computes, and with `--set`: the last line of the text is the
/// argument.
fn scene(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let argument = text.lines().next_back().unwrap_or_default().to_owned();
    for arguments in [&[][..], &[argument]] {
        match config::parse_each_method("scene.toml", &text, arguments) {
            Ok(files) => drop(config::AnyScene::Structure(files).warnings_text(false)),
            Err(refused) => shown(&refused),
        }
    }
}

fn record_scene(bytes: &[u8]) {
    match config::parse_records("scene.toml", &String::from_utf8_lossy(bytes), &[]) {
        Ok(file) => drop(file.warnings_text(false)),
        Err(refused) => shown(&refused),
    }
}

fn test_scene(bytes: &[u8]) {
    match config::parse_test("scene.toml", &String::from_utf8_lossy(bytes), &[]) {
        Ok(file) => drop(file.warnings_text(false)),
        Err(refused) => shown(&refused),
    }
}

fn shown(refused: &config::SceneError) {
    assert!(refused.text(false).contains("error"), "a scene is refused without a reason");
}

/// A table taken apart into the channels of the corpus, or shown to be wrong in words.
fn record(table: Result<RecordTable, RecordError>) {
    let channels = [("x", Quantity::Displacement), ("f", Quantity::Force)]
        .map(|(name, quantity)| Channel::new(name, quantity, Role::Response, Some(0.1)));
    match table.and_then(|table| table.into_record("record", &channels, None)) {
        Ok(record) => {
            assert!(record.samples.iter().all(|samples| samples.len() == record.n_samples()), "ragged record");
        }
        Err(error) => assert!(error.to_string().len() > 10, "{error:?} has no message"),
    }
}

fn contact_problem(directory: &Path, bytes: &[u8]) {
    let path = directory.join("problem.npz");
    if fs::write(&path, bytes).is_ok()
        && let Err(error) = lcp::read(&path)
    {
        assert!(chain(&error).len() > 10, "{error}");
    }
}

/// A summary and coefficients in one, the length of the first in front.
fn results(directory: &Path, bytes: &[u8]) {
    let Some((length, rest)) = bytes.split_first_chunk() else { return };
    let (summary, harmonics) = rest.split_at((u32::from_le_bytes(*length) as usize).min(rest.len()));
    let written = fs::write(directory.join("summary.json"), summary)
        .and_then(|()| fs::write(directory.join("harmonics.npz"), harmonics));
    if written.is_ok()
        && let Err(error) = Point::read(directory, 1)
    {
        assert!(chain(&error).len() > 10, "{error}");
    }
}

/// A directory for files that are read again at once, in memory where there is such a place; removed at the end.
pub struct Scratch(PathBuf);

impl Scratch {
    /// Makes one.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn new() -> io::Result<Self> {
        let memory = Path::new("/dev/shm");
        let parent = if memory.is_dir() { memory.to_path_buf() } else { env::temp_dir() };
        let own = parent.join(format!("nlmodes-fuzz-{}", process::id()));
        fs::create_dir_all(&own)?;
        Ok(Self(own))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What stays behind is small, and of a name of its own.
        drop(fs::remove_dir_all(&self.0));
    }
}
