//! Motions from a given state: impacts, flights, and what they keep.

use std::f64::consts::{PI, TAU};

use nlmodes::fem::{MassMatrix, Material, Mesh, Rod, Support};
use nlmodes::linalg::{Triplet, sparse_from_triplets, triplets};
use nlmodes::model::{Contact, Drop, MasslessContactModel, Side, StructuralModel};
use nlmodes::timestep::{ContactDynamics, Floquet, Shooting, Trajectory};

use super::tools::{Bilinear, bisect, integral, slope, springs};
use super::{Case, Check, Kind};
use crate::Failure;

const ROUNDING: &str = "arcs are propagated exactly: rounding";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "sdnd101",
        problem: "Code_Aster's SDND101: a mass of 100 kg on 10⁴ N/m touches a stop of 10⁶ N/m at rest and is thrown \
            at it with 1 m/s.\nDuration of the contact, largest force, impulse.",
        kind: Kind::Exact,
        reference: "half an oscillation: `π/ω`, `Kv/ω`, `2Kv/ω²` with `ω² = (k + K)/m`; the validation manual has \
            0.03126002 s, 9950.372 N, 198.0198 N s",
        remark: "",
        compute: sdnd101,
    },
    Case {
        name: "sdnv100",
        problem: "After Code_Aster's SDNV100: a free bar of 0.2 m (`E = 200 GPa`, `ρ = 8000 kg/m³`, 1 cm²) flies into \
            a rigid wall with 100 m/s; 20 to 160 elements.\nImpulse, duration of the contact, mean force; how they \
            converge.",
        kind: Kind::Exact,
        reference: "one wave there and back: `2L/c`, constant force `ρcvA`, and the bar leaves as it came, with the \
            impulse `2ρALv`",
        remark: "elements disperse the wave: its front spreads like the third root of the path over the element",
        compute: sdnv100,
    },
    Case {
        name: "bouncing-bar",
        problem: "Doyen, Ern, Piperno 2011: a bar with `L = 10`, `E = 900`, `ρ = 1` falls from 5 above the floor, \
            gravity 10; 100 elements.\nInstants of the first two contacts, height of its centre after the first \
            bounce and after the period 16/3.",
        kind: Kind::Exact,
        reference: "waves of speed 30: falls 1, touches for 2/3, flies 2 (three periods of its vibration), touches \
            for 2/3, which undoes the vibration, and rises 1; the force `300 (1 + t)` of the contact lets its centre \
            sink by 20/27",
        remark: "gravity enters as soft springs to far above, `K + 10⁻⁶M` about the equilibrium 10⁷ below the floor: \
            it changes by 1e-6 of itself over the fall",
        compute: bouncing_bar,
    },
    Case {
        name: "impact-limit",
        problem: "A mass of 1 kg on 1 N/m starts at −2 m and hits stops of 10² to 10⁶ N/m at 1 m.\nTime until it is \
            back, and how it approaches that of a rigid impact.",
        kind: Kind::Exact,
        reference: "two harmonic arcs; `2(π − arccos ½)` for an impact that takes no time, approached like the root \
            of the compliance",
        remark: "",
        compute: impact_limit,
    },
    Case {
        name: "runge-kutta",
        problem: "Wall, 3 N/m, 1 kg, 2 N/m, 0.7 kg, 1 N/m, 0.4 kg, 4 N/m, a massless node, a rigid stop 0.1 m from \
            it; from (0.02, −0.05, 0.03) m with (0.1, 0.2, 0.35) m/s.\nTwenty seconds with some ten contacts. \
            Displacements and velocities at the end.",
        kind: Kind::Independent,
        reference: "the equations with the contact force `λ = k max(q₃ − g, 0)` of the massless node, by the \
            classical method of Runge and Kutta, 100 000 and 200 000 steps",
        remark: "",
        compute: runge_kutta,
    },
    Case {
        name: "energy-over-many-periods",
        problem: "The same three masses over 2000 s, some thousand contacts.\nEnergy at all contact instants beside \
            that at the start.",
        kind: Kind::Exact,
        reference: "nothing dissipates: constant",
        remark: "",
        compute: energy,
    },
    Case {
        name: "there-and-back",
        problem: "The same three masses over 20 s, then with their velocities reversed for another 20 s.\nDistance \
            from the start.",
        kind: Kind::Exact,
        reference: "the motion runs backwards: none",
        remark: "",
        compute: there_and_back,
    },
    Case {
        name: "shooting-bilinear",
        problem: "The rod of two elements (one mass of ⅓, 2 N/m, massless half as a stop of 2 N/m at 1 m) at six \
            times the energy of grazing, by shooting.\nFrequency, total energy, share of contact.",
        kind: Kind::Exact,
        reference: "two harmonic arcs",
        remark: "",
        compute: shooting,
    },
    Case {
        name: "multipliers-of-a-conservative-motion",
        problem: "The three masses in their first nonlinear mode at twice the energy of grazing, by \
            shooting.\nProduct of the four multipliers beside the double one; how well it comes back along itself.",
        kind: Kind::Exact,
        reference: "a Hamiltonian flow keeps volume: the product is 1",
        remark: "",
        compute: multipliers,
    },
];

pub(super) fn dynamics(model: &StructuralModel, tips: bool) -> Result<ContactDynamics, Failure> {
    let massless = if tips {
        MasslessContactModel::with_spring_tips(model, None)?
    } else {
        MasslessContactModel::new(model, &Drop)?
    };
    Ok(ContactDynamics::new(massless)?)
}

/// `∫ λ dt` over the trajectory, contact by contact, by Simpson's rule between instants.
pub(super) fn impulse(motion: &Trajectory) -> f64 {
    let of = |from: f64, to: f64| {
        integral(|t| motion.contact_state(0, t).force[0], from + 1e-12 * (to - from), to - 1e-12 * (to - from), 200)
    };
    motion.closed_intervals().iter().map(|i| of(i.from, i.to)).sum()
}

fn sdnd101() -> Result<Vec<Check>, Failure> {
    let stop = Contact::elastic(0, Side::Positive, 0.0, 1e6);
    let mut dynamics = dynamics(&springs(&[100.0], &[(0, 0, 1e4)], vec![stop])?, true)?;
    let state = dynamics.state(&[0.0], &[1.0])?;
    let motion = dynamics.propagate(&state, 0.05)?;
    let intervals = motion.closed_intervals();
    let contact = intervals.last().ok_or("no contact")?;
    let omega = ((1e4 + 1e6) / 100.0_f64).sqrt();
    let [duration, peak, impulse] = [contact.to - contact.from, motion.peak_force(0), impulse(&motion)];
    Ok(vec![
        Check::relative("duration, s", duration, PI / omega, 1e-10, ROUNDING),
        Check::relative("largest force, N", peak, 1e6 / omega, 1e-10, ROUNDING),
        Check::relative("impulse, N s", impulse, 2e6 / (omega * omega), 1e-8, "Simpson's rule with 200 intervals"),
        Check::relative("duration beside the manual's, s", duration, 0.03126002, 2e-7, "its digits"),
        Check::relative("largest force beside the manual's, N", peak, 9950.372, 1e-7, "its digits"),
        Check::relative("impulse beside the manual's, N s", impulse, 198.0198, 1e-6, "its digits"),
    ])
}

/// A free rod whose end at its length faces a stop at `gap`, with springs of `softness` times its mass to the ground.
fn bar([e, rho, length]: [f64; 3], elements: usize, gap: f64, softness: f64) -> Result<StructuralModel, Failure> {
    let rod = Rod {
        material: Material::new(e, rho)?,
        area: 1.0,
        mesh: Mesh::uniform(length, elements)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Free,
        end: Support::Free,
    };
    let model = rod.assemble(&[])?;
    let n = model.dofs().len();
    // The end before the stop will have no mass, and so no weight.
    let mass = || triplets(model.mass()).filter(|(i, j, _)| *i.max(j) + 1 < n);
    let soft: Vec<Triplet> = triplets(model.stiffness()).chain(mass().map(|(i, j, m)| (i, j, softness * m))).collect();
    let stop = Contact::rigid(n - 1, Side::Positive, gap);
    let stiffness = sparse_from_triplets(n, n, &soft)?;
    Ok(StructuralModel::new(model.mass().clone(), stiffness, model.dofs().to_vec(), vec![stop])?)
}

fn sdnv100() -> Result<Vec<Check>, Failure> {
    let (e, rho, length, area, v) = (200e9_f64, 8000.0_f64, 0.2_f64, 1e-4, 100.0);
    let c = (e / rho).sqrt();
    let crossing = 2.0 * length / c;
    // Springs to the ground so soft that the flight does not feel them: a period of 10⁴ contacts.
    let softness = (TAU / (1e4 * crossing)).powi(2);
    let hit = |elements: usize| -> Result<[f64; 2], Failure> {
        let model = bar([e * area, rho * area, length], elements, 0.01 * length, softness)?;
        let mut dynamics = dynamics(&model, false)?;
        let n = elements + 1;
        let state = dynamics.state(&vec![0.0; n], &vec![v; n])?;
        let motion = dynamics.propagate(&state, 0.01 * length / v + 1.6 * crossing)?;
        let intervals = motion.closed_intervals();
        let [first, last] = [intervals.first(), intervals.last()].map(|i| i.copied());
        let (first, last) = (first.ok_or("no contact")?, last.ok_or("no contact")?);
        Ok([impulse(&motion), last.to - first.from])
    };
    let numbers = [20, 40, 80, 160];
    let mut found = Vec::new();
    for elements in numbers {
        found.push(hit(elements)?);
    }
    let exact = 2.0 * rho * area * length * v;
    let errors: Vec<(f64, f64)> =
        numbers.iter().zip(&found).map(|(n, [impulse, _])| (*n as f64, impulse / exact - 1.0)).collect();
    let [last, duration] = found[3];
    let why = "the front of the wave, (h/L)^⅔ = 0.03 with 160 elements";
    Ok(vec![
        Check::relative(
            "impulse, N s",
            last,
            exact,
            0.03,
            "what stays in vibrations behind the front, (h/L)^⅔, and the mass of the end, ⅔ h/L",
        ),
        Check::relative("duration, s", duration, crossing, 0.04, why),
        Check::relative("mean force, N", last / duration, rho * c * v * area, 0.04, why),
        Check::order(
            "impulse, 20 to 160 elements",
            -slope(&errors),
            0.8,
            0.35,
            "the tail of the front falls with ⅔ to 1",
        ),
    ])
}

fn bouncing_bar() -> Result<Vec<Check>, Failure> {
    let (length, height, gravity, n): (f64, f64, f64, usize) = (10.0, 5.0, 10.0, 100);
    let softness = 1e-6;
    // Displacements count downward from the equilibrium g/κ below the start, where the soft springs carry the weight.
    let sag = gravity / softness;
    let model = bar([900.0, 1.0, length], n, height - sag, softness)?;
    let mut dynamics = dynamics(&model, false)?;
    let state = dynamics.state(&vec![-sag; n + 1], &vec![0.0; n + 1])?;
    let period = 16.0 / 3.0;
    let motion = dynamics.propagate(&state, period)?;
    let intervals = motion.closed_intervals();
    let (first, second): (Vec<_>, Vec<_>) = intervals.iter().partition(|i| i.from < 2.5);
    let ends = |group: &[&nlmodes::timestep::ClosedInterval]| -> Result<[f64; 2], Failure> {
        Ok([group.first().ok_or("no contact")?.from, group.last().ok_or("no contact")?.to])
    };
    let ([a, b], [c, d]) = (ends(&first)?, ends(&second)?);
    let centre = |t: f64| {
        let q = motion.at(t).displacement;
        let inner: f64 = q[1..n].iter().sum();
        // Weights of the nodes: half an element at the ends.
        height - ((inner + 0.5 * (q[0] + q[n])) / n as f64 + sag)
    };
    let why = "the front of the wave, (h/L)^⅔ = 0.046, of the contact's duration, ⅛ of the period";
    Ok(vec![
        Check::of_size("first touch", [a, 1.0, period], 1e-5, "the soft springs, 1e-6"),
        Check::of_size("first leaving", [b, 5.0 / 3.0, period], 1e-2, why),
        Check::of_size("second touch", [c, 11.0 / 3.0, period], 1e-2, why),
        Check::of_size("second leaving", [d, 13.0 / 3.0, period], 1e-2, why),
        Check::of_size(
            "height at 8/3",
            [centre(8.0 / 3.0), height - 20.0 / 27.0, height],
            4.6e-2,
            "what the front leaves in vibrations, (h/L)^⅔",
        ),
        Check::of_size("height at 16/3", [centre(period), height, height], 9.2e-2, "the same twice"),
    ])
}

fn impact_limit() -> Result<Vec<Check>, Failure> {
    let rigid = 2.0 * (PI - 0.5_f64.acos());
    let mut checks = Vec::new();
    let mut excess = Vec::new();
    for stiffness in [1e2, 1e3, 1e4, 1e5, 1e6] {
        let stop = Contact::elastic(0, Side::Positive, 1.0, stiffness);
        let mut dynamics = dynamics(&springs(&[1.0], &[(0, 0, 1.0)], vec![stop])?, true)?;
        let state = dynamics.state(&[-2.0], &[0.0])?;
        let motion = dynamics.propagate(&state, 6.0)?;
        let contact = *motion.closed_intervals().first().ok_or("no contact")?;
        // There and back are mirror images about the middle of the contact.
        let period = contact.from + contact.to;
        let top = bisect(|x| 0.5 * x * x + 0.5 * stiffness * (x - 1.0).powi(2) - 2.0, 1.0, 2.0);
        let closed = Bilinear { m: 1.0, k: 1.0, k_s: stiffness, gap: 1.0, top, two_sided: false };
        checks.push(Check::relative(
            format!("time with {stiffness:e} N/m, s"),
            period,
            closed.period(),
            1e-9,
            ROUNDING,
        ));
        excess.push((stiffness, period - rigid));
    }
    checks.push(Check::order("over the compliance", -slope(&excess[2..]), 0.5, 0.02, "the next term, of order one"));
    Ok(checks)
}

const MASSES: [f64; 3] = [1.0, 0.7, 0.4];
const LAST: f64 = 4.0;
const GAP: f64 = 0.1;

/// Wall, spring 3, mass, spring 2, mass, spring 1, mass, spring 4, massless node, stop.
fn three_masses() -> Result<ContactDynamics, Failure> {
    let stop = Contact::rigid(3, Side::Positive, GAP);
    let connections = [(0, 0, 3.0), (0, 1, 2.0), (1, 2, 1.0), (2, 3, LAST)];
    dynamics(&springs(&[MASSES[0], MASSES[1], MASSES[2], 0.0], &connections, vec![stop])?, false)
}

const START: [f64; 4] = [0.02, -0.05, 0.03, 0.0];
const SPEED: [f64; 4] = [0.1, 0.2, 0.35, 0.0];

fn accelerations(q: [f64; 3]) -> [f64; 3] {
    let pressed = LAST * (q[2] - GAP).max(0.0);
    let f = [-3.0 * q[0] + 2.0 * (q[1] - q[0]), 2.0 * (q[0] - q[1]) + q[2] - q[1], q[1] - q[2] - pressed];
    std::array::from_fn(|i| f[i] / MASSES[i])
}

fn by_runge_kutta(duration: f64, steps: usize) -> [[f64; 3]; 2] {
    let h = duration / steps as f64;
    let moved = |[q, v]: [[f64; 3]; 2], [a, b]: [[f64; 3]; 2], s: f64| -> [[f64; 3]; 2] {
        [std::array::from_fn(|i| q[i] + s * a[i]), std::array::from_fn(|i| v[i] + s * b[i])]
    };
    let rate = |[q, v]: [[f64; 3]; 2]| [v, accelerations(q)];
    let mut state = [[START[0], START[1], START[2]], [SPEED[0], SPEED[1], SPEED[2]]];
    for _ in 0..steps {
        let a = rate(state);
        let b = rate(moved(state, a, 0.5 * h));
        let c = rate(moved(state, b, 0.5 * h));
        let d = rate(moved(state, c, h));
        for (slope, weight) in [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)] {
            state = moved(state, slope, weight * h / 6.0);
        }
    }
    state
}

fn runge_kutta() -> Result<Vec<Check>, Failure> {
    let mut dynamics = three_masses()?;
    let state = dynamics.state(&START, &SPEED)?;
    let end = dynamics.propagate(&state, 20.0)?.end;
    let (q, v) = dynamics.displacement_and_velocity(&end)?;
    let [coarse, fine] = [100_000, 200_000].map(|steps| by_runge_kutta(20.0, steps));
    let why = "steps across the instants miss the kink of the force there: some 40 times 0.1 h², h = 2e-4";
    let of = |i: usize| {
        [
            Check::of_size(format!("q_{}, m", i + 1), [q[i], fine[0][i], 0.1], 1e-7, why),
            Check::of_size(format!("v_{}, m/s", i + 1), [v[i], fine[1][i], 0.3], 1e-7, why),
        ]
    };
    let mut checks: Vec<Check> = (0..3).flat_map(of).collect();
    let error = |of: &[[f64; 3]; 2]| (0..3).map(|i| (of[0][i] - q[i]).abs()).fold(0.0, f64::max);
    let smaller = usize::from(error(&fine) < error(&coarse));
    checks.push(Check::count("half the step is nearer (1: yes)", smaller, 1));
    Ok(checks)
}

fn energy() -> Result<Vec<Check>, Failure> {
    let mut dynamics = three_masses()?;
    let state = dynamics.state(&START, &SPEED)?;
    let start = 0.5 * (0..3).map(|i| MASSES[i] * SPEED[i].powi(2)).sum::<f64>()
        + 0.5 * (3.0 * START[0].powi(2) + 2.0 * (START[1] - START[0]).powi(2) + (START[2] - START[1]).powi(2));
    let motion = dynamics.propagate(&state, 2000.0)?;
    let worst = motion.energies().iter().map(|e| (e / start - 1.0).abs()).fold(0.0, f64::max);
    let contacts = motion.closed_intervals().len();
    Ok(vec![
        Check::of_size("largest relative difference", [worst, 0.0, 1.0], 1e-11, "rounding, contact by contact"),
        Check::count("more than 300 contacts (1: yes)", usize::from(contacts > 300), 1),
    ])
}

fn there_and_back() -> Result<Vec<Check>, Failure> {
    let mut dynamics = three_masses()?;
    let state = dynamics.state(&START, &SPEED)?;
    let mut turned = dynamics.propagate(&state, 20.0)?.end;
    turned.v.iter_mut().for_each(|v| *v = -*v);
    let back = dynamics.propagate(&turned, 20.0)?.end;
    let (q, v) = dynamics.displacement_and_velocity(&back)?;
    let off =
        |of: &[f64], from: &[f64; 4], sign: f64| (0..3).map(|i| (of[i] - sign * from[i]).abs()).fold(0.0, f64::max);
    let why = "rounding, as contacts enlarge it";
    Ok(vec![
        Check::of_size("displacements, m", [off(&q, &START, 1.0), 0.0, 0.05], 1e-9, why),
        Check::of_size("velocities, m/s", [off(&v, &SPEED, -1.0), 0.0, 0.35], 1e-9, why),
    ])
}

fn shooting() -> Result<Vec<Check>, Failure> {
    let stop = Contact::rigid(1, Side::Positive, 1.0);
    let model = springs(&[1.0 / 3.0, 0.0], &[(0, 0, 2.0), (0, 1, 2.0)], vec![stop])?;
    let closed = |top: f64| Bilinear { m: 1.0 / 3.0, k: 2.0, k_s: 2.0, gap: 1.0, top, two_sided: false };
    let exact = closed(bisect(|top| closed(top).kinetic() - 3.0, 1.1, 10.0));
    let (mut shooting, mut x, _) = Shooting::from_grazing(dynamics(&model, false)?, 1)?;
    (x[0], x[1]) = (2.0 * x[0], 1.1);
    let motion = shooting.motion_near(&x, 6.0_f64.ln())?;
    let closed_time: f64 = motion.trajectory.closed_intervals().iter().map(|i| i.to - i.from).sum();
    let rest = 0.5;
    let pressed = 2.0 * ((1.0 - rest) / (exact.top - rest)).acos() / 12.0_f64.sqrt();
    let why = "the tolerance of the corrector";
    Ok(vec![
        Check::relative("ω, rad/s", motion.omega, exact.omega(), 1e-9, why),
        Check::relative("total energy, J", motion.total_energy, exact.total(), 1e-9, why),
        Check::relative("share of contact", closed_time * motion.omega / TAU, pressed * exact.omega() / TAU, 1e-8, why),
    ])
}

fn multipliers() -> Result<Vec<Check>, Failure> {
    let (mut shooting, mut x, _) = Shooting::from_grazing(three_masses()?, 1)?;
    x.iter_mut().take(3).for_each(|x| *x *= 1.35);
    x[3] = 1.05;
    let motion = shooting.motion_near(&x, 2.0_f64.ln())?;
    let floquet = Floquet::new(shooting.dynamics(), &motion)?;
    let product: num_complex::Complex64 = floquet.multipliers.iter().product();
    Ok(vec![
        Check::count("multipliers beside the double one", floquet.multipliers.len(), 4),
        Check::relative("their product", product.re, 1.0, 1e-8, "rounding of the product of exponentials"),
        Check::of_size(
            "defect along itself",
            [floquet.trivial_defect, 0.0, 1.0],
            1e-7,
            "the tolerance of the corrector",
        ),
    ])
}
