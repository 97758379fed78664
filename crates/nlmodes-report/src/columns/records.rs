//! The table of records and of the levels of tests.

use super::row::{Numbered, Sometimes, row};

row! {
    /// A record, or a level of a test, of `modal_points.csv`.
    ModalPointRow {
        record: String, "", "name of the record, or of the level of a test";
        segment: Sometimes<String>, "", "of records with several levels: which of them";
        from_s: Sometimes<Option<f64>>, "s", "of records with several levels: its first instant";
        to_s: Sometimes<Option<f64>>, "s", "of records with several levels: its end";
        drive_v: Sometimes<Option<f64>>, "V", "of a test: amplitude of the signal to the exciter";
        drive_n: Sometimes<Option<f64>>, "N", "of a test with an ideal force: its amplitude";
        frequency_hz: Option<f64>, "Hz", "frequency of the vibration";
        modal_amplitude: Option<f64>, "m √kg", "nonlinear modal amplitude, for shapes with unit modal mass";
        damping: Option<f64>, "",
            "`P₁/(q̃² ω³)`: power of the first harmonic of the force over modal amplitude and angular frequency, a \
             damping ratio";
        drive_fundamental_m: Option<f64>, "m", "amplitude of the fundamental of the displacement of the drive point";
        lag_deg: Option<f64>, "°",
            "by how much the displacement of the drive point lags the force in the first harmonic; 90 at phase \
             resonance";
        modal_lag_deg: Option<f64>, "°",
            "the same of the coordinate of the excited linear mode, from all sensors: without what other modes add to \
             the motion of the drive point";
        phase_indicator: Option<f64>, "",
            "from the fundamentals `x_i` of all sensors by the phase of the force: `1 − Σ |Re x_i||x_i| / Σ |x_i|²`, \
             one in phase resonance";
        pbmif: Option<f64>, "",
            "power-based mode indicator: active over apparent power of the force, one at phase resonance of all \
             harmonics";
        pbmif_harmonics: Option<usize>, "", "number of harmonics in it";
        participation "participation_…": Numbered<Option<f64>>, "",
            "participation of the linear mode: its coordinate over the modal amplitude, summed over the harmonics \
             at the peak of the first one";
        participation_harmonics: Option<usize>, "", "harmonics in the participation";
        peak_contact_force_n: Option<f64>, "N",
            "largest contact force of the mean period, without the noise of the force cell";
        contact_stiffness_n_m: Option<f64>, "N/m",
            "slope of the contact force over the displacement at the stop while it is touched";
        restitution_mean: Option<f64>, "", "speed after over speed before an impact, mean over the impacts";
        restitution_std: Option<f64>, "", "its standard deviation";
        approach_speed_m_s: Option<f64>, "m/s", "speed before an impact, mean over the impacts";
        impacts: Option<usize>, "", "impacts in the record";
        contact_fraction: Option<f64>, "", "share of the time in which the stop is touched";
        force_n: Option<f64>, "N", "amplitude of the force in the first harmonic";
        power_w: Option<f64>, "W", "active power of the force in the first harmonic";
        total_power_w: Option<f64>, "W",
            "active power of the force in as many harmonics as pbmif_harmonics says, eq. (17)";
        linear_dissipation_w: Option<f64>, "W", "power that the damping ratios of the linear modes would take";
        contact_dissipation_w: Option<f64>, "W",
            "total_power_w less what the damping ratios of the linear modes take in the same harmonics: lost at the \
             contact, or in modes that are not in the table";
        balance_peak_force_n: Option<f64>, "N",
            "largest contact force by the balance of the linear modes, without the force cell; empty where it is \
             within its errors";
        balance_impulse_ns: Option<f64>, "N s", "its integral over a period, by the balance of the linear modes";
        balance_restitution: Option<f64>, "",
            "speed after over speed before a contact, where that force begins and ends";
        balance_stiffness_n_m: Option<f64>, "N/m", "slope of that force over the displacement at the stop";
        energy_j: Option<f64>, "J", "kinetic energy, averaged over a period";
        periods: Option<usize>, "", "whole periods that were evaluated";
        frequency_hz_uncertainty: Option<f64>, "Hz",
            "standard error, over the single periods, of the column of this name";
        modal_amplitude_uncertainty: Option<f64>, "m √kg", "the same";
        damping_uncertainty: Option<f64>, "", "the same";
        drive_fundamental_m_uncertainty: Option<f64>, "m", "the same";
        lag_deg_uncertainty: Option<f64>, "°", "the same";
        modal_lag_deg_uncertainty: Option<f64>, "°", "the same";
        phase_indicator_uncertainty: Option<f64>, "", "the same";
        pbmif_uncertainty: Option<f64>, "", "the same";
        peak_contact_force_n_uncertainty: Option<f64>, "N", "the same";
        contact_stiffness_n_m_uncertainty: Option<f64>, "N/m", "the same, with one impact left out at a time";
        force_n_uncertainty: Option<f64>, "N", "the same";
        power_w_uncertainty: Option<f64>, "W", "the same";
        total_power_w_uncertainty: Option<f64>, "W", "the same";
        contact_dissipation_w_uncertainty: Option<f64>, "W", "the same, with the errors of the linear modes";
        balance_peak_force_n_uncertainty: Option<f64>, "N", "the same, with the errors of the linear modes";
        balance_impulse_ns_uncertainty: Option<f64>, "N s", "the same, with the errors of the linear modes";
        balance_restitution_uncertainty: Option<f64>, "", "change over the distance of two points of the force";
        balance_stiffness_n_m_uncertainty: Option<f64>, "N/m", "the share of the uncertainty of the peak";
        energy_j_uncertainty: Option<f64>, "J", "the same";
        participation_uncertainty "participation_…_uncertainty": Numbered<Option<f64>>, "", "the same";
        findings: String, "",
            "names of what is wrong with the record, separated by spaces; `summary.json` has each in words";
    }
}

row! {
    /// A harmonic of a record, of `damping_by_harmonic.csv`.
    HarmonicDampingRow {
        record: String, "", "name of the record";
        segment: Sometimes<String>, "", "of records with several levels: which of them";
        harmonic: usize, "", "number of the harmonic";
        damping: f64, "",
            "damping coefficient of the harmonic, eq. (26): `Σ ζ_k ω_k |η_k,n|² / (ω q̃²)` of the linear modes";
        linear_dissipation_w: f64, "W", "power that the damping ratios of the linear modes take in it, eq. (25)";
        energy_j: f64, "J", "kinetic energy of the harmonic, averaged over a period";
        damping_uncertainty: Option<f64>, "", "standard error, over the single periods";
    }
}

row! {
    /// A point of a free decay, of `decay.csv`.
    DecayRow {
        record: String, "", "name of the record";
        time_s: f64, "s", "instant, on the time axis of the record";
        frequency_hz: f64, "Hz", "frequency";
        modal_amplitude: f64, "m √kg",
            "modal amplitude of the first harmonic; without linear modes the amplitude of the displacement, m";
        damping: f64, "",
            "damping ratio, from the decay of twice the kinetic energy over the frequency: that of the damped mode";
        frequency_hz_uncertainty: f64, "Hz", "standard error, of the course over seven blocks of three periods";
        modal_amplitude_uncertainty: f64, "m √kg", "the same";
        damping_uncertainty: f64, "", "the same";
    }
}
