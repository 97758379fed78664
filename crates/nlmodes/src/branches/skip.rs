//! A branch that leaves out the internal-resonance branches.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_continuation::StopReason;
use nlmodes_modal::{BranchEnd, EndReason, Event, InternalResonance, ModalPoint, RESONANT_SHARE};

use super::branch::branch_end;
use super::found::{First, Found};
use super::guide::Guides;
use super::homotopy::Effort;
use super::start::{Seed, Target, heading, refined};
use super::trace::Tracer;
use super::{BranchError, BranchProgress, FOLLOWING, ResonanceRule};

/// Follows the backbone from `seed`; where it runs into an internal resonance, it goes back to the base point of
/// its branch, and on behind it. One behind which no backbone is found is followed.
pub(super) fn follow(
    tracer: &mut Tracer,
    mut seed: Seed,
    start_event: Event,
    observe: &mut dyn FnMut(BranchProgress) -> ControlFlow<()>,
) -> Result<(Found, BranchEnd), BranchError> {
    let (mut all, mut guides, mut followed) = (Found::default(), Guides::default(), Vec::<Followed>::new());
    let (mut first, mut upward) = (First::Named(start_event), None);
    // Where the segment since the last internal-resonance branch begins.
    let mut segment_start = 0;
    loop {
        let (mut count, limit, mut resonance) = (all.points.len(), tracer.settings.max_points, None);
        let watch = tracer.settings.watch.clone();
        let _ = watch.begins(FOLLOWING);
        let before = all.points.len();
        // On an internal-resonance branch that is followed all others are part of it.
        let is_followed = |found: InternalResonance| followed.iter().any(|each| each.resonance == found);
        let mut is_aside = all.points.last().and_then(|last| last.resonance).is_some_and(is_followed);
        let traced = tracer.trace(&seed, None, first, |shown| {
            let point = match shown {
                BranchProgress::Found { point, .. } => point,
                BranchProgress::Withdrawn { kept, .. } => {
                    count = before + kept;
                    return observe(BranchProgress::Withdrawn { branch: 0, kept: count });
                }
            };
            let was_aside = is_aside;
            is_aside = point.resonance.is_some_and(|found| is_aside || is_followed(found));
            if was_aside && !is_aside {
                segment_start = count;
            }
            resonance = point.resonance.filter(|_| !is_aside);
            if resonance.is_some() {
                return ControlFlow::Break(());
            }
            count += 1;
            observe(BranchProgress::Found { branch: 0, point })?;
            if count < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        let (segment, stop) = match traced {
            Err(_) if watch.has_ended() && before > 0 => (Found::default(), StopReason::Stopped),
            traced => traced?,
        };
        all.append(segment);
        let Some(resonance) = resonance else {
            let mut end = branch_end(&stop, tracer, all.points.len());
            if let Some(followed) = followed.last().filter(|_| is_aside && end.complete) {
                end.complete = tracer.settings.internal_resonance != ResonanceRule::Skip;
                end.message += &format!(
                    "; on the internal-resonance branch {}, which was followed: {}",
                    followed.resonance, followed.why
                );
            }
            return Ok((all, end));
        };
        let last = all.points.len() - 1;
        let base_share = tracer.settings.skip.base_share;
        let mut base = None;
        let behind = upward.map_or_else(|| heading(tracer, &seed), Ok).and_then(|found| {
            upward = Some(found);
            base =
                base_point(&all.points[segment_start..last], base_share, resonance, found).map(|i| segment_start + i);
            match base {
                Some(base) => resume(tracer, &mut guides, &all.points[base], (found, resonance)),
                None => Ok(Behind::Nothing("it begins on it".to_owned())),
            }
        });
        if watch.has_ended() {
            all.truncate(last);
            let end = branch_end(&StopReason::Stopped, tracer, all.points.len());
            return Ok((all, end));
        }
        let behind = behind?;
        if let (Some(base), Behind::Found { .. } | Behind::Limit(_)) = (base, &behind) {
            all.truncate(base + 1);
            mark(&mut all.points[base], resonance, Event::TongueFoot);
            let withdrawn = observe(BranchProgress::Withdrawn { branch: 0, kept: base });
            let marked = BranchProgress::Found { branch: 0, point: &all.points[base] };
            if withdrawn.is_break() || observe(marked).is_break() {
                let end = branch_end(&StopReason::Stopped, tracer, all.points.len());
                return Ok((all, end));
            }
        }
        match behind {
            Behind::Found { points, seed: next } => {
                for point in &points.points {
                    if observe(BranchProgress::Found { branch: 0, point }).is_break() {
                        let end = branch_end(&StopReason::Stopped, tracer, all.points.len());
                        return Ok((all, end));
                    }
                }
                segment_start = all.points.len();
                all.append(*points);
                (seed, first) = (next, First::Known);
            }
            Behind::Limit(end) => return Ok((all, end)),
            Behind::Nothing(why) => {
                let shown = observe(BranchProgress::Found { branch: 0, point: &all.points[last] });
                if shown.is_break() || all.points.len() >= limit {
                    let end = branch_end(&StopReason::Stopped, tracer, all.points.len());
                    return Ok((all, end));
                }
                let Some(next) = ahead(tracer, &all) else { return Ok((all, lost(resonance, &why))) };
                followed.push(Followed { resonance, why });
                (seed, first) = (next, First::Known);
            }
        }
    }
}

/// An internal resonance whose branch is followed, and why.
struct Followed {
    resonance: InternalResonance,
    why: String,
}

/// Where the last two points lead.
fn ahead(tracer: &Tracer, all: &Found) -> Option<Seed> {
    let p = |point: &ModalPoint| (point.kinetic_energy / tracer.grazing.energy).ln();
    let ([.., before, x], [.., earlier, last]) = (&all.unknowns[..], &all.points[..]) else { return None };
    if before.len() != x.len() {
        return None;
    }
    let direction = x.iter().zip(before).map(|(a, b)| a - b).chain([p(last) - p(earlier)]).collect();
    Some(Seed { x: x.clone(), p: p(last), direction, harmonics: tracer.settings.harmonics })
}

/// What was found behind an internal-resonance branch.
enum Behind {
    /// The points from its base point on, and where the last one of them leads.
    Found {
        points: Box<Found>,
        seed: Seed,
    },
    Nothing(String),
    /// A limit of the branch lies within the internal-resonance branch.
    Limit(BranchEnd),
}

/// Seeks the backbone behind an internal-resonance branch at growing distances, and goes from there back to the base
/// point.
fn resume(
    tracer: &mut Tracer,
    guides: &mut Guides,
    near: &ModalPoint,
    (upward, resonance): (bool, InternalResonance),
) -> Result<Behind, BranchError> {
    let skip = tracer.settings.skip;
    let (mut distance, sense) = (skip.first, if upward { 1.0 } else { -1.0 });
    let highest = tracer.settings.max_energy_ratio.map_or(f64::INFINITY, f64::ln);
    let (mut why, mut least, mut has_less) = (None, f64::INFINITY, false);
    // Where nothing is found the branch is followed, which whoever asks for "skip" does not want.
    let effort = if tracer.settings.internal_resonance == ResonanceRule::Skip { Effort::SOME } else { Effort::LITTLE };
    while distance < skip.furthest {
        let hz = near.omega * (1.0 + sense * distance) / TAU;
        distance += (distance * (skip.growth - 1.0)).min(skip.further.0.max(distance * skip.further.1));
        if tracer.settings.frequency_hz.is_some_and(|[low, high]| !(low..=high).contains(&hz)) {
            return Ok(Behind::Limit(window(resonance)));
        }
        let target = Target::Frequency(hz);
        let (structure, settings, grazing) = (tracer.structure, &tracer.settings, tracer.grazing);
        let seed = match refined(structure, settings, grazing, (target, upward), (guides, effort), tracer.log) {
            Ok(seed) => seed,
            Err(error @ BranchError::NoStart { .. }) => {
                why.get_or_insert_with(|| error.to_string());
                continue;
            }
            Err(error) => return Err(error),
        };
        if seed.p > highest {
            least = least.min(seed.p.exp());
            continue;
        }
        has_less = true;
        let Some(points) = back_to_base(tracer, &seed, near, upward, resonance)? else { continue };
        return Ok(Behind::Found { points: Box::new(points), seed });
    }
    if least.is_finite() && !has_less {
        let message = format!(
            "behind the internal-resonance branch {resonance}, which is skipped, all motions that were found have more \
                than the largest energy, {least:.1} times that at grazing or more"
        );
        return Ok(Behind::Limit(BranchEnd::new(EndReason::MaxEnergy, message, true)));
    }
    Ok(Behind::Nothing(why.unwrap_or_else(|| "the backbone was not found behind it".to_owned())))
}

/// The branch from the base point behind the internal resonance to `seed`; `None` if that lies on its branch itself, or
/// on the near side of this one.
fn back_to_base(
    tracer: &mut Tracer,
    seed: &Seed,
    near: &ModalPoint,
    upward: bool,
    resonance: InternalResonance,
) -> Result<Option<Found>, BranchError> {
    let scaled = near.omega / tracer.grazing.omega;
    let frequency = if upward { [scaled, f64::INFINITY] } else { [0.0, scaled] };
    let back = Seed { direction: seed.direction.iter().map(|d| -d).collect(), ..seed.clone() };
    let mut resonant = false;
    let (mut found, _) = tracer.trace(&back, Some(frequency), First::Plain, |shown| {
        let BranchProgress::Found { point, .. } = shown else { return ControlFlow::Continue(()) };
        resonant = point.resonance.is_some();
        let turned = point.has_event(Event::FrequencyFold);
        if resonant || turned { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    if resonant {
        found.truncate(found.points.len() - 1);
    }
    let Some(base) = base_point(&found.points, tracer.settings.skip.base_share, resonance, !upward) else {
        return Ok(None);
    };
    let same = |a: f64, b: f64| (a / b - 1.0).abs() < tracer.settings.skip.same;
    let last = &found.points[base];
    if same(last.omega, near.omega) && same(last.kinetic_energy, near.kinetic_energy) {
        return Ok(None);
    }
    found.truncate(base + 1);
    mark(&mut found.points[base], resonance, Event::Resumed);
    found.reverse();
    Ok(Some(found))
}

/// Index of the base point of an internal-resonance branch at the end of these points: where the resonant harmonic
/// begins to grow, and the frequency has not turned yet. None where all of them lie on an internal-resonance branch,
/// one of its flanks included.
fn base_point(points: &[ModalPoint], base_share: f64, resonance: InternalResonance, upward: bool) -> Option<usize> {
    let share = |point: &ModalPoint| point.harmonic_share(resonance.harmonic);
    let least = points.iter().map(share).fold(f64::INFINITY, f64::min);
    let limit = base_share.max(2.0 * least).min(RESONANT_SHARE);
    let last = points.iter().rposition(|point| share(point) <= limit)?;
    let sense = if upward { 1.0 } else { -1.0 };
    (0..=last).max_by(|&i, &j| (sense * points[i].omega).total_cmp(&(sense * points[j].omega)))
}

fn mark(point: &mut ModalPoint, resonance: InternalResonance, event: Event) {
    point.events.push(event);
    point.resonance = Some(resonance);
}

fn window(resonance: InternalResonance) -> BranchEnd {
    let message =
        format!("the frequency window ends within the internal-resonance branch {resonance}, which is skipped");
    BranchEnd::new(EndReason::FrequencyWindow, message, true)
}

fn lost(resonance: InternalResonance, why: &str) -> BranchEnd {
    let message = format!("the branch reached the base point of the internal-resonance branch {resonance}, and {why}");
    BranchEnd::new(EndReason::Tongue, message, false)
}
