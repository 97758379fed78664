/// What one contact does in a period of a motion: how long it is closed, how hard it pushes, how fast it is met.
///
/// The impulse is what converges with the number of harmonics; the largest force does so slowly, if at all, where
/// contacts are short blows.
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
    /// Closed intervals a period.
    pub touches: usize,
    /// Largest speed at which the gap closes as it is touched, m/s; zero without a touch.
    pub approach_velocity: f64,
}
