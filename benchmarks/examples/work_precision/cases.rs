//! The structures, and where on their branches the study is made.

use nlmodes::model::StructuralModel;
use nlmodes_benchmarks::{Failure, beam_in_six_modes, beam_structure, beam_with_ten_stops, unit_rod};

/// A structure and a point of its first nonlinear mode.
pub struct Case {
    pub slug: &'static str,
    pub title: &'static str,
    pub model: StructuralModel,
    /// Frequencies, Hz, or where negative over that at grazing, of which the first is taken at which the solutions with more and more
    /// harmonics and the exact one lie side by side.
    pub frequencies: &'static [f64],
    /// Whether MS-HBM with the harmonics of the seed may stand in for the exact motion.
    pub with_truncated_reference: bool,
    /// Harmonics with which the backbone is found there.
    pub leading_harmonics: usize,
    /// Harmonics from which the exact motion is sought.
    pub seed_harmonics: usize,
    /// Largest number of harmonics: beyond, the dense solve takes minutes.
    pub most_harmonics: usize,
}

/// The structures of the study. Frequencies: outside of the tongues of internal resonances.
pub fn cases() -> Result<Vec<Case>, Failure> {
    let case = |slug, title, model, frequencies| Case {
        slug,
        title,
        model,
        frequencies,
        with_truncated_reference: false,
        leading_harmonics: 5,
        seed_harmonics: 128,
        most_harmonics: 256,
    };
    Ok(vec![
        // Amplitude 2, in closed form in docs/convergence.md.
        case("rod2", "Rod of two elements", unit_rod(2)?, &[0.417_852_834_045_572_5]),
        case("rod3", "Rod of three elements", unit_rod(3)?, &[0.341_55]),
        case(
            "rod10",
            "Rod of ten elements",
            unit_rod(10)?,
            &[-1.08, -1.09, -1.07, -1.1, -1.06, -1.12, -1.15, -1.13, -1.17],
        ),
        case(
            "rod100",
            "Rod of a hundred elements",
            unit_rod(100)?,
            &[-1.08, -1.09, -1.07, -1.1, -1.06, -1.12, -1.15, -1.13, -1.17],
        ),
        case(
            "beam6",
            "Beam in six modes",
            beam_in_six_modes()?,
            &[42.0, 41.5, 42.3, 42.5, 43.0, 43.5, 41.2, 41.0, 44.0],
        ),
        Case {
            with_truncated_reference: true,
            seed_harmonics: 128,
            most_harmonics: 80,
            ..case("beam", "Beam of the paper", beam_structure()?, &[42.5, 45.5])
        },
        Case {
            with_truncated_reference: true,
            leading_harmonics: 3,
            seed_harmonics: 40,
            most_harmonics: 30,
            ..case("ten_stops", "Beam over ten stops", beam_with_ten_stops()?, &[-1.05, -1.3])
        },
    ])
}
