use nlmodes_linalg::{Mat, max_norm};
use nlmodes_modal::{ContactPeriod, HarmonicCoefficients, ModalPoint};
use num_complex::Complex64;

use crate::contact_statistics::largest;
use crate::energy::held_coordinates;
use crate::held_motion::{HeldMotion, Part};
use crate::transfer::Plane;
use crate::{HbmError, MixedShooting, Symmetry};

impl MixedShooting<'_> {
    /// The point with the unknowns `x`, as a nonlinear mode with its modal quantities.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn modal_point(&mut self, x: &[f64], residual: f64) -> Result<ModalPoint, HbmError> {
        self.solve_contact(x)?;
        let omega = self.omega(x);
        let held = self.held_motion(omega);
        let coefficients = self.recorded_coordinates(&held, omega);
        let (harmonic_energy, strain) = self.energies(&held, omega);
        let kinetic = harmonic_energy.iter().sum();
        let modal_amplitude = self.modal_amplitude(&held);
        let first = self.structure().model().contacts()[0];
        let contacts = self.sweep.contact_periods(omega);
        // A structure has a contact at least: that of `first`.
        let ContactPeriod { closed_share: fraction, peak_force: first_force, .. } = contacts[0];
        Ok(ModalPoint {
            omega,
            fundamental: self
                .signed_fundamental(coefficients.of(self.structure().recorded_index(first.dof).unwrap_or(0))[1]),
            coefficients,
            kinetic_energy: kinetic,
            harmonic_energy,
            resonance: None,
            stability: None,
            total_energy: kinetic + strain,
            modal_amplitude,
            peak: self.peak(fraction > 0.0, first_force),
            contact_fraction: fraction,
            contact_intervals: contacts.iter().map(|contact| contact.touches).sum(),
            peak_contact_force: max_norm(contacts.iter().map(|contact| contact.peak_force)),
            contacts,
            residual,
            error_estimate: None,
            events: Vec::new(),
        })
    }

    /// Complex `b_n`, `q_N,n` and `η_k,n` of all harmonics.
    pub(crate) fn held_motion(&self, omega: f64) -> HeldMotion {
        let (structure, series) = (self.structure(), self.series());
        let (n_n, h) = (structure.n_contact_dofs(), series.n_harmonics);
        let mut motion = HeldMotion::new(n_n, structure.modes().len(), h);
        let mut plane = Plane::new(n_n);
        let mut eta = vec![0.0; structure.modes().len()];
        let (mut b, mut q) = (vec![0.0; n_n], vec![0.0; n_n]);
        for n in 0..=h {
            let nu2 = (n as f64 * omega).powi(2);
            if n == 0 {
                plane.set_static(structure)
            } else {
                plane.set(structure, nu2)
            }
            let sine = series.sine(n);
            for (m, unit) in std::iter::once((n, Complex64::ONE)).chain(sine.map(|m| (m, -Complex64::I))) {
                self.coefficients(m, &mut b, &mut q);
                held_coordinates(structure, &plane, nu2, &b, &q, &mut eta);
                motion.add(n, unit, &b, &q, &eta);
            }
        }
        motion
    }

    /// The coefficients of the recorded degrees of freedom.
    fn recorded_coordinates(&self, held: &HeldMotion, omega: f64) -> HarmonicCoefficients {
        let recording = &self.structure().recording;
        let h = self.series().n_harmonics;
        let mut all = HarmonicCoefficients::zeros(recording.dofs().len(), h);
        for (d, &place) in recording.contacts.iter().enumerate() {
            all.of_mut(place).iter_mut().zip(&held.q).for_each(|(to, q)| *to = q[d]);
        }
        for (part, unit) in [(Part::Real, Complex64::ONE), (Part::Imaginary, Complex64::I)] {
            if part == Part::Imaginary && self.series().symmetry == Symmetry::Even {
                continue;
            }
            let values = &recording.basis * self.amplitudes(held, omega, part);
            for (row, &place) in recording.linear.iter().enumerate() {
                let target = all.of_mut(place).iter_mut().enumerate();
                target.for_each(|(n, q)| *q += unit * values[(row, n)]);
            }
        }
        all
    }

    /// `ν²/λ_k η_k,n`, `q_N,n` and `ν² q_N,n`, one below the other, a column a harmonic: what
    /// `q_L,n = Σ_k φ_k (ν²/λ_k) η_k,n + Ψ q_N,n + X ν² q_N,n` is made from.
    pub(crate) fn amplitudes(&self, held: &HeldMotion, omega: f64, part: Part) -> Mat<f64> {
        let modes = self.structure().modes();
        let (k, n_n) = (modes.len(), self.structure().n_contact_dofs());
        Mat::from_fn(k + 2 * n_n, self.series().n_harmonics + 1, |i, n| {
            let nu2 = (n as f64 * omega).powi(2);
            match i {
                i if i < k => nu2 / modes[i].lambda * part.of(held.eta[n][i]),
                i if i < k + n_n => part.of(held.q[n][i - k]),
                i => nu2 * part.of(held.q[n][i - k - n_n]),
            }
        })
    }

    /// Averaged kinetic energy of each harmonic, and averaged strain energy, that of elastic stops included.
    ///
    /// The strain energy is that of `q_L` with the contact nodes at `b`, and that of the contact nodes between `b` and `q_N` and of
    /// the stops, `½ λᵀ A λ`, whose mean is `−½ ⟨λᵀ (Wᵀ b + g₀)⟩` because `λᵀ (Wᵀ b + g₀ + A λ) = 0`.
    fn energies(&self, held: &HeldMotion, omega: f64) -> (Vec<f64>, f64) {
        let structure = self.structure();
        let k_nn = structure.model().k_nn();
        let n_n = structure.n_contact_dofs();
        let (mut harmonic_energy, mut strain) = (Vec::new(), 0.0);
        for n in 0..=self.series().n_harmonics {
            let mut kinetic = 0.0;
            let nu2 = (n as f64 * omega).powi(2);
            let mean = if n == 0 { 1.0 } else { 0.5 };
            let (b, q) = (&held.b[n], &held.q[n]);
            for (mode, eta) in structure.modes().iter().zip(&held.eta[n]) {
                let coupling: Complex64 = mode.g.iter().zip(q).map(|(g, q)| q * *g).sum();
                let share = nu2 / mode.lambda;
                kinetic += 0.5 * mean * nu2 * eta.norm_sqr();
                strain += 0.5 * mean * (share * nu2 * eta.norm_sqr() - 2.0 * share * (coupling.conj() * eta).re);
            }
            for i in 0..n_n {
                for j in 0..n_n {
                    let k = k_nn[(i, j)];
                    // The modes not computed: q_L gains ν² K_LL⁻¹ M_LL Ψ q_N, whose work against Ψ q_N counts twice.
                    let residual = structure.residual.mass[(i, j)] * (q[i].conj() * q[j]).re;
                    kinetic += 0.5 * mean * nu2 * residual;
                    strain += mean * nu2 * residual;
                    let static_q: Complex64 = (0..n_n).map(|e| q[e] * structure.t0[(j, e)]).sum();
                    let force: Complex64 = q[j] - b[j];
                    strain += 0.5 * mean * k * (q[i].conj() * static_q).re;
                    strain -= 0.5 * mean * k * (b[i].conj() * b[j]).re;
                    strain -= 0.5 * mean * k * (b[i].conj() * force).re;
                }
            }
            harmonic_energy.push(kinetic);
        }
        let preload: f64 = self.mean_forces().iter().zip(structure.body.gaps()).map(|(λ, g)| λ * g).sum();
        (harmonic_energy, strain - 0.5 * preload)
    }

    /// `q̃ = √(q_L,1ᴴ M_LL q_L,1)`, eqs. (21), (22).
    fn modal_amplitude(&self, held: &HeldMotion) -> f64 {
        let (mass, q) = (&self.structure().residual.mass, &held.q[1]);
        let pairs = (0..q.len()).flat_map(|i| (0..q.len()).map(move |j| (i, j)));
        let residual: f64 = pairs.map(|(i, j)| mass[(i, j)] * (q[i].conj() * q[j]).re).sum();
        (held.eta[1].iter().map(|η| η.norm_sqr()).sum::<f64>() + residual).sqrt()
    }

    /// Mean contact forces over a period, N.
    pub fn mean_forces(&self) -> Vec<f64> {
        self.sweep.mean_forces()
    }

    fn signed_fundamental(&self, q: Complex64) -> f64 {
        match self.series().symmetry {
            Symmetry::Even => q.re,
            Symmetry::None if q.re < 0.0 => -q.norm(),
            Symmetry::None => q.norm(),
        }
    }

    /// Largest displacement of the first contact toward its stop, with what an elastic stop yields.
    fn peak(&self, touches: bool, force: f64) -> f64 {
        let contact = self.structure().model().contacts()[0];
        if touches {
            return contact.gap + contact.law.compliance() * force;
        }
        // g = g₀ − side·q: the largest motion toward the stop is g₀ − min g; other contacts may be closed meanwhile.
        let toward = self.sweep.intervals.iter().map(|interval| {
            let set = self.sweep.sets.get(interval.set);
            let opposite = set.guard_row(0).map(|(j, g)| (j, -g));
            largest(&self.sweep.combination(opposite), interval.from, interval.to)
        });
        contact.gap + toward.fold(f64::NEG_INFINITY, f64::max)
    }
}
