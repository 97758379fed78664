//! The table of curves over a parameter.

use super::row::row;

row! {
    /// A point of `follow.csv`.
    FollowRow {
        curve: usize, "", "number of the curve, from 0: of each fold or first touch its own";
        value: f64, "unit of the key", "value of the parameter";
        frequency_hz: f64, "Hz", "frequency of the load there, or of the mode";
        d_frequency_d_value: f64, "Hz per unit of the key", "its derivative along the curve; infinite where that turns";
        fundamental_m: f64, "m", "amplitude of the fundamental of stop 0";
        peak_m: f64, "m", "largest displacement of stop 0 toward it";
        peak_contact_force_n: f64, "N", "largest contact force of all stops";
        impulse_ns: f64, "N·s", "impulse of all stops over a period";
        energy_j: f64, "J", "averaged kinetic energy";
        level: f64, "unit of the load", "level of the load; 0 of a mode";
        residual: f64, "", "largest scaled residual of the equations";
        turns: bool, "", "whether the curve turns here: on this side there is no such motion beyond the value";
    }
}
