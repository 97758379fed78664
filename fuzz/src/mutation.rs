//! From valid files to files that are almost valid.

use rand::{Rng, RngExt};

/// Numbers that go wrong where anything can.
const NUMBERS: [&str; 16] = [
    "0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "nan",
    "inf",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "4294967296",
    "2147483647",
    "0.1e1000",
    "1000001",
    "1e5",
    "65536",
];
/// Longest input, bytes.
const LONGEST: usize = 1 << 16;

/// A valid file, or two of them spliced, with one to eight mutations.
pub fn mutated(corpus: &[Vec<u8>], words: &[&str], random: &mut impl Rng) -> Vec<u8> {
    let mut bytes = pick(corpus, random).clone();
    for _ in 0..random.random_range(1..=8) {
        mutate(&mut bytes, corpus, words, random);
    }
    bytes.truncate(LONGEST);
    bytes
}

fn mutate(bytes: &mut Vec<u8>, corpus: &[Vec<u8>], words: &[&str], random: &mut impl Rng) {
    let at = random.random_range(0..=bytes.len());
    let end = (at + random.random_range(0..=40)).min(bytes.len());
    match random.random_range(0..12_u32) {
        0 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8_u32),
        1 if at < bytes.len() => bytes[at] = random.random(),
        2 => drop(bytes.drain(at..end)),
        3 => bytes.truncate(at),
        4 => insert(bytes, at..at, random.random_iter().take(4).collect::<Vec<u8>>()),
        5 | 6 => insert(bytes, at..at, pick(words, random).bytes()),
        7 => insert(bytes, at..end, pick(words, random).bytes()),
        8 | 9 => another_number(bytes, at, random),
        10 => {
            let part = bytes[at..end].to_vec();
            for _ in 0..random.random_range(1..30) {
                insert(bytes, at..at, part.iter().copied());
            }
        }
        _ => {
            let other = pick(corpus, random);
            let from = random.random_range(0..=other.len());
            let to = (from + random.random_range(0..200)).min(other.len());
            insert(bytes, at..end, other[from..to].iter().copied());
        }
    }
}

/// Puts one of the odd numbers in the place of the next one in the text.
fn another_number(bytes: &mut Vec<u8>, at: usize, random: &mut impl Rng) {
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|i| i + at) else { return };
    let part = |b: &u8| b.is_ascii_digit() || b".eE+-_".contains(b);
    let end = bytes[start..].iter().position(|b| !part(b)).map_or(bytes.len(), |i| i + start);
    insert(bytes, start..end, pick(&NUMBERS, random).bytes());
}

fn insert(bytes: &mut Vec<u8>, range: std::ops::Range<usize>, with: impl IntoIterator<Item = u8>) {
    drop(bytes.splice(range, with));
}

fn pick<'a, T>(from: &'a [T], random: &mut impl Rng) -> &'a T {
    &from[random.random_range(0..from.len())]
}
