use nlmodes_linalg::{DenseLu, Mat, Triplet, multiply_transposed, sparse_from_triplets};

use crate::reduction::open_modes::stops;
use crate::reduction::{GivenFlexibility, GivenModes, OpenModes, ReductionError};
use crate::{Contact, Dof, DofKind, MasslessContactModel, Side, SteadyForce, StructuralModel};

/// Relative difference up to which two directions are one.
const SAME: f64 = 1e-12;

/// Residual flexibility that is left beside the other contacts, over the static one, below which nothing is left that
/// could be pressed.
const RIGID: f64 = 1e-9;

/// The reduced equations as a structure of their own.
///
/// ```text
/// x = (η, u) ,   u = −(Y η + A f)                displacement of each direction toward its stop, f the force along it
/// M = | 1  0 | ,   K = | Ω² + Yᵀ A⁻¹ Y   Yᵀ A⁻¹ |
///     | 0  0 |         |     A⁻¹ Y        A⁻¹   |
/// ```
///
/// Its contacts are stops of single degrees of freedom without mass, so that whatever takes a structure with massless
/// contact nodes takes this one: no mass has been moved. Contacts that face each other at one place share a direction.
#[derive(Debug, Clone)]
pub struct ReducedStructure {
    model: StructuralModel,
    /// Direction of each contact, and +1, or −1 where it is met from the other side.
    direction_of: Vec<(usize, f64)>,
    /// `A⁻¹` of the directions.
    stiffness: Mat<f64>,
    /// `Y` of the directions.
    rows: Mat<f64>,
    least_share: f64,
}

impl ReducedStructure {
    /// The structure of these open modes; `places` are the node and the position (m) by which each contact is known.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`]; [`ReductionError::DependentContact`] if the motion of a contact follows from
    /// those of others, or from the retained modes alone; [`ReductionError::Model`].
    pub fn new(open: &OpenModes, places: &[(usize, f64)]) -> Result<Self, ReductionError> {
        Self::with_directions(open, places, |_| (1.0, DofKind::Contact))
    }

    /// The same of a structure along an axis with these degrees of freedom: the displacement of a contact at a single
    /// one counts as that does, not toward the stop, and keeps its name.
    ///
    /// # Errors
    /// As [`ReducedStructure::new`].
    pub fn along_axes(open: &OpenModes, places: &[(usize, f64)], dofs: &[Dof]) -> Result<Self, ReductionError> {
        Self::with_directions(open, places, |column| match column {
            // `g = g₀ + w q`: the stop is on the negative side.
            [(dof, w)] => (if *w > 0.0 { -1.0 } else { 1.0 }, dofs[*dof].kind),
            _ => (1.0, DofKind::Contact),
        })
    }

    /// `of` gives −1 for the columns of contact directions against which displacements count, and what these are.
    fn with_directions(
        open: &OpenModes,
        places: &[(usize, f64)],
        of: impl Fn(&[(usize, f64)]) -> (f64, DofKind),
    ) -> Result<Self, ReductionError> {
        let (c, m) = (open.n_contacts(), open.n_modes());
        if places.len() != c {
            return Err(ReductionError::Dimension { what: "places of the contacts", expected: c, found: places.len() });
        }
        let (first, direction_of) = directions(open);
        let lent = lent(open, &direction_of, first.len());
        let (first, mut direction_of) = apart(first, direction_of, &lent);
        let d = first.len();
        let (turned, kinds): (Vec<f64>, Vec<DofKind>) = first.iter().map(|&i| of(&column(open, i))).unzip();
        direction_of.iter_mut().for_each(|(d, sign)| *sign *= turned[*d]);
        let a = Mat::from_fn(d, d, |i, j| {
            turned[i] * turned[j] * open.flexibility()[(first[i], first[j])] + if i == j { lent[first[i]] } else { 0.0 }
        });
        let least_share = least_share(open, &first, &a)?;
        let stiffness = inverse(&a)?;
        let rows = Mat::from_fn(d, m, |i, r| turned[i] * open.contact_rows()[(first[i], r)]);
        let pressed = &stiffness * &rows;
        let entries = entries(&squares(open), &rows, &pressed, &stiffness);
        let failed = ReductionError::during("the reduced structure");
        let k = sparse_from_triplets(m + d, m + d, &entries).map_err(failed)?;
        let units: Vec<Triplet> = (0..m).map(|r| (r, r, 1.0)).collect();
        let failed = ReductionError::during("the reduced structure");
        let mass = sparse_from_triplets(m + d, m + d, &units).map_err(failed)?;
        let modal = (0..m).map(|r| Dof { node: r, position: 0.0, kind: DofKind::Modal });
        let touching = first.iter().zip(kinds);
        let touching = touching.map(|(&i, kind)| Dof { node: places[i].0, position: places[i].1, kind });
        let contacts = (0..c).map(|i| stop(open, (i, lent[i]), m, direction_of[i])).collect();
        let model = StructuralModel::new(mass, k, modal.chain(touching).collect(), contacts)?;
        Ok(Self { model, direction_of, stiffness, rows, least_share })
    }

    /// The same structure before stops with other gaps (m), one a contact.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`] for another number of gaps, [`ReductionError::Model`] for one that is not finite.
    pub fn with_gaps(&self, gaps: &[f64]) -> Result<Self, ReductionError> {
        let (expected, found) = (self.direction_of.len(), gaps.len());
        if expected != found {
            return Err(ReductionError::Dimension { what: "gaps of the contacts", expected, found });
        }
        let contacts = self.model.contacts().iter().zip(gaps);
        let contacts = contacts.map(|(of, &gap)| Contact { gap, ..of.clone() }).collect();
        Ok(Self { model: self.model.clone().with_contacts(contacts)?, ..self.clone() })
    }

    /// The same structure under the constant force that its open modes have on rigid-body motions.
    ///
    /// # Errors
    /// [`ReductionError::Model`] for open modes of another structure.
    pub fn with_force_of(&self, open: &OpenModes) -> Result<Self, ReductionError> {
        if open.steady_force().is_empty() {
            return Ok(self.clone());
        }
        let (m, d) = (self.rows.ncols(), self.rows.nrows());
        let unfelt = open.unfelt_motions();
        let felt: Vec<usize> = (0..open.n_rigid()).filter(|r| !unfelt.contains(r)).collect();
        // u = −(Y η + A f).
        let moved = |i: usize, r: usize| match i.checked_sub(m) {
            None => f64::from(u8::from(i == r)),
            Some(direction) => -self.rows[(direction, r)],
        };
        let motions = Mat::from_fn(m + d, felt.len(), |i, k| moved(i, felt[k]));
        let mut force = open.steady_force().to_vec();
        force.resize(m + d, 0.0);
        let model = self.model.clone().with_steady_force(SteadyForce { force, motions })?;
        Ok(Self { model, ..self.clone() })
    }

    /// The structure: modal coordinates, then the displacement of each direction.
    pub fn model(&self) -> &StructuralModel {
        &self.model
    }

    /// Displacements of degrees of freedom of the structure that was reduced, of coordinates `x = (η, u)`, column by
    /// column: `q = Φ η + (K⁻¹ − Φ Ω⁻² Φᵀ) W λ` with the contact forces `λ` of `u + Y η = −A f`.
    ///
    /// # Panics
    /// If `x` or `open` has another size, or there is no such degree of freedom.
    pub fn displacements(&self, open: &OpenModes, dofs: &[usize], x: &Mat<f64>) -> Mat<f64> {
        let eta = x.subrows(0, self.rows.ncols()).to_owned();
        open.displacements(dofs, &eta, &self.contact_forces(x))
    }

    /// The contact forces `λ` of coordinates `x = (η, u)`, column by column, with `u + Y η = −A f`; of contacts with
    /// the same direction the first one carries the force of all.
    ///
    /// # Panics
    /// If `x` has another size.
    pub fn contact_forces(&self, x: &Mat<f64>) -> Mat<f64> {
        let (m, d) = (self.rows.ncols(), self.rows.nrows());
        let eta = x.subrows(0, m).to_owned();
        let off = &self.rows * &eta + x.subrows(m, d);
        let forces = &self.stiffness * &off;
        let mut lambda = Mat::zeros(self.direction_of.len(), x.ncols());
        let mut carried = vec![false; d];
        for (contact, (direction, sign)) in self.direction_of.iter().enumerate() {
            if !std::mem::replace(&mut carried[*direction], true) {
                (0..x.ncols()).for_each(|j| lambda[(contact, j)] = -sign * forces[(*direction, j)]);
            }
        }
        lambda
    }

    /// The coordinates `x = (η, u)` of displacements that are a motion of the reduced structure, column by column:
    /// `η = Φᵀ M q`, and `u` the displacement along each direction. None where the mass is not known, since the
    /// structure was reduced elsewhere.
    ///
    /// # Panics
    /// If `q` or `open` has another size.
    pub fn coordinates(&self, open: &OpenModes, q: &Mat<f64>) -> Option<Mat<f64>> {
        Some(self.joined(&open.modal_coordinates(q)?, &multiply_transposed(open.directions(), q)))
    }

    /// The coordinates `x = (η, u)` of modal ones (m × any) and of what they and the contact forces open the gaps by
    /// (c × any), column by column.
    ///
    /// # Panics
    /// If one of them has another size.
    pub fn joined(&self, eta: &Mat<f64>, gaps: &Mat<f64>) -> Mat<f64> {
        let (m, d) = (self.rows.ncols(), self.rows.nrows());
        let mut x = Mat::zeros(m + d, eta.ncols());
        for j in 0..eta.ncols() {
            (0..m).for_each(|r| x[(r, j)] = eta[(r, j)]);
            for (contact, (direction, sign)) in self.direction_of.iter().enumerate() {
                x[(m + direction, j)] = -sign * gaps[(contact, j)];
            }
        }
        x
    }

    /// Least flexibility of a contact beyond the retained modes, the other contacts held, over its whole static
    /// flexibility: digits are lost in proportion to its inverse. One of a structure without contacts.
    pub fn least_share(&self) -> f64 {
        self.least_share
    }

    /// The direction of each contact, and +1, or −1 where it is met from the other side.
    pub fn direction_of(&self) -> &[(usize, f64)] {
        &self.direction_of
    }
}

/// Entry of a matrix, over those on its diagonal, up to which it is rounding.
const ROUNDING: f64 = 1e-12;

/// The modes, and the flexibility beyond them, that a [`ReducedStructure`] was made of: its model without the contact
/// nodes is diagonal. None for a model of another kind.
pub(crate) fn made_of(model: &MasslessContactModel) -> Result<Option<OpenModes>, ReductionError> {
    let (linear, dofs) = (model.linear_dofs(), model.dofs());
    let (m, n) = (linear.len(), dofs.len());
    let is_unit = |i: usize| model.mass().get(i, i).is_some_and(|mass| *mass == 1.0);
    if !linear.iter().all(|&i| dofs[i].kind == DofKind::Modal && is_unit(i)) {
        return Ok(None);
    }
    let failed = |source| ReductionError::Linalg { what: "stiffness K_NN of the contact degrees of freedom", source };
    let nodes = DenseLu::factor(model.k_nn()).map_err(failed)?;
    let (k_ll, k_ln) = (model.k_ll().to_dense(), model.k_ln());
    let follow = -nodes.solve_columns(&k_ln.transpose().to_owned());
    let left = &k_ll + k_ln * &follow;
    let size = |r: usize| k_ll[(r, r)].abs().sqrt();
    let is_diagonal = |r: usize| (0..r).all(|s| left[(r, s)].abs() <= ROUNDING * size(r) * size(s));
    if !(0..m).all(is_diagonal) {
        return Ok(None);
    }
    let square = |r: usize| if left[(r, r)] <= ROUNDING * k_ll[(r, r)] { 0.0 } else { left[(r, r)] };
    let mut order: Vec<usize> = (0..m).collect();
    order.sort_by(|a, b| square(*a).total_cmp(&square(*b)));
    let (mut rows, mut flexibility) = (Mat::zeros(n, m), Mat::zeros(n, n));
    for (mode, &r) in order.iter().enumerate() {
        rows[(linear[r], mode)] = 1.0;
        model.contact_dofs().iter().enumerate().for_each(|(d, &dof)| rows[(dof, mode)] = follow[(d, r)]);
    }
    let own = nodes.solve_columns(&Mat::identity(follow.nrows(), follow.nrows()));
    for (d, &i) in model.contact_dofs().iter().enumerate() {
        let both = model.contact_dofs().iter().enumerate();
        both.for_each(|(e, &j)| flexibility[(i, j)] = 0.5 * (own[(d, e)] + own[(e, d)]));
    }
    for contact in model.contacts() {
        flexibility[(contact.dof, contact.dof)] -= contact.lent;
    }
    let of = GivenModes {
        omega_squared: order.iter().map(|&r| square(r)).collect(),
        rows,
        flexibility: GivenFlexibility::Residual(flexibility),
    };
    let contacts: Vec<Contact> = model.contacts().iter().copied().map(Contact::from).collect();
    let (directions, gaps, mut compliance) = stops(&contacts, n)?;
    compliance.iter_mut().zip(&contacts).for_each(|(own, contact)| *own += contact.lent);
    let open = OpenModes::given(of, directions, gaps, compliance)?;
    let Some(steady) = model.steady_force() else { return Ok(Some(open)) };
    let on = |mode: usize| (0..n).map(|i| open.shapes()[(i, mode)] * steady.force[i]).sum();
    let force = (0..open.n_rigid()).map(on).collect();
    open.with_steady_force(force).map(Some)
}

/// Square, over that of the first elastic mode, of the frequency that an unfelt motion gets.
const GAUGE: f64 = 1e-6;

/// `Ω²`. Rigid-body motions that move no contact are never pushed by one: a small frequency, far below all others,
/// leaves them at rest and their mean no longer open.
fn squares(open: &OpenModes) -> Vec<f64> {
    let mut squares = open.omega_squared().to_vec();
    squares[..open.n_rigid()].fill(0.0);
    let Some(&elastic) = squares.get(open.n_rigid()) else { return squares };
    open.unfelt_motions().into_iter().for_each(|r| squares[r] = GAUGE * elastic);
    squares
}

fn entries(omega_squared: &[f64], rows: &Mat<f64>, pressed: &Mat<f64>, stiffness: &Mat<f64>) -> Vec<Triplet> {
    let (d, m) = (rows.nrows(), rows.ncols());
    let modal = rows.transpose() * pressed;
    let mut entries = Vec::new();
    for r in 0..m {
        for s in 0..m {
            let own = if r == s { omega_squared[r].max(0.0) } else { 0.0 };
            entries.push((r, s, own + 0.5 * (modal[(r, s)] + modal[(s, r)])));
        }
        for i in 0..d {
            entries.extend([(m + i, r, pressed[(i, r)]), (r, m + i, pressed[(i, r)])]);
        }
    }
    entries.extend((0..d).flat_map(|i| (0..d).map(move |j| (m + i, m + j, stiffness[(i, j)]))));
    entries
}

/// `u` grows toward the stop of the first contact of a direction: `g = g₀ − u`, and `g₀ + u` from the other side.
fn stop(open: &OpenModes, (i, lent): (usize, f64), m: usize, (direction, sign): (usize, f64)) -> Contact {
    let side = if sign > 0.0 { Side::Positive } else { Side::Negative };
    let contact = Contact::stop(m + direction, side, open.gaps()[i]);
    match open.stop_compliance()[i] {
        0.0 => contact,
        compliance => Contact { lent, ..contact.on_spring(1.0 / (compliance - lent)) },
    }
}

/// Share of the compliance of an elastic stop that its contact node takes where the structure leaves it none.
const LENT: f64 = 1e-2;

/// What each elastic stop lends to the flexibility of its node, m/N: `0 ≤ λ ⊥ g₀ + Y η + (A + C) λ ≥ 0` asks for the
/// sum of both alone, so that masses which pound each other through springs need no flexibility of their own.
fn lent(open: &OpenModes, direction_of: &[(usize, f64)], directions: usize) -> Vec<f64> {
    let least = |d: usize| {
        let own = direction_of.iter().zip(open.stop_compliance()).filter(|((direction, _), _)| *direction == d);
        own.map(|(_, compliance)| *compliance).fold(f64::INFINITY, f64::min)
    };
    let is_short = |d: usize| {
        let of = |i: &usize| direction_of[*i].0 == d;
        least(d) > 0.0
            && (0..direction_of.len()).filter(of).any(|i| open.flexibility()[(i, i)] <= LENT * LENT * LENT * least(d))
    };
    let short: Vec<bool> = (0..directions).map(is_short).collect();
    let of = |(i, (d, _)): (usize, &(usize, f64))| if short[*d] { LENT * open.stop_compliance()[i] } else { 0.0 };
    direction_of.iter().enumerate().map(of).collect()
}

/// Contacts of one direction, each with a node of its own where they lend it compliance: the spring of one does not
/// yield to the force of another.
fn apart(mut first: Vec<usize>, mut direction_of: Vec<(usize, f64)>, lent: &[f64]) -> (Vec<usize>, Vec<(usize, f64)>) {
    for (i, of) in direction_of.iter_mut().enumerate() {
        if lent[i] > 0.0 && first[of.0] != i {
            *of = (first.len(), 1.0);
            first.push(i);
        }
    }
    (first, direction_of)
}

/// The degrees of freedom along the normal of a contact, with their shares.
fn column(open: &OpenModes, contact: usize) -> Vec<(usize, f64)> {
    let w = open.directions();
    let rows = w.symbolic().row_idx_of_col_raw(contact).iter().copied();
    rows.zip(w.val_of_col(contact).iter().copied()).filter(|entry| entry.1 != 0.0).collect()
}

/// The first contact of each direction, and of each contact its direction and sign.
fn directions(open: &OpenModes) -> (Vec<usize>, Vec<(usize, f64)>) {
    let columns: Vec<Vec<(usize, f64)>> = (0..open.n_contacts()).map(|i| column(open, i)).collect();
    // Those of one direction begin at one degree of freedom.
    let mut known = std::collections::HashMap::<usize, Vec<usize>>::new();
    let (mut first, mut direction_of) = (Vec::<usize>::new(), Vec::new());
    for (i, column) in columns.iter().enumerate() {
        let beside = known.entry(column.first().map_or(usize::MAX, |entry| entry.0)).or_default();
        let same = beside.iter().find_map(|&d| Some((d, sign(column, &columns[first[d]])?)));
        direction_of.push(same.unwrap_or((first.len(), 1.0)));
        if same.is_none() {
            beside.push(first.len());
            first.push(i);
        }
    }
    (first, direction_of)
}

/// +1 or −1 where one column is the other times that.
fn sign(a: &[(usize, f64)], b: &[(usize, f64)]) -> Option<f64> {
    let size = b.iter().fold(0.0_f64, |size, entry| size.max(entry.1.abs()));
    let is = |sign: f64| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.0 == b.0 && (a.1 - sign * b.1).abs() <= SAME * size)
    };
    [1.0, -1.0].into_iter().find(|sign| is(*sign))
}

/// Least pivot of `A`, what is left of the flexibility of a contact with those before it held, over the static
/// flexibility of that contact.
fn least_share(open: &OpenModes, first: &[usize], a: &Mat<f64>) -> Result<f64, ReductionError> {
    let (mut l, n, mut least) = (a.clone(), first.len(), 1.0_f64);
    for k in 0..n {
        let elastic = open.omega_squared().iter().enumerate().filter(|(_, w)| **w > 1e-6 * open.residual.shift());
        let modal: f64 = elastic.map(|(r, w)| open.contact_rows()[(first[k], r)].powi(2) / w).sum();
        // Of an elastic stop, what it yields itself is enough.
        let whole = a[(k, k)] + if open.stop_compliance()[first[k]] > 0.0 { 0.0 } else { modal };
        let left = l[(k, k)] / whole;
        if left.is_nan() || left <= RIGID {
            return Err(ReductionError::DependentContact { contact: first[k], left, retained: open.n_modes() });
        }
        least = least.min(left);
        for i in k + 1..n {
            let factor = l[(i, k)] / l[(k, k)];
            if factor != 0.0 {
                (k..n).for_each(|j| l[(i, j)] -= factor * l[(k, j)]);
            }
        }
    }
    Ok(least)
}

fn inverse(a: &Mat<f64>) -> Result<Mat<f64>, ReductionError> {
    let n = a.nrows();
    let lu = DenseLu::factor(a).map_err(ReductionError::during("residual flexibility of the contacts"))?;
    let mut columns = Mat::zeros(n, n);
    for j in 0..n {
        let mut column: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == j))).collect();
        lu.solve_in_place(&mut column);
        columns.col_mut(j).iter_mut().zip(&column).for_each(|(to, from)| *to = *from);
    }
    Ok(Mat::from_fn(n, n, |i, j| 0.5 * (columns[(i, j)] + columns[(j, i)])))
}
