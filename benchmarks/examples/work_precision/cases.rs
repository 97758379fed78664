//! The structures, and where on their branches the study is made.

use nlmodes::model::StructuralModel;
use nlmodes_benchmarks::{Failure, beam_structure, beam_with_ten_stops, unit_rod};

/// A structure and a point of its first nonlinear mode.
pub struct Case {
    pub slug: &'static str,
    pub title: &'static str,
    pub model: StructuralModel,
    /// Frequencies, Hz, or where negative over that at grazing, of which the first is taken at which the solutions with more and more
    /// harmonics and the exact one lie side by side.
    pub frequencies: &'static [f64],
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
        case("beam", "Beam of the paper", beam_structure()?, &[44.0, 45.0, 43.0, 46.0, 42.5, 43.5, 44.5, 45.5, 49.0]),
        Case {
            leading_harmonics: 3,
            seed_harmonics: 30,
            most_harmonics: 40,
            ..case(
                "ten_stops",
                "Beam over ten stops",
                beam_with_ten_stops()?,
                &[-1.05, -1.1, -1.15, -1.2, -1.06, -1.12, -1.18, -1.25, -1.3],
            )
        },
    ])
}
