//! The beam of Table 1 of the paper as a modal model: measured frequencies and damping ratios, computed shapes.
//!
//! Shapes: Timoshenko beam of 21 elements refined towards the tip (first over last 9.1958536), E = 187.60 GPa, ν = 0.3,
//! κ = 5/6, consistent mass, no mass dropped, with the first frequency at 40.10 Hz. The drive point at a tenth of the
//! length is inside the first element, whose static interpolation gives the shapes there.

use nlmodes::rig::{
    ContactLaw, DrivePoint, Exciter, LinearStructure, ModalReduction, MotionQuantity, RigSetup, Sensor, SensorPlace,
    Side, Stop,
};
use nlmodes_fem::{Beam, MassMatrix, Material, Mesh, Section, Support};
use nlmodes_model::{DofKind, StructuralModel};

pub const LENGTH: f64 = 0.62975520;
pub const FREQUENCIES_HZ: [f64; 6] = [40.10, 268.62, 758.26, 1371.82, 2427.72, 3508.31];
pub const DAMPING_RATIOS: [f64; 6] = [0.0019, 0.0076, 0.0005, 0.0017, 0.0010, 0.0014];
pub const GAP: f64 = 1.03e-3;
pub const ACCELEROMETERS: [f64; 6] = [0.199565, 0.306437, 0.390059, 0.482652, 0.546737, 0.591091];
pub const INTERVAL: f64 = 5e-5;

const YOUNGS_MODULUS: f64 = 187.60e9;

/// Channels of [`setup`].
pub const FORCE: usize = 0;
pub const DRIVE_DISPLACEMENT: usize = 1;

/// The finite element beam and its six lowest bending modes.
pub struct Shapes {
    beam: Beam,
    model: StructuralModel,
    reduction: ModalReduction,
}

impl Shapes {
    pub fn new() -> Self {
        let beam = Beam {
            material: Material::new(YOUNGS_MODULUS, 7730.0).unwrap(),
            section: Section::rectangle(0.012, 0.020).unwrap(),
            mesh: Mesh::graded(LENGTH, 21, 9.1958536).unwrap(),
            mass_matrix: MassMatrix::Consistent,
            start: Support::Clamped,
            end: Support::Free,
        };
        let model = beam.assemble(&[]).unwrap();
        let reduction =
            ModalReduction::new(model.mass(), model.stiffness(), model.dofs(), DofKind::Deflection, 6).unwrap();
        Self { beam, model, reduction }
    }

    /// Mode shapes at `x`, 1/√kg.
    pub fn at(&self, x: f64) -> Vec<f64> {
        self.reduction.shape(&self.beam.deflection_at(self.model.dofs(), x).unwrap())
    }

    /// Residual flexibility at `x`, m/N: `x³/3EI + x/κGA` less that of the six modes, exact also inside an element.
    pub fn residual(&self, x: f64) -> f64 {
        let (ei, ga) = (YOUNGS_MODULUS * 8e-9, 5.0 / 6.0 * YOUNGS_MODULUS / 2.6 * 2.4e-4);
        let modal = self.at(x).into_iter().zip(self.reduction.omega()).map(|(φ, ω)| (φ / ω).powi(2));
        x.powi(3) / (3.0 * ei) + x / ga - modal.sum::<f64>()
    }

    /// The same by finite elements; identical at nodes.
    pub fn residual_of_elements(&self, x: f64) -> f64 {
        self.reduction.residual(&self.beam.deflection_at(self.model.dofs(), x).unwrap())
    }
}

/// The rig of Section 5: compliant stop, sensors as in Fig. 6, without noise.
pub fn setup(exciter: Exciter) -> RigSetup {
    let shapes = Shapes::new();
    let drive = 0.1 * LENGTH;
    let point = |i: usize, position: f64| {
        let place = SensorPlace::Point { motion: MotionQuantity::Acceleration, position, shape: shapes.at(position) };
        Sensor::new(format!("a{i}"), place, 0.0)
    };
    let mut sensors = vec![
        Sensor::new("force", SensorPlace::Excitation, 0.0),
        Sensor::new("x_ex", SensorPlace::DrivePoint(MotionQuantity::Displacement), 0.0),
        Sensor::new("v_ex", SensorPlace::DrivePoint(MotionQuantity::Velocity), 0.0),
        Sensor::new("x_tip", SensorPlace::StopPoint(MotionQuantity::Displacement), 0.0),
        Sensor::new("v_tip", SensorPlace::StopPoint(MotionQuantity::Velocity), 0.0),
        Sensor::new("f_contact", SensorPlace::Stop, 0.0),
    ];
    sensors.extend(ACCELEROMETERS.into_iter().enumerate().map(|(i, x)| point(i + 1, x)));
    RigSetup {
        structure: LinearStructure {
            omega: FREQUENCIES_HZ.map(|f| std::f64::consts::TAU * f).to_vec(),
            damping_ratios: DAMPING_RATIOS.to_vec(),
        },
        drive_point: DrivePoint { position: drive, shape: shapes.at(drive), residual: shapes.residual(drive) },
        exciter,
        stop: Some(Stop {
            position: LENGTH,
            shape: shapes.at(LENGTH),
            side: Side::Positive,
            gap: GAP,
            law: ContactLaw::Elastic { stiffness: 2.3e6 },
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
