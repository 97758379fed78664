//! Mixed shooting-harmonic balance: one residual with its Jacobian, and whole branches.

use std::hint::black_box;
use std::ops::ControlFlow;

use criterion::{Criterion, criterion_group, criterion_main};
use nlmodes::contact::solver_by_name;
use nlmodes::continuation::{Linearization, ParametricSystem};
use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes::hbm::{CondensedStructure, MixedShooting, MixedShootingSettings, Switching, Symmetry, grazing};
use nlmodes::model::{Drop, MasslessContactModel, Side};
use nlmodes::study::{BranchSettings, compute_branch};

/// The rod of Section 3, with `elements` elements.
fn rod(elements: usize) -> MasslessContactModel {
    let rod = Rod {
        material: Material::new(210e9, 9000.0).expect("steel-like"),
        area: 1.0,
        mesh: Mesh::uniform(20.0, elements).expect("a mesh"),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(20.0, Direction::Axial, Side::Positive, 0.5);
    MasslessContactModel::new(&rod.assemble(&[stop]).expect("a rod"), &Drop).expect("massless tip")
}

/// The beam of Section 4.
fn beam() -> MasslessContactModel {
    let length = 0.629_755_20;
    let beam = Beam {
        material: Material::new(181.36e9, 7730.0).expect("steel"),
        section: Section::rectangle(0.012, 0.020).expect("a rectangle"),
        mesh: Mesh::graded(length, 21, 9.195_853_6).expect("a mesh"),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(length, Direction::Transverse, Side::Positive, 1.03e-3);
    MasslessContactModel::new(&beam.assemble(&[stop]).expect("a beam"), &Drop).expect("massless tip")
}

/// Residual with Jacobian at a motion with contact, for several numbers of harmonics.
fn residual(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("residual and Jacobian, rod of 100 elements");
    let structure = CondensedStructure::new(rod(100), 99).expect("held rod");
    let start = grazing(&structure, 1).expect("the first mode touches");
    let solver = solver_by_name("active-set").expect("the default");
    for harmonics in [1, 3, 5, 10, 20, 40, 80] {
        let settings = MixedShootingSettings { harmonics, symmetry: Symmetry::Even, switching: Switching::Exact };
        let mut problem = MixedShooting::new(&structure, settings, start.scales(), solver.as_ref()).expect("a problem");
        let n = problem.dim();
        let mut x = start.unknowns(problem.series(), n);
        x[0] -= 0.2;
        x[1] += 0.4;
        let mut out = Linearization::new(n);
        group.bench_function(format!("{harmonics} harmonics"), |bencher| {
            bencher.iter(|| problem.linearize(black_box(&x), 0.5, &mut out).expect("a motion with contact"));
        });
    }
    group.finish();
}

/// The two studies of the paper, from the model to the branch.
fn branches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("branch");
    group.sample_size(20);
    let loop_of_the_rod = BranchSettings {
        harmonics: 3,
        max_energy_ratio: Some(20.0),
        frequency_hz: Some([50.0, 66.5]),
        ..BranchSettings::default()
    };
    let cases = [
        ("rod, 3 harmonics, the whole loop", rod(100), loop_of_the_rod),
        (
            "beam, 5 harmonics, to 6 grazing energies",
            beam(),
            BranchSettings { harmonics: 5, max_energy_ratio: Some(6.0), ..BranchSettings::default() },
        ),
    ];
    for (name, model, settings) in cases {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                compute_branch(model.clone(), &settings, |_| ControlFlow::Continue(())).expect("a branch").branch
            });
        });
    }
    group.finish();
}

criterion_group!(benches, residual, branches);
criterion_main!(benches);
