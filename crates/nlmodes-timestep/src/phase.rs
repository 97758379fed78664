use nlmodes_contact::ContactBody;
use nlmodes_linalg::{Mat, column, multiply, multiply_many};
use nlmodes_model::MasslessContactModel;

use crate::TimestepError;
use crate::oscillation::{Oscillation, cosine_and_sine, fall};
use crate::restrained::Restrained;

/// The structure as long as one set of contacts is closed: a linear system whose modes are computed once.
///
/// ```text
/// q = q_s + Φ u ,   ü_k + λ_k u_k = 0 ,   Φᵀ M Φ = I
/// ```
///
/// A steady force on motions without strain, `p_k = φ_kᵀ f`, has no equilibrium: there `ü_k + λ_k u_k = p_k`, `λ_k`
/// zero up to rounding.
///
/// Degrees of freedom at closed rigid stops are fixed there, springs of closed elastic stops are part of the structure,
/// and free massless degrees of freedom follow statically; `q_s` is the static equilibrium of this system.
#[derive(Debug, Clone)]
pub(crate) struct Phase {
    pub closed: Vec<bool>,
    /// Squared angular frequencies and angular frequencies.
    pub lambda: Vec<f64>,
    pub omega: Vec<f64>,
    /// Shapes of all degrees of freedom, n × m.
    pub shapes: Mat<f64>,
    /// `q_s`, n.
    pub offset: Vec<f64>,
    /// Strain energy at `q_s`, with that of elastic stops and of a steady force, J.
    pub strain: f64,
    /// `p_k`, m; empty where nothing falls.
    pub push: Vec<f64>,
    /// `u = T z − o`, with `z` the modal coordinates of the open structure: `T = Φᵀ M Φ_0`, orthogonal, and
    /// `o = Φᵀ M q_s`.
    pub turn: Mat<f64>,
    pub shift: Vec<f64>,
    /// Guards, which must not become negative, m: the gap of an open contact, the force of a closed one times its own
    /// compliance.
    guards: Vec<Row>,
    /// Contact forces, N.
    forces: Vec<Row>,
}

/// `r · u + c`.
#[derive(Debug, Clone)]
struct Row {
    coefficients: Vec<f64>,
    constant: f64,
}

impl Row {
    fn at(&self, u: &[f64]) -> f64 {
        self.constant + dot(&self.coefficients, u)
    }
}

/// Modal coordinates of a phase and their rates.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coordinates {
    pub u: Vec<f64>,
    pub v: Vec<f64>,
}

impl Phase {
    /// The phase of the closed contacts `closed`; `open` is the phase without closed contacts (not needed for itself).
    pub fn new(
        model: &MasslessContactModel,
        body: &ContactBody,
        closed: &[bool],
        open: Option<&Phase>,
    ) -> Result<Self, TimestepError> {
        let restrained = Restrained::new(model, closed)?;
        let modes = restrained.modes()?;
        let offset = restrained.equilibrium(&modes)?;
        let shapes = restrained.on_all(&modes.shapes);
        let reference = open.map_or(&shapes, |open| &open.shapes);
        let turn = shapes.transpose() * multiply_many(model.mass(), reference);
        let inertia = multiply(model.mass(), &offset);
        let shift: Vec<f64> = (0..shapes.ncols()).map(|k| dot(column(&shapes, k), &inertia)).collect();
        let free_gaps = free_gaps(model, reference, &turn, &shift);
        let response = body.response(closed)?;
        let a = body.matrix().a();
        let guard = |i: usize| match closed[i] {
            true => combine(&free_gaps, |j| a[(i, i)] * response.lambda[(i, j)]),
            false => combine(&free_gaps, |j| response.gaps[(i, j)]),
        };
        Ok(Self {
            closed: closed.to_vec(),
            lambda: modes.omega.iter().map(|ω| ω * ω).collect(),
            strain: restrained.strain(&offset),
            push: restrained.push(&modes),
            guards: (0..closed.len()).map(guard).collect(),
            forces: (0..closed.len()).map(|i| combine(&free_gaps, |j| response.lambda[(i, j)])).collect(),
            omega: modes.omega,
            shapes,
            offset,
            turn,
            shift,
        })
    }

    /// From modal coordinates of the open structure.
    pub fn enter(&self, z: &[f64], v: &[f64]) -> Coordinates {
        let mut at = Coordinates { u: product(&self.turn, z), v: product(&self.turn, v) };
        at.u.iter_mut().zip(&self.shift).for_each(|(u, o)| *u -= o);
        at
    }

    /// Back to modal coordinates of the open structure.
    pub fn leave(&self, at: &Coordinates) -> (Vec<f64>, Vec<f64>) {
        let absolute: Vec<f64> = at.u.iter().zip(&self.shift).map(|(u, o)| u + o).collect();
        (transposed_product(&self.turn, &absolute), transposed_product(&self.turn, &at.v))
    }

    /// The coordinates a time `t` later.
    pub fn after(&self, from: &Coordinates, t: f64) -> Coordinates {
        let mut to = from.clone();
        for k in 0..self.lambda.len() {
            let (cos, sin) = cosine_and_sine(self.omega[k], t);
            to.u[k] = from.u[k] * cos + from.v[k] * sin;
            to.v[k] = from.v[k] * cos - self.lambda[k] * sin * from.u[k];
        }
        for (k, push) in self.push.iter().enumerate().filter(|(_, push)| **push != 0.0) {
            to.u[k] += push * fall(self.omega[k], t);
            to.v[k] += push * cosine_and_sine(self.omega[k], t).1;
        }
        to
    }

    /// Accelerations `z̈` in modal coordinates of the open structure.
    pub fn acceleration(&self, at: &Coordinates) -> Vec<f64> {
        let mut own: Vec<f64> = self.lambda.iter().zip(&at.u).map(|(λ, u)| -λ * u).collect();
        own.iter_mut().zip(&self.push).for_each(|(own, push)| *own += push);
        transposed_product(&self.turn, &own)
    }

    /// Kinetic and strain energy, including that of elastic stops and of a steady force, J.
    pub fn energy(&self, at: &Coordinates) -> f64 {
        let terms = self.lambda.iter().zip(at.u.iter().zip(&at.v));
        self.strain + 0.5 * terms.map(|(λ, (u, v))| v * v + λ * u * u).sum::<f64>() - dot(&self.push, &at.u)
    }

    /// Displacements of all degrees of freedom.
    pub fn displacement(&self, at: &Coordinates) -> Vec<f64> {
        let mut q = product(&self.shapes, &at.u);
        q.iter_mut().zip(&self.offset).for_each(|(q, s)| *q += s);
        q
    }

    /// Velocities of all degrees of freedom.
    pub fn velocity(&self, at: &Coordinates) -> Vec<f64> {
        product(&self.shapes, &at.v)
    }

    /// Force of contact `i`, N; zero where it is open.
    pub fn force(&self, i: usize, at: &Coordinates) -> f64 {
        if self.closed[i] { self.forces[i].at(&at.u) } else { 0.0 }
    }

    /// Guard `i` as a function of time from now on.
    pub fn guard(&self, i: usize, at: &Coordinates) -> Oscillation<'_> {
        self.motion_of(&self.guards[i], at)
    }

    /// Force of the closed contact `i` as a function of time from now on.
    pub fn force_motion(&self, i: usize, at: &Coordinates) -> Oscillation<'_> {
        self.motion_of(&self.forces[i], at)
    }

    /// Guard `i` at static equilibrium, and per unit of mode `k`.
    pub fn guard_coefficients(&self, i: usize, k: usize) -> (f64, f64) {
        (self.guards[i].constant, self.guards[i].coefficients[k])
    }

    fn motion_of(&self, row: &Row, at: &Coordinates) -> Oscillation<'_> {
        let Row { coefficients, constant } = row;
        let times = |x: &[f64]| coefficients.iter().zip(x).map(|(r, x)| r * x).collect();
        let (lambda, omega, constant) = (&self.lambda, &self.omega, *constant);
        Oscillation { lambda, omega, a: times(&at.u), b: times(&at.v), d: times(&self.push), constant }
    }
}

/// Gaps without contact forces, `y = Wᵀ b + g₀`, as functions of the modal coordinates of a phase: the massless nodes
/// of the open structure follow statically, with displacement `b`.
fn free_gaps(model: &MasslessContactModel, open_shapes: &Mat<f64>, turn: &Mat<f64>, shift: &[f64]) -> Vec<Row> {
    let row = |contact: &nlmodes_model::DofContact| {
        let shape: Vec<f64> =
            (0..open_shapes.ncols()).map(|k| contact.direction() * open_shapes[(contact.dof, k)]).collect();
        let coefficients = product(turn, &shape);
        Row { constant: contact.gap + dot(&coefficients, shift), coefficients }
    };
    model.contacts().iter().map(row).collect()
}

fn combine(rows: &[Row], weight: impl Fn(usize) -> f64) -> Row {
    let mut sum = Row { coefficients: vec![0.0; rows.first().map_or(0, |r| r.coefficients.len())], constant: 0.0 };
    for (j, row) in rows.iter().enumerate() {
        let weight = weight(j);
        if weight != 0.0 {
            sum.constant += weight * row.constant;
            sum.coefficients.iter_mut().zip(&row.coefficients).for_each(|(s, r)| *s += weight * r);
        }
    }
    sum
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `A x`.
pub(crate) fn product(a: &Mat<f64>, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; a.nrows()];
    for (k, x) in x.iter().enumerate() {
        y.iter_mut().zip(column(a, k)).for_each(|(y, a)| *y += a * x);
    }
    y
}

/// `Aᵀ x`.
pub(crate) fn transposed_product(a: &Mat<f64>, x: &[f64]) -> Vec<f64> {
    (0..a.ncols()).map(|k| dot(column(a, k), x)).collect()
}
