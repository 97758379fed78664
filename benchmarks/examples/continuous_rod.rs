//! The backbone of discrete rods beside the exact one of the continuous rod, with the tongues that interrupt it.
//!
//! `cargo run --release -p nlmodes-benchmarks --example continuous_rod [SVG]` writes `docs/images/continuous_rod.svg`.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, ResonanceRule, compute_branch};
use nlmodes::fem::MassMatrix;
use nlmodes::modal::{BranchEnd, Event, HarmonicCoefficients, ModalBranch, ModalPoint};
use nlmodes::report::{Abscissa, BranchFigure};
use nlmodes_benchmarks::{Failure, rod};

const LENGTH: f64 = 20.0;
const GAP: f64 = 0.5;
const MODULUS: f64 = 210e9;
const DENSITY: f64 = 9000.0;

fn main() -> Result<(), Failure> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "docs/images/continuous_rod.svg".to_owned());
    let mut branches = vec![exact()];
    for elements in [20, 80, 160] {
        let settings = BranchSettings {
            label: format!("{elements} elements, 20 harmonics"),
            harmonics: 20,
            internal_resonance: ResonanceRule::Skip,
            frequency_hz: Some([55.0, 72.0]),
            max_energy_ratio: Some(30.0),
            ..BranchSettings::default()
        };
        let computed =
            compute_branch(rod(elements, MassMatrix::Consistent)?, &settings, |_| ControlFlow::Continue(()))?;
        let tongues = computed.tongues();
        println!("{elements} elements: {} points, {}", computed.branch.points.len(), computed.branch.end.message);
        println!("  tongues: {}", tongues.iter().map(|t| t.resonance.to_string()).collect::<Vec<_>>().join(", "));
        let mut branch = computed.branch;
        // Names and symbols of all tongues would hide the curves.
        for point in &mut branch.points {
            point.resonance = None;
            point.events.retain(|e| *e == Event::Resumed);
        }
        branches.push(branch);
    }
    let all: Vec<&ModalBranch> = branches.iter().collect();
    BranchFigure::new(Abscissa::Energy, &all).title("Rod with a stop at its tip").render()?.write(&path)?;
    println!("{path}");
    Ok(())
}

/// One contact of length `2D − T` a period `T`, `D = 2L/c`; the tip pushes with the constant force `EA V/c`.
fn exact() -> ModalBranch {
    let speed = (MODULUS / DENSITY).sqrt();
    let d = 2.0 * LENGTH / speed;
    let point = |hz: f64| {
        let period = 1.0 / hz;
        let velocity = 2.0 * GAP / (2.0 * period - 3.0 * d);
        let total = 0.5 * DENSITY * LENGTH * velocity * velocity;
        let r = period / d;
        let kinetic = total * (r - 1.0) * (3.0 - r) / r;
        ModalPoint {
            omega: TAU * hz,
            coefficients: HarmonicCoefficients::zeros(1, 1),
            kinetic_energy: kinetic,
            total_energy: total,
            modal_amplitude: f64::NAN,
            fundamental: f64::NAN,
            peak: GAP,
            contact_fraction: 2.0 / r - 1.0,
            contact_intervals: 1,
            peak_contact_force: MODULUS * velocity / speed,
            ..ModalPoint::default()
        }
    };
    let first = speed / (4.0 * LENGTH);
    let points = (0..=120).map(|k| point(first + (72.0 - first) * f64::from(k) / 120.0)).collect();
    let end = BranchEnd::given("closed form");
    let label = "continuous rod, exact".into();
    ModalBranch { label, coordinates: Vec::new(), contact_coordinate: None, stop: None, points, end }
}
