//! Mixed shooting-harmonic balance: one residual with its Jacobian, and whole branches.

use std::hint::black_box;
use std::ops::ControlFlow;

use criterion::{Criterion, criterion_group, criterion_main};
use nlmodes::contact::solver_by_name;
use nlmodes::continuation::{Linearization, ParametricSystem};
use nlmodes::fem::MassMatrix;
use nlmodes::hbm::{CondensedStructure, MixedShooting, MixedShootingSettings, Switching, Symmetry, grazing};
use nlmodes::model::MasslessContactModel;
use nlmodes::study::{BranchSettings, compute_branch};

/// The rod of Section 3, with `elements` elements.
fn rod(elements: usize) -> MasslessContactModel {
    nlmodes_benchmarks::rod(elements, MassMatrix::Consistent).expect("the rod of the paper")
}

/// The beam of Section 4.
fn beam() -> MasslessContactModel {
    nlmodes_benchmarks::beam().expect("the beam of the paper")
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
