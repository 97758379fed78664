use nlmodes_linalg::{Mat, max_norm};
use nlmodes_modal::{ContactPeriod, HarmonicCoefficients, ModalPoint};
use num_complex::Complex64;

use crate::contact_statistics::largest;
use crate::energy::{held_coordinates, inner};
use crate::held_motion::{HeldMotion, HeldPart};
use crate::transfer::Plane;
use crate::{HbmError, MixedShooting, Symmetry};

impl MixedShooting<'_> {
    /// The point with the unknowns `x`, as a nonlinear mode with its modal quantities.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn modal_point(&mut self, x: &[f64], residual: f64) -> Result<ModalPoint, HbmError> {
        if self.is_in_open_modes() {
            return self.system.modal_point(x, self.structure.model().contacts(), residual);
        }
        self.solve(x)?;
        let omega = self.omega(x);
        let held = self.held_motion(omega);
        let coefficients = self.recorded_coordinates(&held, omega);
        let (harmonic_energy, strain) = self.energies(&held, omega);
        let kinetic = harmonic_energy.iter().sum();
        let modal_amplitude = self.modal_amplitude(&held);
        let first = self.structure().model().contacts()[0];
        let contacts = self.system.operator.contact_periods(omega);
        // A structure has a contact at least: that of `first`.
        let ContactPeriod { closed_share: fraction, peak_force: first_force, .. } = contacts[0];
        Ok(ModalPoint {
            omega,
            fundamental: self
                .signed_fundamental(coefficients.of(self.structure().recorded_index(first.dof).unwrap_or(0))[1]),
            coefficients,
            kinetic_energy: kinetic,
            harmonic_energy,
            total_energy: kinetic + strain,
            modal_amplitude,
            peak: self.peak(fraction > 0.0, first_force),
            contact_fraction: fraction,
            contact_intervals: contacts.iter().map(|contact| contact.touches).sum(),
            peak_contact_force: max_norm(contacts.iter().map(|contact| contact.peak_force)),
            contacts,
            residual,
            ..ModalPoint::default()
        })
    }

    /// `b_n`, `q_N,n` and `η_k,n` of all harmonics.
    pub(crate) fn held_motion(&self, omega: f64) -> HeldMotion {
        let (structure, series) = (self.structure(), self.series());
        let h = series.n_harmonics;
        let units = [Complex64::ONE, -Complex64::I].into_iter();
        let units = units.take(if series.symmetry == Symmetry::Even { 1 } else { 2 });
        let part = |unit| HeldPart::new(unit, structure.n_contact_dofs(), structure.modes().len(), h);
        let mut parts: Vec<HeldPart> = units.map(part).collect();
        let mut plane = Plane::new(structure.n_contact_dofs());
        for n in 0..=h {
            let nu2 = (n as f64 * omega).powi(2);
            if n == 0 {
                plane.set_static(&structure.held)
            } else {
                plane.set(&structure.held, nu2)
            }
            let sine = series.sine(n).map(|_| true);
            for (is_sine, part) in std::iter::once(false).chain(sine).zip(&mut parts) {
                let [b, q, eta] = part.of_mut(n);
                self.coefficients(n, is_sine, b, q);
                held_coordinates(&structure.held, &plane, nu2, b, q, eta);
            }
        }
        HeldMotion { parts }
    }

    /// The coefficients of the recorded degrees of freedom.
    fn recorded_coordinates(&self, held: &HeldMotion, omega: f64) -> HarmonicCoefficients {
        let recording = &self.structure().recording;
        let h = self.series().n_harmonics;
        let mut all = HarmonicCoefficients::zeros(recording.dofs().len(), h);
        for part in &held.parts {
            for n in 0..=h {
                let [_, q, _] = part.of(n);
                recording.contacts.iter().zip(q).for_each(|(&place, q)| all.of_mut(place)[n] += part.unit * *q);
            }
            let values = &recording.basis * self.amplitudes(part, omega);
            for (row, &place) in recording.linear.iter().enumerate() {
                all.of_mut(place).iter_mut().zip(values.row(row).iter()).for_each(|(to, q)| *to += part.unit * *q);
            }
        }
        recording.linear.iter().zip(&recording.sag).for_each(|(&place, sag)| all.of_mut(place)[0] += sag);
        all
    }

    /// `ν²/λ_k η_k,n`, `q_N,n` and `ν² q_N,n`, one below the other, a column a harmonic: what
    /// `q_L,n = Σ_k φ_k (ν²/λ_k) η_k,n + Ψ q_N,n + X ν² q_N,n` is made from.
    pub(crate) fn amplitudes(&self, part: &HeldPart, omega: f64) -> Mat<f64> {
        let inverse_lambda = &self.structure().held.sums.inverse_lambda;
        let (k, n_n) = (inverse_lambda.len(), self.structure().n_contact_dofs());
        let mut amplitudes = Mat::zeros(k + 2 * n_n, self.series().n_harmonics + 1);
        for n in 0..=self.series().n_harmonics {
            let nu2 = (n as f64 * omega).powi(2);
            let [_, q, eta] = part.of(n);
            let modal = eta.iter().zip(inverse_lambda).map(|(eta, inverse)| nu2 * inverse * eta);
            let values = modal.chain(q.iter().copied()).chain(q.iter().map(|q| nu2 * q));
            amplitudes.col_mut(n).iter_mut().zip(values).for_each(|(to, value)| *to = value);
        }
        amplitudes
    }

    /// Averaged kinetic energy of each harmonic, and averaged strain energy, that of elastic stops included.
    ///
    /// The strain energy is that of `q_L` with the contact nodes at `b`, and that of the contact nodes between `b` and
    /// `q_N` and of the stops, `½ λᵀ A λ`, whose mean is `−½ ⟨λᵀ (Wᵀ b + g₀)⟩` because `λᵀ (Wᵀ b + g₀ + A λ) = 0`. That
    /// of a steady force, `−f_Lᵀ q_L`, is counted with it: with `q_L,0 = Ψ q_N,0 + K_LL⁻¹ f_L` both are the same sum
    /// but for a constant.
    fn energies(&self, held: &HeldMotion, omega: f64) -> (Vec<f64>, f64) {
        let structure = self.structure();
        let (n_n, k_nn) = (structure.n_contact_dofs(), structure.model().k_nn());
        let (mut harmonic_energy, mut strain) = (vec![0.0; self.series().n_harmonics + 1], 0.0);
        let mut coupling = vec![0.0; structure.modes().len()];
        for (n, kinetic) in harmonic_energy.iter_mut().enumerate() {
            let nu2 = (n as f64 * omega).powi(2);
            let half = if n == 0 { 0.5 } else { 0.25 };
            for part in &held.parts {
                let [b, q, eta] = part.of(n);
                structure.held.sums.couple(q, &mut coupling);
                for ((inverse, coupling), eta) in structure.held.sums.inverse_lambda.iter().zip(&coupling).zip(eta) {
                    let share = nu2 * inverse;
                    *kinetic += half * nu2 * eta * eta;
                    strain += half * share * eta * (nu2 * eta - 2.0 * coupling);
                }
                for j in 0..n_n {
                    let static_q: f64 = (0..n_n).map(|e| q[e] * structure.t0[(j, e)]).sum();
                    for i in 0..n_n {
                        // The modes not computed: q_L gains ν² K_LL⁻¹ M_LL Ψ q_N, whose work against Ψ q_N counts
                        // twice.
                        let residual = structure.held.residual.mass[(i, j)] * q[i] * q[j];
                        *kinetic += half * nu2 * residual;
                        strain += 2.0 * half * nu2 * residual;
                        strain += half * k_nn[(i, j)] * (q[i] * static_q - b[i] * q[j]);
                    }
                }
            }
        }
        let preload: f64 = self.mean_forces().iter().zip(structure.body.gaps()).map(|(λ, g)| λ * g).sum();
        (harmonic_energy, strain - 0.5 * preload + structure.statics.energy)
    }

    /// `q̃ = √(q_L,1ᴴ M_LL q_L,1)`, eqs. (21), (22).
    fn modal_amplitude(&self, held: &HeldMotion) -> f64 {
        let mass = &self.structure().held.residual.mass;
        let squares = held.parts.iter().map(|part| {
            let [_, q, eta] = part.of(1);
            let pairs = (0..q.len()).flat_map(|i| (0..q.len()).map(move |j| (i, j)));
            inner(eta, eta) + pairs.map(|(i, j)| mass[(i, j)] * q[i] * q[j]).sum::<f64>()
        });
        squares.sum::<f64>().sqrt()
    }

    /// Mean contact forces over a period, N.
    pub fn mean_forces(&self) -> Vec<f64> {
        self.system.operator.mean_forces()
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
        let operator = &self.system.operator;
        let toward = operator.intervals.iter().map(|interval| {
            let set = operator.sets.get(interval.set);
            let opposite = set.guard_row(0).map(|(j, g)| (j, -g));
            largest(&operator.combination(opposite), interval.from, interval.to).1
        });
        contact.gap + toward.fold(f64::NEG_INFINITY, f64::max)
    }
}
