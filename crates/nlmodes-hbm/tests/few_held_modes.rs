//! Where a branch begins if only few modes of the held structure are kept: at the linear mode that these have.

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
use nlmodes_hbm::{CondensedStructure, MixedShooting, MixedShootingSettings, Switching, Symmetry, grazing};
use nlmodes_model::{Drop, MasslessContactModel, Side};

/// Modulus, density and metre in SI units, and in t, mm, s.
const UNITS: [[f64; 3]; 2] = [[210e9, 9000.0, 1.0], [210e3, 9e-9, 1e3]];

/// A rod with stops behind its end and in its middle, whose second mode has nearly three times the first frequency.
fn structure([modulus, density, metre]: [f64; 3], held: usize) -> CondensedStructure {
    let rod = Rod {
        material: Material::new(modulus, density).unwrap(),
        area: metre * metre,
        mesh: Mesh::uniform(20.0 * metre, 40).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = |at: f64, gap: f64| Stop::rigid(at * metre, Direction::Axial, Side::Positive, gap * metre);
    let model = rod.assemble(&[stop(20.0, 0.5), stop(10.0, 0.4)]).unwrap();
    CondensedStructure::new(MasslessContactModel::new(&model, &Drop).unwrap(), held).unwrap()
}

#[test]
fn the_first_point_is_a_solution_however_few_the_modes() {
    for (units, held) in UNITS.iter().flat_map(|units| [5, 10, 18, 30].map(|held| (units, held))) {
        let structure = structure(*units, held);
        for harmonics in [1, 3, 5] {
            let start = grazing(&structure, 1).unwrap();
            let settings = MixedShootingSettings { harmonics, symmetry: Symmetry::Even, switching: Switching::Exact };
            let solver = solver_by_name("active-set").unwrap();
            let mut problem = MixedShooting::new(&structure, settings, start.scales(), solver.as_ref()).unwrap();
            let mut out = Linearization::new(problem.dim());
            let x = start.unknowns(problem.series(), problem.dim());
            problem.linearize(&x, 0.0, &mut out).unwrap();
            let worst = out.residual.iter().fold(0.0_f64, |worst, r| worst.max(r.abs()));
            assert!(worst < 1e-11, "{held} {harmonics}: {worst:e}");
        }
    }
}

/// What the modes leave out is a spring with mass: the error of the squared frequency falls with the third power of their number.
#[test]
fn with_more_modes_it_comes_to_that_of_the_whole_structure() {
    let omega = |held: usize| grazing(&structure(UNITS[0], held), 1).unwrap().omega;
    let errors = [5, 10, 20].map(|held| (omega(held) / omega(38) - 1.0).abs());
    assert!(errors[0] < 1e-3 && errors[1] < errors[0] / 6.0 && errors[2] < errors[1] / 6.0, "{errors:?}");
}
