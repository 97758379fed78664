use crate::records::{
    Channel, Declared, Flag, Quantity, Record, RecordError, Remark, Role, SampleRate, Start, common_time,
};

/// Relative difference of sampling rates within a file that counts as agreement.
const AGREEMENT: f64 = 1e-6;

/// The same of a declared rate and the mean one of uneven instants.
const ROUGHLY: f64 = 0.02;

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
    /// Sampling rate, if given in the file.
    pub rate: Option<SampleRate>,
    /// Instant of the first sample, if given in the file for each column.
    pub start: Option<Start>,
    /// Description of the numbers in the file.
    pub declared: Declared,
    /// Recorded numbers.
    pub values: Vec<f64>,
    /// By how many intervals the instants of the samples were off an even time axis, where these are values between
    /// them.
    pub uneven: Option<f64>,
}

/// Described channels with their columns.
type Picked = Vec<(Channel, Column)>;

impl Column {
    /// A column with only its name known.
    pub fn new(name: impl Into<String>, values: Vec<f64>) -> Self {
        let name = name.into();
        Self { name, aliases: vec![], rate: None, start: None, declared: Declared::default(), values, uneven: None }
    }

    /// All names under which it can be found.
    fn all_names(&self) -> impl Iterator<Item = &str> {
        std::iter::once(&self.name).chain(&self.aliases).map(String::as_str)
    }
}

impl RecordTable {
    /// The record that the channels describe, in SI units. `rate_hz` is the declared sampling rate; without one that of
    /// the file counts.
    ///
    /// A described channel that a file with names does not have is no error here: it is listed in [`Record::missing`].
    ///
    /// # Errors
    /// [`RecordError`] if rates or lengths disagree, if names are ambiguous, or if there is nothing to take.
    pub fn into_record(self, name: &str, channels: &[Channel], rate_hz: Option<f64>) -> Result<Record, RecordError> {
        self.into_flagged_record(name, channels, &[], rate_hz)
    }

    /// The same with [`Record::flags`]: columns that tell while which samples a level is held. A flag has any name of
    /// its column; in a file without names it is the number of the column, from 1, and the channels are the others.
    ///
    /// # Errors
    /// Those of [`Self::into_record`]; [`RecordError::NoFlag`].
    pub fn into_flagged_record(
        mut self,
        name: &str,
        channels: &[Channel],
        flags: &[&str],
        rate_hz: Option<f64>,
    ) -> Result<Record, RecordError> {
        let flags = self.flags(flags, channels)?;
        if !self.named && self.columns.len() != channels.len() {
            return Err(RecordError::ChannelCount { found: self.columns.len(), described: channels.len() });
        }
        let (mut picked, missing) = self.pick(channels)?;
        let unused = self.unused();
        if picked.is_empty() {
            let described = channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(", ");
            return Err(RecordError::NoChannels { described, columns: unused.join("; ") });
        }
        let sample_rate = common_rate(&picked, rate_hz)?;
        let mut remarks = Vec::new();
        for (channel, column) in &picked {
            channel.scale()?;
            column.declared.check(channel, &mut remarks)?;
        }
        let uneven = picked.iter().filter_map(|(_, column)| column.uneven).reduce(f64::max);
        remarks.extend(uneven.map(|deviation| Remark::UnevenTimes { deviation }));
        let n_channels = picked.len();
        picked.extend(flags);
        let start = picked.iter().filter_map(|(_, column)| Some(column.start?.at)).reduce(f64::max).unwrap_or(0.0);
        common_time::cut(&mut picked, sample_rate, &mut remarks)?;
        check_lengths(&picked)?;
        let flags = picked.drain(n_channels..).map(|(flag, column)| Flag::new(flag.name, &column.values)).collect();
        let rate_error = sample_rate.relative_error;
        let record = Record { missing, unused, remarks, rate_error, start, flags, ..Record::new(name, sample_rate.hz) };
        Self::described(picked, record)
    }

    /// The columns of the flags; one that is a described channel, too, stays in the table.
    fn flags(&mut self, flags: &[&str], channels: &[Channel]) -> Result<Picked, RecordError> {
        let mut found = Picked::new();
        for flag in flags {
            let lost = || RecordError::NoFlag { flag: (*flag).to_owned(), columns: self.unused().join("; ") };
            let at = self.find(flag)?.ok_or_else(lost)?;
            let is_described =
                self.named && channels.iter().any(|c| matches!(self.find(&c.name), Ok(Some(i)) if i == at));
            let column = if is_described { self.columns[at].clone() } else { self.columns.remove(at) };
            // It takes part in what columns have in common, not in what channels measure.
            found.push((Channel::new(*flag, Quantity::Phase, Role::ExcitationPhase, None), column));
        }
        Ok(found)
    }

    /// The columns that the channels describe, and the names of channels that have none.
    fn pick(&mut self, channels: &[Channel]) -> Result<(Picked, Vec<String>), RecordError> {
        let (mut places, mut missing): (Vec<(usize, &Channel)>, Vec<String>) = (Vec::new(), Vec::new());
        for (i, channel) in channels.iter().enumerate() {
            let Some(at) = (if self.named { self.find(&channel.name)? } else { Some(i) }) else {
                missing.push(channel.name.clone());
                continue;
            };
            if let Some((_, other)) = places.iter().find(|(taken, _)| *taken == at) {
                let (first, second) = (other.name.clone(), channel.name.clone());
                return Err(RecordError::SameColumn { first, second });
            }
            places.push((at, channel));
        }
        let mut columns: Vec<Option<Column>> = std::mem::take(&mut self.columns).into_iter().map(Some).collect();
        let take = |(at, channel): (usize, &Channel)| Some((channel.clone(), columns[at].take()?));
        let picked = places.into_iter().filter_map(take).collect();
        self.columns = columns.into_iter().flatten().collect();
        Ok((picked, missing))
    }

    /// Names of the columns that no channel describes, each with all of its names.
    fn unused(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.all_names().collect::<Vec<_>>().join(" = ")).collect()
    }

    /// The record of channels and their columns.
    fn described(picked: Picked, mut record: Record) -> Result<Record, RecordError> {
        for (channel, column) in picked {
            let scale = channel.scale()?;
            record.channels.push(channel);
            record.samples.push(column.values.into_iter().map(|x| x * scale).collect());
        }
        Ok(record)
    }

    /// Index of the column of this name.
    fn find(&self, name: &str) -> Result<Option<usize>, RecordError> {
        let own = |column: &&Column| column.name == name;
        let called = |column: &&Column| column.aliases.iter().any(|alias| alias == name);
        let named: Vec<usize> = self.places(own);
        match (if named.is_empty() { self.places(called) } else { named })[..] {
            [] => Ok(None),
            [only] => Ok(Some(only)),
            [..] => Err(RecordError::Ambiguous {
                name: name.to_owned(),
                count: self.places(|column| own(column) || called(column)).len(),
                columns: self.unused().join("; "),
            }),
        }
    }

    fn places(&self, is_meant: impl Fn(&&Column) -> bool) -> Vec<usize> {
        self.columns.iter().enumerate().filter(|(_, column)| is_meant(column)).map(|(i, _)| i).collect()
    }

    /// Names of the columns, separated by commas.
    pub fn names(&self) -> String {
        self.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(", ")
    }
}

/// The common rate of all channels, from the most precise of them; a declared one is exact.
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
    // The rate of even instants among uneven ones is the mean one, however the recorder was set.
    let is_uneven = picked.iter().any(|(_, column)| column.uneven.is_some());
    let declared = declared
        .filter(|declared| !best.is_some_and(|(_, rate)| is_uneven && (rate.hz / declared - 1.0).abs() < ROUGHLY));
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
        Column { aliases: vec!["old".into()], rate, ..Column::new(name, vec![1.0; samples]) }
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
