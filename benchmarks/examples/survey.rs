//! Branches of the paper's structures with many numbers of harmonics, as tables of points, events, processor time and
//! residual.
//!
//! `cargo run --release -p nlmodes-benchmarks --example survey [rod|meshes|beam]`; without an argument all three.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, BranchStart, ComputedBranch, ResonanceRule, compute_branch};
use nlmodes::fem::MassMatrix;
use nlmodes::model::MasslessContactModel;
use nlmodes_benchmarks::{Failure, beam, rod, thread_time};

fn main() -> Result<(), Failure> {
    let wanted = std::env::args().nth(1);
    let has = |name: &str| wanted.as_ref().is_none_or(|w| w == name);
    let all = || (1..=20).chain([30]);
    if has("rod") {
        header("Rod of 100 elements, from grazing to 15 grazing energies", &["N_h"]);
        for harmonics in all() {
            row(
                &[harmonics.to_string()],
                rod(100, MassMatrix::Consistent)?,
                &rod_settings(harmonics, BranchStart::Grazing),
            );
        }
        for (name, upward) in [("down", false), ("up", true)] {
            header(&format!("The same from 66 Hz {name}, within 60.9 to 70 Hz"), &["N_h"]);
            for harmonics in all() {
                let start = BranchStart::Frequency { hz: 66.0, upward };
                row(&[harmonics.to_string()], rod(100, MassMatrix::Consistent)?, &rod_settings(harmonics, start));
            }
        }
    }
    if has("meshes") {
        header("Rods of other meshes, from grazing to 15 grazing energies", &["elements", "mass", "N_h"]);
        for elements in [10, 20, 60, 200] {
            for (name, mass) in [("consistent", MassMatrix::Consistent), ("lumped", MassMatrix::Lumped)] {
                for harmonics in all() {
                    let cells = [elements.to_string(), name.to_owned(), harmonics.to_string()];
                    row(&cells, rod(elements, mass)?, &rod_settings(harmonics, BranchStart::Grazing));
                }
            }
        }
    }
    if has("beam") {
        header("Beam, from grazing to 6 grazing energies", &["N_h", "tongues"]);
        for harmonics in [1, 3, 5, 10, 20] {
            for (name, internal_resonance) in [("followed", ResonanceRule::Follow), ("skipped", ResonanceRule::Skip)] {
                let frequency_hz = Some([39.0, 52.0]);
                let max_energy_ratio = Some(6.0);
                let settings = BranchSettings {
                    harmonics,
                    internal_resonance,
                    frequency_hz,
                    max_energy_ratio,
                    ..BranchSettings::default()
                };
                row(&[harmonics.to_string(), name.to_owned()], beam()?, &settings);
            }
        }
    }
    Ok(())
}

fn rod_settings(harmonics: usize, start: BranchStart) -> BranchSettings {
    let frequency_hz = if start == BranchStart::Grazing { None } else { Some([60.9, 70.0]) };
    let internal_resonance = ResonanceRule::Follow;
    BranchSettings {
        harmonics,
        start,
        frequency_hz,
        max_energy_ratio: Some(15.0),
        internal_resonance,
        ..BranchSettings::default()
    }
}

const COLUMNS: [&str; 7] = ["points", "refused", "events", "tongues", "end", "largest residual", "CPU, ms"];

fn header(title: &str, first: &[&str]) {
    let columns: Vec<&str> = first.iter().chain(&COLUMNS).copied().collect();
    println!("\n### {title}\n\n| {} |\n|{}", columns.join(" | "), " --- |".repeat(columns.len()));
}

fn row(first: &[String], model: MasslessContactModel, settings: &BranchSettings) {
    let began = thread_time();
    let outcome = compute_branch(model, settings, |_| ControlFlow::Continue(()));
    let time = thread_time().saturating_sub(began).as_secs_f64() * 1e3;
    let cells = match outcome {
        Ok(computed) => describe(&computed, time),
        Err(error) => format!("- | - | - | - | no branch: {error} | - | {time:.0}"),
    };
    println!("| {} | {cells} |", first.join(" | "));
}

fn describe(computed: &ComputedBranch, time: f64) -> String {
    let points = &computed.branch.points;
    let mut events = BTreeMap::<&str, usize>::new();
    points.iter().flat_map(|p| &p.events).for_each(|e| *events.entry(e.name()).or_default() += 1);
    let events: Vec<String> = events.iter().map(|(name, n)| format!("{n} {name}")).collect();
    let tongues: Vec<String> =
        computed.tongues().iter().map(|t| t.resonance.to_string().replace("mode ", "")).collect();
    let residual = points.iter().fold(0.0_f64, |m, p| m.max(p.residual));
    let end = &computed.branch.end;
    let hz = points.last().map_or(f64::NAN, |p| p.omega / TAU);
    let early = if end.complete { "" } else { "**" };
    format!(
        "{} | {} | {} | {} | {early}{} at {hz:.3} Hz{early} | {residual:.0e} | {time:.0}",
        points.len(),
        computed.refused_steps,
        events.join(", "),
        tongues.join(", "),
        end.names(),
    )
}
