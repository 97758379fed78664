//! The tables of differences between what is laid over and what a scene computes.

use super::row::row;

row! {
    /// A point of `response_overlay.csv`.
    ResponseDifferenceRow {
        overlay: String, "", "name of the overlay";
        point: usize, "", "point of the overlay, from 0";
        frequency_hz: f64, "Hz", "frequency of the load, of both";
        level: f64, "unit of the load", "level of the point; NaN where the table has none";
        fundamental_m: f64, "m", "fundamental of the first contact; NaN where it is not known";
        curve_fundamental_m: f64, "m", "that of the curve there, linear between its points";
        drive_fundamental_m: f64, "m", "fundamental of the drive point; NaN where it is not known";
        curve_drive_fundamental_m: f64, "m", "that of the curve there";
        peak_contact_force_n: f64, "N", "largest contact force; NaN where it is not known";
        curve_peak_contact_force_n: f64, "N", "that of the curve there";
    }
}

row! {
    /// A point of `overlay.csv` or `methods.csv`.
    DifferenceRow {
        overlay: String, "", "name of the overlay";
        point: usize, "", "point of the overlay, from 0";
        modal_amplitude: f64, "m √kg", "modal amplitude of both; NaN where energies are equal";
        energy_j: f64, "J", "averaged kinetic energy of both; NaN where amplitudes are equal";
        frequency_hz: f64, "Hz", "frequency of the point";
        branch_frequency_hz: f64, "Hz", "frequency of the branch there, linear between its points";
        relative_difference: f64, "", "the first over the second, minus one; negative where the overlay is softer";
        peak_contact_force_n: f64, "N", "largest contact force of the point; NaN where it is not known";
        branch_peak_contact_force_n: f64, "N", "that of the branch there";
        impulse_ns: f64, "N·s",
            "integral of all contact forces over a period at the point; NaN where it is not known";
        branch_impulse_ns: f64, "N·s", "that of the branch there";
        motions: usize, "",
            "motions of this amplitude, or energy, that one of the two has; with more than one, as at an internal \
             resonance, the nearest in frequency is given, may be on another half-branch, and is not in the median; \
             of measured points the one whose difference is most like that of points with one motion, which is in \
             the median";
    }
}

row! {
    /// A stop at a point, of `overlay_stops.csv` or `methods_stops.csv`.
    StopDifferenceRow {
        overlay: String, "", "name of the overlay";
        point: usize, "", "point of the overlay, from 0";
        contact: usize, "", "number of the stop, from 0 in the order of the scene";
        equal: String, "",
            "what both motions have in common: `modal amplitude`, `energy` where there are no amplitudes, or \
             `frequency`; each point is listed for both comparisons";
        frequency_hz: f64, "Hz", "frequency of the point";
        branch_frequency_hz: f64, "Hz", "frequency of the branch there, linear between its points";
        impulse_ns: f64, "N·s", "integral of the force of this stop over a period at the point";
        branch_impulse_ns: f64, "N·s", "that of the branch there";
        relative_difference: f64, "",
            "the first over the second, minus one; NaN where the branch has no impulse there";
        motions: usize, "",
            "motions with this in common that one of the two has; with more than one the nearest is given, may be \
             on another half-branch, and is not in the median";
    }
}
