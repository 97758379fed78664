//! Virtual tests of finite-element structures: a bench with exciter, stop and sensors, a schedule under the
//! phase-locked loop, and each level's record through the extraction that measured records go through.

use std::ops::ControlFlow;

use nlmodes_experiment::extraction::{self, ExtractionError, ExtractionSettings, RecordExtraction, extract};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_modal::{LinearModes, ModalError};
use nlmodes_model::{Contact, ContactLaw, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};

use crate::branches::{Ended, Watch};
use crate::rig::{
    Chain, ControlledHarmonics, DrivePoint, Exciter, LevelOutcome, LinearStructure, ModalReduction, MotionQuantity,
    RigError, RigSetup, Sensor, SensorPlace, Stop, VirtualTest,
};

/// Channel of the excitation force in [`Bench::setup`].
pub const FORCE: usize = 0;
/// Channel of the drive point's displacement.
pub const DRIVE_DISPLACEMENT: usize = 1;
/// First channel of the accelerometers.
const ACCELEROMETERS: usize = 3;

/// A point of a structure: a displacement as a weighted sum of its degrees of freedom, as of
/// [`Beam::deflection_at`](nlmodes_fem::Beam::deflection_at).
#[derive(Debug, Clone, PartialEq)]
pub struct BenchPoint {
    /// Position along the structure, m.
    pub position: f64,
    /// Degrees of freedom and their weights.
    pub weights: Vec<(usize, f64)>,
}

/// A stop of a bench.
#[derive(Debug, Clone, PartialEq)]
pub struct BenchStop {
    /// Its place.
    pub at: BenchPoint,
    /// On which side.
    pub side: Side,
    /// Gap at rest, m.
    pub gap: f64,
    /// Rigid, with the residual flexibility of the structure; or elastic, on the modes alone.
    pub law: ContactLaw,
}

/// Standard deviations of the sensors' noise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BenchNoise {
    /// Excitation force, N.
    pub force: f64,
    /// Displacements, m.
    pub displacement: f64,
    /// Velocities, m/s.
    pub velocity: f64,
    /// Accelerations, m/s².
    pub acceleration: f64,
    /// Contact force, N.
    pub contact_force: f64,
}

/// A bench as in Fig. 6 of the paper: displacement and velocity at drive point and stop, accelerometers between, both
/// forces.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    /// Angular eigenfrequencies, rad/s: measured ones, or those of the reduction.
    pub omega: Vec<f64>,
    /// Damping ratios.
    pub damping_ratios: Vec<f64>,
    /// Where the exciter pushes.
    pub drive: BenchPoint,
    /// The stop, if there is one.
    pub stop: Option<BenchStop>,
    /// Accelerometers.
    pub accelerometers: Vec<BenchPoint>,
    /// Shaker or ideal force.
    pub exciter: Exciter,
    /// Sampling interval, s.
    pub interval: f64,
    /// Noise of the sensors.
    pub noise: BenchNoise,
    /// Its seed.
    pub seed: u64,
    /// What else lies between quantities and samples, by the name of the channel.
    pub chains: Vec<(String, Chain)>,
}

/// The names of the channels of a bench with so many accelerometers, with or without a stop.
pub fn channel_names(accelerometers: usize, stop: bool) -> Vec<String> {
    let mut names: Vec<String> = ["force_N", "x_drive_m", "v_drive_mps"].map(str::to_owned).to_vec();
    names.extend((1..=accelerometers).map(|i| format!("a{i}_mps2")));
    if stop {
        names.extend(["x_stop_m", "v_stop_mps", "f_contact_N"].map(str::to_owned));
    }
    names
}

impl Bench {
    /// The rig: shapes and residual flexibilities of the reduction, frequencies and damping of the bench.
    pub fn setup(&self, reduction: &ModalReduction) -> RigSetup {
        let mut places = vec![
            (SensorPlace::Excitation, self.noise.force),
            (SensorPlace::DrivePoint(MotionQuantity::Displacement), self.noise.displacement),
            (SensorPlace::DrivePoint(MotionQuantity::Velocity), self.noise.velocity),
        ];
        places.extend(self.accelerometers.iter().map(|point| {
            let shape = reduction.shape(&point.weights);
            let place = SensorPlace::Point { motion: MotionQuantity::Acceleration, position: point.position, shape };
            (place, self.noise.acceleration)
        }));
        if self.stop.is_some() {
            places.extend([
                (SensorPlace::StopPoint(MotionQuantity::Displacement), self.noise.displacement),
                (SensorPlace::StopPoint(MotionQuantity::Velocity), self.noise.velocity),
                (SensorPlace::Stop, self.noise.contact_force),
            ]);
        }
        let chain = |name: &str| self.chains.iter().find(|(of, _)| of == name).map(|(_, chain)| chain.clone());
        let names = channel_names(self.accelerometers.len(), self.stop.is_some());
        let sensors = names.into_iter().zip(places).map(|(name, (place, noise))| Sensor {
            chain: chain(&name).unwrap_or_default(),
            ..Sensor::new(name, place, noise)
        });
        let sensors = sensors.collect();
        RigSetup {
            structure: LinearStructure { omega: self.omega.clone(), damping_ratios: self.damping_ratios.clone() },
            drive_point: DrivePoint {
                position: self.drive.position,
                shape: reduction.shape(&self.drive.weights),
                residual: reduction.residual(&self.drive.weights),
            },
            exciter: self.exciter,
            stop: self.stop.as_ref().map(|stop| stop.reduced(reduction)),
            sensors,
            interval: self.interval,
            substeps: None,
            seed: self.seed,
        }
    }

    /// The linear modes at all motion sensors, for the extraction; as many of the lowest as there are positions.
    ///
    /// # Errors
    /// [`ModalError`], among others if the sensors cannot tell the modes apart.
    pub fn linear_modes(&self, reduction: &ModalReduction) -> Result<LinearModes, ModalError> {
        let stop = self.stop.as_ref().map(|stop| &stop.at);
        let points: Vec<&BenchPoint> = std::iter::once(&self.drive).chain(&self.accelerometers).chain(stop).collect();
        let positions: Vec<f64> = points.iter().map(|point| point.position).collect();
        let mut places = positions.clone();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let shape = |point: &&BenchPoint| reduction.shape(&point.weights).into_iter().take(places.len()).collect();
        let shapes: Vec<Vec<f64>> = points.iter().map(shape).collect();
        LinearModes::new(&positions, &self.omega, &self.damping_ratios, &shapes)
    }

    /// Harmonics of the force up to this one under control, by the motion at drive point, accelerometers and stop and
    /// these modes there, as of [`linear_modes`](Self::linear_modes).
    pub fn controlled_harmonics(&self, harmonics: usize, modes: LinearModes) -> ControlledHarmonics {
        let last = ACCELEROMETERS + self.accelerometers.len();
        let channels = std::iter::once(DRIVE_DISPLACEMENT).chain(ACCELEROMETERS..last);
        // Behind the accelerometers is the displacement at the stop.
        let channels = channels.chain(self.stop.is_some().then_some(last)).collect();
        ControlledHarmonics { harmonics, modes, channels, drive: 0 }
    }

    /// The undamped modes and the stop as a model whose nonlinear mode can be computed: modal coordinates with unit
    /// mass, and the massless tip of a spring that is the stop's own or, at a rigid one, the residual flexibility `R`
    /// of the modes left out.
    ///
    /// ```text
    /// K = [Λ + k φ φᵀ, −k φ; −k φᵀ, k] ,   k = k_c or 1/R
    /// ```
    ///
    /// `None` without a stop.
    ///
    /// # Errors
    /// [`RigError::RigidStopWithoutFlexibility`], and what the model has against the numbers.
    pub fn backbone_model(&self, reduction: &ModalReduction) -> Result<Option<MasslessContactModel>, RigError> {
        let Some(stop) = &self.stop else { return Ok(None) };
        let reduced = stop.reduced(reduction);
        let k = match stop.law {
            ContactLaw::Elastic { stiffness } => stiffness,
            ContactLaw::Rigid if reduced.residual > 0.0 => 1.0 / reduced.residual,
            ContactLaw::Rigid => return Err(RigError::RigidStopWithoutFlexibility { residual: reduced.residual }),
        };
        let (shape, n) = (&reduced.shape, self.omega.len());
        let (mut stiffness, mut mass) = (vec![(n, n, k)], Vec::new());
        for (i, omega) in self.omega.iter().enumerate() {
            mass.push((i, i, 1.0));
            stiffness.push((i, i, omega.powi(2)));
            stiffness.extend([(i, n, -k * shape[i]), (n, i, -k * shape[i])]);
            stiffness.extend((0..n).map(|j| (i, j, k * shape[i] * shape[j])));
        }
        let [stiffness, mass] = [stiffness, mass].map(|entries| sparse_from_triplets(n + 1, n + 1, &entries));
        let dof = |node| Dof { node, position: node as f64, kind: DofKind::Deflection };
        let contact = Contact::rigid(n, stop.side, stop.gap);
        let model = StructuralModel::new(mass?, stiffness?, (0..=n).map(dof).collect(), vec![contact])?;
        Ok(Some(MasslessContactModel::new(&model, &Drop)?))
    }

    /// The stop as the extraction sees it.
    pub fn extraction_stop(&self) -> Option<extraction::Stop> {
        let stop = self.stop.as_ref()?;
        let positive = stop.side == Side::Positive;
        Some(extraction::Stop { position: stop.at.position, gap: stop.gap, positive })
    }
}

impl BenchStop {
    fn reduced(&self, reduction: &ModalReduction) -> Stop {
        let residual = match self.law {
            ContactLaw::Rigid => reduction.residual(&self.at.weights),
            ContactLaw::Elastic { .. } => 0.0,
        };
        let shape = reduction.shape(&self.at.weights);
        Stop { position: self.at.position, shape, side: self.side, gap: self.gap, law: self.law, residual }
    }
}

/// A level of a test and what its record gives.
#[derive(Debug)]
pub struct TestLevel {
    /// What the rig did.
    pub outcome: LevelOutcome,
    /// What a measured record would have told.
    pub extraction: Result<RecordExtraction, ExtractionError>,
}

impl TestLevel {
    /// Names of all findings, of the level and of its extraction, each once, separated by spaces.
    pub fn finding_names(&self) -> String {
        let mut names: Vec<&str> = self.outcome.findings.iter().map(|finding| finding.name()).collect();
        if let Ok(extraction) = &self.extraction {
            names.extend(extraction.findings.iter().map(|finding| finding.name()));
        }
        let mut unique: Vec<&str> = Vec::with_capacity(names.len());
        for name in names {
            if !unique.contains(&name) {
                unique.push(name);
            }
        }
        unique.join(" ")
    }
}

/// What a test came to.
#[derive(Debug)]
pub struct TestRun {
    /// The levels that were recorded.
    pub levels: Vec<TestLevel>,
    /// Why there are not as many as in the schedule.
    pub failure: Option<RigError>,
}

/// Runs a test and extracts from each record as soon as it is there. `observe` sees each level. Where the motion cannot
/// be followed any further, the levels before remain.
pub fn run(test: &VirtualTest, settings: &ExtractionSettings, mut observe: impl FnMut(&TestLevel)) -> TestRun {
    run_while(test, settings, &Watch::default(), |level| {
        observe(level);
        ControlFlow::Continue(())
    })
}

/// As [`run`], as long as `watch` lets it go on, and up to the level behind which `observe` ends it.
pub fn run_while(
    test: &VirtualTest,
    settings: &ExtractionSettings,
    watch: &Watch,
    mut observe: impl FnMut(&TestLevel) -> ControlFlow<()>,
) -> TestRun {
    let mut levels = Vec::with_capacity(test.control.schedule.count);
    let asking = watch.clone();
    let asked = move || match asking.begins("bringing the rig to its next level") {
        Ok(()) => ControlFlow::Continue(()),
        Err(Ended) => ControlFlow::Break(()),
    };
    let outcome = test.run_while(asked, |outcome| {
        let level = TestLevel { outcome: outcome.clone(), extraction: extract(&outcome.record, settings) };
        let told = observe(&level);
        levels.push(level);
        told
    });
    TestRun { levels, failure: outcome.err() }
}
