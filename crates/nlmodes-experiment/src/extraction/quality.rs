//! Channels that cannot be used, and what is not periodic.

use crate::extraction::Finding;
use crate::extraction::guess::strongest_frequency;
use crate::extraction::layout::Layout;
use crate::records::Record;

/// Which channels hold nothing but finite numbers; the others are reported.
pub fn usable(record: &Record, findings: &mut Vec<Finding>) -> Vec<bool> {
    let n = record.n_samples();
    let mut usable = Vec::new();
    for (channel, samples) in record.channels.iter().zip(&record.samples) {
        let broken: Vec<usize> = (0..n).filter(|j| !samples[*j].is_finite()).collect();
        if let Some(first) = broken.first() {
            let channel = channel.name.clone();
            findings.push(Finding::NotANumber { channel, samples: broken.len(), first: *first });
        }
        usable.push(broken.is_empty());
    }
    usable
}

/// Reports channels that were described and are not there.
pub fn missing(record: &Record, findings: &mut Vec<Finding>) {
    for channel in &record.missing {
        let consequence = "the file has no such column";
        findings.push(Finding::ChannelMissing { channel: channel.clone(), consequence });
    }
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
        findings.push(Finding::ChannelMissing { channel: role.into(), consequence });
    }
}

/// Reports a signal whose rest without harmonics is more than the tolerated share of it.
pub fn aperiodic(
    signal: &[f64],
    rest: &[f64],
    channel: &str,
    sample_rate: f64,
    tolerance: f64,
    findings: &mut Vec<Finding>,
) {
    let n = signal.len() as f64;
    let mean = signal.iter().sum::<f64>() / n;
    let power: f64 = signal.iter().map(|x| (x - mean).powi(2)).sum();
    let ratio = (rest.iter().map(|x| x * x).sum::<f64>() / power).sqrt();
    if ratio > tolerance {
        let strongest_hz = strongest_frequency(rest).unwrap_or(f64::NAN) * sample_rate;
        findings.push(Finding::Aperiodic { channel: channel.to_owned(), ratio, strongest_hz });
    }
}
