/// A Fortran edit descriptor of one repeated field, as in `(3I14)`, `(1P,4D20.12)` or `(4(1PE25.16))`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Columns {
    /// Fields in a line.
    pub(super) count: usize,
    /// Characters of a field.
    pub(super) width: usize,
    /// Whether it is `I`.
    pub(super) integer: bool,
}

impl Columns {
    /// Takes a descriptor apart; nothing if it is of another kind.
    pub(super) fn parse(text: &[u8]) -> Option<Self> {
        let text: Vec<u8> = text.iter().filter(|b| !b.is_ascii_whitespace()).map(u8::to_ascii_uppercase).collect();
        let inner = text.strip_prefix(b"(")?.strip_suffix(b")")?;
        let (outer, inner) = match inner.iter().position(|b| *b == b'(') {
            Some(at) => (count(&inner[..at])?, inner[at + 1..].strip_suffix(b")")?),
            None => (1, inner),
        };
        let inner = scale(inner);
        let letter = inner.iter().position(|b| b.is_ascii_alphabetic())?;
        let repeat = count(&inner[..letter])?;
        let kind = inner[letter];
        let size = &inner[letter + 1..];
        let point = size.iter().position(|b| *b == b'.').unwrap_or(size.len());
        let width = crate::text::unsigned(&size[..point])?;
        let fits = b"IEDFG".contains(&kind) && (1..=200).contains(&width) && (1..=1000).contains(&(repeat * outer));
        fits.then_some(Self { count: repeat * outer, width: width as usize, integer: kind == b'I' })
    }
}

/// A number in front of something, 1 if there is none.
fn count(text: &[u8]) -> Option<usize> {
    if text.is_empty() { Some(1) } else { crate::text::unsigned(text).filter(|n| *n <= 1000).map(|n| n as usize) }
}

/// What follows a scale factor `1P` or `1P,`, which changes how numbers are written, not how those with an exponent are
/// read.
fn scale(text: &[u8]) -> &[u8] {
    let digits = text.iter().take_while(|b| b.is_ascii_digit()).count();
    match text[digits..].strip_prefix(b"P") {
        Some(rest) => rest.strip_prefix(b",").unwrap_or(rest),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptors_of_programs_are_understood() {
        let parsed = |text: &str| Columns::parse(text.as_bytes()).map(|c| (c.count, c.width, c.integer));
        assert_eq!(parsed("(3I14)          "), Some((3, 14, true)));
        assert_eq!(parsed("(I14)"), Some((1, 14, true)));
        assert_eq!(parsed("(5E16.8)"), Some((5, 16, false)));
        assert_eq!(parsed("(1P,4D20.12)"), Some((4, 20, false)));
        assert_eq!(parsed("(1P3E25.16E3)"), Some((3, 25, false)));
        assert_eq!(parsed("(4(1PE25.16))"), Some((4, 25, false)));
        assert_eq!(parsed("(d25.15)"), Some((1, 25, false)));
        for wrong in ["", "3I14", "(3A8)", "(I)", "(0I5)", "(3I0)", "(99999I9)", "(*)", "(3I14", "((3I14)"] {
            assert_eq!(parsed(wrong), None, "{wrong}");
        }
    }
}
