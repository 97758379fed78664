use std::ops::Range;

use crate::records::{Channel, Column, Flag, RecordTable, Remark, Role, SampleRate};

/// Channels that were sampled together, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Name, for instance that of the file.
    pub name: String,
    /// Sampling rate, Hz.
    pub sample_rate: f64,
    /// Largest relative error of the sampling rate, from the digits of headers and time stamps; zero where it is known.
    pub rate_error: f64,
    /// Instant of the first sample on the time axis of the file, s; zero where the file has none.
    pub start: f64,
    /// Which samples belong to levels that are held, where the file has channels that tell it.
    pub flags: Vec<Flag>,
    /// The channels.
    pub channels: Vec<Channel>,
    /// Samples of each channel, in the SI unit of its quantity; all of the same length.
    pub samples: Vec<Vec<f64>>,
    /// Channels that were described, but that the file does not have.
    pub missing: Vec<String>,
    /// Columns of the file that no channel describes, each with all of its names.
    pub unused: Vec<String>,
    /// What reading brought up.
    pub remarks: Vec<Remark>,
}

impl Record {
    /// A record without channels.
    pub fn new(name: impl Into<String>, sample_rate: f64) -> Self {
        Self {
            name: name.into(),
            sample_rate,
            rate_error: 0.0,
            start: 0.0,
            flags: vec![],
            channels: vec![],
            samples: vec![],
            missing: vec![],
            unused: vec![],
            remarks: vec![],
        }
    }

    /// Adds a channel with samples that are in SI units already.
    #[must_use]
    pub fn with(mut self, channel: Channel, samples: Vec<f64>) -> Self {
        self.channels.push(channel);
        self.samples.push(samples);
        self
    }

    /// Number of samples of each channel; of the shortest, where they differ.
    pub fn n_samples(&self) -> usize {
        self.samples.iter().map(Vec::len).min().unwrap_or(0)
    }

    /// Duration, s.
    pub fn duration(&self) -> f64 {
        self.n_samples() as f64 / self.sample_rate
    }

    /// The time from its first sample to behind its last one, s on the time axis of the file.
    pub fn span(&self) -> [f64; 2] {
        [self.start, self.start + self.duration()]
    }

    /// The samples from one instant to another, s on the time axis of the file; `None` where the record has not all of
    /// them, to half a sample.
    pub fn between(&self, from: f64, to: f64) -> Option<Range<usize>> {
        let [first, end] = [from, to].map(|t| ((t - self.start) * self.sample_rate).round());
        let has = first >= 0.0 && end > first && end <= self.n_samples() as f64;
        has.then_some(first as usize..end as usize)
    }

    /// These samples as a record of their own: as if nothing else had been recorded.
    ///
    /// # Panics
    /// If the record has not all of them.
    #[must_use]
    pub fn part(&self, name: impl Into<String>, samples: Range<usize>) -> Self {
        Self {
            name: name.into(),
            start: self.start + samples.start as f64 / self.sample_rate,
            flags: vec![],
            samples: self.samples.iter().map(|channel| channel[samples.clone()].to_vec()).collect(),
            channels: self.channels.clone(),
            missing: self.missing.clone(),
            unused: self.unused.clone(),
            remarks: self.remarks.clone(),
            ..*self
        }
    }

    /// Numbers of the channels with this role.
    pub fn with_role(&self, role: Role) -> impl Iterator<Item = usize> + '_ {
        self.channels.iter().enumerate().filter(move |(_, channel)| channel.role == role).map(|(i, _)| i)
    }

    /// As a table with the SI values, to be written. The description of its channels is that of [`Self::si_channels`].
    pub fn table(&self) -> RecordTable {
        let column = |(channel, samples): (&Channel, &Vec<f64>)| Column {
            rate: Some(SampleRate { hz: self.sample_rate, relative_error: self.rate_error }),
            ..Column::new(channel.name.clone(), samples.clone())
        };
        RecordTable { columns: self.channels.iter().zip(&self.samples).map(column).collect(), named: true }
    }

    /// Description of the channels as they are written: SI units, sign and sensitivity one. Delays stay in the samples
    /// and so stay here.
    pub fn si_channels(&self) -> Vec<Channel> {
        self.channels.iter().map(|channel| Channel { delay: channel.delay, ..channel.in_si() }).collect()
    }
}
