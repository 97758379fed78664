use std::cell::OnceCell;
use std::sync::Arc;

use nlmodes_linalg::{
    CommonMotions, DenseLu, LinalgError, Mat, Modes, Openness, Pencil, SparseMatrix, Written, multiply_many,
    multiply_transposed, sparse_from_triplets, symmetric_eigen, triplets,
};

use crate::reduction::residual::{Residual, Solved, blocks, dense_columns};
use crate::reduction::rest::felt_rows;
use crate::reduction::{ModeCount, ReductionError};
use crate::{Contact, ContactCoordinates, MasslessContactModel, SteadyForce, StructuralModel};

/// Up to this many numbers the residual shapes of the contact forces are kept (n × c); beyond, they are solved for
/// again where they are asked for.
const KEPT_SHAPES: usize = 1 << 21;

/// A structure with contacts, reduced to its lowest open modes and the residual flexibility of the contacts.
///
/// ```text
/// η̈_r + ω_r² η_r = y_rᵀ λ ,   g = g₀ + Y η + A λ ,   A = Wᵀ K⁻¹ W − Y Ω⁻² Yᵀ
/// ```
///
/// The mass may be that of the structure, or one without the mass of the contact nodes. With the latter and all its
/// modes, `A` is `W̄ᵀ K_NN⁻¹ W̄`, the compliance of the nodes with everything else held. `A` is symmetric and positive
/// semidefinite; it is singular where contacts share a direction, and it vanishes when all modes of a structure whose
/// contact nodes have mass are retained: then nothing without mass is left that could be pressed.
///
/// A structure that floats has its rigid-body motions among the modes, with `ω_r² = 0` up to rounding. The residual
/// flexibility is then that of loads in balance with the inertia forces of the retained modes.
#[derive(Debug, Clone)]
pub struct OpenModes {
    pub(crate) omega_squared: Vec<f64>,
    pub(crate) shapes: Mat<f64>,
    pub(crate) contact_rows: Mat<f64>,
    pub(crate) flexibility: Mat<f64>,
    pub(crate) directions: SparseMatrix,
    pub(crate) residual: Residual,
    /// `K⁻¹ W − Φ Ω⁻² Yᵀ` (n × c), of structures so small that keeping it costs nothing.
    pub(crate) residual_shapes: Option<Mat<f64>>,
    pub(crate) openness: Openness,
    pub(crate) hourglass_motions: usize,
    pub(crate) gaps: Vec<f64>,
    pub(crate) stop_compliance: Vec<f64>,
    /// Of each mode; zero for elastic ones.
    pub(crate) steady_force: Vec<f64>,
}

impl OpenModes {
    /// Reduces the structure with mass `M` and stiffness `K` (n × n) and the contact directions `W` (n × c, one column
    /// a contact, `g = g₀ + Wᵀ q`). `gaps` (m) and `stop_compliance` (m/N, zero for rigid stops) have one entry a
    /// contact.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`], [`ReductionError::NotFinite`], [`ReductionError::StopCompliance`],
    /// [`ReductionError::FrequencyLimit`], [`ReductionError::NoMode`], [`ReductionError::OnlyRigidModes`];
    /// [`ReductionError::Unstable`] if the stiffness is negative in a mode;
    /// [`ReductionError::Linalg`] if the matrices are not symmetric, the stiffness is far from positive, or modes do
    /// not converge.
    pub fn new(
        mass: impl Into<Arc<SparseMatrix>>,
        stiffness: impl Into<Arc<SparseMatrix>>,
        directions: SparseMatrix,
        gaps: Vec<f64>,
        stop_compliance: Vec<f64>,
        modes: ModeCount,
    ) -> Result<Self, ReductionError> {
        Self::known_to(mass, stiffness, directions, gaps, stop_compliance, modes, None)
    }

    /// The same of matrices of which only what was written is known: what its digits leave open of the modes is in
    /// [`OpenModes::openness`], and motions that strain nothing as far as they tell have `ω² = 0`.
    ///
    /// # Errors
    /// As [`OpenModes::new`]; [`ReductionError::Hourglass`] if a contact feels a motion that has neither stiffness nor
    /// mass. Those that none feels are left out.
    pub fn known_to(
        mass: impl Into<Arc<SparseMatrix>>,
        stiffness: impl Into<Arc<SparseMatrix>>,
        directions: SparseMatrix,
        gaps: Vec<f64>,
        stop_compliance: Vec<f64>,
        modes: ModeCount,
        written: Option<Written>,
    ) -> Result<Self, ReductionError> {
        let (mass, stiffness) = (mass.into(), stiffness.into());
        check(&stiffness, &directions, &gaps, &stop_compliance)?;
        let (held, mut common) = (OnceCell::new(), None);
        let mut pencil = pencil(&stiffness, &mass, written.as_ref());
        if let (Some(written), Err(LinalgError::NeitherStiffnessNorMass { .. })) = (&written, &pencil) {
            let found = unfelt_motions(&stiffness, &mass, &directions, written)?;
            let without = found.held(&stiffness).map_err(factorisation())?;
            pencil = self::pencil(held.get_or_init(|| without), &mass, Some(written));
            common = Some(found);
        }
        let pencil = pencil.map_err(factorisation())?;
        let (mut retained, openness) = modes.select(&pencil, stiffness.nrows())?;
        let shift = pencil.shift();
        refuse_unstable(&retained, &stiffness, shift, openness.strainless)?;
        common.iter().for_each(|common| common.take_out_of(&mut retained.vectors));
        separate_repeated(&retained.eigenvalues, &mut retained.vectors, &directions, shift)?;
        match retained.eigenvalues.last() {
            None => return Err(ReductionError::NoMode { wanted: wanted(modes) }),
            Some(&last) if last <= 1e-6 * shift && retained.eigenvalues.len() < moving(&mass) => {
                return Err(ReductionError::OnlyRigidModes { retained: retained.eigenvalues.len() });
            }
            Some(_) => {}
        }
        let residual = Residual::Solved(Solved { factor: Arc::new(pencil.into_factor()), mass, shift });
        let mut open = Self {
            contact_rows: felt_rows(&directions, &retained.vectors),
            flexibility: Mat::zeros(gaps.len(), gaps.len()),
            omega_squared: retained.eigenvalues,
            shapes: retained.vectors,
            residual_shapes: None,
            openness,
            hourglass_motions: common.map_or(0, |common| common.len()),
            directions,
            residual,
            steady_force: Vec::new(),
            gaps,
            stop_compliance,
        };
        open.press_contacts();
        Ok(open)
    }

    /// Standard deviation that the digits of the matrices leave of the frequency of a mode (from 1), over that
    /// frequency; none where the digits are not known, or the mode strains nothing.
    pub fn left_open(&self, mode: usize) -> Option<f64> {
        let mode = mode.checked_sub(1)?;
        let square = self.omega_squared.get(mode).copied().filter(|square| *square > 0.0)?;
        self.openness.deviations.get(mode).map(|deviation| 0.5 * deviation / square)
    }

    /// Whether there are no other modes: as many as degrees of freedom with mass. Not known of a structure that was
    /// reduced elsewhere.
    pub fn has_all_modes(&self) -> bool {
        self.residual.mass().is_some_and(|mass| moving(mass) <= self.n_modes())
    }

    /// Reduces `model` with its mass as it is.
    ///
    /// # Errors
    /// As [`OpenModes::new`].
    pub fn of_model(model: &StructuralModel, modes: ModeCount) -> Result<Self, ReductionError> {
        let open = Self::of_parts(model.shared_mass(), model.shared_stiffness(), model.contacts(), modes)?;
        open.with_force_of(model.steady_force().map(AsRef::as_ref))
    }

    /// Reduces `model` with the mass that it left after that of its contact nodes has been taken away.
    ///
    /// # Errors
    /// As [`OpenModes::new`].
    pub fn of_massless(model: &MasslessContactModel, modes: ModeCount) -> Result<Self, ReductionError> {
        let contacts: Vec<Contact> = model.contacts().iter().copied().map(Contact::from).collect();
        let open = Self::of_parts(Arc::new(model.mass().clone()), model.shared_stiffness(), &contacts, modes)?;
        open.with_force_of(model.steady_force())
    }

    /// All modes of `model` with the mass that it left after that of its contact nodes has been taken away. Of a
    /// [`ReducedStructure`](crate::reduction::ReducedStructure) they are those that it was made of.
    ///
    /// Contact nodes without mass follow the others and their own contact forces, eq. (13), as
    /// `q_N = b + K_NN⁻¹ W λ`, `b = −K_NN⁻¹ K_NL q_L`. So eqs. (6) to (16) are those of free-interface modes with
    ///
    /// ```text
    /// (K_LL − K_LN K_NN⁻¹ K_NL) φ_k = ω_k² M_LL φ_k ,   Y = −Wᵀ K_NN⁻¹ K_NL Φ ,   A = Wᵀ K_NN⁻¹ W
    /// ```
    ///
    /// and where the coordinates are the tips of contact springs, with `A = 0`: their compliance is that of the stops.
    ///
    /// # Errors
    /// As [`OpenModes::new`].
    pub fn all_of_massless(model: &MasslessContactModel) -> Result<Self, ReductionError> {
        if let Some(open) = crate::reduction::reduced::made_of(model)? {
            return Ok(open);
        }
        let mut open = Self::of_massless(model, ModeCount::Lowest(moving(model.mass())))?;
        if open.n_modes() == model.linear_dofs().len() {
            // Nothing but the nodes themselves answers statically: no difference of larger numbers.
            let pressed = match model.contact_coordinates() {
                ContactCoordinates::Nodes => DenseLu::factor(model.k_nn())
                    .map_err(ReductionError::during("stiffness K_NN of the contact degrees of freedom"))?
                    .solve_columns(model.w()),
                ContactCoordinates::SpringTips => Mat::zeros(model.w().nrows(), model.w().ncols()),
            };
            let a = model.w().transpose() * &pressed;
            open.flexibility = Mat::from_fn(a.nrows(), a.ncols(), |i, j| 0.5 * (a[(i, j)] + a[(j, i)]));
            if let (Some(shapes), ContactCoordinates::Nodes) = (&mut open.residual_shapes, model.contact_coordinates())
            {
                shapes.fill(0.0);
                for (row, &dof) in model.contact_dofs().iter().enumerate() {
                    (0..pressed.ncols()).for_each(|i| shapes[(dof, i)] = pressed[(row, i)]);
                }
            }
        }
        Ok(open)
    }

    /// The same structure under the constant force that its model has, on its rigid-body motions.
    fn with_force_of(self, steady: Option<&SteadyForce>) -> Result<Self, ReductionError> {
        let Some(steady) = steady else { return Ok(self) };
        let on = |r: usize| steady.force.iter().enumerate().map(|(i, force)| self.shapes[(i, r)] * force).sum();
        let force = (0..self.n_rigid()).map(on).collect();
        self.with_steady_force(force)
    }

    fn of_parts(
        mass: Arc<SparseMatrix>,
        stiffness: Arc<SparseMatrix>,
        contacts: &[Contact],
        modes: ModeCount,
    ) -> Result<Self, ReductionError> {
        let (directions, gaps, compliance) = stops(contacts, stiffness.nrows())?;
        Self::new(mass, stiffness, directions, gaps, compliance, modes)
    }

    /// Residual flexibility of the contacts, and the shapes that go with it if they are small: otherwise half a
    /// solution will do, and that only where the contacts reach.
    pub(crate) fn press_contacts(&mut self) {
        let (n, c) = (self.shapes.nrows(), self.gaps.len());
        let mut kept = (n * c <= KEPT_SHAPES).then(|| Mat::zeros(n, c));
        if kept.is_none()
            && let Some(flexibility) = self.residual.form(&self.shapes, &self.contact_rows, &self.directions)
        {
            self.flexibility = flexibility;
            return;
        }
        let (mut flexibility, beside) = (Mat::zeros(c, c), self.residual.beside(&self.shapes));
        for block in blocks(c) {
            let (first, count) = (block.start, block.len());
            let shapes = beside.answer(dense_columns(&self.directions, block));
            flexibility.subcols_mut(first, count).copy_from(&multiply_transposed(&self.directions, &shapes));
            if let Some(kept) = &mut kept {
                kept.subcols_mut(first, count).copy_from(&shapes);
            }
        }
        self.flexibility = Mat::from_fn(c, c, |i, j| 0.5 * (flexibility[(i, j)] + flexibility[(j, i)]));
        self.residual_shapes = kept;
    }

    /// The same structure with only the lowest `count` of these modes; the others join what answers statically. Nothing
    /// is solved again: what comes out next to the full one gives the error of the truncation. `A` grows by
    /// `Σ y_r y_rᵀ/ω_r²` of the modes that go.
    ///
    /// # Errors
    /// [`ReductionError::NoMode`] for none, [`ReductionError::OnlyRigidModes`] if only rigid-body motions would stay.
    pub fn truncated(&self, count: usize) -> Result<Self, ReductionError> {
        let count = count.min(self.n_modes());
        let Some(last) = count.checked_sub(1) else { return Err(ReductionError::NoMode { wanted: 0 }) };
        if count < self.n_modes() && self.omega_squared[last] <= 1e-6 * self.residual.shift() {
            return Err(ReductionError::OnlyRigidModes { retained: count });
        }
        let mut fewer = self.clone();
        for r in count..self.n_modes() {
            let weight = 1.0 / self.omega_squared[r];
            fewer.residual.take_over(&self.shapes, r, self.omega_squared[r]);
            let y = |i: usize| self.contact_rows[(i, r)];
            for j in 0..self.n_contacts() {
                (0..self.n_contacts()).for_each(|i| fewer.flexibility[(i, j)] += weight * (y(i) * y(j)));
                if let Some(shapes) = &mut fewer.residual_shapes {
                    (0..shapes.nrows()).for_each(|i| shapes[(i, j)] += weight * self.shapes[(i, r)] * y(j));
                }
            }
        }
        fewer.omega_squared.truncate(count);
        fewer.steady_force.truncate(count);
        fewer.openness = self.openness.of_lowest(count);
        fewer.shapes = self.shapes.subcols(0, count).to_owned();
        fewer.contact_rows = self.contact_rows.subcols(0, count).to_owned();
        Ok(fewer)
    }

    /// The same structure before stops with other `gaps` (m) and `stop_compliance` (m/N), one entry a contact. Modes
    /// and flexibility do not depend on them: nothing is solved again.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`], [`ReductionError::NotFinite`], [`ReductionError::StopCompliance`].
    pub fn with_stops(&self, gaps: Vec<f64>, stop_compliance: Vec<f64>) -> Result<Self, ReductionError> {
        check_stops(&self.directions, &gaps, &stop_compliance)?;
        Ok(Self { gaps, stop_compliance, ..self.clone() })
    }

    /// The same structure under a constant force on its rigid-body motions, `p = Φᵀ f` (N/√kg, one entry for each of
    /// them), that its contacts alone can balance. Those that no contact feels are left at rest.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`], [`ReductionError::NotFinite`]; [`ReductionError::FallsUnfelt`] for a force on
    /// motions that no contact feels.
    pub fn with_steady_force(mut self, mut force: Vec<f64>) -> Result<Self, ReductionError> {
        same_size("steady forces on rigid-body motions", self.n_rigid(), force.len())?;
        all_finite("steady force on rigid-body motion", &force)?;
        let largest = force.iter().fold(0.0_f64, |largest, p| largest.max(p.abs()));
        let unfelt: Vec<usize> = self.unfelt_motions();
        if unfelt.iter().any(|&r| force[r].abs() > UNDRIVEN * largest) {
            return Err(ReductionError::FallsUnfelt { motion: self.combined(&unfelt, &force) });
        }
        unfelt.iter().for_each(|&r| force[r] = 0.0);
        force.resize(self.n_modes(), 0.0);
        self.steady_force = force;
        Ok(self)
    }

    /// Displacements of all degrees of freedom in these modes, each as far as it is driven; the largest is one.
    pub(crate) fn combined(&self, modes: &[usize], driven: &[f64]) -> Vec<f64> {
        let of = |i: usize| modes.iter().map(|&r| self.shapes[(i, r)] * driven[r]).sum::<f64>();
        let moved: Vec<f64> = (0..self.n_dofs()).map(of).collect();
        let largest = moved.iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
        moved.into_iter().map(|v| if largest > 0.0 { v / largest } else { v }).collect()
    }

    /// The constant force on each mode, `p`, m, N/√kg, zero for elastic ones; empty where there is none.
    pub fn steady_force(&self) -> &[f64] {
        &self.steady_force
    }

    /// Number of retained modes m.
    pub fn n_modes(&self) -> usize {
        self.omega_squared.len()
    }

    /// What the digits of the matrices leave open of the retained modes; nothing where they are not known.
    pub fn openness(&self) -> &Openness {
        &self.openness
    }

    /// Motions with neither stiffness nor mass that were left out, since no contact feels them.
    pub fn hourglass_motions(&self) -> usize {
        self.hourglass_motions
    }

    /// Number of contacts c.
    pub fn n_contacts(&self) -> usize {
        self.gaps.len()
    }

    /// Number of degrees of freedom n of the structure that was reduced.
    pub fn n_dofs(&self) -> usize {
        self.shapes.nrows()
    }

    /// `ω_r²`, ascending, rad²/s²; zero for rigid-body motions, up to rounding.
    pub fn omega_squared(&self) -> &[f64] {
        &self.omega_squared
    }

    /// Modal coordinates `η = Φᵀ M q` of displacements (n × any), column by column; none where the mass is not known,
    /// since the structure was reduced elsewhere.
    ///
    /// # Panics
    /// If `q` has another size.
    pub fn modal_coordinates(&self, q: &Mat<f64>) -> Option<Mat<f64>> {
        Some(self.shapes.transpose() * multiply_many(self.residual.mass()?, q))
    }

    /// `Φ`, n × m, mass-normalised; the largest component of each mode is positive.
    pub fn shapes(&self) -> &Mat<f64> {
        &self.shapes
    }

    /// `Y = Wᵀ Φ`, c × m, 1/√kg: how each mode moves the gaps.
    pub fn contact_rows(&self) -> &Mat<f64> {
        &self.contact_rows
    }

    /// `A = Wᵀ K⁻¹ W − Y Ω⁻² Yᵀ`, c × c, m/N: residual flexibility, without the stops' own compliance.
    pub fn flexibility(&self) -> &Mat<f64> {
        &self.flexibility
    }

    /// Displacement of the degree of freedom `dof` under a unit force along it, beyond the retained modes, m/N.
    ///
    /// # Panics
    /// If there is no such degree of freedom.
    pub fn residual_flexibility(&self, dof: usize) -> f64 {
        let unit = Mat::from_fn(self.n_dofs(), 1, |i, _| f64::from(u8::from(i == dof)));
        self.residual_answer(unit)[(dof, 0)]
    }

    /// `W`, n × c: `g = g₀ + Wᵀ q`.
    pub fn directions(&self) -> &SparseMatrix {
        &self.directions
    }

    /// Clearances at rest `g₀`, m, one a contact; negative where the stop presses.
    pub fn gaps(&self) -> &[f64] {
        &self.gaps
    }

    /// Compliance `C` of the stops, m/N, one a contact; zero where they are rigid.
    pub fn stop_compliance(&self) -> &[f64] {
        &self.stop_compliance
    }
}

/// Share of a steady force that may act on motions which no contact feels: digits of files mix some of the others into
/// these.
const UNDRIVEN: f64 = 1e-6;

/// Degrees of freedom with mass: a row without any on the diagonal has none beside it.
fn moving(mass: &SparseMatrix) -> usize {
    (0..mass.nrows()).filter(|&i| mass.get(i, i).is_some_and(|m| *m != 0.0)).count()
}

/// Directions `W` (n × c), gaps and compliances of contacts.
pub(crate) fn stops(contacts: &[Contact], dofs: usize) -> Result<(SparseMatrix, Vec<f64>, Vec<f64>), ReductionError> {
    let column =
        |(i, c): (usize, &Contact)| c.normal.entries().iter().map(move |&(dof, w)| (dof, i, w)).collect::<Vec<_>>();
    let entries: Vec<_> = contacts.iter().enumerate().flat_map(column).collect();
    let directions = sparse_from_triplets(dofs, contacts.len(), &entries)
        .map_err(ReductionError::during("directions of the contacts"))?;
    Ok((directions, contacts.iter().map(|c| c.gap).collect(), contacts.iter().map(|c| c.law.compliance()).collect()))
}

fn factorisation() -> impl FnOnce(LinalgError) -> ReductionError {
    ReductionError::during("factorisation of the open structure")
}

fn pencil<'a>(
    stiffness: &'a SparseMatrix,
    mass: &'a SparseMatrix,
    written: Option<&Written>,
) -> Result<Pencil<'a>, LinalgError> {
    let known = |written: &Written| Pencil::known_to(stiffness, mass, written.clone());
    written.map_or_else(|| Pencil::new(stiffness, mass), known)
}

/// Motions with neither stiffness nor mass, which no contact may feel.
fn unfelt_motions(
    stiffness: &SparseMatrix,
    mass: &SparseMatrix,
    directions: &SparseMatrix,
    written: &Written,
) -> Result<CommonMotions, ReductionError> {
    let found = CommonMotions::of(stiffness, mass, written).map_err(factorisation())?;
    match found.felt_by(directions) {
        Some(contact) => Err(ReductionError::Hourglass { contact, motions: found.len() }),
        None => Ok(found),
    }
}

/// A motion that strains nothing has energies that cancel each other to this share: entries of a file have ten digits
/// at least.
const CANCELLED: f64 = 1e-9;

/// The eigenvalues are never negative, but `φᵀ K φ` is where a preload takes more stiffness than there is.
fn refuse_unstable(
    modes: &Modes,
    stiffness: &SparseMatrix,
    shift: f64,
    strainless: usize,
) -> Result<(), ReductionError> {
    let suspects = modes.eigenvalues.iter().take_while(|value| shift > 0.0 && **value <= 1e-6 * shift).count();
    for mode in strainless..suspects {
        let shape = modes.vectors.col(mode);
        let products = || triplets(stiffness).map(|(i, j, k)| shape[i] * k * shape[j]);
        let (energy, size) = (products().sum::<f64>(), products().map(f64::abs).sum::<f64>());
        if energy < -CANCELLED * size && energy < -1e-6 * shift {
            return Err(ReductionError::Unstable { mode: mode + 1, omega_squared: energy });
        }
    }
    Ok(())
}

/// Relative difference below which two eigenvalues count as one.
const REPEATED: f64 = 1e-9;

/// Among modes with the same frequency (equal bodies, square plates), takes those that move the contacts apart from
/// those that do not, the strongest first: any of their combinations is a mode, but only these are limits of nonlinear
/// modes.
pub(crate) fn separate_repeated(
    values: &[f64],
    vectors: &mut Mat<f64>,
    directions: &SparseMatrix,
    shift: f64,
) -> Result<(), ReductionError> {
    let is_same = |a: f64, b: f64| b - a <= REPEATED * b.abs() || b.abs().max(a.abs()) <= 1e-6 * shift;
    let mut first = if directions.ncols() == 0 { values.len() } else { 0 };
    while first < values.len() {
        let same = values[first..].iter().take_while(|value| is_same(values[first], **value)).count().max(1);
        if same > 1 {
            let shapes = vectors.subcols(first, same).to_owned();
            let rows = multiply_transposed(directions, &shapes);
            let strength = rows.transpose() * &rows;
            let symmetric = Mat::from_fn(same, same, |i, j| 0.5 * (strength[(i, j)] + strength[(j, i)]));
            let (_, turn) = symmetric_eigen(&symmetric).map_err(ReductionError::during("modes with one frequency"))?;
            let strongest_first = Mat::from_fn(same, same, |i, j| turn[(i, same - 1 - j)]);
            let turned = shapes * strongest_first;
            for j in 0..same {
                let column = turned.col(j);
                let largest = column.iter().fold(0.0_f64, |l, v| if v.abs() > l.abs() { *v } else { l });
                let sign = if largest < 0.0 { -1.0 } else { 1.0 };
                let to = vectors.col_mut(first + j);
                to.iter_mut().zip(column.iter()).for_each(|(to, from)| *to = sign * from);
            }
        }
        first += same;
    }
    Ok(())
}

fn wanted(modes: ModeCount) -> usize {
    match modes {
        ModeCount::Lowest(count) => count,
        ModeCount::UpTo(_) | ModeCount::Beyond { .. } => 1,
    }
}

pub(crate) fn same_size(what: &'static str, expected: usize, found: usize) -> Result<(), ReductionError> {
    if expected == found { Ok(()) } else { Err(ReductionError::Dimension { what, expected, found }) }
}

pub(crate) fn all_finite(what: &'static str, values: &[f64]) -> Result<(), ReductionError> {
    match values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        Some((index, &value)) => Err(ReductionError::NotFinite { what, index, value }),
        None => Ok(()),
    }
}

fn check(k: &SparseMatrix, w: &SparseMatrix, gaps: &[f64], compliance: &[f64]) -> Result<(), ReductionError> {
    same_size("rows of the contact directions", k.nrows(), w.nrows())?;
    all_finite("entry of the contact directions", w.val())?;
    check_stops(w, gaps, compliance)
}

pub(crate) fn check_stops(w: &SparseMatrix, gaps: &[f64], compliance: &[f64]) -> Result<(), ReductionError> {
    same_size("gaps of the contacts", w.ncols(), gaps.len())?;
    same_size("compliances of the stops", w.ncols(), compliance.len())?;
    all_finite("gap of contact", gaps)?;
    match compliance.iter().enumerate().find(|(_, v)| !(v.is_finite() && **v >= 0.0)) {
        Some((contact, &value)) => Err(ReductionError::StopCompliance { contact, value }),
        None => Ok(()),
    }
}
