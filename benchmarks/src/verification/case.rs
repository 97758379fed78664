use crate::Failure;

/// Where a reference comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A closed form, or an equation of one unknown solved to rounding.
    Exact,
    /// Another method for the same equations, written for the case.
    Independent,
    /// A number that another program gave.
    OtherProgram,
    /// A number that was measured.
    Measured,
}

impl Kind {
    /// Its name in the manual.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Independent => "independent computation",
            Self::OtherProgram => "other program",
            Self::Measured => "measured",
        }
    }
}

/// A problem with a known answer.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Short name, unlike all others.
    pub name: &'static str,
    /// The problem.
    pub problem: &'static str,
    /// Kind of the reference.
    pub kind: Kind,
    /// The reference.
    pub reference: &'static str,
    /// What is to be said of it, such as why a published number is wrong; empty where there is nothing.
    pub remark: &'static str,
    /// Computes the case.
    pub compute: fn() -> Result<Vec<Check>, Failure>,
}

/// A number beside its reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// What it is, with its unit.
    pub what: String,
    /// What was obtained.
    pub obtained: f64,
    /// What it should be.
    pub reference: f64,
    /// Size of which the error is a share.
    pub size: f64,
    /// Largest share.
    pub limit: f64,
    /// Why the limit is what it is.
    pub why: &'static str,
}

impl Check {
    /// The error is a share of the reference.
    pub fn relative(what: impl Into<String>, obtained: f64, reference: f64, limit: f64, why: &'static str) -> Self {
        Self { what: what.into(), obtained, reference, size: reference.abs(), limit, why }
    }

    /// The error is a share of `size`.
    pub fn of_size(
        what: impl Into<String>,
        [obtained, reference, size]: [f64; 3],
        limit: f64,
        why: &'static str,
    ) -> Self {
        Self { what: what.into(), obtained, reference, size, limit, why }
    }

    /// A count, which is right or wrong.
    pub fn count(what: impl Into<String>, obtained: usize, reference: usize) -> Self {
        Self::of_size(what, [obtained as f64, reference as f64, 1.0], 0.0, "a count")
    }

    /// An order of convergence.
    pub fn order(what: impl Into<String>, obtained: f64, reference: f64, limit: f64, why: &'static str) -> Self {
        Self::of_size(format!("observed order, {}", what.into()), [obtained, reference, 1.0], limit, why)
    }

    /// The error as a share.
    pub fn error(&self) -> f64 {
        (self.obtained - self.reference).abs() / self.size
    }

    /// Whether the error is within its limit; an error without a number is not.
    pub fn passes(&self) -> bool {
        self.error() <= self.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_beyond_its_limit_or_none_at_all_fails() {
        assert!(Check::relative("", 1.0 + 1e-9, 1.0, 1e-8, "").passes());
        assert!(!Check::relative("", 1.0 + 1e-7, 1.0, 1e-8, "").passes());
        assert!(!Check::relative("", f64::NAN, 1.0, 1e-8, "").passes());
        assert!(!Check::relative("", 0.0, 0.0, 1e-8, "").passes());
        assert!(Check::count("", 3, 3).passes() && !Check::count("", 3, 4).passes());
    }
}
