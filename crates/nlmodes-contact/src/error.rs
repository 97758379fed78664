use thiserror::Error;

/// Why a contact problem has no solution here.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LcpError {
    /// No backend of that name.
    #[error("unknown contact solver `{name}`; there are: {}", known.join(", "))]
    UnknownSolver {
        /// The requested name.
        name: String,
        /// The available names.
        known: Vec<&'static str>,
    },
    /// `A` is not square.
    #[error("the contact matrix is not square: {rows} × {columns}")]
    NotSquare {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// `A_ij` and `A_ji` differ by more than rounding.
    #[error("the contact matrix is not symmetric: A[{row},{column}] = {value}, A[{column},{row}] = {transposed}")]
    NotSymmetric {
        /// Row of the entry, from zero.
        row: usize,
        /// Column of the entry, from zero.
        column: usize,
        /// `A[row, column]`, m/N.
        value: f64,
        /// `A[column, row]`, m/N.
        transposed: f64,
    },
    /// `A` has a negative eigenvalue: a compressive contact force would reduce the gap.
    #[error("the contact matrix is not positive semidefinite: pivot {pivot:e} (relative) at contact {contact}")]
    NotPositiveSemidefinite {
        /// First contact at which the factorisation fails, from zero.
        contact: usize,
        /// The pivot there, with the diagonal of `A` scaled to one.
        pivot: f64,
    },
    /// NaN or infinite, as given or after scaling.
    #[error("{what} is not finite")]
    NotFinite {
        /// Which quantity.
        what: &'static str,
    },
    /// The forces exist, but not as normal floating-point numbers in these units.
    #[error("the forces are too large or too small for floating-point numbers in these units")]
    OutOfRange,
    /// A slice has the wrong length.
    #[error("{what}: {expected} entries expected, {found} found")]
    Dimension {
        /// Which quantity.
        what: &'static str,
        /// Number of entries it must have.
        expected: usize,
        /// Number of entries it has.
        found: usize,
    },
    /// Too many contacts for this backend.
    #[error("contact solver `{solver}` treats at most {at_most} contact(s), not {found}")]
    TooManyContacts {
        /// Name of the backend.
        solver: &'static str,
        /// Its maximum number of contacts.
        at_most: usize,
        /// Number of contacts of the problem.
        found: usize,
    },
    /// No forces can open all contacts: the gaps contradict each other.
    #[error("contradictory contacts: no forces make all gaps non-negative")]
    Infeasible {
        /// The proof (c, N): `ray ≥ 0` with `A ray = 0` and `bᵀ ray < 0`, so `rayᵀ g < 0` whatever the forces are. In
        /// rounded numbers `max |A ray| ≤ 1e-8 |bᵀ ray|` (scaled), which excludes forces below `1e8 max |b|`.
        ray: Vec<f64>,
    },
    /// No contact forces balance a load on motions without stiffness.
    #[error("the body falls away: no contact forces balance the load on it")]
    Unbalanced {
        /// What is left of the load on each of the motions, along which the body goes.
        motion: Vec<f64>,
    },
    /// A motion without stiffness is not held by the closed contacts.
    #[error("the closed contacts do not hold the body: it can still move without strain")]
    Loose,
    /// The backend ended without a solution that the judge accepts.
    #[error("contact solver `{solver}` did not converge: violation {violation:.1e} after {iterations} iterations")]
    NotConverged {
        /// Name of the backend.
        solver: &'static str,
        /// Iterations done.
        iterations: usize,
        /// [`LcpMatrix::violation`](crate::LcpMatrix::violation) of `lambda`.
        violation: f64,
        /// The best iterate (c, N).
        lambda: Vec<f64>,
    },
    /// The best forces solve the problem to floating-point accuracy, but because the contacts are nearly redundant they
    /// are so large that their rounding alone may change the gaps by more than the judge permits.
    ///
    /// This begins at forces of about `1e5 max |b|` (scaled), for contacts that are redundant to within 1e-5 of their
    /// compliance.
    #[error(
        "contact solver `{solver}`: the contacts are so nearly redundant that forces cannot be told exactly enough: \
         violation {violation:e}, of which rounding explains up to {rounding:e}"
    )]
    Rounding {
        /// Name of the backend.
        solver: &'static str,
        /// [`LcpMatrix::violation`](crate::LcpMatrix::violation) of `lambda`.
        violation: f64,
        /// What rounding may contribute to it: `(c + 2) ε max |D| |A| |λ| / max |D b|`, `ε = 2⁻⁵³`.
        rounding: f64,
        /// The forces (c, N).
        lambda: Vec<f64>,
    },
    /// The third-party solver could not be set up.
    #[error("contact solver `{solver}` could not be set up: {reason}")]
    Setup {
        /// Name of the backend.
        solver: &'static str,
        /// Message of the third-party code.
        reason: String,
    },
    /// A sample of a series has no solution.
    #[error("sample {sample}: {source}")]
    Sample {
        /// Index of the sample, from zero.
        sample: usize,
        /// Why.
        source: Box<LcpError>,
    },
}
