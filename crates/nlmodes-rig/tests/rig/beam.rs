//! The beam of Table 1 of the paper as a modal model: measured frequencies and damping ratios, computed shapes.
//!
//! Shapes: Timoshenko beam of 21 elements refined towards the tip (first over last 9.1958536), E = 187.60 GPa, ν = 0.3,
//! κ = 5/6, consistent mass, nothing dropped, which has its first frequency at 40.10 Hz. The drive point at a tenth of the length lies
//! inside the first element, whose static interpolation gives the shapes there.

use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop as Node, Support};
use nlmodes_model::{ContactLaw, DofKind, LinearModes, Side, StructuralModel, linear_modes};
use nlmodes_rig::{DrivePoint, Exciter, ModalStructure, Motion, Place, RigSetup, Sensor, Stop, StopLaw, StopSide};

pub const LENGTH: f64 = 0.62975520;
pub const FREQUENCIES_HZ: [f64; 6] = [40.10, 268.62, 758.26, 1371.82, 2427.72, 3508.31];
pub const DAMPING_RATIOS: [f64; 6] = [0.0019, 0.0076, 0.0005, 0.0017, 0.0010, 0.0014];
pub const GAP: f64 = 1.03e-3;
pub const INTERVAL: f64 = 5e-5;

const YOUNGS_MODULUS: f64 = 187.60e9;
const WIDTH: f64 = 0.012;
const HEIGHT: f64 = 0.020;

/// Channels of [`setup`].
pub const FORCE: usize = 0;
pub const DRIVE_DISPLACEMENT: usize = 1;

/// The finite element beam.
pub struct Shapes {
    mesh: Mesh,
    model: StructuralModel,
    modes: LinearModes,
}

impl Shapes {
    pub fn new() -> Self {
        let mesh = Mesh::graded(LENGTH, 21, 9.1958536).unwrap();
        let beam = Beam {
            material: Material::new(YOUNGS_MODULUS, 7730.0).unwrap(),
            section: Section::rectangle(WIDTH, HEIGHT).unwrap(),
            mesh: mesh.clone(),
            mass_matrix: MassMatrix::Consistent,
            start: Support::Clamped,
            end: Support::Free,
        };
        let tip = Node {
            position: LENGTH,
            direction: Direction::Transverse,
            side: Side::Positive,
            gap: GAP,
            law: ContactLaw::Rigid,
        };
        let model = beam.assemble(&[tip]).unwrap();
        let modes = linear_modes(model.mass(), model.stiffness(), 12).unwrap();
        Self { mesh, model, modes }
    }

    /// The first six bending modes at `x`, 1/√kg, positive at the tip.
    pub fn at(&self, x: f64) -> Vec<f64> {
        let bending = (0..self.modes.omega.len()).filter(|&k| self.deflection(k, LENGTH).abs() > 1e-6);
        bending.take(6).map(|k| self.deflection(k, x) * self.deflection(k, LENGTH).signum()).collect()
    }

    /// Eigenfrequencies of these modes in the finite element model, rad/s.
    fn omega(&self) -> Vec<f64> {
        let bending = (0..self.modes.omega.len()).filter(|&k| self.deflection(k, LENGTH).abs() > 1e-6);
        bending.take(6).map(|k| self.modes.omega[k]).collect()
    }

    /// Static flexibility at `x` less that of the six modes, m/N; `x³/3EI + x/κGA` is exact.
    pub fn residual(&self, x: f64) -> f64 {
        let (ei, ga) = (bending_stiffness(), shear_stiffness());
        let statics = x.powi(3) / (3.0 * ei) + x / ga;
        statics - self.at(x).iter().zip(self.omega()).map(|(φ, ω)| (φ / ω).powi(2)).sum::<f64>()
    }

    /// Deflection of mode `k` by the static shape functions of the element in which `x` lies.
    fn deflection(&self, k: usize, x: f64) -> f64 {
        let nodes = self.mesh.nodes();
        let element = (1..nodes.len()).find(|&i| x <= nodes[i] + 1e-12).unwrap() - 1;
        let l = nodes[element + 1] - nodes[element];
        let (s, p) = ((x - nodes[element]) / l, 12.0 * bending_stiffness() / (shear_stiffness() * l * l));
        let of = |node, kind| {
            let dof = self.model.dofs().iter().position(|dof| dof.node == node && dof.kind == kind);
            dof.map_or(0.0, |dof| self.modes.shapes[(dof, k)])
        };
        let (s2, s3) = (s * s, s * s * s);
        let near = (2.0 * s3 - 3.0 * s2 - p * s + 1.0 + p) * of(element, DofKind::Deflection)
            + l * (s3 - (2.0 + p / 2.0) * s2 + (1.0 + p / 2.0) * s) * of(element, DofKind::Rotation);
        let far = (-2.0 * s3 + 3.0 * s2 + p * s) * of(element + 1, DofKind::Deflection)
            + l * (s3 - (1.0 - p / 2.0) * s2 - p / 2.0 * s) * of(element + 1, DofKind::Rotation);
        (near + far) / (1.0 + p)
    }
}

fn bending_stiffness() -> f64 {
    YOUNGS_MODULUS * WIDTH * HEIGHT.powi(3) / 12.0
}

fn shear_stiffness() -> f64 {
    5.0 / 6.0 * YOUNGS_MODULUS / 2.6 * WIDTH * HEIGHT
}

/// The rig of Section 5: compliant stop, sensors as in Fig. 6, without noise.
pub fn setup(exciter: Exciter) -> RigSetup {
    let shapes = Shapes::new();
    let drive = 0.1 * LENGTH;
    let point = |i: usize, position: f64| {
        let place = Place::Point { motion: Motion::Acceleration, position, shape: shapes.at(position) };
        Sensor::new(format!("a{i}"), place, 0.0)
    };
    let mut sensors = vec![
        Sensor::new("force", Place::Excitation, 0.0),
        Sensor::new("x_ex", Place::DrivePoint(Motion::Displacement), 0.0),
        Sensor::new("v_ex", Place::DrivePoint(Motion::Velocity), 0.0),
        Sensor::new("x_tip", Place::StopPoint(Motion::Displacement), 0.0),
        Sensor::new("v_tip", Place::StopPoint(Motion::Velocity), 0.0),
        Sensor::new("f_contact", Place::Stop, 0.0),
    ];
    let positions = [0.199565, 0.306437, 0.390059, 0.482652, 0.546737, 0.591091];
    sensors.extend(positions.into_iter().enumerate().map(|(i, x)| point(i + 1, x)));
    RigSetup {
        structure: ModalStructure {
            omega: FREQUENCIES_HZ.map(|f| std::f64::consts::TAU * f).to_vec(),
            damping_ratios: DAMPING_RATIOS.to_vec(),
        },
        drive_point: DrivePoint { position: drive, shape: shapes.at(drive), residual: shapes.residual(drive) },
        exciter,
        stop: Some(Stop {
            position: LENGTH,
            shape: shapes.at(LENGTH),
            side: StopSide::Positive,
            gap: GAP,
            law: StopLaw::Compliant { stiffness: 2.3e6 },
            residual: 0.0,
        }),
        sensors,
        interval: INTERVAL,
        substeps: None,
        seed: 1,
    }
}

/// Noise of each channel, as of good sensors at such a rig.
pub fn with_noise(mut setup: RigSetup) -> RigSetup {
    let noise = [0.02, 5e-8, 2e-5, 2e-7, 2e-4, 0.1, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05];
    for (sensor, noise) in setup.sensors.iter_mut().zip(noise) {
        sensor.noise = noise;
    }
    setup
}
