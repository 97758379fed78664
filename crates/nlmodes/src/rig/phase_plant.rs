use nlmodes_experiment::phase_loop::{Gains, LowPass};
use num_complex::Complex64;

use crate::rig::{ControlChannels, Exciter, MotionQuantity, RigSetup, SensorPlace, Shaker};

/// Phase margin that gains are designed for, degrees.
const MARGIN_DEG: f64 = 50.0;
/// Unit loop gain, over the cut-off of the detector, as in the symmetrical optimum.
const CROSSOVER: f64 = 0.25;
/// Factor by which it is lowered where the margin is not reached …
const SLOWER: f64 = 0.8;
/// … and how often at most.
const MOST: usize = 12;
/// Frequencies between crossover and oscillation at which the loop gain must stay below one.
const POINTS: usize = 60;
/// Distance from zero, over the frequency, at which the slow limit of the plant is taken.
const SLOW: f64 = 1e-7;

/// What the phase-locked loop controls: how the lag of the response follows the frequency of the drive, with exciter,
/// structure below contact, and the filters of both sensors.
///
/// A drive whose phase is modulated, `θ = ωt + φ̂ e^{st}`, gives an output of response `G` the phase
///
/// ```text
/// P_G(s) φ̂ ,   P_G(s) = ½ (G(iω + s)/G(iω) + conj(G(iω + conj s))/conj(G(iω)))
/// ψ̂ / ω̂ = (P_F(s) − P_X(s)) / s                          of force F and response X
/// ```
///
/// With an ideal force and one mode that is `1/(s + ζω)`. A shaker follows the structure: near the resonance its force
/// drops, the phases of force and response turn against each other faster, and the gains of the ideal force would be
/// several times too large.
#[derive(Debug, Clone)]
pub struct PhasePlant {
    rig: RigSetup,
    channels: ControlChannels,
    omega: f64,
}

/// Crossover and phase margin of a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseMargin {
    /// Angular frequency of unit loop gain, rad/s.
    pub crossover: f64,
    /// Phase margin there, degrees.
    pub degrees: f64,
}

impl PhasePlant {
    /// Of a rig at an angular frequency of the drive, rad/s.
    pub fn new(rig: &RigSetup, channels: &ControlChannels, omega: f64) -> Self {
        Self { rig: rig.clone(), channels: channels.clone(), omega }
    }

    /// `ψ̂/ω̂` at the complex frequency `s`, 1/s; the result in s. NaN where a channel does not exist.
    pub fn lag(&self, s: Complex64) -> Complex64 {
        (self.phase(s, |s| self.force(s)) - self.phase(s, |s| self.response(s))) / s
    }

    /// Open loop with these gains and a detector of this low-pass.
    pub fn open_loop(&self, gains: Gains, low_pass: LowPass, s: Complex64) -> Complex64 {
        (gains.proportional + gains.integral / s) * low_pass.response(s) * self.lag(s)
    }

    /// The margin at the highest crossover below the frequency of the drive; `None` without one.
    pub fn margin(&self, gains: Gains, low_pass: LowPass) -> Option<PhaseMargin> {
        let size = |y: f64| self.open_loop(gains, low_pass, Complex64::new(0.0, y)).norm();
        let lowest = 1e-3 * low_pass.cut_off;
        let ratio = (0.5 * self.omega / lowest).powf(1.0 / (20 * POINTS) as f64);
        let grid = |k: usize| lowest * ratio.powi(k as i32);
        let last = (0..20 * POINTS).rev().find(|k| size(grid(*k)) > 1.0 && size(grid(k + 1)) <= 1.0)?;
        let (mut low, mut high) = (grid(last), grid(last + 1));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if size(middle) > 1.0 { low = middle } else { high = middle }
        }
        let at = self.open_loop(gains, low_pass, Complex64::new(0.0, low));
        Some(PhaseMargin { crossover: low, degrees: (-at).arg().to_degrees() })
    }

    /// Gains after the symmetrical optimum for this plant: unit loop gain at a quarter of the cut-off, or as far below
    /// as a phase margin of 50 degrees and a loop gain below one from there on need; `None` where none has both.
    pub fn design(&self, low_pass: LowPass) -> Option<Gains> {
        let decay = self.lag(Complex64::new(SLOW * self.omega, 0.0)).re.recip().max(0.0);
        let gains = |crossover: f64| {
            let corner = decay + 0.25 * crossover;
            let unit = Gains { proportional: 1.0, integral: corner };
            let scale = self.open_loop(unit, low_pass, Complex64::new(0.0, crossover)).norm().recip();
            Gains { proportional: scale, integral: scale * corner }
        };
        let is_sound = |crossover: f64| {
            let own = gains(crossover);
            let at = |y: f64| self.open_loop(own, low_pass, Complex64::new(0.0, y));
            let ratio = (0.5 * self.omega / crossover).powf(1.0 / POINTS as f64);
            let is_low = (1..=POINTS).all(|k| at(crossover * ratio.powi(k as i32)).norm() < 1.0);
            is_low && (-at(crossover)).arg().to_degrees() >= MARGIN_DEG
        };
        let first = CROSSOVER * low_pass.cut_off;
        let crossovers = (0..MOST).map(|k| first * SLOWER.powi(k as i32));
        crossovers.into_iter().find(|crossover| is_sound(*crossover)).map(gains)
    }

    /// `P_G(s)`.
    fn phase(&self, s: Complex64, of: impl Fn(Complex64) -> Complex64) -> Complex64 {
        let carrier = Complex64::new(0.0, self.omega);
        let beside = |s: Complex64| of(carrier + s) / of(carrier);
        0.5 * (beside(s) + beside(s.conj()).conj())
    }

    /// Reading of the force over the drive.
    fn force(&self, s: Complex64) -> Complex64 {
        self.excitation(s) * self.chain(self.channels.force, s)
    }

    /// Reading of the response over the drive.
    fn response(&self, s: Complex64) -> Complex64 {
        let none = Complex64::new(f64::NAN, 0.0);
        let Some(sensor) = self.rig.sensors.get(self.channels.response) else { return none };
        let (quantity, shape, residual) = match &sensor.place {
            SensorPlace::DrivePoint(quantity) => {
                (*quantity, &self.rig.drive_point.shape, self.rig.drive_point.residual)
            }
            SensorPlace::Point { motion, shape, .. } => (*motion, shape, 0.0),
            SensorPlace::StopPoint(quantity) => match &self.rig.stop {
                Some(stop) => (*quantity, &stop.shape, 0.0),
                None => return none,
            },
            SensorPlace::Excitation | SensorPlace::Stop => return none,
        };
        let order = match quantity {
            MotionQuantity::Displacement => 0,
            MotionQuantity::Velocity => 1,
            MotionQuantity::Acceleration => 2,
        };
        let motion = (self.receptance(shape, s) + residual) * self.excitation(s) * s.powu(order);
        motion * self.chain(self.channels.response, s)
    }

    /// `Σ_k φ_k φ_k(drive) / (ω_k² + 2 ζ_k ω_k s + s²)`, m/N.
    fn receptance(&self, shape: &[f64], s: Complex64) -> Complex64 {
        let structure = &self.rig.structure;
        let modes = structure.omega.iter().zip(&structure.damping_ratios);
        let products = shape.iter().zip(&self.rig.drive_point.shape).map(|(a, b)| a * b);
        modes.zip(products).map(|((own, zeta), product)| product / (own * own + 2.0 * zeta * own * s + s * s)).sum()
    }

    /// Force over drive.
    fn excitation(&self, s: Complex64) -> Complex64 {
        let Exciter::Shaker(shaker) = self.rig.exciter else { return Complex64::ONE };
        let at = &self.rig.drive_point;
        let coil = shaker.force_constant / (shaker.inductance * s + shaker.resistance);
        let stinger = shaker.stinger_at(at) + shaker.stinger_damping * s;
        let yields = stinger.inv() + self.receptance(&at.shape, s);
        coil / (1.0 + (armature(&shaker, s) + shaker.force_constant * coil * s) * yields)
    }

    /// Filters of a channel.
    fn chain(&self, channel: usize, s: Complex64) -> Complex64 {
        let Some(sensor) = self.rig.sensors.get(channel) else { return Complex64::new(f64::NAN, 0.0) };
        let stage = |stage: &crate::rig::Stage| {
            let w = stage.omega;
            w * w / (w * w + 2.0 * stage.damping_ratio * w * s + s * s)
        };
        let filtered: Complex64 = sensor.chain.stages.iter().map(stage).product();
        filtered * (-sensor.chain.delay * s).exp()
    }
}

/// Dynamic stiffness of armature and suspension, N/m.
fn armature(shaker: &Shaker, s: Complex64) -> Complex64 {
    shaker.suspension_stiffness + shaker.suspension_damping * s + shaker.armature_mass * s * s
}
