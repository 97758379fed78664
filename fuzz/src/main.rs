//! `nlmodes-fuzz TARGET COUNT [SEED]`: valid files with mutations, one after the other, until one makes the reader
//! panic or hang.
//!
//! The input that did it is kept as `TARGET-SEED-NUMBER.bin` in the directory where the program was started;
//! `nlmodes-fuzz TARGET FILE` reads it again.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use std::{env, error, fs, process, thread};

use nlmodes_fuzz::mutation::mutated;
use nlmodes_fuzz::{Scratch, TARGETS, Target, target};
use rand::SeedableRng;
use rand::rngs::Xoshiro256PlusPlus;

/// A reader that takes longer than this over 64 KiB hangs.
const PATIENCE: Duration = Duration::from_secs(20);
/// Inputs after which the count is said, so that a run that is cut off has one.
const MILLION: u64 = 1_000_000;
/// Panics that are kept before it is enough.
const ENOUGH: usize = 20;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match run(&arguments) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!(
                "{error}\nusage: nlmodes-fuzz TARGET COUNT [SEED], or TARGET FILE; targets: {}",
                TARGETS.join(", ")
            );
            ExitCode::from(2)
        }
    }
}

/// The number of inputs that made the reader panic.
fn run(arguments: &[String]) -> Result<usize, Box<dyn error::Error>> {
    let scratch = Scratch::new()?;
    let [name, what, seed @ ..] = arguments else { return Err("two arguments are needed".into()) };
    let target = target(name, &scratch)?.ok_or_else(|| format!("there is no target {name}"))?;
    match what.parse::<u64>() {
        Ok(count) => {
            let seed = seed.first().map_or(Ok(1), |seed| seed.parse())?;
            Ok(many(name, &target, count, seed))
        }
        Err(_) => {
            (target.read)(&fs::read(what)?);
            Ok(0)
        }
    }
}

/// The input under way, and since when.
type Current = Arc<Mutex<(Instant, u64, Vec<u8>)>>;

fn many(name: &str, target: &Target, count: u64, seed: u64) -> usize {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let current: Current = Arc::new(Mutex::new((Instant::now(), 0, Vec::new())));
    watch(name.to_owned(), seed, Arc::clone(&current));
    let (began, mut slowest, mut panics) = (Instant::now(), (Duration::ZERO, 0), 0);
    // The corpus itself must be read without complaint of the reader's asserts.
    target.corpus.iter().for_each(|bytes| (target.read)(bytes));
    for number in 0..count {
        let bytes = mutated(&target.corpus, target.words, &mut random);
        let start = Instant::now();
        if let Ok(mut current) = current.lock() {
            *current = (start, number, bytes.clone());
        }
        if catch_unwind(AssertUnwindSafe(|| (target.read)(&bytes))).is_err() {
            keep(name, seed, number, &bytes);
            panics += 1;
            if panics == ENOUGH {
                println!("{name}: {ENOUGH} panics within {number} inputs; that is enough");
                return panics;
            }
        }
        slowest = slowest.max((start.elapsed(), number));
        let done = number + 1;
        if done.is_multiple_of(MILLION) || done == count {
            let seconds = began.elapsed().as_secs_f64();
            let (time, slow) = slowest;
            println!(
                "{name}: {done} inputs, seed {seed}: {panics} panics; slowest {time:.1?}, input {slow}; {seconds:.0} s"
            );
        }
    }
    panics
}

/// Ends the program if an input takes too long.
fn watch(name: String, seed: u64, current: Current) {
    thread::spawn(move || {
        loop {
            thread::sleep(Duration::from_secs(1));
            let Ok(current) = current.lock() else { continue };
            if current.0.elapsed() > PATIENCE && !current.2.is_empty() {
                keep(&name, seed, current.1, &current.2);
                println!("{name}: input {} hangs", current.1);
                process::exit(1);
            }
        }
    });
}

fn keep(name: &str, seed: u64, number: u64, bytes: &[u8]) {
    let path = format!("{name}-{seed}-{number}.bin");
    match fs::write(&path, bytes) {
        Ok(()) => println!("{name}: input {number} is kept as {path}"),
        Err(error) => println!("{name}: input {number} cannot be kept: {error}"),
    }
}
