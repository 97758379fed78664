use nlmodes_contact::ContactBody;
use nlmodes_linalg::{Mat, SparseCholesky, SparseMatrix, bilinear, multiply, select, sparse_from_triplets, triplets};
use nlmodes_model::{ContactCoordinates, ContactLaw, LinearModes, MasslessContactModel, linear_modes};

use crate::TimestepError;
use crate::oscillation::{Oscillation, cosine_and_sine};

/// The structure while one set of contacts stays closed: a linear system, taken apart into its modes once.
///
/// ```text
/// q = q_s + Φ u ,   ü_k + λ_k u_k = 0 ,   Φᵀ M Φ = I
/// ```
///
/// Degrees of freedom at closed rigid stops are held at these, springs of closed elastic stops belong to the structure, and massless
/// degrees of freedom that are free follow statically; `q_s` is the static equilibrium of all that.
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
    /// Strain energy at `q_s`, with that of elastic stops, J.
    pub strain: f64,
    /// `u = T z − o`, with `z` the modal coordinates of the open structure: `T = Φᵀ M Φ_0`, orthogonal, and `o = Φᵀ M q_s`.
    pub turn: Mat<f64>,
    pub shift: Vec<f64>,
    /// What must not turn negative, m: the gap of an open contact, the force of a closed one times its own compliance.
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
    /// The phase of the closed contacts `closed`; `open` is that without any, which itself needs none.
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
        let turn = shapes.transpose() * mass_times(model.mass(), reference);
        let mut inertia = vec![0.0; offset.len()];
        multiply(model.mass(), &offset, &mut inertia);
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
        to
    }

    /// Accelerations `z̈` in modal coordinates of the open structure.
    pub fn acceleration(&self, at: &Coordinates) -> Vec<f64> {
        let own: Vec<f64> = self.lambda.iter().zip(&at.u).map(|(λ, u)| -λ * u).collect();
        transposed_product(&self.turn, &own)
    }

    /// Kinetic and strain energy, that of elastic stops included, J.
    pub fn energy(&self, at: &Coordinates) -> f64 {
        let terms = self.lambda.iter().zip(at.u.iter().zip(&at.v));
        self.strain + 0.5 * terms.map(|(λ, (u, v))| v * v + λ * u * u).sum::<f64>()
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

    /// Guard `i` from now on.
    pub fn guard(&self, i: usize, at: &Coordinates) -> Oscillation<'_> {
        let Row { coefficients, constant } = &self.guards[i];
        let times = |x: &[f64]| coefficients.iter().zip(x).map(|(r, x)| r * x).collect();
        Oscillation { lambda: &self.lambda, omega: &self.omega, a: times(&at.u), b: times(&at.v), constant: *constant }
    }
}

/// The structure with the closed contacts of a phase.
struct Restrained<'m> {
    model: &'m MasslessContactModel,
    free: Vec<usize>,
    /// Held degrees of freedom and where.
    held: Vec<(usize, f64)>,
    /// Springs of closed elastic stops: degree of freedom, stiffness, place where they are relaxed.
    springs: Vec<(usize, f64, f64)>,
    mass: SparseMatrix,
    stiffness: SparseMatrix,
    massless: Vec<usize>,
}

impl<'m> Restrained<'m> {
    fn new(model: &'m MasslessContactModel, closed: &[bool]) -> Result<Self, TimestepError> {
        let failed = TimestepError::during("structure with closed contacts");
        let (mut held, mut springs) = (Vec::new(), Vec::new());
        for contact in model.contacts().iter().zip(closed).filter(|(_, closed)| **closed).map(|(contact, _)| contact) {
            let place = contact.side.sign() * contact.gap;
            match contact.law {
                ContactLaw::Rigid => held.push((contact.dof, place)),
                ContactLaw::Elastic { stiffness } => springs.push((contact.dof, stiffness, place)),
            }
        }
        let n = model.dofs().len();
        let free: Vec<usize> = (0..n).filter(|i| held.iter().all(|(dof, _)| dof != i)).collect();
        let grounded = springs.iter().map(|&(dof, k, _)| (dof, dof, k));
        let entries: Vec<_> = triplets(model.stiffness()).chain(grounded).collect();
        let stiffness = sparse_from_triplets(n, n, &entries).map_err(&failed)?;
        let massless = match model.contact_coordinates() {
            ContactCoordinates::Nodes => model.contact_dofs().to_vec(),
            ContactCoordinates::SpringTips => Vec::new(),
        };
        let mass = select(model.mass(), &free, &free).map_err(&failed)?;
        let massless = massless.into_iter().filter(|dof| free.contains(dof)).collect();
        Ok(Self { model, free, held, springs, mass, stiffness, massless })
    }

    fn modes(&self) -> Result<LinearModes, TimestepError> {
        let stiffness = self.free_stiffness()?;
        Ok(linear_modes(&self.mass, &stiffness, self.free.len())?)
    }

    fn free_stiffness(&self) -> Result<SparseMatrix, TimestepError> {
        select(&self.stiffness, &self.free, &self.free)
            .map_err(TimestepError::during("structure with closed contacts"))
    }

    /// Static equilibrium of all degrees of freedom.
    ///
    /// Where a rigid motion is left, the load does no work on it: held degrees of freedom and springs do not move in it.
    fn equilibrium(&self, modes: &LinearModes) -> Result<Vec<f64>, TimestepError> {
        let n = self.model.dofs().len();
        let mut q = vec![0.0; n];
        self.held.iter().for_each(|&(dof, place)| q[dof] = place);
        let mut load = vec![0.0; n];
        multiply(&self.stiffness, &q, &mut load);
        load.iter_mut().for_each(|f| *f = -*f);
        self.springs.iter().for_each(|&(dof, k, place)| load[dof] += k * place);
        let mut x: Vec<f64> = self.free.iter().map(|&i| load[i]).collect();
        if x.iter().all(|f| *f == 0.0) {
            return Ok(q);
        }
        match SparseCholesky::factor(&self.free_stiffness()?, "stiffness with closed contacts") {
            Ok(factor) => factor.solve_in_place(&mut x),
            Err(_) => x = self.modal_equilibrium(modes, &x)?,
        }
        self.free.iter().zip(&x).for_each(|(&dof, x)| q[dof] = *x);
        Ok(q)
    }

    /// The equilibrium without rigid motion, from the elastic modes and the massless degrees of freedom.
    fn modal_equilibrium(&self, modes: &LinearModes, load: &[f64]) -> Result<Vec<f64>, TimestepError> {
        let highest = modes.omega.last().copied().unwrap_or(0.0);
        let mut x = vec![0.0; load.len()];
        for k in (0..modes.omega.len()).filter(|&k| modes.omega[k] > 1e-7 * highest) {
            let shape = column(&modes.shapes, k);
            let coordinate = dot(shape, load) / (modes.omega[k] * modes.omega[k]);
            x.iter_mut().zip(shape).for_each(|(x, s)| *x += coordinate * s);
        }
        if !self.massless.is_empty() {
            let failed = TimestepError::during("statics of massless nodes");
            let block = select(&self.stiffness, &self.massless, &self.massless).map_err(&failed)?;
            let places: Vec<usize> =
                self.massless.iter().filter_map(|dof| self.free.binary_search(dof).ok()).collect();
            let mut own: Vec<f64> = places.iter().map(|&i| load[i]).collect();
            SparseCholesky::factor(&block, "stiffness of the massless nodes").map_err(&failed)?.solve_in_place(&mut own);
            places.iter().zip(&own).for_each(|(&i, own)| x[i] += own);
        }
        Ok(x)
    }

    /// Rows of zeros for what is held.
    fn on_all(&self, shapes: &Mat<f64>) -> Mat<f64> {
        let mut all = Mat::zeros(self.model.dofs().len(), shapes.ncols());
        for k in 0..shapes.ncols() {
            self.free.iter().enumerate().for_each(|(i, &dof)| all[(dof, k)] = shapes[(i, k)]);
        }
        all
    }

    /// Strain energy of the structure and of the closed stops' springs.
    fn strain(&self, q: &[f64]) -> f64 {
        let springs: f64 = self.springs.iter().map(|&(dof, k, place)| k * (q[dof] - place).powi(2)).sum();
        0.5 * (bilinear(q, self.model.stiffness(), q) + springs)
    }
}

/// Gaps that there would be without contact forces, `y = Wᵀ b + g₀`, over the modal coordinates of a phase: the open structure's massless
/// nodes follow statically, so that their displacement is `b`.
fn free_gaps(model: &MasslessContactModel, open_shapes: &Mat<f64>, turn: &Mat<f64>, shift: &[f64]) -> Vec<Row> {
    let row = |contact: &nlmodes_model::Contact| {
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

fn mass_times(mass: &SparseMatrix, shapes: &Mat<f64>) -> Mat<f64> {
    let mut all = Mat::zeros(shapes.nrows(), shapes.ncols());
    let mut one = vec![0.0; shapes.nrows()];
    for k in 0..shapes.ncols() {
        multiply(mass, column(shapes, k), &mut one);
        all.col_mut(k).iter_mut().zip(&one).for_each(|(a, x)| *a = *x);
    }
    all
}

/// Column `k` as a slice.
pub(crate) fn column(a: &Mat<f64>, k: usize) -> &[f64] {
    a.col(k).try_as_col_major().expect("columns of a Mat are contiguous").as_slice()
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
