use std::fmt;

/// A way into an array.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Step {
    /// A variable, or a field of a structure.
    Field(String),
    /// An element of a cell or of an array of structures: its number and its subscripts, from 1.
    Element { number: u64, subscripts: Vec<u64>, of_cell: bool },
}

/// Path of an array in a file, in MATLAB notation: `FEM.K`, `KM{1}`, `part(2).K`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(in crate::formats) struct MatPath(Vec<Step>);

impl MatPath {
    pub(in crate::formats) fn variable(name: &str) -> Self {
        Self(vec![Step::Field(name.to_owned())])
    }

    fn with(&self, step: Step) -> Self {
        Self(self.0.iter().cloned().chain([step]).collect())
    }

    pub(in crate::formats) fn field(&self, name: &str) -> Self {
        self.with(Step::Field(name.to_owned()))
    }

    /// Element `index`, from 0, of a cell or of an array of structures; the only structure has no number.
    pub(in crate::formats) fn element(&self, index: u64, dimensions: &[u64], of_cell: bool) -> Self {
        let count = dimensions.iter().try_fold(1_u64, |product, length| product.checked_mul(*length));
        if !of_cell && count == Some(1) {
            return self.clone();
        }
        let (mut rest, mut subscripts) = (index, Vec::new());
        for length in dimensions {
            subscripts.push(rest % (*length).max(1) + 1);
            rest /= (*length).max(1);
        }
        self.with(Step::Element { number: index + 1, subscripts, of_cell })
    }

    /// What a field belongs to, and its name.
    pub(in crate::formats) fn parent(&self) -> Option<(Self, String)> {
        match self.0.split_last() {
            Some((Step::Field(name), parent)) if !parent.is_empty() => Some((Self(parent.to_vec()), name.clone())),
            _ => None,
        }
    }

    /// Whether this matches a name: fields behind points or strokes, numbers or subscripts in brackets.
    pub(in crate::formats) fn is(&self, name: &str) -> bool {
        let mut rest = name.trim_start_matches('/');
        let mut steps = self.0.iter().peekable();
        while !rest.is_empty() {
            if rest.starts_with(['{', '(']) {
                let Some((inside, after)) = rest[1..].split_once(['}', ')']) else { return false };
                let wanted: Option<Vec<u64>> = inside.split(',').map(|n| n.trim().parse().ok()).collect();
                let Some(wanted) = wanted else { return false };
                rest = after;
                match steps.peek() {
                    Some(Step::Element { number, subscripts, .. }) if wanted == [*number] || wanted == *subscripts => {
                        steps.next();
                    }
                    // The only structure may have a number.
                    Some(Step::Field(_)) | None if wanted.iter().all(|n| *n == 1) => {}
                    _ => return false,
                }
                continue;
            }
            rest = rest.strip_prefix(['.', '/']).unwrap_or(rest);
            let end = rest.find(['.', '/', '{', '(']).unwrap_or(rest.len());
            let (wanted, after) = rest.split_at(end);
            match steps.next() {
                Some(Step::Field(field)) if field == wanted => rest = after,
                _ => return false,
            }
        }
        steps.next().is_none()
    }
}

impl fmt::Display for MatPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, step) in self.0.iter().enumerate() {
            match step {
                Step::Field(name) if k == 0 => f.write_str(name)?,
                Step::Field(name) => write!(f, ".{name}")?,
                Step::Element { number, subscripts, of_cell } => {
                    let (open, close) = if *of_cell { ('{', '}') } else { ('(', ')') };
                    let is_list = subscripts.iter().filter(|k| **k != 1).count() <= 1 && subscripts.contains(number);
                    let list = || subscripts.iter().map(u64::to_string).collect::<Vec<_>>().join(",");
                    let inside = if is_list { number.to_string() } else { list() };
                    write!(f, "{open}{inside}{close}")?;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_written_as_in_matlab_and_found_by_what_people_write() {
        let field = MatPath::variable("sys").field("model").field("K");
        assert_eq!(field.to_string(), "sys.model.K");
        for name in ["sys.model.K", "sys/model/K", "/sys/model/K", "sys(1).model.K", "sys.model(1,1).K"] {
            assert!(field.is(name), "{name}");
        }
        for name in
            ["sys", "sys.model", "sys.model.M", "sys.model.K.x", "model.K", "sys(2).model.K", "", "sys{", "sys{x}"]
        {
            assert!(!field.is(name), "{name}");
        }
        let cell = MatPath::variable("KM").element(1, &[1, 2], true);
        assert_eq!(cell.to_string(), "KM{2}");
        assert!(cell.is("KM{2}") && cell.is("KM{1,2}") && cell.is("KM(2)") && !cell.is("KM{1}"));
        let square = MatPath::variable("C").element(2, &[2, 2], true);
        assert_eq!(square.to_string(), "C{1,2}");
        assert!(square.is("C{3}") && square.is("C{1, 2}") && !square.is("C{2,1}"));
        let many = MatPath::variable("part").element(1, &[3, 1], false).field("K");
        assert_eq!(many.to_string(), "part(2).K");
        assert!(many.is("part(2).K") && many.is("part(2,1)/K") && !many.is("part.K"));
        assert_eq!(MatPath::variable("one").element(0, &[1, 1], false).field("K").to_string(), "one.K");
    }
}
