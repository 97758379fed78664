//! Error against processor time: MS-HBM exact and sampled with each contact solver, conventional HBM, and shooting.
//!
//! ```text
//! cargo run --release -p nlmodes-benchmarks --example work_precision -- FOLDER [STRUCTURE]
//! ```
//!
//! writes `work_precision.csv` and the figures of `benchmarks/results/work_precision.md` to FOLDER and prints its
//! tables. STRUCTURE is one of `rod2`, `rod3`, `rod10`, `rod100`, `beam3`, `beam6`, `beam10`, `ten_stops`; without it
//! all are studied.
//!
//! ```text
//! cargo run --release -p nlmodes-benchmarks --example work_precision -- survey STRUCTURE FROM TO STEP [MOST]
//! ```
//!
//! prints the errors at other places of the branch: at frequencies over that at grazing, with up to MOST harmonics.
//!
//! A point costs what Newton's method takes from unknowns that are 1 % too large, with the frequency held; setting up
//! the structure does not count, it is done once a branch.

mod cases;
mod methods;
mod newton;
mod reference;
mod survey;
mod tables;
mod truncation;

use std::fmt::Write;
use std::path::PathBuf;

use cases::{Case, cases};
use methods::{Measurement, contact_solvers, exact, harmonic_balance, sampled, shooting};
use nlmodes_benchmarks::Failure;
use reference::Reference;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.first().is_some_and(|first| first == "survey") {
        return survey::survey(&arguments[1..]);
    }
    let folder = PathBuf::from(arguments.first().ok_or("expected a folder for the figures")?);
    std::fs::create_dir_all(&folder)?;
    let wanted = arguments.get(1);
    let mut csv = format!("structure,{}\n", Measurement::HEAD);
    for case in cases()?.iter().filter(|case| wanted.is_none_or(|name| name == case.slug)) {
        let measured = study(case)?;
        for m in &measured {
            writeln!(csv, "{},{}", case.slug, m.row())?;
        }
        if let Err(error) = tables::figures(case, &measured, &folder) {
            println!("({}: {error})", case.slug);
        }
    }
    let name = wanted.map_or_else(|| "work_precision.csv".to_owned(), |name| format!("work_precision_{name}.csv"));
    std::fs::write(folder.join(name), csv)?;
    Ok(())
}

/// All methods on one structure.
fn study(case: &Case) -> Result<Vec<Measurement>, Failure> {
    let reference = Reference::new(case)?;
    println!("\n## {}\n\n{}", case.title, reference.describe());
    truncation::print(case, &reference)?;
    let mut measured = vec![shooting(&reference)?];
    let (with_exact_switching, known) = exact(case, &reference)?;
    measured.extend(with_exact_switching);
    measured.extend(sampled(case, &reference, &known)?);
    measured.extend(harmonic_balance(case, &reference)?);
    tables::print(case, &measured);
    tables::print_solvers(&contact_solvers(case, &reference, &known)?);
    Ok(measured)
}
