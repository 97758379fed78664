//! A beam-like structure of three modes with a compliant stop at its end, kept in phase resonance by a force that
//! follows the velocity of its first mode: `F = F₀ η̇₁ / √(η̇₁² + ω₁² η₁²)`. That is what a phase-locked loop aims at,
//! without the loop.

use nlmodes_experiment::records::{Channel, Quantity, Record, Role};
use nlmodes_modal::LinearModes;

use super::Normal;

/// Steps of the integration from sample to sample.
const STEPS: usize = 32;

/// The structure, its stop and its excitation.
#[derive(Debug, Clone)]
pub struct Rig {
    pub modes: LinearModes,
    /// Rows of the drive point and of the stop.
    pub drive: usize,
    pub tip: usize,
    pub gap: f64,
    pub stiffness: f64,
    /// Exponent of the force over the displacement into the stop: 1 of a spring, 1.5 of a Hertz contact.
    pub exponent: f64,
    /// Amplitude of the force, N.
    pub force: f64,
    pub sample_rate: f64,
    /// Share of noise in the root mean square of a channel.
    pub noise: f64,
}

/// Modal coordinates and velocities.
type State = Vec<[f64; 2]>;

impl Rig {
    /// Samples after the transient has died away.
    pub fn record(&self, name: &str, settling: f64, n: usize, seed: u64) -> Record {
        let dt = 1.0 / self.sample_rate / STEPS as f64;
        let mut state: State = vec![[0.0, 0.0]; self.modes.n_modes()];
        // Settles faster from where force and damping balance without the stop.
        let (omega, zeta) = (self.modes.omegas()[0], self.modes.damping_ratios()[0]);
        let linear = self.force * self.modes.shape(self.drive, 0) / (2.0 * zeta * omega * omega);
        state[0][0] = linear.min(1.01 * self.gap / self.modes.shape(self.tip, 0));
        for _ in 0..(settling / dt) as usize {
            state = self.step(&state, dt);
        }
        let mut rows = Vec::new();
        for _ in 0..n {
            rows.push(self.signals(&state));
            for _ in 0..STEPS {
                state = self.step(&state, dt);
            }
        }
        self.written(name, &rows, seed)
    }

    /// A step of the classical Runge-Kutta method.
    fn step(&self, state: &State, dt: f64) -> State {
        let moved = |rate: &State, h: f64| -> State {
            state.iter().zip(rate).map(|(s, r)| [s[0] + h * r[0], s[1] + h * r[1]]).collect()
        };
        let a = self.rate(state);
        let b = self.rate(&moved(&a, 0.5 * dt));
        let c = self.rate(&moved(&b, 0.5 * dt));
        let d = self.rate(&moved(&c, dt));
        let mean = |k: usize, i: usize| (a[k][i] + 2.0 * b[k][i] + 2.0 * c[k][i] + d[k][i]) / 6.0;
        (0..state.len()).map(|k| [state[k][0] + dt * mean(k, 0), state[k][1] + dt * mean(k, 1)]).collect()
    }

    fn rate(&self, state: &State) -> State {
        let (force, contact) = (self.excitation(state), self.contact(state));
        let accelerate = |(k, s): (usize, &[f64; 2])| {
            let (omega, zeta) = (self.modes.omegas()[k], self.modes.damping_ratios()[k]);
            let load = force * self.modes.shape(self.drive, k) - contact * self.modes.shape(self.tip, k);
            [s[1], load - 2.0 * zeta * omega * s[1] - omega * omega * s[0]]
        };
        state.iter().enumerate().map(accelerate).collect()
    }

    fn excitation(&self, state: &State) -> f64 {
        let [q, v] = state[0];
        let size = v.hypot(self.modes.omegas()[0] * q);
        if size > 0.0 { self.force * v / size } else { self.force }
    }

    fn contact(&self, state: &State) -> f64 {
        self.stiffness * (self.at(self.tip, state, 0) - self.gap).max(0.0).powf(self.exponent)
    }

    fn at(&self, row: usize, state: &State, i: usize) -> f64 {
        state.iter().enumerate().map(|(k, s)| s[i] * self.modes.shape(row, k)).sum()
    }

    /// Force, displacement and velocity at the drive point, accelerations between, displacement and velocity at the
    /// tip, contact force.
    fn signals(&self, state: &State) -> Vec<f64> {
        let rate = self.rate(state);
        let mut row = vec![self.excitation(state), self.at(self.drive, state, 0), self.at(self.drive, state, 1)];
        row.extend(self.between().map(|d| self.at(d, &rate, 1)));
        row.extend([self.at(self.tip, state, 0), self.at(self.tip, state, 1), self.contact(state)]);
        row
    }

    fn between(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.modes.n_coordinates()).filter(|d| *d != self.drive && *d != self.tip)
    }

    fn written(&self, name: &str, rows: &[Vec<f64>], seed: u64) -> Record {
        let position = |row: usize| Some(self.modes.positions()[row]);
        let (drive, tip) = (position(self.drive), position(self.tip));
        let mut channels = vec![
            Channel::new("force_N", Quantity::Force, Role::Excitation, drive),
            Channel::new("x_drive_m", Quantity::Displacement, Role::DrivePoint, drive),
            Channel::new("v_drive_mps", Quantity::Velocity, Role::DrivePoint, drive),
        ];
        channels.extend(self.between().enumerate().map(|(i, row)| {
            Channel::new(format!("a{}_mps2", i + 1), Quantity::Acceleration, Role::Response, position(row))
        }));
        channels.push(Channel::new("x_tip_m", Quantity::Displacement, Role::Response, tip));
        channels.push(Channel::new("v_tip_mps", Quantity::Velocity, Role::Response, tip));
        channels.push(Channel::new("f_contact_N", Quantity::Force, Role::Contact, tip));
        let mut normal = Normal::new(seed);
        let mut record = Record::new(name, self.sample_rate);
        for (i, channel) in channels.into_iter().enumerate() {
            let clean: Vec<f64> = rows.iter().map(|row| row[i]).collect();
            let rms = (clean.iter().map(|x| x * x).sum::<f64>() / clean.len() as f64).sqrt();
            let samples = clean.iter().map(|x| x + self.noise * rms * normal.draw()).collect();
            record = record.with(channel, samples);
        }
        record
    }
}
