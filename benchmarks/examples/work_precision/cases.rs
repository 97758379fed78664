//! The structures, and where on their branches the study is made.

use nlmodes::model::StructuralModel;
use nlmodes_benchmarks::{Failure, beam_structure, beam_with_ten_stops, unit_rod};

/// A structure and a point of its first nonlinear mode.
pub struct Case {
    pub slug: &'static str,
    pub title: &'static str,
    pub model: StructuralModel,
    /// Averaged kinetic energy over that at grazing.
    pub energy_ratio: f64,
    /// Harmonics with which the branch is followed from grazing to that energy.
    pub leading_harmonics: usize,
    /// Harmonics from which the exact motion is sought.
    pub seed_harmonics: usize,
    /// Largest number of harmonics: beyond, the dense solve takes minutes.
    pub most_harmonics: usize,
}

/// The structures of the study. Energies: where the branches with all numbers of harmonics and the exact one run side by side,
/// outside of the tongues of internal resonances.
pub fn cases() -> Result<Vec<Case>, Failure> {
    let case = |slug, title, model, energy_ratio| Case {
        slug,
        title,
        model,
        energy_ratio,
        leading_harmonics: 20,
        seed_harmonics: 128,
        most_harmonics: 256,
    };
    // Two elements, amplitude 2: E_av is known in closed form, and ½ at grazing.
    Ok(vec![
        case("rod2", "Rod of two elements", unit_rod(2)?, 2.0 * 2.076_372_313_358_422),
        case("rod3", "Rod of three elements", unit_rod(3)?, 3.0),
        case("rod10", "Rod of ten elements", unit_rod(10)?, 3.0),
        Case { leading_harmonics: 5, ..case("rod100", "Rod of a hundred elements", unit_rod(100)?, 3.0) },
        Case { leading_harmonics: 5, ..case("beam", "Beam of the paper", beam_structure()?, 3.0) },
        Case {
            leading_harmonics: 3,
            seed_harmonics: 40,
            most_harmonics: 80,
            ..case("ten_stops", "Beam over ten stops", beam_with_ten_stops()?, 1.5)
        },
    ])
}
