//! Unusable channels, and nonperiodic parts.

use crate::extraction::blocks::Blocks;
use crate::extraction::layout::{Layout, Place, displacement, displacement_noise, is_at};
use crate::extraction::{Finding, Tolerances};
use crate::records::{Record, Role};

/// Standard errors from which on a fundamental is one.
const SIGNIFICANT: f64 = 5.0;

/// Which channels hold nothing but finite numbers, and not one number alone; the others are reported. A force at the
/// stop may rest at zero.
pub fn usable(record: &Record, findings: &mut Vec<Finding>) -> Vec<bool> {
    let n = record.n_samples();
    let mut usable = Vec::new();
    for (channel, samples) in record.channels.iter().zip(&record.samples) {
        let broken: Vec<usize> = (0..n).filter(|j| !samples[*j].is_finite()).collect();
        if let Some(first) = broken.first() {
            let channel = channel.name.clone();
            findings.push(Finding::NotANumber { channel, samples: broken.len(), first: *first });
        }
        let judged = !matches!(channel.role, Role::Contact | Role::ExcitationPhase);
        let constant = judged && broken.is_empty() && n > 1 && samples[..n].iter().all(|x| *x == samples[0]);
        if constant {
            findings.push(Finding::NoSignal { channel: channel.name.clone() });
        }
        usable.push(broken.is_empty() && !constant);
    }
    usable
}

/// Reports channels that were described and are not there, with the columns that are, and what reading brought up.
pub fn missing(record: &Record, findings: &mut Vec<Finding>) {
    for channel in &record.missing {
        let consequence = match &record.unused[..] {
            [] => "the file has no such column, and no other one".to_owned(),
            others => format!("the file has no such column; not described are {}", others.join("; ")),
        };
        findings.push(Finding::ChannelMissing { channel: channel.clone(), consequence });
    }
    findings.extend(record.remarks.iter().cloned().map(Finding::Recorded));
}

/// Reports roles that no usable channel has.
pub fn roles(layout: &Layout, has_stop: bool, findings: &mut Vec<Finding>) {
    let absent = [
        ("excitation", layout.force.is_none(), "without a force there is no damping, lag or mode indicator"),
        (
            "drive-point",
            layout.force.is_some() && layout.drive.is_none(),
            "without the response where the force acts there is no damping, lag or mode indicator",
        ),
        (
            "contact",
            has_stop && layout.contact.is_none(),
            "without the force at the stop there is no restitution and no contact stiffness",
        ),
    ];
    for (role, _, consequence) in absent.into_iter().filter(|(_, is_absent, _)| *is_absent) {
        findings.push(Finding::ChannelMissing { channel: role.into(), consequence: consequence.into() });
    }
}

/// Reports channels that are not used, or not as described.
pub fn unused(record: &Record, layout: &Layout, usable: &[bool], findings: &mut Vec<Finding>) {
    let drive = layout.drive.as_ref();
    let at_force = layout.force.and_then(|force| record.channels[force].position);
    for (i, channel) in record.channels.iter().enumerate().filter(|(i, _)| usable[*i]) {
        let only = |used: Option<usize>| used.is_some_and(|used| used != i);
        let member = drive.is_some_and(|drive| drive.members.iter().any(|(j, _)| *j == i));
        let reason = match channel.role {
            Role::Excitation if only(layout.force) => "it is not used, another channel is the excitation",
            Role::Contact if only(layout.contact) => "it is not used, another channel is the force at the stop",
            Role::ExcitationPhase if only(layout.phase) => {
                "it is not used, another channel is the phase of the excitation"
            }
            Role::Response if channel.position.is_none() => "it is not used, since it has no position",
            Role::DrivePoint if !member => {
                "it is taken as a response, since it is not where the other channels of the drive point are"
            }
            Role::DrivePoint if !is_at(&record.channels, i, at_force) => {
                "it is the drive point, but the force acts elsewhere: power and damping are those of another place"
            }
            _ => continue,
        };
        findings.push(Finding::ChannelUnused { channel: channel.name.clone(), reason });
    }
}

/// Reports a sampling rate given with few digits in the file.
pub fn sample_rate(record: &Record, tolerances: &Tolerances, findings: &mut Vec<Finding>) {
    let (rate_hz, relative) = (record.sample_rate, record.rate_error);
    if relative > tolerances.sample_rate {
        findings.push(Finding::SampleRateUncertain { rate_hz, relative });
    }
}

/// Leaves out a force or a drive point that holds nothing but noise at the frequency (rad/s, with the number of
/// samples).
pub fn silent(
    record: &Record,
    layout: &mut Layout,
    blocks: &Blocks,
    (omega, n_samples): (f64, usize),
    findings: &mut Vec<Finding>,
) {
    let name = |i: usize| Finding::NoSignal { channel: record.channels[i].name.clone() };
    let of_force = |i: &usize| {
        let noise = blocks.noise[*i] * (2.0 / n_samples as f64).sqrt();
        blocks.all[*i][1].norm() <= SIGNIFICANT * noise
    };
    if let Some(i) = layout.force.take_if(|i| of_force(i)) {
        findings.push(name(i));
    }
    let of_drive = |drive: &Place| {
        let noise = displacement_noise(drive, &blocks.noise, omega, 1, n_samples);
        displacement(drive, &blocks.all, &blocks.noise, omega, 1).norm() <= SIGNIFICANT * noise
    };
    if let Some(drive) = layout.drive.take_if(|drive| of_drive(drive)) {
        findings.extend(drive.members.iter().map(|(i, _)| name(*i)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::{Channel, Quantity};
    use num_complex::Complex64;

    /// A Fourier coefficient of n samples with noise of unit variance has the variance 2/n in either part.
    #[test]
    fn force_and_drive_point_are_left_out_up_to_five_standard_errors() {
        let (omega, n) = (7.0, 800);
        for (size, left_out) in [(4.99, true), (5.01, false)] {
            let fundamental = size * (2.0 / n as f64).sqrt();
            let record = Record::new("made", 1e3)
                .with(Channel::new("f", Quantity::Force, Role::Excitation, Some(0.1)), vec![0.0; n])
                .with(Channel::new("v", Quantity::Velocity, Role::DrivePoint, Some(0.1)), vec![0.0; n]);
            let mut layout = Layout::new(&record, &[true; 2]);
            let all =
                [3.0, 0.2].map(|noise| vec![Complex64::default(), Complex64::new(0.6, 0.8) * fundamental * noise]);
            let blocks =
                Blocks { all: all.to_vec(), single: vec![], centres: vec![], rest: vec![], noise: vec![3.0, 0.2] };
            let mut findings = vec![];
            silent(&record, &mut layout, &blocks, (omega, n), &mut findings);
            assert_eq!((layout.force.is_none(), layout.drive.is_none()), (left_out, left_out));
            assert_eq!(findings.len(), if left_out { 2 } else { 0 });
        }
    }
}
