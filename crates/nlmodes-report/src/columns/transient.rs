//! The table of a motion in time.

use super::row::row;

row! {
    /// A touch of `touches.csv`.
    TouchRow {
        contact: usize, "", "number of the stop, from 0 in the order of the scene";
        instant_s: f64, "s", "when the contact closes, from the beginning of the motion";
        duration_s: f64, "s", "how long it stays closed, at most to the end of the motion";
        impulse_ns: f64, "N·s", "integral of its force over this time";
        approach_velocity_m_s: f64, "m/s",
            "rate at which the gap closes; 0 for a contact that is closed at the beginning";
    }
}
