//! Exact forced motions: known numbers, closed forms, an integration by small steps, and invariants.

use std::f64::consts::TAU;

use nlmodes_linalg::Mat;
use nlmodes_timestep::{Flash, ForcedMotion, ForcedStructure, TimestepError};
use num_complex::Complex64;

/// Units in which the rod of two elements is given: stiffness `EA/L`, mass, length.
const UNITS: [(f64, f64, f64); 2] = [(1.0, 1.0, 1.0), (4e6, 0.3, 2e-4)];

/// A rod of two elements with `EA = ρA = L = g₀ = 1`, the mass of its tip left out, 1 % of damping, a unit force at its
/// middle; in other units.
struct Rod {
    stiffness: f64,
    mass: f64,
    gap: f64,
}

impl Rod {
    fn shape(&self) -> f64 {
        (3.0 / self.mass).sqrt()
    }

    fn omega(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    fn structure(&self) -> ForcedStructure {
        let square = 6.0 * self.stiffness / self.mass;
        let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
        let damping = one(0.02 * square.sqrt());
        let compliance = one(0.5 / self.stiffness);
        let mut rod = ForcedStructure::new(&[square], &damping, &one(-self.shape()), &compliance, &[self.gap]).unwrap();
        rod.push_load(1, &[Complex64::from(self.shape())], &[Complex64::default()]).unwrap();
        rod
    }

    fn level(&self, force: f64) -> f64 {
        force * self.stiffness * self.gap
    }

    /// The motion near `size cos(Ωt − lag)` of the free contact.
    fn near(&self, force: f64, frequency: f64, size: f64, lag: f64) -> ForcedMotion {
        let omega = TAU * frequency * self.omega();
        let (sin, cos) = lag.to_radians().sin_cos();
        let eta = size * self.gap / self.shape();
        self.structure().periodic(self.level(force), omega, 1, &[eta * cos, eta * omega * sin]).unwrap()
    }

    fn fundamental(&self, motion: &ForcedMotion) -> Complex64 {
        motion.modal_harmonic(0, 1) * (self.shape() / self.gap)
    }
}

#[test]
fn the_rod_of_two_elements_has_the_three_responses_that_are_known() {
    // Fundamental, share of contact, lag and largest multiplier from independent event-driven integrations.
    let stable = Complex64::new(0.9198996, 0.2090172);
    let known = [
        (0.42, 2.42034024458, 0.3157984185, 31.677157, stable, 1e-10),
        (0.42, 1.52905305744, 0.2473334222, 160.714754, Complex64::from(1.2534129), 1e-10),
        // The frequency has ten digits.
        (0.4400260004, 4.39277069957, 0.3619577474, 90.0, Complex64::from(0.9529337), 1e-8),
    ];
    for (stiffness, mass, gap) in UNITS {
        let rod = Rod { stiffness, mass, gap };
        for (frequency, size, share, lag, multiplier, within) in known {
            let motion = rod.near(0.2, frequency, size, lag);
            let found = rod.fundamental(&motion);
            assert!((found.norm() - size).abs() < within * 2.0, "{} {size}", found.norm());
            assert!((motion.closed_share(0) - share).abs() < within.max(1e-10), "{}", motion.closed_share(0));
            assert!((-found.arg().to_degrees() - lag).abs() < 1e-6, "{}", -found.arg().to_degrees());
            let largest = motion.multipliers[0];
            let off = (Complex64::new(largest.re, largest.im.abs()) - multiplier).norm();
            // Only the magnitude of a pair that may have become real is given at the resonance.
            assert!(off < 1e-7 || (largest.norm() - multiplier.norm()).abs() < 1e-7, "{largest} {multiplier}");
            let product: Complex64 = motion.multipliers.iter().product();
            let trace = 0.02 * (6.0 * stiffness / mass).sqrt();
            assert!((product.re / (-trace * motion.period()).exp() - 1.0).abs() < 1e-12);
            // Power: the input by the force equals the dissipation by damping, summed over all harmonics.
            let input = 0.5 * rod.level(0.2) * motion.omega * (Complex64::i() * found).re * gap;
            let speeds = (1..60).map(|n| 0.5 * (n as f64 * motion.omega * motion.modal_harmonic(0, n).norm()).powi(2));
            assert!((input / (trace * speeds.sum::<f64>()) - 1.0).abs() < 1e-8);
        }
    }
}

/// By multiple shooting, from states that are off by a hundredth but for the first.
#[test]
fn a_motion_through_several_states_is_that_from_one() {
    let rod = Rod { stiffness: 1.0, mass: 1.0, gap: 1.0 };
    let structure = rod.structure();
    let motion = rod.near(0.2, 0.42, 1.52905305744, 160.714754);
    for parts in [2, 5, 16] {
        let mut states = vec![motion.state.clone()];
        let mut take = |Flash { state: x, .. }: Flash<'_>| {
            states.push(x.iter().map(|v| 1.01 * v).collect());
            states.len() < parts
        };
        structure.flash((rod.level(0.2), motion.omega), &motion.state, parts, &mut take).unwrap();
        let found = structure.periodic_through(rod.level(0.2), motion.omega, 1, &states).unwrap();
        let off = found.state.iter().zip(&motion.state).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(off < 1e-12 && (found.multipliers[0] - motion.multipliers[0]).norm() < 1e-9, "{parts}: {off:e}");
        assert!((found.closed_share(0) - motion.closed_share(0)).abs() < 1e-12);
    }
    assert!(structure.periodic_through(1.0, 1.0, 1, &[]).is_err());
}

#[test]
fn a_motion_without_contact_is_the_linear_one_over_one_period_and_over_two() {
    for (stiffness, mass, gap) in UNITS {
        let rod = Rod { stiffness, mass, gap };
        let omega = 1.3 * rod.omega();
        let square = 6.0 * stiffness / mass;
        let damped = Complex64::new(square - omega * omega, 0.02 * square.sqrt() * omega);
        let expected = rod.shape() * rod.level(0.5) / damped;
        for periods in [1, 2] {
            let motion = rod.structure().periodic(rod.level(0.5), omega, periods, &[0.1 * gap, 0.0]).unwrap();
            assert_eq!((motion.touches(0), motion.closed_share(0), motion.peak_force(0)), (0, 0.0, 0.0));
            let found = motion.modal_harmonic(0, periods);
            assert!((found - expected).norm() < 1e-12 * expected.norm(), "{found} {expected}");
            // The same place in the period shows the free gap.
            let t = 0.37 * motion.period();
            let gap_there = gap - rod.shape() * (expected * Complex64::cis(omega * t)).re;
            assert!((motion.contact_at(0, t)[0] - gap_there).abs() < 1e-12 * gap);
        }
    }
}

/// Two modes with two contacts, one of them with a dissipative stop, under two harmonics and base motion that moves a
/// stop.
fn two_contacts() -> ForcedStructure {
    let damping = Mat::from_fn(2, 2, |i, j| [[0.03, 0.01], [0.01, 0.09]][i][j]);
    let rows = Mat::from_fn(2, 2, |i, j| [[-1.2, 0.4], [0.7, 0.9]][i][j]);
    let compliance = Mat::from_fn(2, 2, |i, j| [[0.2, 0.03], [0.03, 0.1]][i][j]);
    let mut structure = ForcedStructure::new(&[1.0, 6.0], &damping, &rows, &compliance, &[0.8, 0.5]).unwrap();
    structure.push_load(1, &[Complex64::new(0.3, 0.1), Complex64::from(0.2)], &[Complex64::default(); 2]).unwrap();
    let moved = [Complex64::default(), Complex64::new(0.0, 0.05)];
    structure.push_load(2, &[Complex64::from(0.1), Complex64::new(0.0, -0.3)], &moved).unwrap();
    structure.push_damped_stop(0, 4.0, 0.6).unwrap();
    structure
}

/// The rates of that structure, written out; contact forces by trying all sets.
fn rates(t: f64, omega: f64, level: f64, x: &[f64; 5]) -> [f64; 5] {
    let (a, b) = ((omega * t).sin_cos(), (2.0 * omega * t).sin_cos());
    let force = [level * (0.3 * a.1 - 0.1 * a.0 + 0.1 * b.1), level * (0.2 * a.1 + 0.3 * b.0)];
    let y = [0.8 - 1.2 * x[0] + 0.4 * x[1] + x[4], 0.5 + 0.7 * x[0] + 0.9 * x[1] - level * 0.05 * b.0];
    let (p, q, r) = (0.2, 0.03, 0.1);
    let both = {
        let det = p * r - q * q;
        [(-r * y[0] + q * y[1]) / det, (q * y[0] - p * y[1]) / det]
    };
    let tried = [[0.0, 0.0], [-y[0] / p, 0.0], [0.0, -y[1] / r], both];
    let fits = |l: &&[f64; 2]| {
        let gap = [y[0] + p * l[0] + q * l[1], y[1] + q * l[0] + r * l[1]];
        (0..2).all(|i| l[i] >= -1e-13 && gap[i] >= -1e-13)
    };
    let lambda = tried.iter().find(fits).copied().unwrap();
    let z0 = -x[0] - 0.03 * x[2] - 0.01 * x[3] - 1.2 * lambda[0] + 0.7 * lambda[1] + force[0];
    let z1 = -6.0 * x[1] - 0.01 * x[2] - 0.09 * x[3] + 0.4 * lambda[0] + 0.9 * lambda[1] + force[1];
    [x[2], x[3], z0, z1, (lambda[0] - 4.0 * x[4]) / 0.6]
}

/// The classical Runge-Kutta method.
fn by_small_steps(omega: f64, level: f64, start: [f64; 5], steps: usize) -> [f64; 5] {
    let h = TAU / omega / steps as f64;
    let along = |x: &[f64; 5], k: &[f64; 5], h: f64| [0, 1, 2, 3, 4].map(|i| x[i] + h * k[i]);
    (0..steps).fold(start, |x, j| {
        let t = h * j as f64;
        let a = rates(t, omega, level, &x);
        let b = rates(t + 0.5 * h, omega, level, &along(&x, &a, 0.5 * h));
        let c = rates(t + 0.5 * h, omega, level, &along(&x, &b, 0.5 * h));
        let d = rates(t + h, omega, level, &along(&x, &c, h));
        [0, 1, 2, 3, 4].map(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
    })
}

#[test]
fn several_contacts_with_a_stop_that_dissipates_are_those_of_small_steps() {
    let structure = two_contacts();
    for (omega, level) in [(0.9, 3.0), (1.4, 2.0), (0.5, 8.0)] {
        let start = [0.3, -0.2, 0.4, 0.1, 0.05];
        let exact = structure.after(level, omega, 1, &start).unwrap();
        let rough = by_small_steps(omega, level, start, 40_000);
        let off = exact.iter().zip(rough).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert!(off < 1e-7 * size.max(1.0), "{omega} {level}: {off:e} {size}");
    }
}

/// The periodic motion after transients have decayed.
fn settled(structure: &ForcedStructure, level: f64, omega: f64) -> ForcedMotion {
    let near = structure.after(level, omega, 80, &[0.0; 5]).unwrap();
    structure.periodic(level, omega, 1, &near).unwrap()
}

#[test]
fn a_periodic_motion_comes_back_and_its_multipliers_are_those_of_differences() {
    let structure = two_contacts();
    for (omega, level) in [(0.9, 3.0), (1.4, 2.0)] {
        let motion = settled(&structure, level, omega);
        assert!(motion.residual < 1e-13 && motion.touches(0) > 0, "{} {}", motion.residual, motion.touches(0));
        let back = by_small_steps(omega, level, std::array::from_fn(|i| motion.state[i]), 40_000);
        let off = motion.state.iter().zip(back).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-8, "{off:e}");
        let step = 1e-6;
        let column = |j: usize| {
            let [up, down] = [step, -step].map(|h| {
                let moved: Vec<f64> = (0..5).map(|i| motion.state[i] + if i == j { h } else { 0.0 }).collect();
                structure.after(level, omega, 1, &moved).unwrap()
            });
            (0..5).map(|i| (up[i] - down[i]) / (2.0 * step)).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..5).map(column).collect();
        let trace: f64 = (0..5).map(|i| columns[i][i]).sum();
        let expected: Complex64 = motion.multipliers.iter().sum();
        assert!((trace - expected.re).abs() < 1e-6, "{trace} {expected}");
    }
}

/// Largest force and smallest gap are those of many instants, in units in which forces are small too.
#[test]
fn the_largest_force_and_the_smallest_gap_of_a_period_are_those_of_many_instants() {
    const INSTANTS: usize = 20_000;
    let mut over_units = Vec::new();
    for (stiffness, mass, gap) in UNITS.into_iter().chain([(2e-3, 50.0, 1e-2)]) {
        let rod = Rod { stiffness, mass, gap };
        let motion = rod.near(0.2, 0.42, 2.42034024458, 31.677157);
        let force = |j: usize| motion.contact_at(0, motion.period() * j as f64 / INSTANTS as f64)[1];
        let most = (0..INSTANTS).map(force).fold(0.0, f64::max);
        // The force is smooth where it is largest: the error of sampling is the square of the interval, some 1e-7.
        assert!((motion.peak_force(0) / most - 1.0).abs() < 1e-6, "{} {most}", motion.peak_force(0));
        assert!(motion.smallest_gap(0).abs() < 1e-12 * gap, "it is touched");
        over_units.push(most / (stiffness * gap));
    }
    assert!(over_units.iter().all(|force| (force / over_units[0] - 1.0).abs() < 1e-6), "{over_units:?}");
    let structure = two_contacts();
    for (omega, level) in [(0.9, 3.0), (0.9, 0.6), (0.5, 0.3)] {
        let motion = settled(&structure, level, omega);
        let at = |j: usize| {
            let [[y0, λ0], [y1, λ1]] =
                [0, 1].map(|i| motion.contact_at(i, motion.period() * j as f64 / INSTANTS as f64));
            [y0 + 0.2 * λ0 + 0.03 * λ1, y1 + 0.03 * λ0 + 0.1 * λ1]
        };
        let least = (0..INSTANTS).map(at).fold([f64::INFINITY; 2], |m, gap| [m[0].min(gap[0]), m[1].min(gap[1])]);
        for (i, least) in least.into_iter().enumerate() {
            assert!((motion.smallest_gap(i) - least).abs() < 1e-6, "{level} {i}: {} {least}", motion.smallest_gap(i));
            assert_eq!(motion.touches(i) == 0, least > 1e-6, "{level} {i}");
            let presses = |j: usize| motion.contact_at(i, motion.period() * j as f64 / INSTANTS as f64)[1] > 0.0;
            let begins = (0..INSTANTS).filter(|&j| presses(j) && !presses((j + INSTANTS - 1) % INSTANTS)).count();
            assert_eq!(motion.touches(i), begins, "{level} {i}");
        }
    }
}

#[test]
fn power_that_goes_in_is_lost_in_the_structure_and_in_the_stop() {
    let (structure, omega, level) = (two_contacts(), 0.9, 3.0);
    let motion = settled(&structure, level, omega);
    let c = [[0.03, 0.01], [0.01, 0.09]];
    let [mut input, mut lost] = [0.0; 2];
    for n in 1..200 {
        let nu = n as f64 * omega;
        let eta = [0, 1].map(|k| motion.modal_harmonic(k, n));
        let p = match n {
            1 => [Complex64::new(0.3, 0.1), Complex64::from(0.2)],
            2 => [Complex64::from(0.1), Complex64::new(0.0, -0.3)],
            _ => [Complex64::default(); 2],
        };
        let speed = |k: usize| Complex64::new(0.0, nu) * eta[k];
        input += (0..2).map(|k| 0.5 * level * (p[k] * speed(k).conj()).re).sum::<f64>();
        // The moving stop does work too: as it recedes, the contact force does work on it.
        if n == 2 {
            let moved = Complex64::new(0.0, 0.05 * level) * Complex64::new(0.0, nu);
            input -= 0.5 * (motion.force_harmonic(1, n) * moved.conj()).re;
        }
        lost +=
            (0..2).map(|i| (0..2).map(|j| 0.5 * c[i][j] * (speed(i).conj() * speed(j)).re).sum::<f64>()).sum::<f64>();
        let pushed = motion.force_harmonic(0, n) / Complex64::new(4.0, 0.6 * nu);
        lost += 0.5 * 0.6 * (nu * pushed.norm()).powi(2);
    }
    assert!(lost > 0.0 && (input / lost - 1.0).abs() < 1e-5, "{input} {lost}");
}

#[test]
fn what_is_no_problem_is_refused() {
    let mut structure = two_contacts();
    assert!(matches!(structure.push_damped_stop(5, 1.0, 1.0), Err(TimestepError::Dimension { .. })));
    for (stiffness, damper) in [(1.0, 0.0), (0.0, 1.0), (1e-3, -1e-9), (-1e-9, 1e-3), (f64::NAN, 1.0)] {
        let refused = structure.push_damped_stop(1, stiffness, damper);
        assert!(matches!(refused, Err(TimestepError::NotPositive { .. })), "{stiffness} {damper}");
    }
    two_contacts().push_damped_stop(1, 1e-3, 1e-6).unwrap();
    assert!(matches!(structure.periodic(1.0, 1.0, 1, &[0.0]), Err(TimestepError::Dimension { .. })));
    assert!(matches!(structure.periodic(1.0, -1.0, 1, &[0.0; 5]), Err(TimestepError::NotPositive { .. })));
    assert!(matches!(structure.periodic(1.0, 1.0, 1, &[f64::NAN; 5]), Err(TimestepError::NotFinite { .. })));
}
