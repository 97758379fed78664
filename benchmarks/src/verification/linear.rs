//! Frequencies and deflections of linear structures.

use std::f64::consts::{PI, TAU};

use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes::linalg::{SparseCholesky, lowest_modes};
use nlmodes::model::{DofKind, MasslessContactModel, Move, Side, StructuralModel, held_modes, linear_modes};

use super::tools::{bisect, slope, springs};
use super::{Case, Check, Kind};
use crate::{Failure, beam, rod};

const ROUNDING: &str = "rounding, times the ratio of the highest frequency to this one";
const ORDER: &str = "what is left of the next order on the meshes used";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "rod-consistent",
        problem: "Clamped-free rod, `EA = 7 N`, `ρA = 3 kg/m`, `L = 2 m`, ten linear elements with consistent \
            mass.\nAll ten angular frequencies.",
        kind: Kind::Exact,
        reference: "the mesh is a chain: `ω² = 6 EA/(ρA h²) · (1 − cos κ)/(2 + cos κ)`, `κ = (2k − 1)π/20`",
        remark: "",
        compute: || discrete_rod(MassMatrix::Consistent),
    },
    Case {
        name: "rod-lumped",
        problem: "The same rod with lumped mass.\nAll ten angular frequencies.",
        kind: Kind::Exact,
        reference: "`ω = (2/h) √(EA/ρA) sin(κ/2)`, `κ = (2k − 1)π/20`",
        remark: "",
        compute: || discrete_rod(MassMatrix::Lumped),
    },
    Case {
        name: "rod-continuous",
        problem: "Clamped-free steel rod, `E = 210 GPa`, `ρ = 7850 kg/m³`, `L = 3 m`, 10 to 80 elements with \
            consistent mass.\nFirst frequency, and how it converges.",
        kind: Kind::Exact,
        reference: "`f = √(E/ρ)/(4L)`; linear elements err with `h²`, from above",
        remark: "",
        compute: continuous_rod,
    },
    Case {
        name: "rod-massless-tip",
        problem: "The rod of Section 3 of the paper: `E = 210 GPa`, `ρ = 9000 kg/m³`, `L = 20 m`, 100 elements, \
            consistent mass;\nthe mass of the tip node is dropped. First and second frequency, and the first one with \
            the tip fixed.",
        kind: Kind::Exact,
        reference: "`q_j = sin κj` between the ends; the equations of the last two nodes give one equation for `κ`, \
            solved by bisection",
        remark: "the paper says 60.3 Hz and \"around 182\" Hz: the former is the frequency with the mass kept or \
            moved (next case)",
        compute: massless_tip,
    },
    Case {
        name: "rod-moved-tip",
        problem: "The same rod; the mass of the tip node is moved to its neighbour instead.\nFirst frequency.",
        kind: Kind::OtherProgram,
        reference: "60.3 Hz, Section 3 of Peter, Schreyer, Leine 2019, one digit behind the point",
        remark: "",
        compute: moved_tip,
    },
    Case {
        name: "chain-of-masses",
        problem: "Eight masses of 0.5 kg between springs of 20 N/m, both ends fixed.\nAll eight angular frequencies.",
        kind: Kind::Exact,
        reference: "`ω = 2 √(k/m) sin(jπ/18)`",
        remark: "",
        compute: chain,
    },
    Case {
        name: "beam-pinned-slender",
        problem: "Slender pinned beam in its plane, `L = 2 m`, 1 mm square, `E = 70 GPa`, `ρ = 2700 kg/m³`, 32 \
            elements.\nFirst three bending frequencies.",
        kind: Kind::Exact,
        reference: "Euler-Bernoulli, `ω = (kπ/L)² √(EI/ρA)`",
        remark: "",
        compute: pinned_slender,
    },
    Case {
        name: "beam-cantilever-slender",
        problem: "The same beam clamped at one end.\nFirst three bending frequencies.",
        kind: Kind::Exact,
        reference: "Euler-Bernoulli, `ω = (β/L)² √(EI/ρA)` with `cos β cosh β = −1`, solved by bisection",
        remark: "",
        compute: cantilever_slender,
    },
    Case {
        name: "beam-pinned-thick",
        problem: "Thick pinned beam, `L = 1 m`, section 0.1 m × 0.2 m, `E = 200 GPa`, `ν = 0.3`, `κ = 5/6`, `ρ = 8000 \
            kg/m³`, 12 to 48 elements.\nFirst three bending frequencies, and how the third converges.",
        kind: Kind::Exact,
        reference: "Timoshenko: `κGA EI p⁴ − (κGA ρA + (κGA ρI + EI ρA) p²) ω² + ρA ρI ω⁴ = 0` with `p = kπ/L`; \
            elements shorter than the beam is high err with `h²`, slender ones with `h⁴`",
        remark: "",
        compute: pinned_thick,
    },
    Case {
        name: "beam-tip-load",
        problem: "Thick cantilever of the same section and material, 1.5 m long, a force of 1 kN at its tip, three \
            elements of unequal length.\nDeflection and rotation of the tip.",
        kind: Kind::Exact,
        reference: "`FL³/3EI + FL/κGA` and `FL²/2EI`: the element is exact for loads at nodes",
        remark: "",
        compute: tip_load,
    },
    Case {
        name: "beam-of-the-paper",
        problem: "The beam of Section 4 of the paper with `E = 181.36 GPa`, the mass of its tip dropped; 21 graded \
            elements (`configs/beam.toml`).\nFirst frequency.",
        kind: Kind::Measured,
        reference: "40.10 Hz, Table 1 of Peter, Schreyer, Leine 2019, measured on the beam",
        remark: "length and mesh are not in the paper; they are those with which both moduli of Table 1 hold. The \
            higher frequencies of the table are not those of an ideal cantilever",
        compute: beam_of_the_paper,
    },
];

fn model(mass_matrix: MassMatrix, elements: usize, [e, rho, length]: [f64; 3]) -> Result<StructuralModel, Failure> {
    let rod = Rod {
        material: Material::new(e, rho)?,
        area: 1.0,
        mesh: Mesh::uniform(length, elements)?,
        mass_matrix,
        start: Support::Clamped,
        end: Support::Free,
    };
    Ok(rod.assemble(&[])?)
}

fn discrete_rod(mass_matrix: MassMatrix) -> Result<Vec<Check>, Failure> {
    let (ea, rho_a, length, n) = (7.0, 3.0, 2.0, 10);
    let model = model(mass_matrix, n, [ea, rho_a, length])?;
    let (h, found) = (length / n as f64, linear_modes(model.mass(), model.stiffness(), n)?.omega);
    let exact = |k: usize| {
        let kappa = (2 * k + 1) as f64 * PI / (2 * n) as f64;
        let speed = (ea / rho_a).sqrt() / h;
        match mass_matrix {
            MassMatrix::Consistent => speed * (6.0 * (1.0 - kappa.cos()) / (2.0 + kappa.cos())).sqrt(),
            _ => speed * 2.0 * (kappa / 2.0).sin(),
        }
    };
    let check = |k: usize| Check::relative(format!("ω_{}, rad/s", k + 1), found[k], exact(k), 1e-11, ROUNDING);
    Ok([0, 4, 9].map(check).to_vec())
}

fn continuous_rod() -> Result<Vec<Check>, Failure> {
    let (e, rho, length): (f64, f64, f64) = (210e9, 7850.0, 3.0);
    let exact = (e / rho).sqrt() / (4.0 * length);
    let mut errors = Vec::new();
    let mut finest = 0.0;
    for elements in [10, 20, 40, 80] {
        let model = model(MassMatrix::Consistent, elements, [e, rho, length])?;
        finest = linear_modes(model.mass(), model.stiffness(), 1)?.omega[0] / TAU;
        errors.push((elements as f64, finest / exact - 1.0));
    }
    // ω_h/ω = 1 + (κ h)²/24 + …, with κ = π/2L.
    let error = (PI / 2.0 / 80.0).powi(2) / 24.0;
    Ok(vec![
        Check::relative(
            "frequency of 80 elements, Hz",
            finest,
            exact * (1.0 + error),
            1e-8,
            "the next term, (κh)⁴/640, and rounding",
        ),
        Check::order("10 to 80 elements", -slope(&errors), 2.0, 0.01, ORDER),
    ])
}

/// `κ` of the chain with its last node massless, between two multiples of π/2n, and the angular frequency.
fn tip_frequency(n: f64, speed: f64, [low, high]: [f64; 2]) -> f64 {
    // The tip follows its neighbour; that one has the mass 4/6 of an element and one spring: (1 − cos κ)-form of its
    // equation.
    let w2 = |kappa: f64| 6.0 * (1.0 - kappa.cos()) / (2.0 + kappa.cos());
    let f = |kappa: f64| {
        let q = |j: f64| (kappa * (n - j)).sin();
        (1.0 - w2(kappa) * 4.0 / 6.0) * q(1.0) - (1.0 + w2(kappa) / 6.0) * q(2.0)
    };
    let kappa = bisect(f, low * PI / (2.0 * n), high * PI / (2.0 * n));
    speed * n * w2(kappa).sqrt()
}

fn massless_tip() -> Result<Vec<Check>, Failure> {
    let speed = (210e9_f64 / 9000.0).sqrt() / 20.0;
    let model = rod(100, MassMatrix::Consistent)?;
    let found = linear_modes(model.mass(), model.stiffness(), 2)?.omega;
    let held = held_modes(&model, 1)?.omega[0];
    // Tip and its neighbour's half element held: 100 equal elements between fixed ends.
    let kappa = PI / 100.0;
    let exact_held = speed * 100.0 * (6.0 * (1.0 - kappa.cos()) / (2.0 + kappa.cos())).sqrt();
    let why = "rounding, times the ratio of the highest frequency to this one";
    Ok(vec![
        Check::relative("f_1, Hz", found[0] / TAU, tip_frequency(100.0, speed, [0.9, 1.1]) / TAU, 1e-10, why),
        Check::relative("f_2, Hz", found[1] / TAU, tip_frequency(100.0, speed, [2.8, 3.2]) / TAU, 1e-10, why),
        Check::relative("f_1 with the tip fixed, Hz", held / TAU, exact_held / TAU, 1e-10, why),
    ])
}

fn moved_tip() -> Result<Vec<Check>, Failure> {
    let rod = Rod {
        material: Material::new(210e9, 9000.0)?,
        area: 1.0,
        mesh: Mesh::uniform(20.0, 100)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let model = rod.assemble(&[Stop::rigid(20.0, Direction::Axial, Side::Positive, 0.5)])?;
    let model = MasslessContactModel::new(&model, &Move)?;
    let found = linear_modes(model.mass(), model.stiffness(), 1)?.omega[0] / TAU;
    Ok(vec![Check::of_size("f_1, Hz", [found, 60.3, 60.3], 2e-3, "its digits: 60.3 may mean anything up to 60.4")])
}

fn chain() -> Result<Vec<Check>, Failure> {
    let mut connections: Vec<(usize, usize, f64)> = (1..8).map(|i| (i - 1, i, 20.0)).collect();
    connections.extend([(0, 0, 20.0), (7, 7, 20.0)]);
    let model = springs(&[0.5; 8], &connections, Vec::new())?;
    let found = linear_modes(model.mass(), model.stiffness(), 8)?.omega;
    let exact = |j: usize| 2.0 * (20.0_f64 / 0.5).sqrt() * ((j + 1) as f64 * PI / 18.0).sin();
    let check = |j: usize| Check::relative(format!("ω_{}, rad/s", j + 1), found[j], exact(j), 1e-12, ROUNDING);
    Ok([0, 3, 7].map(check).to_vec())
}

fn bending(beam: &Beam, count: usize) -> Result<Vec<f64>, Failure> {
    let model = beam.assemble(&[])?;
    let n = model.dofs().len();
    let modes = linear_modes(model.mass(), model.stiffness(), (3 * count).min(n))?;
    let bends = |k: usize| {
        let size = |kind: DofKind| {
            (0..n).filter(|i| model.dofs()[*i].kind == kind).map(|i| modes.shapes[(i, k)].abs()).fold(0.0, f64::max)
        };
        size(DofKind::Deflection) > size(DofKind::Axial)
    };
    Ok((0..modes.omega.len()).filter(|k| bends(*k)).map(|k| modes.omega[k]).take(count).collect())
}

fn slender(start: Support, end: Support) -> Result<Beam, Failure> {
    Ok(Beam {
        material: Material::new(70e9, 2700.0)?,
        section: Section::rectangle(1e-3, 1e-3)?,
        mesh: Mesh::uniform(2.0, 32)?,
        mass_matrix: MassMatrix::Consistent,
        start,
        end,
    })
}

/// `√(EI/ρA)/L²` of the slender beam.
fn slender_unit() -> f64 {
    (70e9_f64 / 2700.0 * 1e-6 / 12.0).sqrt() / 4.0
}

const SLENDER: &str =
    "shear and rotary inertia, `(1 + E/κG)(β r/L)²/2` with `r/L = 1.4e-4`, and the mesh, `(βh/L)⁴/720·…`";

fn pinned_slender() -> Result<Vec<Check>, Failure> {
    let found = bending(&slender(Support::Pinned, Support::Pinned)?, 3)?;
    let exact = |k: usize| ((k + 1) as f64 * PI).powi(2) * slender_unit();
    let check = |k: usize| Check::relative(format!("ω_{}, rad/s", k + 1), found[k], exact(k), 1e-5, SLENDER);
    Ok((0..3).map(check).collect())
}

fn cantilever_slender() -> Result<Vec<Check>, Failure> {
    let found = bending(&slender(Support::Clamped, Support::Free)?, 3)?;
    let beta = |k: usize| {
        let middle = (k as f64 + 0.5) * PI;
        bisect(|b| b.cos() + 1.0 / b.cosh(), middle - 0.5, middle + 0.5)
    };
    let exact = |k: usize| beta(k).powi(2) * slender_unit();
    let check = |k: usize| Check::relative(format!("ω_{}, rad/s", k + 1), found[k], exact(k), 1e-5, SLENDER);
    Ok((0..3).map(check).collect())
}

const THICK: [f64; 4] = [200e9, 8000.0, 0.1, 0.2];

fn thick(mesh: Mesh, start: Support, end: Support) -> Result<Beam, Failure> {
    let [e, rho, width, height] = THICK;
    Ok(Beam {
        material: Material::new(e, rho)?.with_poissons_ratio(0.3)?,
        section: Section::rectangle(width, height)?.with_shear_factor(5.0 / 6.0)?,
        mesh,
        mass_matrix: MassMatrix::Consistent,
        start,
        end,
    })
}

fn pinned_thick() -> Result<Vec<Check>, Failure> {
    let [e, rho, width, height] = THICK;
    let (area, second) = (width * height, width * height.powi(3) / 12.0);
    let (shear, ei) = (5.0 / 6.0 * e / 2.6 * area, e * second);
    let exact = |k: usize| {
        let p2 = (k as f64 * PI).powi(2);
        let (a, c) = (rho * area * rho * second, shear * ei * p2 * p2);
        let b = shear * rho * area + (shear * rho * second + ei * rho * area) * p2;
        (2.0 * c / (b + (b * b - 4.0 * a * c).sqrt())).sqrt()
    };
    let found = |elements: usize| bending(&thick(Mesh::uniform(1.0, elements)?, Support::Pinned, Support::Pinned)?, 3);
    let [coarse, middle, fine] = [found(12)?, found(24)?, found(48)?];
    let why = "(kπ/48)²/24: elements shorter than the beam is high are linear in bending";
    let mut checks: Vec<Check> = (0..3)
        .map(|k| Check::relative(format!("ω_{}, rad/s, 48 elements", k + 1), fine[k], exact(k + 1), 1.7e-3, why))
        .collect();
    checks.extend((0..3).map(|k| {
        let extrapolated = (4.0 * fine[k] - middle[k]) / 3.0;
        Check::relative(format!("ω_{}, extrapolated", k + 1), extrapolated, exact(k + 1), 1e-5, "the next term, h⁴")
    }));
    let errors: Vec<(f64, f64)> =
        [(12.0, &coarse), (24.0, &middle), (48.0, &fine)].map(|(n, f)| (n, f[2] / exact(3) - 1.0)).to_vec();
    checks.push(Check::order("12 to 48 elements", -slope(&errors), 2.0, 0.05, ORDER));
    Ok(checks)
}

fn tip_load() -> Result<Vec<Check>, Failure> {
    let [e, _, width, height] = THICK;
    let (length, force) = (1.5, 1e3);
    let (area, ei) = (width * height, e * width * height.powi(3) / 12.0);
    let shear = 5.0 / 6.0 * e / 2.6 * area;
    let model = thick(Mesh::graded(length, 3, 2.5)?, Support::Clamped, Support::Free)?.assemble(&[])?;
    let last = |kind: DofKind| model.dofs().iter().rposition(|dof| dof.kind == kind).ok_or("no such freedom");
    let (deflection, rotation) = (last(DofKind::Deflection)?, last(DofKind::Rotation)?);
    let mut q = vec![0.0; model.dofs().len()];
    q[deflection] = force;
    SparseCholesky::factor(model.stiffness(), "stiffness")?.solve_in_place(&mut q);
    let why = "rounding, times the condition of the stiffness";
    let bent = force * length.powi(3) / (3.0 * ei) + force * length / shear;
    Ok(vec![
        Check::relative("deflection, m", q[deflection], bent, 1e-11, why),
        Check::relative("rotation, rad", q[rotation], force * length * length / (2.0 * ei), 1e-11, why),
    ])
}

fn beam_of_the_paper() -> Result<Vec<Check>, Failure> {
    let model = beam()?;
    let found = (lowest_modes(model.stiffness(), model.mass(), 1)?.eigenvalues[0]).sqrt() / TAU;
    Ok(vec![Check::of_size("f_1, Hz", [found, 40.10, 40.10], 2e-4, "the digits of the table")])
}
