use thiserror::Error;

/// Why a modal quantity cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ModalError {
    /// The harmonics alias.
    #[error("{harmonics} harmonics need at least {needed} samples a period, not {samples}")]
    TooFewSamples {
        /// Highest harmonic.
        harmonics: usize,
        /// Samples a period.
        samples: usize,
        /// Smallest sufficient number.
        needed: usize,
    },
    /// A table of linear mode shapes is inconsistent with its positions or frequencies.
    #[error(
        "the table of linear mode shapes has {rows} rows and {columns} columns (rows of equal length?), but there are \
         {positions} \
         positions and {modes} modes with frequency and damping ratio"
    )]
    ShapeTable {
        /// Rows of the table.
        rows: usize,
        /// Entries of the first row.
        columns: usize,
        /// Number of positions.
        positions: usize,
        /// Number of modes that have a frequency and a damping ratio.
        modes: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what}: a number is not finite")]
    NotFinite {
        /// Where.
        what: &'static str,
    },
    /// The positions do not distinguish the modes.
    #[error(
        "{coordinates} positions cannot tell {modes} modes apart (smallest over largest singular value of the shapes: \
         {ratio:.1e})"
    )]
    DependentShapes {
        /// Number of positions.
        coordinates: usize,
        /// Number of modes.
        modes: usize,
        /// Smallest over largest singular value.
        ratio: f64,
    },
    /// A motion cannot be normalised on its fundamental.
    #[error("the fundamental of the motion cannot be normalised: its mass norm squared is {squared} kg·m²")]
    NoFundamental {
        /// `q₁ᴴ M q₁`, kg·m².
        squared: f64,
    },
    /// The series of a time history have different lengths, or too few entries.
    #[error(
        "a time history needs at least {needed} samples and series of equal length; found {time} instants, \
         {displacement} displacements, {velocity} velocities, {force} forces"
    )]
    HistoryLength {
        /// Samples that are needed.
        needed: usize,
        /// Instants.
        time: usize,
        /// Displacements.
        displacement: usize,
        /// Velocities.
        velocity: usize,
        /// Forces.
        force: usize,
    },
    /// The record has no complete contact interval.
    #[error(
        "no contact interval lies within the record: the force peaks at {peak} N, and {threshold} N count as closed"
    )]
    NoContact {
        /// Largest force, N.
        peak: f64,
        /// Force above which the contact is closed, N.
        threshold: f64,
    },
    /// Force and displacement do not increase together: there is no stiffness to fit.
    #[error("{samples} samples in contact span {span} m of displacement: no contact stiffness can be fitted")]
    NoPenetration {
        /// Samples in contact.
        samples: usize,
        /// Range of displacement among them, m.
        span: f64,
    },
}
