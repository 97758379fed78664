//! `nlmodes-cli figures`: the figures of results as PDF and PNG, beside their SVG.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use nlmodes::report::{FigureStyle, write_file};
use nlmodes_report::print::{pdf, png};
use nlmodes_run::redrawn::redraw;
use nlmodes_run::{Failure, chain};
use nlmodes_scene::number;

use crate::Status;
use crate::terminal::print;

/// Command-line arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Directories of results, whose figures are all converted, and single figures
    #[arg(value_name = "RESULTS", required = true)]
    from: Vec<PathBuf>,
    /// Output format
    #[arg(long, value_name = "FORMAT", value_delimiter = ',', default_values = ["pdf"])]
    format: Vec<Format>,
    /// Resolution of PNG
    #[arg(long, value_name = "N", default_value_t = 300.0, allow_negative_numbers = true)]
    dots_per_inch: f64,
    /// Width in print, mm, with letters of 8 points: 90 for one column, 180 for two. The figures of a branch or of
    /// responses are redrawn, and the width is part of the file names: frequency_energy_90mm.pdf
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    width_mm: Option<f64>,
    /// Without the titles above the figures, with --width-mm
    #[arg(long, requires = "width_mm")]
    no_titles: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// Vector graphics with embedded fonts
    Pdf,
    /// Image with white background
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

/// Converts the figures, and prints the names of the files written.
pub fn run(arguments: &Arguments) -> Status {
    if let Some(width) = arguments.width_mm {
        return in_width(arguments, width);
    }
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
            if let Err(error) = convert(figure, &figure.with_extension(""), arguments) {
                say!("error: {}: {}", figure.display(), chain(error.as_ref()));
                status = Status::EndedEarly;
            }
        }
    }
    status
}

/// The figures of a directory by name, or the figure itself; none if it is not an SVG.
fn figures_of(place: &Path) -> io::Result<Vec<PathBuf>> {
    let mut figures = Vec::new();
    if fs::metadata(place)?.is_dir() {
        for entry in fs::read_dir(place)? {
            figures.push(entry?.path());
        }
    } else {
        figures.push(place.to_path_buf());
    }
    figures.retain(|path| path.extension().is_some_and(|ending| ending == "svg"));
    figures.sort();
    Ok(figures)
}

/// Redraws the figures of directories in this width, and converts them.
fn in_width(arguments: &Arguments, width: f64) -> Status {
    if !(FigureStyle::LEAST_MM..=FigureStyle::MOST_MM).contains(&width) {
        let [least, most] = [FigureStyle::LEAST_MM, FigureStyle::MOST_MM].map(number);
        say!("error: --width-mm is {}; expected a number from {least} to {most}", number(width));
        return Status::Wrong;
    }
    for place in &arguments.from {
        if !place.is_dir() {
            say!("error: {}: only whole directories of results are drawn anew in another width", place.display());
            return Status::Wrong;
        }
        let folder = place.join(format!(".figures.{}.nlmodes.tmp", std::process::id()));
        let drawn = draw(place, &folder, arguments, width);
        // A leftover file does no harm.
        _ = fs::remove_dir_all(&folder);
        if let Err(error) = drawn {
            say!("error: {}: {}", place.display(), chain(error.as_ref()));
            return Status::EndedEarly;
        }
    }
    Status::Done
}

fn draw(place: &Path, folder: &Path, arguments: &Arguments, width: f64) -> Result<(), Failure> {
    redraw(place, folder, Some(width), !arguments.no_titles)?;
    for figure in figures_of(folder)? {
        let name = figure.file_stem().unwrap_or_default().to_string_lossy();
        convert(&figure, &place.join(format!("{name}_{}mm", number(width))), arguments)?;
    }
    Ok(())
}

/// Converts a figure to files with this name.
fn convert(figure: &Path, called: &Path, arguments: &Arguments) -> Result<(), Failure> {
    let svg = fs::read_to_string(figure)?;
    for format in &arguments.format {
        let converted = match format {
            Format::Pdf => pdf(&svg)?,
            Format::Png => png(&svg, arguments.dots_per_inch)?,
        };
        // The name may have a decimal point in its width.
        let path = PathBuf::from(format!("{}.{}", called.display(), format.ending()));
        write_file(&path, &converted)?;
        print(&path.display().to_string());
    }
    Ok(())
}
