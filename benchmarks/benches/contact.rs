//! Contact problems: time per sample of a smooth series, by backend, cold and warm, next to the limit.
//!
//! The limit is what no solver can avoid once it knows the closed contacts: one back-solve with the factor of their
//! block and `g = A λ + b`, over the same samples.
//!
//! - `limit`: in the order of the samples, with a factor kept for every closed set. From some hundred contacts on these
//!   factors do not fit into the cache beside the processor, so the limit includes fetching them.
//! - `limit in cache`: closed set by closed set, timed after the factor was used once. No solver that meets the samples
//!   in their order can do that; it bounds what fetching contributes to the limit.
//! - `cold`: a new work space, every sample without a guess.
//! - `warm`: the guess is the sample before, as for the first iterate of an outer iteration.
//! - `again`: the guess is the same sample of a series with an amplitude 0.1 % off, as for all later iterates.

use std::{
    collections::HashMap,
    hint::black_box,
    time::{Duration, Instant},
};

use criterion::{
    BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use nlmodes_benchmarks::kernels::{SAMPLES, compliance as matrix, string_motion as motion};
use nlmodes_contact::{ClosedBlock, LcpSolver, Series, SeriesSolution, Start, solver_by_name};

/// A cold sample is as expensive among many as among few.
const COLD_SAMPLES: usize = 32;

fn solve(series: &mut Series, b: &[f64], start: Start, solution: &mut SeriesSolution) {
    series.solve(b, start, solution).expect("compliance is positive definite");
}

fn limit(group: &mut BenchmarkGroup<'_, WallTime>, c: usize) {
    let (a, b) = (matrix(c), motion(c, 1.0));
    let mut solution = SeriesSolution::default();
    let solver = solver_by_name("active-set").expect("the default exists");
    solve(&mut Series::new(&a, solver.as_ref()).expect("valid matrix"), &b, Start::PreviousSample, &mut solution);
    let (mut blocks, mut index) = (Vec::<ClosedBlock>::new(), HashMap::new());
    let block_of: Vec<usize> = (0..SAMPLES)
        .map(|sample| {
            *index.entry(solution.closed(sample).to_vec()).or_insert_with_key(|closed| {
                blocks.push(a.closed_block(closed).expect("c flags"));
                blocks.len() - 1
            })
        })
        .collect();
    let (mut lambda, mut gaps) = (vec![0.0; c], vec![0.0; c]);
    let mut solve = |sample: usize, block: &ClosedBlock| {
        let b = &b[sample * c..(sample + 1) * c];
        block.forces(b, &mut lambda).expect("c entries");
        a.gaps(b, &lambda, &mut gaps).expect("c entries");
        black_box(&gaps);
    };
    group.bench_function("limit", |bencher| {
        bencher.iter(|| block_of.iter().enumerate().for_each(|(sample, &block)| solve(sample, &blocks[block])));
    });
    let mut samples_of = vec![Vec::new(); blocks.len()];
    block_of.iter().enumerate().for_each(|(sample, &block)| samples_of[block].push(sample));
    group.bench_function("limit in cache", |bencher| {
        bencher.iter_custom(|iterations| {
            let mut time = Duration::ZERO;
            for (samples, block) in (0..iterations).flat_map(|_| samples_of.iter().zip(&blocks)) {
                solve(samples[0], block);
                let start = Instant::now();
                samples.iter().for_each(|&sample| solve(sample, block));
                time += start.elapsed();
            }
            time
        });
    });
}

fn cold(group: &mut BenchmarkGroup<'_, WallTime>, c: usize, solver: &dyn LcpSolver) {
    let a = matrix(c);
    let b: Vec<f64> =
        motion(c, 1.0).chunks_exact(c).step_by(SAMPLES / COLD_SAMPLES).flat_map(|sample| sample.to_vec()).collect();
    let mut solution = SeriesSolution::default();
    group.throughput(Throughput::Elements(COLD_SAMPLES as u64));
    group.bench_function(format!("{} cold", solver.name()), |bencher| {
        let set_up = || Series::new(&a, solver).expect("valid matrix");
        let run = |series: &mut Series| solve(series, &b, Start::Cold, &mut solution);
        bencher.iter_batched_ref(set_up, run, BatchSize::PerIteration);
    });
    group.throughput(Throughput::Elements(SAMPLES as u64));
}

fn warm(group: &mut BenchmarkGroup<'_, WallTime>, c: usize, solver: &dyn LcpSolver) {
    let a = matrix(c);
    let motions: Vec<Vec<f64>> = [1.0, 1.001, 1.002, 1.001].map(|amplitude| motion(c, amplitude)).into();
    let mut solution = SeriesSolution::default();
    for (name, start) in [("warm", Start::PreviousSample), ("again", Start::SameSample)] {
        let mut series = Series::new(&a, solver).expect("valid matrix");
        let mut turn = motions.iter().cycle();
        group.bench_function(format!("{} {name}", solver.name()), |bencher| {
            bencher.iter(|| turn.next().into_iter().for_each(|b| solve(&mut series, b, start, &mut solution)));
        });
    }
}

/// The largest number of contacts that each backend can afford here: cold, and warm.
const AFFORDABLE: [(&str, usize, usize); 5] = [
    ("active-set", 1000, 1000),
    ("proximal", 1000, 1000),
    ("clarabel", 100, 0),
    ("lemke", 100, 0),
    ("closed-form", 1, 1),
];

fn contact(criterion: &mut Criterion) {
    for c in [1, 10, 50, 100, 400, 1000] {
        let mut group = criterion.benchmark_group(format!("contact/{c}"));
        group.throughput(Throughput::Elements(SAMPLES as u64)).sample_size(10);
        group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
        limit(&mut group, c);
        for (name, largest_cold, largest_warm) in AFFORDABLE {
            let solver = solver_by_name(name).expect("listed name");
            if c <= largest_cold {
                cold(&mut group, c, solver.as_ref());
            }
            if c <= largest_warm {
                warm(&mut group, c, solver.as_ref());
            }
        }
        group.finish();
    }
}

criterion_group!(benches, contact);
criterion_main!(benches);
