use num_complex::Complex64;

/// Coefficients of `b`, `q_N` and `η`, those of the cosines and, where the motion is not even in time, those of the
/// sines.
pub(crate) struct HeldMotion {
    pub parts: Vec<HeldPart>,
}

/// Coefficients of the cosines or of the sines, one harmonic after the other from the mean on.
pub(crate) struct HeldPart {
    /// What they are multiplied by in the complex coefficients: 1, or −i for sines.
    pub unit: Complex64,
    /// Contact coordinates, and held modes.
    sizes: [usize; 2],
    b: Vec<f64>,
    q: Vec<f64>,
    eta: Vec<f64>,
}

impl HeldPart {
    pub fn new(unit: Complex64, n_contact_dofs: usize, n_modes: usize, harmonics: usize) -> Self {
        let zeros = |n: usize| vec![0.0; n * (harmonics + 1)];
        let sizes = [n_contact_dofs, n_modes];
        Self { unit, sizes, b: zeros(n_contact_dofs), q: zeros(n_contact_dofs), eta: zeros(n_modes) }
    }

    /// `b`, `q_N` and `η` of one harmonic.
    pub fn of(&self, harmonic: usize) -> [&[f64]; 3] {
        let [contacts, modes] = self.sizes.map(|size| harmonic * size..(harmonic + 1) * size);
        [&self.b[contacts.clone()], &self.q[contacts], &self.eta[modes]]
    }

    pub fn of_mut(&mut self, harmonic: usize) -> [&mut [f64]; 3] {
        let [contacts, modes] = self.sizes.map(|size| harmonic * size..(harmonic + 1) * size);
        [&mut self.b[contacts.clone()], &mut self.q[contacts], &mut self.eta[modes]]
    }
}
