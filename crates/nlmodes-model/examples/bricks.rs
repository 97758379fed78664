//! Time and memory of the reduction of a solid of 8-node bricks, clamped at one end, with contacts on its top.
//!
//! `cargo run --release -p nlmodes-model --example bricks -- 80 20 20 100 20` takes nodes along X, Y, Z, contacts
//! and modes, and prints CPU seconds. `minimum-degree` as a sixth word also factors in that order.
//!
//! With `-- table 2` it prints the first two rows of a table of sizes instead, each measured in a process of its own;
//! `-- deck 80 20 20` prints the same solid as a deck for CalculiX that requests 20 frequencies.

use std::time::Instant;

use nlmodes_linalg::{CholeskyPlan, Mat, SparseMatrix, Triplet, sparse_from_triplets};
use nlmodes_model::reduction::{ModeCount, OpenModes};
use nlmodes_model::{Contact, Dof, DofIndex, DofKind, StructuralModel};

type Failure = Box<dyn std::error::Error>;

/// Young's modulus, Pa, Poisson's ratio, density, kg/m³, and edge of an element, m.
const STEEL: (f64, f64, f64, f64) = (210e9, 0.3, 7800.0, 0.01);

fn main() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.first().map(String::as_str) {
        Some("table") => return table(words.get(1).and_then(|w| w.parse().ok()).unwrap_or(1)),
        Some("row") => return row(&words[1..]),
        Some("deck") => return deck(&words[1..]),
        _ => {}
    }
    let number = |i: usize, default: usize| words.get(i).and_then(|w| w.parse().ok()).unwrap_or(default);
    let size = [number(0, 20), number(1, 6), number(2, 6)];
    let (contacts, modes) = (number(3, 10), number(4, 10));
    let model = timed("assembly", || solid(size, contacts))?;
    println!("{} degrees of freedom, {} entries of K", model.dofs().len(), model.stiffness().compute_nnz());
    let plan = timed("dissection and symbolic", || CholeskyPlan::new(model.stiffness(), "stiffness"))?;
    report(&plan);
    if words.iter().any(|w| w == "minimum-degree") {
        let other = timed("minimum degree", || CholeskyPlan::by_minimum_degree(model.stiffness(), "stiffness"))?;
        report(&other);
        timed("factor, minimum degree", || other.factor(model.stiffness(), "stiffness"))?;
    }
    let factor = timed("factor, dissection", || plan.factor(model.stiffness(), "stiffness"))?;
    for columns in [1, 8, 32] {
        let mut x = Mat::from_fn(factor.dim(), columns, |i, j| ((7 * i + j) % 11) as f64 - 5.0);
        timed(&format!("{columns} right-hand sides"), || -> Result<(), Failure> {
            factor.solve_many(&mut x);
            Ok(())
        })?;
    }
    drop(factor);
    let open = timed("open modes", || OpenModes::of_model(&model, ModeCount::Lowest(modes)))?;
    let hertz: Vec<f64> = open.omega_squared().iter().map(|w| w.sqrt() / std::f64::consts::TAU).collect();
    println!("frequencies / Hz: {hertz:.2?}");
    println!("residual flexibility of the first contact: {:e} m/N", open.flexibility()[(0, 0)]);
    println!("peak memory: {}", peak_memory());
    Ok(())
}

/// Nodes along X, Y, Z, contacts and modes of each row.
const ROWS: [[usize; 5]; 4] =
    [[40, 12, 12, 100, 20], [80, 20, 20, 100, 20], [118, 30, 30, 500, 40], [176, 44, 44, 1000, 60]];

fn table(rows: usize) -> Result<(), Failure> {
    println!(
        "| degrees of freedom | contacts | modes | estimate: factor, GB | order, s | reduction, s CPU | by the clock, \
            s | peak memory, GB |"
    );
    println!("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    for size in ROWS.iter().take(rows) {
        let words = size.iter().map(usize::to_string);
        std::process::Command::new(std::env::current_exe()?).arg("row").args(words).status()?;
    }
    Ok(())
}

/// One row: all of the reduction, the order of elimination and the factorisation with it.
fn row(words: &[String]) -> Result<(), Failure> {
    let number = |i: usize| words.get(i).and_then(|w| w.parse().ok()).unwrap_or(10);
    let (contacts, modes) = (number(3), number(4));
    let model = solid([number(0), number(1), number(2)], contacts)?;
    let start = cpu_seconds();
    let bytes = CholeskyPlan::new(model.stiffness(), "stiffness")?.bytes();
    let order = cpu_seconds() - start;
    let clock = Instant::now();
    let open = OpenModes::of_model(&model, ModeCount::Lowest(modes))?;
    let (cpu, clock, n) = (cpu_seconds() - start - order, clock.elapsed().as_secs_f64(), open.n_dofs());
    let kilobytes: f64 = peak_memory().split_whitespace().next().and_then(|w| w.parse().ok()).unwrap_or(f64::NAN);
    let (factor, peak) = (bytes as f64 / 1e9, kilobytes / 1e6);
    println!("| {n} | {contacts} | {modes} | {factor:.2} | {order:.1} | {cpu:.1} | {clock:.1} | {peak:.2} |");
    Ok(())
}

/// The solid as a deck, clamped at X = 0.
fn deck(words: &[String]) -> Result<(), Failure> {
    let number = |i: usize| words.get(i).and_then(|w| w.parse::<usize>().ok()).unwrap_or(10);
    let [nx, ny, nz] = [number(0), number(1), number(2)];
    let node = |x: usize, y: usize, z: usize| (x * ny + y) * nz + z + 1;
    let each = |nx: usize, ny: usize, nz: usize| {
        (0..nx).flat_map(move |x| (0..ny).flat_map(move |y| (0..nz).map(move |z| (x, y, z))))
    };
    let mut text = String::from("*NODE, NSET=ALL\n");
    let mut line = |words: std::fmt::Arguments<'_>| text.push_str(&format!("{words}\n"));
    for (x, y, z) in each(nx, ny, nz) {
        let [a, b, c] = [x, y, z].map(|i| i as f64 * STEEL.3);
        line(format_args!("{}, {a:.6}, {b:.6}, {c:.6}", node(x, y, z)));
    }
    line(format_args!("*ELEMENT, TYPE=C3D8, ELSET=BODY"));
    for (i, (x, y, z)) in each(nx - 1, ny - 1, nz - 1).enumerate() {
        let corner = |a: usize, b: usize, c: usize| node(x + a, y + b, z + c);
        let low = [corner(0, 0, 0), corner(1, 0, 0), corner(1, 1, 0), corner(0, 1, 0)];
        let [p, q, r, s] = low;
        line(format_args!("{}, {p}, {q}, {r}, {s}, {}, {}, {}, {}", i + 1, p + 1, q + 1, r + 1, s + 1));
    }
    line(format_args!("*NSET, NSET=HELD, GENERATE\n1, {}, 1", ny * nz));
    let (e, nu, rho, _) = STEEL;
    line(format_args!("*MATERIAL, NAME=STEEL\n*ELASTIC\n{e:e}, {nu}\n*DENSITY\n{rho}"));
    line(format_args!("*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL\n*BOUNDARY\nHELD, 1, 3"));
    line(format_args!("*STEP\n*FREQUENCY\n20\n*END STEP"));
    print!("{text}");
    Ok(())
}

fn timed<T, E: Into<Failure>>(what: &str, work: impl FnOnce() -> Result<T, E>) -> Result<T, Failure> {
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let result = work().map_err(Into::into);
    println!("{what}: {:.2} s CPU, {:.2} s", cpu_seconds() - cpu, start.elapsed().as_secs_f64());
    result
}

fn report(plan: &CholeskyPlan) {
    println!("    factor: {:.2} GB, {:.1} Gflop", plan.bytes() as f64 / 1e9, plan.flops() / 1e9);
}

/// Of this process, from the kernel's statistics in ticks of 10 ms; zero elsewhere than on Linux.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |i: usize| fields.get(i).and_then(|f| f.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(11) + ticks(12)) / 100.0
}

fn peak_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status.lines().find_map(|l| l.strip_prefix("VmHWM:")).unwrap_or("unknown").trim().to_owned()
}

/// Nodes of the grid in X, Y, Z; the end X = 0 clamped; contacts spread over the top.
fn solid([nx, ny, nz]: [usize; 3], contacts: usize) -> Result<StructuralModel, Failure> {
    let node = |x: usize, y: usize, z: usize| (x * ny + y) * nz + z;
    let held = ny * nz;
    let n = 3 * (nx * ny * nz - held);
    let (k_e, m_e) = brick();
    let (mut k, mut m): (Vec<Triplet>, Vec<Triplet>) = (Vec::new(), Vec::new());
    for (x, y, z) in (0..nx - 1).flat_map(|x| (0..ny - 1).flat_map(move |y| (0..nz - 1).map(move |z| (x, y, z)))) {
        let corners: Vec<usize> = (0..8).map(|c| node(x + (c >> 2), y + ((c >> 1) & 1), z + (c & 1))).collect();
        for (a, b) in (0..24).flat_map(|a| (0..24).map(move |b| (a, b))) {
            let (i, j) = (3 * corners[a / 3] + a % 3, 3 * corners[b / 3] + b % 3);
            if i >= 3 * held && j >= 3 * held {
                let at = (i - 3 * held, j - 3 * held);
                k.push((at.0, at.1, k_e[a][b]));
                if a % 3 == b % 3 {
                    m.push((at.0, at.1, m_e[a / 3][b / 3]));
                }
            }
        }
    }
    let kinds = [DofKind::X, DofKind::Y, DofKind::Z];
    let place = |i: usize| {
        let node = i / 3 + held;
        [node / (ny * nz), node / nz % ny, node % nz].map(|index| index as f64 * STEEL.3)
    };
    let dofs: Vec<Dof> =
        (0..n).map(|i| Dof { node: i / 3 + held, position: place(i)[0], kind: kinds[i % 3] }).collect();
    let index = DofIndex::new(&dofs);
    let top = |c: usize| {
        let free = (nx - 1) * ny;
        let at = free - 1 - c * free / contacts.max(1) % free;
        node(1 + at / ny, at % ny, nz - 1)
    };
    let contacts: Result<Vec<_>, _> =
        (0..contacts).map(|c| Contact::point(&index, top(c), [0.0, 0.0, 1.0], 1e-3)).collect();
    let matrix = |entries: &[Triplet]| -> Result<SparseMatrix, Failure> { Ok(sparse_from_triplets(n, n, entries)?) };
    let (mass, stiffness) = (matrix(&m)?, matrix(&k)?);
    Ok(StructuralModel::new(mass, stiffness, dofs, contacts?)?.with_places((0..n).map(place).collect())?)
}

/// Stiffness (24 × 24) and mass of one direction (8 × 8) of a cube with linear displacements, by 2 × 2 × 2 Gauss
/// points; vertex `c` has its bits as X, Y, Z.
fn brick() -> (Vec<[f64; 24]>, [[f64; 8]; 8]) {
    let (e, nu, rho, h) = STEEL;
    let (lambda, mu) = (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)));
    let sign = |c: usize, axis: usize| if (c >> (2 - axis)) & 1 == 1 { 1.0 } else { -1.0 };
    let (mut k, mut m) = (vec![[0.0; 24]; 24], [[0.0; 8]; 8]);
    let volume = (h / 2.0).powi(3);
    for point in 0..8 {
        let x: [f64; 3] = std::array::from_fn(|axis| sign(point, axis) / 3f64.sqrt());
        let factor = |c: usize, axis: usize| 0.5 * (1.0 + sign(c, axis) * x[axis]);
        let shape = |c: usize| (0..3).map(|axis| factor(c, axis)).product::<f64>();
        let slope =
            |c: usize, of: usize| (0..3).map(|a| if a == of { sign(c, a) / h } else { factor(c, a) }).product::<f64>();
        for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))) {
            m[a][b] += rho * volume * shape(a) * shape(b);
            let both: f64 = (0..3).map(|i| slope(a, i) * slope(b, i)).sum();
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let shear = mu * (slope(a, j) * slope(b, i) + if i == j { both } else { 0.0 });
                k[3 * a + i][3 * b + j] += volume * (lambda * slope(a, i) * slope(b, j) + shear);
            }
        }
    }
    (k, m)
}
