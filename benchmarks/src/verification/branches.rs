//! Solution sets of equations whose folds, crossings and corners are known.

mod follow;
mod systems;

use std::f64::consts::PI;

use nlmodes::continuation::{EventKind, Linearization};

use super::tools::{bisect, integral, slope};
use super::{Case, Check, Kind};
use crate::Failure;
use follow::{CROSSED, crossings, first_fold, folds, trace, tree};
use systems::{Equations, Pieces, planar, two_point};

const LOCATED: &str =
    "events are located to the tolerance of the corrector, 1e-10, the parameter of a fold to its square";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "circle",
        problem: "`x² + p² = 1`, once around.\nBoth folds, and that the branch closes.",
        kind: Kind::Exact,
        reference: "`p = ±1`, `x = 0`",
        remark: "",
        compute: circle,
    },
    Case {
        name: "bifurcationkit-perturbed-pitchfork",
        problem: "The first example of BifurcationKit's documentation, `p + x − x³/3 = 0`, from `(−2, −1)`.\nBoth \
            folds.",
        kind: Kind::Exact,
        reference: "`p = ±⅔` at `x = ∓1`",
        remark: "",
        compute: perturbed_pitchfork,
    },
    Case {
        name: "bifurcationkit-pitchfork",
        problem: "BifurcationKit's pitchfork, `x (p − x²) = 0`, along `x = 0` from −0.3.\nThe branch point, its \
            half-branches, and the number of branches of its tree.",
        kind: Kind::Exact,
        reference: "`(0, 0)`, three half-branches other than the incoming one",
        remark: "",
        compute: pitchfork,
    },
    Case {
        name: "bifurcationkit-transcritical",
        problem: "BifurcationKit's transcritical bifurcation, `x (p − x) = 0`, along `x = 0` from −0.2.\nThe branch \
            point and its half-branches.",
        kind: Kind::Exact,
        reference: "`(0, 0)`, three half-branches",
        remark: "",
        compute: transcritical,
    },
    Case {
        name: "square-symmetry",
        problem: "`x (p − x² − a(x² + y²)) = y (p − y² − a(x² + y²)) = 0` with `a = 0.4`: two directions become free \
            at once.\nThe branch point and its half-branches.",
        kind: Kind::Exact,
        reference: "`(0, 0, 0)`; each unknown is zero or one of two: nine half-branches other than the incoming one",
        remark: "",
        compute: square_symmetry,
    },
    Case {
        name: "auto-ab",
        problem: "AUTO's demo `ab`: `−u₁ + p (1 − u₁) e^{u₂} = −u₂ + 14 p (1 − u₁) e^{u₂} − 2u₂ = 0`, from `p = \
            0`.\nBoth folds.",
        kind: Kind::Exact,
        reference: "`u₂ = 14u₁/3`; the folds are where `u₁(1 − u₁) = 3/14`. AUTO's manual: 0.105739 and 0.0889318",
        remark: "",
        compute: ab,
    },
    Case {
        name: "auto-exp",
        problem: "AUTO's demo `exp` (Bratu): `u″ + p eᵘ = 0`, `u(0) = u(1) = 0`, by central differences on 10 to 40 \
            intervals.\nThe fold, and how it converges.",
        kind: Kind::Exact,
        reference: "`p = 8 (θ/cosh θ)²` with `θ tanh θ = 1`, 3.513830719; differences err with the square of the step",
        remark: "",
        compute: bratu,
    },
    Case {
        name: "auto-pp2",
        problem: "AUTO's demo `pp2`: `3u(1 − u) − uv − p(1 − e^{−5u}) = −v + 3uv = 0`, tree from `p = 0.3` along `u = \
            v = 0`.\nBranch points of prey without and with predators, and the fold between them.",
        kind: Kind::Exact,
        reference: "`p = 0.6` at `u = 0`; `p = 2/3/(1 − e^{−5/3})` at `u = 1/3`; the largest `3u(1 − u)/(1 − \
            e^{−5u})`, by bisection of its derivative",
        remark: "",
        compute: predator_prey,
    },
    Case {
        name: "two-cells",
        problem: "Two cells with `R(s) = s/(1 + s + s²)`: `(p − s₁) + (s₂ − s₁) − 100 R(s₁) = 0` and the same with 1 \
            and 2 exchanged, from `p = 0` (as AUTO's `enz`).\nFolds and branch points of the symmetric branch.",
        kind: Kind::Exact,
        reference: "`p = s + 100 R(s)`; `1 + 100 R′ = 0` at the folds and `3 + 100 R′ = 0` at the branch points, by \
            bisection",
        remark: "",
        compute: two_cells,
    },
    Case {
        name: "cusp",
        problem: "`p + 1.5x − x³ = 0`, a section of the cusp.\nBoth folds.",
        kind: Kind::Exact,
        reference: "`p = ±2 (λ/3)^{3/2}` with `λ = 1.5`",
        remark: "",
        compute: cusp,
    },
    Case {
        name: "shallow-truss",
        problem: "Two bars that meet in a shallow gable of height 0.1 m, half span 2 m, `EA = 2·10⁸ N`: `P = EA w (w \
            − h)(w − 2h)/L³`, in newtons and metres.\nBoth limit loads.",
        kind: Kind::Exact,
        reference: "`P = ±2EA h³/(3√3 L³)` at `w = h(1 ∓ 1/√3)`",
        remark: "",
        compute: truss,
    },
    Case {
        name: "temperature-model",
        problem: "The model of BifurcationKit's documentation: `T″ + p (1 + (T + T²/2)/(1 + βT²)) = 0`, `T = β = \
            0.01` at both ends, by differences on 20 and 40 intervals.\nThe first fold, and how it converges.",
        kind: Kind::Independent,
        reference: "quadrature: `p = 2 (∫ dT/√(G(T_m) − G(T)))²` over the largest temperature `T_m`, whose derivative \
            vanishes",
        remark: "",
        compute: temperature,
    },
    Case {
        name: "buckling",
        problem: "`y″ + p sin y = 0`, `y(0) = y(1) = 0`, by differences on 12 intervals, along `y = 0` to `p = \
            100`.\nAll branch points, and the half-branches of each other than the incoming one.",
        kind: Kind::Exact,
        reference: "`p = 4 · 144 sin²(kπ/24)`, three of them",
        remark: "",
        compute: buckling,
    },
    Case {
        name: "corner",
        problem: "`p + |x| = 1`, from `x = 0.8`: the parameter turns at a kink of the branch.\nThe fold, and that the \
            branch goes on behind it.",
        kind: Kind::Exact,
        reference: "`p = 1`, `x = 0`; the branch reaches `x = −0.8` at `p = 0.2`",
        remark: "",
        compute: corner,
    },
    Case {
        name: "grazing-corner",
        problem: "`p = x − 2 (x − 1)₊^{3/2}·1.5`, the law of a contact that begins: its slope is continuous, its \
            curvature is not bounded.\nThe fold behind the grazing point.",
        kind: Kind::Exact,
        reference: "`1 = 4.5 √(x − 1)`: `x = 1 + 4/81`, `p = x − 3 (x − 1)^{3/2}`",
        remark: "",
        compute: grazing,
    },
];

fn circle() -> Result<Vec<Check>, Failure> {
    let mut system = planar(|x, p| [x * x + p * p - 1.0, 2.0 * x, 2.0 * p]);
    let branch = trace(&mut system, &[1.0], 0.0, &[])?;
    let mut checks = folds(&branch, &[1.0, -1.0], 1e-9, LOCATED);
    let closed = branch.stop == nlmodes::continuation::StopReason::Closed;
    checks.push(Check::count("closed (1: yes)", usize::from(closed), 1));
    Ok(checks)
}

fn perturbed_pitchfork() -> Result<Vec<Check>, Failure> {
    let mut system = planar(|x, p| [p + x - x.powi(3) / 3.0, 1.0 - x * x, 1.0]);
    let branch = trace(&mut system, &[-2.1], -1.0, &[(1, -1.2, 1.2)])?;
    Ok(folds(&branch, &[2.0 / 3.0, -2.0 / 3.0], 1e-9, LOCATED))
}

fn pitchfork() -> Result<Vec<Check>, Failure> {
    let system = || planar(|x, p| [x * (p - x * x), p - 3.0 * x * x, x]);
    let bounds = [(1, -1.0, 1.0)];
    let mut checks = crossings(&trace(&mut system(), &[0.0], -0.3, &bounds)?, &[(0.0, 3)], 1.0);
    let tree = tree(&mut system(), &[0.0], -0.3, &bounds)?;
    checks.push(Check::count("branches of the tree", tree.branches.len(), 3));
    let ends: Vec<f64> = tree.branches.iter().filter_map(|b| b.branch.points.last()).map(|q| q.x[0].abs()).collect();
    let on_parabola = ends.iter().filter(|x| (**x - 1.0).abs() < 1e-8).count();
    checks.push(Check::count("of which end at |x| = 1", on_parabola, 2));
    Ok(checks)
}

fn transcritical() -> Result<Vec<Check>, Failure> {
    let mut system = planar(|x, p| [x * (p - x), p - 2.0 * x, x]);
    Ok(crossings(&trace(&mut system, &[0.0], -0.2, &[(1, -1.0, 1.0)])?, &[(0.0, 3)], 1.0))
}

fn square_symmetry() -> Result<Vec<Check>, Failure> {
    let a = 0.4;
    let f = move |x: &[f64], p: f64, out: &mut Linearization| {
        let sum = x[0] * x[0] + x[1] * x[1];
        for i in 0..2 {
            let rest = p - x[i] * x[i] - a * sum;
            out.residual[i] = x[i] * rest;
            (0..2).for_each(|j| out.jacobian[(i, j)] = -2.0 * a * x[i] * x[j]);
            out.jacobian[(i, i)] += rest - 2.0 * x[i] * x[i];
            out.jacobian[(i, 2)] = x[i];
        }
    };
    let branch = trace(&mut Equations { n: 2, f }, &[0.0; 2], -0.3, &[(2, -1.0, 1.0)])?;
    Ok(crossings(&branch, &[(0.0, 9)], 1.0))
}

fn ab() -> Result<Vec<Check>, Failure> {
    let f = |u: &[f64], p: f64, out: &mut Linearization| {
        let e = u[1].exp();
        let rate = (1.0 - u[0]) * e;
        out.residual.copy_from_slice(&[-u[0] + p * rate, -3.0 * u[1] + 14.0 * p * rate]);
        (out.jacobian[(0, 0)], out.jacobian[(0, 1)], out.jacobian[(0, 2)]) = (-1.0 - p * e, p * rate, rate);
        (out.jacobian[(1, 0)], out.jacobian[(1, 1)], out.jacobian[(1, 2)]) =
            (-14.0 * p * e, -3.0 + 14.0 * p * rate, 14.0 * rate);
    };
    let branch = trace(&mut Equations { n: 2, f }, &[0.0; 2], 0.0, &[(2, -0.05, 0.15)])?;
    let root = (1.0_f64 - 12.0 / 14.0).sqrt();
    let level = |u: f64| u / (1.0 - u) * (-14.0 * u / 3.0).exp();
    let exact = [level(0.5 * (1.0 - root)), level(0.5 * (1.0 + root))];
    let mut checks = folds(&branch, &exact, 1e-9, LOCATED);
    let published = [0.105739, 0.0889318];
    checks.extend(published.iter().zip(&exact).map(|(p, e)| {
        Check::relative("p at a fold, closed form beside the digits of AUTO", *e, *p, 1e-5, "six digits are published")
    }));
    Ok(checks)
}

fn bratu() -> Result<Vec<Check>, Failure> {
    let theta = bisect(|t| t * t.tanh() - 1.0, 0.5, 2.0);
    let exact = 8.0 * (theta / theta.cosh()).powi(2);
    let found = |n: usize| first_fold(two_point(n - 1, 0.0, |u| [u.exp(); 2]), 0.0, 5.0);
    let values = [found(10)?, found(20)?, found(40)?];
    let errors: Vec<(f64, f64)> = [10.0, 20.0, 40.0].into_iter().zip(values.map(|p| p / exact - 1.0)).collect();
    Ok(vec![
        Check::relative("fold on 40 intervals", values[2], exact, 1e-3, "the differences: 0.7 h²"),
        Check::relative(
            "extrapolated from 20 and 40 intervals",
            (4.0 * values[2] - values[1]) / 3.0,
            exact,
            1e-5,
            "the next term of the differences, h⁴",
        ),
        Check::order("10 to 40 intervals", -slope(&errors), 2.0, 0.05, "the next term"),
    ])
}

fn predator_prey() -> Result<Vec<Check>, Failure> {
    let f = |x: &[f64], p: f64, out: &mut Linearization| {
        let (u, v) = (x[0], x[1]);
        let e = (-5.0 * u).exp();
        out.residual.copy_from_slice(&[3.0 * u * (1.0 - u) - u * v - p * (1.0 - e), -v + 3.0 * u * v]);
        (out.jacobian[(0, 0)], out.jacobian[(0, 1)]) = (3.0 - 6.0 * u - v - 5.0 * p * e, -u);
        out.jacobian[(0, 2)] = -(1.0 - e);
        (out.jacobian[(1, 0)], out.jacobian[(1, 1)]) = (3.0 * v, -1.0 + 3.0 * u);
    };
    let found = tree(&mut Equations { n: 2, f }, &[0.0; 2], 0.3, &[(2, 0.2, 1.2), (0, -0.2, 1.2), (1, -0.5, 2.0)])?;
    let all: Vec<&[f64]> = found.branches.iter().flat_map(|b| &b.branch.crossings).map(|c| c.z.as_slice()).collect();
    let near = |u: f64| all.iter().filter(|z| (z[0] - u).abs() < 1e-3).map(|z| z[2]).next().unwrap_or(f64::NAN);
    let level = |u: f64| 3.0 * u * (1.0 - u) / (1.0 - (-5.0 * u).exp());
    let rises = |u: f64| (1.0 - 2.0 * u) * (1.0 - (-5.0 * u).exp()) - 5.0 * u * (1.0 - u) * (-5.0 * u).exp();
    let top = bisect(rises, 0.1, 0.9);
    let points = || found.branches.iter().flat_map(|b| &b.branch.points);
    let fold = points()
        .find(|q| q.events.contains(&EventKind::ParameterFold) && q.x[1].abs() < 1e-9)
        .map_or(f64::NAN, |q| q.p);
    Ok(vec![
        Check::relative("p where prey appears", near(0.0), 0.6, 1e-6, CROSSED),
        Check::relative("p where predators appear", near(1.0 / 3.0), level(1.0 / 3.0), 1e-6, CROSSED),
        Check::relative("p at the fold without predators", fold, level(top), 1e-8, LOCATED),
    ])
}

fn two_cells() -> Result<Vec<Check>, Failure> {
    let rate = |s: f64| s / (1.0 + s + s * s);
    let slope = |s: f64| (1.0 - s * s) / (1.0 + s + s * s).powi(2);
    let f = move |s: &[f64], p: f64, out: &mut Linearization| {
        for (i, j) in [(0, 1), (1, 0)] {
            out.residual[i] = p - 2.0 * s[i] + s[j] - 100.0 * rate(s[i]);
            (out.jacobian[(i, i)], out.jacobian[(i, j)]) = (-2.0 - 100.0 * slope(s[i]), 1.0);
            out.jacobian[(i, 2)] = 1.0;
        }
    };
    let branch = trace(&mut Equations { n: 2, f }, &[0.0; 2], 0.0, &[(2, -1.0, 40.0)])?;
    let level = |s: f64| s + 100.0 * rate(s);
    let root = |c: f64, low: f64, high: f64| level(bisect(|s| c + 100.0 * slope(s), low, high));
    let mut checks = folds(&branch, &[root(1.0, 1.0, 2.0), root(1.0, 4.0, 12.0)], 1e-8, LOCATED);
    checks.extend(crossings(&branch, &[(root(3.0, 1.0, 2.0), 3), (root(3.0, 2.5, 12.0), 3)], 40.0));
    Ok(checks)
}

fn cusp() -> Result<Vec<Check>, Failure> {
    let mut system = planar(|x, p| [p + 1.5 * x - x.powi(3), 1.5 - 3.0 * x * x, 1.0]);
    let branch = trace(&mut system, &[-1.5], -1.125, &[(1, -2.0, 2.0)])?;
    let exact = 2.0 * 0.5_f64.powf(1.5);
    Ok(folds(&branch, &[exact, -exact], 1e-9, LOCATED))
}

fn truss() -> Result<Vec<Check>, Failure> {
    let (h, unit): (f64, f64) = (0.1, 2e8 / 8.0);
    let mut system = planar(move |w, p| {
        [unit * w * (w - h) * (w - 2.0 * h) - p, unit * (3.0 * w * w - 6.0 * h * w + 2.0 * h * h), -1.0]
    });
    let top = 2.0 * unit * h.powi(3) / (3.0 * 3.0_f64.sqrt());
    let branch = trace(&mut system, &[0.0], 0.0, &[(1, -2.0 * top, 2.0 * top)])?;
    Ok(folds(&branch, &[top, -top], 1e-8, LOCATED))
}

fn temperature() -> Result<Vec<Check>, Failure> {
    let beta = 0.01;
    let source = move |t: f64| {
        let (above, below) = (t + 0.5 * t * t, 1.0 + beta * t * t);
        [1.0 + above / below, ((1.0 + t) * below - above * 2.0 * beta * t) / (below * below)]
    };
    // ½T′² = p (G(T_m) − G(T)); with T = T_m − s² the integrand is smooth.
    let level = |top: f64| {
        let s_end = (top - beta).sqrt();
        let gained = |s: f64| integral(|t| source(t)[0], top - s * s, top, 20);
        let integrand = |s: f64| if s == 0.0 { 2.0 / source(top)[0].sqrt() } else { 2.0 * s / gained(s).sqrt() };
        2.0 * integral(integrand, 0.0, s_end, 200).powi(2)
    };
    let rises = |top: f64| level(top * 1.0001) - level(top / 1.0001);
    let exact = level(bisect(rises, 0.5, 8.0));
    let found = |n: usize| first_fold(two_point(n - 1, beta, source), beta, 10.0);
    let values = [found(20)?, found(40)?];
    let errors: Vec<(f64, f64)> = [20.0, 40.0].into_iter().zip(values.map(|p| p / exact - 1.0)).collect();
    Ok(vec![
        Check::relative("fold on 40 intervals", values[1], exact, 3e-3, "the differences, h²"),
        Check::relative(
            "extrapolated",
            (4.0 * values[1] - values[0]) / 3.0,
            exact,
            1e-5,
            "the next term of the differences, and differences of the quadrature",
        ),
        Check::order("20 to 40 intervals", -slope(&errors), 2.0, 0.1, "the next term"),
    ])
}

fn buckling() -> Result<Vec<Check>, Failure> {
    let mut system = two_point(11, 0.0, |y| [y.sin(), y.cos()]);
    let branch = trace(&mut system, &[0.0; 11], 0.0, &[(11, -1.0, 100.0)])?;
    let load = |k: f64| (4.0 * 144.0 * (k * PI / 24.0).sin().powi(2), 3);
    Ok(crossings(&branch, &[load(1.0), load(2.0), load(3.0)], 100.0))
}

fn corner() -> Result<Vec<Check>, Failure> {
    let inner = planar(|x, p| [p + x.abs() - 1.0, x.signum(), 1.0]);
    let mut system = Pieces { inner, edge: 0.0, beyond: true };
    let branch = trace(&mut system, &[0.8], 0.2, &[(0, -0.8, 1.0)])?;
    let turned = branch.points.iter().map(|q| q.p).fold(f64::NEG_INFINITY, f64::max);
    let last = branch.points.last().ok_or("no points")?;
    let events = branch.points.iter().filter(|q| q.events.contains(&EventKind::ParameterFold)).count();
    Ok(vec![
        Check::count("folds", events, 1),
        Check::relative("largest p", turned, 1.0, 1e-8, LOCATED),
        Check::relative("p at the end", last.p, 0.2, 1e-9, LOCATED),
    ])
}

fn grazing() -> Result<Vec<Check>, Failure> {
    let inner = planar(|x, p| {
        let over = (x - 1.0).max(0.0);
        [x - 3.0 * over.powf(1.5) - p, 1.0 - 4.5 * over.sqrt(), -1.0]
    });
    let mut system = Pieces { inner, edge: 1.0, beyond: false };
    let branch = trace(&mut system, &[0.5], 0.5, &[(0, 0.0, 1.3)])?;
    let x = 1.0 + 4.0_f64 / 81.0;
    Ok(folds(&branch, &[x - 3.0 * (x - 1.0).powf(1.5)], 1e-8, LOCATED))
}
