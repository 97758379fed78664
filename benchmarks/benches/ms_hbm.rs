//! Mixed shooting-harmonic balance: one residual with its Jacobian over the number of harmonics. Whole branches are
//! among the `kernels`.

use criterion::{Criterion, criterion_group, criterion_main};
use nlmodes_benchmarks::kernels::residual;

/// Residual with Jacobian of the rod of 100 elements at a motion with contact, for several numbers of harmonics.
fn residuals(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("residual and Jacobian, rod of 100 elements");
    for harmonics in [1, 3, 5, 10, 20, 40, 80] {
        let mut kernel = residual(99, harmonics).expect("the rod of the paper");
        group.bench_function(format!("{harmonics} harmonics"), |bencher| bencher.iter(&mut kernel));
    }
    group.finish();
}

criterion_group!(benches, residuals);
criterion_main!(benches);
