//! The parts of recordings in which levels are held.

use crate::nearest::nearest;
use crate::raw::{RawRecordScene, RawRecordSegment};
use crate::rule::either;
use crate::scene::{SegmentRule, SegmentTold};
use crate::{Diagnostic, Diagnostics};

const WAYS: &str = "expected `from_s` and `to_s`, or `flag`, or `segments = \"steady\"`";

/// The rules that are sound: each tells its part in one way, and no part overlaps another of its file.
pub fn check(raw: &RawRecordScene, diagnostics: &mut Diagnostics<'_>) -> Vec<SegmentRule> {
    let files = &raw.recording.files;
    let given = raw.segment.as_deref().unwrap_or_default();
    let rules = given.iter().enumerate();
    let mut rules: Vec<SegmentRule> = rules.filter_map(|(i, raw)| rule(raw, i, files, diagnostics)).collect();
    if raw.recording.segments.is_some() {
        if !given.is_empty() {
            let diagnostic = Diagnostic::error("the segments are given twice");
            let help = "`recording.segments` finds them; a [[segment]] says where it is";
            diagnostics.put("recording.segments", diagnostic.help(help), "there are [[segment]] tables too");
        }
        let (name, file, key) = (None, None, "recording.segments".to_owned());
        rules.push(SegmentRule { name, file, key, told: SegmentTold::Steady });
    }
    for (k, later) in rules.iter().enumerate() {
        if let Some(clash) = rules[..k].iter().find_map(|earlier| clash(earlier, later)) {
            let Clash { title, label } = clash;
            diagnostics.put(&later.key, Diagnostic::error(title), label);
        }
    }
    rules
}

/// A free decay ends after it begins, and its record has no other levels.
pub fn free_decay(raw: &RawRecordScene, diagnostics: &mut Diagnostics<'_>) {
    let Some(decay) = &raw.free_decay else { return };
    if raw.segment.is_some() || raw.recording.segments.is_some() {
        let diagnostic = Diagnostic::error("a record has either segments or a free decay");
        let help = "what is before the free decay is a level of its own; cut other levels into files of their own";
        diagnostics.put("free_decay", diagnostic.help(help), "expected either this table or [[segment]]");
    }
    if let Some((from, to)) = decay.from_s.zip(decay.to_s).filter(|(from, to)| from >= to) {
        let diagnostic = Diagnostic::error("`free_decay` ends before it begins");
        let label = format!("found {to} s, expected more than `from_s`, {from} s");
        diagnostics.put("free_decay.to_s", diagnostic, label);
    }
}

fn rule(raw: &RawRecordSegment, i: usize, files: &[String], diagnostics: &mut Diagnostics<'_>) -> Option<SegmentRule> {
    let key = format!("segment.{i}");
    let told = told(raw, &key, diagnostics)?;
    let file = match &raw.file {
        None => None,
        Some(name) => Some(files.iter().position(|file| file == name).or_else(|| {
            let diagnostic = Diagnostic::error(format!("\"{name}\" is none of `recording.files`"));
            let diagnostic = match nearest(name, files.iter().map(String::as_str)) {
                Some(meant) => diagnostic.help(format!("did you mean \"{meant}\"?")),
                None => diagnostic,
            };
            let files: Vec<&str> = files.iter().map(String::as_str).collect();
            diagnostics.put(&format!("{key}.file"), diagnostic, format!("expected {}", either(&files)));
            None
        })?),
    };
    Some(SegmentRule { name: raw.name.clone(), file, key, told })
}

/// What tells the part, if it is one thing.
fn told(raw: &RawRecordSegment, key: &str, diagnostics: &mut Diagnostics<'_>) -> Option<SegmentTold> {
    let has_times = raw.from_s.is_some() || raw.to_s.is_some();
    let ways = [has_times, raw.flag.is_some(), raw.segments.is_some()];
    if ways.into_iter().filter(|way| *way).count() != 1 {
        let said = if ways.contains(&true) { "is given in several ways" } else { "does not say which part it is" };
        diagnostics.put(key, Diagnostic::error(format!("`{key}` {said}")), WAYS);
        return None;
    }
    if let Some(flag) = &raw.flag {
        return Some(SegmentTold::Flag(flag.clone()));
    }
    let (from, to) = match (raw.from_s, raw.to_s) {
        (None, None) => return Some(SegmentTold::Steady),
        (Some(from), Some(to)) => (from, to),
        (from, _) => {
            let missing = if from.is_some() { "to_s" } else { "from_s" };
            let diagnostic = Diagnostic::error(format!("`{key}.{missing}` is missing"));
            diagnostics.put(key, diagnostic, "expected both `from_s` and `to_s`");
            return None;
        }
    };
    if from < to {
        return Some(SegmentTold::Times([from, to]));
    }
    let diagnostic = Diagnostic::error(format!("`{key}` ends before it begins"));
    diagnostics.put(&format!("{key}.to_s"), diagnostic, format!("found {to} s, expected more than `from_s`, {from} s"));
    None
}

/// Why two rules exclude each other.
struct Clash {
    title: String,
    label: String,
}

fn clash(earlier: &SegmentRule, later: &SegmentRule) -> Option<Clash> {
    if earlier.file.zip(later.file).is_some_and(|(a, b)| a != b) {
        return None;
    }
    let (SegmentTold::Times(a), SegmentTold::Times(b)) = (&earlier.told, &later.told) else {
        let title = format!("`{}` and `{}` may be the same part of a record", earlier.key, later.key);
        let label = "expected for a file either one `flag`, or `segments = \"steady\"`, or `from_s` and `to_s` of each";
        return Some(Clash { title, label: label.to_owned() });
    };
    let overlap = [a[0].max(b[0]), a[1].min(b[1])];
    (overlap[0] < overlap[1]).then(|| Clash {
        title: format!("`{}` and `{}` overlap from {} s to {} s", earlier.key, later.key, overlap[0], overlap[1]),
        label: format!("{} s to {} s; `{}` is {} s to {} s", b[0], b[1], earlier.key, a[0], a[1]),
    })
}
