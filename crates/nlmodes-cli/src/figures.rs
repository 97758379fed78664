//! `nlmodes-cli figures`: the figures of results as PDF and PNG, beside their SVG.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use nlmodes::report::write_file;
use nlmodes_print::{pdf, png};
use nlmodes_run::{Failure, chain};

use crate::Status;
use crate::terminal::print;

/// What stands on the command line.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Directories of results, all figures of which are taken, and single figures
    #[arg(value_name = "RESULTS", required = true)]
    from: Vec<PathBuf>,
    /// What to make of them
    #[arg(long, value_name = "FORMAT", value_delimiter = ',', default_values = ["pdf"])]
    format: Vec<Format>,
    /// Resolution of PNG
    #[arg(long, value_name = "N", default_value_t = 300.0, allow_negative_numbers = true)]
    dots_per_inch: f64,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// Lines as lines, letters embedded
    Pdf,
    /// An image on white
    Png,
}

impl Format {
    fn ending(self) -> &'static str {
        match self {
            Format::Pdf => "pdf",
            Format::Png => "png",
        }
    }
}

/// Converts the figures, and names what it writes.
pub fn run(arguments: &Arguments) -> Status {
    let mut status = Status::Done;
    for place in &arguments.from {
        let figures = match figures_of(place) {
            Ok(figures) if !figures.is_empty() => figures,
            Ok(_) => {
                say!(
                    "error: {}: no figures; expected .svg files, which a run writes unless output.figures = false",
                    place.display()
                );
                return Status::Wrong;
            }
            Err(error) => {
                say!("error: {}: {error}", place.display());
                return Status::Wrong;
            }
        };
        for figure in &figures {
            if let Err(error) = convert(figure, arguments) {
                say!("error: {}: {}", figure.display(), chain(error.as_ref()));
                status = Status::EndedEarly;
            }
        }
    }
    status
}

/// The figures of a directory by name, or the figure itself.
fn figures_of(place: &Path) -> io::Result<Vec<PathBuf>> {
    if !fs::metadata(place)?.is_dir() {
        return Ok(vec![place.to_path_buf()]);
    }
    let mut figures = Vec::new();
    for entry in fs::read_dir(place)? {
        figures.push(entry?.path());
    }
    figures.retain(|path| path.extension().is_some_and(|ending| ending == "svg"));
    figures.sort();
    Ok(figures)
}

fn convert(figure: &Path, arguments: &Arguments) -> Result<(), Failure> {
    let svg = fs::read_to_string(figure)?;
    for format in &arguments.format {
        let converted = match format {
            Format::Pdf => pdf(&svg)?,
            Format::Png => png(&svg, arguments.dots_per_inch)?,
        };
        let path = figure.with_extension(format.ending());
        write_file(&path, &converted)?;
        print(&path.display().to_string());
    }
    Ok(())
}
