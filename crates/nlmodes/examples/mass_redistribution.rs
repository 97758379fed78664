//! What becomes of frequencies and backbone when the contact node loses its mass: three rules over mesh refinement.
//!
//! `cargo run --release --example mass_redistribution -- FOLDER` prints the tables of
//! `benchmarks/results/stops.md` and writes its figure.

use std::error::Error;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::path::PathBuf;

use nlmodes::branches::{BranchSettings, compute_branch};
use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes::model::{
    Conserve, Drop, MassRedistribution, MasslessContactModel, Move, Side, StructuralModel, linear_modes,
};
use nlmodes::report::ConvergenceFigure;

type Outcome<T> = Result<T, Box<dyn Error>>;

const LENGTH: f64 = 0.629_755_20;
const ELEMENTS: [usize; 5] = [5, 10, 20, 40, 80];
const RULES: [&dyn MassRedistribution; 3] = [&Drop, &Move, &Conserve];

/// The cantilever of Section 4 with equal elements.
fn beam(elements: usize) -> Outcome<StructuralModel> {
    let beam = Beam {
        material: Material::new(187.60e9, 7730.0)?.with_poissons_ratio(0.3)?,
        section: Section::rectangle(0.012, 0.020)?.with_shear_factor(5.0 / 6.0)?,
        mesh: Mesh::uniform(LENGTH, elements)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    Ok(beam.assemble(&[Stop::rigid(LENGTH, Direction::Transverse, Side::Positive, 1.03e-3)])?)
}

/// Relative changes of the first three frequencies by `rule`.
fn changes(model: &StructuralModel, rule: &dyn MassRedistribution) -> Outcome<Vec<f64>> {
    let massless = MasslessContactModel::new(model, rule)?;
    let kept = linear_modes(model.mass(), model.stiffness(), 3)?.omega;
    let without = linear_modes(massless.mass(), massless.stiffness(), 3)?.omega;
    Ok(kept.iter().zip(without).map(|(kept, without)| without / kept - 1.0).collect())
}

/// Frequency at three times the energy of grazing and at grazing, Hz, and the modal amplitude there.
fn backbone(model: &StructuralModel, rule: &dyn MassRedistribution) -> Outcome<[f64; 2]> {
    let settings = BranchSettings { max_energy_ratio: Some(3.0), ..BranchSettings::default() };
    let massless = MasslessContactModel::new(model, rule)?;
    let computed = compute_branch(massless, &settings, |_| ControlFlow::Continue(()))?;
    let last = computed.branch.points.last().ok_or("a branch without points")?;
    Ok([last.omega / TAU, 1e4 * computed.branch.points[0].modal_amplitude])
}

fn main() -> Outcome<()> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("which folder?")?);
    std::fs::create_dir_all(&folder)?;
    let mut curves: Vec<(&str, Vec<(f64, f64)>)> = RULES.iter().map(|rule| (rule.name(), Vec::new())).collect();
    println!("elements | rule | f1 | f2 | f3 | backbone Hz | amplitude at grazing, 1e-4 m √kg");
    for elements in ELEMENTS {
        let model = beam(elements)?;
        for (rule, curve) in RULES.iter().zip(&mut curves) {
            let found = changes(&model, *rule)?;
            let [hz, amplitude] = backbone(&model, *rule)?;
            println!(
                "| {elements} | {} | {:+.1e} | {:+.1e} | {:+.1e} | {hz:.4} | {amplitude:.4} |",
                rule.name(),
                found[0],
                found[1],
                found[2]
            );
            curve.1.push((elements as f64, found[0].abs()));
        }
    }
    let mut figure = ConvergenceFigure::new("elements", "change of the first frequency, relative")
        .title("Contact mass of a cantilever: left out, moved, conserved");
    for (name, curve) in &curves {
        figure = figure.series(name, curve);
    }
    let law = |exponent: i32, at: f64| [10.0, 80.0].map(|n: f64| (n, at * (n / 10.0).powi(exponent)));
    let (first, third) = (law(-1, 0.2), law(-3, 5e-3));
    figure = figure.reference("slope −1", &first).reference("slope −3", &third);
    figure.render()?.write(folder.join("mass_redistribution.svg"))?;
    Ok(())
}
