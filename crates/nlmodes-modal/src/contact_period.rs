use crate::Sliding;

/// Quantities of one contact over a period of a motion: duration, force and approach speed.
///
/// The impulse converges with the number of harmonics; the largest force converges slowly, if at all, for short
/// contacts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactPeriod {
    /// Share of the period in which it is closed.
    pub closed_share: f64,
    /// Largest force, N.
    pub peak_force: f64,
    /// Force averaged over the period, N.
    pub mean_force: f64,
    /// Integral of the force over the period, N·s.
    pub impulse: f64,
    /// Closed intervals per period.
    pub touches: usize,
    /// Largest closing speed at the beginning of contact, m/s; zero without contact.
    pub approach_velocity: f64,
    /// How it slides; none where its node has no motion within the plane of the contact, or it is not known.
    pub sliding: Option<Sliding>,
}
