//! Tables of two columns: loads over time, forces over displacements.

use std::fs;
use std::path::Path;

use nlmodes_io::{Address, read_numbers};

use crate::chain;

/// Endings of texts.
const TEXTS: [&str; 5] = ["csv", "txt", "dat", "tsv", "asc"];

/// Reads two columns of an array, or of a text, with or without these names above.
///
/// # Errors
/// What is wrong, in words that begin with the file.
pub fn read(path: &Path, names: [&str; 2]) -> Result<[Vec<f64>; 2], String> {
    let of = |what: String| format!("{}: {what}", path.display());
    let address = Address::parse(&path.to_string_lossy());
    let ending = address.path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_text = address.name.is_none() && TEXTS.contains(&ending.as_str());
    let [first, second] = match is_text.then(|| fs::read_to_string(&address.path)) {
        Some(Ok(text)) if has_names(&text) => named(&text, names).map_err(of)?,
        _ => of_numbers(&address)
            .map_err(|why| if why.contains(&*address.path.to_string_lossy()) { why } else { of(why) })?,
    };
    if first.len() < 2 {
        return Err(of(format!("{} row; expected two or more", first.len())));
    }
    if let Some(k) = first.windows(2).position(|pair| pair[0] >= pair[1]) {
        let (before, behind) = (first[k], first[k + 1]);
        return Err(of(format!("row {}: {behind} behind {before}; expected {} that grows", k + 2, names[0])));
    }
    Ok([first, second])
}

fn of_numbers(address: &Address) -> Result<[Vec<f64>; 2], String> {
    let numbers = read_numbers(address).map_err(|error| chain(&error))?;
    let [rows, 2] = numbers.shape[..] else {
        return Err(format!("{}; expected two columns", numbers.size()));
    };
    let column = |j: usize| (0..rows).map(|i| numbers.values[2 * i + j]).collect();
    Ok([column(0), column(1)])
}

fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
    lines.enumerate().map(|(i, line)| (i + 1, line)).filter(|(_, line)| !line.is_empty())
}

/// Whether the first line has names.
fn has_names(text: &str) -> bool {
    let first = lines(text).next().map(|(_, line)| line);
    first.is_some_and(|line| {
        line.split([',', ';', '\t', ' ']).any(|field| field.trim().starts_with(|c: char| c.is_ascii_alphabetic()))
    })
}

/// The columns of these names.
fn named(text: &str, wanted: [&str; 2]) -> Result<[Vec<f64>; 2], String> {
    let mut lines = lines(text);
    let names: Vec<&str> = lines.next().map_or_else(Vec::new, |(_, line)| line.split(',').map(str::trim).collect());
    let column = |name: &str| {
        let found = names.iter().position(|own| *own == name);
        found.ok_or_else(|| format!("columns {}; expected {}", names.join(","), wanted.join(" and ")))
    };
    let columns = [column(wanted[0])?, column(wanted[1])?];
    let [mut first, mut second] = [Vec::new(), Vec::new()];
    for (number, line) in lines {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let read = |column: usize| {
            let field = fields.get(column).copied().unwrap_or_default();
            let number_there = field.parse::<f64>().ok().filter(|v| v.is_finite());
            number_there
                .ok_or_else(|| format!("line {number}: `{field}` in column {}; expected a number", names[column]))
        };
        first.push(read(columns[0])?);
        second.push(read(columns[1])?);
    }
    Ok([first, second])
}
