use nlmodes_linalg::Mat;

use crate::rig::functional::Functional;
use crate::rig::{DrivePoint, Exciter, LinearStructure, RigError, Stage, Stop};

/// `ẋ = A x + c + b u` with the stop open or closed.
///
/// State: `s q_k`, `q̇_k`, and for a shaker `s √m_a x_a`, `√m_a v_a`, `√L i`. The rate `s`, near the highest frequency
/// with the stop closed, makes all entries comparable and the norm of `A`, which determines the step, as small as
/// possible.
#[derive(Debug, Clone)]
pub(crate) struct Linear {
    pub(crate) a: Mat<f64>,
    pub(crate) c: Vec<f64>,
}

/// The rig as two linear systems with common state and input, and their outputs.
#[derive(Debug, Clone)]
pub(crate) struct StateSpace {
    modes: usize,
    scale: f64,
    exciter: Exciter,
    /// Open, closed.
    pub(crate) systems: [Linear; 2],
    pub(crate) b: Vec<f64>,
    /// `side · Σ φ_k q_k − g_0`, m: closed where positive.
    pub(crate) penetration: Option<Functional>,
    stop: Option<Stop>,
    drive_point: DrivePoint,
}

impl StateSpace {
    pub(crate) fn new(structure: &LinearStructure, at: &DrivePoint, exciter: Exciter, stop: Option<&Stop>) -> Self {
        let modes = structure.modes();
        let n = 2 * modes + exciter.states();
        let scale = rate(structure, at, exciter, stop);
        let mut space = Self {
            modes,
            scale,
            exciter,
            systems: [Linear { a: Mat::zeros(n, n), c: vec![0.0; n] }, Linear { a: Mat::zeros(n, n), c: vec![0.0; n] }],
            b: vec![0.0; n],
            penetration: None,
            stop: stop.cloned(),
            drive_point: at.clone(),
        };
        space.penetration = stop.map(|stop| space.penetration_of(stop));
        let mut a = space.free(structure);
        space.excite(&mut a);
        space.systems[0].a = a.clone();
        space.systems[1].a = a;
        space.close();
        space
    }

    /// Adds the stages of a sensor that reads `raw`, with the stop open and closed; what the last of them gives.
    ///
    /// ```text
    /// ẏ_1 = ω y_2 ,   ẏ_2 = ω (raw/σ − y_1) − 2 ζ ω y_2
    /// ```
    ///
    /// The size `σ` of `raw` keeps the new states comparable to the others.
    ///
    /// # Errors
    /// [`RigError::DriveInSensor`] where derivatives of the drive are part of what is read.
    pub(crate) fn push_stages(&mut self, raw: [Functional; 2], stages: &[Stage]) -> Result<[Functional; 2], RigError> {
        if raw.iter().any(|raw| raw.input[1..] != [0.0; 2]) {
            return Err(RigError::DriveInSensor);
        }
        let size = raw.iter().flat_map(|raw| &raw.row).fold(0.0, |m: f64, x| m.max(x.abs()));
        let size = if size > 0.0 { size } else { 1.0 };
        let mut read = raw;
        for stage in stages {
            let (n, w) = (self.size(), stage.omega);
            self.b.extend([0.0; 2]);
            self.penetration.iter_mut().for_each(|p| p.row.extend([0.0; 2]));
            for (system, read) in self.systems.iter_mut().zip(&mut read) {
                read.row.extend([0.0; 2]);
                system.a.resize_with(n + 2, n + 2, |_, _| 0.0);
                system.a[(n, n + 1)] += w;
                system.a[(n + 1, n)] -= w;
                system.a[(n + 1, n + 1)] -= 2.0 * stage.damping_ratio * w;
                read.row.iter().enumerate().for_each(|(j, value)| system.a[(n + 1, j)] += w * value / size);
                system.c.extend([0.0, w * read.constant / size]);
            }
            let [open, closed] = [read[0].input[0], read[1].input[0]];
            // The drive itself enters alike, whether the stop is open or closed.
            debug_assert!(open == closed);
            self.b[n + 1] = w * open / size;
            for read in &mut read {
                *read = Functional::zero(n + 2);
                read.row[n] = size;
            }
        }
        Ok(read)
    }

    pub(crate) fn size(&self) -> usize {
        self.b.len()
    }

    /// Modal coordinates `q_k`, m·√kg.
    pub(crate) fn coordinates<'a>(&self, x: &'a [f64]) -> impl Iterator<Item = f64> + use<'a> {
        let scale = self.scale;
        x[..self.modes].iter().map(move |x| x / scale)
    }

    /// Modal velocities `q̇_k`, m·√kg/s.
    pub(crate) fn velocities<'a>(&self, x: &'a [f64]) -> &'a [f64] {
        &x[self.modes..2 * self.modes]
    }

    /// State with these modal coordinates and velocities; a shaker at rest.
    pub(crate) fn state(&self, coordinates: &[f64], velocities: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.size()];
        for k in 0..self.modes {
            (x[k], x[self.modes + k]) = (self.scale * coordinates[k], velocities[k]);
        }
        x
    }

    /// Structure alone.
    fn free(&self, structure: &LinearStructure) -> Mat<f64> {
        let mut a = Mat::zeros(self.size(), self.size());
        for (k, (ω, ζ)) in structure.omega.iter().zip(&structure.damping_ratios).enumerate() {
            a[(k, self.modes + k)] += self.scale;
            a[(self.modes + k, k)] -= ω * ω / self.scale;
            a[(self.modes + k, self.modes + k)] -= 2.0 * ζ * ω;
        }
        a
    }

    /// Adds the force at the drive point, and the equations of the shaker.
    fn excite(&mut self, a: &mut Mat<f64>) {
        let force = self.excitation_force();
        for (k, φ) in self.drive_point.shape.clone().into_iter().enumerate() {
            self.add_row(a, self.modes + k, φ, &force);
        }
        let Exciter::Shaker(shaker) = self.exciter else { return };
        let (x, v, i) = (2 * self.modes, 2 * self.modes + 1, 2 * self.modes + 2);
        let (root_mass, root_inductance) = (shaker.armature_mass.sqrt(), shaker.inductance.sqrt());
        a[(x, v)] += self.scale;
        a[(v, x)] -= shaker.suspension_stiffness / (shaker.armature_mass * self.scale);
        a[(v, v)] -= shaker.suspension_damping / shaker.armature_mass;
        self.add_row(a, v, -1.0 / root_mass, &force);
        let coupling = shaker.force_constant / (root_mass * root_inductance);
        a[(v, i)] += coupling;
        a[(i, v)] -= coupling;
        a[(i, i)] -= shaker.resistance / shaker.inductance;
        self.b[i] = 1.0 / root_inductance;
    }

    fn add_row(&mut self, a: &mut Mat<f64>, i: usize, factor: f64, functional: &Functional) {
        for (j, value) in functional.row.iter().enumerate() {
            a[(i, j)] += factor * value;
        }
        self.b[i] += factor * functional.input[0];
    }

    /// Adds the contact force to the closed system.
    fn close(&mut self) {
        let Some(stop) = self.stop.clone() else { return };
        let λ = self.contact_force(true);
        let closed = &mut self.systems[1];
        for (k, φ) in stop.shape.iter().enumerate() {
            let factor = -stop.side.sign() * φ;
            for (j, value) in λ.row.iter().enumerate() {
                closed.a[(self.modes + k, j)] += factor * value;
            }
            closed.c[self.modes + k] += factor * λ.constant;
        }
    }

    /// `Σ_k φ_k q_k`, m.
    pub(crate) fn modal_displacement(&self, shape: &[f64]) -> Functional {
        let mut functional = Functional::zero(self.size());
        functional.row.iter_mut().zip(shape).for_each(|(r, φ)| *r = φ / self.scale);
        functional
    }

    fn penetration_of(&self, stop: &Stop) -> Functional {
        let gap = Functional { constant: -stop.gap, ..Functional::zero(self.size()) };
        gap.plus(stop.side.sign(), &self.modal_displacement(&stop.shape))
    }

    /// Contact force `λ`, N.
    pub(crate) fn contact_force(&self, closed: bool) -> Functional {
        let zero = Functional::zero(self.size());
        match (&self.stop, &self.penetration) {
            (Some(stop), Some(penetration)) if closed => zero.plus(1.0 / stop.flexibility(), penetration),
            _ => zero,
        }
    }

    /// Force at the drive point, N.
    pub(crate) fn excitation_force(&self) -> Functional {
        let mut force = Functional::zero(self.size());
        match self.exciter {
            Exciter::IdealForce => force.input[0] = 1.0,
            Exciter::Shaker(shaker) => {
                let (k, c) = (shaker.stinger_at(&self.drive_point), shaker.stinger_damping);
                let root_mass = shaker.armature_mass.sqrt();
                for (j, φ) in self.drive_point.shape.iter().enumerate() {
                    force.row[j] = -k * φ / self.scale;
                    force.row[self.modes + j] = -c * φ;
                }
                force.row[2 * self.modes] = k / (root_mass * self.scale);
                force.row[2 * self.modes + 1] = c / root_mass;
            }
        }
        force
    }
}

/// Square root of a bound of the eigenvalues of the closed stiffness in coordinates of unit mass, rad/s.
fn rate(structure: &LinearStructure, at: &DrivePoint, exciter: Exciter, stop: Option<&Stop>) -> f64 {
    let mut stiffness: Vec<f64> = structure.omega.iter().map(|ω| ω * ω).collect();
    let mut spring = |k: f64, shape: &[f64], other: f64| {
        let sum = shape.iter().map(|φ| φ.abs()).sum::<f64>() + other;
        stiffness.iter_mut().zip(shape).for_each(|(entry, φ)| *entry += k * φ.abs() * sum);
        k * other * sum
    };
    if let Some(stop) = stop {
        spring(1.0 / stop.flexibility(), &stop.shape, 0.0);
    }
    let armature = match exciter {
        Exciter::IdealForce => 0.0,
        Exciter::Shaker(shaker) => {
            spring(shaker.stinger_at(at), &at.shape, 1.0 / shaker.armature_mass.sqrt())
                + shaker.suspension_stiffness / shaker.armature_mass
        }
    };
    stiffness.into_iter().fold(armature, f64::max).sqrt()
}
