use nlmodes_experiment::records;
use rand::SeedableRng;
use rand::rngs::Xoshiro256PlusPlus;
use rand_distr::{Distribution, StandardNormal};

use crate::error::{finite, not_negative, positive};
use crate::functional::Functional;
use crate::propagator::Propagator;
use crate::state_space::StateSpace;
use crate::structure::check_shape;
use crate::{Drive, DrivePoint, Exciter, LinearStructure, MotionQuantity, RigError, Sensor, SensorPlace, Stop};

/// Components of a rig.
#[derive(Debug, Clone, PartialEq)]
pub struct RigSetup {
    /// The structure without its stop.
    pub structure: LinearStructure,
    /// The drive point.
    pub drive_point: DrivePoint,
    /// Shaker or ideal force.
    pub exciter: Exciter,
    /// The stop, if there is one.
    pub stop: Option<Stop>,
    /// Sensors, one per channel.
    pub sensors: Vec<Sensor>,
    /// Sampling interval, s.
    pub interval: f64,
    /// Integration steps per sampling interval; by default the smallest sufficient number.
    pub substeps: Option<usize>,
    /// Seed of the noise.
    pub seed: u64,
}

/// A rig in motion.
///
/// The motion is exact up to rounding between contact instants, which are located to the same accuracy; only a drive of
/// high frequency is approximated (a polynomial of degree seven per step). Sensors are read at sampling instants; their
/// noise is determined by the random seed, channel by channel.
#[derive(Debug, Clone)]
pub struct VirtualRig {
    setup: RigSetup,
    space: StateSpace,
    propagator: Propagator,
    substeps: usize,
    channels: Vec<Channel>,
    x: Vec<f64>,
    closed: bool,
    input: [f64; 3],
    intervals: u64,
}

#[derive(Debug, Clone)]
struct Channel {
    /// Stop open, closed.
    output: [Functional; 2],
    noise: f64,
    random: Xoshiro256PlusPlus,
}

impl VirtualRig {
    /// A rig at rest.
    ///
    /// # Errors
    /// [`RigError::StepTooLarge`] if `substeps` is given and too small, and the variants about quantities and shapes.
    pub fn new(setup: RigSetup) -> Result<Self, RigError> {
        check(&setup)?;
        let space = StateSpace::new(&setup.structure, &setup.drive_point, setup.exciter, setup.stop.as_ref());
        let propagator = Propagator::new(&space, setup.interval, setup.substeps)?;
        let substeps = (setup.interval / propagator.step()).round() as usize;
        let channels = channels(&setup, &space)?;
        let x = vec![0.0; space.size()];
        let closed = setup.stop.as_ref().is_some_and(|stop| stop.gap < 0.0);
        Ok(Self { setup, space, propagator, substeps, channels, x, closed, input: [0.0; 3], intervals: 0 })
    }

    /// Its components.
    pub fn setup(&self) -> &RigSetup {
        &self.setup
    }

    /// Integration steps per sampling interval.
    pub fn substeps(&self) -> usize {
        self.substeps
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.intervals as f64 * self.setup.interval
    }

    /// Advances by one sampling interval.
    ///
    /// # Errors
    /// [`RigError::DriveTooFast`], [`RigError::Chatter`], [`RigError::Diverged`].
    pub fn advance(&mut self, drive: &Drive) -> Result<(), RigError> {
        for k in 0..self.substeps {
            let (start, end) = (k as f64 / self.substeps as f64, (k + 1) as f64 / self.substeps as f64);
            let input = drive.polynomial(start, end, self.setup.interval)?;
            self.propagator.advance(
                &mut self.x,
                &mut self.closed,
                &input,
                self.intervals as f64 * self.setup.interval,
            )?;
        }
        self.input = drive.at_end(self.setup.interval);
        self.intervals += 1;
        if self.x.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(RigError::Diverged { time: self.time() }) }
    }

    /// Reads a channel, with noise. Each reading has new noise.
    ///
    /// # Errors
    /// [`RigError::NoChannel`].
    pub fn read(&mut self, channel: usize) -> Result<f64, RigError> {
        let exact = self.exact(channel)?;
        let Channel { noise, random, .. } = &mut self.channels[channel];
        if *noise == 0.0 {
            return Ok(exact);
        }
        let normal: f64 = StandardNormal.sample(random);
        Ok(exact + *noise * normal)
    }

    /// The noise-free value of a channel.
    ///
    /// # Errors
    /// [`RigError::NoChannel`].
    pub fn exact(&self, channel: usize) -> Result<f64, RigError> {
        let missing = RigError::NoChannel { channel, channels: self.channels.len() };
        let channel = self.channels.get(channel).ok_or(missing)?;
        Ok(channel.output[usize::from(self.closed)].value(&self.x, &self.input))
    }

    /// Whether the contact is closed.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Modal coordinates `q_k`, m·√kg, which no sensor measures.
    pub fn modal_coordinates(&self) -> Vec<f64> {
        self.space.coordinates(&self.x).collect()
    }

    /// Sets the state of the structure, m·√kg and m·√kg/s, with the exciter at rest.
    ///
    /// # Errors
    /// [`RigError::ModeCount`], [`RigError::NotFinite`].
    pub fn set_motion(&mut self, coordinates: &[f64], velocities: &[f64]) -> Result<(), RigError> {
        check_shape("modal coordinates", coordinates, self.setup.structure.modes())?;
        check_shape("modal velocities", velocities, self.setup.structure.modes())?;
        self.x = self.space.state(coordinates, velocities);
        let penetration = self.space.penetration.as_ref();
        self.closed = penetration.is_some_and(|p| p.value(&self.x, &[0.0; 3]) > 0.0);
        Ok(())
    }

    /// Kinetic and strain energy of structure and stop, J; that of an exciter is not counted.
    pub fn energy(&self) -> f64 {
        let strain = self.space.coordinates(&self.x).zip(&self.setup.structure.omega).map(|(q, ω)| (ω * q).powi(2));
        let kinetic = self.space.velocities(&self.x).iter().map(|v| v * v);
        let force = self.space.contact_force(self.closed).value(&self.x, &self.input);
        let stop = self.setup.stop.as_ref().map_or(0.0, |stop| stop.flexibility() * force * force);
        0.5 * (strain.sum::<f64>() + kinetic.sum::<f64>() + stop)
    }

    /// Description of a channel, in SI units.
    ///
    /// # Errors
    /// [`RigError::NoChannel`].
    pub fn channel(&self, channel: usize) -> Result<records::Channel, RigError> {
        let missing = RigError::NoChannel { channel, channels: self.channels.len() };
        let sensor = self.setup.sensors.get(channel).ok_or(missing)?;
        let position = match &sensor.place {
            SensorPlace::Excitation | SensorPlace::DrivePoint(_) => Some(self.setup.drive_point.position),
            SensorPlace::Stop | SensorPlace::StopPoint(_) => self.setup.stop.as_ref().map(|stop| stop.position),
            SensorPlace::Point { position, .. } => Some(*position),
        };
        Ok(records::Channel::new(sensor.name.clone(), sensor.place.quantity(), sensor.place.role(), position))
    }
}

fn check(setup: &RigSetup) -> Result<(), RigError> {
    let modes = setup.structure.modes();
    setup.structure.check()?;
    setup.drive_point.check(modes)?;
    setup.exciter.check()?;
    positive("sampling interval (s)", setup.interval)?;
    if let Some(stop) = &setup.stop {
        stop.check(modes)?;
    }
    for sensor in &setup.sensors {
        not_negative("standard deviation of the noise", sensor.noise)?;
        if let SensorPlace::Point { shape, position, .. } = &sensor.place {
            check_shape(&format!("shape at sensor `{}`", sensor.name), shape, modes)?;
            finite("position of a sensor (m)", *position)?;
        }
    }
    Ok(())
}

fn channels(setup: &RigSetup, space: &StateSpace) -> Result<Vec<Channel>, RigError> {
    let channel = |(index, sensor): (usize, &Sensor)| {
        Ok(Channel {
            output: [output(setup, space, sensor, false)?, output(setup, space, sensor, true)?],
            noise: sensor.noise,
            // One random stream per channel: an additional channel does not change the noise of the others.
            random: Xoshiro256PlusPlus::seed_from_u64(setup.seed.wrapping_add(index as u64)),
        })
    };
    setup.sensors.iter().enumerate().map(channel).collect()
}

/// Value of a sensor with the stop open or closed.
fn output(setup: &RigSetup, space: &StateSpace, sensor: &Sensor, closed: bool) -> Result<Functional, RigError> {
    let stop = || setup.stop.as_ref().ok_or_else(|| RigError::NoStop { sensor: sensor.name.clone() });
    let differentiate = |displacement: Functional, motion: MotionQuantity| {
        let system = &space.systems[usize::from(closed)];
        let orders = match motion {
            MotionQuantity::Displacement => 0,
            MotionQuantity::Velocity => 1,
            MotionQuantity::Acceleration => 2,
        };
        (0..orders).fold(displacement, |output, _| output.derivative(&system.a, &system.c, &space.b))
    };
    Ok(match &sensor.place {
        SensorPlace::Excitation => space.excitation_force(),
        SensorPlace::Stop => {
            stop()?;
            space.contact_force(closed)
        }
        SensorPlace::Point { motion, shape, .. } => differentiate(space.modal_displacement(shape), *motion),
        SensorPlace::DrivePoint(motion) => {
            let modal = space.modal_displacement(&setup.drive_point.shape);
            differentiate(modal.plus(setup.drive_point.residual, &space.excitation_force()), *motion)
        }
        SensorPlace::StopPoint(motion) => {
            let stop = stop()?;
            let yielding = -stop.side.sign() * stop.residual;
            let modal = space.modal_displacement(&stop.shape);
            differentiate(modal.plus(yielding, &space.contact_force(closed)), *motion)
        }
    })
}
