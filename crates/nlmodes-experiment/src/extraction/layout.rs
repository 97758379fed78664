//! Roles of the channels of a record.

use nlmodes_modal::{LinearModes, noise_level};
use num_complex::Complex64;

use crate::extraction::measured::spread;
use crate::extraction::window::refuse;
use crate::extraction::{ExtractionError, Finding};
use crate::records::{Channel, Quantity, Record, Role};

/// Positions count as the same within this share of the largest one.
const SAME_PLACE: f64 = 1e-3;

/// Factor in the relative noise for which a channel of the next derivative is taken for the frequency.
const PREFERRED: f64 = 5.0;
/// Relative noise below which channels are alike.
const NOISELESS: f64 = 1e-6;

/// Channels that measure the motion at one place: displacement, velocity, acceleration.
#[derive(Debug, Clone)]
pub struct Place {
    /// Position, m.
    pub position: Option<f64>,
    /// Numbers of the channels, each with its order of differentiation.
    pub members: Vec<(usize, u32)>,
}

/// Roles of the channels of a record. Numbers are those of the record's channels.
#[derive(Debug, Clone)]
pub struct Layout {
    pub force: Option<usize>,
    pub drive: Option<Place>,
    pub contact: Option<usize>,
    pub phase: Option<usize>,
    /// Places of all motion channels that have a position, ascending.
    pub places: Vec<Place>,
    /// The motion channel that determines the frequency best.
    pub reference: Option<usize>,
}

impl Layout {
    /// Of the channels that are usable.
    pub fn new(record: &Record, usable: &[bool]) -> Self {
        let first = |role: Role| record.with_role(role).find(|i| usable[*i]);
        let motion: Vec<usize> = (0..record.channels.len())
            .filter(|i| usable[*i] && record.channels[*i].quantity.time_derivative().is_some())
            .collect();
        let order = |i: usize| record.channels[i].quantity.time_derivative().unwrap_or(0);
        let places = places(&record.channels, &motion);
        let force = first(Role::Excitation);
        let drives: Vec<usize> =
            motion.iter().copied().filter(|i| record.channels[*i].role == Role::DrivePoint).collect();
        let home = home(&record.channels, &drives, force);
        let drive: Vec<(usize, u32)> =
            drives.iter().filter(|i| is_at(&record.channels, **i, home)).map(|i| (*i, order(*i))).collect();
        let at_force = || {
            let position = record.channels[force?].position?;
            find(&places, position).map(|at| places[at].clone())
        };
        let drive = match drive.first() {
            Some(_) => Some(Place { position: home, members: drive }),
            None => at_force(),
        };
        let reference = reference(record, &motion);
        Self { force, drive, contact: first(Role::Contact), phase: first(Role::ExcitationPhase), places, reference }
    }

    /// Samples of the force, or else of the first motion channel beside the reference.
    pub fn other_signal<'a>(&self, record: &'a Record) -> Option<&'a [f64]> {
        let other = |place: &Place| place.members.iter().map(|(i, _)| *i).find(|i| self.reference != Some(*i));
        let i = self.force.or_else(|| self.places.iter().find_map(other))?;
        Some(&record.samples[i])
    }

    /// Whether a channel is force, drive point or response at a place, but not the reference.
    pub fn takes_part(&self, channel: usize) -> bool {
        let at = |place: &Place| place.members.iter().any(|(i, _)| *i == channel);
        let taken = self.force == Some(channel) || self.drive.iter().chain(&self.places).any(at);
        taken && self.reference != Some(channel)
    }

    /// The channel of motion that determines the frequency.
    ///
    /// # Errors
    /// [`Finding::ChannelMissing`] without one, among these findings.
    pub fn motion(&self, findings: &[Finding]) -> Result<usize, ExtractionError> {
        self.reference.ok_or_else(|| {
            let consequence = "no usable channel measures a motion".into();
            refuse(Finding::ChannelMissing { channel: "response".into(), consequence }, findings)
        })
    }
}

/// Position of the drive point: where the force acts, if a channel of the drive point is there, else that of the first
/// of them.
fn home(channels: &[Channel], drives: &[usize], force: Option<usize>) -> Option<f64> {
    let at_force = force.and_then(|force| channels[force].position);
    let there =
        at_force.is_some() && drives.iter().any(|i| channels[*i].position.is_some() && is_at(channels, *i, at_force));
    if there { at_force } else { drives.iter().find_map(|i| channels[*i].position) }
}

/// Whether a channel is at this position, or may be.
pub fn is_at(channels: &[Channel], channel: usize, position: Option<f64>) -> bool {
    let largest = channels.iter().filter_map(|channel| channel.position).fold(0.0, |m: f64, x| m.max(x.abs()));
    channels[channel].position.zip(position).is_none_or(|(a, b)| (a - b).abs() <= SAME_PLACE * largest)
}

/// The channel with the least noise; displacement before velocity before acceleration, since it has the weakest
/// harmonics, unless its noise is larger by a factor for each derivative.
fn reference(record: &Record, motion: &[usize]) -> Option<usize> {
    let order = |i: usize| record.channels[i].quantity.time_derivative().unwrap_or(0);
    let noise = |i: usize| {
        let own = noise_level(&record.samples[i]) / spread(&record.samples[i]);
        own.max(NOISELESS) * PREFERRED.powi(order(i) as i32)
    };
    motion.iter().copied().min_by(|a, b| noise(*a).total_cmp(&noise(*b)))
}

fn places(channels: &[Channel], motion: &[usize]) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    let largest = motion.iter().filter_map(|i| channels[*i].position).fold(0.0, |m: f64, x| m.max(x.abs()));
    for i in motion {
        let channel = &channels[*i];
        let (Some(position), Some(order)) = (channel.position, channel.quantity.time_derivative()) else { continue };
        let same = |place: &&mut Place| place.position.is_some_and(|p| (p - position).abs() <= SAME_PLACE * largest);
        match places.iter_mut().find(same) {
            Some(place) => place.members.push((*i, order)),
            None => places.push(Place { position: Some(position), members: vec![(*i, order)] }),
        }
    }
    places.sort_by(|a, b| a.position.unwrap_or(0.0).total_cmp(&b.position.unwrap_or(0.0)));
    places
}

/// Number of the place at this position.
pub fn find(places: &[Place], position: f64) -> Option<usize> {
    let largest = places.iter().filter_map(|place| place.position).fold(position.abs(), |m, x| m.max(x.abs()));
    let near = |place: &Place| place.position.is_some_and(|p| (p - position).abs() <= SAME_PLACE * largest);
    places.iter().position(near)
}

/// Number of the position that is this one.
pub fn row_at(positions: &[f64], position: f64) -> Option<usize> {
    let largest = positions.iter().fold(position.abs(), |m: f64, x| m.max(x.abs()));
    positions.iter().position(|own| (own - position).abs() <= SAME_PLACE * largest)
}

/// The linear modes at the places that have a sensor, as many as can be distinguished, and the positions in their
/// order.
pub fn modes_at(
    modes: &LinearModes,
    places: &[Place],
    channels: &[Channel],
    findings: &mut Vec<Finding>,
) -> Option<(LinearModes, Vec<usize>)> {
    let rows: Vec<(usize, usize)> =
        modes.positions().iter().enumerate().filter_map(|(row, x)| Some((row, find(places, *x)?))).collect();
    for (k, place) in places.iter().enumerate().filter(|(k, _)| rows.iter().all(|(_, at)| at != k)) {
        let channel = place.members.first().map_or_else(String::new, |(i, _)| channels[*i].name.clone());
        findings.push(Finding::PositionWithoutShape { channel, position: places[k].position.unwrap_or(f64::NAN) });
    }
    let (sensors, wanted) = (rows.len(), modes.n_modes());
    if sensors < wanted {
        findings.push(Finding::FewerSensorsThanModes { sensors, modes: wanted });
    }
    let (rows, at): (Vec<usize>, Vec<usize>) = rows.into_iter().unzip();
    if rows.is_empty() {
        return None;
    }
    Some((modes.restricted(&rows, wanted.min(sensors)).ok()?, at))
}

/// Displacement from the coefficients of collocated channels, each integrated in the frequency domain, weighted by its
/// noise: displacement counts most at low harmonics, acceleration at high ones. The mean comes from displacement alone
/// and is zero without it.
pub fn displacement(place: &Place, coefficients: &[Vec<Complex64>], noise: &[f64], omega: f64, n: usize) -> Complex64 {
    let (mut sum, mut weights) = (Complex64::default(), 0.0);
    for (i, order) in &place.members {
        if n == 0 && *order > 0 {
            continue;
        }
        let factor = Complex64::new(0.0, n as f64 * omega).powu(*order);
        let weight = factor.norm_sqr() / noise[*i].powi(2);
        sum += coefficients[*i][n] / factor * weight;
        weights += weight;
    }
    if weights > 0.0 { sum / weights } else { Complex64::default() }
}

/// Standard deviation of the displacement of harmonic `n` that noise gives, with `n_samples`.
pub fn displacement_noise(place: &Place, noise: &[f64], omega: f64, n: usize, n_samples: usize) -> f64 {
    let weight = |(i, order): &(usize, u32)| ((n as f64 * omega).powi(*order as i32) / noise[*i]).powi(2);
    (2.0 / n_samples as f64 / place.members.iter().map(weight).sum::<f64>()).sqrt()
}

/// Whether a place has a channel of this quantity.
pub fn member(place: &Place, channels: &[Channel], quantity: Quantity) -> Option<usize> {
    place.members.iter().map(|(i, _)| *i).find(|i| channels[*i].quantity == quantity)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Structures of ten nanometres and of a thousand kilometres.
    #[test]
    fn channels_are_at_one_place_within_a_share_of_the_structure() {
        for length in [1e-8, 1.0, 1e6] {
            let channel = |x: f64| Channel::new("x", Quantity::Displacement, Role::Response, Some(x * length));
            let channels = [channel(1.0), channel(-0.5), channel(0.9995), channel(0.25), channel(0.252)];
            let found = places(&channels, &[0, 1, 2, 3, 4]);
            let members: Vec<Vec<usize>> =
                found.iter().map(|place| place.members.iter().map(|member| member.0).collect()).collect();
            assert_eq!(members, [vec![1], vec![3], vec![4], vec![0, 2]], "{length}");
            assert_eq!(find(&found, 1.0005 * length), Some(3), "{length}");
            assert_eq!(find(&found, -0.5009 * length), Some(0), "{length}");
            assert_eq!(find(&found, 0.5 * length), None, "{length}");
            assert!(is_at(&channels, 3, Some(0.2505 * length)) && !is_at(&channels, 3, Some(0.252 * length)));
            assert!(!is_at(&channels, 1, Some(0.5 * length)), "the other side");
            assert!(is_at(&channels, 3, None));
        }
    }
}
