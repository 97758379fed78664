/// An instant at which a contact closes or opens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactInstant {
    /// Time within the record, s.
    pub time: f64,
    /// True: touching begins. False: the body leaves.
    pub touching: bool,
}

/// Motion and force of one contact coordinate over time.
///
/// All series have the length of `time`.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeHistory {
    /// Name in legends.
    pub label: String,
    /// Time, s, ascending.
    pub time: Vec<f64>,
    /// Displacement, m.
    pub displacement: Vec<f64>,
    /// Velocity, m/s.
    pub velocity: Vec<f64>,
    /// Acceleration, m/s².
    pub acceleration: Vec<f64>,
    /// Contact force, N, zero or positive.
    pub force: Vec<f64>,
    /// Signed position of the stop along the coordinate, m.
    pub stop: f64,
    /// Instants of touching and leaving, ascending.
    pub instants: Vec<ContactInstant>,
}
