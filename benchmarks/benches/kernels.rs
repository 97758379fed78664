//! Time of each kernel of `nlmodes_benchmarks::kernels`; their instructions are counted by the example `instructions`.

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use nlmodes_benchmarks::kernels::KERNELS;
use nlmodes_benchmarks::thread_time;

/// Processor time of the thread, so that other programs on the machine count less.
fn kernels(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("kernel");
    group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
    for (name, prepare) in KERNELS {
        let mut kernel = prepare().expect("the structures of the benches are sound");
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|iterations| {
                let before = thread_time();
                (0..iterations).for_each(|_| kernel());
                thread_time().saturating_sub(before)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, kernels);
criterion_main!(benches);
