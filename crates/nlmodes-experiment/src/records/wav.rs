//! WAV files.

use std::io::{Read, Seek, Write};

use hound::{SampleFormat, WavReader, WavSpec, WavWriter};

use crate::records::limits::{MAX_BYTES, MAX_CHANNELS};
use crate::records::{Column, Record, RecordError, RecordTable, SampleRate};

/// Reads the channels of a WAV file: floating-point samples as they are, whole numbers over their full scale. The
/// channels have no names.
///
/// # Errors
/// [`RecordError::Wav`] and what limits there are.
pub fn read_wav(source: impl Read) -> Result<RecordTable, RecordError> {
    let mut reader = WavReader::new(source).map_err(|error| refuse(&error))?;
    if u64::from(reader.len()) * u64::from(reader.spec().bits_per_sample) / 8 > MAX_BYTES {
        return Err(RecordError::TooLarge { limit: MAX_BYTES });
    }
    let spec = reader.spec();
    let channels = usize::from(spec.channels);
    if channels == 0 || spec.sample_rate == 0 || spec.bits_per_sample == 0 {
        return Err(RecordError::Wav { message: "its header has zero channels, sampling rate or bits".into() });
    }
    if channels > MAX_CHANNELS {
        return Err(RecordError::TooManyChannels { found: channels, limit: MAX_CHANNELS });
    }
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); channels];
    let mut push = |i: usize, x: f64| values[i % channels].push(x);
    match spec.sample_format {
        SampleFormat::Float => {
            for (i, x) in reader.samples::<f32>().enumerate() {
                push(i, f64::from(x.map_err(|error| refuse(&error))?));
            }
        }
        SampleFormat::Int => {
            let full_scale = 2f64.powi(i32::from(spec.bits_per_sample) - 1);
            for (i, x) in reader.samples::<i32>().enumerate() {
                push(i, f64::from(x.map_err(|error| refuse(&error))?) / full_scale);
            }
        }
    }
    let samples = values[0].len();
    if samples < 2 {
        return Err(RecordError::Empty { samples });
    }
    if values.iter().any(|channel| channel.len() != samples) {
        return Err(RecordError::Wav { message: "it ends within a sample of its channels".into() });
    }
    let rate = SampleRate::exact(f64::from(spec.sample_rate));
    let column = |(i, values)| Column { rate: Some(rate), ..Column::new(format!("{}", i + 1), values) };
    Ok(RecordTable { columns: values.into_iter().enumerate().map(column).collect(), named: false })
}

fn refuse(error: &hound::Error) -> RecordError {
    RecordError::Wav { message: error.to_string() }
}

/// Writes a record in SI units as 32-bit floating-point samples: seven digits.
///
/// # Errors
/// [`RecordError::Wav`] if the stream cannot be written, or if the sampling rate is not a whole number of hertz, which
/// is all that such a file can hold.
pub fn write_wav(target: impl Write + Seek, record: &Record) -> Result<(), RecordError> {
    let rate = record.sample_rate;
    let channels = u16::try_from(record.channels.len()).unwrap_or(0);
    if rate.fract() != 0.0 || !(1.0..=f64::from(u32::MAX)).contains(&rate) || channels == 0 {
        let message = format!("{rate} Hz with {} channels cannot be written", record.channels.len());
        return Err(RecordError::Wav { message });
    }
    let spec = WavSpec { channels, sample_rate: rate as u32, bits_per_sample: 32, sample_format: SampleFormat::Float };
    let mut writer = WavWriter::new(target, spec).map_err(|error| refuse(&error))?;
    for j in 0..record.n_samples() {
        for samples in &record.samples {
            writer.write_sample(samples[j] as f32).map_err(|error| refuse(&error))?;
        }
    }
    writer.finalize().map_err(|error| refuse(&error))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::records::{Channel, Quantity, Role};

    #[test]
    fn what_is_written_comes_back_to_seven_digits() {
        let channel = |name: &str| Channel::new(name, Quantity::Velocity, Role::Response, None);
        let channels = [channel("a"), channel("b")];
        let mut record = Record::new("r", 20_000.0)
            .with(channels[0].clone(), vec![1.1, -2.0e-5, 33.0])
            .with(channels[1].clone(), vec![0.0, 5.0, 6.0]);
        let mut bytes = Cursor::new(Vec::new());
        write_wav(&mut bytes, &record).unwrap();
        let back = read_wav(&bytes.get_ref()[..]).unwrap().into_record("r", &channels, Some(20_000.0)).unwrap();
        for (a, b) in back.samples.iter().flatten().zip(record.samples.iter().flatten()) {
            assert!((a - b).abs() <= 6e-8 * b.abs());
        }
        record.sample_rate = 0.5;
        assert!(write_wav(&mut bytes, &record).is_err());
    }

    #[test]
    fn whole_numbers_are_taken_over_full_scale() {
        let mut bytes = Cursor::new(Vec::new());
        let spec = WavSpec { channels: 1, sample_rate: 100, bits_per_sample: 16, sample_format: SampleFormat::Int };
        let mut writer = WavWriter::new(&mut bytes, spec).unwrap();
        [16384_i16, -32768].into_iter().for_each(|x| writer.write_sample(x).unwrap());
        writer.finalize().unwrap();
        let table = read_wav(&bytes.get_ref()[..]).unwrap();
        assert_eq!(table.columns[0].values, [0.5, -1.0]);
    }
}
