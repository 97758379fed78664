use crate::columns::Column;

/// Columns of `branch.csv` of a scene with responses, after those of every branch.
pub const RESPONSE_COLUMNS: [Column; 17] = [
    Column::new("response", "", "number of the response in the scene, from 1"),
    Column::new("kind", "", "what it follows: frequency, force, phase-resonance, damped-mode, mode, appropriation"),
    Column::new("curve", "", "number of the curve of this run, from 0"),
    Column::new("name", "", "name of the curve in figures"),
    Column::new("detached", "", "whether no curve from the ends of the window reaches it"),
    Column::new("level", "", "level of the load: amplitude of the first force in N, or of the base in m/s² or m"),
    Column::new(
        "force_n",
        "N",
        "amplitude of the first force; of a damped mode the force in one harmonic at the drive point that would hold it, of appropriation the fundamental of that of the first drive point",
    ),
    Column::new("acceleration_m_s2", "m/s²", "amplitude of the acceleration of the base"),
    Column::new("base_amplitude_m", "m", "amplitude of the displacement of the base"),
    Column::new("drive_fundamental_m", "m", "amplitude of the drive point at the frequency of the load"),
    Column::new(
        "drive_lag_deg",
        "°",
        "angle by which the drive point lags the force, or the displacement of the base, −180 to 180",
    ),
    Column::new("input_power_w", "W", "mean power of the load"),
    Column::new("dissipated_power_w", "W", "mean power that the damping takes out; equals the former"),
    Column::new("damping_ratio", "", "damping ratio ξ/(2ω) of a damped mode"),
    Column::new(
        "pbmif",
        "",
        "active over apparent power of the forces; of a mode that of a force in one harmonic at the drive point",
    ),
    Column::new(
        "multiplier_error",
        "",
        "estimated error of the largest multiplier; within it the stability is not said",
    ),
    Column::new(
        "mode_distance",
        "",
        "of appropriation: distance of the velocities from those of the mode, over the latter",
    ),
];

/// Columns of `appropriation.csv`.
pub const APPROPRIATION_COLUMNS: [Column; 6] = [
    Column::new("point", "", "number of the point, that of `branch.csv`; of a test that of the level, from 1"),
    Column::new("frequency_hz", "Hz", "frequency of the mode, or of the level"),
    Column::new("drive", "", "number of the drive point, from 0 in the order of the forces"),
    Column::new("harmonic", "", "harmonic of the force, from 1"),
    Column::new("force_n", "N", "its amplitude"),
    Column::new(
        "phase_deg",
        "°",
        "its phase, ahead of the cosine in which the mode moves; of a test, the fundamental of the displacement of the drive point",
    ),
];
