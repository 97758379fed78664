use nlmodes_experiment::records;
use rand::SeedableRng;
use rand::rngs::Xoshiro256PlusPlus;
use rand_distr::{Distribution, StandardNormal};

use crate::rig::chain::Samples;
use crate::rig::error::{finite, not_negative, positive};
use crate::rig::functional::Functional;
use crate::rig::propagator::Propagator;
use crate::rig::state_space::StateSpace;
use crate::rig::structure::check_shape;
use crate::rig::{
    Chain, Drive, DrivePoint, Exciter, LinearStructure, MotionQuantity, RigError, Sensor, SensorPlace, Stop,
};

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
    /// What happens to its samples, if anything does.
    samples: Option<Samples>,
}

impl VirtualRig {
    /// A rig at rest.
    ///
    /// # Errors
    /// [`RigError::StepTooLarge`] if `substeps` is given and too small, and the variants about quantities and shapes.
    pub fn new(setup: RigSetup) -> Result<Self, RigError> {
        check(&setup)?;
        let mut space = StateSpace::new(&setup.structure, &setup.drive_point, setup.exciter, setup.stop.as_ref());
        let channels = channels(&setup, &mut space)?;
        let propagator = Propagator::new(&space, setup.interval, setup.substeps)?;
        let substeps = (setup.interval / propagator.step()).round() as usize;
        let x = vec![0.0; space.size()];
        let closed = setup.stop.as_ref().is_some_and(|stop| stop.gap < 0.0);
        let mut rig = Self { setup, space, propagator, substeps, channels, x, closed, input: [0.0; 3], intervals: 0 };
        rig.sample();
        Ok(rig)
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
        self.sample();
        if self.x.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(RigError::Diverged { time: self.time() }) }
    }

    /// Hands the quantities on to the channels that have a past.
    fn sample(&mut self) {
        let (x, input, closed) = (&self.x, &self.input, usize::from(self.closed));
        for channel in &mut self.channels {
            if let Some(samples) = &mut channel.samples {
                samples.push(channel.output[closed].value(x, input));
            }
        }
    }

    /// Reads a channel, with noise. Each reading has new noise.
    ///
    /// # Errors
    /// [`RigError::NoChannel`].
    pub fn read(&mut self, channel: usize) -> Result<f64, RigError> {
        let (exact, time) = (self.exact(channel)?, self.time());
        let Channel { noise, random, samples, .. } = &mut self.channels[channel];
        let normal: f64 = if *noise == 0.0 { 0.0 } else { StandardNormal.sample(random) };
        let noise = *noise * normal;
        Ok(samples.as_mut().map_or(exact + noise, |samples| samples.read(time, noise)))
    }

    /// The value of a channel behind cell and filter, without noise and what happens to samples.
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

    /// The states in their own scale: modal coordinates and velocities, and those of a shaker.
    pub(crate) fn states(&self) -> &[f64] {
        &self.x
    }

    /// Continues from these states, after an interval with this drive.
    pub(crate) fn set_states(&mut self, x: &[f64], drive: &Drive) {
        self.x.copy_from_slice(x);
        let penetration = self.space.penetration.as_ref();
        self.closed = penetration.is_some_and(|p| p.value(&self.x, &[0.0; 3]) > 0.0);
        self.input = drive.at_end(self.setup.interval);
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
        sensor.chain.check()?;
        if let SensorPlace::Point { shape, position, .. } = &sensor.place {
            check_shape(&format!("shape at sensor `{}`", sensor.name), shape, modes)?;
            finite("position of a sensor (m)", *position)?;
        }
    }
    Ok(())
}

fn channels(setup: &RigSetup, space: &mut StateSpace) -> Result<Vec<Channel>, RigError> {
    let mut channels = Vec::with_capacity(setup.sensors.len());
    for (index, sensor) in setup.sensors.iter().enumerate() {
        let raw = [output(setup, space, sensor, false)?, output(setup, space, sensor, true)?];
        let output = if sensor.chain.stages.is_empty() { raw } else { space.push_stages(raw, &sensor.chain.stages)? };
        let stream = |number: u64| setup.seed.wrapping_add(index as u64).wrapping_add(number << 32);
        let disturbed = sensor.chain != Chain { stages: sensor.chain.stages.clone(), ..Chain::default() };
        channels.push(Channel {
            output,
            noise: sensor.noise,
            // One random stream per channel: an additional channel does not change the noise of the others.
            random: Xoshiro256PlusPlus::seed_from_u64(stream(0)),
            samples: disturbed.then(|| Samples::new(&sensor.chain, setup.interval, stream(1))),
        });
    }
    // Stages of later sensors have added states.
    let size = space.size();
    channels.iter_mut().flat_map(|channel| &mut channel.output).for_each(|output| output.row.resize(size, 0.0));
    Ok(channels)
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
        SensorPlace::Excitation => {
            let force = space.excitation_force();
            let mass = sensor.chain.mass;
            if mass == 0.0 {
                return Ok(force);
            }
            let at_drive = space.modal_displacement(&setup.drive_point.shape);
            let at_drive = at_drive.plus(setup.drive_point.residual, &force);
            force.plus(mass, &differentiate(at_drive, MotionQuantity::Acceleration))
        }
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
