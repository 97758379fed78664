//! The structures, and where on their branches the study is made.

use nlmodes::model::{Drop, MasslessContactModel, StructuralModel};
use nlmodes_benchmarks::free_modes::FreeModes;
use nlmodes_benchmarks::{Failure, beam_structure, beam_with_ten_stops, unit_rod};

/// A structure and a point of its first nonlinear mode.
pub struct Case {
    pub slug: &'static str,
    pub title: &'static str,
    pub model: StructuralModel,
    /// Whose reduction `model` is, if it is one.
    pub whole: Option<Whole>,
    /// Frequency of the point, Hz, or where negative over that at grazing.
    pub frequency: f64,
    /// Harmonics with which the backbone is followed to that frequency, and from which the exact motion is sought
    /// there.
    pub leading_harmonics: usize,
    /// Largest number of harmonics: beyond, the dense solve takes minutes.
    pub most_harmonics: usize,
}

/// A structure with all its modes, and how it is reduced.
pub struct Whole {
    pub model: MasslessContactModel,
    pub reduction: FreeModes,
}

/// The structures of the study. Frequencies: outside of the tongues of internal resonances, see `survey`.
pub fn cases() -> Result<Vec<Case>, Failure> {
    let case = |slug, title, model, frequency| Case {
        slug,
        title,
        model,
        whole: None,
        frequency,
        leading_harmonics: 5,
        most_harmonics: 256,
    };
    // All methods, and the reference, in the same few modes: in all of them tongues lie side by side.
    let reduced = |slug, title, model: StructuralModel, modes: usize, frequency| -> Result<_, Failure> {
        let model = MasslessContactModel::new(&model, &Drop)?;
        let reduction = FreeModes::new(&model, modes)?;
        let structure = reduction.model.clone();
        let whole = Some(Whole { model, reduction });
        Ok(Case { whole, ..case(slug, title, structure, frequency) })
    };
    let stops = beam_with_ten_stops()?;
    Ok(vec![
        // Amplitude 2, in closed form in benchmarks/results/convergence.md.
        case("rod2", "Rod of two elements", unit_rod(2)?, 0.417_852_834_045_572_5),
        case("rod3", "Rod of three elements", unit_rod(3)?, 0.341_55),
        case("rod10", "Rod of ten elements", unit_rod(10)?, -1.08),
        case("rod100", "Rod of a hundred elements", unit_rod(100)?, -1.08),
        reduced("beam3", "Beam in three modes", beam_structure()?, 3, -1.208)?,
        reduced("beam6", "Beam in six modes", beam_structure()?, 6, -1.11)?,
        reduced("beam10", "Beam in ten modes", beam_structure()?, 10, -1.01)?,
        Case {
            leading_harmonics: 3,
            most_harmonics: 80,
            ..reduced("ten_stops", "Beam over ten stops, in three modes", stops, 3, -1.08)?
        },
    ])
}
