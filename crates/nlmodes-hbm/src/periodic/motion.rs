use std::f64::consts::TAU;

use nlmodes_linalg::{Mat, max_norm};
use nlmodes_modal::{ClosedSpan, ContactPeriod, HarmonicCoefficients, ModalPoint, TimeHistory};
use nlmodes_model::DofContact;
use nlmodes_model::reduction::ResponseRows;
use num_complex::Complex64;

use super::law::StopMotion;
use super::operating_point::OperatingPoint;
use super::rows::complex_harmonic;
use super::structure::ResponseRow;
use super::system::PeriodicSystem;
use crate::contact_statistics::largest;
use crate::trigonometric::Trigonometric;
use crate::{HbmError, Symmetry};

/// What a contact does over a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactMotion {
    /// Share of the period in which it is closed.
    pub closed_share: f64,
    /// Closed intervals a period.
    pub touches: usize,
    /// Largest force, N.
    pub peak_force: f64,
    /// Mean force, N.
    pub mean_force: f64,
    /// Fastest approach with which it closes, m/s; zero where it never does.
    pub approach: f64,
    /// Largest displacement toward the stop, m: the gap and what an elastic stop yields where it touches.
    pub peak: f64,
    /// Complex amplitude of the fundamental of the displacement away from the stop, m.
    pub fundamental: Complex64,
    /// The same of the displacement that there would be without contact forces of this instant, m: `Y η + a`.
    pub free_fundamental: Complex64,
}

impl ContactMotion {
    /// What it does, without its displacement, in a motion of this angular frequency, rad/s.
    pub fn period(&self, omega: f64) -> ContactPeriod {
        ContactPeriod {
            closed_share: self.closed_share,
            peak_force: self.peak_force,
            mean_force: self.mean_force,
            impulse: self.mean_force * TAU / omega,
            touches: self.touches,
            approach_velocity: self.approach,
            sliding: None,
        }
    }
}

/// A periodic motion, free or forced: amplitudes are those of `Re Σ z_n e^{inωt}`.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicMotion {
    /// Base frequency, negative damping and level.
    pub at: OperatingPoint,
    /// Modal coordinates, harmonic by harmonic, m each, m √kg.
    pub eta: Vec<Vec<Complex64>>,
    /// Displacements of the stops that dissipate, harmonic by harmonic, in the order in which they were put there, m.
    pub stops: Vec<Vec<Complex64>>,
    /// Contact forces, harmonic by harmonic, c each, N.
    pub forces: Vec<Vec<Complex64>>,
    /// Reactions of the laws on the structure, harmonic by harmonic, N.
    pub reactions: Vec<Vec<Complex64>>,
    /// The contacts, and behind them the laws that are stops.
    pub contacts: Vec<ContactMotion>,
    /// Averaged kinetic energy, J.
    pub kinetic_energy: f64,
    /// Mean of kinetic and strain energy, J, with that of the residual flexibility, of the stops and of a steady force;
    /// without the work of contact-free static loads.
    pub total_energy: f64,
    /// Mean power that the load puts in, W.
    pub input_power: f64,
    /// Mean power that the damping of the structure and its stops takes out, W.
    pub dissipated_power: f64,
}

impl PeriodicMotion {
    /// Complex amplitudes of a displacement, harmonic by harmonic, m; without what the load moves statically.
    pub fn displacement(&self, row: &ResponseRow) -> Vec<Complex64> {
        let of = |row: &[f64], z: &[Complex64]| row.iter().zip(z).map(|(r, z)| z * *r).sum::<Complex64>();
        let forces = self.forces.iter().zip(&self.reactions).map(|(contacts, laws)| [&contacts[..], laws].concat());
        self.eta.iter().zip(forces).map(|(eta, force)| of(&row.modes, eta) + of(&row.contacts, &force)).collect()
    }

    /// Modal coordinates and, behind them, the displacements of the stops that dissipate, of one harmonic.
    pub fn coordinates(&self, harmonic: usize) -> Vec<Complex64> {
        let of = |all: &[Vec<Complex64>]| all.get(harmonic).cloned().unwrap_or_default();
        of(&self.eta).into_iter().chain(of(&self.stops)).collect()
    }

    /// Damping ratio `D = ξ/(2ω)` of a damped nonlinear mode.
    pub fn damping_ratio(&self) -> f64 {
        self.at.xi / (2.0 * self.at.omega)
    }

    /// Modal amplitude `√(η_1ᴴ η_1)` of the fundamental, m √kg, eqs. (21), (22).
    pub fn modal_amplitude(&self) -> f64 {
        self.eta.get(1).map_or(0.0, |eta| eta.iter().map(|e| e.norm_sqr()).sum::<f64>().sqrt())
    }
}

impl PeriodicMotion {
    /// Modal coordinates with mass as Fourier coefficients, modes × (H + 1), m·√kg.
    pub fn modal_coefficients(&self) -> HarmonicCoefficients {
        let (modes, harmonics) = (self.eta.first().map_or(0, Vec::len), self.eta.len().saturating_sub(1));
        let mut modal = HarmonicCoefficients::zeros(modes, harmonics);
        for (n, eta) in self.eta.iter().enumerate() {
            eta.iter().enumerate().for_each(|(k, eta)| modal.of_mut(k)[n] = *eta);
        }
        modal
    }

    /// As a point of a curve, without displacements, whose coordinates the motion does not know: its fundamental and,
    /// without a contact, its peak are NaN.
    pub fn point(&self) -> ModalPoint {
        let (omega, first) = (self.at.omega, self.contacts.first());
        let kinetic = |(n, eta): (usize, &Vec<Complex64>)| {
            0.25 * (n as f64 * omega).powi(2) * eta.iter().map(|e| e.norm_sqr()).sum::<f64>()
        };
        ModalPoint {
            omega,
            kinetic_energy: self.kinetic_energy,
            harmonic_energy: self.eta.iter().enumerate().map(kinetic).collect(),
            total_energy: self.total_energy,
            modal_amplitude: self.modal_amplitude(),
            fundamental: f64::NAN,
            peak: first.map_or(f64::NAN, |c| c.peak),
            contact_fraction: first.map_or(f64::NAN, |c| c.closed_share),
            contact_intervals: self.contacts.iter().map(|c| c.touches).sum(),
            peak_contact_force: max_norm(self.contacts.iter().map(|c| c.peak_force)),
            contacts: self.contacts.iter().map(|c| c.period(omega)).collect(),
            ..ModalPoint::default()
        }
    }
}

impl PeriodicSystem {
    /// The motion with the unknowns `x` at the parameter `p`.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn motion(&mut self, x: &[f64], p: f64) -> Result<PeriodicMotion, HbmError> {
        let at = self.solve(x, p)?;
        let (series, c) = (self.series(), self.structure.n_contacts());
        let eta: Vec<Vec<Complex64>> = (0..self.blocks.len()).map(|n| self.modal_coordinates(n, at)).collect();
        let split = |n: usize| {
            let mut forces = self.forces_of_harmonic(n);
            let reactions = forces.split_off(c);
            (forces, reactions)
        };
        let (forces, reactions): (Vec<Vec<Complex64>>, Vec<Vec<Complex64>>) = (0..eta.len()).map(split).unzip();
        let free = complex_harmonic(series, &self.y, 1);
        let mean = self.operator.mean_forces();
        let own = (0..c).map(|i| self.contact_motion(i, mean[i], free[i], (&eta, &forces[1]), at.omega));
        let of_laws = (0..self.laws.len()).filter_map(|l| self.stop_motion(l, (&forces[1], &reactions[1])));
        let contacts = own.chain(of_laws).collect();
        let nu = |n: usize| n as f64 * at.omega;
        let moving = self.structure.n_moving();
        let kinetic = |n: usize| 0.25 * nu(n).powi(2) * eta[n][..moving].iter().map(|e| e.norm_sqr()).sum::<f64>();
        let damped = |n: usize| 0.5 * nu(n).powi(2) * self.structure.damping().form(&eta[n]);
        let power = |n: usize| {
            let modal = (0..self.structure.n_modes()).map(|k| (self.load.modal(n, k, at).value, eta[n][k]));
            let places = forces[n].iter().chain(&reactions[n]).enumerate();
            let gaps = places.map(|(i, force)| (self.load.gap(n, i, at).value, *force));
            0.5 * nu(n) * modal.chain(gaps).map(|(load, z)| (load * (Complex64::I * z).conj()).re).sum::<f64>()
        };
        // ½⟨ηᵀ Ω² η⟩, and ½⟨λᵀ (A + C) λ⟩ = −½⟨λᵀ y⟩ by complementarity.
        let mean_share = |n: usize| if n == 0 { 0.5 } else { 0.25 };
        let strain = |n: usize| -> f64 {
            let modal = eta[n].iter().zip(self.structure.omega_squared()).map(|(e, w)| w * e.norm_sqr()).sum::<f64>();
            let y = complex_harmonic(series, &self.y, n);
            let contact: f64 = forces[n].iter().zip(&y).map(|(f, y)| (f * y.conj()).re).sum();
            // Beside the modes the structure stores ½ (λ, f)ᵀ H (λ, f), of which that of the contacts alone is theirs.
            mean_share(n) * (modal - contact + self.between_laws(&forces[n], &reactions[n]))
        };
        // The steady force loses what it does on the mean.
        let steady = self.structure.steady_force().iter().zip(&eta[0]).map(|(p, eta)| p * eta.re).sum::<f64>();
        let strain: f64 = (0..eta.len()).map(strain).sum::<f64>() - steady;
        let sum = |f: &dyn Fn(usize) -> f64| (1..eta.len()).map(f).sum::<f64>();
        let (total_energy, kinetic_energy) = (sum(&kinetic) + strain + self.laws.mean_potential(), sum(&kinetic));
        let (input_power, dissipated_power) = (sum(&power), sum(&damped) + self.laws.dissipated_power());
        let mut eta = eta;
        let stops = eta.iter_mut().map(|eta| eta.split_off(moving)).collect();
        Ok(PeriodicMotion {
            at,
            contacts,
            total_energy,
            kinetic_energy,
            input_power,
            dissipated_power,
            eta,
            stops,
            forces,
            reactions,
        })
    }

    /// `f̄ᵀ (H_ff f + 2 H_fu λ)` of one harmonic.
    fn between_laws(&self, forces: &[Complex64], reactions: &[Complex64]) -> f64 {
        let laws = self.structure.laws();
        let along = |row: &[f64], z: &[Complex64]| row.iter().zip(z).map(|(h, z)| z * *h).sum::<Complex64>();
        let of = |(l, f): (usize, &Complex64)| {
            (f.conj() * (along(&laws[l].laws, reactions) + along(&laws[l].contacts, forces) * 2.0)).re
        };
        reactions.iter().enumerate().map(of).sum()
    }

    /// The point of a conservative branch with the unknowns `x`: `rows` are the displacements that it shows, of which
    /// number `first` is that of the first contact.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn modal_point(
        &mut self,
        x: &[f64],
        rows: &ResponseRows,
        first: usize,
        residual: f64,
    ) -> Result<ModalPoint, HbmError> {
        let motion = self.motion(x, 0.0)?;
        let periods = self.operator.contact_periods(motion.at.omega);
        let coefficients = displacements(&motion, rows);
        let fundamental = coefficients.of(first)[1];
        let even = self.series().symmetry == Symmetry::Even;
        let signed = if even {
            fundamental.re
        } else {
            fundamental.norm().copysign(if fundamental.re == 0.0 { 1.0 } else { fundamental.re })
        };
        Ok(ModalPoint {
            fundamental: signed,
            contact_fraction: periods.first().map_or(0.0, |contact| contact.closed_share),
            contact_intervals: periods.iter().map(|contact| contact.touches).sum(),
            peak_contact_force: max_norm(periods.iter().map(|contact| contact.peak_force)),
            contacts: periods,
            residual,
            coefficients,
            ..motion.point()
        })
    }

    /// Motion and force of all contacts over a period of the point with the unknowns `x`, exact at the instants of
    /// contact; `contacts` are those of the structure at its degrees of freedom.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn time_histories(
        &mut self,
        x: &[f64],
        contacts: &[DofContact],
        samples: usize,
        label: &str,
    ) -> Result<Vec<TimeHistory>, HbmError> {
        let at = self.solve(x, 0.0)?;
        Ok(self.operator.time_histories(contacts, at.omega, samples, label))
    }

    /// The same at equidistant instants.
    ///
    /// # Errors
    /// As [`time_histories`](Self::time_histories).
    pub fn equidistant_histories(
        &mut self,
        x: &[f64],
        contacts: &[DofContact],
        samples: usize,
        label: &str,
    ) -> Result<Vec<TimeHistory>, HbmError> {
        let at = self.solve(x, 0.0)?;
        Ok(self.operator.equidistant_histories(contacts, at.omega, samples, label))
    }

    /// The spans of a period in which each contact is closed at the point with the unknowns `x`, with its force.
    ///
    /// # Errors
    /// As [`time_histories`](Self::time_histories).
    pub fn closed_spans(&mut self, x: &[f64]) -> Result<Vec<Vec<ClosedSpan>>, HbmError> {
        self.solve(x, 0.0)?;
        Ok(self.operator.closed_spans())
    }

    /// Iterations of the contact solver so far.
    pub fn contact_iterations(&self) -> usize {
        self.operator.iterations()
    }

    /// What a law does that is a stop.
    fn stop_motion(&self, l: usize, (forces, reactions): (&[Complex64], &[Complex64])) -> Option<ContactMotion> {
        let StopMotion { closed_share, touches, peak_force, mean_force, approach, displacement, .. } =
            self.laws.stop_motion(l)?;
        let placed = &self.structure.laws()[l];
        let along = |row: &[f64], z: &[Complex64]| row.iter().zip(z).map(|(h, z)| z * *h).sum::<Complex64>();
        let fundamental = -displacement.get(1).copied().unwrap_or_default();
        let free_fundamental = fundamental + along(&placed.contacts, forces) + along(&placed.laws, reactions);
        let peak = largest_value(&displacement);
        Some(ContactMotion {
            closed_share,
            touches,
            peak_force,
            mean_force,
            approach,
            peak,
            fundamental,
            free_fundamental,
        })
    }

    fn contact_motion(
        &self,
        i: usize,
        mean: f64,
        free: Complex64,
        (eta, forces): (&[Vec<Complex64>], &[Complex64]),
        omega: f64,
    ) -> ContactMotion {
        let (operator, structure) = (&self.operator, &self.structure);
        // The body moves away from the stop by less than the gap opens where the stop yields.
        let yielded: Option<Vec<Complex64>> = structure.damped_stop(i).map(|k| eta.iter().map(|eta| eta[k]).collect());
        let free = free - yielded.as_ref().map_or(Complex64::default(), |stop| stop[1]);
        let (a, own) = (structure.compliance().a(), structure.stop_compliance()[i]);
        let pressed: Complex64 = forces.iter().enumerate().map(|(j, f)| f * a[(i, j)]).sum();
        let (gap, peak_force) = (structure.gaps()[i], operator.peak_force(i));
        let closest = operator.smallest_gap(i);
        ContactMotion {
            closed_share: operator.closed_share(i),
            touches: operator.touches(i),
            peak_force,
            mean_force: mean,
            approach: operator.approach(i) * omega,
            peak: match yielded {
                Some(stop) if peak_force > 0.0 => gap + largest_value(&stop),
                _ if peak_force > 0.0 => gap + own * peak_force,
                _ => gap - closest,
            },
            fundamental: free + pressed - forces[i] * own,
            free_fundamental: free,
        }
    }
}

/// Displacements of these rows in a motion, `Lᵀ Φ η + Lᵀ G W λ`.
fn displacements(motion: &PeriodicMotion, rows: &ResponseRows) -> HarmonicCoefficients {
    let count = motion.eta.len();
    let mut all = HarmonicCoefficients::zeros(rows.modes.nrows(), count.saturating_sub(1));
    // Motions that are even in time have cosines alone.
    let is_even = motion.eta.iter().chain(&motion.forces).flatten().all(|z| z.im == 0.0);
    for (unit, part) in [(Complex64::ONE, 0), (Complex64::I, 1)].into_iter().take(if is_even { 1 } else { 2 }) {
        let columns = |of: &[Vec<Complex64>], size: usize| {
            Mat::from_fn(size, count, |k, n| of[n].get(k).map_or(0.0, |z| [z.re, z.im][part]))
        };
        let (eta, forces) = (columns(&motion.eta, rows.modes.ncols()), columns(&motion.forces, rows.forces.ncols()));
        let values = &rows.modes * eta + &rows.forces * forces;
        for i in 0..values.nrows() {
            all.of_mut(i).iter_mut().enumerate().for_each(|(n, q)| *q += unit * values[(i, n)]);
        }
    }
    all
}

/// Largest value of `Re Σ z_n e^{inτ}`.
pub fn largest_value(z: &[Complex64]) -> f64 {
    largest_instant(z)[1]
}

/// Where it is, and the largest value. The best sample may be an end of the period: a second search has it inside.
pub(super) fn largest_instant(z: &[Complex64]) -> [f64; 2] {
    let series = Trigonometric { z: z.to_vec() };
    let (near, _) = largest(&series, 0.0, TAU);
    let beside = TAU / (8 * z.len().max(1)) as f64;
    largest(&series, near - beside, near + beside).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `Σ a_n cos n(τ − τ₀)` with positive a_n has its maximum at τ₀; samples alone would be off by 3e-4 of the
    /// amplitude and more.
    #[test]
    fn the_largest_value_of_a_series_is_found_between_its_samples() {
        for amplitudes in [vec![1.0], vec![1.0, 0.3], vec![0.2, 0.0, 0.7, 0.1]] {
            for mean in [0.0, 5.0, -5.0, 1e-3] {
                for k in 0..50 {
                    let instant = 0.0137 + 0.127 * f64::from(k);
                    let turned = |(n, a): (usize, &f64)| a * Complex64::cis(-(n as f64 + 1.0) * instant);
                    let z: Vec<Complex64> =
                        std::iter::once(mean.into()).chain(amplitudes.iter().enumerate().map(turned)).collect();
                    let expected = mean + amplitudes.iter().sum::<f64>();
                    let found = largest_value(&z);
                    assert!((found - expected).abs() < 1e-6, "{amplitudes:?} {mean} {instant}: {found} of {expected}");
                }
            }
        }
    }
}
