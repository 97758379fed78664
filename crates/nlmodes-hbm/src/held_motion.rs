use num_complex::Complex64;

/// Complex coefficients of `b`, `q_N` and `η`, each `[harmonic][coordinate]`.
pub(crate) struct HeldMotion {
    pub b: Vec<Vec<Complex64>>,
    pub q: Vec<Vec<Complex64>>,
    pub eta: Vec<Vec<Complex64>>,
}

/// Real or imaginary part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Real,
    Imaginary,
}

impl Part {
    pub fn of(self, z: Complex64) -> f64 {
        match self {
            Self::Real => z.re,
            Self::Imaginary => z.im,
        }
    }
}

impl HeldMotion {
    pub fn new(n_contact_dofs: usize, n_modes: usize, harmonics: usize) -> Self {
        let zeros = |n: usize| vec![vec![Complex64::default(); n]; harmonics + 1];
        Self { b: zeros(n_contact_dofs), q: zeros(n_contact_dofs), eta: zeros(n_modes) }
    }

    pub fn add(&mut self, n: usize, unit: Complex64, b: &[f64], q: &[f64], eta: &[f64]) {
        for (to, from) in [(&mut self.b[n], b), (&mut self.q[n], q), (&mut self.eta[n], eta)] {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += unit * *from);
        }
    }
}
