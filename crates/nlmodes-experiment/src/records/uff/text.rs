//! Numbers as text, in fields of fixed width.

use crate::records::uff::header::parse;
use crate::records::uff::lines::{Lines, is_mark};
use crate::records::uff::{Precision, UffError};

/// Widths of the numbers of one value: six digits take 13 letters, twelve take 20; an abscissa always takes 13.
pub fn widths(precision: Precision, complex: bool, uneven: bool) -> Vec<usize> {
    let width = match precision {
        Precision::Single => 13,
        Precision::Double => 20,
    };
    let mut widths = if uneven { vec![13] } else { vec![] };
    widths.extend(std::iter::repeat_n(width, if complex { 2 } else { 1 }));
    widths
}

/// Reads `announced` numbers up to the end mark.
pub fn read(lines: &mut Lines<'_>, widths: &[usize], announced: usize) -> Result<Vec<f64>, UffError> {
    let begin = lines.number;
    // Memory is allocated as the numbers are read, whatever the header claims.
    let mut numbers = Vec::new();
    loop {
        let number = lines.number;
        let found = numbers.len();
        let line = lines.next().ok_or(UffError::CutOff { line: begin, announced, found })?;
        if is_mark(line) && found >= announced {
            return Ok(numbers);
        }
        // A lone −1 among numbers is no number of this format, which has decimals.
        if is_mark(line) {
            return Err(UffError::CutOff { line: begin, announced, found });
        }
        row(line, number, widths, &mut numbers)?;
        if numbers.len() > announced {
            return Err(UffError::TooMany { line: begin, announced });
        }
    }
}

/// The numbers of a line: separated by blanks, or in their columns where they touch.
fn row(line: &[u8], number: usize, widths: &[usize], numbers: &mut Vec<f64>) -> Result<(), UffError> {
    let text = String::from_utf8_lossy(line);
    let before = numbers.len();
    if text.split_whitespace().all(|word| parse(word).map(|x| numbers.push(x)).is_some()) {
        return Ok(());
    }
    numbers.truncate(before);
    let mut at = 0;
    for width in widths.iter().cycle() {
        if at >= line.len() {
            break;
        }
        let field = &line[at..(at + width).min(line.len())];
        let field = String::from_utf8_lossy(field.trim_ascii()).into_owned();
        at += width;
        if !field.is_empty() {
            numbers.push(parse(&field).ok_or_else(|| not_a_number(&field, &text, number))?);
        }
    }
    Ok(())
}

fn not_a_number(field: &str, line: &str, number: usize) -> UffError {
    let has_comma = |text: &str| text.contains(',') && parse(&text.replacen(',', ".", 1)).is_some();
    let word = line.split_whitespace().find(|word| has_comma(word));
    let word = word.filter(|_| !has_comma(field)).unwrap_or(field);
    UffError::NotANumber { line: number, text: word.chars().take(40).collect(), decimal_comma: has_comma(word) }
}
