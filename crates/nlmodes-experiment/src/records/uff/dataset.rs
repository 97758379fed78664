use num_complex::Complex64;

use crate::records::UnitSystem;

/// A function at a nodal degree of freedom: one dataset 58.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset58 {
    /// Five identification lines, up to 80 letters each.
    pub identification: [String; 5],
    /// Type of the function: 1 time response, 4 frequency response, …
    pub function_type: i32,
    /// Number of the function.
    pub function: i32,
    /// Version or sequence number.
    pub version: i32,
    /// Load case.
    pub load_case: i32,
    /// Where the response is.
    pub response: Node,
    /// Where the reference is.
    pub reference: Node,
    /// Value on the third axis.
    pub z: f64,
    /// What the abscissa is.
    pub abscissa_axis: Axis,
    /// What the ordinate is, or its numerator.
    pub ordinate_axis: Axis,
    /// What the denominator of the ordinate is.
    pub denominator_axis: Axis,
    /// What the third axis is.
    pub z_axis: Axis,
    /// Values of the abscissa.
    pub abscissa: Abscissa,
    /// Values of the function.
    pub ordinates: Ordinates,
    /// Units of the numbers where a dataset 164 gives them; not written.
    pub units: Option<UnitSystem>,
}

/// A degree of freedom.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Node {
    /// Name of the entity, up to 10 letters.
    pub entity: String,
    /// Number of the node.
    pub node: i32,
    /// Direction: 1 to 3 along x, y, z, 4 to 6 about them, negative the other way, 0 a scalar.
    pub direction: i32,
}

/// What an axis shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// Code: 8 displacement, 11 velocity, 12 acceleration, 13 force, 17 time, 18 frequency, …
    pub kind: i32,
    /// Exponents of length, force and temperature in the unit.
    pub exponents: [i32; 3],
    /// Label, up to 20 letters.
    pub label: String,
    /// Unit, up to 20 letters.
    pub unit: String,
}

/// Values of the abscissa.
#[derive(Debug, Clone, PartialEq)]
pub enum Abscissa {
    /// `first + step · j`.
    Even {
        /// First value.
        first: f64,
        /// Step.
        step: f64,
        /// Rounding error of the step in the header.
        rounding: f64,
        /// Rounding error of the first value in the header.
        first_rounding: f64,
    },
    /// Value by value.
    Uneven {
        /// The values.
        values: Vec<f64>,
        /// Their rounding error.
        rounding: f64,
    },
}

/// Values of a function.
#[derive(Debug, Clone, PartialEq)]
pub enum Ordinates {
    /// Real.
    Real(Vec<f64>),
    /// Complex.
    Complex(Vec<Complex64>),
}

/// Precision of the numbers in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// 4 bytes, or six digits as text.
    Single,
    /// 8 bytes, or twelve digits as text.
    Double,
}

/// How numbers are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// As text: dataset 58.
    Text,
    /// In binary: dataset 58b.
    Binary(ByteOrder),
}

/// Order of the bytes of a binary number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

impl Dataset58 {
    /// A real time response, with nothing else in its header.
    pub fn real(ordinates: Vec<f64>, abscissa: Abscissa) -> Self {
        let axis = Axis::default;
        Self {
            identification: Default::default(),
            function_type: 1,
            function: 0,
            version: 0,
            load_case: 0,
            response: Node::default(),
            reference: Node::default(),
            z: 0.0,
            abscissa_axis: axis(),
            ordinate_axis: axis(),
            denominator_axis: axis(),
            z_axis: axis(),
            abscissa,
            ordinates: Ordinates::Real(ordinates),
            units: None,
        }
    }

    /// Names under which the function can be found, the most telling one first.
    pub fn names(&self) -> Vec<String> {
        let place = format!("{}:{}", self.response.node, self.response.direction);
        let labels = [&self.ordinate_axis.label, &self.response.entity, &place];
        let mut names: Vec<String> = Vec::new();
        for label in self.identification.iter().chain(labels) {
            if !label.is_empty() && label != "NONE" && !is_time(label) && !names.contains(label) {
                names.push(label.clone());
            }
        }
        names
    }
}

/// Whether an identification line has a time: hours, minutes and seconds after a date.
fn is_time(label: &str) -> bool {
    label.starts_with(|c: char| c.is_ascii_digit()) && label.matches(':').count() == 2
}

impl Abscissa {
    /// Even, with a step that is known exactly.
    pub fn even(first: f64, step: f64) -> Self {
        Self::Even { first, step, rounding: 0.0, first_rounding: 0.0 }
    }
}

impl Ordinates {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Complex(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Default for Node {
    fn default() -> Self {
        Self { entity: "NONE".into(), node: 0, direction: 0 }
    }
}

impl Default for Axis {
    fn default() -> Self {
        Self { kind: 0, exponents: [0; 3], label: "NONE".into(), unit: "NONE".into() }
    }
}
