use crate::records::{Channel, Record, RecordError, SampleRate};

/// Relative difference of sampling rates within a file that counts as agreement.
const AGREEMENT: f64 = 1e-6;

/// The numbers of a file before its channels are described.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordTable {
    /// The columns in the order of the file.
    pub columns: Vec<Column>,
    /// Whether the columns have names of their own; else they are taken in order.
    pub named: bool,
}

/// A column of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Other names under which it can be found.
    pub aliases: Vec<String>,
    /// Sampling rate, where the file tells one.
    pub rate: Option<SampleRate>,
    /// Recorded numbers.
    pub values: Vec<f64>,
}

impl RecordTable {
    /// The record that the channels describe, in SI units. `rate_hz` is the declared sampling rate; without one that of
    /// the file counts.
    ///
    /// A described channel that a file with names does not have is no error here: it is listed in [`Record::missing`].
    ///
    /// # Errors
    /// [`RecordError`] if rates or lengths disagree, if names are ambiguous, or if there is nothing to take.
    pub fn into_record(
        mut self,
        name: &str,
        channels: &[Channel],
        rate_hz: Option<f64>,
    ) -> Result<Record, RecordError> {
        if !self.named && self.columns.len() != channels.len() {
            return Err(RecordError::ChannelCount { found: self.columns.len(), described: channels.len() });
        }
        let mut picked: Vec<(Channel, Column)> = Vec::new();
        let mut missing = Vec::new();
        for (i, channel) in channels.iter().enumerate() {
            match if self.named { self.find(&channel.name)? } else { Some(i) } {
                Some(at) => {
                    let values = std::mem::take(&mut self.columns[at].values);
                    picked.push((channel.clone(), Column { values, ..self.columns[at].clone() }));
                }
                None => missing.push(channel.name.clone()),
            }
        }
        let sample_rate = common_rate(&picked, rate_hz)?;
        check_lengths(&picked)?;
        let mut record = Record::new(name, sample_rate.hz);
        record.rate_error = sample_rate.relative_error;
        record.missing = missing;
        for (channel, column) in picked {
            let scale = channel.scale()?;
            record.channels.push(channel);
            record.samples.push(column.values.into_iter().map(|x| x * scale).collect());
        }
        Ok(record)
    }

    /// Where the column of this name stands.
    fn find(&self, name: &str) -> Result<Option<usize>, RecordError> {
        let exact = self.columns.iter().position(|column| column.name == name);
        if exact.is_some() {
            return Ok(exact);
        }
        let called = |column: &&Column| column.aliases.iter().any(|alias| alias == name);
        match self.columns.iter().filter(called).count() {
            0 => Ok(None),
            1 => Ok(self.columns.iter().position(|column| called(&column))),
            count => Err(RecordError::Ambiguous { name: name.to_owned(), count }),
        }
    }

    /// Names of the columns, separated by commas.
    pub fn names(&self) -> String {
        self.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(", ")
    }
}

/// The rate that all channels have, as exactly as the most exact of them tells it; a declared one is taken as known.
fn common_rate(picked: &[(Channel, Column)], declared: Option<f64>) -> Result<SampleRate, RecordError> {
    let rates = || picked.iter().filter_map(|(channel, column)| Some((&channel.name, column.rate?)));
    let best = rates().min_by(|a, b| a.1.relative_error.total_cmp(&b.1.relative_error));
    if let Some((name, rate)) = best {
        let disagrees = |other: &SampleRate| {
            (other.hz / rate.hz - 1.0).abs() > AGREEMENT + rate.relative_error + other.relative_error
        };
        if let Some((other, other_rate)) = rates().find(|(_, other)| disagrees(other)) {
            return Err(RecordError::RatesDisagree {
                first: name.clone(),
                first_hz: rate.hz,
                other: other.clone(),
                other_hz: other_rate.hz,
            });
        }
    }
    let rate = match (declared, best) {
        (Some(declared), Some((_, rate))) => SampleRate::exact(rate.agree(declared)?),
        (Some(declared), None) => SampleRate::exact(declared),
        (None, Some((_, rate))) => rate,
        (None, None) => return Err(RecordError::NoRate),
    };
    if rate.hz > 0.0 && rate.hz.is_finite() { Ok(rate) } else { Err(RecordError::NoRate) }
}

fn check_lengths(picked: &[(Channel, Column)]) -> Result<(), RecordError> {
    let Some((first, column)) = picked.first() else { return Ok(()) };
    let samples = column.values.len();
    if samples < 2 {
        return Err(RecordError::Empty { samples });
    }
    match picked.iter().find(|(_, other)| other.values.len() != samples) {
        Some((other, other_column)) => Err(RecordError::LengthsDisagree {
            first: first.name.clone(),
            first_samples: samples,
            other: other.name.clone(),
            other_samples: other_column.values.len(),
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::records::{Quantity, Role};

    fn column(name: &str, samples: usize, rate: Option<SampleRate>) -> Column {
        Column { name: name.into(), aliases: vec!["old".into()], rate, values: vec![1.0; samples] }
    }

    fn record(columns: Vec<Column>, rate: Option<f64>) -> Result<Record, RecordError> {
        let channel = |name: &str| Channel::new(name, Quantity::Force, Role::Response, None);
        RecordTable { columns, named: true }.into_record("r", &[channel("a"), channel("b"), channel("c")], rate)
    }

    #[test]
    fn columns_of_one_record_have_one_length_and_one_rate() {
        let known = Some(SampleRate { hz: 100.0, relative_error: 1e-5 });
        let rate = |hz: f64| Some(SampleRate { hz, relative_error: 1e-5 });
        let sound = record(vec![column("a", 3, known), column("b", 3, rate(100.001))], None).unwrap();
        assert_eq!((sound.sample_rate, sound.rate_error, &sound.missing[..]), (100.0, 1e-5, &["c".to_owned()][..]));
        let error = record(vec![column("a", 3, known), column("b", 4, None)], None).unwrap_err();
        assert!(matches!(error, RecordError::LengthsDisagree { first_samples: 3, other_samples: 4, .. }), "{error}");
        let error = record(vec![column("a", 1, known)], None).unwrap_err();
        assert!(matches!(error, RecordError::Empty { samples: 1 }), "{error}");
        // Both errors of the rates and a millionth are let pass, not more.
        let error = record(vec![column("a", 3, known), column("b", 3, rate(100.0022))], None).unwrap_err();
        assert!(matches!(error, RecordError::RatesDisagree { .. }), "{error}");
        assert!(matches!(record(vec![column("a", 3, None)], None), Err(RecordError::NoRate)));
        assert!(matches!(record(vec![column("a", 3, None)], Some(0.0)), Err(RecordError::NoRate)));
        assert_eq!(record(vec![column("a", 3, None)], Some(1e-3)).unwrap().sample_rate, 1e-3);
        assert!(matches!(record(vec![column("a", 3, known)], Some(101.0)), Err(RecordError::RateDisagrees { .. })));
    }

    #[test]
    fn a_name_that_two_columns_answer_to_is_ambiguous() {
        let of = |columns: Vec<Column>| {
            let channels = [Channel::new("old", Quantity::Force, Role::Response, None)];
            RecordTable { columns, named: true }.into_record("r", &channels, Some(10.0))
        };
        assert_eq!(of(vec![column("a", 2, None)]).unwrap().samples.len(), 1);
        let error = of(vec![column("a", 2, None), column("b", 2, None)]).unwrap_err();
        assert!(matches!(error, RecordError::Ambiguous { count: 2, .. }), "{error}");
        // A name of its own goes before other names.
        assert_eq!(of(vec![column("a", 2, None), column("old", 2, None)]).unwrap().samples.len(), 1);
    }
}
