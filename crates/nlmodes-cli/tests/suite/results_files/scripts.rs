//! The scripts that plot results with other programs.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use super::{Outcome, run, table};

/// Directory of the scripts of the documentation.
fn scripts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scripts")
}

/// Whether a program exists and succeeds.
fn works(program: &str, arguments: &[&str]) -> bool {
    std::process::Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
}

/// Skipped, with a note, without an Octave that can plot.
#[test]
fn octave_draws_the_branch_and_the_forces_that_the_tables_have() -> Outcome {
    let quiet = "set(0, 'defaultfigurevisible', 'off');";
    if !works("octave-cli", &["--norc", "--eval", &format!("{quiet} figure(1); axes();")]) {
        println!("skipped: no Octave that can draw");
        return Ok(());
    }
    let (_folder, out, _) = run(&["output.matlab=true"])?;
    let told = out.join("told.txt");
    let script = format!(
        "{quiet} addpath('{}'); plot_results('{}'); f = fopen('{}', 'w'); for n = 1:2, l = findobj(figure(n), 'type', \
         'line'); \
         for k = 1:numel(l), x = get(l(k), 'xdata'); y = get(l(k), 'ydata'); fprintf(f, '%d %d %.17g %.17g\\n', n, \
         numel(x), sum(x), max(y)); end; end; \
         fclose(f);",
        scripts().display(),
        out.join("results.mat").display(),
        told.display()
    );
    let output = std::process::Command::new("octave-cli").args(["--norc", "--eval", &script]).output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(&told)?;
    let mut lines: Vec<Vec<f64>> = Vec::new();
    for line in text.lines() {
        lines.push(line.split(' ').map(str::parse).collect::<Result<_, _>>()?);
    }
    let (head, rows) = table(&out.join("branch.csv"))?;
    let column = |name: &str| head.iter().position(|column| column == name).ok_or(name.to_owned());
    let [energy, frequency, event] = [column("energy_j")?, column("frequency_hz")?, column("event")?];
    let drawn = |rows: &[&Vec<String>]| -> Result<[f64; 3], Box<dyn Error>> {
        let (mut sum, mut most) = (0.0, 0.0_f64);
        for row in rows {
            sum += row[energy].parse::<f64>()?;
            most = most.max(row[frequency].parse()?);
        }
        Ok([rows.len() as f64, sum, most])
    };
    let all: Vec<&Vec<String>> = rows.iter().collect();
    let of_branch: Vec<&Vec<f64>> = lines.iter().filter(|line| line[0] == 1.0).collect();
    // The curve goes through the highest point, and twenty times from point to point.
    let [n, _, most] = drawn(&all)?;
    assert!(of_branch.iter().any(|line| line[1] > 10.0 * n && (line[3] / most - 1.0).abs() < 1e-9), "{of_branch:?}");
    // The linear mode, and the symbols of each event.
    assert!(of_branch.iter().any(|line| line[1] == 2.0), "{of_branch:?}");
    let names: std::collections::BTreeSet<&str> = rows.iter().flat_map(|row| row[event].split_whitespace()).collect();
    assert!(names.len() > 1, "{names:?}");
    for name in names {
        let here = |row: &&Vec<String>| row[event].split_whitespace().any(|found| found == name);
        let wanted = drawn(&rows.iter().filter(here).collect::<Vec<_>>())?;
        let is_drawn = |line: &&Vec<f64>| {
            line[1] == wanted[0] && (line[2] / wanted[1] - 1.0).abs() < 1e-12 && line[3] == wanted[2]
        };
        assert!(of_branch.iter().any(is_drawn), "{wanted:?} is not among {of_branch:?}");
    }
    // A curve for each of the three stops, the last point being the one of the largest force of stop 0.
    let (stops, contacts) = table(&out.join("contacts.csv"))?;
    let place = |name: &str| stops.iter().position(|column| column == name).ok_or(name.to_owned());
    let [point, peak] = [place("point")?, place("peak_force_n")?];
    let last = &contacts[contacts.len() - 1][point];
    for row in contacts.iter().filter(|row| row[point] == *last) {
        let wanted: f64 = row[peak].parse()?;
        let near = lines.iter().any(|line| line[0] == 2.0 && (line[3] - wanted).abs() <= 0.02 * wanted.abs());
        assert!(near, "the largest force {wanted} N is not drawn: {lines:?}");
    }
    Ok(())
}

/// Skipped, with a note, without Python with SciPy and Matplotlib.
#[test]
fn python_draws_both_figures_from_the_matlab_file() -> Outcome {
    let python = std::env::var("NLMODES_PYTHON").unwrap_or_else(|_| "python3".into());
    if !works(&python, &["-c", "import scipy.io, matplotlib.pyplot"]) {
        println!("skipped: no Python with SciPy and Matplotlib");
        return Ok(());
    }
    let (_folder, out, _) = run(&["output.matlab=true"])?;
    let call = std::process::Command::new(&python)
        .arg(scripts().join("plot_results.py"))
        .arg(out.join("results.mat"))
        .env("MPLBACKEND", "agg")
        .output()?;
    assert!(call.status.success(), "{}", String::from_utf8_lossy(&call.stderr));
    for name in ["frequency_energy.png", "contact_forces.png"] {
        let picture = fs::read(out.join(name))?;
        assert!(picture.starts_with(b"\x89PNG") && picture.len() > 5000, "{name}: {} bytes", picture.len());
    }
    Ok(())
}
