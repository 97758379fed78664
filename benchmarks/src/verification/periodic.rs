//! Free periodic motions whose frequency is known exactly.

use nlmodes::modal::Event;
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, compute_branch};
use nlmodes::fem::MassMatrix;
use nlmodes::hbm::{CondensedStructure, Symmetry};
use nlmodes::model::{Contact, MasslessContactModel, Side};

use super::tools::{Bilinear, TwoMasses, at_energy, bisect, condensed, follow, mode, slope, springs, with_tips};
use super::{Case, Check, Kind};
use crate::{Failure, kernels::loop_of_the_rod, rod};

const FIFTH: &str = "harmonics beyond H are left out: error ~ H⁻⁵, 1e-4 at 5";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "sdnd122",
        problem: "Code_Aster's SDND122: a mass of 1 kg on 10 N/m, a stop of 50 N/m at 0.01 m, at three total \
            energies;\nconventional harmonic balance, 60 harmonics. Frequency at the mean kinetic energy of the exact \
            motion, and its total energy.",
        kind: Kind::Exact,
        reference: "two harmonic arcs: `f = 1/(t₁ + t₂)`, `t₁ = 2(π − arccos(g/A))/√(k/m)`, `t₂ = 2 arccos((g − \
            d)/A₁)/√((k + k_c)/m)`",
        remark: "the validation manual of Code_Aster has 0.646694 Hz beside an \"analytical\" 0.646217 Hz; the exact \
            value at the first energy is 0.6466310 Hz, which the former misses by 1e-4 and the latter by 6e-4: it is \
            no closed form of this oscillator",
        compute: sdnd122,
    },
    Case {
        name: "sdnd123-one-sided",
        problem: "After Code_Aster's SDND123: two masses of 1 kg, three springs of 1 N/m between walls, a stop of 30 \
            N/m 1 m from the first mass, which goes 1.1 m far;\n60 harmonics. Frequency of the first mode, \
            displacement of the second mass at that instant.",
        kind: Kind::Independent,
        reference: "arcs in the modes with and without the stop's spring, joined by Newton's method: three equations \
            for two durations and one displacement",
        remark: "the reference point of the validation manual lies at an amplitude of 0.81, where nothing touches: it \
            tests the linear mode",
        compute: || sdnd123(false),
    },
    Case {
        name: "sdnd123-two-sided",
        problem: "The same with a second stop on the other side.\nFrequency of the first mode.",
        kind: Kind::Independent,
        reference: "as before, over a quarter of the period",
        remark: "",
        compute: || sdnd123(true),
    },
    Case {
        name: "bilinear-one-sided",
        problem: "A mass of ⅓ kg on 2 N/m with a stop of 6 N/m at 1 m, into which it penetrates by 0.6 m; harmonic \
            balance.\nFrequency and total energy with 80 harmonics; order over 6 to 48 harmonics.",
        kind: Kind::Exact,
        reference: "two harmonic arcs; the third derivative jumps, so that `x_n ~ n⁻⁴` and the frequency, which is \
            stationary, errs with `H⁻⁵`",
        remark: "",
        compute: one_sided,
    },
    Case {
        name: "bilinear-two-sided",
        problem: "The same mass between two such stops.\nFrequency and total energy with 81 harmonics.",
        kind: Kind::Exact,
        reference: "four harmonic arcs a period",
        remark: "",
        compute: two_sided,
    },
    Case {
        name: "bilinear-massless-node",
        problem: "The same mass with a spring of 2 N/m and a massless node with a rigid stop at 1 m, which the mass \
            passes by 0.7 m; mixed shooting, 60 harmonics.\nFrequency, total energy, and largest contact force.",
        kind: Kind::Exact,
        reference: "the mass sees a stop of 2 N/m; the force is that spring's, 1.4 N",
        remark: "",
        compute: || massless_node(f64::INFINITY),
    },
    Case {
        name: "bilinear-springs-in-series",
        problem: "The same with the stop on a spring of 3 N/m.\nFrequency, total energy, and largest contact force.",
        kind: Kind::Exact,
        reference: "the mass sees both springs in series, 1.2 N/m; the force is 0.84 N",
        remark: "",
        compute: || massless_node(3.0),
    },
    Case {
        name: "bilinear-closed-at-rest",
        problem: "Shaw and Holmes 1983: a mass of 1 kg on 1 N/m that touches a stop of 3 N/m at rest; 41 \
            harmonics.\nFrequency at the first and the last point of the branch, which does not depend on the energy.",
        kind: Kind::Exact,
        reference: "`ω = 2ω₁ω₂/(ω₁ + ω₂)` with `ω₁ = 1`, `ω₂ = 2`",
        remark: "",
        compute: closed_at_rest,
    },
    Case {
        name: "small-penetration",
        problem: "A mass of 1 kg on 1 N/m with a stop of 100 N/m at 1 mm, into which it penetrates by 1 to 16 nm; 20 \
            harmonics.\nHow the frequency rises over the energy at which it just touches.",
        kind: Kind::Exact,
        reference: "two harmonic arcs; the contact lasts like the root of the penetration, so that the frequency \
            rises with its power 3/2",
        remark: "",
        compute: small_penetration,
    },
    Case {
        name: "rod-internal-resonance",
        problem: "The rod of Section 3 of the paper, 100 elements, 3 harmonics: the loop of Fig. 3 b ends on the \
            second linear mode where that just touches,\nthe 3:1 internal resonance. Frequency and energy (over that \
            of grazing) of this branch point.",
        kind: Kind::Exact,
        reference: "a third of the second linear frequency, and the ratio of the energies at which both modes just \
            touch, from `q_j = sin κj`",
        remark: "",
        compute: internal_resonance,
    },
    Case {
        name: "rod-of-two-elements",
        problem: "The rod of two elements (`EA = ρA = L = g₀ = 1`, tip massless) has one mass: mixed shooting with \
            all its harmonics gives a bilinear oscillator.\nFrequency where the mass goes 1.2, 2 and 5 m far toward \
            the stop, with 80 harmonics, without evenness assumed.",
        kind: Kind::Exact,
        reference: "`m = ⅓`, `k = 2`, and the massless half of the rod as a stop of 2 at 1",
        remark: "",
        compute: two_element_rod,
    },
    Case {
        name: "chain-of-two-with-impacts",
        problem: "Nonsmooth modes after Thorin, Delezoide and Legrand 2017: two masses of 1 kg on springs of 1 N/m \
            behind a wall, the last hits a rigid stop at 1 m once a period, without loss.\nStops of 10⁴ to 2.56·10⁶ \
            N/m by shooting, at the averaged kinetic energies of the exact motions with these shares of the first \
            linear period T₁:\nfrequency and impulse, extrapolated to the rigid stop; order of the approach.",
        kind: Kind::Exact,
        reference: "free between the impacts, `q_k = a_k cos ω_k(t − T/2)`, `a_k = −p φ_k / (2 ω_k sin(ω_k T/2))`, \
            and `p` from the distance of the stop",
        remark: "",
        compute: || super::chains::chain(2, &[0.95, 0.85]),
    },
    Case {
        name: "chain-of-five-with-impacts",
        problem: "The same with five masses.",
        kind: Kind::Exact,
        reference: "as before",
        remark: "",
        compute: || super::chains::chain(5, &[0.97, 0.93]),
    },
];

fn sdnd122() -> Result<Vec<Check>, Failure> {
    let (k, k_c, g): (f64, f64, f64) = (10.0, 50.0, 0.01);
    let stop = Contact::elastic(0, Side::Positive, g, k_c);
    let structure = with_tips(&springs(&[1.0], &[(0, 0, k)], vec![stop])?)?;
    let mut checks = Vec::new();
    for energy in [0.00650108331626, 0.00658129654238, 0.00647656819016] {
        let (a, d) = ((2.0 * energy / k).sqrt(), k_c * g / (k + k_c));
        let a1 = ((2.0 * energy - k * k_c * g * g / (k + k_c)) / (k + k_c)).sqrt();
        let t1 = 2.0 * (PI - (g / a).acos()) / k.sqrt();
        let t2 = 2.0 * ((g - d) / a1).acos() / (k + k_c).sqrt();
        let exact = 1.0 / (t1 + t2);
        let closed = Bilinear { m: 1.0, k, k_s: k_c, gap: g, top: d + a1, two_sided: false };
        let point = at_energy(&structure, 1, 60, closed.kinetic())?;
        let why = "the harmonics beyond 60: ~ 60⁻⁵";
        checks.push(Check::relative(format!("f at {energy:.8} J, Hz"), point.omega / TAU, exact, 1e-9, why));
        checks.push(Check::relative(
            format!("total energy at {energy:.8} J, J"),
            point.total_energy,
            energy,
            1e-8,
            why,
        ));
    }
    Ok(checks)
}

fn sdnd123(two_sided: bool) -> Result<Vec<Check>, Failure> {
    let mut stops = vec![Contact::elastic(0, Side::Positive, 1.0, 30.0)];
    if two_sided {
        stops.push(Contact::elastic(0, Side::Negative, 1.0, 30.0));
    }
    let structure = with_tips(&springs(&[1.0; 2], &[(0, 0, 1.0), (0, 1, 1.0), (1, 1, 1.0)], stops)?)?;
    let exact = TwoMasses::of_amplitude(1.1, two_sided)?;
    let point = at_energy(&structure, 1, 60, exact.kinetic)?;
    let why = "the harmonics beyond 60, with the contact of a tenth of the period: ~ 60⁻⁵";
    let second = point.coefficients.value(1, 0.0);
    Ok(vec![
        Check::relative("ω, rad/s", point.omega, exact.omega, 1e-7, why),
        Check::relative(
            "x₁ at the instant of rest, m",
            point.coefficients.value(0, 0.0),
            1.1,
            1e-5,
            "harmonics: ~ 60⁻³",
        ),
        Check::relative("x₂ at the instant of rest, m", second, exact.second, 1e-5, "harmonics: ~ 60⁻³"),
    ])
}

fn oscillator(k_s: f64, top: f64, two_sided: bool) -> Bilinear {
    Bilinear { m: 1.0 / 3.0, k: 2.0, k_s, gap: 1.0, top, two_sided }
}

fn errors(structure: &CondensedStructure, closed: &Bilinear, harmonics: usize) -> Result<[f64; 2], Failure> {
    let point = at_energy(structure, 1, harmonics, closed.kinetic())?;
    Ok([point.omega, point.total_energy])
}

fn one_sided() -> Result<Vec<Check>, Failure> {
    let stop = Contact::elastic(0, Side::Positive, 1.0, 6.0);
    let structure = with_tips(&springs(&[1.0 / 3.0], &[(0, 0, 2.0)], vec![stop])?)?;
    let closed = oscillator(6.0, 1.6, false);
    let [omega, energy] = errors(&structure, &closed, 80)?;
    let mut octaves = Vec::new();
    for from in [6, 12, 24] {
        // Single errors depend on where the corners fall: the largest of an octave.
        let mut largest = 0.0_f64;
        for harmonics in (0..4).map(|i| from + from * i / 4) {
            largest = largest.max((errors(&structure, &closed, harmonics)?[0] / closed.omega() - 1.0).abs());
        }
        octaves.push((from as f64, largest));
    }
    Ok(vec![
        Check::relative("ω, rad/s", omega, closed.omega(), 1e-9, FIFTH),
        Check::relative("total energy, J", energy, closed.total(), 1e-9, FIFTH),
        Check::order("6 to 48 harmonics", -slope(&octaves), 5.0, 0.7, "errors of single numbers of harmonics scatter"),
    ])
}

fn two_sided() -> Result<Vec<Check>, Failure> {
    let stops = [Side::Positive, Side::Negative].map(|side| Contact::elastic(0, side, 1.0, 6.0));
    let structure = with_tips(&springs(&[1.0 / 3.0], &[(0, 0, 2.0)], stops.to_vec())?)?;
    let closed = oscillator(6.0, 1.6, true);
    let [omega, energy] = errors(&structure, &closed, 81)?;
    Ok(vec![
        Check::relative("ω, rad/s", omega, closed.omega(), 1e-8, FIFTH),
        Check::relative("total energy, J", energy, closed.total(), 1e-8, FIFTH),
    ])
}

fn massless_node(k_c: f64) -> Result<Vec<Check>, Failure> {
    let stop = if k_c.is_finite() {
        Contact::elastic(1, Side::Positive, 1.0, k_c)
    } else {
        Contact::rigid(1, Side::Positive, 1.0)
    };
    let structure = condensed(&springs(&[1.0 / 3.0, 0.0], &[(0, 0, 2.0), (0, 1, 2.0)], vec![stop])?)?;
    let closed = oscillator(1.0 / (0.5 + 1.0 / k_c), 1.7, false);
    let point = at_energy(&structure, 1, 60, closed.kinetic())?;
    Ok(vec![
        Check::relative("ω, rad/s", point.omega, closed.omega(), 1e-9, FIFTH),
        Check::relative("total energy, J", point.total_energy, closed.total(), 1e-9, FIFTH),
        Check::relative(
            "largest contact force, N",
            point.peak_contact_force,
            closed.k_s * 0.7,
            1e-5,
            "harmonics of the displacement: ~ 60⁻³",
        ),
    ])
}

fn closed_at_rest() -> Result<Vec<Check>, Failure> {
    let stop = Contact::elastic(0, Side::Positive, 0.0, 3.0);
    let model = MasslessContactModel::with_spring_tips(&springs(&[1.0], &[(0, 0, 1.0)], vec![stop])?, None)?;
    let settings = BranchSettings { harmonics: 41, max_energy_ratio: Some(10.0), ..BranchSettings::default() };
    let branch = compute_branch(model, &settings, |_| ControlFlow::Continue(()))?.branch;
    let [first, last] = [branch.points.first(), branch.points.last()].map(|p| p.map_or(f64::NAN, |p| p.omega));
    let why = "the harmonics beyond 41: ~ 41⁻⁵ = 9e-9, of a contact of a third of the period";
    Ok(vec![
        Check::relative("ω at the first point, rad/s", first, 4.0 / 3.0, 1e-7, why),
        Check::relative("ω at the last point, rad/s", last, 4.0 / 3.0, 1e-7, why),
    ])
}

fn small_penetration() -> Result<Vec<Check>, Failure> {
    let gap = 1e-3;
    let stop = Contact::elastic(0, Side::Positive, gap, 100.0);
    let structure = with_tips(&springs(&[1.0], &[(0, 0, 1.0)], vec![stop])?)?;
    let mut points = Vec::new();
    let mut checks = Vec::new();
    for nanometres in [1.0, 4.0, 16.0] {
        let top = gap + nanometres * 1e-9;
        let closed = Bilinear { m: 1.0, k: 1.0, k_s: 100.0, gap, top, two_sided: false };
        let shift = at_energy(&structure, 1, 20, closed.kinetic())?.omega - 1.0;
        // arccos of nearly one, without cancellation: an exact sum of small angles.
        let exact = closed.omega() - 1.0;
        points.push((nanometres, shift));
        let why =
            "cancellation in the closed form (1e-16 over 1e-8 to 1e-6), and a contact that 20 harmonics see as a point";
        checks.push(Check::relative(format!("Δω/ω at {nanometres} nm"), shift, exact, 5e-2, why));
    }
    checks.push(Check::order(
        "over the penetration",
        slope(&points),
        1.5,
        0.03,
        "the next order, the root of the penetration",
    ));
    Ok(checks)
}

fn internal_resonance() -> Result<Vec<Check>, Failure> {
    let settings = loop_of_the_rod();
    let branch = compute_branch(rod(100, MassMatrix::Consistent)?, &settings, |_| ControlFlow::Continue(()))?.branch;
    let first = branch.points.first().ok_or("no points")?;
    let meeting: Vec<_> = branch.points.iter().filter(|p| p.has_event(Event::BranchPoint)).collect();
    let point = meeting.first().ok_or("no branch point")?;
    let [one, two] = [[0.9, 1.1], [2.8, 3.2]].map(tip_mode);
    let why = "the residual of a double zero of the equations: the root of rounding";
    Ok(vec![
        Check::count("branch points on the loop", meeting.len(), 1),
        Check::relative("f, Hz", point.omega / TAU, two[0] / 3.0 / TAU, 1e-8, why),
        Check::relative("energy over grazing", point.kinetic_energy / first.kinetic_energy, two[1] / one[1], 1e-6, why),
    ])
}

/// Angular frequency, rad/s, and averaged kinetic energy, J, of a linear mode of the paper's rod that just touches.
fn tip_mode([low, high]: [f64; 2]) -> [f64; 2] {
    let (n, h) = (100.0, 0.2);
    let w2 = |kappa: f64| 6.0 * (1.0 - kappa.cos()) / (2.0 + kappa.cos());
    let f = |kappa: f64| {
        let q = |j: f64| (kappa * (n - j)).sin();
        (1.0 - w2(kappa) * 4.0 / 6.0) * q(1.0) - (1.0 + w2(kappa) / 6.0) * q(2.0)
    };
    let kappa = bisect(f, low * PI / (2.0 * n), high * PI / (2.0 * n));
    let omega = (210e9_f64 / 9000.0).sqrt() / h * w2(kappa).sqrt();
    let q: Vec<f64> = (0..100).map(|j| (kappa * f64::from(j)).sin() / (kappa * 99.0).sin() * 0.5).collect();
    // Consistent mass without the row of the tip: the last node keeps the share of two elements.
    let coupled: f64 = q.windows(2).map(|q| q[0] * q[1]).sum();
    let mass = 9000.0 * h / 6.0 * (4.0 * q.iter().map(|q| q * q).sum::<f64>() + 2.0 * coupled);
    [omega, 0.25 * omega * omega * mass]
}

fn two_element_rod() -> Result<Vec<Check>, Failure> {
    let stop = Contact::rigid(1, Side::Positive, 1.0);
    // Two linear elements: K = 2[2 −1; −1 1], consistent mass 4/12 at the middle, that of the tip dropped.
    let structure = condensed(&springs(&[1.0 / 3.0, 0.0], &[(0, 0, 2.0), (0, 1, 2.0)], vec![stop])?)?;
    let mut checks = Vec::new();
    for top in [1.2, 2.0, 5.0] {
        let closed = oscillator(2.0, top, false);
        let (mut problem, start) = mode(&structure, 1, 80, Symmetry::None)?;
        let branch = follow(&mut problem, &start, closed.kinetic())?;
        let last = branch.points.last().ok_or("no points")?;
        let omega = problem.omega(&last.x);
        checks.push(Check::relative(
            format!("ω where the mass goes {top} m far, rad/s"),
            omega,
            closed.omega(),
            1e-9,
            FIFTH,
        ));
    }
    Ok(checks)
}
