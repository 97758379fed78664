//! The levels of a record.

use std::ops::Range;

use nlmodes::experiment::extraction::{
    ExtractionError, ExtractionSettings, Finding, RecordExtraction, Steadiness, steady_stretches,
};
use nlmodes::experiment::records::Record;
use nlmodes_scene::scene::{SegmentRule, SegmentTold};
use nlmodes_scene::{RecordScene, SceneError, SceneFile, number, significant};

use crate::chain;

/// A part of a record in which a level is held.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Its name: that of the scene, or its number.
    pub name: String,
    /// First instant, s on the time axis of the record.
    pub from: f64,
    /// End, s.
    pub to: f64,
}

impl Segment {
    /// The record's name with that of the segment.
    pub fn of(&self, record: &str) -> String {
        let [from, to] = [self.from, self.to].map(|t| significant(t, 6));
        format!("{record}, segment {} ({from} s to {to} s)", self.name)
    }
}

/// A level with its samples, and the rule that tells it.
pub struct Level<'a> {
    pub segment: Segment,
    pub samples: Range<usize>,
    rule: &'a SegmentRule,
}

/// The names of the flags by which the levels of a file are marked.
pub fn flags<'a>(scene: &'a RecordScene, file: Option<usize>) -> Vec<&'a str> {
    let flag = |rule: &&'a SegmentRule| match &rule.told {
        SegmentTold::Flag(flag) => Some(flag.as_str()),
        _ => None,
    };
    rules(scene, file).iter().filter_map(flag).collect()
}

fn rules(scene: &RecordScene, file: Option<usize>) -> Vec<&SegmentRule> {
    file.map_or_else(
        || scene.segments.iter().filter(|rule| rule.file.is_none()).collect(),
        |file| scene.segments_of(file),
    )
}

/// The levels of a record in their order; none where the scene takes it as one.
///
/// # Errors
/// [`SceneError`] at the segment: beyond the record, a flag that is never set, nothing that is steady.
pub fn levels<'a>(
    file: &SceneFile<RecordScene>,
    scene: &'a RecordScene,
    of: Option<usize>,
    record: &Record,
) -> Result<Vec<Level<'a>>, SceneError> {
    let mut found: Vec<(Range<usize>, Option<String>, &SegmentRule)> = Vec::new();
    for rule in rules(scene, of) {
        let ranges = match &rule.told {
            SegmentTold::Times([from, to]) => vec![record.between(*from, *to).ok_or_else(|| {
                let [first, last] = record.span().map(number);
                let title = format!("`{}` is not within the record \"{}\"", rule.key, record.name);
                let label = format!("{from} s to {to} s, expected times from {first} s to {last} s");
                file.error_at(&rule.key, &title, &label, &["times count as those of the file; without any from 0"])
            })?],
            SegmentTold::Flag(flag) => flagged(file, rule, flag, record)?,
            SegmentTold::Steady => steady(file, rule, &scene.settings, record)?,
        };
        let several = ranges.len() > 1;
        let name =
            |k: usize| rule.name.as_ref().map(|name| if several { format!("{name} {}", k + 1) } else { name.clone() });
        found.extend(ranges.into_iter().enumerate().map(|(k, range)| (range, name(k), rule)));
    }
    found.sort_by_key(|(range, ..)| range.start);
    let level = |(k, (samples, name, rule)): (usize, (Range<usize>, Option<String>, &'a SegmentRule))| {
        let [from, to] = [samples.start, samples.end].map(|j| record.start + j as f64 / record.sample_rate);
        let name = name.unwrap_or_else(|| (k + 1).to_string());
        Level { segment: Segment { name, from, to }, samples, rule }
    };
    Ok(found.into_iter().enumerate().map(level).collect())
}

fn flagged(
    file: &SceneFile<RecordScene>,
    rule: &SegmentRule,
    flag: &str,
    record: &Record,
) -> Result<Vec<Range<usize>>, SceneError> {
    let stretches = record.flags.iter().find(|own| own.name == flag).map(|own| own.stretches.clone());
    stretches.filter(|stretches| !stretches.is_empty()).ok_or_else(|| {
        let title = format!("the flag \"{flag}\" is never set in the record \"{}\"", record.name);
        let label = format!("\"{flag}\" is zero throughout, expected intervals in which it is not");
        file.error_at(&format!("{}.flag", rule.key), &title, &label, &[])
    })
}

fn steady(
    file: &SceneFile<RecordScene>,
    rule: &SegmentRule,
    settings: &ExtractionSettings,
    record: &Record,
) -> Result<Vec<Range<usize>>, SceneError> {
    let mut steadiness = Steadiness::default();
    steadiness.periods = settings.periods.unwrap_or(steadiness.periods).max(steadiness.periods);
    let nothing = |reason: String| {
        let title = format!("no level is found in the record \"{}\": {reason}", record.name);
        let help = "say where the levels are: [[segment]] with `from_s` and `to_s`, or a `flag`";
        file.error_at(&rule.key, &title, "expected intervals in which force and motion are steady", &[help])
    };
    let found = steady_stretches(record, settings, &steadiness).map_err(|error| nothing(chain(&error)))?;
    if found.is_empty() {
        let Steadiness { periods, amplitude, lag_deg, frequency } = steadiness;
        return Err(nothing(format!(
            "over no {periods} periods the amplitudes change by less than {} %, the lag by {lag_deg}° and the \
             frequency by {} %",
            100.0 * amplitude,
            100.0 * frequency
        )));
    }
    Ok(found)
}

impl Level<'_> {
    /// Refuses a part with given times that is shorter than the periods that are asked for.
    ///
    /// # Errors
    /// [`SceneError`] at the segment.
    pub fn long_enough(
        &self,
        file: &SceneFile<RecordScene>,
        record: &str,
        result: &Result<RecordExtraction, ExtractionError>,
    ) -> Result<(), SceneError> {
        let findings = match result {
            Ok(found) => found.findings.as_slice(),
            Err(ExtractionError::Refused { finding, .. }) => std::slice::from_ref(&**finding),
            Err(_) => &[],
        };
        let short = findings.iter().find_map(|finding| match finding {
            Finding::TooShort { periods, wanted } => Some((*periods, *wanted)),
            _ => None,
        });
        match (short, &self.rule.told) {
            (Some((periods, wanted)), SegmentTold::Times(_)) => {
                let key = &self.rule.key;
                let title = format!("`{key}` of the record \"{record}\" is too short");
                let label = format!("{} periods, expected {wanted} at least", significant(periods, 3));
                let help = "make it longer, or ask for fewer `extraction.periods`";
                Err(file.error_at(key, &title, &label, &[help]))
            }
            _ => Ok(()),
        }
    }
}
