use num_complex::Complex64;

use super::structure::ModalStructure;

/// The modes of a structure without damping and load in motions that are even in time, where `D_k = ω_k² − ν²` is
/// real, in the order of their frequencies and laid out for sums over all of them.
///
/// ```text
/// G = Σ_k y_k y_kᵀ/D_k ,   η_k = y_kᵀ λ/D_k ,   t = Σ_k y_k η_k/D_k ,   e = Σ_k η_k² ,   s = Σ_k η_k²/D_k
/// ```
///
/// From `G` follow the motions of the contacts, with `dG/dν² λ = t`, and from `e` their kinetic energy, with
/// `de/dν² = 2 s` and `de/dλ = 2 t`. One pass over the modes makes all of them.
pub(crate) struct ModeSums {
    /// The modes that move a contact and have mass.
    modes: Vec<usize>,
    squares: Vec<f64>,
    /// `s_k`, how strongly each takes part in the motion of the contacts.
    coupling: Vec<f64>,
    /// `y_ik` of all modes for one coordinate after the other; where there is only one, `y_k²`.
    rows: Vec<f64>,
    /// `G` of the coordinates without mass, and of the residual flexibility.
    massless: Vec<f64>,
    /// `1/D_k`, `η_k`, and `y_ik/D_k` of all coordinates.
    inverse: Vec<f64>,
    eta: Vec<f64>,
    scaled: Vec<f64>,
    pub sums: Sums,
}

/// The sums at one frequency.
#[derive(Default)]
pub(crate) struct Sums {
    /// `G`, c × c, row-major and symmetric.
    pub g: Vec<f64>,
    /// `t`, c.
    pub t: Vec<f64>,
    /// `e` and `s`.
    pub energy: [f64; 2],
}

impl ModeSums {
    /// Of coordinates that move as these contacts do, and of laws behind them; `residual` (c × c) is their flexibility
    /// beyond the modes, or empty.
    pub fn new(structure: &ModalStructure, contacts: &[usize], residual: &[f64]) -> Self {
        let c = contacts.len() + structure.laws().len();
        let y = |i: usize, k: usize| match i.checked_sub(contacts.len()) {
            None => structure.rows()[(contacts[i], k)],
            Some(l) => structure.laws()[l].modes[k],
        };
        let moving = (0..structure.n_modes()).filter(|&k| structure.moves_a_contact(k));
        let (mut modes, springs): (Vec<usize>, Vec<usize>) = moving.partition(|&k| structure.inertia()[k] > 0.0);
        modes.sort_by(|a, b| structure.omega_squared()[*a].total_cmp(&structure.omega_squared()[*b]));
        let of_springs =
            |i: usize, j: usize| springs.iter().map(|&k| y(i, k) * y(j, k) / structure.omega_squared()[k]).sum::<f64>();
        let pairs = (0..c).flat_map(|i| (0..c).map(move |j| (i, j)));
        let rows = (0..c).flat_map(|i| modes.iter().map(move |&k| (i, k)));
        Self {
            squares: modes.iter().map(|&k| structure.omega_squared()[k]).collect(),
            coupling: modes.iter().map(|&k| structure.coupling(k)).collect(),
            massless: pairs.map(|(i, j)| of_springs(i, j) + residual.get(i * c + j).unwrap_or(&0.0)).collect(),
            rows: rows.map(|(i, k)| if c == 1 { y(i, k).powi(2) } else { y(i, k) }).collect(),
            inverse: vec![0.0; modes.len()],
            eta: vec![0.0; modes.len()],
            scaled: vec![0.0; c * modes.len()],
            sums: Sums { g: vec![0.0; c * c], t: vec![0.0; c], energy: [0.0; 2] },
            modes,
        }
    }

    /// The sums at the squared frequency `nu2` for the forces `λ` (c, all real) over all modes but the more resonant
    /// one of the two around it; that mode, and the number of the others below `nu2`.
    pub fn set(&mut self, nu2: f64, force: &[Complex64]) -> Option<(usize, usize)> {
        let passed = self.squares.partition_point(|square| *square < nu2);
        let resonance = |k: &usize| self.coupling[*k] / (self.squares[*k] - nu2).abs();
        let neighbours = passed.saturating_sub(1)..(passed + 1).min(self.squares.len());
        let apart = neighbours.max_by(|i, j| resonance(i).total_cmp(&resonance(j)));
        self.sums.g.copy_from_slice(&self.massless);
        match force {
            [force] => self.sum_scalars(nu2, force.re, apart),
            _ => self.sum_rows(nu2, force, apart),
        }
        apart.map(|k| (self.modes[k], passed - usize::from(k < passed)))
    }

    /// For one coordinate, where `t`, `e` and `s` are sums of `y²` over powers of `D`.
    fn sum_scalars(&mut self, nu2: f64, force: f64, apart: Option<usize>) {
        let end = apart.unwrap_or(self.squares.len());
        let behind = (end + 1).min(self.squares.len());
        let below = powers(&self.squares[..end], &self.rows[..end], nu2);
        let above = powers(&self.squares[behind..], &self.rows[behind..], nu2);
        let [first, second, third] = [0, 1, 2].map(|i| below[i] + above[i]);
        self.sums.g[0] += first;
        self.sums.t[0] = second * force;
        self.sums.energy = [second * force * force, third * force * force];
    }

    fn sum_rows(&mut self, nu2: f64, force: &[Complex64], apart: Option<usize>) {
        let (c, m) = (force.len(), self.modes.len());
        self.inverse.iter_mut().zip(&self.squares).for_each(|(inverse, square)| *inverse = 1.0 / (square - nu2));
        apart.iter().for_each(|&k| self.inverse[k] = 0.0);
        self.eta.fill(0.0);
        for (i, force) in force.iter().enumerate() {
            let (row, scaled) = (&self.rows[i * m..(i + 1) * m], &mut self.scaled[i * m..(i + 1) * m]);
            for (((scaled, eta), y), inverse) in scaled.iter_mut().zip(&mut self.eta).zip(row).zip(&self.inverse) {
                *scaled = y * inverse;
                *eta += *scaled * force.re;
            }
        }
        for i in 0..c {
            let scaled = &self.scaled[i * m..(i + 1) * m];
            self.sums.t[i] = product(scaled, &self.eta);
            for j in 0..=i {
                let sum = product(scaled, &self.rows[j * m..(j + 1) * m]);
                self.sums.g[i * c + j] += sum;
                if j < i {
                    self.sums.g[j * c + i] += sum;
                }
            }
        }
        let of_energy = self.eta.iter().zip(&self.inverse);
        self.sums.energy = of_energy.fold([0.0; 2], |[e, s], (eta, inverse)| {
            let square = eta * eta;
            [e + square, s + square * inverse]
        });
    }
}

/// Partial sums that the compiler puts side by side.
const LANES: usize = 4;

/// `Σ y²/D`, `Σ y²/D²`, `Σ y²/D³`.
fn powers(squares: &[f64], y2: &[f64], nu2: f64) -> [f64; 3] {
    let (mut first, mut second, mut third) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    let ((chunks, rest), (y2_chunks, y2_rest)) = (squares.as_chunks::<LANES>(), y2.as_chunks::<LANES>());
    for (square, y2) in chunks.iter().zip(y2_chunks) {
        for l in 0..LANES {
            let inverse = 1.0 / (square[l] - nu2);
            let share = y2[l] * inverse;
            let slope = share * inverse;
            first[l] += share;
            second[l] += slope;
            third[l] += slope * inverse;
        }
    }
    for (square, y2) in rest.iter().zip(y2_rest) {
        let inverse = 1.0 / (square - nu2);
        let slope = y2 * inverse * inverse;
        first[0] += y2 * inverse;
        second[0] += slope;
        third[0] += slope * inverse;
    }
    [first, second, third].map(|s| (s[0] + s[1]) + (s[2] + s[3]))
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.iter().zip(b) {
        (0..LANES).for_each(|l| sums[l] += a[l] * b[l]);
    }
    a_rest.iter().zip(b_rest).for_each(|(a, b)| sums[0] += a * b);
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
