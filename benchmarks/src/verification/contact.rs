//! Complementarity problems of contact with known forces, gaps and free boundaries.

use std::f64::consts::PI;

use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::model::{DofKind, Side};
use nlmodes_contact::{LcpError, LcpMatrix, Mat, SOLVER_NAMES, solver_by_name};

use super::tools::{bisect, integral};
use super::{Case, Check, Kind};
use crate::Failure;

const ROUNDING: &str = "rounding, times the condition of the compliance";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "two-stops-by-hand",
        problem: "`A = [2 1; 1 2] µm/N`, gaps without forces `(−1, −0.4) mm` and `(−1, 0.2) mm`: the second stop is \
            relieved by the force on the first.\nForces and gaps, with every solver.",
        kind: Kind::Exact,
        reference: "two equations by hand: 500 N on the first stop, none on the second, whose gap is 0.1 and 0.7 mm",
        remark: "",
        compute: two_stops,
    },
    Case {
        name: "tower-of-blocks",
        problem: "Six blocks on each other, each ten times as heavy as the one below it (1 g to 100 kg), on the \
            ground; `g = 9.81 m/s²`.\nForces that keep all relative accelerations from being negative.",
        kind: Kind::Exact,
        reference: "each contact carries what lies above it",
        remark: "twelve such blocks (to 10⁸ kg) are refused: rounding the forces moves the gaps by more than the \
            solvers promise",
        compute: || tower(6, 10.0),
    },
    Case {
        name: "tower-of-equal-blocks",
        problem: "A tower of 200 equal blocks of 1 kg; the ground is lowered with 5 m/s², so that the tower rests on \
            it with `g − 5 = 4.81 m/s²`.\nForces in all contacts.",
        kind: Kind::Exact,
        reference: "each contact carries the reduced weight of what lies above it",
        remark: "",
        compute: || tower(200, 1.0),
    },
    Case {
        name: "string-on-a-floor",
        problem: "String of length 1 m under 1 N, loaded by 1 N/m, over a floor 0.08 m below its ends; 99 \
            nodes.\nLength that lies on the floor, force of the floor.",
        kind: Kind::Exact,
        reference: "parabolas of length `√(2d)` meet the floor with a horizontal tangent, at 0.4 m, a node: \
            differences of second order are exact for them",
        remark: "",
        compute: string_on_a_floor,
    },
    Case {
        name: "hertz-sphere",
        problem: "Sphere of radius 0.1 m pressed 10 µm into a half-space, `E* = 100 GPa`, on 12² to 36² square cells \
            with constant pressure each\n(influence of a cell: Love 1929). Force, and largest pressure.",
        kind: Kind::Exact,
        reference: "Hertz: `F = 4/3 E* √R δ^{3/2}`, `p₀ = 2E*/π √(δ/R)`; cells of constant pressure err with `h²`",
        remark: "",
        compute: hertz,
    },
    Case {
        name: "hertz-cylinder",
        problem: "Cylinder of radius 0.1 m pressed with 10⁵ N/m onto a half-plane, `E* = 100 GPa`, 200 strips of \
            constant pressure.\nHalf width of the contact and largest pressure; the approach is found from the force.",
        kind: Kind::Exact,
        reference: "`a = √(4FR/πE*)`, `p₀ = 2F/πa`",
        remark: "",
        compute: hertz_cylinder,
    },
    Case {
        name: "journal-bearing",
        problem: "Infinitely long journal bearing, film `1 + ε cos θ`, `ε = 0.6`, oil that cannot pull: `p ≥ 0 ⊥ −(h³ \
            p′)′ + h′ ≥ 0`, `p = 0` at `θ = 0`.\nAngle at which the film ruptures, and largest pressure (in units of \
            `6ηΩ(R/c)²`), 100 to 400 nodes.",
        kind: Kind::Exact,
        reference: "Swift-Stieber: `∫₀^{θ_c} (h − h_c)/h³ dθ = 0`, by Simpson's rule and bisection; central \
            differences err with the square of the step",
        remark: "",
        compute: bearing,
    },
    Case {
        name: "propped-cantilever",
        problem: "Thick cantilever of 2 m (0.05 m wide, 0.1 m high, `E = 200 GPa`, `ν = 0.3`, `κ = 5/6`) loaded by 10 \
            kN at mid-span toward a stop at its tip, 1 mm away at rest.\nForce of the stop, from the reduction to two \
            free-interface modes.",
        kind: Kind::Exact,
        reference: "Timoshenko's statics: tip deflection `F(5L³/48EI + L/2κGA)`, tip compliance `L³/3EI + L/κGA`; \
            residual flexibility makes statics exact, whatever the number of modes",
        remark: "",
        compute: propped_cantilever,
    },
    Case {
        name: "exponential-example",
        problem: "Fathi's problem of 16 contacts, `A = L Lᵀ` with ones on the diagonal of `L` and twos below, gaps of \
            −1 without forces:\nleast-index pivoting needs 2¹⁶ − 1 steps. Forces.",
        kind: Kind::Exact,
        reference: "the first contact carries 1, all others are open with the gap 1",
        remark: "",
        compute: exponential,
    },
    Case {
        name: "redundant-stops",
        problem: "Four stops at one node that yields 1 µm/N, pressed in by 2 mm: the forces are not unique, their sum \
            is.\nSum of the forces; how many stops carry.",
        kind: Kind::Exact,
        reference: "2 kN; an independent subset, here one",
        remark: "",
        compute: redundant,
    },
    Case {
        name: "contradictory-gaps",
        problem: "A rigid body between two stops that are closer together than it is long: `A = [1 −1; −1 1]`, gaps \
            of −1 and 0.5.\nWhether each solver refuses it.",
        kind: Kind::Exact,
        reference: "`λ = (1, 1)` proves it: `Aλ = 0` and `bᵀλ < 0`",
        remark: "",
        compute: contradictory,
    },
];

/// Forces and gaps by the solver of that name.
fn solve(a: &Mat<f64>, b: &[f64], solver: &str) -> Result<(Vec<f64>, Vec<f64>), LcpError> {
    let matrix = LcpMatrix::new(a)?;
    let mut workspace = solver_by_name(solver)?.workspace(&matrix)?;
    let (mut closed, mut lambda, mut gaps) = (vec![false; b.len()], vec![0.0; b.len()], vec![0.0; b.len()]);
    workspace.solve(b, &mut closed, &mut lambda)?;
    workspace.gaps(&mut gaps)?;
    Ok((lambda, gaps))
}

fn two_stops() -> Result<Vec<Check>, Failure> {
    let a = Mat::from_fn(2, 2, |i, j| if i == j { 2e-6 } else { 1e-6 });
    let mut checks = Vec::new();
    for solver in SOLVER_NAMES.iter().filter(|name| **name != "closed-form") {
        for (free, gap) in [(-0.4e-3, 0.1e-3), (0.2e-3, 0.7e-3)] {
            let (lambda, gaps) = solve(&a, &[-1e-3, free], solver)?;
            checks.push(Check::relative(format!("{solver}: first force, N"), lambda[0], 500.0, 1e-9, ROUNDING));
            checks.push(Check::relative(format!("{solver}: second gap, m"), gaps[1], gap, 1e-9, ROUNDING));
            checks.push(Check::of_size(format!("{solver}: second force, N"), [lambda[1], 0.0, 500.0], 1e-9, ROUNDING));
        }
    }
    Ok(checks)
}

fn tower(n: usize, ratio: f64) -> Result<Vec<Check>, Failure> {
    let mass: Vec<f64> = (0..n).map(|k| if ratio == 1.0 { 1.0 } else { 1e-3 * ratio.powi(k as i32) }).collect();
    let gravity = if ratio == 1.0 { 4.81 } else { 9.81 };
    // Acceleration of block k: −g + (λ_k − λ_{k+1})/m_k; relative ones are those of the gaps.
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => 1.0 / mass[i] + if i > 0 { 1.0 / mass[i - 1] } else { 0.0 },
        1 => -1.0 / mass[i.min(j)],
        _ => 0.0,
    };
    let mut b = vec![0.0; n];
    b[0] = -gravity;
    let (lambda, _) = solve(&Mat::from_fn(n, n, entry), &b, "active-set")?;
    let above = |k: usize| mass[k..].iter().sum::<f64>() * gravity;
    let check = |k: usize| {
        Check::relative(
            format!("force in contact {}, N", k + 1),
            lambda[k],
            above(k),
            1e-7,
            "rounding, times the condition of the chain, up to 1e8",
        )
    };
    Ok([0, n / 2, n - 1].map(check).to_vec())
}

fn string_on_a_floor() -> Result<Vec<Check>, Failure> {
    let (n, depth) = (99, 0.08);
    let at = |i: usize| (i + 1) as f64 / (n + 1) as f64;
    let green = |i: usize, j: usize| at(i.min(j)) * (1.0 - at(i.max(j)));
    let free: Vec<f64> = (0..n).map(|i| depth - 0.5 * at(i) * (1.0 - at(i))).collect();
    let (lambda, gaps) = solve(&Mat::from_fn(n, n, green), &free, "active-set")?;
    // Nodes at 0.4 and 0.6 m just touch, with a force of their own share of the load: half the interval.
    let touching = gaps.iter().filter(|g| g.abs() < 1e-12).count();
    Ok(vec![
        Check::count("nodes on the floor", touching, 21),
        Check::relative("force of the floor, N", lambda.iter().sum(), 0.2, 1e-9, ROUNDING),
        Check::relative("gap at 0.2 m, m", gaps[19], depth - 0.5 * 0.2 * (0.8 - 0.2), 1e-10, ROUNDING),
    ])
}

/// Influence of a uniform pressure on a square of side `2s` on the deflection at a distance, times `πE*` (Love 1929).
fn love(x: f64, y: f64, s: f64) -> f64 {
    let term = |x: f64, y: f64, z: f64| x * ((y + y.hypot(x)) / (z + z.hypot(x))).ln();
    term(x + s, y + s, y - s) + term(y + s, x + s, x - s) + term(x - s, y - s, y + s) + term(y - s, x - s, x + s)
}

fn hertz() -> Result<Vec<Check>, Failure> {
    let (radius, modulus, approach) = (0.1_f64, 100e9_f64, 10e-6_f64);
    let contact = (radius * approach).sqrt();
    let force = 4.0 / 3.0 * modulus * radius.sqrt() * approach.powf(1.5);
    let pressure = 2.0 * modulus / PI * (approach / radius).sqrt();
    let computed = |n: usize| -> Result<[f64; 2], Failure> {
        // Only a quarter: the cells of the others are mirror images.
        let (half, cells) = (n / 2, (n / 2) * (n / 2));
        let side = 2.2 * contact / n as f64;
        let place = |k: usize| [(k % half) as f64 + 0.5, (k / half) as f64 + 0.5].map(|x| x * side);
        let influence = |i: usize, j: usize| {
            let ([x, y], [u, v]) = (place(i), place(j));
            let images = [(u, v), (-u, v), (u, -v), (-u, -v)];
            images.iter().map(|(u, v)| love(x - u, y - v, 0.5 * side)).sum::<f64>() / (PI * modulus)
        };
        let free: Vec<f64> =
            (0..cells).map(|k| (place(k)[0].powi(2) + place(k)[1].powi(2)) / (2.0 * radius) - approach).collect();
        let (pressures, _) = solve(&Mat::from_fn(cells, cells, influence), &free, "active-set")?;
        let largest = pressures.iter().fold(0.0_f64, |m, p| m.max(*p));
        Ok([4.0 * side * side * pressures.iter().sum::<f64>(), largest])
    };
    let ([coarse, _], [total, largest]) = (computed(12)?, computed(36)?);
    Ok(vec![
        Check::relative(
            "force, N, 12² cells",
            coarse,
            force,
            0.034,
            "(h/a)² = 0.034: constant pressure, and the rim, which cells follow in steps",
        ),
        Check::relative("force, N, 36² cells", total, force, 3.8e-3, "(h/a)² = 3.7e-3"),
        Check::relative("largest pressure, Pa, 36² cells", largest, pressure, 3.8e-3, "(h/a)² = 3.7e-3"),
    ])
}

fn hertz_cylinder() -> Result<Vec<Check>, Failure> {
    let (radius, modulus, force, n) = (0.1_f64, 100e9_f64, 1e5_f64, 200);
    let half = (4.0 * force * radius / (PI * modulus)).sqrt();
    let (width, peak) = (3.0 * half / n as f64, 2.0 * force / (PI * half));
    let place = |i: usize| (i as f64 + 0.5 - 0.5 * n as f64) * width;
    // Deflection of the half-plane relative to a point far away, distance 100 a: −2/πE* ∫ p ln |x − s|/d ds.
    let far = 100.0 * half;
    let strip = |x: f64| {
        let part = |t: f64| if t == 0.0 { 0.0 } else { t * (t.abs() / far).ln() - t };
        -2.0 / (PI * modulus) * (part(x + 0.5 * width) - part(x - 0.5 * width))
    };
    let a = Mat::from_fn(n, n, |i, j| strip(place(i) - place(j)));
    let loaded = |approach: f64| -> Result<Vec<f64>, Failure> {
        let free: Vec<f64> = (0..n).map(|i| place(i).powi(2) / (2.0 * radius) - approach).collect();
        Ok(solve(&a, &free, "active-set")?.0)
    };
    let total = |approach: f64| loaded(approach).map_or(f64::NAN, |p| width * p.iter().sum::<f64>());
    // The force is nearly linear in the approach: bisection.
    let approach = bisect(|d| total(d) - force, 0.0, 20.0 * half * half / radius);
    let pressures = loaded(approach)?;
    let closed = pressures.iter().filter(|p| **p > 0.0).count() as f64;
    Ok(vec![
        Check::relative("half width, m", 0.5 * closed * width, half, 0.02, "one strip at each end, 3/200"),
        Check::relative(
            "largest pressure, Pa",
            pressures.iter().fold(0.0, |m: f64, p| m.max(*p)),
            peak,
            2e-3,
            "strips of constant pressure: (h/a)² and the ends",
        ),
    ])
}

fn bearing() -> Result<Vec<Check>, Failure> {
    let eccentricity = 0.6;
    let film = |t: f64| 1.0 + eccentricity * f64::cos(t);
    let slope_at = |c: f64, t: f64| (film(t) - film(c)) / film(t).powi(3);
    let rupture = bisect(|c| integral(|t| slope_at(c, t), 0.0, c, 2000), PI, 1.9 * PI);
    // The pressure is largest where the film is as thick as at its rupture: mirrored about π.
    let peak = integral(|t| slope_at(rupture, t), 0.0, 2.0 * PI - rupture, 2000);
    let computed = |n: usize| -> Result<[f64; 2], Failure> {
        let h = 2.0 * PI / (n + 1) as f64;
        let cubed = |i: f64| film(i * h).powi(3) / (h * h);
        let entry = |i: usize, j: usize| {
            let x = (i + 1) as f64;
            match i.abs_diff(j) {
                0 => cubed(x - 0.5) + cubed(x + 0.5),
                1 => -cubed(0.5 * (i + j) as f64 + 1.0),
                _ => 0.0,
            }
        };
        let b: Vec<f64> = (0..n).map(|i| (film((i as f64 + 1.5) * h) - film((i as f64 + 0.5) * h)) / h).collect();
        let (pressure, _) = solve(&Mat::from_fn(n, n, entry), &b, "active-set")?;
        let last = pressure.iter().rposition(|p| *p > 0.0).ok_or("no pressure")?;
        // The pressure ends as a parabola whose curvature the equation gives: p = h′/h³ s²/2.
        let x = (last + 1) as f64 * h;
        let bend = eccentricity * -f64::sin(rupture) / film(rupture).powi(3);
        let ends = x + (2.0 * pressure[last] / bend).sqrt();
        Ok([ends, pressure.iter().fold(0.0, |m: f64, p| m.max(*p))])
    };
    let [coarse, fine] = [computed(100)?, computed(400)?];
    let ratio = (coarse[1] / peak - 1.0) / (fine[1] / peak - 1.0);
    Ok(vec![
        Check::relative(
            "angle of rupture, rad",
            fine[0],
            rupture,
            3e-3,
            "one step, 0.016 rad, of which the parabola leaves a fifth",
        ),
        Check::relative(
            "largest pressure",
            fine[1],
            peak,
            1e-3,
            "(Δθ)² = 2.5e-4, and where the peak falls between nodes",
        ),
        Check::order(
            "largest pressure, 100 to 400 nodes",
            ratio.abs().ln() / (401.0_f64 / 101.0).ln(),
            2.0,
            0.5,
            "where the peak falls between nodes",
        ),
    ])
}

fn propped_cantilever() -> Result<Vec<Check>, Failure> {
    let (e, width, height, length, load, gap) = (200e9, 0.05, 0.1_f64, 2.0_f64, 1e4, 1e-3);
    let (ei, shear) = (e * width * height.powi(3) / 12.0, 5.0 / 6.0 * e / 2.6 * width * height);
    let beam = Beam {
        material: Material::new(e, 7850.0)?.with_poissons_ratio(0.3)?,
        section: Section::rectangle(width, height)?.with_shear_factor(5.0 / 6.0)?,
        mesh: Mesh::uniform(length, 8)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let model = beam.assemble(&[Stop::rigid(length, Direction::Transverse, Side::Positive, gap)])?;
    let open = OpenModes::of_model(&model, ModeCount::Lowest(2))?;
    let middle = |dof: &nlmodes::model::Dof| dof.kind == DofKind::Deflection && (dof.position - 1.0).abs() < 1e-9;
    let at = model.dofs().iter().position(middle).ok_or("no node at mid-span")?;
    let mut force = vec![0.0; model.dofs().len()];
    force[at] = load;
    let preload = open.load(&force)?;
    let rest = open.rest(&[&preload], solver_by_name("active-set")?.as_ref())?;
    let deflection = load * (5.0 * length.powi(3) / (48.0 * ei) + 0.5 * length / shear);
    let compliance = length.powi(3) / (3.0 * ei) + length / shear;
    let expected = (deflection - gap) / compliance;
    Ok(vec![Check::relative("force of the stop, N", rest.forces[0], expected, 1e-8, ROUNDING)])
}

fn exponential() -> Result<Vec<Check>, Failure> {
    let n = 16;
    let lower = |i: usize, j: usize| f64::from(u8::from(i == j) + 2 * u8::from(i > j));
    let a = Mat::from_fn(n, n, |i, j| (0..n).map(|k| lower(i, k) * lower(j, k)).sum::<f64>());
    let mut checks = Vec::new();
    for solver in ["active-set", "lemke", "clarabel"] {
        let (lambda, gaps) = solve(&a, &vec![-1.0; n], solver)?;
        let others = lambda[1..].iter().fold(0.0_f64, |m, l| m.max(l.abs()));
        checks.push(Check::relative(format!("{solver}: first force"), lambda[0], 1.0, 1e-8, ROUNDING));
        checks.push(Check::of_size(format!("{solver}: largest other force"), [others, 0.0, 1.0], 1e-8, ROUNDING));
        checks.push(Check::relative(format!("{solver}: last gap"), gaps[n - 1], 1.0, 1e-8, ROUNDING));
    }
    Ok(checks)
}

fn redundant() -> Result<Vec<Check>, Failure> {
    let matrix = LcpMatrix::new(&Mat::from_fn(4, 4, |_, _| 1e-6))?;
    let mut workspace = solver_by_name("active-set")?.workspace(&matrix)?;
    let (mut closed, mut lambda) = ([false; 4], [0.0; 4]);
    workspace.solve(&[-2e-3; 4], &mut closed, &mut lambda)?;
    Ok(vec![
        Check::relative("sum of the forces, N", lambda.iter().sum(), 2000.0, 1e-10, ROUNDING),
        Check::count("stops that carry", closed.iter().filter(|c| **c).count(), 1),
    ])
}

fn contradictory() -> Result<Vec<Check>, Failure> {
    let a = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { -1.0 });
    let check = |solver: &str| {
        let refused = solve(&a, &[-1.0, 0.5], solver).is_err();
        Check::count(format!("{solver} refuses (1: yes)"), usize::from(refused), 1)
    };
    Ok(["active-set", "proximal", "clarabel", "lemke"].map(check).to_vec())
}
